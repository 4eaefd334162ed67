//! How far the tip gets: corners of the pressure box and ascents from the best of them.
//!
//! What is sought is the largest value of a smooth function over a box. All corners are looked at where there are at most 2^14, that
//! many of them otherwise, and points inside; from the best ones a projected quasi-Newton ascent goes on. The answer is asked of the model.

use nalgebra::{DMatrix, DVector};

use super::lanes::LANES;
use super::sample::kronecker;
use super::space::{AXES_MAX, Workspace};

/// Most corners that are looked at, as a power of two, and points inside.
const CORNERS_LOG2: usize = 14;
const INSIDE: usize = 4096;
/// Ascents from corners, and from points inside.
const STARTS: usize = 4;
const STEPS: usize = 60;
/// Step of differences, as a share of an axis.
const DIFFERENCE: f64 = 1e-5;
/// Lengths of a step that are tried at once, of that of the quasi-Newton step.
const LENGTHS: [f64; LANES] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.06, 1e-2, 1e-3];

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A coordinate of the tip in the scene's frame: 0 to 2.
    Coordinate(usize),
    /// Distance of the tip from the start of the limb.
    Distance,
}

/// An extreme and where in the box it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// The extreme of the measure, m, by the model.
    pub value_m: f64,
    /// The tip there, m.
    pub tip_m: [f64; 3],
    /// Gauge pressure of each axis, Pa.
    pub pressures_pa: Vec<f64>,
    /// Value at the best corner alone, m.
    pub corner_m: f64,
    /// How far the polynomials were off at the extreme, m.
    pub table_error_m: f64,
}

/// Least and largest of each coordinate and of the distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Extents {
    /// By coordinate, then the distance: least and largest.
    pub of: [[Reach; 2]; 4],
}

impl Extents {
    /// Largest less least value of a coordinate (0 to 2) or of the distance (3), m.
    pub fn range_m(&self, index: usize) -> f64 {
        let [least, largest] = &self.of[index];
        largest.value_m - least.value_m
    }
}

/// A measure and whether its largest value is sought.
#[derive(Clone, Copy)]
struct Goal {
    measure: Measure,
    sign: f64,
}

impl Goal {
    fn of(&self, tip: &[f64; 3], base: &[f64; 3]) -> f64 {
        let value = match self.measure {
            Measure::Coordinate(axis) => tip[axis],
            Measure::Distance => tip.iter().zip(base).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt(),
        };
        self.sign * value
    }
}

/// A place in the box.
type Place = [f64; AXES_MAX];

/// The extents; `None` where the model has no equilibrium at one of them.
pub fn extents(space: &Workspace<'_>) -> Option<Extents> {
    let [corners, inside] = starts(space);
    let find = |measure| {
        let both = [-1.0, 1.0].map(|sign| extreme(space, Goal { measure, sign }, &corners, &inside));
        let [least, largest] = both;
        Some([least?, largest?])
    };
    let of = [Measure::Coordinate(0), Measure::Coordinate(1), Measure::Coordinate(2), Measure::Distance].map(find);
    let [x, y, z, distance] = of;
    Some(Extents { of: [x?, y?, z?, distance?] })
}

/// Corners and points inside with their tips.
fn starts(space: &Workspace<'_>) -> [Vec<(Place, [f64; 3])>; 2] {
    let axes = space.axes().len();
    let corners = 1_usize << axes.min(CORNERS_LOG2);
    // Beyond 2^14, corners far apart: those whose bits are those of odd multiples of their number.
    let corner = |index: usize, axis: usize| {
        let code =
            if axes > CORNERS_LOG2 { (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 24 } else { index as u64 };
        if code >> axis & 1 == 1 { 1.0 } else { 0.0 }
    };
    let point = kronecker(axes, 0);
    [gather(space, corners, corner), gather(space, INSIDE, point)]
}

fn gather(space: &Workspace<'_>, count: usize, share: impl Fn(usize, usize) -> f64) -> Vec<(Place, [f64; 3])> {
    let mut tips = vec![[0.0; 3]; count];
    space.tips(count, &share, &mut tips);
    let axes = space.axes().len();
    let place = |index: usize| std::array::from_fn(|axis| if axis < axes { share(index, axis) } else { 0.0 });
    tips.into_iter().enumerate().map(|(index, tip)| (place(index), tip)).collect()
}

fn extreme(
    space: &Workspace<'_>,
    goal: Goal,
    corners: &[(Place, [f64; 3])],
    inside: &[(Place, [f64; 3])],
) -> Option<Reach> {
    let base = space.base();
    let (first, second) = (best(corners, goal, &base), best(inside, goal, &base));
    let corner_m = goal.sign * first.first()?.0;
    let climbed = first.iter().chain(&second).map(|(_, place)| ascend(space, goal, place));
    let (_, place) = climbed.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let axes = space.axes();
    let tip_m = space.tip_by_the_model(&place[..axes.len()])?;
    let value = goal.of(&tip_m, &base);
    let off = space.tip(&place[..axes.len()]);
    Some(Reach {
        value_m: goal.sign * value,
        tip_m,
        pressures_pa: axes.iter().zip(place).map(|(axis, share)| axis.pressure_max_pa * share).collect(),
        corner_m,
        table_error_m: off.iter().zip(tip_m).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
    })
}

/// The best few, best first.
fn best(points: &[(Place, [f64; 3])], goal: Goal, base: &[f64; 3]) -> Vec<(f64, Place)> {
    let mut kept: Vec<(f64, Place)> = Vec::new();
    for (place, tip) in points {
        let value = goal.of(tip, base);
        if kept.len() < STARTS || kept.last().is_some_and(|last| value > last.0) {
            kept.push((value, *place));
            kept.sort_by(|a, b| b.0.total_cmp(&a.0));
            kept.truncate(STARTS);
        }
    }
    kept
}

/// The value and place where a projected quasi-Newton ascent ends.
fn ascend(space: &Workspace<'_>, goal: Goal, start: &Place) -> (f64, Place) {
    let axes = space.axes().len();
    let base = space.base();
    let mut place = *start;
    let mut value = goal.of(&space.tip(&place[..axes]), &base);
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
        if better <= value + 1e-15 {
            break;
        }
        last = Some((gradient, place, free));
        (value, place) = (better, to);
    }
    (value, place)
}

/// The best of several steps along a direction, within the box.
fn along(
    space: &Workspace<'_>,
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

fn gradient(space: &Workspace<'_>, goal: Goal, place: &Place, base: &[f64; 3]) -> DVector<f64> {
    let axes = space.axes().len();
    let mut tips = [[0.0; 3]; 2 * AXES_MAX];
    let moved = |index: usize, axis: usize| {
        let step = if index.is_multiple_of(2) { DIFFERENCE } else { -DIFFERENCE };
        place[axis] + if index / 2 == axis { step } else { 0.0 }
    };
    space.tips(2 * axes, moved, &mut tips);
    let value = |index: usize| goal.of(&tips[index], base);
    DVector::from_fn(axes, |axis, _| (value(2 * axis) - value(2 * axis + 1)) / (2.0 * DIFFERENCE))
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
