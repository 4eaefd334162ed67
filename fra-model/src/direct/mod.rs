//! The direct way to an equilibrium of the tubes that have closed forms: a neo-Hookean wall, bare or wound with a sheet.
//!
//! Newton's method from rest or from an earlier state, on equations that a stiff winding does not make more nonlinear, with a
//! certificate that the answer is connected to its start. From rest it starts at the sum of the power series of the branch, as far as
//! steps to it are certified, and mostly answers in one evaluation; or not at all: then the branch is searched.

mod arithmetic;
mod expansion;
mod forward;
mod kernel;
mod lanes;
mod path;

pub use arithmetic::{Arithmetic, atanh_series};
pub(crate) use lanes::{Column, Columns};
pub use lanes::{LANES, Lanes};

use nalgebra::Vector3;

use crate::branch::LARGEST_PRESSURE;
use crate::goal::Goal;
use crate::parameters::{ActuatorParameters, Families, Material, Placement};
use crate::question::{Question, Way};
use crate::real::{Real, epsilon, real};
use expansion::Expansion;
use kernel::{Constants, Linearised, Norm, Rest, Unknowns};
use path::{CONTRACTION, Path, Stand, part, tolerance, weighted};

/// A tube with closed forms, ready to be solved directly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direct<T> {
    constants: Constants<T>,
    families: Option<Families>,
    norm: Norm<T>,
    stiffness: T,
    /// The branch at rest.
    expansion: Expansion<T>,
}

/// The same without the way from rest: for questions next to a known state alone, in a third of the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near<T> {
    constants: Constants<T>,
    families: Option<Families>,
    norm: Norm<T>,
    /// That of the sheet, `scale/compliance`.
    stiffness: T,
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

impl<T: Real> Near<T> {
    /// `None` for a wall without closed forms.
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Option<Self> {
        let Material::NeoHookean { shear_modulus_pa } = parameters.material else { return None };
        let (zero, one) = (T::zero(), T::one());
        let ratio = parameters.outer_radius_m / parameters.inner_radius_m;
        let x_outer = ratio * ratio;
        let mut constants = Constants {
            x_outer,
            // A thin wall keeps its digits.
            d: (parameters.outer_radius_m - parameters.inner_radius_m)
                * (parameters.outer_radius_m + parameters.inner_radius_m)
                / (parameters.inner_radius_m * parameters.inner_radius_m),
            per_x_fiber: one,
            sin_rho: zero,
            neutral: zero,
            cos: zero,
            sin2: zero,
            compliance: one,
            scale: zero,
        };
        let mut stiffness = zero;
        let fiber = parameters.fiber.filter(|fiber| fiber.modulus_pa > zero);
        if let Some(fiber) = fiber {
            if fiber.placement != Placement::Sheet {
                return None;
            }
            let radius = fiber.radius_m / parameters.inner_radius_m;
            let sin = crate::scalar::Scalar::sin(fiber.angle_rad);
            // At exactly a quarter turn the fibers are axial: the rounding of pi/2 shall not make them twist.
            let cos = crate::scalar::Scalar::cos(fiber.angle_rad);
            constants.cos = if cos.abs() <= epsilon::<T>() { zero } else { cos };
            constants.sin2 = sin * sin;
            constants.neutral = neutral(fiber.angle_rad);
            constants.sin_rho = if fiber.families == Families::One { sin * radius } else { zero };
            constants.per_x_fiber = one / (radius * radius);
            let families = if fiber.families == Families::Two { real::<T>(2.0) } else { one };
            let area = real::<T>(2.0) * radius * fiber.thickness_m / parameters.inner_radius_m;
            stiffness = families * area * (fiber.modulus_pa / shear_modulus_pa);
            (constants.compliance, constants.scale) =
                if stiffness > one { (one / stiffness, one) } else { (one, stiffness) };
        }
        let families = fiber.map(|fiber| fiber.families);
        let norm = Norm { twist: ratio, tension: one / constants.d };
        Some(Self { constants, families, norm, stiffness })
    }

    /// `(R_o/R_i)^2`.
    pub(crate) fn x_outer(&self) -> T {
        self.constants.x_outer
    }

    /// The unloaded equilibrium that meets a goal, if the way to it from the state `(e, w, g)` is certified.
    pub(crate) fn answer(&self, start: &Vector3<T>, goal: &Goal<T>) -> Option<Equilibrium<T>> {
        if twists(self.families) { self.solve::<true>(start, goal) } else { self.solve::<false>(start, goal) }
    }

    fn solve<const TWIST: bool>(&self, start: &Vector3<T>, goal: &Goal<T>) -> Option<Equilibrium<T>> {
        let zero = T::zero();
        let (constants, norm, floor) = (&self.constants, self.norm, tolerance());
        let path = Path::<T, TWIST> { constants, force: zero, torque: zero, norm, floor };
        let end = path.follow(earlier(&self.constants, self.stiffness, start), goal, 0, EVALUATIONS)?;
        (end.pressure.abs() <= real(LARGEST_PRESSURE)).then(|| equilibrium(end))
    }
}

impl<T: Real> Direct<T> {
    /// `None` for a wall without closed forms.
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Option<Self> {
        let Near { constants, families, norm, stiffness } = Near::new(parameters)?;
        let zero = T::zero();
        let rest = Unknowns { e: zero, w: zero, g: zero, tension: zero };
        let expansion = if twists(families) {
            Expansion::new(&constants, &norm, &Linearised::<T, true>::new(&constants, rest))
        } else {
            Expansion::new(&constants, &norm, &Linearised::<T, false>::new(&constants, rest))
        };
        Some(Self { constants, families, norm, stiffness, expansion })
    }

    fn twists_by_itself(&self) -> bool {
        twists(self.families)
    }

    fn path<const TWIST: bool>(&self, force: T, torque: T) -> Path<'_, T, TWIST> {
        Path { constants: &self.constants, force, torque, norm: self.norm, floor: T::zero() }
    }

    /// The answer to a question, if the way to it is certified.
    #[inline(always)]
    pub(crate) fn answer(&self, question: &Question<T>) -> Option<Equilibrium<T>> {
        // Under torque the two families carry different tensions.
        if question.twists && self.families == Some(Families::Two) {
            return None;
        }
        if question.twists { self.solve::<true>(question) } else { self.solve::<false>(question) }
    }

    #[inline(always)]
    fn solve<const TWIST: bool>(&self, question: &Question<T>) -> Option<Equilibrium<T>> {
        let Question { force, torque, goal, .. } = question;
        let path = self.path::<TWIST>(*force, *torque);
        let unloaded = *force == T::zero() && *torque == T::zero();
        let (stand, spent) = match question.start {
            Some(start) => (earlier(&self.constants, self.stiffness, &start), 0),
            None if unloaded => (self.leave_rest::<TWIST>(goal)?, 0),
            None => (self.under_load::<TWIST>(&path)?, 1),
        };
        let end = path.follow(stand, goal, spent, question.budget.min(EVALUATIONS))?;
        let lies_right = match question.way {
            Way::Towards => true,
            Way::Outwards => end.pressure > T::zero(),
            Way::Inwards => end.pressure < T::zero(),
        };
        (lies_right && end.pressure.abs() <= question.within).then_some(())?;
        Some(equilibrium(end))
    }

    /// The first step from rest, without load.
    #[inline(always)]
    fn leave_rest<const TWIST: bool>(&self, goal: &Goal<T>) -> Option<Stand<T>> {
        let Expansion { unit, contraction, terms: [rate, curve, ..], .. } = &self.expansion;
        let (mut z, along, bend) = match goal {
            Goal::Pressure(wanted) => (*wanted * *unit, None, T::zero()),
            Goal::Deformation { weights, value, .. } => {
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
        if let (true, Goal::Deformation { weights, value, .. }) = (arrived, goal) {
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

/// Evaluations after which a way that is not certified is given up.
const EVALUATIONS: u32 = 25;

/// `2 sin^2 - cos^2` of a fiber angle: three times the product of the sines of its sum with and its difference from the neutral angle,
/// which is taken in two parts.
fn neutral<T: Real>(angle_rad: T) -> T {
    let (high, low) = (real::<T>(0.615_479_707_717_895_5), real::<T>(9.524_918_332_549_646e-10));
    let angle = angle_rad.abs();
    let (sum, difference) = ((angle + high) + low, (angle - high) - low);
    real::<T>(3.0) * crate::scalar::Scalar::sin(sum) * crate::scalar::Scalar::sin(difference)
}
