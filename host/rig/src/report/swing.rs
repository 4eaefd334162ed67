//! Swing of the tip after a move, as it was seen.

use nalgebra::Vector3;

use crate::record::{PhaseInfo, RunLog, Sample};

/// Periods of the slowest vibration over which a swing is taken, at most; and fewest samples of a period.
const PERIODS: f64 = 2.0;
const SAMPLES: f64 = 8.0;

/// Largest distance of the tip from its mean in the first two periods after a move, or the one that its hold has, m. Tracking has no part in it:
/// the tip counts from where the model has it at the pressures of the time. Creep of that time has one.
///
/// `None` without a predicted frequency, in a hold shorter than a period, where the gripper acts, and where nobody saw the tip.
pub(super) fn seen_m(log: &RunLog, phase: &PhaseInfo) -> Option<f64> {
    let frequency_hz = phase.swing.filter(|_| phase.gripper.is_none())?.frequency_hz;
    let periods = (phase.hold_s * frequency_hz).floor().min(PERIODS);
    let (from_s, to_s) = (phase.hold_start_s(), phase.hold_start_s() + periods / frequency_hz);
    let within = log.samples.iter().filter(|sample| (from_s..to_s).contains(&sample.time_s));
    let off = |sample: &Sample| Some(Vector3::from(sample.tip_achieved_m?) - Vector3::from(sample.tip_modelled_m));
    let offs = within.map(off).collect::<Option<Vec<_>>>()?;
    if offs.is_empty() || (offs.len() as f64) < SAMPLES * periods {
        return None;
    }
    let mean = offs.iter().sum::<Vector3<f64>>() / offs.len() as f64;
    let most_m = offs.iter().map(|off| (off - mean).norm()).fold(0.0, f64::max);
    most_m.is_finite().then_some(most_m)
}
