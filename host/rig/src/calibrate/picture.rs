//! Measurements, what the model says before and after, and what is left.

use super::{Branch, Fit, Observation, RangeFit, Tension, TensionFit};
use fra_model::StateQuantity;
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, Ticks, sheet, span};

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 240.0];
const ROOM: f64 = 400.0;

/// A fit as a document that stands by itself: a row for each quantity, with the deformations beside their residuals.
pub fn picture(fit: &Fit, observations: &[Observation]) -> String {
    let mut quantities: Vec<StateQuantity> = Vec::new();
    for seen in observations {
        if !quantities.contains(&seen.quantity) {
            quantities.push(seen.quantity);
        }
    }
    let rows: Vec<Vec<Chart>> = quantities.iter().map(|quantity| row(fit, observations, *quantity)).collect();
    sheet(
        &rows,
        ROOM,
        "Dots: measured. Lines: the fit, dashed its confidence interval, dotted the model before the fit.",
    )
}

fn row(fit: &Fit, observations: &[Observation], quantity: StateQuantity) -> Vec<Chart> {
    let scale = quantity.display_scale();
    let (mut curves, mut left) = (Vec::new(), Vec::new());
    for (index, body) in fit.bodies.iter().enumerate() {
        let mut of: Vec<usize> = (0..observations.len())
            .filter(|k| observations[*k].body == index && observations[*k].quantity == quantity)
            .collect();
        if of.is_empty() {
            continue;
        }
        // Up the branch of loading and down that of unloading.
        let along = |k: usize| observations[k].branch.sign() * observations[k].reading_pa;
        let is_back = |k: usize| observations[k].branch == Branch::Unloading;
        of.sort_by(|a, b| is_back(*a).cmp(&is_back(*b)).then(along(*a).total_cmp(&along(*b))));
        let points = |value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
            of.iter().map(|k| [observations[*k].reading_pa * 1e-3, scale * value(*k)]).collect()
        };
        let color = Color::nth(index);
        let mut add = |label: String, color, stroke, points| curves.push(Series { label, color, stroke, points });
        add(String::new(), Color::Faint, Stroke::Dotted, points(&|k| fit.before[k].unwrap_or(f64::NAN)));
        add(String::new(), color, Stroke::Solid, points(&|k| fit.after[k]));
        for sign in [-1.0, 1.0] {
            add(String::new(), color, Stroke::Dashed, points(&|k| fit.after[k] + sign * fit.half_widths[k]));
            let width = points(&|k| sign * fit.half_widths[k]);
            left.push(Series { label: String::new(), color, stroke: Stroke::Dashed, points: width });
        }
        add(body.name.clone(), color, Stroke::Dots, points(&|k| observations[k].value));
        left.push(Series {
            label: body.name.clone(),
            color,
            stroke: Stroke::Dots,
            points: points(&|k| observations[k].value - fit.after[k]),
        });
    }
    let unit = quantity.display_unit();
    let label = |what: &str| if unit.is_empty() { what.to_owned() } else { format!("{what}, {unit}") };
    let name = quantity.label();
    vec![
        chart(name.to_owned(), "reading, kPa", &label(name), curves),
        chart(format!("{name}: measured less fit"), "reading, kPa", &label("residual"), left),
    ]
}

/// A tensile test as a document that stands by itself.
pub fn tension_picture(test: &Tension, fit: &TensionFit) -> String {
    let mut order: Vec<usize> = (0..test.points().len()).collect();
    order.sort_by(|a, b| test.points()[*a][0].total_cmp(&test.points()[*b][0]));
    let points = |value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        order.iter().map(|k| [test.points()[*k][0], 1e-3 * value(*k)]).collect()
    };
    let measured = |k: usize| test.points()[k][1];
    let series = |label: &str, color, stroke, points| Series { label: label.into(), color, stroke, points };
    let interval = |of: &dyn Fn(usize) -> f64| {
        [-1.0, 1.0]
            .map(|sign| series("", Color::First, Stroke::Dashed, points(&|k| of(k) + sign * fit.half_widths_pa[k])))
    };
    let mut curves = vec![
        series(fit.law.word(), Color::First, Stroke::Solid, points(&|k| fit.modelled_pa[k])),
        series("measured", Color::Ink, Stroke::Dots, points(&measured)),
    ];
    curves.extend(interval(&|k| fit.modelled_pa[k]));
    let mut left =
        vec![series("measured less law", Color::Ink, Stroke::Dots, points(&|k| measured(k) - fit.modelled_pa[k]))];
    left.extend(interval(&|_| 0.0));
    let charts = vec![
        chart("nominal stress".into(), "stretch", "nominal stress, kPa", curves),
        chart("residual".into(), "stretch", "residual, kPa", left),
    ];
    sheet(&[charts], ROOM, "Dots: measured. Line: the law that fits, dashed its confidence interval.")
}

/// A tensile test and the law of its range as a document that stands by itself.
pub fn range_picture(name: &str, test: &Tension, fit: Option<&RangeFit>) -> String {
    let readings = test.points().iter().map(|[stretch, stress]| [*stretch, 1e-3 * stress]);
    let is_inside = |[stretch, _]: &[f64; 2]| fit.is_none_or(|fit| (fit.stretch[0]..=fit.stretch[1]).contains(stretch));
    let (measured, outside): (Vec<[f64; 2]>, Vec<[f64; 2]>) = readings.partition(is_inside);
    let mut curves = Vec::new();
    if let Some(fit) = fit {
        let [low, high] = fit.stretch;
        let law = (0..=100).map(|step| low + (high - low) * f64::from(step) / 100.0);
        let points = law.map(|stretch| [stretch, 1e-3 * fit.stress_pa(stretch)]).collect();
        curves.push(Series { label: "Yeoh law".into(), color: Color::First, stroke: Stroke::Solid, points });
    }
    curves.push(Series { label: "measured".into(), color: Color::Ink, stroke: Stroke::Dots, points: measured });
    if !outside.is_empty() {
        let label = "measured, outside the range of the fit".into();
        curves.push(Series { label, color: Color::Ink, stroke: Stroke::Rings, points: outside });
    }
    let charts = vec![chart(format!("{name}: nominal stress"), "stretch", "nominal stress, kPa", curves)];
    sheet(&[charts], ROOM, &format!("Tensile test of {name}, and the law fitted to it"))
}

fn chart(title: String, x: &str, y: &str, series: Vec<Series>) -> Chart {
    let range = |axis: usize| span(series.iter().flat_map(|series| &series.points).map(|point| point[axis]));
    let axis = |label: &str, range| Axis { label: label.into(), range, ticks: Ticks::Round };
    let (across, up) = (range(0), range(1));
    Chart {
        title,
        area: AREA,
        x: axis(x, across),
        y: axis(y, up),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
