//! Newton's last steps in double-double arithmetic.
//!
//! The tension of a stiff fiber is a tiny strain times a huge modulus: in plain arithmetic the rounding of the strain comes out
//! magnified by `mu2/mu1`. Here strains, loads and corrections are computed in [`DoubleDouble`]. The remaining error is the rounding of
//! the answer itself and of the parameters.

use nalgebra::Vector3;

use crate::number::double_double::DoubleDouble;
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::{Scalar, dot};
use crate::solve::continuation::Point;
use crate::solve::energy::{Derivatives, Wall};
use crate::solve::residual::Residual;

/// Most corrections: the first usually does, near a limit point it takes several.
const CORRECTIONS: u32 = 12;
/// Rounding, in units in the last place and as estimated from the magnitudes of all terms, that is left as it is.
const TOLERATED: f64 = 600.0;

/// The equilibrium to refine, of those under a load.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wanted<T> {
    /// The root of this residual.
    Residual(Residual<T>),
    /// The equilibrium at this volume.
    Volume,
}

/// The point with the rounding of its state and pressure taken out, where that is worth the work; `None` where Newton's corrections do
/// not settle near it. The torque is `None` where the tube cannot twist.
pub(crate) fn refined<T: Real>(
    wall: &Wall<T>,
    force: T,
    torque: Option<T>,
    wanted: Wanted<T>,
    point: &Point<T>,
    iterations: &mut u32,
) -> Option<Point<T>> {
    if is_exact_enough(point) {
        return Some(*point);
    }
    let wall = wall.in_double_double();
    let mut at = point.at.map(DoubleDouble::from);
    let mut last = T::max_value()?;
    for _ in 0..CORRECTIONS {
        *iterations += 1;
        let local = Local::new(&wall.derivatives(at.x, at.y, at.z), force, torque)?;
        let correction = local.correction(&at, wanted);
        let size = correction.map(|c| c.round().abs()).amax();
        let scale = at.map(|c| c.round().abs()).amax();
        at += correction;
        if size <= epsilon::<T>() * real::<T>(0.25) * scale {
            let refined = local.point(&at, &correction);
            return belongs_to(&refined, point, wanted).then_some(refined);
        }
        if !size.is_finite() || size >= last {
            return None;
        }
        last = size;
    }
    None
}

fn is_exact_enough<T: Real>(point: &Point<T>) -> bool {
    let along = point.tangent.abs() * (point.pressure_noise / point.slope.abs());
    let noise = (point.settling_noise + along).amax();
    let tolerated = real::<T>(TOLERATED) * epsilon::<T>();
    noise <= tolerated * point.at.amax() && point.pressure_noise <= tolerated * point.pressure.abs()
}

/// Whether a refined point belongs to the given one: near it, and on the stable side of a limit point.
fn belongs_to<T: Real>(refined: &Point<T>, point: &Point<T>, wanted: Wanted<T>) -> bool {
    let near = (refined.at - point.at).amax() <= real::<T>(0.25) * point.at.amax();
    let stable = refined.slope > T::zero() || matches!(wanted, Wanted::Volume);
    near && stable && refined.pressure.is_finite()
}

/// The equilibrium equations linearised at one state.
struct Local<T> {
    /// Change of `(e, 0, g)` that balances the loads at constant volume.
    settling: Vector3<DoubleDouble<T>>,
    /// `d(e, w, g)/dw` under constant loads.
    tangent: Vector3<DoubleDouble<T>>,
    /// `P/mu1` once settled, and its slope along the branch.
    pressure: DoubleDouble<T>,
    slope: DoubleDouble<T>,
    residual: T,
}

impl<T: Real> Local<T> {
    /// `None` where the state is not stable at constant volume.
    fn new(d: &Derivatives<DoubleDouble<T>>, force: T, torque: Option<T>) -> Option<Self> {
        let zero = DoubleDouble::zero();
        let force_rest = DoubleDouble::from(force) - d.gradient.x;
        let torque_rest = torque.map_or(zero, |torque| DoubleDouble::from(torque) - d.gradient.z);
        let (ee, eg, gg) = (d.hessian[(0, 0)], d.hessian[(0, 2)], d.hessian[(2, 2)]);
        let twists = torque.is_some();
        let rest = gg - eg * eg / ee;
        if !(ee > zero && (!twists || rest > zero)) {
            return None;
        }
        let solve = |by_e: DoubleDouble<T>, by_g: DoubleDouble<T>| {
            let dg = if twists { (by_g - eg / ee * by_e) / rest } else { zero };
            let de = if twists { (by_e - eg * dg) / ee } else { by_e / ee };
            (de, dg)
        };
        let (de, dg) = solve(force_rest, torque_rest);
        let (e_w, g_w) = solve(-d.hessian[(0, 1)], -d.hessian[(2, 1)]);
        Some(Self {
            settling: Vector3::new(de, zero, dg),
            tangent: Vector3::new(e_w, DoubleDouble::one(), g_w),
            pressure: d.gradient.y + d.hessian[(0, 1)] * de + d.hessian[(2, 1)] * dg,
            slope: d.hessian[(1, 1)] + d.hessian[(0, 1)] * e_w + d.hessian[(2, 1)] * g_w,
            residual: force_rest.round().abs().max(torque_rest.round().abs()),
        })
    }

    fn correction(&self, at: &Vector3<DoubleDouble<T>>, wanted: Wanted<T>) -> Vector3<DoubleDouble<T>> {
        let dw = match wanted {
            Wanted::Residual(Residual::Pressure(pressure)) => {
                (DoubleDouble::from(pressure) - self.pressure) / self.slope
            }
            Wanted::Residual(Residual::Deformation { weights, value, .. }) => {
                let weights = weights.map(DoubleDouble::from);
                (DoubleDouble::from(value) - dot(&weights, at) - dot(&weights, &self.settling))
                    / dot(&weights, &self.tangent)
            }
            Wanted::Volume => DoubleDouble::zero(),
        };
        self.settling + self.tangent * dw
    }

    /// The point after the last, negligible correction.
    fn point(&self, at: &Vector3<DoubleDouble<T>>, correction: &Vector3<DoubleDouble<T>>) -> Point<T> {
        Point {
            at: at.map(DoubleDouble::round),
            tangent: self.tangent.map(DoubleDouble::round),
            pressure: (self.pressure + self.slope * correction.y).round(),
            slope: self.slope.round(),
            residual: self.residual,
            pressure_noise: T::zero(),
            settling_noise: Vector3::zeros(),
        }
    }
}
