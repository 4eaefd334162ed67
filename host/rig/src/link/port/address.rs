//! Addresses of devices.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Baud of the images for boards.
pub const BAUD: u32 = 921_600;
/// Bauds that a serial port may have.
pub const BAUD_RANGE: RangeInclusive<u32> = 1_200..=10_000_000;

const TCP: &str = "tcp:";
const FORMS: &str = "/dev/ttyACM0, COM3, tcp:HOST:PORT, sim, qemu";

/// Place of a device: in this process, in an emulator, or behind a port.
///
/// ```
/// use softlimb_rig::link::port::{Address, PortAddress};
///
/// assert_eq!("sim".parse(), Ok(Address::Simulated));
/// let serial = PortAddress::Serial { path: "/dev/ttyACM0".into(), baud: 921_600 };
/// assert_eq!("/dev/ttyACM0".parse(), Ok(Address::Port(serial)));
/// let tcp = PortAddress::Tcp { host: "localhost".into(), port: 7000 };
/// assert_eq!("tcp:localhost:7000".parse(), Ok(Address::Port(tcp)));
/// assert!("ttyACM0".parse::<Address>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// The simulated device, in this process.
    Simulated,
    /// The flashed image in an emulator, started by this process.
    Emulated,
    /// A device behind a port.
    Port(PortAddress),
}

/// A port of this computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortAddress {
    /// A serial port, or the terminal's end of a pseudo-terminal; 8 data bits, no parity, 1 stop bit.
    Serial {
        /// Name by the operating system.
        path: String,
        /// Bits per second, within [`BAUD_RANGE`].
        baud: u32,
    },
    /// A TCP server.
    Tcp {
        /// Name or number of the host.
        host: String,
        /// Its port.
        port: u16,
    },
}

/// Text that is no address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// None of the forms.
    #[error("`{0}` is no address of a device; the forms are {FORMS}")]
    Form(String),
    /// A TCP address without a port that there can be.
    #[error("`{0}`: the form is tcp:HOST:PORT, with a PORT from 1 to 65535")]
    Tcp(String),
    /// A baud that no port has.
    #[error("baud = {0} is not allowed: {low} to {high}", low = BAUD_RANGE.start(), high = BAUD_RANGE.end())]
    Baud(u32),
    /// A baud for something without a line.
    #[error("a baud is for serial ports; {0} has none")]
    NoBaud(Address),
}

impl Address {
    /// The same address at another baud.
    ///
    /// # Errors
    /// [`AddressError::Baud`] outside of [`BAUD_RANGE`], [`AddressError::NoBaud`] where the address is no serial port.
    pub fn at_baud(self, baud: u32) -> Result<Self, AddressError> {
        match self {
            Self::Port(PortAddress::Serial { path, .. }) if BAUD_RANGE.contains(&baud) => {
                Ok(Self::Port(PortAddress::Serial { path, baud }))
            }
            Self::Port(PortAddress::Serial { .. }) => Err(AddressError::Baud(baud)),
            other => Err(AddressError::NoBaud(other)),
        }
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text {
            "sim" => Ok(Self::Simulated),
            "qemu" => Ok(Self::Emulated),
            _ => match text.strip_prefix(TCP) {
                Some(place) => tcp(place).ok_or_else(|| AddressError::Tcp(text.to_owned())),
                None if is_serial(text) => Ok(PortAddress::Serial { path: text.to_owned(), baud: BAUD }),
                None => Err(AddressError::Form(text.to_owned())),
            }
            .map(Self::Port),
        }
    }
}

fn tcp(place: &str) -> Option<PortAddress> {
    let (host, port) = place.rsplit_once(':')?;
    let port = port.parse().ok().filter(|port| *port > 0)?;
    (!host.is_empty()).then(|| PortAddress::Tcp { host: host.to_owned(), port })
}

/// A path, or a name as Windows gives them.
fn is_serial(text: &str) -> bool {
    let number = text.get(..3).filter(|word| word.eq_ignore_ascii_case("com")).and_then(|_| text.get(3..));
    text.contains(['/', '\\']) || number.is_some_and(|number| number.parse::<u8>().is_ok())
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("sim"),
            Self::Emulated => f.write_str("qemu"),
            Self::Port(port) => port.fmt(f),
        }
    }
}

impl fmt::Display for PortAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { path, .. } => f.write_str(path),
            Self::Tcp { host, port } => write!(f, "{TCP}{host}:{port}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn serial(path: &str) -> Address {
        Address::Port(PortAddress::Serial { path: path.to_owned(), baud: BAUD })
    }

    #[test]
    fn every_form_is_read_and_shown_again() {
        let tcp = |host: &str, port| Address::Port(PortAddress::Tcp { host: host.to_owned(), port });
        let forms = [
            ("sim", Address::Simulated),
            ("qemu", Address::Emulated),
            ("/dev/ttyACM0", serial("/dev/ttyACM0")),
            ("/dev/serial/by-id/usb-ST:1", serial("/dev/serial/by-id/usb-ST:1")),
            ("COM3", serial("COM3")),
            ("com12", serial("com12")),
            (r"\\.\COM12", serial(r"\\.\COM12")),
            ("tcp:board.local:7000", tcp("board.local", 7000)),
            ("tcp:[::1]:7000", tcp("[::1]", 7000)),
        ];
        for (text, address) in forms {
            assert_eq!(text.parse(), Ok(address.clone()));
            assert_eq!(address.to_string(), text);
        }
    }

    #[test]
    fn other_text_is_named_with_the_forms() {
        for text in ["", "ttyACM0", "COM", "COMx", "simulated", "tcp"] {
            let error = text.parse::<Address>().unwrap_err();
            let message = error.to_string();
            assert!(message.contains(&format!("`{text}`")) && message.contains("tcp:HOST:PORT"), "{message}");
        }
        for text in ["tcp:", "tcp:host", "tcp::7000", "tcp:host:0", "tcp:host:65536", "tcp:host:x"] {
            assert_eq!(text.parse::<Address>(), Err(AddressError::Tcp(text.to_owned())));
        }
    }

    #[test]
    fn serial_ports_alone_take_a_baud_within_the_range() {
        let at = |address: Address, baud| address.at_baud(baud);
        let fast = PortAddress::Serial { path: "COM3".to_owned(), baud: 1_000_000 };
        assert_eq!(at(serial("COM3"), 1_000_000), Ok(Address::Port(fast)));
        assert_eq!(at(serial("COM3"), 300), Err(AddressError::Baud(300)));
        assert_eq!(at(Address::Simulated, 9_600).unwrap_err().to_string(), "a baud is for serial ports; sim has none");
    }
}
