//! A query to the branch of equilibria, and the choice of arithmetic for its answer.

use nalgebra::Vector3;

use crate::number::double_double::DoubleDouble;
use crate::number::real::{Real, real};
use crate::number::scalar::Scalar;
use crate::solve::continuation::{Continuation, Outcome, Point};
use crate::solve::energy::Wall;
use crate::solve::refine::{Wanted, refined};
use crate::solve::residual::Residual;

/// Cost of one double-double evaluation, in plain ones.
const COST_OF_DOUBLE_DOUBLE: u32 = 16;
/// Fewest double-double evaluations worth a start.
const LEAST_OF_DOUBLE_DOUBLE: u32 = 60;

/// Largest `d ln P/d ln V` taken for that of a limit point.
const SLOPE_OF_A_LIMIT: f64 = 1e-2;

/// Direction of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Direction of the root to first order.
    Towards,
    /// Towards larger volume.
    Outwards,
    /// Towards smaller volume.
    Inwards,
}

/// A query to the branch, in the units of the model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Query<T> {
    /// External force and torque.
    pub(crate) force: T,
    pub(crate) torque: T,
    /// Whether the twist rate is an unknown.
    pub(crate) twists: bool,
    /// Evaluations after which the search gives up.
    pub(crate) budget: u32,
    pub(crate) residual: Residual<T>,
    /// A state `(e, w, g)` to start from; else the search starts at rest under the load.
    pub(crate) start: Option<Vector3<T>>,
    /// Whether the start is itself a root, and the search is for the next one.
    pub(crate) is_left: bool,
    pub(crate) direction: Direction,
    /// Largest `|P|/mu1` of the search.
    pub(crate) within: T,
}

/// Outcome of a search, and its cost.
pub(crate) struct Answer<T> {
    pub(crate) found: Outcome<T>,
    pub(crate) iterations: u32,
}

impl<T: Real> Query<T> {
    /// The answer in plain arithmetic where that resolves it, else in double-double arithmetic.
    pub(crate) fn answer(&self, wall: &Wall<T>) -> Answer<T> {
        let mut spent = 0;
        if !wall.is_too_stiff_for_plain_arithmetic() {
            let plain = self.search(wall);
            spent = plain.iterations;
            let settled = self.settled(wall, plain.found, &mut spent);
            if settled.is_some() || spent >= self.budget {
                return Answer { found: settled.unwrap_or(Outcome::Failed(plain.found.point())), iterations: spent };
            }
        }
        let budget = ((self.budget - spent) / COST_OF_DOUBLE_DOUBLE).max(LEAST_OF_DOUBLE_DOUBLE);
        let exact = Query { budget, ..self.map(DoubleDouble::from) }.search(&wall.in_double_double());
        let found = exact.found.map(|point| point.map(DoubleDouble::round));
        spent += exact.iterations;
        let settled = self.settled(wall, found, &mut spent);
        Answer { found: settled.unwrap_or(found), iterations: spent }
    }

    /// The outcome without the rounding of plain arithmetic; `None` where that leaves it in doubt.
    fn settled(&self, wall: &Wall<T>, found: Outcome<T>, spent: &mut u32) -> Option<Outcome<T>> {
        let torque = self.twists.then_some(self.torque);
        let mut refine = |point: &Point<T>, wanted| refined(wall, self.force, torque, wanted, point, spent);
        match found {
            Outcome::Root(point) => refine(&point, Wanted::Residual(self.residual)).map(Outcome::Root),
            Outcome::Limit(point) => {
                // Rounding may hide a root just before the limit.
                let side = |point: &Point<T>| self.residual.measure(point).0 > T::zero();
                let same_side = |refined: &Point<T>| is_limit(refined) && side(refined) == side(&point);
                refine(&point, Wanted::Volume).filter(same_side).map(Outcome::Limit)
            }
            Outcome::Unreached(_) | Outcome::Failed(_) => None,
        }
    }
}

/// Whether the pressure hardly changes with the volume here: a limit point, and not rounding that looked like one.
fn is_limit<T: Real>(point: &Point<T>) -> bool {
    let relative_slope = point.slope.abs() * (T::one() + point.at.y);
    relative_slope <= real::<T>(SLOPE_OF_A_LIMIT) * point.pressure.abs()
}

impl<T: Scalar> Query<T> {
    fn search(&self, wall: &Wall<T>) -> Answer<T> {
        let Self { force, torque, twists, budget, .. } = *self;
        let continuation = Continuation { wall, force, torque, twists, budget };
        let mut iterations = 0;
        let begin = match self.start {
            Some(start) => continuation.resume(start, &mut iterations),
            None => continuation.at_rest(&mut iterations),
        };
        let found = match begin {
            Outcome::Root(point) if point.slope > T::zero() => {
                let outwards = match self.direction {
                    Direction::Towards => self.residual.lies_outwards(&point),
                    Direction::Outwards => true,
                    Direction::Inwards => false,
                };
                let begin = if self.is_left {
                    continuation.leave(point, &self.residual, outwards, &mut iterations)
                } else {
                    Outcome::Root(point)
                };
                match begin {
                    Outcome::Root(begin) => {
                        continuation.search(begin, &self.residual, outwards, self.within, &mut iterations)
                    }
                    ended => ended,
                }
            }
            // The load alone has no stable equilibrium: no pressure is to blame.
            Outcome::Root(point) | Outcome::Limit(point) => Outcome::Unreached(point),
            ended => ended,
        };
        Answer { found, iterations }
    }

    fn map<U: Scalar>(&self, f: impl Fn(T) -> U) -> Query<U> {
        Query {
            force: f(self.force),
            torque: f(self.torque),
            twists: self.twists,
            budget: self.budget,
            residual: self.residual.map(&f),
            start: self.start.map(|at| at.map(&f)),
            is_left: self.is_left,
            direction: self.direction,
            within: f(self.within),
        }
    }
}
