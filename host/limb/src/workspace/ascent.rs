//! Uphill in a box: a projected quasi-Newton ascent of a measure of the tip.
//!
//! The measure is a coordinate or a distance to be made as large as possible, no sum of squares, so that least squares do not apply.

use nalgebra::{DMatrix, DVector};

use super::extents::Measure;
use super::lanes::LANES;
use super::space::{AXES_MAX, Workspace};

const STEPS: usize = 60;
/// Step of differences, as a share of an axis.
const DIFFERENCE: f64 = 1e-5;
/// Lengths of a step that are tried at once, of that of the quasi-Newton step.
const LENGTHS: [f64; LANES] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.06, 1e-2, 1e-3];

/// A place in the box: shares of the highest pressures.
pub(super) type Place = [f64; AXES_MAX];

/// Tips as a smooth function of the places of a box.
pub(super) trait Surface {
    /// Number of pressures.
    fn axes(&self) -> usize;
    /// Where the limb starts, m.
    fn base(&self) -> [f64; 3];
    /// Less is no gain, m.
    fn resolution_m(&self) -> f64;
    /// Tips of several places, m; not numbers where there is none.
    fn tips(&self, count: usize, share: impl Fn(usize, usize) -> f64, tips: &mut [[f64; 3]]);

    /// The tip of one.
    fn tip(&self, place: &Place) -> [f64; 3] {
        let mut tip = [[0.0; 3]];
        self.tips(1, |_, axis| place[axis], &mut tip);
        tip[0]
    }
}

impl Surface for Workspace<'_> {
    fn axes(&self) -> usize {
        Workspace::axes(self).len()
    }

    fn base(&self) -> [f64; 3] {
        Workspace::base(self)
    }

    fn resolution_m(&self) -> f64 {
        1e-15
    }

    fn tips(&self, count: usize, share: impl Fn(usize, usize) -> f64, tips: &mut [[f64; 3]]) {
        Workspace::tips(self, count, share, tips);
    }
}

/// A measure and whether its largest value is sought.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    pub(super) measure: Measure,
    pub(super) sign: f64,
}

impl Goal {
    pub(super) fn of(&self, tip: &[f64; 3], base: &[f64; 3]) -> f64 {
        let value = match self.measure {
            Measure::Coordinate(axis) => tip[axis],
            Measure::Distance => tip.iter().zip(base).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt(),
        };
        if value.is_finite() { self.sign * value } else { f64::NEG_INFINITY }
    }
}

/// The value and place where a projected quasi-Newton ascent ends.
pub(super) fn ascend(space: &impl Surface, goal: Goal, start: &Place) -> (f64, Place) {
    let axes = space.axes();
    let base = space.base();
    let mut place = *start;
    let mut value = goal.of(&space.tip(start), &base);
    let mut inverse = DMatrix::<f64>::identity(axes, axes);
    let mut last: Option<(DVector<f64>, Place, Vec<bool>)> = None;
    for _ in 0..STEPS {
        let gradient = gradient(space, goal, &place, &base);
        let free: Vec<bool> = (0..axes)
            .map(|i| !(place[i] <= 0.0 && gradient[i] <= 0.0 || place[i] >= 1.0 && gradient[i] >= 0.0))
            .collect();
        match &last {
            Some((before, from, known)) if *known == free => update(&mut inverse, &(before - &gradient), from, &place),
            _ => inverse.fill_with_identity(),
        }
        let direction = step(&inverse, &gradient, &free);
        let Some((better, to)) = along(space, goal, &place, &direction, &base) else { break };
        if better <= value + space.resolution_m() {
            break;
        }
        last = Some((gradient, place, free));
        (value, place) = (better, to);
    }
    (value, place)
}

/// The best of several steps along a direction, within the box.
fn along(
    space: &impl Surface,
    goal: Goal,
    place: &Place,
    direction: &DVector<f64>,
    base: &[f64; 3],
) -> Option<(f64, Place)> {
    let at = |lane: usize, axis: usize| (place[axis] + LENGTHS[lane] * direction[axis]).clamp(0.0, 1.0);
    let mut tips = [[0.0; 3]; LANES];
    space.tips(LANES, at, &mut tips);
    let (lane, value) = tips.iter().map(|tip| goal.of(tip, base)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let axes = direction.len();
    Some((value, std::array::from_fn(|axis| if axis < axes { at(lane, axis) } else { 0.0 })))
}

fn gradient(space: &impl Surface, goal: Goal, place: &Place, base: &[f64; 3]) -> DVector<f64> {
    let axes = space.axes();
    let mut tips = [[0.0; 3]; 2 * AXES_MAX];
    // Not beyond the box, where there may be no pose.
    let ends = |axis: usize| [(place[axis] + DIFFERENCE).min(1.0), (place[axis] - DIFFERENCE).max(0.0)];
    let moved = |index: usize, axis: usize| if index / 2 == axis { ends(axis)[index % 2] } else { place[axis] };
    space.tips(2 * axes, moved, &mut tips);
    let value = |index: usize| goal.of(&tips[index], base);
    let slope = |axis: usize| {
        let [up, down] = ends(axis);
        (value(2 * axis) - value(2 * axis + 1)) / (up - down)
    };
    // No slope where a neighbour is no place to go to.
    DVector::from_fn(axes, |axis, _| Some(slope(axis)).filter(|slope| slope.is_finite()).unwrap_or(0.0))
}

/// The quasi-Newton step of the free axes, where it goes up; the gradient's else.
fn step(inverse: &DMatrix<f64>, gradient: &DVector<f64>, free: &[bool]) -> DVector<f64> {
    let masked = DVector::from_fn(gradient.len(), |i, _| if free[i] { gradient[i] } else { 0.0 });
    let newton = inverse * &masked;
    let newton = DVector::from_fn(gradient.len(), |i, _| if free[i] { newton[i] } else { 0.0 });
    if newton.dot(&masked) > 0.0 { newton } else { masked }
}

/// The formula of Broyden, Fletcher, Goldfarb and Shanno for the inverse of the negative second derivatives.
fn update(inverse: &mut DMatrix<f64>, change: &DVector<f64>, from: &Place, to: &Place) {
    let moved = DVector::from_fn(change.len(), |i, _| to[i] - from[i]);
    let product = moved.dot(change);
    if product <= 1e-14 * moved.norm() * change.norm() {
        return;
    }
    let image = &*inverse * change;
    let factor = (product + change.dot(&image)) / (product * product);
    *inverse +=
        &moved * moved.transpose() * factor - (&image * moved.transpose() + &moved * image.transpose()) / product;
}
