//! `softlimb device list`: the serial ports of this computer.

use clap::Args;
use serde::Serialize;

use super::super::shared::show;
use super::super::{Failure, Outcome};
use softlimb_rig::link::port::{SerialPort, serial_ports};

/// List the serial ports of this computer
#[derive(Args)]
#[command(after_help = "Example: softlimb device list")]
pub(super) struct List {
    /// Print the ports as JSON
    #[arg(long)]
    json: bool,
}

/// A port, as `--json` prints it.
#[derive(Serialize)]
struct Printed<'a> {
    port: &'a str,
    description: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    serial_number: Option<&'a str>,
}

impl<'a> From<&'a SerialPort> for Printed<'a> {
    fn from(port: &'a SerialPort) -> Self {
        let serial_number = port.serial_number.as_deref();
        Self { port: &port.path, description: &port.description, serial_number }
    }
}

impl List {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let ports = serial_ports().map_err(Failure::new)?;
        let printed: Vec<Printed<'_>> = ports.iter().map(Printed::from).collect();
        show(self.json, &printed, || table(&printed))?;
        Ok(Outcome::Done)
    }
}

fn table(ports: &[Printed<'_>]) -> String {
    if ports.is_empty() {
        return "no serial ports".to_owned();
    }
    let width = ports.iter().map(|port| port.port.len()).max().unwrap_or(0);
    let line = |port: &Printed<'_>| {
        let serial = port.serial_number.map(|number| format!(", serial number {number}")).unwrap_or_default();
        format!("{:width$}  {}{serial}\n", port.port, port.description)
    };
    ports.iter().map(line).collect()
}
