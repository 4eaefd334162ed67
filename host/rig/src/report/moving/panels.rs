//! The plots of the page: which quantities stand in which panel, and the numbers behind them.

use serde::Serialize;

use super::columns::Table;
use crate::record::{Body, ChannelSample, ModuleInfo, ModuleSample, RunLog, Sample};
use crate::report::causes;
use crate::report::rows::with_unit;
use crate::report::summary::is_scheduled;
use softlimb_chart::labelled;
use softlimb_numerics::statistics::root_mean_square;

/// Channels of a panel: four colors that every color vision tells apart.
const CHANNELS: usize = 4;
/// Distance of two values in the page: pressures have that of the wire.
const KPA: f64 = 0.01;
const MM: f64 = 0.02;
const SECONDS: f64 = 1e-4;
/// Width of the uppermost line of several, their difference in width, and that of a setpoint from its line, px.
const LINE_PX: f64 = 1.75;
const STEP_PX: f64 = 2.0;
/// Largest difference in width of such lines, px.
const STEPS_MOST_PX: f64 = 6.0;
const BAND_PX: f64 = 4.0;
/// Distance from an obstacle beyond which a plot need not show it, mm.
const FAR_MM: f64 = 100.0;

/// A quantity of a panel.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Trace {
    name: String,
    /// Table and column of its values; the times are the first column.
    table: &'static str,
    column: String,
    /// `line`, `setpoint` (a pale band), `planned` (dashed), `required` (dotted).
    style: &'static str,
    /// Index of its color.
    color: usize,
    /// Width of its line, px; absent for that of its style.
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
}

/// Quantities over one axis.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Panel {
    /// Heading of the section that it is in.
    section: &'static str,
    title: String,
    /// Label of the axis with its unit.
    axis: String,
    from_zero: bool,
    /// Upper end of the axis, beyond which values are cut off.
    #[serde(skip_serializing_if = "Option::is_none")]
    most: Option<f64>,
    traces: Vec<Trace>,
}

/// The tables of a page, and its panels.
#[derive(Debug, Clone)]
pub(super) struct Plots {
    pub(super) samples: Table,
    pub(super) bodies: Table,
    pub(super) planned: Table,
    pub(super) panels: Vec<Panel>,
}

/// A table under its name with the log that it is of.
struct Filled<'a> {
    log: &'a RunLog,
    plots: Plots,
}

/// Everything that the page plots.
pub(super) fn plots(log: &RunLog) -> Plots {
    let planned = log.info.phases.iter().filter(|phase| phase.nearest.is_some()).count();
    let plots = Plots {
        samples: Table::new(log.samples.len()),
        bodies: Table::new(log.bodies.len()),
        planned: Table::new(3 * planned),
        panels: Vec::new(),
    };
    let mut filled = Filled { log, plots };
    filled.sample("t", SECONDS, |sample| sample.time_s);
    filled.body("t", SECONDS, |body| body.time_s);
    filled.planned();
    filled.tip();
    filled.clearance();
    filled.deformations();
    filled.pressures();
    filled.air();
    filled.plots
}

impl Filled<'_> {
    fn sample(&mut self, name: impl Into<String>, step: f64, value: impl Fn(&Sample) -> f64) {
        self.plots.samples.add(name, step, self.log.samples.iter().map(value));
    }

    fn body(&mut self, name: impl Into<String>, step: f64, value: impl Fn(&Body) -> f64) {
        self.plots.bodies.add(name, step, self.log.bodies.iter().map(value));
    }

    /// Adds a panel of the traces that have something to show.
    fn panel(&mut self, section: &'static str, title: &str, axis: String, from_zero: bool, traces: Vec<Trace>) {
        let title = labelled(title, self.log.info.weightless);
        self.plots.panels.push(Panel { section, title, axis, from_zero, most: None, traces });
    }

    fn tip(&mut self) {
        let log = self.log;
        let scheduled = |time_s: f64, value: f64| if is_scheduled(&log.info, time_s) { value } else { f64::NAN };
        let of = |sample: &Sample, value: fn(&causes::Causes) -> Option<f64>| {
            scheduled(sample.time_s, value(&causes::at(sample, None)).map_or(f64::NAN, |part| part * 1e3))
        };
        let seen = log.samples.iter().any(|sample| sample.tip_achieved_m.is_some());
        let sags = log.bodies.iter().any(|body| body.tip_unloaded_m.is_some());
        let mut traces = Vec::new();
        let splits = !log.info.is_corrected();
        if splits {
            self.sample("by_pressure", MM, move |sample| of(sample, |parts| parts.pressure_m));
            traces.push(sample_trace("pressure", "by_pressure", "line", 1));
        }
        if splits && sags {
            let of_body = |body: &Body, value: fn(&causes::Causes) -> Option<f64>| {
                let nearest = nearest_sample(log, body.time_s);
                let parts = nearest.map(|sample| causes::at(sample, Some(body)));
                scheduled(body.time_s, parts.and_then(|parts| value(&parts)).map_or(f64::NAN, |part| part * 1e3))
            };
            self.body("by_model", MM, |body| of_body(body, |parts| parts.model_m));
            self.body("by_sag", MM, |body| of_body(body, |parts| parts.sag_m));
            traces.push(body_trace("model", "by_model", "line", 2));
            traces.push(body_trace("sag", "by_sag", "line", 3));
        } else if splits && seen {
            self.sample("by_model", MM, move |sample| of(sample, |parts| parts.model_m));
            traces.push(sample_trace("model", "by_model", "line", 2));
        }
        if seen {
            self.sample("error", MM, move |sample| of(sample, |parts| parts.total_m));
            traces.push(sample_trace("error", "error", "line", 0));
        }
        let title = if splits { "Tip error and its causes" } else { "Tip error" };
        self.panel("Error of the tip", title, "distance, mm".into(), true, traces);
    }

    fn clearance(&mut self) {
        let seen = self.log.bodies.iter().any(|body| body.nearest.is_some());
        let mut traces = Vec::new();
        if self.plots.planned.rows > 0 {
            traces.push(trace("planned", "planned", "clearance", "planned", 2));
        }
        if seen {
            let clearance = |body: &Body| body.nearest.as_ref().map_or(f64::NAN, |(distance_m, _)| distance_m * 1e3);
            self.body("clearance", MM, clearance);
            traces.push(body_trace("achieved", "clearance", "line", 0));
        }
        if !traces.is_empty() {
            if let Some(required_m) = self.log.info.clearance_m {
                let required_mm = 1e3 * required_m;
                if seen {
                    self.body("required", MM, move |_| required_mm);
                } else {
                    let rows = self.plots.planned.rows;
                    self.plots.planned.add("required", MM, std::iter::repeat_n(required_mm, rows));
                }
                traces.push(trace("required", if seen { "bodies" } else { "planned" }, "required", "required", 1));
            }
            let planned = if self.plots.planned.rows > 0 { "; planned: least of each phase" } else { "" };
            let axis = format!("surface to surface, mm{planned}");
            self.panel("Clearance", "Distance from the nearest obstacle", axis, true, traces);
            let levels_m = self.log.info.phases.iter().filter_map(|phase| Some(phase.nearest.as_ref()?.distance_m));
            let most_mm = levels_m.map(|level_m| 1.2e3 * level_m).filter(|most_mm| most_mm.is_finite());
            let most_mm = most_mm.fold(FAR_MM, f64::max);
            self.plots.panels.last_mut().into_iter().for_each(|panel| panel.most = Some(most_mm));
        }
    }

    /// The least clearance of the plan in each phase: a level from its start to its end.
    fn planned(&mut self) {
        let phases = self.log.info.phases.iter();
        let levels: Vec<_> = phases.filter_map(|phase| Some((phase, phase.nearest.as_ref()?.distance_m))).collect();
        let times = levels.iter().flat_map(|(phase, _)| [phase.start_s, phase.end_s(), phase.end_s()]);
        self.plots.planned.add("t", SECONDS, times);
        let heights = levels.iter().flat_map(|(_, level_m)| [level_m * 1e3, level_m * 1e3, f64::NAN]);
        self.plots.planned.add("clearance", MM, heights);
    }

    fn deformations(&mut self) {
        let log = self.log;
        for (index, module) in log.info.modules.iter().enumerate() {
            let quantity = module.quantity;
            let (scale, step) = (quantity.display_scale(), 0.1_f64.powi(quantity.display_decimals() as i32 + 1));
            let value = |value: fn(&ModuleSample) -> f64| {
                move |sample: &Sample| sample.modules.get(index).map_or(f64::NAN, value) * scale
            };
            let setpoint = value(|module| module.setpoint);
            let scheduled = move |sample: &Sample| {
                if is_scheduled(&log.info, sample.time_s) { setpoint(sample) } else { f64::NAN }
            };
            let [set, modelled, achieved] = ["set", "modelled", "achieved"].map(|name| format!("{name}_{index}"));
            self.sample(&set, step, scheduled);
            self.sample(&modelled, step, value(|module| module.modelled));
            let mut traces =
                vec![sample_trace("setpoint", &set, "setpoint", 0), sample_trace("modelled", &modelled, "line", 1)];
            let seen = |sample: &Sample| sample.modules.get(index).is_some_and(|module| module.achieved.is_some());
            if log.samples.iter().any(seen) {
                self.sample(&achieved, step, value(|module| module.achieved.unwrap_or(f64::NAN)));
                traces.push(sample_trace("achieved", &achieved, "line", 0));
            }
            let axis = with_unit(quantity.label(), quantity.display_unit());
            let title = format!("{}: {}", module.name, module.motion);
            self.panel("Deformation of the modules", &title, axis, false, traces);
        }
    }

    fn pressures(&mut self) {
        for channel in 0..self.log.info.channel_count() {
            let value = |value: fn(&ChannelSample) -> f64| {
                move |sample: &Sample| sample.channels.get(channel).map_or(f64::NAN, value) * 1e-3
            };
            self.sample(format!("pressure_{channel}"), KPA, value(|channel| channel.pressure_pa));
            self.sample(format!("reference_{channel}"), KPA, value(|channel| channel.reference_pa));
        }
        let of_module = |module: &ModuleInfo| {
            let channels: Vec<usize> = module.channels.clone().collect();
            channels.chunks(CHANNELS).map(|channels| (module.name.clone(), channels.to_vec())).collect::<Vec<_>>()
        };
        let groups: Vec<_> = self.log.info.modules.iter().flat_map(of_module).collect();
        for (module, channels) in groups {
            let count = channels.len();
            let of_style = |style: &'static str, column: &'static str| {
                let trace = move |(color, channel): (usize, &usize)| {
                    let name = if style == "line" { format!("ch {channel}") } else { format!("ch {channel} set") };
                    let width = nested_px(color, count) + if style == "line" { 0.0 } else { BAND_PX };
                    let width = Some(width);
                    Trace { width, ..sample_trace(&name, &format!("{column}_{channel}"), style, color) }
                };
                channels.iter().enumerate().map(trace).collect::<Vec<_>>()
            };
            let traces = [of_style("setpoint", "reference"), of_style("line", "pressure")].concat();
            let title = match channels[..] {
                [first, .., last] => format!("{module}: channels {first} to {last}"),
                _ => format!("{module}: channel {}", channels[0]),
            };
            self.panel("Pressures", &title, "gauge pressure, kPa".into(), false, traces);
        }
    }

    fn air(&mut self) {
        let rms = |error: fn(&ChannelSample) -> f64| {
            move |sample: &Sample| root_mean_square(sample.channels.iter().map(error)).unwrap_or(f64::NAN) * 1e-3
        };
        self.sample("by_sensor", KPA, rms(|channel| channel.pressure_pa - channel.reference_pa));
        let mut traces = vec![sample_trace("sensor", "by_sensor", "line", 1)];
        let seen = |sample: &Sample| sample.channels.iter().any(|channel| channel.true_pressure_pa.is_some());
        if self.log.samples.iter().any(seen) {
            let chamber = |channel: &ChannelSample| channel.true_pressure_pa.unwrap_or(f64::NAN) - channel.reference_pa;
            self.sample("by_chamber", KPA, rms(chamber));
            traces.push(sample_trace("chamber", "by_chamber", "line", 0));
        }
        let section = "Air";
        self.panel(section, "Pressure from its reference, all channels", "RMS, kPa".into(), true, traces);
        self.sample("supply", KPA, |sample| sample.supply_pa * 1e-3);
        let supply = vec![sample_trace("supply", "supply", "line", 0)];
        self.panel(section, "Supply", "gauge pressure, kPa".into(), true, supply);
    }
}

/// Width of a line of several that may lie on each other, px: each leaves the edges of those below it in sight.
fn nested_px(index: usize, count: usize) -> f64 {
    LINE_PX + STEP_PX.min(STEPS_MOST_PX / (count.max(2) - 1) as f64) * (count - 1 - index) as f64
}

/// The sample at a time, or the last before it.
fn nearest_sample(log: &RunLog, time_s: f64) -> Option<&Sample> {
    let after = log.samples.partition_point(|sample| sample.time_s <= time_s + 1e-9);
    log.samples.get(after.checked_sub(1)?)
}

fn trace(name: &str, table: &'static str, column: &str, style: &'static str, color: usize) -> Trace {
    Trace { name: name.to_owned(), table, column: column.to_owned(), style, color, width: None }
}

fn sample_trace(name: &str, column: &str, style: &'static str, color: usize) -> Trace {
    trace(name, "samples", column, style, color)
}

fn body_trace(name: &str, column: &str, style: &'static str, color: usize) -> Trace {
    trace(name, "bodies", column, style, color)
}
