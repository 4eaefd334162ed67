//! The way of the tip, seen from two sides, with the limb at the ends of the phases; and each phase by itself among obstacles.

use super::super::summary::scheduled;
use crate::record::{PhaseInfo, RunLog, Sample, Shape, SolidInfo};
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, labelled, span};

/// Largest width and height of a view, px.
const MAX_AREA: [f64; 2] = [284.0, 420.0];
/// Smallest width and height of a view, px.
const MIN_AREA: [f64; 2] = [280.0, 160.0];
/// Notes closer than this are one, px.
const SAME_PLACE_PX: f64 = 12.0;
/// A shape this far from a time does not show it, s.
const NEAR_S: f64 = 0.5;

/// Side view (x, z) and front view (y, z), to one scale.
pub(crate) fn tip_views(log: &RunLog) -> Vec<String> {
    let shapes = shapes_at_phase_ends(log);
    let mm = |axis: usize| all_points(log, &shapes).map(move |point| point[axis] * 1e3);
    let [x, y, z] = std::array::from_fn(|axis| span(mm(axis)));
    let layout = Layout::new(x, y, z);
    let title = |side: &str| labelled(side, log.info.weightless);
    vec![
        view(log, &shapes, &title("Side view"), [0, 2], [x, z], layout).svg(),
        view(log, &shapes, &title("Front view"), [1, 2], [y, z], layout).svg(),
    ]
}

/// One phase among obstacles and regions, seen from the side and from the front: where the limb was when it began and when its move
/// ended, and where the plan comes nearest to an obstacle. Empty for a scene without obstacles and regions.
pub(crate) fn phase_views(log: &RunLog) -> Vec<[String; 2]> {
    if log.info.solids.is_empty() {
        return Vec::new();
    }
    let all: Vec<(usize, &Shape)> = log.shapes.iter().map(|shape| (0, shape)).collect();
    let mm = |axis: usize| all_points(log, &all).map(move |point| point[axis] * 1e3);
    let [x, y, z] = std::array::from_fn(|axis| span(mm(axis)));
    let layout = Layout::new(x, y, z);
    let views = |phase: &PhaseInfo| {
        [("side", [0, 2], [x, z]), ("front", [1, 2], [y, z])].map(|(side, axes, extents)| {
            let title = format!("{}, from the {side}", phase.name);
            phase_view(log, phase, &labelled(&title, log.info.weightless), axes, extents, layout).svg()
        })
    };
    log.info.phases.iter().map(views).collect()
}

fn phase_view(
    log: &RunLog,
    phase: &PhaseInfo,
    title: &str,
    axes: [usize; 2],
    extents: [[f64; 2]; 2],
    layout: Layout,
) -> Chart {
    let seen = |point: &[f64; 3]| axes.map(|axis| point[axis] * 1e3);
    let limb = |label: &str, time_s: f64, color, stroke, planned: bool| {
        let shape = nearest_shape(log, time_s)?;
        let line = if planned { &shape.setpoint } else { shape.achieved.as_ref().unwrap_or(&shape.setpoint) };
        Some(Series { label: label.to_owned(), color, stroke, points: line.iter().map(seen).collect() })
    };
    let mut series = solid_series(log, seen);
    series.extend(limb("at the start", phase.start_s, Color::Faint, Stroke::Dashed, false));
    let nearest = phase.nearest.as_ref();
    series.extend(nearest.and_then(|near| limb("planned, nearest", near.time_s, Color::Second, Stroke::Dotted, true)));
    series.extend(limb("at the end", phase.end_s(), Color::First, Stroke::Solid, false));
    layout.chart(title, axes, extents, series, solid_names(log, seen))
}

/// The name of each obstacle and region at its corner on the upper right.
fn solid_names(log: &RunLog, seen: impl Fn(&[f64; 3]) -> [f64; 2]) -> Vec<Note> {
    let note = |solid: &SolidInfo| {
        let points = solid.lines_m.iter().flatten().map(&seen);
        let points = points.filter(|point| point.iter().all(|value| value.is_finite()));
        let at = points.max_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])))?;
        Some(Note { at, text: solid.name.clone(), meaning: String::new() })
    };
    log.info.solids.iter().filter_map(note).collect()
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

    /// A view along the axis that is not among `axes`, of lines in mm.
    fn chart(
        &self,
        title: &str,
        axes: [usize; 2],
        extents: [[f64; 2]; 2],
        mut series: Vec<Series>,
        notes: Vec<Note>,
    ) -> Chart {
        let axis = |side: usize| Axis {
            label: format!("{}, mm", ["x", "y", "z"][axes[side]]),
            range: self.filled(side, extents[side]),
            ticks: Ticks::Round,
        };
        series.retain(|series| series.points.iter().flatten().any(|value| value.is_finite()));
        let [x, y] = [axis(0), axis(1)];
        Chart { title: title.to_owned(), area: self.area, x, y, series, bands: Vec::new(), marks: Vec::new(), notes }
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
    let seen = |point: &[f64; 3]| axes.map(|axis| point[axis] * 1e3);
    let mut series = solid_series(log, seen);
    series.extend(shape_series(shapes, seen));
    series.push(path(log, "tip achieved", Color::Second, Stroke::Solid, |sample| {
        sample.tip_achieved_m.as_ref().map(seen)
    }));
    series.push(path(log, "tip setpoint", Color::Ink, Stroke::Dashed, |sample| Some(seen(&sample.tip_setpoint_m))));
    let ends = shapes.iter().filter_map(|(phase, shape)| Some((*phase, seen(shape.setpoint.last()?))));
    let points = ends.clone().map(|(_, end)| end).collect();
    series.push(Series { label: String::new(), color: Color::Ink, stroke: Stroke::Dots, points });
    layout.chart(title, axes, extents, series, notes(ends, SAME_PLACE_PX / layout.px_per_mm))
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
    let phases = (1..).zip(&log.info.phases);
    phases.filter_map(|(number, phase)| Some((number, nearest_shape(log, phase.end_s())?))).collect()
}

/// The shape nearest to a time; `None` where none is near enough to show it.
fn nearest_shape(log: &RunLog, time_s: f64) -> Option<&Shape> {
    let off = |shape: &&Shape| (shape.time_s - time_s).abs();
    log.shapes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).filter(|shape| off(shape) <= NEAR_S)
}

/// Phase numbers at the tips; those at one place are one note.
fn notes(ends: impl Iterator<Item = (usize, [f64; 2])>, near_mm: f64) -> Vec<Note> {
    let mut notes: Vec<Note> = Vec::new();
    for (number, at) in ends {
        let same = |note: &&mut Note| (note.at[0] - at[0]).hypot(note.at[1] - at[1]) < near_mm;
        match notes.iter_mut().find(same) {
            Some(note) => note.text.push_str(&format!(", {number}")),
            None => notes.push(Note { at, text: number.to_string(), meaning: String::new() }),
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
