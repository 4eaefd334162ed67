//! The device's end of a port: where a served device meets its clients.

use std::fmt;
use std::io;
#[cfg(unix)]
use std::io::Write;
use std::net::ToSocketAddrs;
#[cfg(unix)]
use std::time::{Duration, Instant};

use super::clients::Clients;
#[cfg(unix)]
use super::clients::{is_nothing, read_all};
use super::serve::Served;

/// A port that a device answers at. No call waits.
pub struct ClientPort(Kind);

enum Kind {
    Tcp(Box<Clients>),
    #[cfg(unix)]
    Terminal(Terminal),
}

impl ClientPort {
    /// Listens at a TCP address, `HOST:PORT`; port 0 takes a free one.
    ///
    /// # Errors
    /// The operating system's: a wrong address, or one that is taken.
    pub fn tcp(address: impl ToSocketAddrs) -> io::Result<Self> {
        Clients::listen(address).map(|clients| Self(Kind::Tcp(Box::new(clients))))
    }

    /// A new pseudo-terminal.
    ///
    /// # Errors
    /// The operating system's; always where it is not Unix.
    #[cfg(unix)]
    pub fn terminal() -> io::Result<Self> {
        Ok(Self(Kind::Terminal(Terminal::new()?)))
    }

    /// A new pseudo-terminal.
    ///
    /// # Errors
    /// The operating system's; always where it is not Unix.
    #[cfg(not(unix))]
    pub fn terminal() -> io::Result<Self> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "this system has no pseudo-terminals; serve at a TCP address"))
    }

    /// The address for clients, as [`Address`](super::Address) reads it.
    ///
    /// # Errors
    /// The operating system's.
    pub fn address(&self) -> io::Result<String> {
        match &self.0 {
            Kind::Tcp(clients) => clients.address().map(|address| format!("tcp:{address}")),
            #[cfg(unix)]
            Kind::Terminal(terminal) => Ok(terminal.path.clone()),
        }
    }

    /// Accepts clients, and appends their bytes that may reach the device. `mcu_time_us` is the device's time.
    pub(super) fn receive(
        &mut self,
        mcu_time_us: u64,
        into: &mut Vec<u8>,
        on_news: &mut dyn FnMut(Served),
    ) -> io::Result<()> {
        match &mut self.0 {
            Kind::Tcp(clients) => {
                clients.greet(on_news)?;
                clients.receive(mcu_time_us, into, on_news);
                Ok(())
            }
            #[cfg(unix)]
            Kind::Terminal(terminal) => terminal.receive(into),
        }
    }

    /// Sends bytes to the clients. Bytes that nobody reads are lost, as on a serial line.
    pub(super) fn send(&mut self, bytes: &[u8], on_news: &mut dyn FnMut(Served)) -> io::Result<()> {
        match &mut self.0 {
            Kind::Tcp(clients) => {
                clients.send(bytes, on_news);
                Ok(())
            }
            #[cfg(unix)]
            Kind::Terminal(terminal) => terminal.send(bytes),
        }
    }
}

impl fmt::Debug for ClientPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClientPort").field("address", &self.address()).finish()
    }
}

/// A pseudo-terminal. Clients come and go unseen, as at a board whose plug stays in.
#[cfg(unix)]
struct Terminal {
    path: String,
    device: serialport::TTYPort,
    /// The clients' end, kept open so that it stays raw and the device's end stays alive.
    clients: serialport::TTYPort,
    released: Instant,
}

/// Bytes that wait for a client before they are dropped; the kernel keeps 4095 of them where a client sees them.
#[cfg(unix)]
const UNREAD_MAX: u32 = 3_000;
/// Time between two releases of the lock that a killed client leaves.
#[cfg(unix)]
const RELEASE: Duration = Duration::from_secs(1);

#[cfg(unix)]
impl Terminal {
    fn new() -> io::Result<Self> {
        use serialport::SerialPort;
        let (mut device, clients) = serialport::TTYPort::pair()?;
        device.set_timeout(Duration::ZERO)?;
        let path = clients.name().ok_or_else(|| io::Error::other("the pseudo-terminal has no name"))?;
        Ok(Self { path, device, clients, released: Instant::now() })
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        if self.released.elapsed() >= RELEASE {
            self.released = Instant::now();
            // Its end takes back the exclusive use of the terminal, which outlives a client that was killed.
            drop(self.clients.try_clone_native()?);
        }
        // With the clients' end open there is no end of the stream.
        read_all(&mut self.device, into);
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        use serialport::{ClearBuffer, SerialPort};
        if self.clients.bytes_to_read()? > UNREAD_MAX {
            self.clients.clear(ClearBuffer::Input)?;
        }
        match self.device.write(bytes) {
            Err(error) if !is_nothing(&error) => Err(error),
            _ => Ok(()),
        }
    }
}
