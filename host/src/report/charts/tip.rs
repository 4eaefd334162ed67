//! The way of the tip, seen from two sides, with the limb at the ends of the phases.

use super::super::figure::{Axis, Chart, Color, Note, Series, Stroke, span};
use super::super::summary::scheduled;
use crate::record::{RunLog, Sample, Shape};

/// Largest width and height of a view, px.
const MAX_AREA: [f64; 2] = [310.0, 420.0];
/// Smallest width and height of a view, px.
const MIN_AREA: [f64; 2] = [280.0, 160.0];
/// Notes closer than this are one, px.
const SAME_PLACE_PX: f64 = 12.0;
/// A shape this far from the end of a phase does not show it, s.
const NEAR_S: f64 = 0.5;

/// Side view (x, z) and front view (y, z), to one scale.
pub(in crate::report) fn tip_views(log: &RunLog) -> Vec<String> {
    let shapes = shapes_at_phase_ends(log);
    let mm = |axis: usize| all_points(log, &shapes).map(move |point| point[axis] * 1e3);
    let [x, y, z] = std::array::from_fn(|axis| span(mm(axis)));
    let layout = Layout::new(x, y, z);
    vec![
        view(log, &shapes, "Side view", [0, 2], [x, z], layout).svg(),
        view(log, &shapes, "Front view", [1, 2], [y, z], layout).svg(),
    ]
}

/// Size that both views have, so that they line up.
#[derive(Debug, Clone, Copy)]
struct Layout {
    area: [f64; 2],
    px_per_mm: f64,
}

impl Layout {
    /// The largest scale at which all three extents fit.
    fn new(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Self {
        let [x, y, z] = [x, y, z].map(|[low, high]| high - low);
        let px_per_mm = (MAX_AREA[0] / x.max(y)).min(MAX_AREA[1] / z);
        let fit = |axis: usize, mm: f64| (mm * px_per_mm).clamp(MIN_AREA[axis], MAX_AREA[axis]);
        Self { area: [fit(0, x.max(y)), fit(1, z)], px_per_mm }
    }

    /// The range around the middle of `range` that fills one side of the area.
    fn filled(&self, side: usize, [low, high]: [f64; 2]) -> [f64; 2] {
        let (middle, half) = (low / 2.0 + high / 2.0, self.area[side] / self.px_per_mm / 2.0);
        [middle - half, middle + half]
    }
}

fn view(
    log: &RunLog,
    shapes: &[(usize, &Shape)],
    title: &str,
    axes: [usize; 2],
    extents: [[f64; 2]; 2],
    layout: Layout,
) -> Chart {
    let axis = |side: usize| Axis {
        label: format!("{}, mm", ["x", "y", "z"][axes[side]]),
        range: layout.filled(side, extents[side]),
        decades: false,
    };
    let seen = |point: &[f64; 3]| axes.map(|axis| point[axis] * 1e3);
    let mut series = solid_series(log, seen);
    series.extend(shape_series(shapes, seen));
    series.push(path(log, "tip achieved", Color::Second, Stroke::Solid, |sample| {
        sample.tip_achieved_m.as_ref().map(seen)
    }));
    series.push(path(log, "tip setpoint", Color::Ink, Stroke::Dashed, |sample| Some(seen(&sample.tip_setpoint_m))));
    series.retain(|series| series.points.iter().flatten().any(|value| value.is_finite()));
    let ends = shapes.iter().filter_map(|(phase, shape)| Some((*phase, seen(shape.setpoint.last()?))));
    Chart {
        title: title.to_owned(),
        area: layout.area,
        x: axis(0),
        y: axis(1),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: notes(ends, SAME_PLACE_PX / layout.px_per_mm),
    }
}

/// Obstacles and regions; only the first of each is in the legend.
fn solid_series(log: &RunLog, seen: impl Fn(&[f64; 3]) -> [f64; 2]) -> Vec<Series> {
    let of_kind = |region: bool, label: &str, color: Color| -> Vec<Series> {
        let lines = log.info.solids.iter().filter(|solid| solid.region == region).flat_map(|solid| &solid.lines_m);
        let series = |(index, line): (usize, &Vec<[f64; 3]>)| Series {
            label: if index == 0 { label.to_owned() } else { String::new() },
            color,
            stroke: Stroke::Solid,
            points: line.iter().map(&seen).collect(),
        };
        lines.enumerate().map(series).collect()
    };
    [of_kind(false, "obstacle", Color::Third), of_kind(true, "region", Color::Fourth)].concat()
}

/// The limb as asked for and as it was; only the first of each is in the legend.
fn shape_series(shapes: &[(usize, &Shape)], seen: impl Fn(&[f64; 3]) -> [f64; 2]) -> Vec<Series> {
    let series = |label: &str, first: bool, color, stroke, points: &[[f64; 3]]| Series {
        label: if first { label.to_owned() } else { String::new() },
        color,
        stroke,
        points: points.iter().map(&seen).collect(),
    };
    let mut all = Vec::new();
    for (index, (_, shape)) in shapes.iter().enumerate() {
        let first = index == 0;
        if let Some(achieved) = &shape.achieved {
            all.push(series("limb at phase ends", first, Color::First, Stroke::Solid, achieved));
        }
        all.push(series("limb setpoint", first, Color::Faint, Stroke::Dashed, &shape.setpoint));
    }
    all
}

fn path(
    log: &RunLog,
    label: &str,
    color: Color,
    stroke: Stroke,
    point: impl Fn(&Sample) -> Option<[f64; 2]>,
) -> Series {
    let points = scheduled(log).into_iter().map(|sample| point(sample).unwrap_or([f64::NAN; 2])).collect();
    Series { label: label.to_owned(), color, stroke, points }
}

/// The shape nearest to the end of each phase, with the number of the phase from 1.
fn shapes_at_phase_ends(log: &RunLog) -> Vec<(usize, &Shape)> {
    let nearest = |end_s: f64| {
        let off = |shape: &&Shape| (shape.time_s - end_s).abs();
        log.shapes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|shape| off(shape) <= NEAR_S)
    };
    let phases = (1..).zip(&log.info.phases);
    phases.filter_map(|(number, phase)| Some((number, nearest(phase.end_s())?))).collect()
}

/// Phase numbers at the tips; those at one place are one note.
fn notes(ends: impl Iterator<Item = (usize, [f64; 2])>, near_mm: f64) -> Vec<Note> {
    let mut notes: Vec<Note> = Vec::new();
    for (number, at) in ends {
        let same = |note: &&mut Note| (note.at[0] - at[0]).hypot(note.at[1] - at[1]) < near_mm;
        match notes.iter_mut().find(same) {
            Some(note) => note.text.push_str(&format!(", {number}")),
            None => notes.push(Note { at, text: number.to_string() }),
        }
    }
    notes
}

fn all_points<'a>(log: &'a RunLog, shapes: &'a [(usize, &Shape)]) -> impl Iterator<Item = [f64; 3]> + 'a {
    let tips = scheduled(log).into_iter().flat_map(|sample| [Some(sample.tip_setpoint_m), sample.tip_achieved_m]);
    let limbs = shapes.iter().flat_map(|(_, shape)| shape.setpoint.iter().chain(shape.achieved.iter().flatten()));
    let solids = log.info.solids.iter().flat_map(|solid| solid.lines_m.iter().flatten());
    tips.flatten().chain(limbs.copied()).chain(solids.copied())
}
