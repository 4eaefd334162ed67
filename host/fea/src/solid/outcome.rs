//! Result of a run: its points with their status.

use super::ccx::{End, Raw};
use super::dat::{Block, Blocks, Progress, blocks};
use super::gauge::{Displacements, Rates};
use super::{FemError, Model};

/// A jump: the volume grows by this share of the one at rest in one increment,
const JUMP: f64 = 0.25;
/// and so many times as fast as in the increment before or after.
const ABRUPT: f64 = 4.0;

/// Outcome at a pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointStatus {
    /// CalculiX converged there.
    Converged,
    /// CalculiX converged there, but on the way the lumen grew so abruptly that a limit point may have been jumped over, as load control
    /// does without a word. The figures are of no use.
    BeyondJump {
        /// Gauge pressures between which it happened, Pa.
        between_pa: [f64; 2],
    },
    /// The run ended before.
    NotReached {
        /// The highest gauge pressure that converged, Pa.
        reached_pa: f64,
    },
}

/// Deformation between the ends, for comparison with figures of a whole actuator: the caps hinder their surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Length between the caps over that at rest.
    pub axial_stretch: f64,
    /// Turn of the one end against the other about the axis, rad.
    pub twist_rad: f64,
    /// Angle between the ends, rad; >= 0.
    pub bend_angle_rad: f64,
}

/// One pressure of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Outcome.
    pub status: PointStatus,
    /// In the middle of the length; `None` where the run ended before, and beyond a jump.
    pub middle: Option<Rates>,
    /// Between the ends; as `middle`.
    pub ends: Option<Ends>,
    /// Seconds from the start of the run until this pressure was reached.
    pub seconds: Option<f64>,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// One for each pressure asked for.
    pub points: Vec<Point>,
    /// End of the run.
    pub end: End,
    /// Increments that converged, and iterations of all.
    pub increments: u32,
    /// Iterations of all increments and attempts.
    pub iterations: u32,
    /// Seconds of the run, those of failed tries included.
    pub seconds: f64,
    /// The model.
    pub model: Model,
    /// Displacements of the printed nodes at each pressure that converged, mm.
    pub(crate) moved: Vec<Displacements>,
}

/// Measured strains at one time of a run.
struct Sample {
    pressure_pa: f64,
    middle: Rates,
    ends: Rates,
}

/// Reduces the output of a run to points.
pub(crate) fn reduce(model: Model, pressures_pa: &[f64], raw: &Raw, inner_radius_m: f64) -> Result<Run, FemError> {
    let printed = model.printed().len();
    let Blocks { whole, torn } = blocks(&raw.dat, printed)?;
    let wanted = pressures_pa.len() as f64;
    let last = whole.last().map_or(0.0, |block| block.time);
    let garbage = |line, what: String| Err(FemError::Garbage { file: "the .dat file", line, what });
    match (&raw.end, torn) {
        // A run that is ended from outside may well be in the middle of a block.
        (End::TimedOut, _) | (_, None) => {}
        (_, Some(line)) => return garbage(line, "it ends in the middle of a block".to_owned()),
    }
    if raw.end == End::Finished && raw.dat.trim().is_empty() {
        return Err(FemError::NoOutput);
    }
    if raw.end == End::Finished && last < wanted - 1e-6 {
        return garbage(
            raw.dat.lines().count(),
            format!("CalculiX says it is done, but printed up to step {last:.3} of {wanted}"),
        );
    }
    let sample = |block: &Block| -> Result<Sample, FemError> {
        let (middle, ends) = model.gauges.read(&model.mesh, &block.moved)?;
        Ok(Sample { pressure_pa: pressure_at(pressures_pa, block.time), middle, ends })
    };
    let samples = whole.iter().map(sample).collect::<Result<Vec<_>, _>>()?;
    let jump = jump(&samples, inner_radius_m);
    let reached_pa = pressure_at(pressures_pa, last);
    let (mut points, mut moved) = (Vec::new(), Vec::new());
    for (step, &pressure_pa) in pressures_pa.iter().enumerate() {
        let at = whole.iter().position(|block| (block.time - (step + 1) as f64).abs() < 1e-6);
        let seconds = at.map(|_| raw.step_seconds.get(step).copied().unwrap_or(raw.seconds));
        let status = match (at, jump) {
            (None, _) => PointStatus::NotReached { reached_pa },
            (Some(n), Some(first)) if n >= first => PointStatus::BeyondJump {
                between_pa: [if first == 0 { 0.0 } else { samples[first - 1].pressure_pa }, samples[first].pressure_pa],
            },
            (Some(_), _) => PointStatus::Converged,
        };
        let sample = at.filter(|_| status == PointStatus::Converged).map(|n| &samples[n]);
        moved.extend(at.filter(|_| sample.is_some()).map(|n| whole[n].moved.clone()));
        let length_m = model.plan.length * 1e-3;
        points.push(Point {
            pressure_pa,
            status,
            middle: sample.map(|sample| sample.middle),
            ends: sample.map(|sample| Ends {
                axial_stretch: sample.ends.axial_stretch,
                twist_rad: sample.ends.twist_rate_rad_per_m * length_m,
                bend_angle_rad: sample.ends.bend_rate_rad_per_m * length_m,
            }),
            seconds,
        });
    }
    let Progress { increments, iterations, .. } = raw.progress;
    Ok(Run { points, end: raw.end.clone(), increments, iterations, seconds: raw.seconds, model, moved })
}

/// The pressure at a total time: a step for each pressure, in which it rises evenly.
fn pressure_at(pressures_pa: &[f64], time: f64) -> f64 {
    let step = (time.max(0.0) as usize).min(pressures_pa.len());
    let before = if step == 0 { 0.0 } else { pressures_pa[step - 1] };
    let next = pressures_pa.get(step).copied().unwrap_or(before);
    before + (next - before) * (time - step as f64).max(0.0)
}

/// The first sample behind an increment in which the lumen grew abruptly.
fn jump(samples: &[Sample], inner_radius_m: f64) -> Option<usize> {
    let volumes: Vec<f64> =
        std::iter::once(1.0).chain(samples.iter().map(|sample| sample.middle.volume_ratio(inner_radius_m))).collect();
    let pressures: Vec<f64> = std::iter::once(0.0).chain(samples.iter().map(|sample| sample.pressure_pa)).collect();
    let slope = |n: usize| (volumes[n + 1] - volumes[n]) / (pressures[n + 1] - pressures[n]);
    (0..samples.len()).find(|&n| {
        let abrupt = |other: usize| slope(n) > ABRUPT * slope(other).abs();
        let grown = volumes[n + 1] - volumes[n] > JUMP * volumes[n].min(1.0);
        grown && ((n > 0 && abrupt(n - 1)) || (n + 1 < samples.len() && abrupt(n + 1)))
    })
}
