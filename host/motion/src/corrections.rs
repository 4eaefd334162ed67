//! Corrections of a plan's setpoints by phase and over the time of a run.

use super::plan::Plan;
use super::unreachable::Unreachable;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{CorrectionRow, Corrections, PhaseCorrections, PhaseTimes, Scene};

/// Difference of planned setpoints, as a share of the module's range, from which corrections are those of another goal.
const MOVED: f64 = 0.01;
/// Shortest time between two rows of a phase, s: knots are not closer.
const STEP_MIN_S: f64 = 1e-3;

impl Plan {
    /// Corrections over the time of this plan, by its phases; with the planned setpoints, one a channel. Each phase has a row at the ends of its move
    /// and of its hold, and the first one at its start.
    pub fn by_phase(&self, limb: &Limb, corrections: &Corrections) -> PhaseCorrections {
        let of_phase = |(index, times): (usize, PhaseTimes)| {
            let [arrived_s, end_s] = [times.start_s + times.move_s, times.end_s()];
            let is_far = |time_s: f64, ends: &[f64]| ends.iter().all(|end_s| (time_s - end_s).abs() >= STEP_MIN_S);
            let mut ends = vec![end_s];
            ends.extend((index == 0).then_some(times.start_s).filter(|start_s| is_far(*start_s, &[end_s])));
            ends.extend(Some(arrived_s).filter(|time_s| is_far(*time_s, &ends) && *time_s > times.start_s));
            let own = corrections.times_s.iter().copied().filter(|time_s| *time_s > times.start_s && *time_s < end_s);
            let mut times_s: Vec<f64> = own.filter(|time_s| is_far(*time_s, &ends)).collect();
            times_s.dedup_by(|later, before| *later < *before + STEP_MIN_S);
            times_s.extend(ends);
            times_s.sort_by(f64::total_cmp);
            times_s.into_iter().map(|time_s| self.row(limb, &times, time_s, corrections.at(time_s))).collect()
        };
        PhaseCorrections { phases: self.phase_times().into_iter().enumerate().map(of_phase).collect() }
    }

    fn row(&self, limb: &Limb, times: &PhaseTimes, time_s: f64, values: Vec<f64>) -> CorrectionRow {
        let since_s = time_s - times.start_s;
        let hold_s = (since_s - times.move_s).max(0.0);
        let move_share = if times.move_s > 0.0 { (since_s / times.move_s).clamp(0.0, 1.0) } else { 1.0 };
        CorrectionRow { move_share, hold_s, values, planned: limb.channel_values(&self.values_at(1e6 * time_s)) }
    }
}

/// Warnings of phases whose planned setpoints differ from those in the scene's corrections.
pub fn moved_warnings(scene: &Scene, limb: &Limb, plan: &Plan) -> Vec<String> {
    let Some(corrections) = scene.corrections() else { return Vec::new() };
    let phases = plan.phases.iter().zip(plan.phase_times()).zip(&corrections.phases);
    let moved = phases.filter_map(|((phase, times), rows)| {
        let last = rows.last().filter(|row| row.move_share == 1.0 && !row.planned.is_empty())?;
        let planned = limb.channel_values(&plan.values_at(1e6 * times.end_s()));
        let share = |module: &LimbModule| {
            let (rest, end) = module.range();
            let channels = last.planned[module.channels.clone()].iter().zip(&planned[module.channels.clone()]);
            channels.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (end - rest).abs()
        };
        let shares = limb.modules().iter().map(|module| (share(module), module)).filter(|(share, _)| *share > MOVED);
        let (share, module) = shares.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
        Some(format!(
            "the planned setpoints of `{}` in `{}` differ from those of the corrections by up to {:.0} % of its range",
            module.name,
            phase.name,
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
