//! Pressure against deformation, a chart for each motion, as in Fig. 6 of the paper.

use fra_model::Motion;

use super::case::label;
use super::compare::{Comparison, Row};
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, sheet, span};

/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [470.0, 300.0];
const ROOM: [f64; 2] = [556.0, 446.0];

const CAPTION: &str = "Lines: analytic model. Dots: finite elements of the section. Rings: CalculiX.";

/// The picture as a document that stands by itself.
pub fn picture(comparison: &Comparison) -> String {
    let of = |motion, title: &str| chart(comparison, motion, title);
    let charts = [
        vec![of(Motion::Extension, "Extension"), of(Motion::Expansion, "Expansion")],
        vec![of(Motion::Bending, "Bending"), of(Motion::Twisting, "Twisting")],
    ];
    sheet(&charts, ROOM, CAPTION)
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
        let section = points(&|row| row.section);
        series.push(Series { label: String::new(), color, stroke: Stroke::Dots, points: section });
        series.push(Series { label: String::new(), color, stroke: Stroke::Rings, points: points(&|row| row.solid) });
    }
    let along = |axis: usize| span(series.iter().flat_map(|one| &one.points).map(|point| point[axis]));
    let (x, y) = (along(0), along(1));
    Chart {
        title: title.to_owned(),
        area: AREA,
        x: Axis { label: "gauge pressure, kPa".to_owned(), range: x, decades: false },
        y: Axis { label: label(motion), range: y, decades: false },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
