//! Exports a log as tables, one or two for each topic, and as JSON.

use std::fmt::Write;

use serde::Serialize;
use softlimb_files::table::written;

use crate::record::{Body, Capture, DeviceTick, Direction, ModuleInfo, ModuleSample, RunLog, Sample, SampleRow};

/// A table of a topic.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of the topic without `/softlimb/`. A topic with lists has a second table for them.
    pub name: &'static str,
    /// Columns of one length.
    pub columns: Vec<Column>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name, which ends with the unit.
    pub name: String,
    /// Values.
    pub values: Values,
}

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; not a number where a value is not known.
    Number(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Words.
    Text(Vec<String>),
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Number(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A value that reads back exactly; empty for one that is not known.
    fn cell(&self, row: usize) -> String {
        match self {
            Self::Number(values) if values[row].is_nan() => String::new(),
            Self::Number(values) => values[row].to_string(),
            Self::Whole(values) => values[row].to_string(),
            Self::Text(values) => values[row].clone(),
        }
    }
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Comma-separated values under the names of the columns. A cell is empty where a value is not known.
    pub fn csv(&self) -> String {
        let header: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
        written(&header, (0..self.rows()).map(|row| self.columns.iter().map(move |column| column.values.cell(row))))
    }
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
        ("body", body(log)),
        ("body_line", body_line(log)),
        ("samples", samples(capture)),
        ("wire", wire(capture)),
        ("ticks", ticks(capture)),
    ];
    let tables = tables.into_iter().map(|(name, columns)| Table { name, columns });
    tables.filter(|table| table.rows() > 0).collect()
}

fn numbers(name: impl Into<String>, values: impl Iterator<Item = f64>) -> Column {
    Column { name: name.into(), values: Values::Number(values.collect()) }
}

fn whole(name: impl Into<String>, values: impl Iterator<Item = impl Into<i64>>) -> Column {
    Column { name: name.into(), values: Values::Whole(values.map(Into::into).collect()) }
}

/// Times of a clock, which stay below the largest `i64` for 292 000 years.
fn clock(name: &str, values: impl Iterator<Item = u64>) -> Column {
    whole(name, values.map(u64::cast_signed))
}

fn words(name: &str, values: impl Iterator<Item = String>) -> Column {
    Column { name: name.to_owned(), values: Values::Text(values.collect()) }
}

fn known(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

/// The three columns of a point.
fn point<'a, T: 'a>(name: &str, rows: &[&'a T], at: impl Fn(&'a T) -> Option<[f64; 3]>) -> [Column; 3] {
    [0, 1, 2].map(|axis| {
        let named = format!("{name}{}_m", ["x", "y", "z"][axis]);
        numbers(named, rows.iter().map(|row| at(row).map_or(f64::NAN, |point| point[axis])))
    })
}

fn telemetry(log: &RunLog) -> Vec<Column> {
    let samples = &log.samples;
    let mut columns = vec![
        numbers("time_s", samples.iter().map(|sample| sample.time_s)),
        whole("state", samples.iter().map(|sample| sample.state)),
        whole("fault_bits", samples.iter().map(|sample| sample.fault_bits)),
        numbers("supply_pa", samples.iter().map(|sample| sample.supply_pa)),
        numbers("valve_supply_v", samples.iter().map(|sample| known(sample.valve_supply_v))),
        whole("output_bits", samples.iter().map(|sample| sample.outputs.bits)),
    ];
    for index in 0..log.info.channel_count() {
        let name = |quantity: &str| format!("channel_{index}_{quantity}");
        let channels = || samples.iter().map(|sample| &sample.channels[index]);
        columns.extend([
            numbers(name("pressure_pa"), channels().map(|channel| channel.pressure_pa)),
            numbers(name("reference_pa"), channels().map(|channel| channel.reference_pa)),
            numbers(name("duty"), channels().map(|channel| channel.duty)),
            whole(name("status"), channels().map(|channel| channel.status)),
        ]);
    }
    columns
}

/// Name of a module's column: the module, its quantity and the unit.
fn column_name(module: &ModuleInfo) -> String {
    let (name, quantity) = (module.name.replace(' ', "_"), module.quantity.name());
    match module.quantity.si_unit() {
        "1" => format!("{name}_{quantity}"),
        unit => format!("{name}_{quantity}_{}", unit.to_lowercase()),
    }
}

fn deformation(
    log: &RunLog,
    tip: &str,
    value: impl Fn(&ModuleSample) -> Option<f64>,
    tip_m: impl Fn(&Sample) -> Option<[f64; 3]>,
) -> Vec<Column> {
    deformations(log, &log.samples.iter().collect::<Vec<_>>(), tip, value, tip_m)
}

fn deformations(
    log: &RunLog,
    samples: &[&Sample],
    tip: &str,
    value: impl Fn(&ModuleSample) -> Option<f64>,
    tip_m: impl Fn(&Sample) -> Option<[f64; 3]>,
) -> Vec<Column> {
    let mut columns = vec![numbers("time_s", samples.iter().map(|sample| sample.time_s))];
    columns.extend(log.info.modules.iter().enumerate().map(|(index, module)| {
        numbers(column_name(module), samples.iter().map(|sample| known(value(&sample.modules[index]))))
    }));
    columns.extend(point(&format!("{tip}_"), samples, tip_m));
    columns
}

fn truth(log: &RunLog) -> Vec<Column> {
    let seen = log.samples.iter().filter(|sample| {
        sample.tip_achieved_m.is_some() || sample.channels.iter().any(|channel| channel.true_pressure_pa.is_some())
    });
    let seen: Vec<&Sample> = seen.collect();
    let mut columns = deformations(log, &seen, "tip_achieved", |module| module.achieved, |s| s.tip_achieved_m);
    columns.extend((0..log.info.channel_count()).map(|index| {
        let pressures = seen.iter().map(|sample| known(sample.channels[index].true_pressure_pa));
        numbers(format!("channel_{index}_chamber_pressure_pa"), pressures)
    }));
    columns.push(numbers("gripper_closure", seen.iter().map(|sample| known(sample.outputs.gripper_closure))));
    columns
}

fn fault(log: &RunLog) -> Vec<Column> {
    let faults = &log.faults;
    vec![
        numbers("time_s", faults.iter().map(|fault| fault.time_s)),
        whole("channel", faults.iter().map(|fault| fault.channel)),
        whole("code", faults.iter().map(|fault| fault.code)),
        whole("value", faults.iter().map(|fault| fault.value)),
        words("text", faults.iter().map(|fault| fault.text.clone())),
    ]
}

/// A point of a backbone: time, line, index, place.
type ShapePoint = (f64, &'static str, u32, [f64; 3]);

/// One row a point of a backbone.
fn shape(log: &RunLog) -> Vec<Column> {
    let mut rows: Vec<ShapePoint> = Vec::new();
    for shape in &log.shapes {
        for (line, points) in [("setpoint", Some(&shape.setpoint)), ("achieved", shape.achieved.as_ref())] {
            let points = (0..).zip(points.into_iter().flatten());
            rows.extend(points.map(|(index, at)| (shape.time_s, line, index, *at)));
        }
    }
    let mut columns = vec![
        numbers("time_s", rows.iter().map(|row| row.0)),
        words("line", rows.iter().map(|row| row.1.to_owned())),
        whole("point", rows.iter().map(|row| row.2)),
    ];
    columns.extend(point("", &rows.iter().collect::<Vec<_>>(), |row| Some(row.3)));
    columns
}

/// One row a look at the limb.
fn body(log: &RunLog) -> Vec<Column> {
    let bodies = &log.bodies;
    let name = |nearest: &Option<(f64, String)>| nearest.as_ref().map_or_else(String::new, |(_, name)| name.clone());
    let mut columns = vec![
        numbers("time_s", bodies.iter().map(|body| body.time_s)),
        numbers("clearance_m", bodies.iter().map(|body| known(body.nearest.as_ref().map(|nearest| nearest.0)))),
        words("nearest", bodies.iter().map(|body| name(&body.nearest))),
    ];
    columns.extend(point("tip_unloaded_", &bodies.iter().collect::<Vec<_>>(), |body| body.tip_unloaded_m));
    columns
}

/// One row a point of the center line.
fn body_line(log: &RunLog) -> Vec<Column> {
    let of = |body: &'_ Body| {
        let points = body.line_m.iter().copied().zip(body.radius_m.iter().copied());
        let time_s = body.time_s;
        (0_u32..).zip(points).map(move |(index, (at, radius_m))| (time_s, index, at, radius_m)).collect::<Vec<_>>()
    };
    let rows: Vec<_> = log.bodies.iter().flat_map(of).collect();
    let mut columns =
        vec![numbers("time_s", rows.iter().map(|row| row.0)), whole("point", rows.iter().map(|row| row.1))];
    columns.extend(point("", &rows.iter().collect::<Vec<_>>(), |row| Some(row.2)));
    columns.push(numbers("radius_m", rows.iter().map(|row| row.3)));
    columns
}

/// One row a measurement.
fn samples(capture: &Capture) -> Vec<Column> {
    let of = |row: &'_ SampleRow| {
        let each = row.states.iter().zip(row.channels.clone()).enumerate();
        let (time_s, period_s, left_out) = (row.time_s, row.period_s, row.left_out);
        let each =
            each.map(move |(index, (state, channels))| (time_s + index as f64 * period_s, *state, left_out, channels));
        each.collect::<Vec<_>>()
    };
    let rows: Vec<_> = capture.samples.iter().flat_map(of).collect();
    let mut columns = vec![
        numbers("time_s", rows.iter().map(|row| row.0)),
        whole("state", rows.iter().map(|row| row.1)),
        whole("left_out", rows.iter().map(|row| row.2)),
    ];
    for index in 0..rows.first().map_or(0, |row| row.3.len()) {
        let value = |of: fn(&(f64, f64)) -> f64| rows.iter().map(move |row| known(row.3.get(index).map(of)));
        columns.push(numbers(format!("channel_{index}_pressure_pa"), value(|value| value.0)));
        columns.push(numbers(format!("channel_{index}_duty"), value(|value| value.1)));
    }
    columns
}

fn wire(capture: &Capture) -> Vec<Column> {
    let direction = |direction: &Direction| match direction {
        Direction::ToDevice => "to_device".to_owned(),
        Direction::ToHost => "to_host".to_owned(),
    };
    let hexadecimal = |bytes: &[u8]| {
        bytes.iter().fold(String::new(), |mut text, byte| {
            // Writing to memory cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
    };
    let wire = &capture.wire;
    vec![
        clock("host_us", wire.iter().map(|wire| wire.host_us)),
        words("direction", wire.iter().map(|wire| direction(&wire.direction))),
        words("bytes_hex", wire.iter().map(|wire| hexadecimal(&wire.bytes))),
    ]
}

fn ticks(capture: &Capture) -> Vec<Column> {
    let ticks = &capture.ticks;
    let channels = ticks.first().map_or(0, |tick| tick.codes.len().saturating_sub(1));
    let code = |code: Option<&u16>| code.map_or(f64::NAN, |code| f64::from(*code));
    let mut columns = vec![
        clock("device_us", ticks.iter().map(|tick| tick.device_us)),
        whole("stop_pressed", ticks.iter().map(|tick| tick.stop_pressed)),
        whole("supply_open", ticks.iter().map(|tick| tick.supply_open)),
        whole("pump_duty_255", ticks.iter().map(|tick| tick.pump_duty)),
        whole("output_bits", ticks.iter().map(|tick| tick.outputs)),
        numbers("supply_code", ticks.iter().map(|tick| code(tick.codes.last()))),
        whole("valve_supply_code", ticks.iter().map(|tick| tick.valve_supply_code)),
    ];
    for channel in 0..channels {
        let pulse = |tick: &DeviceTick| tick.pulses.iter().find(|pulse| usize::from(pulse.channel) == channel).copied();
        let name = |quantity: &str| format!("channel_{channel}_{quantity}");
        columns.extend([
            numbers(name("code"), ticks.iter().map(|tick| code(tick.codes.get(channel)))),
            whole(name("fill_us"), ticks.iter().map(|tick| pulse(tick).map_or(0, |pulse| pulse.fill_us))),
            whole(name("vent_us"), ticks.iter().map(|tick| pulse(tick).map_or(0, |pulse| pulse.vent_us))),
        ]);
    }
    columns
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
