//! The comparison as a picture: a row for each group, against model solves and against time.

use super::{Comparison, Method, Point};
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, sheet, span};

/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [420.0, 200.0];
const ROOM: [f64; 2] = [506.0, 300.0];
/// Least values that are drawn, of an objective and of a share.
const FLOORS: [f64; 2] = [1e-30, 1e-12];

const CAPTION: &str = "Least objective so far, a line for each problem. The last point of the projection is its answer by the forward model.";

/// The picture as a document that stands by itself.
pub fn picture(comparison: &Comparison) -> String {
    let row = |group: &str| {
        let solves = |point: &Point| point.solves as f64;
        let seconds = |point: &Point| point.seconds;
        vec![chart(comparison, group, "model solves", &solves), chart(comparison, group, "time, s", &seconds)]
    };
    let rows: Vec<_> = comparison.groups().into_iter().map(row).collect();
    sheet(&rows, ROOM, CAPTION)
}

fn chart(comparison: &Comparison, group: &str, label: &str, cost: &dyn Fn(&Point) -> f64) -> Chart {
    let reachable = comparison.reachable(group);
    let (floor, quantity) =
        if reachable { (FLOORS[0], "objective") } else { (FLOORS[1], "objective above the least, relative") };
    let mut series = Vec::new();
    for method in Method::ALL {
        let (color, name) = match method {
            Method::Projection => (Color::First, "projection"),
            Method::Swarm => (Color::Second, "particle swarm"),
        };
        let runs = comparison.runs.iter().filter(|run| run.group == group && run.method == method);
        for (index, run) in runs.enumerate() {
            let place = |point: &Point| [cost(point).log10(), comparison.left(run, point).max(floor).log10()];
            let label = if index == 0 { name.to_owned() } else { String::new() };
            let points: Vec<_> = run.points.iter().map(place).collect();
            // The last one by itself: a run that has one point only would be no line.
            let end = points.last().copied().into_iter().collect();
            series.push(Series { label, color, stroke: Stroke::Solid, points });
            series.push(Series { label: String::new(), color, stroke: Stroke::Dots, points: end });
        }
    }
    let along = |axis: usize| span(series.iter().flat_map(|one| &one.points).map(|point| point[axis]));
    let (x, y) = (along(0), along(1));
    Chart {
        title: group.to_owned(),
        area: AREA,
        x: Axis { label: label.to_owned(), range: x, decades: true },
        y: Axis { label: quantity.to_owned(), range: y, decades: true },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
