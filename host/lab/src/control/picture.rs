//! The picture: steps and a trajectory on the nominal plant, and the errors on the others.

use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet, span, steps};

use super::program::{STEP_S, STEPS_S, TRAJECTORY_S, knots_pa, reference_pa};
use super::{Group, Method, Moment, Trial};
use crate::faults::bench::VOLUMES_M3;

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 220.0];
const ROOM: f64 = 400.0;
/// Area of the chart of lanes, px: beside longer names, and as high as the chart on its left with its key.
const LANES_AREA: [f64; 2] = [312.0, 256.0];
const CAPTION: &str =
    "Three chambers under one program. Below: the errors on 60 plants that differ from the nominal one.";

/// Distance of two lanes of the errors over time, kPa.
const LANE_KPA: f64 = 5.0;

/// Height of a lane's words above its line, kPa: beyond its noise.
const WORDS_KPA: f64 = 1.5;

/// Ticks between two drawn points.
const EVERY: usize = 5;
/// Number of drawn steps.
const STEPS: f64 = 4.0;

/// The picture as a document that stands by itself.
pub(super) fn picture(trials: &[Trial]) -> String {
    let ours = || trials.iter().filter(|trial| trial.method == Method::OURS);
    let Some(nominal) = ours().find(|trial| trial.group == Group::Nominal) else { return String::new() };
    let steps = over_time(nominal, "steps, nominal plant", [STEPS_S - 0.1, STEPS_S + STEPS * STEP_S - 0.05]);
    let trajectory = errors_over_time(nominal, "trajectory, nominal plant", [TRAJECTORY_S.start, TRAJECTORY_S.end]);
    let spread: Vec<_> = ours().filter(|trial| trial.group == Group::Spread).collect();
    let errors = |title: &str, label: &str, value: fn(&super::Figures) -> f64| sorted(&spread, title, label, value);
    let below = vec![
        errors("steps, 60 plants", "overshoot, kPa", |figures| 1e-3 * figures.overshoot_pa),
        errors("trajectory, 60 plants", "RMS error, kPa", |figures| 1e-3 * figures.trajectory_pa[0]),
    ];
    sheet(&[vec![steps, trajectory], below], ROOM, CAPTION)
}

fn name(channel: usize) -> String {
    format!("{:.0} mL", VOLUMES_M3[channel] * 1e6)
}

/// Every `EVERY`th moment of a trial in a range of time, s.
fn moments(trial: &Trial, range: [f64; 2]) -> impl Iterator<Item = &Moment> {
    trial.recording.moments.iter().filter(move |it| (range[0]..range[1]).contains(&it.time_s)).step_by(EVERY)
}

fn over_time(trial: &Trial, title: &str, range: [f64; 2]) -> Chart {
    let knots_pa = knots_pa();
    let reference = moments(trial, range).map(|moment| [moment.time_s, 1e-3 * reference_pa(&knots_pa, moment.time_s)]);
    let points = reference.collect();
    let mut series = vec![Series { label: "reference".into(), color: Color::Ink, stroke: Stroke::Dashed, points }];
    series.extend((0..VOLUMES_M3.len()).map(|channel| Series {
        label: name(channel),
        color: Color::nth(channel),
        stroke: Stroke::Solid,
        points: moments(trial, range).map(|moment| [moment.time_s, 1e-3 * moment.pressure_pa[channel]]).collect(),
    }));
    chart(title, ["time, s", "pressure, kPa"], series)
}

/// Errors in lanes, the first chamber on top: over each other, the noise of one would hide the others.
fn errors_over_time(trial: &Trial, title: &str, range: [f64; 2]) -> Chart {
    let knots_pa = knots_pa();
    let count = VOLUMES_M3.len();
    let series = (0..count).map(|channel| {
        let error_pa = |moment: &Moment| moment.pressure_pa[channel] - reference_pa(&knots_pa, moment.time_s);
        let errors = moments(trial, range).map(|moment| [moment.time_s, 1e-3 * error_pa(moment)]);
        let points = errors.map(|[time_s, error_kpa]| [time_s, in_lane(channel, error_kpa)]).collect();
        Series { label: String::new(), color: Color::nth(channel), stroke: Stroke::Solid, points }
    });
    let label = format!("error, kPa: 0 on each line, {LANE_KPA} kPa apart");
    let mut chart = chart(title, ["time, s", &label], series.collect());
    chart.area = LANES_AREA;
    let figures = trial.figures.iter().flatten().enumerate();
    chart.notes = figures
        .map(|(channel, figures)| Note {
            at: [range[0], in_lane(channel, WORDS_KPA)],
            text: format!("RMS {:.2} kPa", 1e-3 * figures.trajectory_pa[0]),
            meaning: String::new(),
        })
        .collect();
    chart.y.ticks = Ticks::Names((0..count).rev().map(name).collect());
    chart
}

/// An error as a height: a lane is 1 high, the last chamber has that of 0.
fn in_lane(channel: usize, error_kpa: f64) -> f64 {
    (VOLUMES_M3.len() - 1 - channel) as f64 + error_kpa / LANE_KPA
}

/// Figures of the plants in ascending order: how many of them are below.
fn sorted(trials: &[&Trial], title: &str, label: &str, value: fn(&super::Figures) -> f64) -> Chart {
    let series = (0..VOLUMES_M3.len()).map(|channel| {
        let mut values: Vec<f64> =
            trials.iter().filter_map(|trial| Some(value(&trial.figures.as_ref()?[channel]))).collect();
        values.sort_by(f64::total_cmp);
        let points: Vec<_> = (1..).zip(values).map(|(count, value)| [value, f64::from(count)]).collect();
        Series { label: name(channel), color: Color::nth(channel), stroke: Stroke::Solid, points: steps(&points) }
    });
    chart(title, [label, "plants with at most this value"], series.collect())
}

fn chart(title: &str, labels: [&str; 2], series: Vec<Series>) -> Chart {
    let range = |axis: usize| span(series.iter().flat_map(|series| &series.points).map(|point| point[axis]));
    let axis = |index: usize| Axis { label: labels[index].into(), range: range(index), ticks: Ticks::Round };
    let (x, y) = (axis(0), axis(1));
    Chart { title: title.into(), area: AREA, x, y, series, bands: Vec::new(), marks: Vec::new(), notes: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_apart_and_the_first_chamber_is_on_top() {
        let lanes = [0, 1, 2].map(|channel| in_lane(channel, 0.0));
        assert_eq!(lanes, [2.0, 1.0, 0.0]);
        assert_eq!(in_lane(1, -2.5), 0.5);
    }
}
