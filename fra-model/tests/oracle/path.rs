//! Pseudo-arclength continuation of the equilibria of a straight tube: first the load is raised from rest, then the pressure, up
//! to the point where the branch loses its stability.

use super::polish::solve;
use super::wall::{PRESSURE, Rule, Tube};

/// First and longest step of the scaled arclength, and the largest angle between neighbouring tangents (its cosine).
const FIRST_STEP: f64 = 0.01;
const LONGEST_STEP: f64 = 0.15;
const STRAIGHTEST: f64 = 0.985;
/// Newton's last step against the step of the path, on the way and where a state is wanted.
const ROUGHLY: f64 = 1e-5;
const EXACTLY: f64 = 1e-10;
/// The state may miss its prediction by this share of its way.
const FARTHEST_OFF: f64 = 0.25;
/// One unit of the scaled arclength, in pressures over `mu1`.
const PRESSURE_UNIT: f64 = 5.0;

/// A state `(e, w, g)` and the parameter of the path that goes with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) state: [f64; 3],
    pub(crate) at: f64,
    /// Unit tangent in scaled variables; the last entry is that of the parameter.
    tangent: [f64; 4],
    scales: [f64; 4],
    /// Whether the state resists every small change under constant loads.
    stable: bool,
}

impl Point {
    /// The direction of the path in the state, of any length.
    pub(crate) fn direction(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.tangent[i] * self.scales[i])
    }
}

/// Why a path ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// The parameter has its extremum here.
    Fold,
    /// Another mode of the tube loses its stability: the branch crosses another one.
    Crossing,
    /// What was asked for has been reached.
    Reached,
    /// The continuation itself got stuck.
    Stuck,
}

/// A stable path of equilibria, its parameter strictly monotone.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) points: Vec<Point>,
    pub(crate) end: End,
}

/// The loads along a path: `base + at * direction`.
#[derive(Clone, Copy)]
struct Loading {
    base: [f64; 3],
    direction: [f64; 3],
    unit: f64,
}

/// The family of problems `loads(state) = loading(at)`.
pub(crate) struct Follower<'a> {
    tube: &'a Tube,
    /// Quadrature on the way, and for the states and limits that are wanted: stiff fibers magnify its error.
    rule: &'a Rule,
    fine: &'a Rule,
    loading: Loading,
}

impl<'a> Follower<'a> {
    /// The load rises from nothing to all of it (`at` = 0 to 1) without pressure.
    pub(crate) fn of_load(tube: &'a Tube, [rule, fine]: [&'a Rule; 2]) -> Self {
        let mut inputs = tube.inputs;
        inputs[PRESSURE] = 0.0;
        let direction = Tube::applied(&inputs, std::f64::consts::PI);
        Self { tube, rule, fine, loading: Loading { base: [0.0; 3], direction, unit: 1.0 } }
    }

    /// The pressure, Pa, changes under the whole load.
    pub(crate) fn of_pressure(tube: &'a Tube, [rule, fine]: [&'a Rule; 2]) -> Self {
        let mut inputs = tube.inputs;
        inputs[PRESSURE] = 0.0;
        let base = Tube::applied(&inputs, std::f64::consts::PI);
        let loading = Loading { base, direction: [0.0, 1.0, 0.0], unit: PRESSURE_UNIT * tube.mu1() };
        Self { tube, rule, fine, loading }
    }

    fn finely(&self) -> Self {
        Self { rule: self.fine, ..*self }
    }

    /// Residual and the matrix of its derivatives by state and parameter, scaled.
    fn equations(&self, state: [f64; 3], at: f64, scales: &[f64; 4]) -> ([f64; 4], [[f64; 4]; 4]) {
        let (loads, slopes) = self.tube.linearised(self.rule, state);
        let (mut rest, mut matrix) = ([0.0; 4], [[0.0; 4]; 4]);
        for i in 0..3 {
            rest[i] = loads[i] - self.loading.base[i] - at * self.loading.direction[i];
            for j in 0..3 {
                matrix[i][j] = slopes[i][j] * scales[j];
            }
            matrix[i][3] = -self.loading.direction[i] * scales[3];
        }
        if !self.tube.twists {
            (rest[2], matrix[2][3]) = (0.0, 0.0);
        }
        (rest, matrix)
    }

    fn scales(&self, state: [f64; 3]) -> [f64; 4] {
        [1.0 + state[0], 1.0 + state[1], 1.0, self.loading.unit]
    }

    /// A point with its tangent, turned the way of `towards`.
    fn point(&self, state: [f64; 3], at: f64, towards: [f64; 4]) -> Option<Point> {
        let scales = self.scales(state);
        let (_, mut matrix) = self.equations(state, at, &scales);
        let stable = positive_definite(&matrix, &scales);
        matrix[3] = towards;
        let mut tangent = solve(matrix, [0.0, 0.0, 0.0, 1.0])?;
        let size = dot(&tangent, &tangent).sqrt();
        tangent = tangent.map(|t| t / size);
        Some(Point { state, at, tangent, scales, stable })
    }

    pub(crate) fn start(&self, state: [f64; 3], at: f64, forwards: bool) -> Option<Point> {
        let sign = if forwards { 1.0 } else { -1.0 };
        self.point(state, at, [0.0, 0.0, 0.0, sign])
    }

    /// The equilibrium a distance `step` along the tangent of `from`, to the square of the share `exactly` of the step.
    fn correct(&self, from: &Point, step: f64, exactly: f64) -> Option<([f64; 3], f64)> {
        let Point { scales, tangent, .. } = from;
        let mut moved = tangent.map(|t| t * step);
        let mut last = f64::MAX;
        for _ in 0..8 {
            let (state, at) = place(from, &moved);
            if state[0] <= -1.0 || state[1] <= -1.0 {
                return None;
            }
            let (rest, mut matrix) = self.equations(state, at, scales);
            matrix[3] = *tangent;
            let newton = solve(matrix, [rest[0], rest[1], rest[2], 0.0])?;
            let size = newton.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            (0..4).for_each(|i| moved[i] -= newton[i]);
            let off: f64 = (0..4).map(|i| (moved[i] - tangent[i] * step).powi(2)).sum();
            if off.is_nan() || off.sqrt() > 0.5 * step.abs() + 1e-9 {
                return None;
            }
            let settled = size < (1e-4 * step.abs()).max(1e-12) && size >= 0.5 * last;
            if size <= exactly * step.abs() || size <= 1e-15 || settled {
                return Some(place(from, &moved));
            }
            last = size;
        }
        None
    }

    /// Follows the path from a stable point while `go_on`; the last point is the extremum where the path turns.
    pub(crate) fn follow(&self, start: Point, go_on: &dyn Fn(&Point) -> bool) -> Path {
        let mut points = vec![start];
        let mut step = FIRST_STEP;
        while let Some(&here) = points.last() {
            if !go_on(&here) || points.len() > 20_000 {
                return Path { points, end: if go_on(&here) { End::Stuck } else { End::Reached } };
            }
            let next = self.next(&here, step, ROUGHLY);
            let smooth = |p: &Point| dot(&unscaled(&here, p), &here.tangent) > STRAIGHTEST && as_predicted(&here, p);
            let Some(next) = next.filter(smooth) else {
                step *= 0.5;
                if step < 1e-12 {
                    return Path { points, end: End::Stuck };
                }
                continue;
            };
            if next.tangent[3] * here.tangent[3] <= 0.0 {
                let last = self.finely().refine(&here, step, |p| p.tangent[3] * here.tangent[3] > 0.0);
                return self.ended(points, last, End::Fold, go_on);
            }
            if !next.stable {
                // Two branches that almost cross: only a short step can tell them apart.
                if step > 1e-7 {
                    step *= 0.25;
                    continue;
                }
                let last = self.finely().refine(&here, step, |p| p.stable);
                return self.ended(points, last, End::Crossing, go_on);
            }
            points.push(next);
            step = (2.0 * step).min(LONGEST_STEP);
        }
        Path { points, end: End::Stuck }
    }

    /// The path up to `last`, or, where the fine quadrature does not confirm that it ends there, followed with that one.
    fn ended(&self, mut points: Vec<Point>, last: Option<Point>, end: End, go_on: &dyn Fn(&Point) -> bool) -> Path {
        let end = match (last, points.pop()) {
            (Some(last), Some(before)) => {
                points.extend([before, last]);
                end
            }
            (None, Some(before)) if !std::ptr::eq(self.rule, self.fine) => {
                let rest = self.finely().follow(before, go_on);
                points.extend(rest.points);
                rest.end
            }
            _ => End::Stuck,
        };
        Path { points, end }
    }

    /// The last point that is `good` on the way from `from`, whose neighbour a `step` ahead is not; `None` where none is bad.
    fn refine(&self, from: &Point, step: f64, good: impl Fn(&Point) -> bool) -> Option<Point> {
        let (mut last, mut length, mut gone) = (*from, step, 0.0);
        while length > 1e-9 {
            match self.next(&last, length, EXACTLY).filter(&good) {
                Some(next) => (last, gone) = (next, gone + length),
                None => length *= 0.5,
            }
            if gone > 3.0 * step {
                return None;
            }
        }
        Some(last)
    }

    /// The point a distance `step` along the tangent of `from`.
    fn next(&self, from: &Point, step: f64, exactly: f64) -> Option<Point> {
        let (state, at) = self.correct(from, step, exactly)?;
        self.point(state, at, from.tangent)
    }

    /// The state at a value of the parameter that the path passes.
    pub(crate) fn state_at(&self, path: &Path, at: f64) -> Option<[f64; 3]> {
        let finely = self.finely();
        let between = |pair: &&[Point]| (pair[0].at - at) * (pair[1].at - at) <= 0.0;
        let [a, b] = *path.points.windows(2).find(between)? else { return None };
        if (at - a.at).abs() <= 1e-3 * (b.at - a.at).abs() {
            let share = (at - a.at) / (a.tangent[3] * a.scales[3]);
            return Some([0, 1, 2].map(|i| a.state[i] + a.direction()[i] * share));
        }
        let (mut near, mut far_rest) = (a, b.at - at);
        let mut length = dot(&difference(&a, &b), &a.tangent);
        let whole = length;
        for round in 0..200 {
            let rest = near.at - at;
            if rest.abs() <= 1e-9 * at.abs() || length <= 1e-13 * whole {
                break;
            }
            let share = if round % 3 == 2 { 0.5 } else { (rest / (rest - far_rest)).clamp(0.01, 0.99) };
            match finely.next(&near, share * length, EXACTLY) {
                // Behind a fold.
                Some(p) if p.tangent[3] * a.tangent[3] <= 0.0 => (far_rest, length) = (-rest, share * length),
                Some(p) if (p.at - at > 0.0) == (rest > 0.0) => (near, length) = (p, (1.0 - share) * length),
                Some(p) => (far_rest, length) = (p.at - at, share * length),
                // Newton's method fails on the whole of the way: a part of it may do.
                None => {
                    let mut part = 0.1 * share;
                    let p = loop {
                        match finely.next(&near, part * length, EXACTLY) {
                            Some(p) if (p.at - at > 0.0) == (rest > 0.0) => break p,
                            _ if part < 1e-6 => return (rest.abs() <= 1e-7 * at.abs()).then_some(near.state),
                            _ => part *= 0.1,
                        }
                    };
                    (near, length) = (p, (1.0 - part) * length);
                }
            }
        }
        Some(near.state)
    }
}

/// Whether the derivatives of the loads by the state, of which column `j` is scaled by `scales[j]`, are positive definite.
fn positive_definite(matrix: &[[f64; 4]; 4], scales: &[f64; 4]) -> bool {
    let h = |i: usize, j: usize| 0.5 * (matrix[i][j] * scales[i] + matrix[j][i] * scales[j]);
    // Cholesky's pivots.
    let first = h(0, 0);
    let second = h(1, 1) - h(0, 1) * h(0, 1) / first;
    let coupling = h(1, 2) - h(0, 1) * h(0, 2) / first;
    let third = h(2, 2) - h(0, 2) * h(0, 2) / first - coupling * coupling / second;
    first > 0.0 && second > 0.0 && third > 0.0
}

fn place(from: &Point, moved: &[f64; 4]) -> ([f64; 3], f64) {
    let state = [0, 1, 2].map(|i| from.state[i] + from.scales[i] * moved[i]);
    (state, from.at + from.scales[3] * moved[3])
}

/// The way from `a` to `b` in the scaled variables of `a`.
fn difference(a: &Point, b: &Point) -> [f64; 4] {
    let way = |i: usize| if i < 3 { b.state[i] - a.state[i] } else { b.at - a.at };
    [0, 1, 2, 3].map(|i| way(i) / a.scales[i])
}

/// The tangent of `b` in the scaled variables of `a`, of unit length.
fn unscaled(a: &Point, b: &Point) -> [f64; 4] {
    let tangent = [0, 1, 2, 3].map(|i| b.tangent[i] * b.scales[i] / a.scales[i]);
    let size = dot(&tangent, &tangent).sqrt();
    tangent.map(|t| t / size)
}

/// Whether the state alone moved as the tangent said: where stiff fibers hold it, a jump to another branch is small against a step.
fn as_predicted(a: &Point, b: &Point) -> bool {
    let way = difference(a, b);
    let length = dot(&way, &a.tangent);
    let off: f64 = (0..3).map(|i| (way[i] - a.tangent[i] * length).powi(2)).sum();
    let predicted: f64 = (0..3).map(|i| (a.tangent[i] * length).powi(2)).sum();
    // A parameter that does not rise as its slopes say may have an extremum in between.
    let (from, to) = (a.tangent[3], unscaled(a, b)[3]);
    let bulge = (way[3] - 0.5 * (from + to) * length).abs();
    let gentle = from * to <= 0.0 || bulge <= FARTHEST_OFF * length * from.abs().min(to.abs()) + 1e-12;
    gentle && off.sqrt() <= FARTHEST_OFF * predicted.sqrt() + 1e-10
}

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (0..4).map(|i| a[i] * b[i]).sum()
}
