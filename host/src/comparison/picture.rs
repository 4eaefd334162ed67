//! Pressure against deformation, a chart for each motion, as in Fig. 6 of the paper.

use fra_model::Motion;

use super::case::label;
use super::compare::{Comparison, Row};
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, Ticks, sheet, span};

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 210.0];
const ROOM: f64 = 400.0;

const CAPTION: &str = "Tubes of 6/8 mm and 10/14 mm: inner and outer radius. Lines: analytic model. Crosses: finite elements of the section. \
                       Squares: calibrated cubic. Rings: CalculiX. The scales of the difference charts differ.";

/// The picture as a document that stands by itself.
pub fn picture(comparison: &Comparison) -> String {
    let pairs = [
        [(Motion::Extension, "Extension"), (Motion::Expansion, "Expansion")],
        [(Motion::Bending, "Bending"), (Motion::Twisting, "Twisting")],
    ];
    let rows = pairs.iter().flat_map(|pair| {
        let curves = pair.iter().map(|(motion, title)| chart(comparison, *motion, title)).collect();
        [curves, pair.iter().map(|(motion, title)| differences(comparison, *motion, title)).collect()]
    });
    sheet(&rows.collect::<Vec<_>>(), ROOM, CAPTION)
}

/// Differences of the finite elements from the analytic model.
fn differences(comparison: &Comparison, motion: Motion, title: &str) -> Chart {
    let mut series = Vec::new();
    let cases = comparison.by_case().into_iter().filter(|rows| rows[0].motion == motion);
    for (index, rows) in cases.enumerate() {
        let percent = |row: &Row, value: Option<f64>| {
            let analytic = row.analytic?;
            Some([row.pressure_kpa, 1e2 * (value? - analytic) / (analytic - row.rest).abs()])
        };
        let points = |value: &dyn Fn(&Row) -> Option<f64>| -> Vec<[f64; 2]> {
            rows.iter().filter_map(|row| percent(row, value(row))).collect()
        };
        for (stroke, points) in [
            (Stroke::Rings, points(&|row| row.solid)),
            (Stroke::Squares, points(&|row| row.calibrated)),
            (Stroke::Crosses, points(&|row| row.section)),
        ] {
            series.push(Series { label: String::new(), color: Color::nth(index), stroke, points });
        }
    }
    let points = || series.iter().flat_map(|one| &one.points);
    Chart {
        title: format!("{title}: difference from the model"),
        area: AREA,
        x: Axis {
            label: "gauge pressure, kPa".to_owned(),
            range: span(points().map(|point| point[0]).chain([0.0])),
            ticks: Ticks::Round,
        },
        y: Axis {
            label: "difference, % of the deformation".to_owned(),
            range: span(points().map(|point| point[1]).chain([0.0])),
            ticks: Ticks::Round,
        },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}

fn chart(comparison: &Comparison, motion: Motion, title: &str) -> Chart {
    let cases: Vec<&[Row]> = comparison.by_case().into_iter().filter(|rows| rows[0].motion == motion).collect();
    let mut series = Vec::new();
    for (index, rows) in cases.iter().enumerate() {
        let color = Color::nth(index);
        let points = |value: &dyn Fn(&Row) -> Option<f64>| -> Vec<[f64; 2]> {
            rows.iter().filter_map(|row| Some([row.pressure_kpa, value(row)?])).collect()
        };
        let mut line = points(&|row| row.analytic);
        line.insert(0, [0.0, rows[0].rest]);
        let label = rows[0].case.split_once(", ").map_or_else(|| rows[0].case.clone(), |(_, rest)| rest.to_owned());
        series.push(Series { label, color, stroke: Stroke::Solid, points: line });
        let mut add = |stroke, points| series.push(Series { label: String::new(), color, stroke, points });
        add(Stroke::Rings, points(&|row| row.solid));
        add(Stroke::Squares, points(&|row| row.calibrated));
        add(Stroke::Crosses, points(&|row| row.section));
    }
    let along = |axis: usize| span(series.iter().flat_map(|one| &one.points).map(|point| point[axis]));
    let (x, y) = (along(0), along(1));
    Chart {
        title: title.to_owned(),
        area: AREA,
        x: Axis { label: "gauge pressure, kPa".to_owned(), range: x, ticks: Ticks::Round },
        y: Axis { label: label(motion), range: y, ticks: Ticks::Round },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
