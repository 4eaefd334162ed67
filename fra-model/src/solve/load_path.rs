//! Continuation in the external load at zero pressure.

use nalgebra::Vector3;

use crate::number::scalar::{Scalar, largest};
use crate::solve::continuation::{
    BLINDING, Continuation, FAR, Outcome, SETTLE_ITERATIONS, STALL, gradient_noise, is_plain, positive,
};
use crate::solve::energy::Derivatives;

/// Smallest step of the load relative to what is applied, and to all of it.
const SMALLEST_SHARE: f64 = 1e-6;
/// Longest move of one step, and the largest part of it that may come after its first prediction.
const LONGEST_MOVE: f64 = 0.3;
const CORRECTION: f64 = 0.25;
/// Largest change of the compliance in one step, as a factor, and largest miss of the move by its mean, as a share.
const CHANGE: f64 = 3.0;
const MISS: f64 = 0.1;

/// An equilibrium at zero pressure under a share of the load.
struct Loaded<T> {
    at: Vector3<T>,
    /// `d(e, w, g)` per share of the load.
    rate: Vector3<T>,
    /// Effect of rounding on `at`.
    noise: T,
}

impl<T: Scalar> Continuation<'_, T> {
    /// The state at zero pressure under the external load, reached from the unloaded one by raising the load.
    pub(crate) fn at_rest(&self, iterations: &mut u32) -> Outcome<T> {
        let origin = Vector3::repeat(T::zero());
        let Some(mut here) = self.loaded(origin, iterations) else { return Outcome::Limit(self.point(origin)) };
        let (mut share, mut step) = (T::zero(), T::one());
        let unloaded = self.force == T::zero() && self.torque == T::zero();
        while share < T::one() && !unloaded {
            let next = (share + step).min(T::one());
            let there = self.equilibrate(here.at, next, iterations);
            match there.filter(|there| self.is_one_path(&here, there, next - share)) {
                Some(there) => {
                    (here, share) = (there, next);
                    step *= T::constant(2.0);
                }
                None => step *= T::constant(0.25),
            }
            if step < T::constant(SMALLEST_SHARE) * share.max(T::constant(SMALLEST_SHARE)) {
                return Outcome::Limit(self.point(here.at));
            }
        }
        Outcome::Root(self.point(here.at))
    }

    /// Newton at zero pressure under a share of the load. Only short moves over stable states are accepted, and only where the first one
    /// is a good prediction of where they lead.
    fn equilibrate(&self, start: Vector3<T>, share: T, iterations: &mut u32) -> Option<Loaded<T>> {
        let mut at = start;
        let (mut predicted, mut last) = (T::constant(FAR), T::constant(FAR));
        for round in 0..SETTLE_ITERATIONS {
            *iterations += 1;
            let d = self.wall.derivatives(at.x, at.y, at.z);
            let rest = Vector3::new(self.force * share, T::zero(), self.torque * share) - d.gradient;
            let move_by = self.solve(&d, rest)?;
            at += move_by;
            let (moved, size) = (largest(&(at - start)), largest(&move_by));
            let finite = move_by.x.is_finite() && move_by.y.is_finite() && move_by.z.is_finite();
            if !finite || moved > T::constant(LONGEST_MOVE) {
                return None;
            }
            let rounding = (T::constant(STALL) * T::rounding() * largest(&at)).max(self.noise(&d, at)?);
            let stalled = size >= last * T::constant(0.5) && size <= rounding;
            if size <= T::rounding() * largest(&at) || stalled {
                return self.loaded(at, iterations);
            }
            if round == 0 {
                predicted = size;
            } else if size > predicted * T::constant(CORRECTION) {
                return None;
            }
            last = size;
        }
        None
    }

    fn loaded(&self, at: Vector3<T>, iterations: &mut u32) -> Option<Loaded<T>> {
        *iterations += 1;
        let d = self.wall.derivatives(at.x, at.y, at.z);
        let rate = self.solve(&d, Vector3::new(self.force, T::zero(), self.torque))?;
        Some(Loaded { at, rate, noise: self.noise(&d, at)? })
    }

    /// Whether two equilibria lie on one path: the compliances at both say how far the load moves in between. A fold on the way would
    /// have made the tube infinitely compliant.
    fn is_one_path(&self, here: &Loaded<T>, there: &Loaded<T>, step: T) -> bool {
        let moved = there.at - here.at;
        let way = largest(&moved);
        let miss = largest(&(moved - (here.rate + there.rate) * (T::constant(0.5) * step)));
        let (before, after) = (largest(&here.rate), largest(&there.rate));
        let even = before.max(after) <= T::constant(CHANGE) * before.min(after);
        let noise = here.noise + there.noise;
        let seen = !is_plain::<T>() || noise <= T::constant(BLINDING) * way;
        even && seen && miss <= T::constant(MISS) * way + noise
    }

    /// The move that removes the imbalance of the equations; `None` unless the state is stable.
    fn solve(&self, d: &Derivatives<T>, rest: Vector3<T>) -> Option<Vector3<T>> {
        let (de, dg) = self.solve_loads(d, rest.x, rest.z)?;
        let (e_w, g_w) = self.solve_loads(d, -d.hessian[(0, 1)], -d.hessian[(2, 1)])?;
        let (ew, gw) = (d.hessian[(0, 1)], d.hessian[(2, 1)]);
        let slope = positive(d.hessian[(1, 1)] + ew * e_w + gw * g_w)?;
        let dw = (rest.y - ew * de - gw * dg) / slope;
        Some(Vector3::new(de + e_w * dw, dw, dg + g_w * dw))
    }

    fn noise(&self, d: &Derivatives<T>, at: Vector3<T>) -> Option<T> {
        let slope = positive(d.hessian[(1, 1)])?;
        Some(largest(&self.settling_noise(d, at)?) + gradient_noise(d, at).y / slope)
    }
}
