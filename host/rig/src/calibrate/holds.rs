//! Pressures and deformations at rest, out of the log of a run.

use crate::record::{ModuleInfo, RunLog, Sample};
use fra_model::StateQuantity;
use softlimb_numerics::statistics;

/// The part of a hold that counts, from its end: what moved has come to rest by then, as far as it does.
const LAST: f64 = 0.3;
/// A hold is at rest where its mean pressure moves by less than this from one half of that part to the other, Pa; or by a hundredth.
const STILL_PA: f64 = 300.0;

/// A module at rest at the end of a hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// Index of the module in the log.
    pub module: usize,
    /// The phase, or `rest` for the start of the run.
    pub phase: String,
    /// Mean reading of the sensors of its actuators, Pa gauge.
    pub reading_pa: f64,
    /// Measured quantity.
    pub quantity: StateQuantity,
    /// Mean of the deformation that was achieved, in the SI unit of the quantity.
    pub value: f64,
}

/// The ends of all holds in which a module was seen and its pressure stood still, and the start of the run.
///
/// Modules whose setpoints are pressures have no deformation in the log and are left out.
pub fn holds(log: &RunLog) -> Vec<Hold> {
    let phases = log.info.phases.iter();
    let mut windows: Vec<(&str, f64, f64)> = vec![("rest", -0.1, 0.0)];
    windows.extend(phases.map(|phase| (phase.name.as_str(), phase.end_s() - LAST * phase.hold_s, phase.end_s())));
    let mut found = Vec::new();
    for (phase, from_s, to_s) in windows {
        let within = |sample: &&Sample| (from_s..=to_s).contains(&sample.time_s);
        let samples: Vec<&Sample> = log.samples.iter().filter(within).collect();
        for (index, module) in log.info.modules.iter().enumerate() {
            let Some((reading_pa, value)) = at_rest(&samples, index, module) else { continue };
            found.push(Hold { module: index, phase: phase.into(), reading_pa, quantity: module.quantity, value });
        }
    }
    found
}

/// Mean reading and deformation over samples in which a module stands still.
fn at_rest(samples: &[&Sample], index: usize, module: &ModuleInfo) -> Option<(f64, f64)> {
    if module.quantity == StateQuantity::Pressure || samples.is_empty() {
        return None;
    }
    let reading = |sample: &&Sample| {
        let channels = sample.channels.get(module.channels.clone())?;
        mean(channels.iter().map(|channel| Some(channel.pressure_pa)))
    };
    let (early, late) = samples.split_at(samples.len() / 2);
    let whole = mean(samples.iter().map(reading))?;
    if let (Some(early), Some(late)) = (mean(early.iter().map(reading)), mean(late.iter().map(reading)))
        && (early - late).abs() > STILL_PA.max(0.01 * whole.abs())
    {
        return None;
    }
    let value = mean(samples.iter().map(|sample| sample.modules.get(index)?.achieved))?;
    Some((whole, value))
}

/// The mean; `None` where there is nothing, or something is missing or not finite.
fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Option<Vec<f64>> = values.map(|value| value.filter(|value| value.is_finite())).collect();
    statistics::mean(all?)
}
