//! Pressures and deformations at rest, out of the log of a run.

use super::Branch;
use crate::record::{ModuleInfo, PhaseInfo, RunLog, Sample};
use std::ops::Range;

use fra_model::StateQuantity;
use softlimb_motion::{Carried, held_share};
use softlimb_numerics::statistics;

/// The part of a hold that counts, from its end: what moved has come to rest by then, as far as it does.
const LAST: f64 = 0.3;
/// A hold is at rest where its mean pressure moves by less than this from one half of that part to the other, Pa; or by a hundredth.
const STILL_PA: f64 = 300.0;

/// The limb at the end of a hold counts where no module's pressure moves by more than this share of its largest from one half of that part to the
/// other: setpoints that follow a mass from hand to hand move slowly.
const SLOW: f64 = 0.05;

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
    /// Whether the pressure rose to it or fell, from the hold before.
    pub branch: Branch,
}

/// The limb at the end of a hold: means of what was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbHold {
    /// The phase, or `rest` for the start of the run.
    pub phase: String,
    /// Mass at the tip, kg.
    pub payload_kg: f64,
    /// Reading of each channel's sensor, Pa gauge.
    pub readings_pa: Vec<f64>,
    /// Deformation of each drive, in the SI unit of its quantity; `None` where it was not seen.
    pub values: Vec<Option<f64>>,
    /// Position of the tip, m; `None` where it was not seen.
    pub tip_m: Option<[f64; 3]>,
}

impl LimbHold {
    /// Mean reading of some channels, Pa gauge.
    pub fn reading_pa(&self, channels: &Range<usize>) -> f64 {
        let own = channels.clone().filter_map(|channel| self.readings_pa.get(channel).copied());
        statistics::mean(own).unwrap_or(0.0)
    }
}

/// The ends of all holds in which a module was seen and its pressure stood still, and the start of the run.
///
/// Modules whose setpoints are pressures have no deformation in the log and are left out.
pub fn holds(log: &RunLog) -> Vec<Hold> {
    let mut found: Vec<Hold> = Vec::new();
    for Window { phase, samples, .. } in windows(log) {
        for (index, module) in log.info.modules.iter().enumerate() {
            let Some((reading_pa, value)) = at_rest(&samples, index, module) else { continue };
            let branch = match found.iter().rfind(|hold| hold.module == index) {
                None => Branch::Loading,
                // A pressure that stands still stays on its branch.
                Some(before) if (reading_pa - before.reading_pa).abs() <= STILL_PA => before.branch,
                Some(before) if reading_pa < before.reading_pa => Branch::Unloading,
                Some(_) => Branch::Loading,
            };
            found.push(Hold {
                module: index,
                phase: phase.into(),
                reading_pa,
                quantity: module.quantity,
                value,
                branch,
            });
        }
    }
    found
}

/// The ends of all holds in which the limb was seen and hardly moved, and the start of the run; `carried` is what the tip carries in each phase.
pub fn limb_holds(log: &RunLog, carried: &[Carried]) -> Vec<LimbHold> {
    let modules = || log.info.modules.iter();
    let largest_pa: Vec<f64> = modules().map(|module| largest_pa(log, module)).collect();
    let of_window = |Window { phase, index, samples }: Window<'_>| {
        let slow = |(module, largest_pa): (&ModuleInfo, &f64)| {
            let (early, late) = halves_pa(&samples, module);
            early.zip(late).is_none_or(|(early, late)| (early - late).abs() <= STILL_PA.max(SLOW * largest_pa))
        };
        if samples.is_empty() || !modules().zip(&largest_pa).all(slow) {
            return None;
        }
        let kg = |sample: &&Sample| match index {
            Some(index) => Some(carried.get(index)?.handed_kg(held(&log.info.phases[index], sample.time_s))),
            None => Some(carried.first()?.moved.payload_kg),
        };
        let over = |of: &dyn Fn(&Sample) -> Option<f64>| mean(samples.iter().map(|sample| of(sample)));
        let reading = |channel: usize| over(&|sample| Some(sample.channels.get(channel)?.pressure_pa));
        let value = |(index, module): (usize, &ModuleInfo)| {
            over(&|sample| sample.modules.get(index)?.achieved).filter(|_| module.quantity != StateQuantity::Pressure)
        };
        let coordinate = |axis: usize| over(&|sample| Some(sample.tip_achieved_m?[axis]));
        Some(LimbHold {
            phase: phase.into(),
            payload_kg: mean(samples.iter().map(kg))?,
            readings_pa: (0..log.info.channel_count()).map(reading).collect::<Option<_>>()?,
            values: modules().enumerate().map(value).collect(),
            tip_m: (|| Some([coordinate(0)?, coordinate(1)?, coordinate(2)?]))(),
        })
    };
    let seen = |hold: &LimbHold| hold.tip_m.is_some() || hold.values.iter().any(Option::is_some);
    windows(log).filter_map(of_window).filter(seen).collect()
}

/// Share of the mass that has changed hands at a time in a hold.
fn held(phase: &PhaseInfo, time_s: f64) -> f64 {
    let us = |time_s: f64| (1e6 * time_s).round() as u64;
    held_share(us(phase.hold_start_s()), us(phase.hold_s), us(time_s))
}

/// The samples of the part of a hold that counts.
struct Window<'a> {
    phase: &'a str,
    /// Index of the phase; `None` for the start of the run.
    index: Option<usize>,
    samples: Vec<&'a Sample>,
}

fn windows(log: &RunLog) -> impl Iterator<Item = Window<'_>> {
    let phases = log.info.phases.iter().enumerate();
    let of_phases = phases
        .map(|(index, phase)| (phase.name.as_str(), Some(index), phase.end_s() - LAST * phase.hold_s, phase.end_s()));
    std::iter::once(("rest", None, -0.1, 0.0)).chain(of_phases).map(|(phase, index, from_s, to_s)| {
        let within = |sample: &&Sample| (from_s..=to_s).contains(&sample.time_s);
        Window { phase, index, samples: log.samples.iter().filter(within).collect() }
    })
}

/// Mean reading and deformation over samples in which a module stands still.
fn at_rest(samples: &[&Sample], index: usize, module: &ModuleInfo) -> Option<(f64, f64)> {
    if module.quantity == StateQuantity::Pressure || samples.is_empty() {
        return None;
    }
    let whole = mean(samples.iter().map(|sample| reading_pa(sample, module)))?;
    if let (Some(early), Some(late)) = halves_pa(samples, module)
        && (early - late).abs() > STILL_PA.max(0.01 * whole.abs())
    {
        return None;
    }
    let value = mean(samples.iter().map(|sample| sample.modules.get(index)?.achieved))?;
    Some((whole, value))
}

/// Mean reading of a module's sensors, Pa.
fn reading_pa(sample: &Sample, module: &ModuleInfo) -> Option<f64> {
    let channels = sample.channels.get(module.channels.clone())?;
    mean(channels.iter().map(|channel| Some(channel.pressure_pa)))
}

/// The same over both halves of some samples; `None` of none.
fn halves_pa(samples: &[&Sample], module: &ModuleInfo) -> (Option<f64>, Option<f64>) {
    let (early, late) = samples.split_at(samples.len() / 2);
    let of = |samples: &[&Sample]| mean(samples.iter().map(|sample| reading_pa(sample, module)));
    (of(early), of(late))
}

/// Largest reading of a module in a run, Pa.
fn largest_pa(log: &RunLog, module: &ModuleInfo) -> f64 {
    log.samples.iter().filter_map(|sample| reading_pa(sample, module)).fold(0.0, f64::max)
}

/// The mean; `None` where there is nothing, or something is missing or not finite.
fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Option<Vec<f64>> = values.map(|value| value.filter(|value| value.is_finite())).collect();
    statistics::mean(all?)
}
