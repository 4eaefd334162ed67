//! The plan under the limb's own weight and what it carries: the model that it needs, and its tips.
//!
//! Goals and ways are found on the loaded limb, which [`Carrier`] gives. The tips of the streamed setpoints are found here.

mod margins;
mod nominal;
mod slopes;
mod swing;

pub use margins::Margins;
pub(crate) use margins::margins;
pub use nominal::{Nominal, Pose, PoseError};
pub(crate) use nominal::{pressures_pa, step_pa};
pub use slopes::planned_slopes;
pub use swing::{Swing, Vibrations};
pub(crate) use swing::{calmed, swings, vibrations};

use fra_model::State;
use nalgebra::Vector3;

use super::carrier::Carrier;
use super::clear::Way;
use super::payload::{Carried, Carrying, carried};
use super::plan::{Plan, PlannedPhase, phase_at};
use super::unreachable::Unreachable;
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_scene::Scene;
use softlimb_scene::collision::Body;

/// What a plan knows of the loaded limb.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighed {
    /// The model that was taken.
    pub tier: Fidelity,
    /// The largest error that it says of itself at the ends of phases, as a share of the limb's length.
    pub error: f64,
    /// Tip of the nominal limb under load at each knot, m: by rods, with the shift of tubes between plates at the ends of moves.
    pub(super) tips_m: Vec<[f64; 3]>,
    /// Its centre line, m.
    pub(super) lines_m: Vec<Vec<[f64; 3]>>,
}

/// The model that poses need, and the largest error that it says of itself, as a share of the limb's length.
pub(super) struct Judged {
    pub(super) tier: Fidelity,
    pub(super) error: f64,
    /// The phase of that error.
    pub(super) phase: usize,
}

impl Judged {
    /// Of the limb at rest.
    ///
    /// # Errors
    /// [`Unreachable::NotCarried`].
    pub(super) fn at_rest(scene: &Scene, limb: &Limb, error: f64) -> Result<Self, Unreachable> {
        let at_rest = vec![0.0; limb.drives().len()];
        let payload_kg = carried(scene.phases()).first().map_or(0.0, |carried| carried.moved.payload_kg);
        let judged = Nominal::tier_for(scene, limb, &at_rest, payload_kg, error);
        let (tier, error) = judged.map_err(|cause| Unreachable::NotCarried { phase: 0, time_us: 0, cause })?;
        Ok(Self { tier, error, phase: 0 })
    }

    /// Takes the ends of the moves and holds of a plan into account.
    pub(super) fn look(&mut self, scene: &Scene, limb: &Limb, plan: &Plan, error: f64) {
        for (index, (phase, carried)) in plan.phases.iter().zip(carried(scene.phases())).enumerate() {
            for (time_us, carrying) in [(0, carried.moved), (phase.hold_us, carried.held)] {
                let time_us = (phase.start_us + phase.move_us + time_us) as f64;
                let pressures_pa = pressures_pa(&plan.states_at(time_us));
                if let Ok((tier, error)) = Nominal::tier_for(scene, limb, &pressures_pa, carrying.payload_kg, error) {
                    self.tier = self.tier.max(tier);
                    if error > self.error {
                        (self.error, self.phase) = (error, index);
                    }
                }
            }
        }
    }
}

/// Tips and centre lines of the nominal limb under its load at the knots.
///
/// # Errors
/// [`Unreachable::NotCarried`] where the limb falls or a tube buckles.
pub(super) fn weigh(
    scene: &Scene,
    limb: &Limb,
    phases: &[PlannedPhase],
    (rows, states, period_us): Way<'_>,
    tier: Fidelity,
) -> Result<Weighed, Unreachable> {
    let carried = carried(scene.phases());
    let mut nominal = Nominal::new(scene, limb, tier);
    let mut weighed = Weighed { tier, error: 0.0, tips_m: Vec::new(), lines_m: Vec::new() };
    let shifts_m = shifts_m(scene, limb, phases, tier, &states[0]);
    let mut last: Option<(usize, f64)> = None;
    for knot in 0..rows.len() {
        let time_us = knot as u64 * period_us;
        let index = phase_at(phases, time_us);
        let payload_kg = carried[index].handed_kg(phases[index].held_share(time_us));
        if last.is_some_and(|(before, kg)| rows[before] == rows[knot] && kg == payload_kg) {
            weighed.tips_m.extend(weighed.tips_m.last().copied());
            weighed.lines_m.extend(weighed.lines_m.last().cloned());
            continue;
        }
        let pose = nominal.at(&pressures_pa(&states[knot]), payload_kg).and_then(Pose::unbuckled);
        let pose = pose.map_err(|cause| Unreachable::NotCarried { phase: index, time_us, cause })?;
        let mut body = Body::new(limb.base());
        limb.loaded_shape(&pose.rod, &pose.shape.q, &states[knot], &mut body);
        weighed.lines_m.push(line_m(&body));
        weighed.tips_m.push((pose.tip_m() + shift_m(&shifts_m, &phases[index], index, time_us)).into());
        last = Some((knot, payload_kg));
    }
    Ok(weighed)
}

/// By how much tubes between plates have the tip elsewhere at rest, and at the end of each phase's move and hold, m.
fn shifts_m(
    scene: &Scene,
    limb: &Limb,
    phases: &[PlannedPhase],
    tier: Fidelity,
    rest: &[State<f64>],
) -> Vec<[Vector3<f64>; 2]> {
    let shift = |states: &[State<f64>], carrying: Carrying| {
        Carrier::new(scene, limb, Some(tier), carrying).tubes_shift_m(&pressures_pa(states))
    };
    let states = |values: &[f64]| -> Vec<State<f64>> {
        let drives = limb.drives().zip(values);
        drives.map(|(drive, value)| drive.state_at(*value).unwrap_or_else(|| drive.actuator.rest())).collect()
    };
    let carried = carried(scene.phases());
    let first = shift(rest, carried.first().map_or_else(Carrying::default, |carried| carried.moved));
    let of_phase = |(phase, carried): (&PlannedPhase, &Carried)| {
        let moved = shift(&states(&phase.values), carried.moved);
        [moved, if carried.held == carried.moved { moved } else { shift(&states(phase.last()), carried.held) }]
    };
    std::iter::once([first; 2]).chain(phases.iter().zip(&carried).map(of_phase)).collect()
}

/// The shift at a time of the run: between those at the ends in proportion to the setpoints.
fn shift_m(shifts_m: &[[Vector3<f64>; 2]], phase: &PlannedPhase, index: usize, time_us: u64) -> Vector3<f64> {
    let ([_, before], [moved, held]) = (&shifts_m[index], &shifts_m[index + 1]);
    before.lerp(moved, phase.move_share(time_us)) + (held - moved) * phase.held_share(time_us)
}

/// Ends of the pieces of a body's centre line, m.
fn line_m(body: &Body) -> Vec<[f64; 3]> {
    let starts = body.pieces().iter().map(|piece| piece.point_m(0.0));
    starts.chain([body.end().translation.vector]).map(Into::into).collect()
}
