//! The tips around that of the nominal limb, and the share of limbs within a displacement, for each pose.

use super::sample::Sample;
use super::study::Study;
use crate::fabricate::Tolerances;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet, span};

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [320.0, 230.0];
const ROOM: f64 = 400.0;
/// Charts side by side.
const COLUMNS: usize = 2;
/// Most tips that are shown for a pose, and points of an ellipse.
const DOTS: usize = 150;
const ELLIPSE_POINTS: usize = 64;
/// Least ratio of a view's height to its width: a limb in a plane would leave no room for three ticks of the axis.
const LEAST_HEIGHT: f64 = 0.6;
/// Points of a curve.
const POINTS: usize = 200;

/// The limb with the scatter of its tip from two sides, and a chart for each pose, as a document that stands by itself.
pub fn picture(title: &str, study: &Study<'_>, samples: &[Sample]) -> String {
    let views = [("from the side", [0, 2], ["x, m", "z, m"]), ("from above", [0, 1], ["x, m", "y, m"])];
    let views = views.map(|(name, axes, labels)| view(name, study, samples, (axes, labels)));
    let mut charts: Vec<Chart> = (0..study.poses().len()).map(|pose| chart(study, samples, pose)).collect();
    // One range for all: their displacements are compared.
    let most = charts.iter().map(|chart| chart.x.range[1]).fold(0.0, f64::max);
    charts.iter_mut().for_each(|chart| chart.x.range[1] = most);
    let mut rows = vec![views.to_vec()];
    rows.extend(charts.chunks(COLUMNS).map(<[Chart]>::to_vec));
    let Tolerances { wall_m, angle_rad, modulus } = study.settings.tolerances;
    let caption = format!(
        "{title}: tips of {} limbs with walls within {} mm, fiber angles within {} deg and moduli within {} % of the nominal ones. \
         Above: a dot for a limb, at most {DOTS} for each pose, and ellipses of two standard deviations. Below: displacements of all, by the model and by its sensitivities (linear).",
        samples.len(),
        rounded(1e3 * wall_m),
        rounded(angle_rad.to_degrees()),
        rounded(100.0 * modulus),
    );
    sheet(&rows, ROOM, &caption)
}

/// A value to four decimals, without zeros at the end.
fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// The nominal limb in each pose, seen along a coordinate, with the tips of the samples.
fn view(name: &str, study: &Study<'_>, samples: &[Sample], (axes, labels): ([usize; 2], [&str; 2])) -> Chart {
    // Tips lie below all limbs, and limbs below the ellipses.
    let (mut dots, mut limbs, mut ellipses, mut notes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, pose) in study.poses().iter().enumerate() {
        let color = Color::nth(index);
        let states: Vec<_> = study
            .limb
            .drives()
            .zip(&pose.pressures_pa)
            .map(|(drive, pressure_pa)| drive.curve.at(*pressure_pa))
            .collect();
        let line: Vec<[f64; 2]> =
            study.limb.backbone(&states).iter().map(|point| axes.map(|axis| point[axis])).collect();
        let end_m = study.nominal_tip_m(index);
        let end = axes.map(|axis| end_m[axis]);
        let tips: Vec<[f64; 2]> = samples
            .iter()
            .filter_map(|sample| sample[index].displacement_m.as_ref().ok())
            .map(|moved_m| [end[0] + moved_m[axes[0]], end[1] + moved_m[axes[1]]])
            .collect();
        let ellipse = ellipse(&tips);
        let shown = tips.iter().step_by(tips.len().div_ceil(DOTS).max(1)).copied().collect();
        let one = |label: &str, color, stroke, points| Series { label: label.into(), color, stroke, points };
        // The name stands at the upper end.
        let end = ellipse.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1]));
        notes.extend(end.map(|at| Note { at, text: pose.name.clone(), meaning: String::new() }));
        dots.push(one("", color, Stroke::Dots, shown));
        limbs.push(one(&pose.name, color, Stroke::Solid, line));
        // In the color of the tips, the ellipse would not show.
        ellipses.push(one("", Color::Ink, Stroke::Solid, ellipse));
    }
    let series: Vec<Series> = [dots, limbs, ellipses].concat();
    let points = || series.iter().flat_map(|one| &one.points);
    let [x, y] = [0, 1].map(|axis: usize| {
        let [low, high] = span(points().map(|point| point[axis]));
        [low, high.max(low + 0.05)]
    });
    let missing = (LEAST_HEIGHT * (x[1] - x[0]) - (y[1] - y[0])).max(0.0);
    let y = [y[0] - 0.5 * missing, y[1] + 0.5 * missing];
    // One scale for both axes.
    let scale = (AREA[0] / (x[1] - x[0])).min(AREA[1] / (y[1] - y[0]));
    Chart {
        title: name.to_owned(),
        area: [(x[1] - x[0]) * scale, (y[1] - y[0]) * scale],
        x: Axis { label: labels[0].into(), range: x, ticks: Ticks::Round },
        y: Axis { label: labels[1].into(), range: y, ticks: Ticks::Round },
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}

/// The ellipse of two standard deviations about the mean of points; empty for fewer than three.
fn ellipse(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() < 3 {
        return Vec::new();
    }
    let count = points.len() as f64;
    let mean = [0, 1].map(|axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let product = |a: usize, b: usize| {
        points.iter().map(|point| (point[a] - mean[a]) * (point[b] - mean[b])).sum::<f64>() / (count - 1.0)
    };
    // Cholesky factor of the covariance.
    let first = product(0, 0).sqrt();
    let across = if first > 0.0 { product(0, 1) / first } else { 0.0 };
    let second = (product(1, 1) - across * across).max(0.0).sqrt();
    let point = |step: usize| {
        let (sin, cos) = (std::f64::consts::TAU * step as f64 / ELLIPSE_POINTS as f64).sin_cos();
        [mean[0] + 2.0 * first * cos, mean[1] + 2.0 * (across * cos + second * sin)]
    };
    (0..=ELLIPSE_POINTS).map(point).collect()
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
        x: Axis { label: "displacement of the tip, mm".into(), range: [0.0, largest.max(1e-6)], ticks: Ticks::Round },
        y: Axis {
            label: "share of limbs with a smaller displacement, %".into(),
            range: [0.0, 100.0],
            ticks: Ticks::Round,
        },
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipse_has_the_axes_of_the_scatter() {
        // Variances 4 and 1 along axes that lean by 3-4-5.
        let spread = [[2.0, 0.0], [-2.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|[u, v]: [f64; 2]| {
            let scale = (3.0_f64 / 2.0).sqrt();
            [5.0 + scale * (0.8 * u - 0.6 * v), scale * (0.6 * u + 0.8 * v)]
        });
        let found = ellipse(&spread);
        for [x, y] in &found {
            let (u, v) = (0.8 * (x - 5.0) + 0.6 * y, -0.6 * (x - 5.0) + 0.8 * y);
            assert!(((u / 4.0).powi(2) + (v / 2.0).powi(2) - 1.0).abs() < 1e-12, "{u} {v}");
        }
        assert_eq!((found.len(), ellipse(&spread[..2]).len()), (ELLIPSE_POINTS + 1, 0));
    }
}
