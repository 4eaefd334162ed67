//! Corrections of a plan's setpoints by phase and over the time of a run.

use super::plan::Plan;
use super::unreachable::Unreachable;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{CorrectionRow, Corrections, PhaseCorrections, PhaseTimes, Scene};

/// Difference of planned setpoints, as a share of the module's range, from which corrections are those of another goal.
const MOVED: f64 = 0.01;
/// Shortest time that is told from none, s.
const TOLERANCE_S: f64 = 1e-6;

impl Plan {
    /// Corrections over the time of this plan, by its phases; with the planned setpoints, one a channel. Each phase has a row at its end.
    pub fn by_phase(&self, limb: &Limb, corrections: &Corrections) -> PhaseCorrections {
        let row = |times: &PhaseTimes, time_s: f64, values: Vec<f64>| {
            let since_s = time_s - times.start_s;
            let hold_s = (since_s - times.move_s).max(0.0);
            let move_share = if times.move_s > 0.0 { (since_s / times.move_s).clamp(0.0, 1.0) } else { 1.0 };
            CorrectionRow { move_share, hold_s, values, planned: limb.channel_values(&self.values_at(1e6 * time_s)) }
        };
        let of_phase = |(index, times): (usize, PhaseTimes)| {
            let (begin_s, end_s) = (times.start_s + if index == 0 { -TOLERANCE_S } else { TOLERANCE_S }, times.end_s());
            let all = corrections.times_s.iter().zip(&corrections.rows);
            let own = all.filter(|(time_s, _)| **time_s > begin_s && **time_s < end_s - TOLERANCE_S);
            let mut rows: Vec<_> = own.map(|(time_s, values)| row(&times, *time_s, values.clone())).collect();
            rows.push(row(&times, end_s, corrections.at(end_s)));
            rows
        };
        PhaseCorrections { phases: self.phase_times().into_iter().enumerate().map(of_phase).collect() }
    }
}

/// Phases whose goals have other setpoints than those that the scene's corrections were learned at, in words.
pub fn moved_warnings(scene: &Scene, limb: &Limb, plan: &Plan) -> Vec<String> {
    let Some(corrections) = scene.corrections() else { return Vec::new() };
    let phases = plan.phases.iter().zip(plan.phase_times()).zip(&corrections.phases);
    let moved = phases.filter_map(|((phase, times), rows)| {
        let learned = rows.last().map(|row| &row.planned).filter(|planned| !planned.is_empty())?;
        let planned = limb.channel_values(&plan.values_at(1e6 * times.end_s()));
        let share = |module: &LimbModule| {
            let (rest, last) = module.range();
            let channels = learned[module.channels.clone()].iter().zip(&planned[module.channels.clone()]);
            channels.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (last - rest).abs()
        };
        let shares = limb.modules().iter().map(|module| (share(module), module));
        let (share, module) = shares.max_by(|(a, _), (b, _)| a.total_cmp(b)).filter(|(share, _)| *share > MOVED)?;
        Some(format!(
            "the corrections of `{}` were learned at other setpoints: those of `{}` were up to {:.0} % of its range away",
            phase.name,
            module.name,
            100.0 * share
        ))
    });
    moved.collect()
}

/// Checks that corrections are within the ranges of their modules: larger ones are in another unit, or of another limb.
///
/// # Errors
/// [`Unreachable::Correction`].
pub(super) fn check_corrections(limb: &Limb, corrections: &Corrections) -> Result<(), Unreachable> {
    for (time_s, row) in corrections.times_s.iter().zip(&corrections.rows) {
        for (index, module) in limb.modules().iter().enumerate() {
            let (rest, last) = module.range();
            let own = row.get(module.channels.clone()).unwrap_or_default();
            if let Some(value) = own.iter().find(|value| value.abs() > (last - rest).abs()) {
                return Err(Unreachable::Correction { time_s: *time_s, module: index, value: *value });
            }
        }
    }
    Ok(())
}
