//! Which figures a report has, and what is in them.

mod tip;

use super::rows::with_unit;
use super::stats::distance;
use super::summary::is_scheduled;
use crate::record::{ChannelSample, ModuleInfo, ModuleSample, RunLog, Sample};
use fra_model::StateQuantity;
use softlimb_chart::{Axis, Band, Chart, Color, Series, Stroke, Ticks, labelled, span};
use softlimb_numerics::statistics::root_mean_square;

pub(super) use tip::{phase_views, tip_views};

/// Area of a chart over time, px.
const WIDE: [f64; 2] = [690.0, 190.0];
/// Area of a flat chart over time, px.
const FLAT: [f64; 2] = [690.0, 130.0];

/// Pressures with their references, one chart per module.
pub(super) fn pressures(log: &RunLog) -> Vec<String> {
    let chart = |module: &ModuleInfo| {
        let title = format!("{}: pressures", module.name);
        over_time(log, title, "gauge pressure, kPa", WIDE, pressure_series(log, module)).svg()
    };
    log.info.modules.iter().map(chart).collect()
}

/// Deformation of each module: asked for, modelled, achieved.
pub(super) fn deformations(log: &RunLog) -> Vec<String> {
    let chart = |(index, module): (usize, &ModuleInfo)| {
        let quantity = module.quantity;
        let title = format!("{}: {}", module.name, module.motion);
        let label = with_unit(quantity.label(), quantity.display_unit());
        over_time(log, title, &label, WIDE, deformation_series(log, index, quantity)).svg()
    };
    log.info.modules.iter().enumerate().map(chart).collect()
}

/// Errors of tip and pressures over time, with the faults marked.
pub(super) fn errors(log: &RunLog) -> Vec<String> {
    let marks: Vec<f64> = log.faults.iter().map(|fault| fault.time_s).collect();
    let tip = over_time(log, "Tip error".into(), "distance, mm", WIDE, tip_error_series(log));
    let pressure = over_time(log, "Pressure error, all channels".into(), "RMS, kPa", FLAT, pressure_error_series(log));
    [tip, pressure].into_iter().map(|chart| from_zero(Chart { marks: marks.clone(), ..chart }).svg()).collect()
}

/// Supply pressure over time.
pub(super) fn supply(log: &RunLog) -> String {
    let series = vec![line("", Color::Ink, Stroke::Solid, log, |sample| sample.supply_pa * 1e-3)];
    let marks = log.faults.iter().map(|fault| fault.time_s).collect();
    let chart = over_time(log, "Supply".into(), "gauge pressure, kPa", FLAT, series);
    from_zero(Chart { marks, ..chart }).svg()
}

/// Measured lines nested into each other, below the references. Equal references are one line.
fn pressure_series(log: &RunLog, module: &ModuleInfo) -> Vec<Series> {
    let channels: Vec<usize> = module.channels.clone().collect();
    let pressure = |channel: usize, value: fn(&ChannelSample) -> f64| {
        move |sample: &Sample| sample.channels.get(channel).map_or(f64::NAN, value) * 1e-3
    };
    let measured = channels.iter().enumerate().map(|(index, &channel)| {
        let stroke = Stroke::Nested((channels.len() - 1 - index) as u8, channels.len() as u8);
        let value = pressure(channel, |channel| channel.pressure_pa);
        line(&format!("channel {channel}"), Color::nth(index), stroke, log, value)
    });
    let reference = |channel: usize| pressure(channel, |channel| channel.reference_pa);
    let is_as_first = |channel: &usize| {
        log.samples.iter().all(|sample| reference(*channel)(sample).total_cmp(&reference(channels[0])(sample)).is_eq())
    };
    let references = match &channels[..] {
        [first, ..] if channels.iter().all(is_as_first) => {
            vec![line("reference", Color::Ink, Stroke::Dashed, log, reference(*first))]
        }
        _ => {
            let of_channel = |(index, &channel): (usize, &usize)| {
                line(&format!("reference {channel}"), Color::nth(index), Stroke::Dashed, log, reference(channel))
            };
            channels.iter().enumerate().map(of_channel).collect()
        }
    };
    measured.chain(references).collect()
}

fn deformation_series(log: &RunLog, index: usize, quantity: StateQuantity) -> Vec<Series> {
    let scale = quantity.display_scale();
    let module = |value: fn(&ModuleSample) -> f64| {
        move |sample: &Sample| sample.modules.get(index).map_or(f64::NAN, value) * scale
    };
    let achieved = module(|module| module.achieved.unwrap_or(f64::NAN));
    let in_chamber = |sample: &Sample| sample.channels.iter().any(|channel| channel.true_pressure_pa.is_some());
    let place = if log.samples.iter().any(in_chamber) { "chamber" } else { "measured" };
    let modelled = format!("modelled at the {place} pressure");
    present([
        line("achieved", Color::Second, Stroke::Solid, log, achieved),
        line(&modelled, Color::First, Stroke::Dotted, log, module(|module| module.modelled)),
        line("setpoint", Color::Ink, Stroke::Dashed, log, while_scheduled(log, module(|module| module.setpoint))),
    ])
}

fn tip_error_series(log: &RunLog) -> Vec<Series> {
    let achieved =
        |sample: &Sample| sample.tip_achieved_m.map_or(f64::NAN, |tip| distance(tip, sample.tip_setpoint_m) * 1e3);
    let tracking = |sample: &Sample| match log.info.is_corrected() {
        false => distance(sample.tip_modelled_m, sample.tip_setpoint_m) * 1e3,
        true => f64::NAN,
    };
    present([
        line("by pressure tracking alone", Color::First, Stroke::Dotted, log, while_scheduled(log, tracking)),
        line("achieved", Color::Second, Stroke::Solid, log, while_scheduled(log, achieved)),
    ])
}

/// The value where there is a setpoint to compare with.
fn while_scheduled(log: &RunLog, value: impl Fn(&Sample) -> f64) -> impl Fn(&Sample) -> f64 {
    move |sample| if is_scheduled(&log.info, sample.time_s) { value(sample) } else { f64::NAN }
}

fn pressure_error_series(log: &RunLog) -> Vec<Series> {
    let rms = |error: fn(&ChannelSample) -> f64| {
        move |sample: &Sample| root_mean_square(sample.channels.iter().map(error)).unwrap_or(f64::NAN) * 1e-3
    };
    let chamber = |channel: &ChannelSample| channel.true_pressure_pa.unwrap_or(f64::NAN) - channel.reference_pa;
    let sensor = |channel: &ChannelSample| channel.pressure_pa - channel.reference_pa;
    present([
        line("sensor - reference", Color::First, Stroke::Dotted, log, rms(sensor)),
        line("chamber - reference", Color::Second, Stroke::Solid, log, rms(chamber)),
    ])
}

/// Series that have something to show; what was never observed gets no legend.
fn present<const N: usize>(series: [Series; N]) -> Vec<Series> {
    let shows = |series: &Series| series.points.iter().any(|point| point[1].is_finite());
    series.into_iter().filter(shows).collect()
}

fn line(label: &str, color: Color, stroke: Stroke, log: &RunLog, value: impl Fn(&Sample) -> f64) -> Series {
    let points = log.samples.iter().map(|sample| [sample.time_s, value(sample)]).collect();
    Series { label: label.to_owned(), color, stroke, points }
}

fn over_time(log: &RunLog, title: String, label: &str, area: [f64; 2], series: Vec<Series>) -> Chart {
    let times = log.samples.iter().map(|sample| sample.time_s);
    let range = times.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], time| [low.min(time), high.max(time)]);
    let values = series.iter().flat_map(|series| series.points.iter().map(|point| point[1]));
    Chart {
        title: labelled(&title, log.info.weightless),
        area,
        x: Axis { label: "time, s".into(), range, ticks: Ticks::Round },
        y: Axis { label: label.to_owned(), range: span(values), ticks: Ticks::Round },
        series,
        bands: bands(log),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}

/// Starts the vertical axis at zero, for quantities whose size matters; negative
/// values keep their room.
fn from_zero(mut chart: Chart) -> Chart {
    let values = || chart.series.iter().flat_map(|series| &series.points).map(|point| point[1]);
    if !values().any(|value| value < 0.0) {
        chart.y.range = [0.0, span(values().chain([0.0]))[1]];
    }
    chart
}

/// One band per phase, every second one shaded.
fn bands(log: &RunLog) -> Vec<Band> {
    let phases = log.info.phases.iter().enumerate();
    phases
        .map(|(index, phase)| Band {
            range: [phase.start_s, phase.end_s()],
            label: phase.name.clone(),
            shaded: index % 2 == 0,
        })
        .collect()
}
