//! Observed swing of the tip after a move.

use nalgebra::Vector3;

use crate::record::{PhaseInfo, RunLog, Sample};

/// Most periods of the slowest vibration over which the swing is measured, and fewest samples of a period.
const PERIODS: f64 = 2.0;
const SAMPLES: f64 = 8.0;

/// Largest distance of the tip from its mean position, m, in the first two periods after a move, or in the first if the hold is shorter. The position
/// is relative to the modelled tip at the measured pressures, which removes the tracking error. Creep is included.
///
/// `None` without a predicted frequency, in a hold shorter than a period, where the gripper acts, and where the tip was not observed.
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
