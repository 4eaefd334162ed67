//! `softlimb record`: a log of a device without a scene.

use std::path::PathBuf;

use clap::Args;

use super::interrupt::interrupt;
use super::port::DevicePort;
use super::{Failure, Outcome, note, warn};
use softlimb_rig::link::port::PortAddress;
use softlimb_rig::run::record_behind;

/// Record what a device sends until Ctrl-C, without a scene
#[derive(Args)]
#[command(
    after_help = "The log has all bytes of the device, its measurements and its faults. It asks the device once who it is, and says nothing more\n\
                  but the request of --sample-period. A device without a configuration sends nothing.\n\
                  `softlimb report` and `softlimb export` take the log. A channel's setpoint there is the pressure that its loop tracks.\n\n\
                  Example: softlimb record --port /dev/ttyACM0 -o board.mcap"
)]
pub(super) struct Record {
    #[command(flatten)]
    port: DevicePort,
    /// The log; an existing file is replaced when the new one is finished
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Time between samples of pressures and valves that the device sends beside its telemetry, whole ms; topic /softlimb/samples of the log
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    sample_period: Option<u32>,
}

impl Record {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let stop = interrupt()?;
        let (address, port) = self.port.open()?;
        note(&format!("recording {address}; Ctrl-C ends it"));
        let baud = if let PortAddress::Serial { baud, .. } = &address { Some(*baud) } else { None };
        let heard = record_behind(port, self.sample_period.map(|ms| (1_000 * ms, baud)), &self.out, &stop)?;
        note(&format!("wrote {}: {} measurements, {} bytes", self.out.display(), heard.samples, heard.bytes));
        let silent = (heard.samples == 0).then(|| "the device sent no measurements".to_owned());
        let others = (heard.others > 0).then(|| {
            format!("{} measurements have another number of channels: the log has their bytes alone", heard.others)
        });
        Ok(warn(&silent.into_iter().chain(others).collect::<Vec<_>>()))
    }
}
