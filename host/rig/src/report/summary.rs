//! The figures of merit of a run.

use super::stats::{ErrorStats, distance};
use crate::record::{
    ContactRecord, FaultRecord, InjectedFault, LinkSummary, ModuleInfo, ModuleSample, Observer, RunInfo, RunLog, Sample,
};
use fra_model::StateQuantity;
use serde::Serialize;
use std::ops::Range;

/// The figures of merit of a run. SI units throughout. In JSON a figure that nobody could observe is absent.
///
/// Errors are taken over the scheduled time, from the start of the first phase to the
/// end of the last, whatever the device made of it; a run without phases counts whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// True when the device and the limb were simulated.
    pub simulated: bool,
    /// True when the simulated limb carried neither its own weight nor a payload.
    pub weightless: bool,
    /// The simulated limb in words; absent where it is the planner's with perturbed parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Whether measurements of the limb corrected the setpoints.
    pub feedback: bool,
    /// Sensors of these measurements; absent without feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer: Option<Observer>,
    /// Whether the setpoints had the corrections of the scene.
    pub corrections: bool,
    /// Seed of everything random in a simulated run; absent on a device.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Time from the first sample to the last, s.
    pub duration_s: f64,
    /// Duration of the schedule, s; `None` without one.
    pub schedule_s: Option<f64>,
    /// Number of samples in the log.
    pub samples: usize,
    /// One entry per module, from the base to the tip.
    pub modules: Vec<ModuleSummary>,
    /// The tip.
    pub tip: TipSummary,
    /// All channels together.
    pub pressure: PressureSummary,
    /// Wall-clock time that the run took, s.
    pub wall_s: Option<f64>,
    /// Run time over wall-clock time.
    pub real_time_factor: Option<f64>,
    /// Faults that the device reported.
    pub faults: Vec<FaultRecord>,
    /// Faults that a simulated run met on purpose.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub injected_faults: Vec<InjectedFault>,
    /// Highest true gauge pressure of each channel's chamber, Pa.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub peak_chamber_pa: Vec<f64>,
    /// Gauge pressure above which the device vents the channel, Pa, one per channel; absent in logs of earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_limit_pa: Option<Vec<f64>>,
    /// Obstacles that stopped the simulated limb.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactRecord>,
    /// Modules that were not at their setpoint when a phase ended.
    pub misses: Vec<Miss>,
    /// Channels whose reference the device had to limit.
    pub limited_channels: Vec<usize>,
    /// Link counters.
    pub link: LinkSummary,
    /// Why the log ends before the run did.
    pub incomplete: Option<String>,
}

/// One module. Values are in [`unit`](Self::unit).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModuleSummary {
    /// Name in the scene.
    pub name: String,
    /// Motion in the field's word.
    pub motion: String,
    /// Measured quantity.
    #[serde(serialize_with = "crate::record::quantity_name::serialize")]
    pub quantity: StateQuantity,
    /// SI unit of the values; "1" for a ratio.
    pub unit: &'static str,
    /// Channels that drive the module.
    pub channels: Range<usize>,
    /// Setpoint at the end.
    pub setpoint_final: Option<f64>,
    /// Deformation that the model gives for the chamber pressure, at the end.
    pub modelled_final: Option<f64>,
    /// Deformation that happened, at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub achieved_final: Option<f64>,
    /// Achieved minus setpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorStats>,
    /// Modelled minus setpoint: the error by pressure tracking alone.
    pub tracking_error: Option<ErrorStats>,
    /// The module's channels.
    pub pressure: PressureSummary,
}

/// The tip of the limb. Errors are distances.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TipSummary {
    /// Distance from the setpoint at the end, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub final_error_m: Option<f64>,
    /// Achieved position from the setpoint, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_m: Option<ErrorStats>,
    /// Modelled position from the setpoint, m: the part that pressure tracking alone
    /// causes; the rest is the model's.
    pub tracking_error_m: Option<ErrorStats>,
    /// Achieved position from the setpoint at the ends of holds of 0.5 s or more, m: one value a hold, the mean of its last 0.2 s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_holds_m: Option<ErrorStats>,
    /// The part of the error across the plane that the planned limb stays in, m: what unequal actuators of a module do. `None` where it stays in
    /// none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub across_m: Option<ErrorStats>,
}

/// Pressure tracking of some channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PressureSummary {
    /// Sensor minus reference, Pa.
    pub measured_error_pa: Option<ErrorStats>,
    /// Chamber minus reference, Pa: with the error of the sensor in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub true_error_pa: Option<ErrorStats>,
}

/// A module whose pressures had not brought it to its setpoint when a phase ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Miss {
    /// Name of the module.
    pub module: String,
    /// Name of the phase.
    pub phase: String,
    /// Mean distance from the setpoint in the last 0.1 s of the hold, by the model at the measured pressure or as the limb was seen, whichever
    /// is less, as a share of the module's travel in the run. A module that stays at rest has no miss.
    pub share_of_travel: f64,
}

/// Misses below this share of the travel are tracking errors and not worth a warning.
const MISS_SHARE: f64 = 0.05;

/// Share of a setpoint below which its changes are rounding.
const AT_REST: f64 = 1e-9;

/// Time before the end of a hold over which a miss is a mean, s: a sensor beside a switching valve reads up to 12 kPa off for 5 ms.
const MISS_WINDOW_S: f64 = 0.1;

/// Bit of [`ChannelSample::status`](crate::record::ChannelSample) that says the reference was limited.
const REFERENCE_LIMITED: u8 = 1 << 1;

impl Summary {
    /// Whether somebody saw the limb itself: of a run on a device there are its own measurements alone.
    pub(super) fn is_observed(&self) -> bool {
        let seen = |module: &ModuleSummary| module.error.is_some() || module.pressure.true_error_pa.is_some();
        self.simulated || self.tip.error_m.is_some() || self.modules.iter().any(seen)
    }
}

/// Computes the figures of merit of a run.
pub fn summary(log: &RunLog) -> Summary {
    let counted = scheduled(log);
    let duration_s = match (log.samples.first(), log.samples.last()) {
        (Some(first), Some(last)) => last.time_s - first.time_s,
        _ => 0.0,
    };
    let modules = log.info.modules.iter().enumerate();
    Summary {
        scene: log.info.scene_name.clone(),
        simulated: log.info.simulated,
        weightless: log.info.weightless,
        truth: log.info.truth.clone(),
        feedback: log.info.feedback.is_some(),
        observer: log.info.feedback,
        corrections: log.info.corrections,
        seed: log.info.seed,
        duration_s,
        schedule_s: schedule(&log.info).map(|(start_s, end_s)| end_s - start_s),
        samples: log.samples.len(),
        modules: modules.map(|(index, info)| module(index, info, &counted)).collect(),
        tip: tip(log, &counted),
        pressure: pressure(0..log.info.channel_count(), &counted),
        wall_s: log.wall_s,
        real_time_factor: log.wall_s.filter(|wall_s| *wall_s > 0.0).map(|wall_s| duration_s / wall_s),
        faults: log.faults.clone(),
        injected_faults: log.info.injected_faults.clone(),
        peak_chamber_pa: log.peak_chamber_pa.clone(),
        pressure_limit_pa: pressure_limits(&log.info),
        contacts: log.contacts.clone(),
        misses: misses(&log.info, &counted),
        limited_channels: limited_channels(&counted),
        link: log.link,
        incomplete: log.incomplete.clone(),
    }
}

/// The samples that count: those while there is a setpoint to follow.
pub(super) fn scheduled(log: &RunLog) -> Vec<&Sample> {
    log.samples.iter().filter(|sample| is_scheduled(&log.info, sample.time_s)).collect()
}

/// Whether a time lies within the phases; before and after them the setpoint means nothing.
pub(super) fn is_scheduled(info: &RunInfo, time_s: f64) -> bool {
    let (start_s, end_s) = schedule(info).unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    // A microsecond, the resolution of the device's clock.
    (start_s - 1e-6..=end_s + 1e-6).contains(&time_s)
}

/// Start of the first phase and end of the last, s.
fn schedule(info: &RunInfo) -> Option<(f64, f64)> {
    Some((info.phases.first()?.start_s, info.phases.last()?.end_s()))
}

fn misses(info: &RunInfo, samples: &[&Sample]) -> Vec<Miss> {
    if info.is_corrected() {
        // Corrections may take model and limb away from a module's planned value, to bring the tip to the plan.
        return Vec::new();
    }
    let ends = info.phases.iter().filter_map(|phase| {
        let last = samples.iter().rposition(|sample| sample.time_s <= phase.end_s() + 1e-6)?;
        // A run that was stopped before has not missed this phase.
        if samples.last()?.time_s + 0.1 < phase.end_s() {
            return None;
        }
        let from_s = (phase.end_s() - MISS_WINDOW_S).max(phase.hold_start_s());
        let first = samples.partition_point(|sample| sample.time_s < from_s).min(last);
        Some((phase, &samples[first..=last]))
    });
    let ends: Vec<_> = ends.collect();
    let of_module = |(index, module): (usize, &ModuleInfo)| {
        let setpoints = samples.iter().filter_map(|sample| Some(sample.modules.get(index)?.setpoint));
        let (low, high) = setpoints.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let travel = high - low;
        // A module that stays at rest, where a run begins, has no travel to compare with.
        if travel <= AT_REST * high.abs() {
            return Vec::new();
        }
        let missed = ends.iter().filter_map(|(phase, window)| {
            let values: Vec<_> = window.iter().filter_map(|sample| sample.modules.get(index)).collect();
            let mean = |error: &dyn Fn(&ModuleSample) -> Option<f64>| -> Option<f64> {
                let errors = values.iter().map(|value| error(value)).collect::<Option<Vec<_>>>()?;
                (!errors.is_empty()).then(|| (errors.iter().sum::<f64>() / errors.len() as f64).abs())
            };
            let modelled = mean(&|value| Some(value.modelled - value.setpoint))?;
            // A limb that was seen at its setpoint has not missed it, whatever its model gives.
            let off = mean(&|value| Some(value.achieved? - value.setpoint)).map_or(modelled, |seen| seen.min(modelled));
            let share_of_travel = off / travel;
            let miss = Miss { module: module.name.clone(), phase: phase.name.clone(), share_of_travel };
            (share_of_travel > MISS_SHARE).then_some(miss)
        });
        missed.collect::<Vec<_>>()
    };
    info.modules.iter().enumerate().flat_map(of_module).collect()
}

fn pressure_limits(info: &RunInfo) -> Option<Vec<f64>> {
    let mut limits = vec![f64::NAN; info.channel_count()];
    for module in &info.modules {
        limits.get_mut(module.channels.clone())?.fill(module.pressure_limit_pa?);
    }
    limits.iter().all(|limit| limit.is_finite()).then_some(limits)
}

fn limited_channels(samples: &[&Sample]) -> Vec<usize> {
    let count = samples.first().map_or(0, |sample| sample.channels.len());
    let limited = |channel: &usize| {
        let statuses = samples.iter().filter_map(|sample| sample.channels.get(*channel));
        statuses.into_iter().any(|channel| channel.status & REFERENCE_LIMITED != 0)
    };
    (0..count).filter(limited).collect()
}

fn module(index: usize, info: &ModuleInfo, samples: &[&Sample]) -> ModuleSummary {
    let values = || samples.iter().filter_map(|sample| sample.modules.get(index));
    let last = values().next_back();
    ModuleSummary {
        name: info.name.clone(),
        motion: info.motion.clone(),
        quantity: info.quantity,
        unit: info.quantity.si_unit(),
        channels: info.channels.clone(),
        setpoint_final: last.map(|module| module.setpoint),
        modelled_final: last.map(|module| module.modelled),
        achieved_final: last.and_then(|module| module.achieved),
        error: ErrorStats::of(values().filter_map(|module| Some(module.achieved? - module.setpoint))),
        tracking_error: ErrorStats::of(values().map(|module| module.modelled - module.setpoint)),
        pressure: pressure(info.channels.clone(), samples),
    }
}

fn tip(log: &RunLog, samples: &[&Sample]) -> TipSummary {
    let error = |sample: &&Sample| Some(distance(sample.tip_achieved_m?, sample.tip_setpoint_m));
    let tracking = |sample: &&Sample| distance(sample.tip_modelled_m, sample.tip_setpoint_m);
    TipSummary {
        final_error_m: samples.last().and_then(error),
        error_m: ErrorStats::of(samples.iter().filter_map(error)),
        tracking_error_m: ErrorStats::of(samples.iter().map(tracking).filter(|_| !log.info.is_corrected())),
        at_holds_m: super::tip::at_holds_m(log),
        across_m: super::tip::across_m(log, samples),
    }
}

fn pressure(channels: Range<usize>, samples: &[&Sample]) -> PressureSummary {
    let values = || samples.iter().filter_map(|sample| sample.channels.get(channels.clone())).flatten();
    let truth = values().filter_map(|channel| Some(channel.true_pressure_pa? - channel.reference_pa));
    PressureSummary {
        measured_error_pa: ErrorStats::of(values().map(|channel| channel.pressure_pa - channel.reference_pa)),
        true_error_pa: ErrorStats::of(truth),
    }
}
