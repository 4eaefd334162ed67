//! `softlimb device clear`: forget the faults that a device has latched.

use clap::Args;

use super::super::port::{DevicePort, options};
use super::super::{Failure, Outcome, say};
use softlimb_rig::link::clear_faults;

/// Clear the latched faults of a device, once their causes are gone
#[derive(Args)]
#[command(
    after_help = "Nothing moves until the next run. The device refuses while a cause is still there, and names it.\n\n\
                  Example: softlimb device clear --port /dev/ttyACM0"
)]
pub(super) struct Clear {
    #[command(flatten)]
    port: DevicePort,
}

impl Clear {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (address, mut port) = self.port.open()?;
        clear_faults(&mut port, &options()).map_err(Failure::new)?;
        say(&format!("{address}: no fault is latched"))?;
        Ok(Outcome::Done)
    }
}
