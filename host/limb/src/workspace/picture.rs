//! Side and front view, as of Fig. 8 of the paper.

use super::grid::Grid;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, sheet};

/// Longest side of a view, px, and the room around it.
const SIDE: f64 = 560.0;
const MARGIN: [f64; 2] = [90.0, 120.0];
/// Free space around what is drawn, as a share of its size.
const RIM: f64 = 0.06;

/// The workspace seen from the side (along the scene's second axis) and from the front (along the first), as a document that stands by itself.
/// `limb_m` is the limb's centre line at rest.
pub fn picture(title: &str, grid: &Grid, limb_m: &[[f64; 3]]) -> String {
    let views = [("side view", 1, [0, 2], ["x, m", "z, m"]), ("front view", 0, [1, 2], ["y, m", "z, m"])];
    let charts = views.map(|(name, along, axes, labels)| {
        let shadow = grid.shadow(along);
        let limb: Vec<[f64; 2]> = limb_m.iter().map(|point| axes.map(|axis: usize| point[axis])).collect();
        view(&format!("{title}: {name}"), shadow, limb, labels)
    });
    let room = charts.iter().fold([0.0_f64; 2], |room, chart| {
        [room[0].max(chart.area[0] + MARGIN[0]), room[1].max(chart.area[1] + MARGIN[1])]
    });
    sheet(&[charts.to_vec()], room, "dots: cells that a sample of the tip falls into; line: the limb at rest")
}

fn view(title: &str, shadow: Vec<[f64; 2]>, limb: Vec<[f64; 2]>, labels: [&str; 2]) -> Chart {
    let ranges = [0, 1].map(|axis: usize| {
        let values = shadow.iter().chain(&limb).map(|point| point[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let rim = RIM * (high - low).max(0.1);
        [low - rim, high + rim]
    });
    let sizes = ranges.map(|[low, high]| high - low);
    let scale = SIDE / sizes[0].max(sizes[1]);
    let [x, y] = [0, 1].map(|axis: usize| Axis { label: labels[axis].into(), range: ranges[axis], decades: false });
    let base = limb.first().copied();
    let series = |label: &str, color, stroke, points| Series { label: label.into(), color, stroke, points };
    Chart {
        title: title.into(),
        area: sizes.map(|size| (size * scale).max(120.0)),
        x,
        y,
        series: vec![
            series("tip", Color::First, Stroke::Dots, shadow),
            series("limb at rest", Color::Second, Stroke::Solid, limb),
        ],
        bands: Vec::new(),
        marks: Vec::new(),
        notes: base.map(|at| Note { at, text: "base".into() }).into_iter().collect(),
    }
}
