//! `softlimb device info`: who answers at a port.

use clap::Args;
use serde::Serialize;

use super::super::port::DevicePort;
use super::super::shared::show;
use super::super::{Failure, Outcome};
use softlimb_rig::link::{Examined, PortErrors, code_name, examine};

/// Ask a device for its firmware, its limits, its state, why it last started, and the errors of its port
#[derive(Args)]
#[command(
    after_help = "Changes nothing on the device. A device that another program commands answers too, and says so.\n\n\
                  Example: softlimb device info --port /dev/ttyACM0"
)]
pub(super) struct Info {
    #[command(flatten)]
    port: DevicePort,
    /// Print the answer as JSON
    #[arg(long)]
    json: bool,
}

/// The answer, as `--json` prints it.
#[derive(Serialize)]
struct Printed {
    port: String,
    firmware: String,
    protocol_version: u16,
    schema_hash: String,
    state: String,
    boot_cause: String,
    channels_max: u8,
    knots_capacity: u16,
    tick_us: u32,
    /// Absent where the device has no configuration.
    #[serde(skip_serializing_if = "Option::is_none")]
    config_hash: Option<String>,
    /// Whether another program commands the device.
    commanded_by_another: bool,
    /// Since the start of the device. Absent where another program commands it.
    #[serde(skip_serializing_if = "Option::is_none")]
    port_errors: Option<PortErrors>,
}

impl Info {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (address, mut port) = self.port.open()?;
        let examined = examine(&mut port, &super::super::port::options()).map_err(Failure::new)?;
        let printed = Printed::new(address.to_string(), &examined);
        show(self.json, &printed, || printed.table())?;
        Ok(Outcome::Done)
    }
}

impl Printed {
    fn new(port: String, Examined { device, port_errors }: &Examined) -> Self {
        Self {
            port,
            firmware: device.firmware.to_string(),
            protocol_version: device.protocol_version,
            schema_hash: format!("{:08x}", device.schema_hash),
            state: code_name(device.state),
            boot_cause: code_name(device.boot_cause),
            channels_max: device.channels_max,
            knots_capacity: device.knots_capacity,
            tick_us: device.tick_us,
            config_hash: device.config_hash.map(|hash| format!("{hash:08x}")),
            commanded_by_another: device.is_occupied,
            port_errors: *port_errors,
        }
    }

    fn table(&self) -> String {
        let rows = [
            ("port", self.port.clone()),
            ("firmware", self.firmware.clone()),
            ("protocol", format!("version {}, schema {}", self.protocol_version, self.schema_hash)),
            ("state", self.state.clone()),
            ("last start", self.boot_cause.clone()),
            ("channels", format!("{} at most", self.channels_max)),
            ("buffer", format!("{} setpoints", self.knots_capacity)),
            ("tick", format!("{} us", self.tick_us)),
            ("configuration", self.config_hash.clone().unwrap_or_else(|| "none".to_owned())),
            ("port errors", self.port_errors.map_or_else(|| "unknown".to_owned(), |errors| errors.to_string())),
            ("commanded by", if self.commanded_by_another { "another program" } else { "nobody else" }.to_owned()),
        ];
        rows.iter().map(|(name, value)| format!("{name:13}  {value}\n")).collect()
    }
}
