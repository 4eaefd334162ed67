//! Error of the bend against the time of one answer, a mark for each model.

use softlimb::comparison::Comparison;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet};

use super::{Choice, Summary};

/// Area of the chart, px, and its width with its frame.
const AREA: [f64; 2] = [710.0, 330.0];
const ROOM: f64 = 800.0;
/// Smaller values are drawn at this one.
const LEAST: f64 = 1e-12;
const COLORS: [Color; 5] = [Color::First, Color::Second, Color::Third, Color::Fourth, Color::Fifth];

const CAPTION: &str = "Error: difference from finite elements of the section on a mesh six times finer; for CalculiX, on the default mesh. \
                       Dot: median of the benders; line: up to the largest. Read times to a factor of ten.";

/// The picture as a document that stands by itself.
pub fn picture(choice: &Choice, validation: &Comparison) -> String {
    let (mut series, mut notes) = (Vec::new(), Vec::new());
    for (Summary { model, errors, seconds, .. }, color) in choice.summaries(validation).into_iter().zip(COLORS) {
        let (Some([median, largest]), Some(answer)) = (errors, seconds.answer) else { continue };
        let [x, median, largest] = [answer, median, largest].map(|value| value.max(LEAST).log10());
        let label = format!("{}: {}", model.name(), model.purpose());
        let points = vec![[x, median], [x, largest]];
        series.push(Series { label: String::new(), color, stroke: Stroke::Solid, points });
        series.push(Series { label, color, stroke: Stroke::Dots, points: vec![[x, median]] });
        notes.push(Note { at: [x, median], text: model.name().to_owned(), meaning: String::new() });
    }
    let axis = |index: usize, label: &str| {
        let values = series.iter().flat_map(|one| &one.points).map(|point| point[index]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| [low.min(e), high.max(e)]);
        let range = if low > high { [0.0, 1.0] } else { [(low - 0.1).floor(), (high + 0.1).ceil()] };
        Axis { label: label.to_owned(), range, ticks: Ticks::Powers }
    };
    let chart = Chart {
        title: "Which model for which task: error of the bend against cost".to_owned(),
        area: AREA,
        x: axis(0, "time of one answer, s"),
        y: axis(1, "relative error of the bend"),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    };
    sheet(&[vec![chart]], ROOM, CAPTION)
}
