//! The steps of the search.

use crate::number::real::{Real, epsilon, real};

use super::{Allocated, Allocation, AllocationStatus, number, within};

/// Most Newton steps. One or two are usual from a state near by, some ten from nothing.
const STEPS: u32 = 400;
/// Most projected steps: beyond them the active set changes by one limit at a time, which ends for certain.
const PROJECTED: u32 = 6;
/// Of the decrease that the gradient promises, what a projected step must keep (Armijo).
const KEPT: f64 = 1e-4;

/// A place of the search.
#[derive(Clone, Copy)]
pub(super) struct Place<T, const N: usize> {
    pub(super) shares: [T; N],
    pub(super) gradient: [T; N],
    /// The pressures that their limits hold.
    pub(super) held: [bool; N],
}

/// The Newton direction of the pressures that no limit holds, and the first limit in its way.
pub(super) struct Direction<T, const N: usize> {
    pub(super) by: [T; N],
    free: usize,
    /// The pressure it stops at and the part of the way to there.
    first: Option<(usize, T)>,
}

impl<T: Real, const R: usize, const N: usize> Allocation<T, R, N> {
    pub(super) fn search(&self, wrench: &[T; R], shares: [T; N]) -> Allocated<T, R, N> {
        let linear = self.linear(wrench);
        let largest = linear[..self.count].iter().fold(T::zero(), |most, g| most.max(g.abs()));
        if !linear[..self.count].iter().all(|g| g.is_finite()) {
            return self.answer(AllocationStatus::NotFinite, &shares, T::max_value().unwrap_or(largest), 0);
        }
        let size = T::one() + largest;
        let tolerance = real::<T>(16.0) * epsilon::<T>() * number::<T>(self.count);
        let (mut iterations, mut projected, mut settled) = (0, 0, true);
        let start = || Place { shares, gradient: self.gradient(&shares, &linear), held: [false; N] };
        let mut place =
            self.pivot(start(), &linear, [tolerance, tolerance * size], &mut iterations).unwrap_or_else(start);
        let mut residual = self.residual(&place, size);
        while iterations < STEPS {
            if settled {
                residual = self.residual(&place, size);
                if residual <= tolerance {
                    break;
                }
                self.hold(&mut place);
            }
            iterations += 1;
            settled = self.step(&mut place, &linear, &mut projected);
        }
        let status = if residual <= tolerance { AllocationStatus::Solved } else { AllocationStatus::NotConverged };
        self.answer(status, &place.shares, residual, iterations)
    }

    /// One step; whether the minimum on the active set was met, so that limits may be left.
    fn step(&self, place: &mut Place<T, N>, linear: &[T; N], projected: &mut u32) -> bool {
        let direction = self.direction(place);
        if direction.free == 0 {
            return true;
        }
        let Some((stops, part)) = direction.first else {
            self.go(place, &direction.by, T::one(), linear);
            return true;
        };
        if *projected < PROJECTED {
            *projected += 1;
            let mut next = *place;
            self.go(&mut next, &direction.by, T::one(), linear);
            if self.lowers(place, &next) {
                *place = next;
                return true;
            }
        }
        self.go(place, &direction.by, part, linear);
        place.shares[stops] = if direction.by[stops] < T::zero() { T::zero() } else { T::one() };
        place.gradient = self.gradient(&place.shares, linear);
        place.held[stops] = true;
        false
    }

    /// Goes a part of the way, held to the limits.
    fn go(&self, place: &mut Place<T, N>, by: &[T; N], part: T, linear: &[T; N]) {
        for (share, by) in place.shares.iter_mut().zip(by).take(self.count) {
            *share = within(*share + part * *by);
        }
        place.gradient = self.gradient(&place.shares, linear);
    }

    /// Whether the objective falls from one place to another as the gradient promises.
    fn lowers(&self, from: &Place<T, N>, to: &Place<T, N>) -> bool {
        let (mut promised, mut change) = (T::zero(), T::zero());
        for i in 0..self.count {
            let moved = to.shares[i] - from.shares[i];
            promised += from.gradient[i] * moved;
            // Exact for a quadratic, and without the difference of two objectives.
            change += (from.gradient[i] + to.gradient[i]) * real::<T>(0.5) * moved;
        }
        promised < T::zero() && change <= promised * real::<T>(KEPT)
    }

    /// Holds what the gradient pushes against a limit, and nothing else.
    fn hold(&self, place: &mut Place<T, N>) {
        let (zero, one) = (T::zero(), T::one());
        for i in 0..self.count {
            let (s, g) = (place.shares[i], place.gradient[i]);
            place.held[i] = (s <= zero && g >= zero) || (s >= one && g <= zero);
        }
    }

    /// `g = (WJ)^T W (w - J lower)/h + rho r`.
    fn linear(&self, wrench: &[T; R]) -> [T; N] {
        let mut wanted = [T::zero(); R];
        for (row, wanted) in wanted.iter_mut().enumerate() {
            *wanted = self.weights[row] * (wrench[row] - self.offset[row]);
        }
        let mut linear = [T::zero(); N];
        for ((g, column), pull) in linear.iter_mut().zip(&self.columns[..self.count]).zip(&self.pull) {
            *g = super::dot(column, &wanted) / self.scale + *pull;
        }
        linear
    }

    /// `H s - g`.
    pub(super) fn gradient(&self, shares: &[T; N], linear: &[T; N]) -> [T; N] {
        let mut gradient = [T::zero(); N];
        for (i, gradient) in gradient.iter_mut().enumerate().take(self.count) {
            let row = &self.hessian[i][..self.count];
            *gradient = row.iter().zip(shares).fold(-linear[i], |sum, (h, s)| sum + *h * *s);
        }
        gradient
    }

    fn residual(&self, place: &Place<T, N>, size: T) -> T {
        let pairs = place.shares[..self.count].iter().zip(&place.gradient);
        pairs.fold(T::zero(), |most, (s, g)| most.max((*s - within(*s - *g / size)).abs()))
    }

    /// The Newton direction of the pressures that no limit holds.
    pub(super) fn direction(&self, place: &Place<T, N>) -> Direction<T, N> {
        let (zero, one) = (T::zero(), T::one());
        let (mut free, mut found, mut size) = ([0; N], [zero; N], 0);
        for i in 0..self.count.min(N) {
            if !place.held[i] {
                free[size] = i;
                found[size] = -place.gradient[i];
                size += 1;
            }
        }
        self.solve_block(&free[..size], &mut found);
        let mut direction = Direction { by: [zero; N], free: size, first: None };
        let mut least = one;
        for (step, i) in found.iter().zip(&free[..size]) {
            direction.by[*i] = *step;
            let s = place.shares[*i];
            let end = if *step < zero { zero } else { one };
            if (s + *step - end) * *step > zero {
                let part = (end - s) / *step;
                if part < least {
                    least = part;
                    direction.first = Some((*i, part));
                }
            }
        }
        direction
    }

    /// Solves `H_FF x = b` in place by `L D L^T`.
    fn solve_block(&self, free: &[usize], b: &mut [T; N]) {
        let mut factor = [[T::zero(); N]; N];
        let mut pivots = [T::one(); N];
        let size = free.len().min(N);
        for row in 0..size {
            let mut scaled = [T::zero(); N];
            let mut pivot = self.hessian[free[row]][free[row]];
            for column in 0..row {
                let mut value = self.hessian[free[row]][free[column]];
                for (a, b) in scaled[..column].iter().zip(&factor[column]) {
                    value -= *a * *b;
                }
                scaled[column] = value;
            }
            for column in 0..row {
                let entry = scaled[column] / pivots[column];
                factor[row][column] = entry;
                pivot -= entry * scaled[column];
            }
            pivots[row] = pivot;
            for column in 0..row {
                b[row] -= factor[row][column] * b[column];
            }
        }
        for row in (0..size).rev() {
            b[row] /= pivots[row];
            for below in row + 1..size {
                b[row] -= factor[below][row] * b[below];
            }
        }
    }

    fn answer(&self, status: AllocationStatus, shares: &[T; N], residual: T, iterations: u32) -> Allocated<T, R, N> {
        let (zero, one) = (T::zero(), T::one());
        let (mut pressures_pa, mut wrench) = ([zero; N], [zero; R]);
        let (mut at_lower, mut at_upper) = (0, 0);
        for i in 0..self.count {
            let s = shares[i];
            // A limit is met exactly.
            pressures_pa[i] = if s >= one { self.upper[i] } else { self.lower[i] + self.range[i] * s };
            for (sum, by) in wrench.iter_mut().zip(&self.jacobian[i]) {
                *sum += *by * pressures_pa[i];
            }
            at_lower |= u32::from(s <= zero) << i;
            at_upper |= u32::from(s >= one) << i;
        }
        Allocated { status, pressures_pa, wrench, residual, at_lower, at_upper, iterations }
    }
}
