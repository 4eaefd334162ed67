//! Closed-form solver of the tubes whose wall integrals have closed forms: a neo-Hookean wall, bare or wound with a sheet.
//!
//! Newton's method from rest or from an earlier state, on equations that a stiff winding does not make more nonlinear, with a
//! certificate that the answer is connected to its start. From rest it starts at the sum of the power series of the branch, as far as
//! steps to it are certified, and mostly answers in one evaluation; or not at all: then the continuation answers.

mod expansion;
mod forward;
mod kernel;
mod lanes;
mod path;
mod warm_start;

pub(crate) use lanes::Columns;
pub(crate) use warm_start::WarmStart;

use nalgebra::Vector3;

use crate::number::real::{Real, real};
use crate::parameters::{ActuatorParameters, Families};
use crate::solve::query::{Direction, Query};
use crate::solve::residual::Residual;
use expansion::Expansion;
use kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use path::{CONTRACTION, Path, Stand, part, weighted};

/// The closed-form solver of one tube.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosedForm<T> {
    constants: Constants<T>,
    families: Option<Families>,
    norm: Norm<T>,
    stiffness: T,
    /// The branch at rest.
    expansion: Expansion<T>,
}

/// An equilibrium, in the units of the model.
pub(crate) struct Equilibrium<T> {
    /// Axial strain, relative change of the lumen's volume, twist rate.
    pub(crate) e: T,
    pub(crate) w: T,
    pub(crate) g: T,
    /// `P/mu1` and `dw/d(P/mu1)`.
    pub(crate) pressure: T,
    pub(crate) volume_rate: T,
    /// About the largest residual of the equations.
    pub(crate) residual: T,
    pub(crate) evaluations: u32,
}

impl<T: Real> ClosedForm<T> {
    /// `None` for a wall without closed forms.
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Option<Self> {
        // Where it is returned: it is large, and a copy costs a device as much as half of it.
        let mut new = Self::near_rest(parameters);
        if let Some(closed_form) = &mut new {
            closed_form.certify();
        }
        new
    }

    /// The same for low pressures: only the first step from rest is certified.
    #[inline(always)]
    pub(crate) fn near_rest(parameters: &ActuatorParameters<T>) -> Option<Self> {
        let WarmStart { constants, families, norm, stiffness } = WarmStart::new(parameters)?;
        let zero = T::zero();
        let rest = Unknowns { e: zero, w: zero, g: zero, tension: zero };
        let expansion = if twists(families) {
            Expansion::new(&constants, &norm, &Linearised::<T, true>::new(&constants, rest))
        } else {
            Expansion::new(&constants, &norm, &Linearised::<T, false>::new(&constants, rest))
        };
        Some(Self { constants, families, norm, stiffness, expansion })
    }

    /// Certifies the steps after the first from rest.
    pub(crate) fn certify(&mut self) {
        let zero = T::zero();
        (self.expansion.reach, self.expansion.short) = if self.twists_by_itself() {
            self.expansion.certified(&self.path::<true>(zero, zero))
        } else {
            self.expansion.certified(&self.path::<false>(zero, zero))
        };
    }

    /// `(R_o/R_i)^2`.
    pub(crate) fn x_outer(&self) -> T {
        self.constants.x_outer
    }

    fn twists_by_itself(&self) -> bool {
        twists(self.families)
    }

    fn path<const TWIST: bool>(&self, force: T, torque: T) -> Path<'_, T, TWIST> {
        Path { constants: &self.constants, force, torque, norm: self.norm, floor: T::zero() }
    }

    /// The answer to a query, if the path to it is certified.
    #[inline(always)]
    pub(crate) fn answer(&self, query: &Query<T>) -> Option<Equilibrium<T>> {
        // Under torque the two families carry different tensions.
        if query.twists && self.families == Some(Families::Two) {
            return None;
        }
        if query.twists { self.solve::<true>(query) } else { self.solve::<false>(query) }
    }

    #[inline(always)]
    fn solve<const TWIST: bool>(&self, query: &Query<T>) -> Option<Equilibrium<T>> {
        let Query { force, torque, residual, .. } = query;
        let path = self.path::<TWIST>(*force, *torque);
        let unloaded = *force == T::zero() && *torque == T::zero();
        let (stand, spent) = match query.start {
            Some(start) => (earlier(&self.constants, self.stiffness, &start), 0),
            None if unloaded => (self.leave_rest::<TWIST>(residual)?, 0),
            None => (self.under_load::<TWIST>(&path)?, 1),
        };
        let end = path.follow(stand, residual, spent, query.budget.min(EVALUATIONS))?;
        let lies_right = match query.direction {
            Direction::Towards => true,
            Direction::Outwards => end.pressure > T::zero(),
            Direction::Inwards => end.pressure < T::zero(),
        };
        (lies_right && end.pressure.abs() <= query.within).then_some(())?;
        Some(equilibrium(end))
    }

    /// The first step from rest, without load.
    #[inline(always)]
    fn leave_rest<const TWIST: bool>(&self, residual: &Residual<T>) -> Option<Stand<T>> {
        let Expansion { unit, contraction, terms: [rate, curve, ..], .. } = &self.expansion;
        let (mut z, along, bend) = match residual {
            Residual::Pressure(wanted) => (*wanted * *unit, None, T::zero()),
            Residual::Deformation { weights, value, .. } => {
                let along = weighted(weights, rate);
                let z = *value / along;
                (z, Some(along), weighted(weights, curve) * z / along)
            }
        };
        let contraction = (*contraction * z.abs()).max(bend.abs());
        let arrived = contraction <= real(CONTRACTION);
        if !arrived {
            z *= part(contraction)?;
        }
        let (mut at, last) = (self.expansion.at::<TWIST>(z), self.norm.size::<TWIST>(rate) * z.abs());
        if let (true, Residual::Deformation { weights, value, .. }) = (arrived, residual) {
            // The series reversed to second order, and a step of Newton's method on the whole of it.
            z *= T::one() - bend + (bend + bend) * bend;
            let slope = self.expansion.slope::<TWIST>(z);
            at = self.expansion.at::<TWIST>(z);
            at = at.plus(slope.times((*value - weighted(weights, &at)) / weighted(weights, &slope)));
        }
        Some(Stand {
            at,
            pressure: Some(z / *unit),
            arrived,
            last,
            along: along.map(|along| along * *unit),
            plain: None,
        })
    }

    /// Rest under the load, to second order.
    #[cold]
    #[inline(never)]
    fn under_load<const TWIST: bool>(&self, path: &Path<'_, T, TWIST>) -> Option<Stand<T>> {
        let (c, zero) = (&self.constants, T::zero());
        let rest = Unknowns { e: zero, w: zero, g: zero, tension: zero };
        let lin = Linearised::<T, TWIST>::new(c, rest);
        let torque = if TWIST { path.torque } else { zero };
        let first = lin.solve(c, Rest { e: path.force, w: zero, g: torque, tension: zero });
        let second = lin.solve(c, lin.curvature(c, first));
        (path.contraction(&first, &second) <= real(CONTRACTION)).then_some(())?;
        let at = first.plus(second);
        Some(Stand { at, pressure: Some(zero), arrived: false, last: path.size(&first), along: None, plain: None })
    }
}

#[inline(always)]
fn equilibrium<T>(end: path::End<T>) -> Equilibrium<T> {
    let path::End { at: Unknowns { e, w, g, .. }, pressure, volume_rate, residual, evaluations } = end;
    Equilibrium { e, w, g, pressure, volume_rate, residual, evaluations }
}

/// A state given from outside; its tension follows from its strain.
fn earlier<T: Real>(constants: &Constants<T>, stiffness: T, start: &Vector3<T>) -> Stand<T> {
    let Constants { per_x_fiber, cos, sin2, sin_rho, .. } = *constants;
    let (e, w, g) = (start.x, start.y, start.z);
    let (one, two) = (T::one(), real::<T>(2.0));
    let eta = (w * per_x_fiber - e) / (one + e);
    let shear = g * sin_rho;
    let strain = cos * cos * eta + (one + eta) * shear * (cos + cos + shear) + sin2 * e * (two + e);
    let tension = strain * stiffness;
    let last = T::max_value().unwrap_or(one);
    Stand { at: Unknowns { e, w, g, tension }, pressure: None, arrived: false, last, along: None, plain: None }
}

/// Two families twist only under torque.
fn twists(families: Option<Families>) -> bool {
    families == Some(Families::One)
}

/// Evaluations after which a path without a certificate is given up.
const EVALUATIONS: u32 = 25;
