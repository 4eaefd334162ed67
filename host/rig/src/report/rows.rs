//! The summary as words and numbers in the units that people read: one place, so that
//! terminal and page say the same.

use super::stats::ErrorStats;
use super::{ModuleSummary, Summary};
use crate::record::{ContactRecord, FaultRecord, InjectedFault, RunLog, Sample, TargetRecord};

/// Shown where nothing was observed.
const ABSENT: &str = "-";

/// One module, ready to be printed.
pub(super) struct ModuleRow {
    pub(super) name: String,
    pub(super) motion: String,
    pub(super) channels: String,
    pub(super) quantity: String,
    pub(super) setpoint: String,
    /// Final value of the kind that [`module_value`] names; its error follows.
    pub(super) value: String,
    pub(super) rmse: String,
    pub(super) max: String,
}

/// One error, ready to be printed.
pub(super) struct ErrorRow {
    pub(super) name: &'static str,
    pub(super) rmse: String,
    pub(super) max: String,
}

/// A name and a value.
pub(super) struct Fact {
    pub(super) name: &'static str,
    pub(super) value: String,
}

/// The value of a module beside its setpoint: where nobody saw the limb, the model's at the measured pressures.
pub(super) fn module_value(summary: &Summary) -> &'static str {
    if summary.is_observed() { "achieved" } else { "modelled" }
}

/// One row per module.
pub(super) fn modules(summary: &Summary) -> Vec<ModuleRow> {
    summary.modules.iter().map(|info| module(info, summary.is_observed())).collect()
}

fn module(module: &ModuleSummary, is_observed: bool) -> ModuleRow {
    let (value, error) = match is_observed {
        true => (module.achieved_final, module.error),
        false => (module.modelled_final, module.tracking_error),
    };
    let quantity = module.quantity;
    let show = |value: Option<f64>| show(value, quantity.display_scale(), quantity.display_decimals());
    ModuleRow {
        name: module.name.clone(),
        motion: module.motion.clone(),
        channels: range(&module.channels),
        quantity: with_unit(quantity.label(), quantity.display_unit()),
        setpoint: show(module.setpoint_final),
        value: show(value),
        rmse: show(error.map(|error| error.rmse)),
        max: show(error.map(|error| error.max)),
    }
}

/// The errors of tip and pressure.
pub(super) fn errors(summary: &Summary) -> Vec<ErrorRow> {
    let row = |name, error: Option<ErrorStats>, scale| ErrorRow {
        name,
        rmse: show(error.map(|error| error.rmse), scale, 2),
        max: show(error.map(|error| error.max), scale, 2),
    };
    // Not every run has holds, or a plane.
    let tip = &summary.tip;
    let at_holds = tip.at_holds_m.map(|error| row("tip position at the ends of holds, mm", Some(error), 1e3));
    let across = tip.across_m.map(|error| row("tip position across the plane of the plan, mm", Some(error), 1e3));
    let seen = |row: ErrorRow| summary.is_observed().then_some(row);
    let mut rows = Vec::from_iter(seen(row("tip position, mm", tip.error_m, 1e3)));
    let tracking = tip.tracking_error_m;
    rows.extend(tracking.map(|error| row("tip position by pressure tracking alone, mm", Some(error), 1e3)));
    rows.extend(across.into_iter().chain(at_holds));
    rows.push(row("pressure, sensor - reference, kPa", summary.pressure.measured_error_pa, 1e-3));
    rows.extend(seen(row("pressure, chamber - reference, kPa", summary.pressure.true_error_pa, 1e-3)));
    rows
}

/// Run time, and speed where the wall-clock time is known.
pub(super) fn time(summary: &Summary) -> String {
    let samples = format!("{:.1} s, {} samples", summary.duration_s, summary.samples);
    match (summary.wall_s, summary.real_time_factor) {
        (Some(wall_s), Some(factor)) => format!("{samples}; took {wall_s:.2} s, real-time factor {factor:.1}"),
        _ => samples,
    }
}

/// Counters of the link.
pub(super) fn link(summary: &Summary) -> Vec<Fact> {
    let link = &summary.link;
    let fact = |name, value: u64| Fact { name, value: value.to_string() };
    let mut facts = vec![
        fact("frames sent", link.frames_sent),
        fact("frames received", link.frames_received),
        fact("bytes sent", link.bytes_sent),
        fact("bytes received", link.bytes_received),
        fact("retransmitted", link.retransmitted),
        fact("checksum errors", link.crc_errors),
        fact("telemetry lost", link.telemetry_lost),
    ];
    facts.extend(link.port_errors.map(|errors| Fact { name: "port of the device", value: errors.to_string() }));
    facts
}

/// A fault as one line.
pub(super) fn fault(fault: &FaultRecord) -> String {
    let place = match fault.channel {
        0xFF => "system".to_owned(),
        channel => format!("channel {channel}"),
    };
    format!("{:.3} s, {place}: {} (code {}, value {})", fault.time_s, fault.text, fault.code, fault.value)
}

/// A fault that the run met on purpose, as one line.
pub(super) fn injected(fault: &InjectedFault) -> String {
    let place = fault.channel.map_or(String::new(), |channel| format!(", channel {channel}"));
    format!("{:.3} s{place}: {}", fault.time_s, fault.name)
}

/// One target of a limb moved by hand.
pub(super) struct TargetRow {
    pub(super) name: String,
    pub(super) time: String,
    pub(super) least: String,
    pub(super) held: String,
}

/// How the targets were met by hand.
pub(super) fn targets(log: &RunLog) -> Vec<TargetRow> {
    let row = |target: &TargetRecord| TargetRow {
        name: target.name.clone(),
        time: target.time_s.map_or_else(|| "not met".to_owned(), |time_s| format!("{time_s:.1}")),
        least: target.least_m.map_or_else(|| "never seen".to_owned(), |least_m| format!("{:.1}", 1e3 * least_m)),
        held: format!("{:.1}", target.held_s),
    };
    log.targets.iter().map(row).collect()
}

/// The chamber that came nearest to its limit, or went furthest beyond it; `None` on a device.
pub(super) fn peak(summary: &Summary) -> Option<String> {
    let limits = summary.pressure_limit_pa.as_ref()?;
    let chambers = summary.peak_chamber_pa.iter().zip(limits).enumerate();
    let (channel, (peak_pa, limit_pa)) = chambers.max_by(|a, b| (a.1.0 - a.1.1).total_cmp(&(b.1.0 - b.1.1)))?;
    Some(format!("{:.1} kPa in channel {channel}, whose limit is {:.1} kPa", peak_pa * 1e-3, limit_pa * 1e-3))
}

/// An obstacle that stopped the limb.
pub(super) fn contact(contact: &ContactRecord) -> String {
    let ContactRecord { obstacle, force_n, time_s, first_s, carried } = contact;
    let what = if *carried { " of the object" } else { "" };
    format!("{what} with {obstacle} from {first_s:.2} s on, at most {force_n:.1} N at {time_s:.2} s")
        .trim_start()
        .to_owned()
}

/// Device states in order, each with the time from which it held.
pub(super) fn states(log: &RunLog) -> Vec<String> {
    let changes = log.samples.chunk_by(|a, b| a.state == b.state);
    let starts = changes.filter_map(|samples| samples.first());
    starts.map(|sample| format!("{} from {:.3} s", state_name(sample.state), sample.time_s)).collect()
}

/// What the gripper was told in order, each with the time from which it was; nothing where it was never told to close.
pub(super) fn gripper(log: &RunLog) -> Vec<String> {
    const GRIPPER: u8 = 1;
    let is_on = |sample: &Sample| sample.outputs.bits & GRIPPER != 0;
    if !log.samples.iter().any(is_on) {
        return Vec::new();
    }
    let changes = log.samples.chunk_by(|a, b| is_on(a) == is_on(b));
    let starts = changes.filter_map(|samples| samples.first());
    let words = |sample: &Sample| if is_on(sample) { "told to close" } else { "told to open" };
    starts.map(|sample| format!("{} from {:.3} s", words(sample), sample.time_s)).collect()
}

/// Name of a device state, as the wire interface numbers them.
pub(super) fn state_name(state: u8) -> &'static str {
    match state {
        0 => "idle",
        1 => "ready",
        2 => "running",
        3 => "holding",
        4 => "venting",
        5 => "faulted",
        _ => "unknown",
    }
}

/// A label with its unit, as on an axis.
pub(super) fn with_unit(label: &str, unit: &str) -> String {
    match unit {
        "" => label.to_owned(),
        unit => format!("{label}, {unit}"),
    }
}

/// Channels as "0-2", as "4" or as nothing.
fn range(channels: &std::ops::Range<usize>) -> String {
    match channels.len() {
        0 => ABSENT.to_owned(),
        1 => channels.start.to_string(),
        _ => format!("{}-{}", channels.start, channels.end - 1),
    }
}

/// A number that keeps its column: absent as a dash, huge in powers of ten.
fn show(value: Option<f64>, scale: f64, decimals: usize) -> String {
    match value.map(|value| value * scale) {
        Some(value) if !value.is_finite() => ABSENT.to_owned(),
        Some(value) if value.abs() >= 1e5 => format!("{value:.2e}"),
        // Adding zero turns the -0.00 of a tiny negative number into 0.00.
        Some(value) => {
            let unit = 10_f64.powi(decimals as i32);
            format!("{:.decimals$}", (value * unit).round() / unit + 0.0)
        }
        None => ABSENT.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_column() {
        assert_eq!(show(Some(0.012_345_6), 1e3, 3), "12.346");
        assert_eq!(show(Some(-1e-9), 1.0, 2), "0.00");
        assert_eq!(show(Some(1.5e9), 1.0, 2), "1.50e9");
        assert_eq!(show(Some(f64::NAN), 1.0, 2), "-");
        assert_eq!(show(None, 1.0, 2), "-");
    }

    #[test]
    fn channels_read_as_people_write_them() {
        assert_eq!([range(&(0..3)), range(&(4..5)), range(&(0..0))], ["0-2", "4", "-"]);
    }
}
