//! Errors of opening a port.

use std::io;

use super::address::PortAddress;

/// Why a port cannot be opened or listed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PortError {
    /// A serial port cannot be opened.
    #[error("cannot open {address}: {source}{}", cure(source))]
    Serial {
        /// The port.
        address: PortAddress,
        /// Reason of the operating system.
        source: io::Error,
    },
    /// Nobody answers at a TCP address.
    #[error("cannot connect to {address}: {source}")]
    Tcp {
        /// The server.
        address: PortAddress,
        /// Reason of the operating system.
        source: io::Error,
    },
    /// The operating system does not list its serial ports.
    #[error("cannot list the serial ports: {0}")]
    List(io::Error),
}

fn cure(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::PermissionDenied => "; on Linux the user must be in the group of the port, mostly `dialout`",
        io::ErrorKind::NotFound => "; `softlimb device list` lists the serial ports",
        _ => "",
    }
}
