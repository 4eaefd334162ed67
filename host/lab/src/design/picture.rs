//! The comparison as a picture: a row for each group, against model solves and against time.

use super::{Comparison, Method, Point};
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, Ticks, sheet, span, steps};
use softlimb_design::actuators::kinds::Kind;

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 170.0];
const ROOM: f64 = 400.0;
/// Least values that are drawn, of an objective and of a share: less is rounding.
const FLOORS: [f64; 2] = [1e-16, 1e-12];

const CAPTION: &str = "Least objective so far, a line for each problem; a dot ends it. Values below 1e-16 (1e-12 if relative to the least) are \
                       rounding, and are drawn there. There is no kind E.";

/// The picture as a document that stands by itself.
pub fn picture(comparison: &Comparison) -> String {
    let row = |group: &str| {
        let solves = |point: &Point| point.solves as f64;
        let seconds = |point: &Point| point.seconds;
        let titles = [named(group), format!("{group}, against time")];
        let [left, right] = titles.map(|title| (group, title));
        vec![chart(comparison, left, "model solves", &solves), chart(comparison, right, "time, s", &seconds)]
    };
    let rows: Vec<_> = comparison.groups().into_iter().map(row).collect();
    sheet(&rows, ROOM, CAPTION)
}

/// A group with its motions, if it is a kind of problems.
fn named(group: &str) -> String {
    let kind = Kind::ALL.into_iter().find(|kind| group.chars().eq([kind.letter()]));
    kind.map_or_else(|| group.to_owned(), |kind| format!("{group}: {kind}"))
}

fn chart(comparison: &Comparison, (group, title): (&str, String), label: &str, cost: &dyn Fn(&Point) -> f64) -> Chart {
    let reachable = comparison.reachable(group);
    let (floor, quantity) = if reachable { (FLOORS[0], "objective") } else { (FLOORS[1], "above the least, relative") };
    let mut series = Vec::new();
    for method in Method::ALL {
        let (color, name) = match method {
            Method::Projection => (Color::First, "projection"),
            Method::Swarm => (Color::Second, "particle swarm"),
        };
        let runs = comparison.runs.iter().filter(|run| run.group == group && run.method == method);
        for (index, run) in runs.enumerate() {
            let label = if index == 0 { name.to_owned() } else { String::new() };
            // The answer by the forward model, at the end, may differ from the search's by rounding.
            let mut least = f64::INFINITY;
            let mut place = |point: &Point| {
                least = least.min(comparison.left(run, point));
                [cost(point).log10(), least.max(floor).log10()]
            };
            let points: Vec<_> = run.points.iter().map(&mut place).collect();
            // The last one by itself: a run that has one point only would be no line.
            let end = points.last().copied().into_iter().collect();
            series.push(Series { label, color, stroke: Stroke::Solid, points: steps(&points) });
            series.push(Series { label: String::new(), color, stroke: Stroke::Dots, points: end });
        }
    }
    let along = |axis: usize| span(series.iter().flat_map(|one| &one.points).map(|point| point[axis]));
    let (x, y) = (along(0), along(1));
    Chart {
        title,
        area: AREA,
        x: Axis { label: label.to_owned(), range: x, ticks: Ticks::Powers },
        y: Axis { label: quantity.to_owned(), range: y, ticks: Ticks::Powers },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
