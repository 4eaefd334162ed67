//! The picture: steps and a trajectory on the nominal plant, and the errors on the others.

use softlimb_chart::{Axis, Chart, Color, Series, Stroke, sheet, span};

use super::program::{STEP_S, STEPS_S, TRAJECTORY_S, knots_pa, reference_pa};
use super::{Group, Method, Trial};
use crate::faults::bench::VOLUMES_M3;

/// Area of one chart, px, and the room it takes with its frame.
const AREA: [f64; 2] = [420.0, 220.0];
const ROOM: [f64; 2] = [506.0, 330.0];
const CAPTION: &str = "Pressures of three chambers by one program, and the errors on 60 plants that differ from the device's configuration";

/// Ticks between two drawn points.
const EVERY: usize = 5;
/// Number of drawn steps.
const STEPS: f64 = 4.0;

/// The picture as a document that stands by itself.
pub(super) fn picture(trials: &[Trial]) -> String {
    let ours = || trials.iter().filter(|trial| trial.method == Method::Firmware);
    let Some(nominal) = ours().find(|trial| trial.group == Group::Nominal) else { return String::new() };
    let steps = over_time(nominal, "steps, nominal plant", [STEPS_S - 0.1, STEPS_S + STEPS * STEP_S]);
    let trajectory = over_time(nominal, "trajectory, nominal plant", [TRAJECTORY_S.start, TRAJECTORY_S.end]);
    let spread: Vec<_> = ours().filter(|trial| trial.group == Group::Spread).collect();
    let errors = |title: &str, label: &str, value: fn(&super::Figures) -> f64| sorted(&spread, title, label, value);
    let below = vec![
        errors("trajectory", "RMS error, kPa", |figures| 1e-3 * figures.trajectory_pa[0]),
        errors("overshoot of steps", "kPa", |figures| 1e-3 * figures.overshoot_pa),
    ];
    sheet(&[vec![steps, trajectory], below], ROOM, CAPTION)
}

fn name(channel: usize) -> String {
    format!("{:.0} mL", VOLUMES_M3[channel] * 1e6)
}

fn over_time(trial: &Trial, title: &str, range: [f64; 2]) -> Chart {
    let knots_pa = knots_pa();
    let moments = || {
        let inside = trial.recording.moments.iter().filter(move |it| (range[0]..range[1]).contains(&it.time_s));
        inside.step_by(EVERY)
    };
    let mut series: Vec<_> = (0..VOLUMES_M3.len())
        .map(|channel| Series {
            label: name(channel),
            color: Color::nth(channel),
            stroke: Stroke::Solid,
            points: moments().map(|moment| [moment.time_s, 1e-3 * moment.pressure_pa[channel]]).collect(),
        })
        .collect();
    let reference = moments().map(|moment| [moment.time_s, 1e-3 * reference_pa(&knots_pa, moment.time_s)]);
    let points = reference.collect();
    series.push(Series { label: "reference".into(), color: Color::Ink, stroke: Stroke::Dashed, points });
    chart(title, ["time, s", "pressure, kPa"], series)
}

/// Figures of the plants in ascending order: how many of them are below.
fn sorted(trials: &[&Trial], title: &str, label: &str, value: fn(&super::Figures) -> f64) -> Chart {
    let series = (0..VOLUMES_M3.len()).map(|channel| {
        let mut values: Vec<f64> =
            trials.iter().filter_map(|trial| Some(value(&trial.figures.as_ref()?[channel]))).collect();
        values.sort_by(f64::total_cmp);
        let points = (1..).zip(values).map(|(count, value)| [value, f64::from(count)]).collect();
        Series { label: name(channel), color: Color::nth(channel), stroke: Stroke::Solid, points }
    });
    chart(title, [label, "plants below"], series.collect())
}

fn chart(title: &str, labels: [&str; 2], series: Vec<Series>) -> Chart {
    let range = |axis: usize| span(series.iter().flat_map(|series| &series.points).map(|point| point[axis]));
    let axis = |index: usize| Axis { label: labels[index].into(), range: range(index), decades: false };
    let (x, y) = (axis(0), axis(1));
    Chart { title: title.into(), area: AREA, x, y, series, bands: Vec::new(), marks: Vec::new(), notes: Vec::new() }
}
