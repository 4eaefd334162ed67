//! The largest load against its direction: what a limb holds in a pose, all around.

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
/// Most decades of the radius, chords of a circle, and number of spokes.
const DECADES: i32 = 4;
const CHORDS: usize = 90;
const SPOKES: usize = 8;
/// Direction of the names of the circles, rad.
const NAMED_RAD: f64 = 1.25;

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
    let radius = Radius::of(poses.iter().flat_map(|pose| pose.loads_n.iter().flatten()).map(|[x, y]| x.hypot(*y)));
    let charts: Vec<Chart> = poses.iter().map(|pose| chart(pose, &radius)).collect();
    let rows: Vec<Vec<Chart>> = charts.chunks(COLUMNS).map(<[Chart]>::to_vec).collect();
    let middle = newtons(10_f64.powi(radius.exponents[0]));
    sheet(
        &rows,
        ROOM,
        &format!("{title}: largest load that pressures hold, by its direction. Logarithmic; middle: {middle} or less."),
    )
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

fn chart(pose: &Polar, radius: &Radius) -> Chart {
    let at = |share: f64, angle: f64| [share * angle.cos(), share * angle.sin()];
    let faint = |stroke, points| Series { label: String::new(), color: Color::Faint, stroke, points };
    let (mut series, mut notes) = (Vec::new(), Vec::new());
    for load_n in radius.circles_n() {
        let share = radius.share(load_n);
        let points = (0..=CHORDS).map(|chord| at(share, TAU * chord as f64 / CHORDS as f64)).collect();
        series.push(faint(Stroke::Dotted, points));
        notes.push(Note { at: at(share, NAMED_RAD), text: newtons(load_n) });
    }
    let spokes = (0..SPOKES).flat_map(|spoke| {
        let angle = TAU * spoke as f64 / SPOKES as f64;
        [[0.0; 2], at(1.0, angle), [f64::NAN; 2]]
    });
    series.push(faint(Stroke::Dotted, spokes.collect()));
    let looks = [("in the plane x z", Color::First, Stroke::Solid), ("in y z", Color::Second, Stroke::Dashed)];
    for (loads_n, (label, color, stroke)) in pose.loads_n.iter().zip(looks) {
        let points = loads_n.iter().map(|&[x, y]| at(radius.share(x.hypot(y)), y.atan2(x))).collect();
        series.push(Series { label: label.into(), color, stroke, points });
    }
    let axis = |label: &str| Axis { label: label.into(), range: [-1.1, 1.1], ticks: Ticks::Names(Vec::new()) };
    Chart {
        title: pose.name.clone(),
        area: AREA,
        x: axis("direction along x or y"),
        y: axis("direction along z, up"),
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
