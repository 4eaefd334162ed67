//! The device's end of a port: where a served device meets its client.

use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
#[cfg(unix)]
use std::time::{Duration, Instant};

/// A port that a device answers at. No call waits.
pub struct ClientPort(Kind);

enum Kind {
    Tcp {
        listener: TcpListener,
        client: Option<TcpStream>,
    },
    #[cfg(unix)]
    Terminal(Terminal),
}

impl ClientPort {
    /// Listens at a TCP address, `HOST:PORT`; port 0 takes a free one.
    ///
    /// # Errors
    /// The operating system's: a wrong address, or one that is taken.
    pub fn tcp(address: impl ToSocketAddrs) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self(Kind::Tcp { listener, client: None }))
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
        Err(io::Error::new(ErrorKind::Unsupported, "this system has no pseudo-terminals; serve at a TCP address"))
    }

    /// The address for clients, as [`Address`](super::Address) reads it.
    ///
    /// # Errors
    /// The operating system's.
    pub fn address(&self) -> io::Result<String> {
        match &self.0 {
            Kind::Tcp { listener, .. } => listener.local_addr().map(|address| format!("tcp:{address}")),
            #[cfg(unix)]
            Kind::Terminal(terminal) => Ok(terminal.path.clone()),
        }
    }

    /// The next client that has come, if the port tells and none is there.
    pub(super) fn greet(&mut self) -> io::Result<Option<SocketAddr>> {
        let Kind::Tcp { listener, client: client @ None } = &mut self.0 else { return Ok(None) };
        match listener.accept() {
            Ok((stream, address)) => {
                stream.set_nonblocking(true)?;
                stream.set_nodelay(true)?;
                *client = Some(stream);
                Ok(Some(address))
            }
            Err(error) if is_nothing(&error) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Appends the bytes that have arrived; false when the client has left.
    pub(super) fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<bool> {
        match &mut self.0 {
            Kind::Tcp { client, .. } => {
                let Some(stream) = client else { return Ok(true) };
                let stays = read_all(stream, into);
                if !stays {
                    *client = None;
                }
                Ok(stays)
            }
            #[cfg(unix)]
            Kind::Terminal(terminal) => terminal.receive(into).map(|()| true),
        }
    }

    /// Sends bytes to the client. Bytes that no one takes are lost, as on a line.
    pub(super) fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        match &mut self.0 {
            // A client that has left shows at the next receipt; one that reads too slowly loses bytes.
            Kind::Tcp { client, .. } => drop(client.as_mut().map(|stream| stream.write(bytes))),
            #[cfg(unix)]
            Kind::Terminal(terminal) => terminal.send(bytes)?,
        }
        Ok(())
    }
}

/// Appends what has arrived; whether the client is still there.
fn read_all(stream: &mut impl Read, into: &mut Vec<u8>) -> bool {
    let mut bytes = [0; 4096];
    loop {
        match stream.read(&mut bytes) {
            Ok(0) => return false,
            Ok(count) => into.extend(bytes.iter().take(count)),
            Err(error) => return is_nothing(&error),
        }
    }
}

/// Whether there is only nothing to do.
fn is_nothing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
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
