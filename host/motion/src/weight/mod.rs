//! Setpoints corrected for weight: the tip of the loaded limb goes where the plan has it without load.
//!
//! The plan is made without weight, as ever. Then, knot by knot, the pressures are sought under which the nominal limb's tip, under its own
//! weight and the payload, is where the plan's tip is ([`correct`]). At rest nothing is corrected, since the setpoints begin there; the
//! weight that is made up for grows with the first move, and a payload with the move or the hold in which it is taken up.

mod clear;
mod correct;
mod margins;
mod nominal;
mod slopes;

pub(crate) use margins::margins;
pub use margins::{
    BUCKLING_MARGIN_MIN, LOAD_FACTOR_MIN, Margins, PRESSURE_SHARE_MAX, SAG_SHARE_MAX, STIFFNESS_MIN_N_PER_M,
};
pub use nominal::{Nominal, OnLimb, Pose, PoseError};
pub use slopes::planned_slopes;

use fra_model::State;
use nalgebra::Vector3;

use super::payload::{Carried, carried, payload_kg};
use super::plan::{PlannedPhase, phase_at};
use super::profile::minimum_jerk;
use super::unreachable::Unreachable;
use super::wire::to_wire;
use correct::{AT_GOAL_M, Corrector, ON_THE_WAY_M};
use nominal::pressures_pa;
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_scene::Scene;

/// Distance from its place up to which the tip of the loaded limb counts as there, m; as that of a way-point without load.
const REACHED_M: f64 = 1e-4;

/// Wire values, one row a knot.
type Knots = Vec<Vec<i32>>;

/// At each knot the states without load, and where the tip shall be, m.
type Way<'a> = (&'a [Vec<State<f64>>], &'a [Vector3<f64>]);

/// What a plan knows of the loaded limb.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighed {
    /// The model that was taken.
    pub tier: Fidelity,
    /// The largest error that it says of itself at the ends of phases, as a share of the limb's length.
    pub error: f64,
    /// Tip of the nominal limb under load at each knot, m.
    pub(super) tips_m: Vec<[f64; 3]>,
    /// Its centre line, m.
    pub(super) lines_m: Vec<Vec<[f64; 3]>>,
}

/// Corrects the knots of a plan; `None` where the scene does not want it.
///
/// `states` are those without load at the knots. The values of the phases become the corrected ones.
///
/// # Errors
/// [`Unreachable`] where the limb does not carry its load, or does not get to its goal under it.
pub(super) fn corrected(
    scene: &Scene,
    limb: &Limb,
    phases: &mut [PlannedPhase],
    states: &[Vec<State<f64>>],
    period_us: u64,
) -> Result<Option<(Knots, Weighed)>, Unreachable> {
    let Some(weight) = scene.weight().filter(|weight| weight.compensated) else { return Ok(None) };
    let carried = carried(scene.phases());
    let wanted_m: Vec<Vector3<f64>> = states.iter().map(|states| limb.tip(states).into()).collect();
    let mut judged = Judged::at_rest(scene, limb, &carried, weight.error).map_err(|why| not_carried(phases, 0, why))?;
    loop {
        let tier = judged.tier;
        let rows = rows(limb, phases, (&carried, (states, &wanted_m), period_us), Nominal::new(scene, limb, tier))?;
        let ends = ends(limb, phases, (&carried, &rows, period_us), Nominal::new(scene, limb, tier))?;
        for (pressures_pa, carried) in ends.iter().zip(&carried) {
            judged.look(scene, limb, pressures_pa, OnLimb::whole(carried.move_kg), weight.error);
        }
        // The corrected poses may need more of a model than the limb at rest.
        if judged.tier > tier {
            continue;
        }
        for (phase, pressures_pa) in phases.iter_mut().zip(&ends) {
            phase.values = values(limb, pressures_pa);
        }
        let knots = rows.iter().map(|row| wire(limb, row)).collect();
        return Ok(Some((knots, Weighed { tier, error: judged.error, tips_m: Vec::new(), lines_m: Vec::new() })));
    }
}

/// The model that poses need, and the largest error that it says of itself, as a share of the limb's length.
struct Judged {
    tier: Fidelity,
    error: f64,
}

impl Judged {
    fn at_rest(scene: &Scene, limb: &Limb, carried: &[Carried], error: f64) -> Result<Self, PoseError> {
        let at_rest = vec![0.0; limb.modules().len()];
        let on = OnLimb::whole(carried.first().map_or(0.0, |carried| carried.move_kg));
        let (tier, error) = Nominal::tier_for(scene, limb, &at_rest, on, error)?;
        Ok(Self { tier, error })
    }

    /// Takes a pose into account in which the limb stands.
    fn look(&mut self, scene: &Scene, limb: &Limb, pressures_pa: &[f64], on: OnLimb, error: f64) {
        if let Ok((tier, error)) = Nominal::tier_for(scene, limb, pressures_pa, on, error) {
            (self.tier, self.error) = (self.tier.max(tier), self.error.max(error));
        }
    }
}

/// Corrected pressures at the knots, Pa, one a module.
fn rows(
    limb: &Limb,
    phases: &[PlannedPhase],
    (carried, way, period_us): (&[Carried], Way<'_>, u64),
    nominal: Nominal<'_>,
) -> Result<Vec<Vec<f64>>, Unreachable> {
    let mut corrector = Corrector::new(limb, nominal);
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(way.0.len());
    let mut last = None;
    for (knot, (states, wanted_m)) in way.0.iter().zip(way.1).enumerate() {
        let time_us = knot as u64 * period_us;
        let on = on_limb(carried, phases, time_us);
        if last == Some((states, wanted_m, on)) {
            rows.extend(rows.last().cloned());
            continue;
        }
        let home = pressures_pa(states);
        let start: Vec<f64> = match rows.last().zip(last) {
            Some((row, (states, ..))) => {
                let moved = home.iter().zip(pressures_pa(states)).map(|(new, old)| new - old);
                row.iter().zip(moved).map(|(pressure, moved)| pressure + moved).collect()
            }
            None => home.clone(),
        };
        let found = corrector.correct(&home, &start, wanted_m, (on, ON_THE_WAY_M));
        rows.push(found.map_err(|why| not_carried(phases, time_us, why))?.pressures_pa);
        last = Some((states, wanted_m, on));
    }
    Ok(rows)
}

/// Corrected pressures at the ends of the moves, Pa, held to their goals.
fn ends(
    limb: &Limb,
    phases: &[PlannedPhase],
    (carried, rows, period_us): (&[Carried], &[Vec<f64>], u64),
    nominal: Nominal<'_>,
) -> Result<Vec<Vec<f64>>, Unreachable> {
    let mut corrector = Corrector::new(limb, nominal);
    let of_phase = |(index, (phase, carried)): (usize, (&PlannedPhase, &Carried))| {
        let end_us = phase.start_us + phase.move_us;
        let modules = limb.modules().iter().zip(&phase.values);
        // The values are those of a plan: each has a state.
        let states: Vec<State<f64>> =
            modules.map(|(module, value)| module.state_at(*value).unwrap_or_else(|| module.actuator.rest())).collect();
        let start = &rows[((end_us / period_us) as usize).min(rows.len() - 1)];
        let (wanted, on) = (Vector3::from(limb.tip(&states)), OnLimb::whole(carried.move_kg));
        let found = corrector
            .correct(&pressures_pa(&states), start, &wanted, (on, AT_GOAL_M))
            .map_err(|why| not_carried(phases, end_us.saturating_sub(1), why))?;
        if found.off_m > REACHED_M {
            let fractions = found.pressures_pa.iter().zip(&corrector.spans_pa).map(|(pressure, span)| pressure / span);
            let (tip_m, fractions) = (found.pose.tip_m().into(), fractions.collect());
            return Err(Unreachable::UnderLoad { phase: index, tip_m, distance_m: found.off_m, fractions });
        }
        Ok(found.pressures_pa)
    };
    phases.iter().zip(carried).enumerate().map(of_phase).collect()
}

/// Tips and centre lines of the nominal limb under all of its load at the knots, whose states these are.
///
/// # Errors
/// [`Unreachable`] where the limb falls or comes too near an obstacle.
pub(super) fn weigh(
    scene: &Scene,
    limb: &Limb,
    phases: &[PlannedPhase],
    states: &[Vec<State<f64>>],
    period_us: u64,
    weighed: &mut Weighed,
) -> Result<(), Unreachable> {
    let carried = carried(scene.phases());
    let mut nominal = Nominal::new(scene, limb, weighed.tier);
    let mut last: Option<(&Vec<State<f64>>, f64)> = None;
    for (knot, states) in states.iter().enumerate() {
        let time_us = knot as u64 * period_us;
        // At the end of a move the goal counts, which is met just before the gripper acts.
        let kg = payload_kg(&carried, phases, time_us.saturating_sub(1));
        if last == Some((states, kg)) {
            weighed.tips_m.extend(weighed.tips_m.last().copied());
            weighed.lines_m.extend(weighed.lines_m.last().cloned());
            continue;
        }
        let pose = nominal.at(&pressures_pa(states), OnLimb::whole(kg)).and_then(Pose::unbuckled);
        let pose = pose.map_err(|why| not_carried(phases, time_us, why))?;
        let line_m = pose.rod.line_m(&pose.shape);
        clear::check(scene, limb, (phases, time_us), (&line_m, states))?;
        weighed.tips_m.push(pose.tip_m().into());
        weighed.lines_m.push(line_m);
        last = Some((states, kg));
    }
    Ok(())
}

/// What is made up for at a time: see the head of this file.
fn on_limb(carried: &[Carried], phases: &[PlannedPhase], time_us: u64) -> OnLimb {
    let index = phase_at(phases, time_us);
    let (Some(phase), Some(own)) = (phases.get(index), carried.get(index)) else { return OnLimb::whole(0.0) };
    let since_us = (time_us - phase.start_us) as f64;
    let (move_us, hold_us) = (phase.move_us as f64, phase.hold_us as f64);
    if since_us >= move_us {
        let share = if hold_us > 0.0 { minimum_jerk(((since_us - move_us) / hold_us).min(1.0)) } else { 1.0 };
        return OnLimb::whole(own.move_kg + (own.hold_kg - own.move_kg) * share);
    }
    let share = minimum_jerk(since_us / move_us);
    match index.checked_sub(1).and_then(|before| carried.get(before)) {
        Some(before) => OnLimb::whole(before.hold_kg + (own.move_kg - before.hold_kg) * share),
        None => OnLimb { payload_kg: own.move_kg, share },
    }
}

fn not_carried(phases: &[PlannedPhase], time_us: u64, cause: PoseError) -> Unreachable {
    Unreachable::NotCarried { phase: phase_at(phases, time_us), time_us, cause }
}

fn values(limb: &Limb, pressures_pa: &[f64]) -> Vec<f64> {
    limb.modules()
        .iter()
        .zip(pressures_pa)
        .map(|(module, pressure)| module.measure(&module.curve.at(*pressure)))
        .collect()
}

fn wire(limb: &Limb, pressures_pa: &[f64]) -> Vec<i32> {
    limb.modules().iter().zip(values(limb, pressures_pa)).map(|(module, value)| to_wire(module.kind, value)).collect()
}
