//! Side, front and top view: how deep the workspace is behind each place, and the limb at its extremes.

use super::grid::Grid;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet};

/// Longest side of a view, px, and the width of a view with its axes.
const SIDE: f64 = 322.0;
const ROOM: f64 = 400.0;
/// Free space around what is drawn, as a share of its size.
const RIM: f64 = 0.03;
/// Least side of a view, px.
const LEAST: f64 = 120.0;
/// Size of the empty chart that holds the key, px.
const KEY: [f64; 2] = [240.0, 1.0];
/// Shades of the depth.
const SHADES: usize = 5;

/// The limb at an extreme.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtremeLine<'a> {
    /// Name of the extreme.
    pub name: &'a str,
    /// The coordinate that is extreme, 0 to 2.
    pub axis: usize,
    /// Its centre line, m.
    pub line_m: Vec<[f64; 3]>,
}

/// A view: its name, the axis that it looks along, and its axes.
type View = (&'static str, usize, [usize; 2]);

/// The views.
const VIEWS: [View; 3] = [("from the side", 1, [0, 2]), ("from the front", 0, [1, 2]), ("from above", 2, [0, 1])];

/// A line in a view, with its name.
type SeenLine<'a> = (&'a str, Vec<[f64; 2]>);

/// The workspace seen along each axis of the scene, as a document that stands by itself. `free` is that without load, behind it, `rest_m` the
/// limb's centre line at rest, `extreme` are those that reach farthest.
pub fn picture(
    title: &str,
    (grid, free): (&Grid, Option<&Grid>),
    rest_m: &[[f64; 3]],
    extreme: &[ExtremeLine<'_>],
) -> String {
    let deepest = VIEWS.iter().flat_map(|(_, along, _)| grid.depths(*along)).map(|(_, depth)| depth).max().unwrap_or(1);
    let lines_m = extreme.iter().flat_map(|one| &one.line_m).chain(rest_m);
    let ranges_m = ranges_m(&[Some(grid), free], lines_m);
    let [side, front, top] = VIEWS.map(|(name, along, axes)| {
        let seen = |line: &[[f64; 3]]| line.iter().map(|point| axes.map(|axis: usize| point[axis])).collect();
        // Extremes along the view would cover each other.
        let across = extreme.iter().filter(|one| one.axis != along);
        let extreme: Vec<SeenLine<'_>> = across.map(|one| (one.name, seen(&one.line_m))).collect();
        view((name, along, axes), ((grid, free), deepest), (seen(rest_m), &extreme), &ranges_m)
    });
    let caption = format!(
        "{title}: the positions that the tip can reach, from three sides to one scale. Shade: the depth of the reachable space behind a point."
    );
    let key = key(deepest as f64 * grid.side_m(), free.is_some(), !extreme.is_empty());
    sheet(&[vec![side, front], vec![top, key]], ROOM, &caption)
}

/// Ranges of the coordinates in all views, m, with free space around: the shorter ones wide enough for an axis.
fn ranges_m<'a>(grids: &[Option<&Grid>], lines_m: impl Iterator<Item = &'a [f64; 3]>) -> [[f64; 2]; 3] {
    let mut ranges_m = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    let mut hold = |axis: usize, value_m: f64| {
        let [low, high] = ranges_m[axis];
        ranges_m[axis] = [low.min(value_m), high.max(value_m)];
    };
    lines_m.for_each(|point| (0..3).for_each(|axis| hold(axis, point[axis])));
    for (_, along, axes) in VIEWS {
        for grid in grids.iter().flatten() {
            let half_m = 0.5 * grid.side_m();
            for (place, _) in grid.depths(along) {
                let ends =
                    axes.into_iter().zip(place).flat_map(|(axis, at)| [(axis, at - half_m), (axis, at + half_m)]);
                ends.for_each(|(axis, value_m)| hold(axis, value_m));
            }
        }
    }
    let rimmed = ranges_m.map(|[low, high]| {
        let rim = RIM * (high - low).max(0.1);
        [low - rim, high + rim]
    });
    let least_m = LEAST / scale(&rimmed);
    rimmed.map(|[low, high]| {
        let missing = 0.5 * (least_m - (high - low)).max(0.0);
        [low - missing, high + missing]
    })
}

/// Scale of all views, px/m.
fn scale(ranges_m: &[[f64; 2]; 3]) -> f64 {
    SIDE / ranges_m.iter().map(|[low, high]| high - low).fold(0.0, f64::max)
}

/// A chart of names alone.
fn key(deepest_m: f64, has_free: bool, has_extremes: bool) -> Chart {
    let entry = |label: String, color, stroke| Series { label, color, stroke, points: Vec::new() };
    let step_m = deepest_m / SHADES as f64;
    let mut series: Vec<Series> = (1..=SHADES)
        .map(|shade| {
            let label = format!("{:.2} to {:.2} m", step_m * (shade - 1) as f64, step_m * shade as f64);
            entry(label, Color::First, Stroke::Cells { side: 1.0, shade: shade as u8 })
        })
        .collect();
    if has_free {
        series.push(entry("reachable without load only".into(), Color::Faint, Stroke::Hatched { side: 1.0 }));
    }
    series.push(entry("limb at rest, unloaded".into(), Color::Second, Stroke::Solid));
    if has_extremes {
        series.push(entry("limb at an extreme".into(), Color::Ink, Stroke::Solid));
    }
    let axis = || Axis { label: String::new(), range: [0.0, 1.0], ticks: Ticks::Names(Vec::new()) };
    Chart {
        title: "depth behind a point".into(),
        area: KEY,
        x: axis(),
        y: axis(),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}

fn view(
    (title, along, axes): View,
    ((grid, free), deepest): ((&Grid, Option<&Grid>), usize),
    (rest, extreme): (Vec<[f64; 2]>, &[SeenLine<'_>]),
    ranges_m: &[[f64; 2]; 3],
) -> Chart {
    let depths = grid.depths(along);
    let behind: Vec<[f64; 2]> =
        free.map_or_else(Vec::new, |free| free.depths(along).into_iter().map(|(place, _)| place).collect());
    let [x, y] = axes.map(|axis| Axis {
        label: format!("{}, m", ["x", "y", "z"][axis]),
        range: ranges_m[axis],
        ticks: Ticks::Round,
    });
    let area = axes.map(|axis| (ranges_m[axis][1] - ranges_m[axis][0]) * scale(ranges_m));
    let series = |label: &str, color, stroke, points| Series { label: label.into(), color, stroke, points };
    let mut all: Vec<Series> = (1..=SHADES)
        .map(|shade| {
            let is_its = |depth: &usize| (*depth * SHADES).div_ceil(deepest).clamp(1, SHADES) == shade;
            let places = depths.iter().filter(|(_, depth)| is_its(depth)).map(|(place, _)| *place).collect();
            let stroke = Stroke::Cells { side: grid.side_m(), shade: shade as u8 };
            series("", Color::First, stroke, places)
        })
        .collect();
    let side = free.map_or(grid.side_m(), Grid::side_m);
    // Shades are translucent: over a hatching they would be other shades.
    let is_covered = |[x, y]: &[f64; 2]| {
        let half = 0.5 * grid.side_m();
        depths.iter().any(|(place, _)| (place[0] - x).abs() <= half && (place[1] - y).abs() <= half)
    };
    let bare = behind.into_iter().filter(|place| !is_covered(place)).collect();
    all.insert(0, series("", Color::Faint, Stroke::Hatched { side }, bare));
    all.extend(extreme.iter().map(|(_, line)| series("", Color::Ink, Stroke::Solid, line.clone())));
    let notes = extreme
        .iter()
        .filter_map(|(name, line)| Some(Note { at: *line.last()?, text: (*name).into(), meaning: String::new() }))
        .collect();
    all.push(series("", Color::Second, Stroke::Solid, rest));
    Chart { title: title.into(), area, x, y, series: all, bands: Vec::new(), marks: Vec::new(), notes }
}
