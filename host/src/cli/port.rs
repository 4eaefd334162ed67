//! The option that says where a device is.

use clap::Args;

use super::Failure;
use softlimb_rig::link::port::Address;

/// Address of a device, and its baud.
#[derive(Args)]
pub(super) struct PortOption {
    /// Device: /dev/ttyACM0, COM3, tcp:HOST:PORT, sim, qemu
    #[arg(long, value_name = "ADDRESS")]
    port: Option<Address>,
    /// Bits per second of a serial port [default: 921600]
    #[arg(long, requires = "port")]
    baud: Option<u32>,
}

impl PortOption {
    /// The address with its baud; `None` where there is none.
    pub(super) fn address(&self) -> Result<Option<Address>, Failure> {
        let Some(address) = self.port.clone() else { return Ok(None) };
        let at_baud = |baud| address.clone().at_baud(baud).map_err(Failure::wrong_line);
        self.baud.map_or(Ok(address.clone()), at_baud).map(Some)
    }
}
