//! A port as a transport: reads that wait for the operating system, times by its monotonic clock.

use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant, SystemTime};

use super::address::PortAddress;
use super::error::PortError;
use super::serial;
use crate::link::Transport;

/// Shortest wait, below which operating systems do not wait or round up, and longest, after which a caller looks around.
const WAIT_MIN: Duration = Duration::from_millis(1);
const WAIT_MAX: Duration = Duration::from_millis(50);
/// Longest wait of bytes for room on the way out.
const SEND_MAX: Duration = Duration::from_millis(500);
/// Longest wait for a TCP server to answer.
const CONNECT_MAX: Duration = Duration::from_secs(5);

/// Bytes both ways, with a limit to how long either waits.
pub(super) trait Stream: Read + Write + Send {
    /// Longest time of the next reads and writes.
    fn set_wait(&mut self, wait: Duration) -> io::Result<()>;
}

impl Stream for TcpStream {
    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        self.set_read_timeout(Some(wait))?;
        self.set_write_timeout(Some(wait))
    }
}

/// A number for a session that most likely no earlier one had: from the clock and the process.
#[must_use]
pub fn session_number() -> u16 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_micros() as u64);
    let mixed = (since ^ u64::from(std::process::id()) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed >> 48) as u16
}

/// An open port.
pub struct Port {
    address: PortAddress,
    stream: Box<dyn Stream>,
    began: Instant,
    arrived: Vec<u8>,
    /// Why nothing will arrive any more.
    gone: Option<(ErrorKind, String)>,
}

impl Port {
    /// Opens a port.
    ///
    /// # Errors
    /// [`PortError`] names the port and the reason of the operating system.
    pub fn open(address: &PortAddress) -> Result<Self, PortError> {
        let stream: Box<dyn Stream> = match address {
            PortAddress::Serial { path, baud } => {
                let opened = serial::open(path, *baud);
                Box::new(opened.map_err(|source| PortError::Serial { address: address.clone(), source })?)
            }
            PortAddress::Tcp { host, port } => {
                let connected = connect(host, *port);
                Box::new(connected.map_err(|source| PortError::Tcp { address: address.clone(), source })?)
            }
        };
        Ok(Self { address: address.clone(), stream, began: Instant::now(), arrived: Vec::new(), gone: None })
    }

    fn read(&mut self, wait: Duration) -> io::Result<()> {
        let mut bytes = [0; 4096];
        self.stream.set_wait(wait)?;
        match self.stream.read(&mut bytes) {
            Ok(0) => Err(io::Error::new(ErrorKind::UnexpectedEof, "end of stream")),
            Ok(count) => {
                self.arrived.extend(bytes.iter().take(count));
                Ok(())
            }
            Err(error) if is_pause(&error) => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn lose(&mut self, error: &io::Error) {
        let reason = match error.kind() {
            // The device is there, but takes nothing.
            ErrorKind::TimedOut => format!("{} took no bytes for {} ms", self.address, SEND_MAX.as_millis()),
            _ => format!("{} is gone: unplugged, or closed at its other end ({error})", self.address),
        };
        self.gone.get_or_insert((error.kind(), reason));
    }

    fn check(&self) -> io::Result<()> {
        match &self.gone {
            Some((kind, reason)) => Err(io::Error::new(*kind, reason.clone())),
            None => Ok(()),
        }
    }
}

impl Transport for Port {
    fn now_us(&self) -> u64 {
        // 64 bits last half a million years.
        self.began.elapsed().as_micros() as u64
    }

    /// Waits only where the operating system has no room, and at most half a second.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.check()?;
        let sent = self.stream.set_wait(SEND_MAX).and_then(|()| self.stream.write_all(bytes));
        if let Err(error) = sent {
            let late = ErrorKind::TimedOut.into();
            self.lose(if is_pause(&error) { &late } else { &error });
        }
        self.check()
    }

    /// Bytes that arrived before the port was lost come before the error.
    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        if self.arrived.is_empty() {
            return self.check();
        }
        into.append(&mut self.arrived);
        Ok(())
    }

    /// At most 50 ms, so that its caller sees a cancellation; at least one look at the port.
    fn wait_until(&mut self, deadline_us: u64) {
        if self.gone.is_some() {
            return;
        }
        let left = Duration::from_micros(deadline_us.saturating_sub(self.now_us()));
        if let Err(error) = self.read(left.clamp(WAIT_MIN, WAIT_MAX)) {
            self.lose(&error);
        }
    }
}

impl fmt::Debug for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Port").field("address", &self.address).field("gone", &self.gone).finish_non_exhaustive()
    }
}

/// Whether nothing is lost: the time is over, or a signal came.
fn is_pause(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// Connects to the first address of a host that answers.
fn connect(host: &str, port: u16) -> io::Result<TcpStream> {
    let mut error = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in std::net::ToSocketAddrs::to_socket_addrs(&format!("{host}:{port}"))? {
        match TcpStream::connect_timeout(&address, CONNECT_MAX) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(failed) => error = failed,
        }
    }
    Err(error)
}
