//! A question to the branch of equilibria, and the arithmetic it takes to answer it.

use nalgebra::Vector3;

use crate::branch::{Branch, Found, Point};
use crate::energy::Wall;
use crate::goal::Goal;
use crate::real::{Real, real};
use crate::refine::{Wanted, refined};
use crate::scalar::Scalar;
use crate::two::Two;

/// One evaluation with twice the digits costs about this many plain ones.
const COST_OF_TWO: u32 = 16;
/// Fewest evaluations with twice the digits that are worth a beginning.
const LEAST_OF_TWO: u32 = 60;

/// Largest `d ln P/d ln V` taken for that of a limit point.
const SLOPE_OF_A_LIMIT: f64 = 1e-2;

/// Which way a search goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// Where the goal lies to first order.
    Towards,
    /// Towards larger volume.
    Outwards,
    /// Towards smaller volume.
    Inwards,
}

/// What is asked of the branch; in the units of the model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<T> {
    /// External force and torque.
    pub(crate) force: T,
    pub(crate) torque: T,
    /// Whether the twist rate is an unknown.
    pub(crate) twists: bool,
    /// Evaluations after which the search gives up.
    pub(crate) budget: u32,
    pub(crate) goal: Goal<T>,
    /// A state `(e, w, g)` to start from; else the search starts at rest under the load.
    pub(crate) start: Option<Vector3<T>>,
    pub(crate) way: Way,
    /// Largest `|P|/mu1` looked at.
    pub(crate) within: T,
}

/// Where a search ended, and what it took.
pub(crate) struct Answer<T> {
    pub(crate) found: Found<T>,
    pub(crate) iterations: u32,
}

impl<T: Real> Question<T> {
    /// The answer in plain arithmetic where that can tell, else with twice the digits.
    pub(crate) fn answer(&self, wall: &Wall<T>) -> Answer<T> {
        let mut spent = 0;
        if !wall.is_too_stiff_for_plain_arithmetic() {
            let plain = self.search(wall);
            spent = plain.iterations;
            let settled = self.settled(wall, plain.found, &mut spent);
            if settled.is_some() || spent >= self.budget {
                return Answer { found: settled.unwrap_or(Found::Failed(plain.found.point())), iterations: spent };
            }
        }
        let budget = ((self.budget - spent) / COST_OF_TWO).max(LEAST_OF_TWO);
        let exact = Question { budget, ..self.map(Two::from) }.search(&wall.of_two());
        let found = exact.found.map(|point| point.map(Two::round));
        spent += exact.iterations;
        let settled = self.settled(wall, found, &mut spent);
        Answer { found: settled.unwrap_or(found), iterations: spent }
    }

    /// The outcome without the rounding of plain arithmetic; `None` where that leaves it in doubt.
    fn settled(&self, wall: &Wall<T>, found: Found<T>, spent: &mut u32) -> Option<Found<T>> {
        let torque = self.twists.then_some(self.torque);
        let mut refine = |point: &Point<T>, wanted| refined(wall, self.force, torque, wanted, point, spent);
        match found {
            Found::Root(point) => refine(&point, Wanted::Goal(self.goal)).map(Found::Root),
            Found::Limit(point) => {
                // Rounding may have hidden that the goal is just met before the limit.
                let side = |point: &Point<T>| self.goal.measure(point).0 > T::zero();
                let same_side = |refined: &Point<T>| is_limit(refined) && side(refined) == side(&point);
                refine(&point, Wanted::Volume).filter(same_side).map(Found::Limit)
            }
            Found::Unreached(_) | Found::Failed(_) => None,
        }
    }
}

/// Whether the pressure hardly changes with the volume here: a limit point, and not rounding that looked like one.
fn is_limit<T: Real>(point: &Point<T>) -> bool {
    let relative_slope = point.slope.abs() * (T::one() + point.at.y);
    relative_slope <= real::<T>(SLOPE_OF_A_LIMIT) * point.pressure.abs()
}

impl<T: Scalar> Question<T> {
    fn search(&self, wall: &Wall<T>) -> Answer<T> {
        let Self { force, torque, twists, budget, .. } = *self;
        let branch = Branch { wall, force, torque, twists, budget };
        let mut iterations = 0;
        let begin = match self.start {
            Some(start) => branch.resume(start, &mut iterations),
            None => branch.at_rest(&mut iterations),
        };
        let found = match begin {
            Found::Root(point) if point.slope > T::zero() => {
                let outwards = match self.way {
                    Way::Towards => self.goal.lies_outwards(&point),
                    Way::Outwards => true,
                    Way::Inwards => false,
                };
                branch.search(point, &self.goal, outwards, self.within, &mut iterations)
            }
            // The load alone has no stable equilibrium: no pressure is to blame.
            Found::Root(point) | Found::Limit(point) => Found::Unreached(point),
            ended => ended,
        };
        Answer { found, iterations }
    }

    fn map<U: Scalar>(&self, f: impl Fn(T) -> U) -> Question<U> {
        Question {
            force: f(self.force),
            torque: f(self.torque),
            twists: self.twists,
            budget: self.budget,
            goal: self.goal.map(&f),
            start: self.start.map(|at| at.map(&f)),
            way: self.way,
            within: f(self.within),
        }
    }
}
