//! Orders of modules that need no search: they do the same as another, or a bound says that they cannot do the task.

use std::f64::consts::{PI, TAU};

use fra_model::Motion;
use nalgebra::Vector3;

use super::aim::missed;
use super::table::Table;
use super::task::{Aim, Space, Task};

/// Directions of a bending plane that are tried.
const PLANES: usize = 720;
/// A bound says that an order is hopeless where it leaves more than this, m.
const HOPELESS_M: f64 = 1e-3;

/// Why an order is left out; `None` where it is worth a search.
pub(super) fn pruned(task: &Task, spaces: &[&Space], longest_m: &[f64]) -> Option<String> {
    duplicate(spaces).or_else(|| too_short(task, longest_m)).or_else(|| off_its_plane(task, spaces, longest_m))
}

fn bends(space: &Space) -> bool {
    space.motion() == Motion::Bending
}

/// Modules on one straight line may change places without moving the tip; only one such order is searched.
fn duplicate(spaces: &[&Space]) -> Option<String> {
    let rank = |space: &Space| match space.motion() {
        Motion::Extension => 0,
        Motion::Expansion => 1,
        Motion::Twisting => 2,
        Motion::Bending => 3,
    };
    let swapped = spaces.windows(2).any(|pair| !bends(pair[0]) && !bends(pair[1]) && rank(pair[0]) > rank(pair[1]));
    if swapped {
        return Some("neighbours that do not bend have the same tip in the other order".into());
    }
    let last_bend = spaces.iter().rposition(|space| bends(space)).map_or(0, |index| index + 1);
    let idle = spaces[last_bend..].iter().any(|space| space.motion() == Motion::Twisting);
    idle.then(|| "a twist behind which nothing bends moves no tip".into())
}

/// The length that a module cannot exceed with its ends, m.
pub(super) fn longest(space: &Space, table: &Table) -> f64 {
    let mut most: f64 = 0.0;
    let steps = [0.0, 0.25, 0.5, 0.75, 1.0];
    for x in steps {
        for y in steps {
            for z in steps {
                let curve = table.curve([x, y, z]);
                most = steps.iter().map(|share| curve.at(*share).value[0]).fold(most, f64::max);
            }
        }
    }
    // A twentieth for what lies between these points, and for the error of the interpolation.
    1.05 * most * space.segment.bounds.length_m[1] + space.ends_m.iter().sum::<f64>()
}

fn reach(task: &Task, longest_m: &[f64]) -> f64 {
    longest_m.iter().sum::<f64>() + longest_m.len() as f64 * task.connector_m[0] + task.tool_m[0]
}

fn too_short(task: &Task, longest_m: &[f64]) -> Option<String> {
    let base = task.base.translation.vector;
    let reach = reach(task, longest_m);
    let beyond = task
        .way_points
        .iter()
        .enumerate()
        .filter_map(|(index, way_point)| Some((index, missed(&base, way_point.aim.as_ref()?).norm() - reach)));
    let (index, by_m) = beyond.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let reason = || format!("way-point {} is at least {:.0} mm beyond the longest limb", index + 1, by_m * 1e3);
    (by_m > HOPELESS_M).then(reason)
}

/// Without a bend the tip stays on the base's axis; with one, and no twist before it, in one half plane.
fn off_its_plane(task: &Task, spaces: &[&Space], longest_m: &[f64]) -> Option<String> {
    let bending = spaces.iter().filter(|space| bends(space)).count();
    let first = spaces.iter().position(|space| bends(space)).unwrap_or(spaces.len());
    let turned = spaces[..first].iter().any(|space| space.motion() == Motion::Twisting);
    if bending > 1 || (bending == 1 && turned) {
        return None;
    }
    let points: Option<Vec<Vector3<f64>>> = task
        .way_points
        .iter()
        .map(|way_point| match &way_point.aim {
            Some(Aim::Point(point)) => {
                Some(task.base.inverse_transform_vector(&(point - task.base.translation.vector)))
            }
            Some(Aim::Inside { .. }) | None => None,
        })
        .collect();
    let points = points?;
    if bending == 0 {
        let off = points.iter().map(|point| point.xy().norm()).fold(0.0, f64::max);
        let reason = || format!("nothing bends, and a way-point is {:.0} mm beside the axis of the base", off * 1e3);
        return (off > HOPELESS_M).then(reason);
    }
    let off = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        let distance = |point: &Vector3<f64>| {
            let (along, across) = (point.x * cosine + point.y * sine, point.y * cosine - point.x * sine);
            if along < 0.0 { point.xy().norm() } else { across.abs() }
        };
        points.iter().map(distance).fold(0.0, f64::max)
    };
    let least = (0..PLANES).map(|index| off(TAU * index as f64 / PLANES as f64)).fold(f64::INFINITY, f64::min);
    // Between two planes that are tried no point comes nearer by more than its way around the axis.
    let by_m = least - reach(task, longest_m) * PI / PLANES as f64;
    let reason = || format!("one plane of bending, and a way-point at least {:.0} mm off any", by_m * 1e3);
    (by_m > HOPELESS_M).then(reason)
}
