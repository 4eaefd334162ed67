//! The free shape of a bundle of straight actuators at different pressures, many samples at once.
//!
//! The same square form as that of `statics::Bundle`, written out: stretch `l` and bends `u` make the sum of
//! `k_i (l - u . r_i - l_i)^2 + b_i u^2` least.

use pulp::Simd;

use super::lanes::Pack;

/// Polynomials of one actuator: free stretch, axial stiffness, and bending stiffness over the square of the circle's radius.
#[derive(Clone, Debug)]
pub(super) struct Tubes {
    pub(super) powers: [Vec<f64>; 3],
    /// Places of the tubes, m.
    pub(super) places_m: Vec<[f64; 2]>,
}

impl Tubes {
    /// Stretch and bends, rad/m, at places on -1 to 1 of the polynomials.
    #[inline(always)]
    pub(super) fn free<S: Simd>(&self, zero: Pack<S>, places: &[Pack<S>]) -> [Pack<S>; 3] {
        let (mut s, mut sx, mut sy) = (zero, zero, zero);
        let (mut xx, mut xy, mut yy) = (zero, zero, zero);
        let (mut r, mut rx, mut ry) = (zero, zero, zero);
        let [stretch, axial, own] = &self.powers;
        for ([x, y], place) in self.places_m.iter().zip(places) {
            let (x, y) = (zero.same(*x), zero.same(*y));
            let (l, k, b) = (place.polynomial(stretch), place.polynomial(axial), place.polynomial(own));
            let (kx, ky, kl) = (k * x, k * y, k * l);
            (s, sx, sy) = (s + k, sx + kx, sy + ky);
            (xx, xy, yy) = (xx + kx * x + b, xy + kx * y, yy + ky * y + b);
            (r, rx, ry) = (r + kl, rx + kl * x, ry + kl * y);
        }
        // The stretch is eliminated first: what is left are moments about the centroid of the stiffness.
        let one = zero.same(1.0);
        let per = one.over(s);
        let (mx, my) = (sx * per, sy * per);
        let (a, b, c) = (xx - mx * sx, xy - mx * sy, yy - my * sy);
        let (fx, fy) = (mx * r - rx, my * r - ry);
        let scale = one.over(a * c - b * b);
        let (ux, uy) = ((c * fx - b * fy) * scale, (a * fy - b * fx) * scale);
        [(r + sx * ux + sy * uy) * per, ux, uy]
    }
}
