//! The ablation as a picture: tip errors before and after learning, a row for each simulated limb.

use super::Row;
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, Ticks, sheet, span};

/// Width of a chart and height of a row, px.
const WIDTH: f64 = 600.0;
const ROW: f64 = 34.0;
/// Width of a chart with its frame, px.
const ROOM: f64 = 800.0;

const CAPTION: &str = "RMS tip error at the dwells on limbs whose parameters differ from those of the model: by the model alone, after learning, \
                       and with feedback within the run. Each effect of the body by itself, and all of them.";

/// A chart for each scene as a document that stands by itself.
pub(super) fn picture(rows: &[Row]) -> String {
    let charts: Vec<Vec<Chart>> =
        rows.chunk_by(|one, next| one.scene == next.scene).map(|rows| vec![chart(rows)]).collect();
    sheet(&charts, ROOM, CAPTION)
}

fn chart(rows: &[Row]) -> Chart {
    // The first row is on top.
    let places = || rows.iter().rev().zip((0..).map(f64::from));
    let exponent = |figures: Option<[f64; 3]>| figures.map_or(f64::NAN, |[rms_m, ..]| (1e3 * rms_m).log10());
    let points = |of: fn(&Row) -> Option<[f64; 3]>| places().map(|(row, y)| [exponent(of(row)), y]).collect();
    let between =
        places().flat_map(|(row, y)| [[exponent(row.by_model), y], [exponent(row.learned), y], [f64::NAN; 2]]);
    let series = vec![
        Series { label: String::new(), color: Color::Faint, stroke: Stroke::Dotted, points: between.collect() },
        Series {
            label: "by the model".into(),
            color: Color::Second,
            stroke: Stroke::Squares,
            points: points(|row| row.by_model),
        },
        Series {
            label: "after learning".into(),
            color: Color::First,
            stroke: Stroke::Dots,
            points: points(|row| row.learned),
        },
        Series {
            label: "with feedback".into(),
            color: Color::Third,
            stroke: Stroke::Crosses,
            points: points(|row| row.feedback),
        },
    ];
    let [low, high] = span(series.iter().flat_map(|one| &one.points).map(|point| point[0]));
    let names = rows.iter().rev().map(|row| name(&row.limb)).collect();
    Chart {
        title: rows[0].scene.clone(),
        area: [WIDTH, ROW * rows.len() as f64],
        x: Axis { label: "tip error, mm".into(), range: [low.floor(), high.ceil()], ticks: Ticks::Powers },
        y: Axis { label: String::new(), range: [-0.5, rows.len() as f64 - 0.5], ticks: Ticks::Names(names) },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}

/// A limb in few words: the effects of all are not listed.
fn name(limb: &str) -> String {
    match limb.matches(" + ").count() {
        0 if limb == "simple" => "planner's limb, perturbed".to_owned(),
        0 => "body, no effect".to_owned(),
        1 => limb.to_owned(),
        _ if limb.contains("swing") => "body + all of them".to_owned(),
        _ => "body + all but swing".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limb_has_a_row_and_two_marks() {
        let row = |limb: &str, learned| Row {
            scene: "arm".into(),
            limb: limb.into(),
            by_model: Some([40e-3, 0.0, 0.0]),
            learned,
            feedback: Some([2e-3, 0.0, 0.0]),
        };
        let svg = picture(&[row("simple", Some([0.4e-3, 0.0, 0.0])), row("body + creep", None)]);
        assert_eq!(
            (svg.matches("<circle").count(), svg.matches("c2 squares\" d=\"M").count()),
            (1 + 1, 2 + 1),
            "{svg}"
        );
        assert!(svg.contains(">planner's limb, perturbed<"), "{svg}");
        assert!(svg.contains(">body + creep<") && svg.contains(">10<tspan") && !svg.contains("NaN"), "{svg}");
    }
}
