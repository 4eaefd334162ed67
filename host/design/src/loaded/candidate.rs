//! The limb that a start of the search leads to, cheap to dear.

use super::confirm;
use super::evaluate::{Evaluation, Judgement, evaluate};
use super::local_solve::{At, NOTHING, local, with_pressures};
use super::places::{change, places};
use super::plates::shifts;
use super::search::{Effort, RAISE, RAISE_STEPS, Refusal};
use super::space::LimbSpace;
use super::task::LoadedTask;
use softlimb_numerics::least_squares::Minimum;

/// Reserve that a limb is sought with.
const RESERVE: f64 = 0.03;
/// Part of the reserve that a limb keeps at least, so that tubes between plates keep every margin, too.
const KEPT: f64 = 0.4;
/// Steps of a local solve that tells a good start from a bad one, and the sum of squares up to which it is a good one.
const SHORT_STEPS: usize = 6;
const GOOD: f64 = 5.0;
/// A sum of squares up to which a limb may keep every margin with less of the reserve, once its tip is moved to the places.
const NEAR: f64 = 0.05;
/// Turns of a local solve and of the shifts of its tubes.
const SHIFT_TURNS: usize = 6;

/// A limb that a local solve has led to.
pub(super) struct Candidate {
    pub(super) minimum: Minimum<At>,
    pub(super) by: Judgement,
    /// Whether every margin is kept with a part of the reserve.
    pub(super) keeps: bool,
    /// Why the planner refuses it; `None` where it keeps all, or where the planner has not judged it.
    pub(super) refused: Option<String>,
}

impl Candidate {
    pub(super) fn limb(&self) -> &Evaluation {
        &self.minimum.evaluation.limb
    }
}

/// The limb that a start leads to, cheap to dear: a few steps, the poses, the moves, tubes between plates, the confirmation by them, a higher reserve, and
/// the planner.
pub(super) fn attempt(
    task: &LoadedTask,
    space: &LimbSpace,
    start: &[f64],
    effort: &Effort,
    refusal: &Refusal<'_>,
    given_up: &dyn Fn() -> bool,
    evaluations: &mut usize,
) -> Option<Candidate> {
    let steps = effort.steps;
    // Rods that tubes do not judge need no reserve for them.
    let reserve = if effort.by_tubes { RESERVE } else { 0.0 };
    let mut by = Judgement { reserve, ..Judgement::default() };
    let limb = evaluate(task, space, &space.sizes(start), &by)?;
    *evaluations += 1;
    let mut here = solved(task, space, (start, &limb), &by, SHORT_STEPS, evaluations)?;
    if !here.keeps && here.minimum.objective <= GOOD && !given_up() {
        here = solved(task, space, (&here.minimum.point, here.limb()), &by, steps, evaluations)?;
    }
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    by.moves = true;
    if effort.by_tubes {
        by.places = places(task, here.limb(), &by);
    }
    here = solved(task, space, (&here.minimum.point, here.limb()), &by, steps, evaluations)?;
    if !effort.by_tubes {
        return Some(here);
    }
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    here = with_shifts(task, space, here, evaluations);
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    here.keeps = confirm::keeps(task, here.limb(), &here.by);
    if !here.keeps || given_up() {
        return Some(here.unproven());
    }
    here = raised(task, space, here, effort.raises, given_up, evaluations);
    if given_up() {
        return Some(here.unproven());
    }
    here.refused = refusal(here.limb());
    Some(here)
}

/// The limb with the largest reserve that rises of it lead to from a limb that keeps that of its own.
fn raised(
    task: &LoadedTask,
    space: &LimbSpace,
    mut here: Candidate,
    raises: usize,
    given_up: &dyn Fn() -> bool,
    evaluations: &mut usize,
) -> Candidate {
    let mut raise = RAISE;
    for _ in 0..raises {
        if given_up() {
            break;
        }
        let by = Judgement { reserve: here.by.reserve + raise, ..here.by.clone() };
        let at = (&here.minimum.point[..], here.limb());
        let higher = solved(task, space, at, &by, RAISE_STEPS, evaluations);
        let higher = higher.filter(|higher| higher.keeps && higher.by.reserve > here.by.reserve);
        let higher = higher.map(|higher| with_shifts(task, space, higher, evaluations));
        match higher.filter(|higher| higher.keeps && confirm::keeps(task, higher.limb(), &higher.by)) {
            Some(higher) => (here, raise) = (higher, 1.6 * raise),
            None => raise *= 0.4,
        }
    }
    here
}

impl Candidate {
    /// The same with some of its margins not judged.
    fn unproven(mut self) -> Self {
        self.keeps = false;
        self
    }
}

/// The limb that a local solve leads to.
pub(super) fn solved(
    task: &LoadedTask,
    space: &LimbSpace,
    (start, near): (&[f64], &Evaluation),
    by: &Judgement,
    steps: usize,
    evaluations: &mut usize,
) -> Option<Candidate> {
    let (mut minimum, count) = local(task, space, start, near, by, steps)?;
    *evaluations += count;
    let (mut by, mut keeps) = (by.clone(), minimum.objective <= NOTHING);
    if !keeps && minimum.objective <= NEAR {
        let less = Judgement { reserve: by.reserve.min(KEPT * RESERVE), ..by.clone() };
        let limb = minimum.evaluation.limb.reaching(task, space, &less);
        if let Some(limb) = limb.filter(|limb| limb.objective() <= NOTHING) {
            minimum.point = with_pressures(task, &minimum.point[..space.variables().len()], &limb);
            (minimum.objective, minimum.evaluation.limb) = (limb.objective(), limb);
            (by, keeps) = (less, true);
        }
    }
    Some(Candidate { minimum, by, keeps, refused: None })
}

/// Solves for the limb and updates its tube shifts alternately until both agree.
pub(super) fn with_shifts(
    task: &LoadedTask,
    space: &LimbSpace,
    mut found: Candidate,
    evaluations: &mut usize,
) -> Candidate {
    for _ in 0..SHIFT_TURNS {
        let shifts = shifts(task, found.limb(), &found.by);
        let shifted = shifts.iter().enumerate().map(|(pose, shift)| shift.change(&found.by.shift(pose)));
        let by = Judgement { shifts: shifts.clone(), ..found.by.clone() };
        let places = places(task, found.limb(), &by);
        if shifted.fold(0.0, f64::max) <= 1.0 && change(&places, &found.by.places) <= 1.0 {
            return found;
        }
        let by = Judgement { places, ..by };
        let at = (&found.minimum.point[..], found.limb());
        let Some(next) = solved(task, space, at, &by, RAISE_STEPS, evaluations) else { break };
        found = next;
        if !found.keeps {
            return found;
        }
    }
    found.keeps = false;
    found
}
