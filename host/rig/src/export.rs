//! Exports a log as tables, one for each topic, and as JSON.

use std::fmt::Write;

use serde::Serialize;
use softlimb_files::table::written;

use crate::record::{Capture, Direction, ModuleInfo, ModuleSample, RunLog, Sample};

/// A table of a topic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Name of the topic without `/softlimb/`.
    pub name: &'static str,
    /// Comma-separated values with a header whose names end with the unit. A cell is empty where a value is not known.
    pub csv: String,
}

/// The tables of a log: those of topics without a message are left out.
#[must_use]
pub fn tables(log: &RunLog, capture: &Capture) -> Vec<Table> {
    let tables = [
        ("telemetry", telemetry(log)),
        ("setpoint", deformation(log, "tip_setpoint", |module| Some(module.setpoint), |s| Some(s.tip_setpoint_m))),
        ("model", deformation(log, "tip_modelled", |module| Some(module.modelled), |s| Some(s.tip_modelled_m))),
        ("truth", truth(log)),
        ("fault", fault(log)),
        ("shape", shape(log)),
        ("wire", wire(capture)),
        ("ticks", ticks(capture)),
    ];
    let filled = tables.into_iter().filter(|(_, (_, rows))| !rows.is_empty());
    let text = |(header, rows): Rows| written(&header.iter().map(String::as_str).collect::<Vec<_>>(), rows);
    filled.map(|(name, rows)| Table { name, csv: text(rows) }).collect()
}

/// Header and rows.
type Rows = (Vec<String>, Vec<Vec<String>>);

/// A number that reads back exactly; empty for one that is not known.
fn number(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}

fn maybe(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn telemetry(log: &RunLog) -> Rows {
    let mut header = strings(&["time_s", "state", "fault_bits", "supply_pa", "output_bits"]);
    for channel in 0..log.info.channel_count() {
        let names = ["pressure_pa", "reference_pa", "duty", "status"];
        header.extend(names.map(|name| format!("channel_{channel}_{name}")));
    }
    let row = |sample: &Sample| {
        let mut cells = vec![
            number(sample.time_s),
            sample.state.to_string(),
            sample.fault_bits.to_string(),
            number(sample.supply_pa),
            sample.outputs.bits.to_string(),
        ];
        for channel in &sample.channels {
            cells.extend([channel.pressure_pa, channel.reference_pa, channel.duty].map(number));
            cells.push(channel.status.to_string());
        }
        cells
    };
    (header, log.samples.iter().map(row).collect())
}

/// Name of a module's column: the module, its quantity and the unit.
fn column(module: &ModuleInfo) -> String {
    let (name, quantity) = (module.name.replace(' ', "_"), module.quantity.name());
    match module.quantity.si_unit() {
        "1" => format!("{name}_{quantity}"),
        unit => format!("{name}_{quantity}_{}", unit.to_lowercase()),
    }
}

fn point_names(name: &str) -> [String; 3] {
    ["x", "y", "z"].map(|axis| format!("{name}_{axis}_m"))
}

fn point(point: Option<[f64; 3]>) -> [String; 3] {
    point.unwrap_or([f64::NAN; 3]).map(number)
}

fn deformation(
    log: &RunLog,
    tip: &str,
    value: impl Fn(&ModuleSample) -> Option<f64>,
    tip_m: impl Fn(&Sample) -> Option<[f64; 3]>,
) -> Rows {
    let mut header = strings(&["time_s"]);
    header.extend(log.info.modules.iter().map(column));
    header.extend(point_names(tip));
    let row = |sample: &Sample| {
        let modules = sample.modules.iter().map(|module| maybe(value(module)));
        [number(sample.time_s)].into_iter().chain(modules).chain(point(tip_m(sample))).collect()
    };
    (header, log.samples.iter().map(row).collect())
}

fn truth(log: &RunLog) -> Rows {
    let (mut header, _) = deformation(log, "tip_achieved", |_| None, |_| None);
    header.extend((0..log.info.channel_count()).map(|channel| format!("channel_{channel}_chamber_pressure_pa")));
    header.push("gripper_closure".to_owned());
    let seen = log.samples.iter().filter(|sample| {
        sample.tip_achieved_m.is_some() || sample.channels.iter().any(|channel| channel.true_pressure_pa.is_some())
    });
    let row = |sample: &Sample| {
        let modules = sample.modules.iter().map(|module| maybe(module.achieved));
        let chambers = sample.channels.iter().map(|channel| maybe(channel.true_pressure_pa));
        let cells = [number(sample.time_s)].into_iter().chain(modules).chain(point(sample.tip_achieved_m));
        cells.chain(chambers).chain([maybe(sample.outputs.gripper_closure)]).collect()
    };
    (header, seen.map(row).collect())
}

fn fault(log: &RunLog) -> Rows {
    let rows = log.faults.iter().map(|fault| {
        let numbers = [fault.channel.to_string(), fault.code.to_string(), fault.value.to_string()];
        [number(fault.time_s)].into_iter().chain(numbers).chain([fault.text.clone()]).collect()
    });
    (strings(&["time_s", "channel", "code", "value", "text"]), rows.collect())
}

/// One row a point of a backbone.
fn shape(log: &RunLog) -> Rows {
    let mut header = strings(&["time_s", "line", "point"]);
    header.extend(["x_m", "y_m", "z_m"].map(str::to_owned));
    let mut rows = Vec::new();
    for shape in &log.shapes {
        for (line, points) in [("setpoint", Some(&shape.setpoint)), ("achieved", shape.achieved.as_ref())] {
            for (index, at) in points.into_iter().flatten().enumerate() {
                let cells = [number(shape.time_s), line.to_owned(), index.to_string()];
                rows.push(cells.into_iter().chain(point(Some(*at))).collect());
            }
        }
    }
    (header, rows)
}

fn wire(capture: &Capture) -> Rows {
    let row = |wire: &crate::record::WireBytes| {
        let hexadecimal = wire.bytes.iter().fold(String::new(), |mut text, byte| {
            // Writing to memory cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        });
        let direction = match wire.direction {
            Direction::ToDevice => "to_device",
            Direction::ToHost => "to_host",
        };
        vec![wire.host_us.to_string(), direction.to_owned(), hexadecimal]
    };
    (strings(&["host_us", "direction", "bytes_hex"]), capture.wire.iter().map(row).collect())
}

fn ticks(capture: &Capture) -> Rows {
    let channels = capture.ticks.first().map_or(0, |tick| tick.codes.len().saturating_sub(1));
    let mut header =
        strings(&["device_us", "stop_pressed", "supply_open", "pump_duty_255", "output_bits", "supply_code"]);
    for channel in 0..channels {
        header.extend(["code", "fill_us", "vent_us"].map(|name| format!("channel_{channel}_{name}")));
    }
    let row = |tick: &crate::record::DeviceTick| {
        let mut cells = vec![
            tick.device_us.to_string(),
            u8::from(tick.stop_pressed).to_string(),
            u8::from(tick.supply_open).to_string(),
            tick.pump_duty.to_string(),
            tick.outputs.to_string(),
            tick.codes.last().map_or_else(String::new, u16::to_string),
        ];
        for channel in 0..channels {
            let pulse = tick.pulses.iter().find(|pulse| usize::from(pulse.channel) == channel);
            cells.push(tick.codes.get(channel).map_or_else(String::new, u16::to_string));
            cells.push(pulse.map_or(0, |pulse| pulse.fill_us).to_string());
            cells.push(pulse.map_or(0, |pulse| pulse.vent_us).to_string());
        }
        cells
    };
    (header, capture.ticks.iter().map(row).collect())
}

/// The whole log, to be serialized.
#[derive(Debug, Serialize)]
pub struct WholeLog<'a> {
    /// The run: data known before it, samples, faults, shapes, link counters.
    #[serde(flatten)]
    pub run: &'a RunLog,
    /// Bytes of the link and control ticks.
    #[serde(flatten)]
    pub capture: &'a Capture,
}
