//! How many limbs stay within a distance, for each pose.

use super::sample::Sample;
use super::study::Study;
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, sheet};

/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [300.0, 200.0];
const ROOM: [f64; 2] = [390.0, 330.0];
/// Charts side by side.
const COLUMNS: usize = 3;
/// Points of a curve.
const POINTS: usize = 200;

/// A chart for each pose, as a document that stands by itself.
pub fn picture(title: &str, study: &Study<'_>, samples: &[Sample]) -> String {
    let charts: Vec<Chart> = (0..study.poses().len()).map(|pose| chart(study, samples, pose)).collect();
    let rows: Vec<Vec<Chart>> = charts.chunks(COLUMNS).map(<[Chart]>::to_vec).collect();
    let caption =
        format!("{title}: limbs whose tip is within a distance of the nominal one; solid: the model, dotted: linear");
    sheet(&rows, ROOM, &caption)
}

fn chart(study: &Study<'_>, samples: &[Sample], pose: usize) -> Chart {
    let deviations = || samples.iter().map(|sample| &sample[pose]);
    let model = deviations().filter_map(|deviation| Some(deviation.displacement_m.as_ref().ok()?.norm()));
    let curves = [
        ("model", Color::First, Stroke::Solid, curve(model.collect(), samples.len())),
        (
            "linear",
            Color::Second,
            Stroke::Dotted,
            curve(deviations().map(|d| d.linear_m.norm()).collect(), samples.len()),
        ),
    ];
    let largest = curves.iter().flat_map(|(_, _, _, points)| points).fold(0.0_f64, |most, point| most.max(point[0]));
    let series = curves.map(|(label, color, stroke, points)| Series { label: label.into(), color, stroke, points });
    Chart {
        title: study.poses()[pose].name.clone(),
        area: AREA,
        x: Axis { label: "displacement of the tip, mm".into(), range: [0.0, largest.max(1e-6)], decades: false },
        y: Axis { label: "limbs, %".into(), range: [0.0, 100.0], decades: false },
        series: series.into(),
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}

/// Distances, mm, against the share of all samples, %, that do not exceed them.
fn curve(mut distances_m: Vec<f64>, count: usize) -> Vec<[f64; 2]> {
    distances_m.sort_by(f64::total_cmp);
    let Some(last) = distances_m.len().checked_sub(1) else { return Vec::new() };
    let ranks = (0..=POINTS.min(last.max(1))).map(|point| last * point / POINTS.min(last.max(1)));
    ranks.map(|rank| [1e3 * distances_m[rank], 100.0 * (rank + 1) as f64 / count as f64]).collect()
}
