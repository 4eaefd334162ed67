//! `softlimb record`: a log of a device without a scene.

use std::path::PathBuf;

use clap::Args;

use super::interrupt::interrupt;
use super::port::DevicePort;
use super::{Failure, Outcome, note, warn};
use softlimb_rig::run::record_behind;

/// Record what a device sends until Ctrl-C, without a scene
#[derive(Args)]
#[command(
    after_help = "The log has all bytes of the device, its measurements and its faults. It asks the device once who it is, and says nothing more. A\n\
                  device without a configuration sends nothing.\n\
                  `softlimb report` and `softlimb export` take the log. A channel's setpoint there is the pressure that its loop tracks.\n\n\
                  Example: softlimb record --port /dev/ttyACM0 -o board.mcap"
)]
pub(super) struct Record {
    #[command(flatten)]
    port: DevicePort,
    /// The log; an existing file is replaced when the new one is finished
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
}

impl Record {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let stop = interrupt()?;
        let (address, port) = self.port.open()?;
        note(&format!("recording {address}; Ctrl-C ends it"));
        let heard = record_behind(port, &self.out, &stop)?;
        note(&format!("wrote {}: {} measurements, {} bytes", self.out.display(), heard.samples, heard.bytes));
        let silent = (heard.samples == 0).then(|| "the device sent no measurements".to_owned());
        let others = (heard.others > 0).then(|| {
            format!("{} measurements have another number of channels: the log has their bytes alone", heard.others)
        });
        Ok(warn(&silent.into_iter().chain(others).collect::<Vec<_>>()))
    }
}
