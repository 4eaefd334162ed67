//! Real ports: a serial port, TCP, a pseudo-terminal; and their addresses.
//!
//! An [`Address`] is the one line that says where a device is. A [`Port`] carries bytes to it and from it, by the monotonic clock of this
//! computer. [`serve`] is the other end: a simulated device that answers at a [`ClientPort`].

mod address;
mod client;
mod clients;
mod error;
mod gate;
mod serial;
mod serve;
mod stream;

pub use address::{Address, AddressError, BAUD, BAUD_RANGE, PortAddress};
pub use client::ClientPort;
pub use error::PortError;
pub use serial::{SerialPort, serial_ports};
pub use serve::{Leave, ServeError, Served, serve};
pub use stream::{Port, session_number};
