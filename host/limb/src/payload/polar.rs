//! The largest load against its direction, all around the tip of a limb in a pose. A load is a force on the tip; a hanging weight points down.

use std::f64::consts::TAU;

use fra_model::State;

use super::bundle::PayloadError;
use super::capacity::capacity;
use super::limb::{LoadCase, limb_capacity};
use super::program::Outcome;
use crate::Limb;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet};
use softlimb_scene::Scene;

/// Directions of a plane.
const DIRECTIONS: usize = 72;
/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [300.0, 300.0];
const ROOM: f64 = 400.0;
/// Charts side by side.
const COLUMNS: usize = 2;
/// End of an axis over the radius of the outermost circle.
const REACH: f64 = 1.1;
/// Most decades of the radius, chords of a circle, and number of spokes.
const DECADES: i32 = 4;
const CHORDS: usize = 90;
const SPOKES: usize = 8;
/// Directions in which the names of the circles may stand, rad: near the vertical, so that they do not touch each other.
const NAMED_RAD: [f64; 4] = [1.2, 1.95, -1.2, -1.95];
/// Middle of a note from its point, and half the size of a name, to the right and up; room around it that is enough, px.
const NOTE_ASIDE: [f64; 2] = [23.0, 9.0];
const NAME_HALF: [f64; 2] = [17.0, 6.0];
const FREE: f64 = 4.0;
/// Parts of a piece of a curve.
const PARTS: u32 = 16;

/// The largest loads of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// Name of the pose.
    pub name: String,
    /// For directions in the planes `x z` and `y z` of the scene: the force on the tip as a vector of that plane, N. It is not finite where the walls alone
    /// carry any load, and zero where no pressures hold the limb.
    pub loads_n: [Vec<[f64; 2]>; 2],
}

/// The largest loads of a limb in states, one a drive; the direction of `case` is not used.
///
/// # Errors
/// As [`limb_capacity`](super::limb_capacity()) and [`capacity`](super::capacity()).
pub fn polar(
    name: &str,
    (scene, limb): (&Scene, &Limb),
    states: &[State<f64>],
    case: &LoadCase,
) -> Result<Polar, PayloadError> {
    let load = |direction: [f64; 3]| -> Result<f64, PayloadError> {
        let found = capacity(&limb_capacity(scene, limb, states, &LoadCase { direction, ..*case })?.question)?;
        Ok(match found.outcome {
            Outcome::Solved => found.load_n.max(0.0),
            Outcome::Infeasible => 0.0,
            Outcome::Unbounded => f64::INFINITY,
        })
    };
    let of_plane = |turned: bool| {
        let of_direction = |index: usize| {
            let (up, along) = (TAU * (index % DIRECTIONS) as f64 / DIRECTIONS as f64).sin_cos();
            let load_n = load(if turned { [0.0, along, up] } else { [along, 0.0, up] })?;
            Ok([load_n * along, load_n * up])
        };
        // The first direction closes the line.
        (0..=DIRECTIONS).map(of_direction).collect::<Result<Vec<_>, PayloadError>>()
    };
    Ok(Polar { name: name.to_owned(), loads_n: [of_plane(false)?, of_plane(true)?] })
}

/// A diagram for each pose, all to one scale, as a document that stands by itself.
pub fn polar_picture(title: &str, poses: &[Polar]) -> String {
    let radius = Radius::of(poses.iter().flat_map(|pose| pose.loads_n.iter().flatten()).map(|[x, y]| x.hypot(*y)));
    let charts: Vec<Chart> = poses.iter().map(|pose| chart(pose, &radius)).collect();
    let rows: Vec<Vec<Chart>> = charts.chunks(COLUMNS).map(<[Chart]>::to_vec).collect();
    let middle = newtons(10_f64.powi(radius.exponents[0]));
    let mut caption = format!(
        "{title}: the largest force on the tip that the pressures can hold, in all directions of two planes. Straight down is a hanging weight. \
         The distance from the center is the force, on a logarithmic scale; the center is {middle} or less."
    );
    let planes = || poses.iter().flat_map(|pose| &pose.loads_n);
    if planes().flatten().any(|[x, y]| !x.hypot(*y).is_finite()) {
        caption += " A gap: the walls alone hold any force.";
    }
    if planes().any(|loads_n| alone(loads_n).contains(&true)) {
        caption += " A dot: of the directions of its plane, the pressures hold a force in this one alone.";
    }
    sheet(&rows, ROOM, &caption)
}

/// Logarithmic radius of a load. Loads along a limb are a hundred times those across it, and would hide them on a linear one.
#[derive(Debug, PartialEq)]
struct Radius {
    /// Exponents of ten of the loads in the middle and on the outermost circle, N.
    exponents: [i32; 2],
}

impl Radius {
    /// The decades that hold all loads, at most the upper ones.
    fn of(loads_n: impl Iterator<Item = f64>) -> Self {
        let loads_n = loads_n.filter(|load_n| load_n.is_finite() && *load_n > 0.0);
        let [least_n, most_n] =
            loads_n.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], load_n| [least.min(load_n), most.max(load_n)]);
        if most_n == 0.0 {
            return Self { exponents: [-1, 0] };
        }
        let high = most_n.log10().ceil() as i32;
        Self { exponents: [(least_n.log10().floor() as i32).clamp(high - DECADES, high - 1), high] }
    }

    /// The radius of a load as a share of the outermost one.
    fn share(&self, load_n: f64) -> f64 {
        let [low, high] = self.exponents.map(f64::from);
        if load_n > 0.0 { ((load_n.log10() - low) / (high - low)).max(0.0) } else { 0.0 }
    }

    /// Loads of the circles, N: more of them in few decades.
    fn circles_n(&self) -> Vec<f64> {
        let [low, high] = self.exponents;
        let leads: &[f64] = if high - low > 2 { &[10.0] } else { &[2.0, 5.0, 10.0] };
        (low..high).flat_map(|exponent| leads.iter().map(move |lead| lead * 10_f64.powi(exponent))).collect()
    }
}

fn newtons(load_n: f64) -> String {
    format!("{} N", (load_n * 1e9).round() / 1e9)
}

fn at(share: f64, angle: f64) -> [f64; 2] {
    [share * angle.cos(), share * angle.sin()]
}

/// Loads of the labelled circles, N, and the middles of the labels, on the circles. All lie along the direction of [`NAMED_RAD`] with the most room.
/// Inner circles whose label a curve would cross have none.
fn circle_names(radius: &Radius, curves: &[Vec<[f64; 2]>]) -> Vec<(f64, [f64; 2])> {
    let circles_n = radius.circles_n();
    let room = |angle: f64, load_n: f64| room_px(at(radius.share(load_n), angle), curves);
    let free = |angle: &f64| circles_n.iter().map(|&load_n| room(*angle, load_n)).fold(FREE, f64::min);
    // The first of equals: `max_by` takes the last.
    let best = NAMED_RAD.into_iter().rev().max_by(|a, b| free(a).total_cmp(&free(b))).unwrap_or(NAMED_RAD[0]);
    let outermost_n = circles_n.last().copied();
    let named = circles_n.iter().filter(|&&load_n| Some(load_n) == outermost_n || room(best, load_n) > 0.0);
    named.map(|&load_n| (load_n, at(radius.share(load_n), best))).collect()
}

/// Distance of the curves from a name whose middle is a point, px.
fn room_px(point: [f64; 2], curves: &[Vec<[f64; 2]>]) -> f64 {
    let px = |[x, y]: [f64; 2]| [x * AREA[0] / (2.0 * REACH), y * AREA[1] / (2.0 * REACH)];
    let name = px(point);
    let steps = curves.iter().flat_map(|curve| curve.windows(2)).flat_map(|ends| {
        let [from, to] = [px(ends[0]), px(ends[1])];
        (0..=PARTS).map(move |part| {
            let share = f64::from(part) / f64::from(PARTS);
            [0, 1].map(|axis: usize| from[axis] + share * (to[axis] - from[axis]))
        })
    });
    let beside = |at: [f64; 2]| {
        let [x, y] = [0, 1].map(|axis: usize| ((at[axis] - name[axis]).abs() - NAME_HALF[axis]).max(0.0));
        x.hypot(y)
    };
    steps.filter(|at| at.iter().all(|value| value.is_finite())).map(beside).fold(f64::INFINITY, f64::min)
}

/// Words in place of the curve of a plane without any bounded load that is held.
fn without_curve(plane: &str, loads_n: &[[f64; 2]]) -> Option<String> {
    let are = |holds: fn(f64) -> bool| loads_n.iter().all(|[x, y]| holds(x.hypot(*y)));
    match (are(|load_n| load_n == 0.0), are(|load_n| !load_n.is_finite())) {
        (true, _) => Some(format!("{plane}: no force")),
        (_, true) => Some(format!("{plane}: any force, by the walls alone")),
        _ => None,
    }
}

/// Directions whose neighbours are not drawn or hold nothing: a curve would not show them.
fn alone(loads_n: &[[f64; 2]]) -> Vec<bool> {
    let shows = |[x, y]: [f64; 2]| x.hypot(y).is_finite() && x.hypot(y) > 0.0;
    let ring = &loads_n[..loads_n.len().saturating_sub(1)];
    let neighbour = |index: usize, by: usize| shows(ring[(index + by) % ring.len()]);
    let is_alone = |index: usize| shows(ring[index]) && !neighbour(index, 1) && !neighbour(index, ring.len() - 1);
    (0..ring.len()).map(is_alone).collect()
}

fn chart(pose: &Polar, radius: &Radius) -> Chart {
    let grid = |points| Series { label: String::new(), color: Color::Grid, stroke: Stroke::Solid, points };
    let curve = |loads_n: &Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        loads_n.iter().map(|&[x, y]| at(radius.share(x.hypot(y)), y.atan2(x))).collect()
    };
    let curves: Vec<Vec<[f64; 2]>> = pose.loads_n.iter().map(curve).collect();
    let mut series = Vec::new();
    for share in radius.circles_n().into_iter().map(|load_n| radius.share(load_n)) {
        series.push(grid((0..=CHORDS).map(|chord| at(share, TAU * chord as f64 / CHORDS as f64)).collect()));
    }
    let name = |(load_n, middle): (f64, [f64; 2])| Note {
        at: [0, 1].map(|axis: usize| middle[axis] - NOTE_ASIDE[axis] * 2.0 * REACH / AREA[axis]),
        text: newtons(load_n),
        meaning: String::new(),
    };
    let mut notes: Vec<Note> = circle_names(radius, &curves).into_iter().map(name).collect();
    let spokes = (0..SPOKES).flat_map(|spoke| {
        let angle = TAU * spoke as f64 / SPOKES as f64;
        [[0.0; 2], at(1.0, angle), [f64::NAN; 2]]
    });
    series.push(grid(spokes.collect()));
    let looks =
        [("plane x z", Color::First, Stroke::Solid, REACH), ("plane y z", Color::Second, Stroke::Dashed, -REACH)];
    for ((loads_n, points), (plane, color, stroke, edge)) in pose.loads_n.iter().zip(curves).zip(looks) {
        if let Some(text) = without_curve(plane, loads_n) {
            notes.push(Note { at: [-REACH, edge], text, meaning: String::new() });
            continue;
        }
        let dots =
            points.iter().zip(alone(loads_n)).filter_map(|(&point, is_alone)| is_alone.then_some(point)).collect();
        series.push(Series { label: plane.into(), color, stroke, points });
        series.push(Series { label: String::new(), color, stroke: Stroke::Dots, points: dots });
    }
    let axis = |label: &str| Axis { label: label.into(), range: [-REACH, REACH], ticks: Ticks::Names(Vec::new()) };
    Chart {
        title: pose.name.clone(),
        area: AREA,
        x: axis("+x (plane x z) or +y (plane y z) →"),
        y: axis("+z, up →"),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Loads of four directions, the first once more at the end.
    fn around(loads_n: [f64; 4]) -> Vec<[f64; 2]> {
        let way = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let at = |index: usize| way[index % 4].map(|part| loads_n[index % 4] * part);
        (0..5).map(at).collect()
    }

    #[test]
    fn plane_without_a_curve_says_why() {
        for (loads_n, words) in [
            ([0.0; 4], Some("plane y z: no force")),
            ([f64::NAN; 4], Some("plane y z: any force, by the walls alone")),
            ([0.0, 3.0, f64::NAN, 0.0], None),
        ] {
            assert_eq!(without_curve("plane y z", &around(loads_n)).as_deref(), words);
        }
    }

    #[test]
    fn direction_between_two_without_load_is_a_dot() {
        assert_eq!(alone(&around([0.0, 5.0, 0.0, 0.0])), [false, true, false, false]);
        assert_eq!(alone(&around([7.0, f64::NAN, 5.0, 6.0])), [false; 4]);
        assert_eq!(alone(&around([7.0, f64::NAN, 5.0, 0.0])), [true, false, true, false]);
    }

    #[test]
    fn names_of_circles_stand_away_from_a_curve() {
        let radius = Radius { exponents: [0, 3] };
        // A curve through all names on the upper right, and one through those on both upper sides.
        let line = |angle: f64| (0..40).map(|step| at(f64::from(step) / 30.0, angle)).collect::<Vec<_>>();
        let named_rad = |curves: &[Vec<[f64; 2]>]| {
            let [x, y] = circle_names(&radius, curves)[0].1;
            y.atan2(x)
        };
        assert!((named_rad(&[]) - NAMED_RAD[0]).abs() < 1e-12);
        assert!((named_rad(&[line(1.1)]) - NAMED_RAD[0]).abs() > 0.1);
        assert!(named_rad(&[line(1.1), line(1.85)]) < 0.0);
        // Two circles cross the names of the innermost one in all directions.
        let around = |share: f64| (0..=72).map(|step| at(share, TAU * f64::from(step) / 72.0)).collect();
        let names = circle_names(&radius, &[around(0.32), around(0.36)]);
        let loads_n: Vec<f64> = names.into_iter().map(|(load_n, _)| load_n).collect();
        assert_eq!(loads_n, [100.0, 1000.0]);
    }

    #[test]
    fn radius_is_logarithmic_from_the_middle_to_the_outermost_circle() {
        let radius = Radius::of([0.0, 5.0, f64::INFINITY, 600.0].into_iter());
        assert_eq!(radius, Radius { exponents: [0, 3] });
        for (load_n, share) in
            [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (10.0, 1.0 / 3.0), (100.0, 2.0 / 3.0), (1000.0, 1.0)]
        {
            assert!((radius.share(load_n) - share).abs() < 1e-12, "{load_n}: {}", radius.share(load_n));
        }
        assert_eq!(radius.circles_n(), [10.0, 100.0, 1000.0]);
    }

    #[test]
    fn radius_has_at_least_one_decade_and_at_most_four() {
        for (loads_n, exponents, circles) in [
            (vec![], [-1, 0], 3),
            (vec![100.0], [1, 2], 3),
            (vec![30.0, 200.0], [1, 3], 6),
            (vec![1e-9, 50.0], [-2, 2], 4),
        ] {
            let radius = Radius::of(loads_n.clone().into_iter());
            assert_eq!((radius.exponents, radius.circles_n().len()), (exponents, circles), "{loads_n:?}");
        }
    }
}
