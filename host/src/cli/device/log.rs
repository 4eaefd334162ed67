//! `softlimb device log`: starts and faults of a device, also those before it was last switched off.

use clap::Args;
use serde::Serialize;

use super::super::port::{DevicePort, options};
use super::super::shared::show;
use super::super::{Failure, Outcome};
use softlimb_rig::link::{DeviceFault, DeviceLog, LoggedStart, code_name, condition_in_words, read_log};

/// Print the starts and faults of a device, also those before it was last switched off
#[derive(Args)]
#[command(
    after_help = "Changes nothing on the device. Times count from the start above them. The device refuses while its limb follows setpoints,\n\
                  and while another program commands it.\n\n\
                  Example: softlimb device log --port /dev/ttyACM0"
)]
pub(super) struct Log {
    #[command(flatten)]
    port: DevicePort,
    /// Print the log as JSON
    #[arg(long)]
    json: bool,
}

/// The log, as `--json` prints it.
#[derive(Serialize)]
struct Printed {
    port: String,
    /// Absent, Kept, Full or Failed, as in `protocol/SPEC.md`.
    condition: String,
    /// Records since the start that the device did not store.
    unstored: u32,
    /// Oldest first.
    starts: Vec<Start>,
}

#[derive(Serialize)]
struct Start {
    /// From 1.
    number: u32,
    /// Absent if its record is older than the log or spoiled.
    #[serde(skip_serializing_if = "Option::is_none")]
    cause: Option<String>,
    /// As `boot_detail` in `protocol/SPEC.md`; absent as the cause.
    #[serde(skip_serializing_if = "Option::is_none")]
    detail: Option<u32>,
    faults: Vec<Fault>,
}

#[derive(Serialize)]
struct Fault {
    /// Time since the start, s.
    time_s: f64,
    /// Absent for the system.
    #[serde(skip_serializing_if = "Option::is_none")]
    channel: Option<u8>,
    code: String,
    value: i32,
    text: String,
}

impl Log {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (address, mut port) = self.port.open()?;
        let log = read_log(&mut port, &options()).map_err(Failure::new)?;
        show(self.json, &Printed::new(address.to_string(), &log), || table(&log))?;
        Ok(Outcome::Done)
    }
}

impl Printed {
    fn new(port: String, log: &DeviceLog) -> Self {
        let starts = log.starts.iter().map(Start::new).collect();
        Self { port, condition: code_name(log.condition), unstored: log.unstored, starts }
    }
}

impl Start {
    fn new(LoggedStart { number, cause, faults }: &LoggedStart) -> Self {
        Self {
            number: *number,
            cause: cause.map(|cause| code_name(cause.cause)),
            detail: cause.map(|cause| cause.detail),
            faults: faults.iter().map(Fault::new).collect(),
        }
    }
}

impl Fault {
    fn new(fault: &DeviceFault) -> Self {
        Self {
            time_s: seconds(fault),
            channel: fault.channel,
            code: code_name(fault.code),
            value: fault.value.unwrap_or_default(),
            text: fault.to_string(),
        }
    }
}

fn seconds(fault: &DeviceFault) -> f64 {
    fault.time_us.unwrap_or_default() as f64 * 1e-6
}

fn table(log: &DeviceLog) -> String {
    let mut lines = vec![format!("{:>7}  {:>12}  event", "start", "time, s")];
    for LoggedStart { number, cause, faults } in &log.starts {
        let cause = cause.map_or_else(|| "cause not in the log".to_owned(), |cause| cause.to_string());
        lines.push(format!("{number:7}  {:>12}  start: {cause}", ""));
        lines.extend(faults.iter().map(|fault| format!("{:7}  {:12.3}  {fault}", "", seconds(fault))));
    }
    let unstored =
        if log.unstored > 0 { format!("; {} of this start not stored", log.unstored) } else { String::new() };
    lines.push(condition_in_words(log.condition) + &unstored);
    lines.join("\n")
}
