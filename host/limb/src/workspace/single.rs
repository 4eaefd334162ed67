//! The same kinematics in single precision, for pictures: many samples at once, each within a few micrometres of double precision.
//!
//! What makes it short: polynomials of as many terms as `TOLERANCE` needs; a bundle in shares of its own stiffness and radius, so that its stretch
//! is counted from 1 and nothing large is taken off something large; and arcs seen from the start of the limb, without turning to the
//! mount angle and back.

use pulp::Simd;

use super::fit::{fit_with, value};
use super::module::Parts;
use super::single_lanes::{Pack, polynomials};

/// Relative error that the polynomials are made to, from those in double precision.
const TOLERANCE: f64 = 3e-7;
/// Numbers of terms that are tried.
const COUNTS: [usize; 11] = [3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 24];

/// A module in single precision.
#[derive(Clone, Debug)]
pub(super) struct Module {
    shape: Shape,
    /// `sin t/t` and `(1 - cos t)/t^2` in `t^2/largest - 1/2`.
    series: Vec<[f32; 2]>,
    per_square: f32,
    rigid_m: f32,
    axes: usize,
}

#[derive(Clone, Debug)]
enum Shape {
    /// Length, m, by the pressure.
    Straight(Vec<[f32; 2]>),
    /// Length, m, and bend, rad, by the pressure, and cosine and sine of the mount angle.
    Bend(Vec<[f32; 2]>, [f32; 2]),
    /// Length, m, and twist, rad, by the pressure.
    Twist(Vec<[f32; 2]>),
    /// A pressure a tube: stiffness, stiffness times strain, and stiffness against bending, in shares; places in shares of a radius;
    /// length at rest, m, and over that radius.
    Bundle { tubes: Vec<[f32; 3]>, places: Vec<[f32; 2]>, length_m: f32, bends: f32 },
}

impl Module {
    /// From the parts of one in double precision; `None` where these are no numbers.
    pub(super) fn new(parts: &Parts<'_>) -> Option<Self> {
        let [cos, sin] = parts.mount;
        let of = |index: usize, share: f64| value(&parts.powers[index], share);
        let two = |turn: usize| fitted(|share| [of(0, share), of(turn, share)]);
        let shape = if let Some(places_m) = parts.places_m {
            let radius = places_m.iter().map(|[x, y]| x.hypot(*y)).fold(f64::MIN_POSITIVE, f64::max);
            let unit = of(1, 0.0);
            let tubes = fitted(|share| {
                let axial = of(1, share) / unit;
                [axial, axial * (of(0, share) - 1.0), of(2, share) / (unit * radius * radius)]
            })?;
            // Seen from the start of the limb.
            let place = |[x, y]: &[f64; 2]| [cos * x - sin * y, sin * x + cos * y].map(|x| (x / radius) as f32);
            let places = places_m.iter().map(place).collect();
            let (length_m, bends) = (parts.length_m as f32, (parts.length_m / radius) as f32);
            Shape::Bundle { tubes, places, length_m, bends }
        } else if parts.twists {
            Shape::Twist(two(2)?)
        } else if parts.bends {
            Shape::Bend(two(1)?, [cos as f32, sin as f32])
        } else {
            Shape::Straight(two(1)?)
        };
        let largest = parts.largest_rad * parts.largest_rad;
        let series = fitted(|share| {
            let angle = (share * largest).sqrt();
            let half = 0.5 * angle;
            let chord = if half > 1e-4 { half.sin() / half } else { 1.0 - half * half / 6.0 };
            [if angle > 1e-4 { angle.sin() / angle } else { 1.0 - angle * angle / 6.0 }, 0.5 * chord * chord]
        })?;
        let axes = parts.places_m.map_or(1, <[_]>::len);
        Some(Self { shape, series, per_square: (1.0 / largest) as f32, rigid_m: parts.rigid_m as f32, axes })
    }

    /// Number of pressures.
    pub(super) fn axes(&self) -> usize {
        self.axes
    }

    /// A point behind the module, seen from its start. `places` are the pressures as shares of the highest, less 1/2.
    #[inline(always)]
    pub(super) fn carry<S: Simd>(&self, places: &[Pack<S>], [x, y, z]: [Pack<S>; 3]) -> [Pack<S>; 3] {
        let z = z + z.same(self.rigid_m);
        match &self.shape {
            Shape::Straight(powers) => {
                let [length, _] = polynomials(places[0], powers);
                [x, y, z + length]
            }
            Shape::Twist(powers) => {
                let [length, twist] = polynomials(places[0], powers);
                let square = twist * twist;
                let [a, b] = self.arc(square);
                let (sin, cos) = (a * twist, z.same(1.0) - b * square);
                [cos * x - sin * y, sin * x + cos * y, z + length]
            }
            Shape::Bend(powers, [cos, sin]) => {
                let [length, bend] = polynomials(places[0], powers);
                self.bend(length, [bend * z.same(*cos), bend * z.same(*sin)], [x, y, z])
            }
            Shape::Bundle { tubes, places: at, length_m, bends } => {
                let [strain, ux, uy] = free(tubes, at, places);
                let (length, bends) = (z.same(*length_m), z.same(*bends));
                self.bend(length.plus_product(length, strain), [ux * bends, uy * bends], [x, y, z])
            }
        }
    }

    /// `sin t/t` and `(1 - cos t)/t^2` of `t^2`.
    #[inline(always)]
    fn arc<S: Simd>(&self, square: Pack<S>) -> [Pack<S>; 2] {
        polynomials(square.same(-0.5).plus_product(square, square.same(self.per_square)), &self.series)
    }

    /// An arc towards `(bx, by)` carries the point `(x, y, z)`: the part of it that points that way and `z` turn into each other.
    #[inline(always)]
    fn bend<S: Simd>(&self, length: Pack<S>, [bx, by]: [Pack<S>; 2], [x, y, z]: [Pack<S>; 3]) -> [Pack<S>; 3] {
        let square = (bx * bx).plus_product(by, by);
        let [a, b] = self.arc(square);
        let rest = length - (bx * x).plus_product(by, y);
        let out = (a * z).plus_product(b, rest);
        [x.plus_product(bx, out), y.plus_product(by, out), (z.less_product(z * square, b)).plus_product(a, rest)]
    }
}

/// Strain and bends, times the radius, of a bundle of springs: as `bundle.rs` has it, with one division.
#[inline(always)]
fn free<S: Simd>(tubes: &[[f32; 3]], at: &[[f32; 2]], places: &[Pack<S>]) -> [Pack<S>; 3] {
    let zero = places[0].same(0.0);
    let (mut s, mut sx, mut sy) = (zero, zero, zero);
    let (mut xx, mut xy, mut yy) = (zero, zero, zero);
    let (mut r, mut rx, mut ry) = (zero, zero, zero);
    for ([x, y], place) in at.iter().zip(places) {
        let (x, y) = (zero.same(*x), zero.same(*y));
        let [k, m, own] = polynomials(*place, tubes);
        let (kx, ky) = (k * x, k * y);
        (s, sx, sy) = (s + k, sx + kx, sy + ky);
        (xx, xy, yy) = ((xx + own).plus_product(kx, x), xy.plus_product(kx, y), (yy + own).plus_product(ky, y));
        (r, rx, ry) = (r + m, rx.plus_product(m, x), ry.plus_product(m, y));
    }
    // Moments about the centroid of the stiffness, times its sum.
    let (a, b, c) = ((xx * s).less_product(sx, sx), (xy * s).less_product(sx, sy), (yy * s).less_product(sy, sy));
    let (fx, fy) = ((sx * r).less_product(rx, s), (sy * r).less_product(ry, s));
    let all = (a * c).less_product(b, b);
    let per = zero.same(1.0).over(all * s);
    let scale = per * s;
    let ux = (c * fx).less_product(b, fy) * scale;
    let uy = (a * fy).less_product(b, fx) * scale;
    [r.plus_product(sx, ux).plus_product(sy, uy) * (per * all), ux, uy]
}

/// Polynomials in `share - 1/2`, the highest power first.
fn fitted<const N: usize>(f: impl Fn(f64) -> [f64; N]) -> Option<Vec<[f32; N]>> {
    let fit = fit_with(&COUNTS, |share| Some(f(share)), TOLERANCE)?;
    let scaled = |power: usize, n: usize| (fit.powers[n][power] * 2_f64.powi(power as i32)) as f32;
    Some((0..fit.powers[0].len()).rev().map(|power| std::array::from_fn(|n| scaled(power, n))).collect())
}
