//! One module of the fast kinematics: from pressures to the rigid motion of what it carries.

use fra_model::{Motion, Segment};
use pulp::Simd;
use serde::Serialize;

use super::bundle::Tubes;
use super::fit::{Fit, fit};
use super::lanes::Pack;
use crate::LimbModule;
use crate::statics::{Bundle, Tangent};

/// Relative error that the polynomials are made to.
const TOLERANCE: f64 = 1e-10;
/// Terms of the series of sine and cosine go on until they are below this.
const LEAST_TERM: f64 = 1e-16;

/// What a module does with its pressures.
#[derive(Clone, Debug)]
enum Shape {
    /// Length, m; bend, rad; twist, rad: all actuators at one pressure.
    One([Vec<f64>; 3]),
    /// Actuators at a pressure each.
    Each(Tubes),
}

/// The polynomials of a module, for other programs.
#[derive(Clone, Debug, Serialize)]
pub struct ModuleTable {
    /// Number of pressures.
    pub axes: usize,
    /// The first of them: segments of a series share theirs.
    pub first_axis: usize,
    /// Length at rest, m.
    pub length_m: f64,
    /// Length of the rigid part behind it, m.
    pub rigid_m: f64,
    /// Cosine and sine of the mount angle.
    pub mount: [f64; 2],
    /// Whether it bends.
    pub bends: bool,
    /// Whether it twists.
    pub twists: bool,
    /// Coefficients of powers of `2 s - 1` for a pressure's share `s`: of length (m), bend and twist (rad), or, for a pressure each, of an
    /// actuator's stretch, `EA` (N) and `EI` (N m2).
    pub powers: [Vec<f64>; 3],
    /// Places of the actuators with a pressure each, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub places_m: Option<Vec<[f64; 2]>>,
}

/// The numbers of a module, as [`ModuleTable`] has them.
pub(super) struct Parts<'a> {
    pub(super) powers: &'a [Vec<f64>; 3],
    pub(super) places_m: Option<&'a [[f64; 2]]>,
    pub(super) bends: bool,
    pub(super) twists: bool,
    pub(super) length_m: f64,
    pub(super) mount: [f64; 2],
    pub(super) rigid_m: f64,
    /// The largest angle it may turn by, rad.
    pub(super) largest_rad: f64,
}

/// A module, ready to be asked often.
#[derive(Clone, Debug)]
pub(super) struct Module {
    shape: Shape,
    bends: bool,
    twists: bool,
    length_m: f64,
    /// Cosine and sine of the mount angle.
    mount: [f64; 2],
    rigid_m: f64,
    /// The largest angle it may turn by, rad.
    largest_rad: f64,
    /// Series of `sin t/t` and of `(1 - cos t)/t^2` in `t^2`.
    series: [Vec<f64>; 2],
    /// Largest relative error of its polynomials.
    pub(super) error: f64,
}

impl Module {
    /// The module with its pressures from 0 to `pressure_max_pa`: one for all actuators, or one for each. `None` where the model has no
    /// answer in this range.
    pub(super) fn new(module: &LimbModule, pressure_max_pa: f64, each: bool) -> Option<Self> {
        let (shape, error, angle) =
            if each { each_pressure(module, pressure_max_pa)? } else { one_pressure(module, pressure_max_pa)? };
        let (sin, cos) = module.mount_angle_rad().sin_cos();
        Some(Self {
            shape,
            bends: each || module.motion == Motion::Bending,
            twists: module.motion == Motion::Twisting,
            length_m: module.length_m(),
            mount: [cos, sin],
            rigid_m: module.rigid_length_m(),
            largest_rad: angle,
            series: series(angle),
            error,
        })
    }

    /// Number of pressures.
    pub(super) fn axes(&self) -> usize {
        match &self.shape {
            Shape::One(_) => 1,
            Shape::Each(tubes) => tubes.places_m.len(),
        }
    }

    /// What it is made of.
    pub(super) fn parts(&self) -> Parts<'_> {
        let (powers, places_m) = match &self.shape {
            Shape::One(powers) => (powers, None),
            Shape::Each(tubes) => (&tubes.powers, Some(tubes.places_m.as_slice())),
        };
        let Self { bends, twists, length_m, mount, rigid_m, largest_rad, .. } = *self;
        Parts { powers, places_m, bends, twists, length_m, mount, rigid_m, largest_rad }
    }

    /// Its polynomials.
    pub(super) fn table(&self, first_axis: usize) -> ModuleTable {
        let Parts { powers, places_m, bends, twists, length_m, mount, rigid_m, .. } = self.parts();
        let (powers, places_m) = (powers.clone(), places_m.map(<[_]>::to_vec));
        ModuleTable { axes: self.axes(), first_axis, length_m, rigid_m, mount, bends, twists, powers, places_m }
    }

    /// A point behind the module, seen from its start. `shares` are the pressures as shares of the highest.
    #[inline(always)]
    pub(super) fn carry<S: Simd>(&self, shares: &[Pack<S>], [x, y, z]: [Pack<S>; 3]) -> [Pack<S>; 3] {
        let (zero, one, two) = (z.same(0.0), z.same(1.0), z.same(2.0));
        let z = z + z.same(self.rigid_m);
        let (length, bend, twist) = match &self.shape {
            Shape::One([length, bend, twist]) => {
                let place = shares[0] * two - one;
                (place.polynomial(length), [place.polynomial(bend), zero], place.polynomial(twist))
            }
            Shape::Each(tubes) => {
                let mut places = [one; 9];
                for (place, share) in places.iter_mut().zip(shares) {
                    *place = *share * two - one;
                }
                let [stretch, ux, uy] = tubes.free(zero, &places[..shares.len().min(9)]);
                let length = z.same(self.length_m);
                (stretch * length, [ux * length, uy * length], zero)
            }
        };
        if self.twists {
            return self.turn(twist, [x, y, z + length]);
        }
        if !self.bends {
            return [x, y, z + length];
        }
        self.bend(length, bend, [x, y, z])
    }

    #[inline(always)]
    fn turn<S: Simd>(&self, twist: Pack<S>, [x, y, z]: [Pack<S>; 3]) -> [Pack<S>; 3] {
        let square = twist * twist;
        let sin = square.polynomial(&self.series[0]) * twist;
        let cos = z.same(1.0) - square.polynomial(&self.series[1]) * square;
        [cos * x - sin * y, sin * x + cos * y, z]
    }

    /// The rotation by the vector `t = (-b_y, b_x, 0)` and the arc that leads there.
    #[inline(always)]
    fn bend<S: Simd>(&self, length: Pack<S>, [bx, by]: [Pack<S>; 2], [x, y, z]: [Pack<S>; 3]) -> [Pack<S>; 3] {
        let (cos, sin) = (z.same(self.mount[0]), z.same(self.mount[1]));
        let (x, y) = (cos * x + sin * y, cos * y - sin * x);
        let square = bx * bx + by * by;
        let (a, b) = (square.polynomial(&self.series[0]), square.polynomial(&self.series[1]));
        // The part of the point that lies where the arc goes and `z` turn into each other.
        let rest = length - (bx * x + by * y);
        let out = a * z + b * rest;
        let (new_x, new_y) = (x + bx * out, y + by * out);
        [cos * new_x - sin * new_y, sin * new_x + cos * new_y, z - b * square * z + a * rest]
    }
}

/// A shape, its relative error, and the largest angle it may turn by.
type Made = (Shape, f64, f64);

fn one_pressure(module: &LimbModule, pressure_max_pa: f64) -> Option<Made> {
    let at = |share: f64| {
        let segment = segment(module, share * pressure_max_pa)?;
        Some([segment.length_m, segment.bend_angle_rad, segment.twist_rad])
    };
    let Fit { powers, error } = fit(at, TOLERANCE)?;
    let end = at(1.0)?;
    Some((Shape::One(powers), error, 1.5 * (end[1].abs() + end[2].abs()) + 0.1))
}

/// The centre line of the module with all actuators at one pressure.
fn segment(module: &LimbModule, pressure_pa: f64) -> Option<Segment<f64>> {
    if module.is_by_section() {
        return Some(module.link(&module.curve.at(pressure_pa)).segment);
    }
    let [stretch, bend_rad_per_m, twist_rad_per_m] = if module.is_restrained() {
        let free = Bundle::new(module, &vec![pressure_pa; module.channels.len()], module.bays())?.free;
        [free.stretch, 0.0, free.twist_rad_per_m]
    } else {
        let tangent = Tangent::of(&module.actuator, pressure_pa)?;
        [tangent.stretch, tangent.bend_rad_per_m, tangent.twist_rad_per_m]
    };
    Some(Segment {
        length_m: module.length_m() * stretch,
        bend_angle_rad: module.length_m() * bend_rad_per_m,
        twist_rad: module.length_m() * twist_rad_per_m,
    })
}

fn each_pressure(module: &LimbModule, pressure_max_pa: f64) -> Option<Made> {
    let at = |share: f64| {
        let tangent = Tangent::of(&module.actuator, share * pressure_max_pa)?;
        Some([tangent.stretch, tangent.axial_n, tangent.bending_nm2])
    };
    let Fit { powers, error } = fit(at, TOLERANCE)?;
    // No bend is larger than that of two tubes side by side without any stiffness of their own.
    let strain = (at(1.0)?[0] - at(0.0)?[0]).abs();
    let angle =
        2.0 * strain * module.length_m() / module.reach_m().max(0.5 * module.actuator.parameters().outer_radius_m);
    let places_m = module.positions_m();
    Some((Shape::Each(Tubes { powers, places_m }), error, angle + 0.1))
}

/// Coefficients of `sin t/t` and `(1 - cos t)/t^2` in `t^2`, as many as angles up to `angle` need.
fn series(angle: f64) -> [Vec<f64>; 2] {
    let square = angle * angle;
    let (mut sine, mut cosine) = (vec![1.0], vec![0.5]);
    let (mut at, mut term) = (1.0, 1.0);
    let mut k = 1.0;
    while term > LEAST_TERM || k < 4.0 {
        at /= -(2.0 * k) * (2.0 * k + 1.0);
        sine.push(at);
        cosine.push(at / (2.0 * k + 2.0));
        term = (at * square.powf(k)).abs();
        k += 1.0;
    }
    [sine, cosine]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_sine_and_cosine() {
        for largest in [0.0_f64, 0.5, 2.0, 7.0] {
            let [sine, cosine] = series(largest);
            for share in [0.1, 0.5, 1.0] {
                let angle = largest.max(0.1) * share;
                let square = angle * angle;
                let value = |series: &[f64]| series.iter().rev().fold(0.0, |sum, term| sum * square + term);
                assert!((value(&sine) - angle.sin() / angle).abs() < 1e-13);
                assert!((value(&cosine) - (1.0 - angle.cos()) / (angle * angle)).abs() < 1e-10);
            }
        }
    }
}
