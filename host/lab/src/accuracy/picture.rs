//! Error against cost as a picture: one chart for each motion and problem, both axes in powers of ten.

use super::report::{Report, Row};
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, sheet};

/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [470.0, 300.0];
const ROOM: [f64; 2] = [556.0, 446.0];
/// Errors below this are drawn on it: nothing in double precision is better.
const LEAST_ERROR: f64 = 1e-17;
/// And errors above this on that: they are no approximation.
const MOST_ERROR: f64 = 1e2;
/// A name closer to another one than this, in decades, is left out: the tables have it.
const APART: [f64; 2] = [0.5, 0.8];

/// Methods that belong together, with their color; the series of a family are joined by a line.
const FAMILIES: [(&str, Color); 7] = [
    ("solver", Color::Ink),
    ("Newton", Color::First),
    ("nodes", Color::Third),
    ("Chebyshev", Color::Second),
    ("table", Color::Fifth),
    ("printed, B0, B1", Color::Fourth),
    ("limits", Color::Faint),
];

/// The picture as a document that stands by itself. Cost is the number of instructions where they were counted for every line, else
/// the time over that of the baseline.
pub fn picture(report: &Report) -> String {
    let counted = report.rows.iter().all(|row| row.cost.count.is_some());
    let cost = |row: &Row| if counted { row.cost.counted().0 } else { row.cost.time };
    let label = if counted { "instructions of one answer" } else { "time of one answer over that of the baseline" };
    let ranges = [range(report.rows.iter().filter_map(cost)), range(report.rows.iter().map(error))];
    let rows = ["extension", "expansion", "twisting", "bending"].map(|motion| {
        let of_motion = |problem| {
            let here = |line: &&Row| line.names[0] == problem && line.names[2] == motion;
            let lines: Vec<&Row> = report.rows.iter().filter(here).collect();
            chart(format!("{motion}, {problem}"), &lines, &cost, label, ranges)
        };
        ["forward", "inverse"].map(of_motion).to_vec()
    });
    sheet(&rows, ROOM, CAPTION)
}

fn error(row: &Row) -> f64 {
    row.accuracy.max_error.clamp(LEAST_ERROR, MOST_ERROR)
}

fn chart(
    title: String,
    lines: &[&Row],
    cost: &dyn Fn(&Row) -> Option<f64>,
    label: &str,
    [x, y]: [[f64; 2]; 2],
) -> Chart {
    let mut series = Vec::new();
    let mut notes: Vec<Note> = Vec::new();
    for (name, color) in FAMILIES {
        for (scalar, stroke) in [("f64", Stroke::Dots), ("f32", Stroke::Rings)] {
            let of = |row: &&&Row| family(&row.names[1]) == name && row.names[3] == scalar;
            let marks: Vec<(&Row, [f64; 2])> = lines
                .iter()
                .filter(of)
                .filter_map(|row| Some((*row, [cost(row)?.log10(), error(row).log10()])))
                .filter(|(_, [x, y])| x.is_finite() && y.is_finite())
                .collect();
            if marks.is_empty() {
                continue;
            }
            let points: Vec<_> = marks.iter().map(|(_, at)| *at).collect();
            if name != "solver" && name != "printed, B0, B1" && name != "limits" {
                let joined = Series { label: String::new(), color, stroke: Stroke::Dotted, points: joined(&marks) };
                series.push(joined);
            }
            series.push(Series { label: format!("{name}, {scalar}"), color, stroke, points });
            if scalar == "f64" {
                for (row, at) in &marks {
                    let near = |note: &Note| (0..2).all(|axis| (note.at[axis] - at[axis]).abs() < APART[axis]);
                    if !notes.iter().any(near) {
                        notes.push(Note { at: *at, text: short(&row.names[1]) });
                    }
                }
            }
        }
    }
    let axis = |label: &str, range| Axis { label: label.to_owned(), range, decades: true };
    Chart {
        title,
        area: AREA,
        x: axis(label, x),
        y: axis("largest relative error", y),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}

/// The marks of a family in order, with a gap wherever another group of it begins.
fn joined(marks: &[(&Row, [f64; 2])]) -> Vec<[f64; 2]> {
    let group = |row: &Row| row.names[1].contains("cold");
    let mut points = Vec::new();
    for (index, (row, at)) in marks.iter().enumerate() {
        if index > 0 && group(row) != group(marks[index - 1].0) {
            points.push([f64::NAN; 2]);
        }
        points.push(*at);
    }
    points
}

/// Which family a method belongs to.
fn family(method: &str) -> &'static str {
    match method {
        _ if method.starts_with("Newton") => "Newton",
        _ if method.ends_with("nodes") => "nodes",
        _ if method.starts_with("Chebyshev") => "Chebyshev",
        _ if method.starts_with("table") => "table",
        _ if method.starts_with("printed") || method == "B0" || method == "B1" => "printed, B0, B1",
        "closed form" | "inextensible fibers" => "limits",
        _ => "solver",
    }
}

/// A method beside its mark.
fn short(method: &str) -> String {
    let words = [
        ("Newton, warm, ", ""),
        ("Newton, cold, to ", "cold "),
        (" steps", ""),
        (" step", ""),
        (" nodes", ""),
        ("B2, ", ""),
        ("Chebyshev, degree ", ""),
        ("table, degree ", ""),
        ("printed ", ""),
        ("inextensible fibers", "inextensible"),
        ("forward, sheet", "cold, sheet"),
        ("inverse, sheet", "cold, sheet"),
        ("forward_from", "warm"),
        ("inverse_from", "warm"),
        ("inverse_near", "near"),
    ];
    let plain = words.iter().fold(method.to_owned(), |text, (from, to)| text.replace(from, to));
    if plain == "forward" || plain == "inverse" { "cold".to_owned() } else { plain }
}

/// Exponents of ten around all values.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let exponents = values.map(f64::log10).filter(|exponent| exponent.is_finite());
    let [low, high] = exponents.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| [low.min(e), high.max(e)]);
    if low > high { [0.0, 1.0] } else { [(low - 0.2).floor(), (high + 0.2).ceil()] }
}

const CAPTION: &str = "Largest relative error over the set against the cost of one answer. Dots: double precision; rings: single. \
                       A mark is named by its nodes, degree, Newton steps or start.";
