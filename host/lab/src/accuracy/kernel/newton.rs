//! Newton's method on the energy, plain: what it costs to leave out the branch, the noise and the second look.

use super::wall::{Derivatives, Wall};
use crate::accuracy::number::Number;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stop {
    /// After so many steps, whatever they have reached.
    Steps(u32),
    /// When a step is below this share of the largest coordinate.
    Below(f64),
    /// When rounding keeps the steps from shrinking further.
    Settled,
}

/// Steps after which an iteration to a tolerance is given up.
const GIVE_UP: u32 = 50;

/// The state at `P/mu1`, without load. `None` where it does not converge.
pub(super) fn forward<N: Number>(wall: &Wall<N>, start: [N; 3], pressure: N, stop: Stop) -> Option<([N; 3], u32)> {
    let twists = wall.twists();
    iterate(start, stop, |at| {
        let Derivatives { gradient, hessian } = wall.derivatives(at);
        symmetric(&hessian, [-gradient[0], pressure - gradient[1], -gradient[2]], twists)
    })
}

/// The state whose weighted sum is `value`, without load and without the pressure as an unknown; then `P/mu1` is the energy's
/// derivative by the volume.
pub(super) fn inverse<N: Number>(
    wall: &Wall<N>,
    start: [N; 3],
    weights: [N; 3],
    value: N,
    stop: Stop,
) -> Option<(N, u32)> {
    let twists = wall.twists();
    let (at, steps) = iterate(start, stop, |at| {
        let Derivatives { gradient, hessian } = wall.derivatives(at);
        let reached = weights[0] * at[0] + weights[1] * at[1] + weights[2] * at[2];
        general([weights, hessian[0], hessian[2]], [value - reached, -gradient[0], -gradient[2]], twists)
    })?;
    Some((wall.derivatives(at).gradient[1], steps))
}

fn iterate<N: Number>(start: [N; 3], stop: Stop, step: impl Fn([N; 3]) -> [N; 3]) -> Option<([N; 3], u32)> {
    let mut at = start;
    let most = if let Stop::Steps(count) = stop { count } else { GIVE_UP };
    let mut last = f64::INFINITY;
    for round in 1..=most {
        let change = limited(at, step(at));
        let size = largest(change);
        if !size.is_finite() {
            return None;
        }
        at = [at[0] + change[0], at[1] + change[1], at[2] + change[2]];
        let share = size / largest(at);
        let done = match stop {
            Stop::Steps(_) => false,
            Stop::Below(tolerance) => share <= tolerance,
            Stop::Settled => share <= N::epsilon() || (share >= 0.5 * last && share < N::difference()),
        };
        if done {
            return Some((at, round));
        }
        last = share;
    }
    matches!(stop, Stop::Steps(_)).then_some((at, most))
}

/// Length and volume may at most halve or grow by half in a step.
fn limited<N: Number>(at: [N; 3], change: [N; 3]) -> [N; 3] {
    let half = N::of(0.5);
    let share = |axis: usize| (change[axis] / (half * (N::of(1.0) + at[axis]))).nearest().abs();
    let most = share(0).max(share(1)).max(1.0);
    if most > 1.0 { change.map(|value| value * N::of(1.0 / most)) } else { change }
}

fn largest<N: Number>(values: [N; 3]) -> f64 {
    values[0].nearest().abs().max(values[1].nearest().abs()).max(values[2].nearest().abs())
}

/// Solves a symmetric system, the twist first; without it two equations are left.
fn symmetric<N: Number>(h: &[[N; 3]; 3], right: [N; 3], twists: bool) -> [N; 3] {
    let ([mut ee, mut ew], mut ww) = ([h[0][0], h[0][1]], h[1][1]);
    let [mut by_e, mut by_w, by_g] = right;
    if twists {
        let (e, w) = (h[0][2] / h[2][2], h[1][2] / h[2][2]);
        (ee, ew, ww) = (ee - e * h[0][2], ew - e * h[1][2], ww - w * h[1][2]);
        (by_e, by_w) = (by_e - e * by_g, by_w - w * by_g);
    }
    let ratio = ew / ee;
    let dw = (by_w - ratio * by_e) / (ww - ratio * ew);
    let de = (by_e - ew * dw) / ee;
    let dg = if twists { (by_g - h[0][2] * de - h[1][2] * dw) / h[2][2] } else { N::of(0.0) };
    [de, dw, dg]
}

/// Solves by Cramer's rule; the third row and column count only where there is a twist.
fn general<N: Number>(m: [[N; 3]; 3], right: [N; 3], twists: bool) -> [N; 3] {
    let minor = |a: [N; 3], b: [N; 3], i: usize, k: usize| a[i] * b[k] - a[k] * b[i];
    let zero = N::of(0.0);
    if !twists {
        let [a, b, _] = m;
        let per = N::of(1.0) / minor(a, b, 0, 1);
        return [(right[0] * b[1] - a[1] * right[1]) * per, (a[0] * right[1] - right[0] * b[0]) * per, zero];
    }
    let determinant = |m: [[N; 3]; 3]| {
        m[0][0] * minor(m[1], m[2], 1, 2) - m[0][1] * minor(m[1], m[2], 0, 2) + m[0][2] * minor(m[1], m[2], 0, 1)
    };
    let per = N::of(1.0) / determinant(m);
    [0, 1, 2].map(|column| {
        let mut replaced = m;
        for row in 0..3 {
            replaced[row][column] = right[row];
        }
        determinant(replaced) * per
    })
}
