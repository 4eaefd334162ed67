//! Clearance of the loaded limb and of what it carries: balls along the deformed centre line.

use nalgebra::{UnitQuaternion, Vector3};

use super::built::Built;
use super::inverse::Stand;
use super::task::{CarriedBody, LoadedTask};
use softlimb_scene::collision::Shape;

/// Balls between two points of the centre line of a module.
const BETWEEN: usize = 4;
/// Largest spacing of balls along a straight part, over their radius: a capsule protrudes from them by at most 0.2 % of the radius.
const APART: f64 = 0.12;

/// Centres and radii of balls along a limb in equilibrium, m.
fn balls(built: &Built, task: &LoadedTask, stand: &Stand) -> Vec<(Vector3<f64>, f64)> {
    let line: Vec<Vector3<f64>> = stand.rod.line_m(&stand.shape).into_iter().map(Vector3::from).collect();
    let rigid = |index: usize| stand.rod.pieces[index].rigid_m > 0.0;
    let steps = (line.len() - 1 - (0..built.modules.len()).filter(|index| rigid(*index)).count()) / built.modules.len();
    let mut all = Vec::new();
    let mut first = 0;
    for (index, module) in built.modules.iter().enumerate() {
        for step in first..first + steps {
            let [before, after] = [slope(&line, step), slope(&line, step + 1)];
            all.extend((0..BETWEEN).map(|part| {
                let share = part as f64 / BETWEEN as f64;
                (cubic(line[step], line[step + 1], before, after, share), module.radius_m)
            }));
        }
        first += steps;
        all.push((line[first], module.radius_m));
        if rigid(index) {
            let (from, to) = (line[first], line[first + 1]);
            let length_m = stand.rod.pieces[index].rigid_m;
            let connector = (module.connector_m / length_m).min(1.0);
            all.push((from.lerp(&to, connector), module.radius_m));
            if connector < 1.0 {
                all.extend(capsule(&from.lerp(&to, connector), &to, task.tool_m[1]));
            }
            first += 1;
        }
    }
    all
}

/// Change of the line per step at a point.
fn slope(line: &[Vector3<f64>], at: usize) -> Vector3<f64> {
    let unit = |from: usize, to: usize| (line[to] - line[from]).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    let before = (at > 0).then(|| unit(at - 1, at));
    let after = (at + 1 < line.len()).then(|| unit(at, at + 1));
    match (before, after) {
        (Some(before), Some(after)) => (before + after) * 0.5,
        (one, other) => one.or(other).unwrap_or_else(Vector3::zeros),
    }
}

/// Hermite's cubic between two points with unit slopes.
fn cubic(from: Vector3<f64>, to: Vector3<f64>, before: Vector3<f64>, after: Vector3<f64>, t: f64) -> Vector3<f64> {
    let chord = (to - from).norm();
    let (t2, t3) = (t * t, t * t * t);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + before * (chord * (t3 - 2.0 * t2 + t))
        + to * (3.0 * t2 - 2.0 * t3)
        + after * (chord * (t3 - t2))
}

/// Balls of a radius along a line, m. A line without radius is no body.
fn capsule(from: &Vector3<f64>, to: &Vector3<f64>, radius_m: f64) -> Vec<(Vector3<f64>, f64)> {
    if radius_m <= 0.0 {
        return Vec::new();
    }
    let parts = ((to - from).norm() / (APART * radius_m)).ceil().clamp(1.0, 1000.0);
    (0..=parts as usize).map(|part| (from.lerp(to, part as f64 / parts), radius_m)).collect()
}

/// Balls of a body that the tip holds along an axis: a capsule.
fn along(tip_m: &Vector3<f64>, body: &CarriedBody, axis: &Vector3<f64>) -> Vec<(Vector3<f64>, f64)> {
    let (top, bottom) = (body.above_m - body.radius_m, body.radius_m - body.below_m);
    let (top, bottom) = if top >= bottom { (top, bottom) } else { (0.5 * (top + bottom), 0.5 * (top + bottom)) };
    capsule(&(tip_m + axis * bottom), &(tip_m + axis * top), body.radius_m)
}

/// Axes of a body that turns with the tip since it was grasped upright, and of one that hangs from it.
fn axes(turn: &UnitQuaternion<f64>, grasp: &UnitQuaternion<f64>) -> [Vector3<f64>; 2] {
    [turn * grasp.inverse() * Vector3::z(), Vector3::z()]
}

/// Least distance to each obstacle less the required clearance, m.
///
/// `shift_m` is the way from the tip of rods to that of tubes between plates: the body goes that way with it, from the base outwards.
pub(super) fn spares_m(
    built: &Built,
    task: &LoadedTask,
    stand: &Stand,
    carried: Option<(&CarriedBody, UnitQuaternion<f64>)>,
    shift_m: &Vector3<f64>,
) -> Vec<f64> {
    if task.obstacles.is_empty() {
        return Vec::new();
    }
    let mut all = balls(built, task, stand);
    let count = all.len().max(1) as f64;
    all.iter_mut().enumerate().for_each(|(index, (center, _))| *center += shift_m * ((index + 1) as f64 / count));
    let tip = stand.shape.tip();
    // A stiff grip turns the body with it, a loose one lets it hang: it keeps clear either way.
    all.extend(carried.iter().flat_map(|(body, grasp)| {
        let place = stand.tip_m() + shift_m;
        axes(&tip.rotation, grasp).into_iter().flat_map(move |axis| along(&place, body, &axis))
    }));
    task.obstacles.iter().map(|obstacle| least_m(&all, &obstacle.shape) - obstacle.clearance_m).collect()
}

/// Least distance of balls from a solid, m.
fn least_m(balls: &[(Vector3<f64>, f64)], shape: &Shape) -> f64 {
    let (mut least_m, mut last) = (f64::INFINITY, None);
    for (center, radius_m) in balls {
        // A distance changes by no more than the way from a point where it is known.
        let bound_m = last.map_or(f64::NEG_INFINITY, |(known, at): (f64, &Vector3<f64>)| known - (center - at).norm());
        if bound_m - radius_m < least_m {
            let distance_m = shape.distance(center).distance_m;
            least_m = least_m.min(distance_m - radius_m);
            last = Some((distance_m, center));
        }
    }
    least_m
}

/// The least of spares and its obstacle; `None` without obstacles.
pub(super) fn least(spares_m: &[f64]) -> Option<(f64, usize)> {
    spares_m.iter().enumerate().map(|(index, spare)| (*spare, index)).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The less of two clearances of each obstacle.
pub(super) fn nearer(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(one, other)| one.min(*other)).collect()
}
