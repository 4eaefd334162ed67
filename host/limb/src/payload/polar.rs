//! The largest load against its direction: what a limb holds in a pose, all around.

use std::f64::consts::TAU;

use fra_model::State;

use super::bundle::PayloadError;
use super::capacity::capacity;
use super::limb::{LoadCase, limb_capacity};
use super::program::Outcome;
use crate::Limb;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, sheet};
use softlimb_scene::Scene;

/// Directions of a plane.
const DIRECTIONS: usize = 72;
/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [300.0, 300.0];
const ROOM: [f64; 2] = [400.0, 394.0];
/// Charts side by side.
const COLUMNS: usize = 2;
/// Circles of one load, and the chords of one.
const RINGS: usize = 4;
const CHORDS: usize = 90;
/// Direction of the names of the circles, rad.
const NAMED_RAD: f64 = 1.35;

const CAPTION: &str = "Largest load that pressures hold, in the direction from the middle to the line.";

/// The largest loads of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar {
    /// Name of the pose.
    pub name: String,
    /// For directions in the planes `x z` and `y z` of the scene: the load as a vector of that plane, N. It is not finite where the walls alone
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
    let loads = poses.iter().flat_map(|pose| pose.loads_n.iter().flatten());
    let largest_n = loads.map(|[x, y]| x.hypot(*y)).filter(|load_n| load_n.is_finite()).fold(0.0, f64::max);
    let step_n = step(if largest_n > 0.0 { largest_n } else { 1.0 });
    let charts: Vec<Chart> = poses.iter().map(|pose| chart(pose, step_n)).collect();
    let rows: Vec<Vec<Chart>> = charts.chunks(COLUMNS).map(<[Chart]>::to_vec).collect();
    sheet(&rows, ROOM, &format!("{title}. {CAPTION}"))
}

/// Distance of the circles: the least round load of which so many hold the largest one.
fn step(largest_n: f64) -> f64 {
    let rough = largest_n / RINGS as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let round = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|lead| lead * power);
    round.into_iter().find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

fn chart(pose: &Polar, step_n: f64) -> Chart {
    let most_n = 1.04 * step_n * RINGS as f64;
    let (mut series, mut notes) = (Vec::new(), Vec::new());
    for ring in 1..=RINGS {
        let load_n = step_n * ring as f64;
        let point = |angle: f64| [load_n * angle.cos(), load_n * angle.sin()];
        let points = (0..=CHORDS).map(|chord| point(TAU * chord as f64 / CHORDS as f64)).collect();
        series.push(Series { label: String::new(), color: Color::Faint, stroke: Stroke::Dotted, points });
        let text = format!("{} N", (load_n * 1e6).round() / 1e6);
        notes.push(Note { at: point(NAMED_RAD), text });
    }
    let looks = [("in the plane x z", Color::First, Stroke::Solid), ("in y z", Color::Second, Stroke::Dashed)];
    for (points, (label, color, stroke)) in pose.loads_n.iter().zip(looks) {
        series.push(Series { label: label.into(), color, stroke, points: points.clone() });
    }
    let axis = |label: &str| Axis { label: label.into(), range: [-most_n, most_n], decades: false };
    Chart {
        title: pose.name.clone(),
        area: AREA,
        x: axis("load along x or y, N"),
        y: axis("load along z, up, N"),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_round_and_hold_the_largest_load() {
        for (largest_n, expected) in [(3.9, 1.0), (4.1, 2.0), (95.0, 25.0), (0.081, 0.025), (100.0, 25.0)] {
            assert!((step(largest_n) - expected).abs() < 1e-12 * expected, "{largest_n}: {}", step(largest_n));
        }
    }
}
