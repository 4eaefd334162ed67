//! Side, front and top view: how deep the workspace is behind each place, and the limb at its extremes.

use super::grid::Grid;
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet};

/// Longest side of a view, px, and the width of a view with its axes.
const SIDE: f64 = 310.0;
const ROOM: f64 = 400.0;
/// Free space around what is drawn, as a share of its size.
const RIM: f64 = 0.06;
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
    let views = [
        ("from the side", 1, [0, 2], ["x, m", "z, m"]),
        ("from the front", 0, [1, 2], ["y, m", "z, m"]),
        ("from above", 2, [0, 1], ["x, m", "y, m"]),
    ];
    let deepest =
        views.iter().flat_map(|(_, along, ..)| grid.depths(*along)).map(|(_, depth)| depth).max().unwrap_or(1);
    let [side, front, top] = views.map(|(name, along, axes, labels)| {
        let seen = |line: &[[f64; 3]]| line.iter().map(|point| axes.map(|axis: usize| point[axis])).collect();
        // Extremes along the view would cover each other.
        let across = extreme.iter().filter(|one| one.axis != along);
        let extreme: Vec<SeenLine<'_>> = across.map(|one| (one.name, seen(&one.line_m))).collect();
        view(name, ((grid, free), along, deepest), (seen(rest_m), &extreme), labels)
    });
    let lines = if free.is_some() {
        "Grey: without load alone. Line: limb at rest."
    } else {
        "Lines: limb at rest and at extremes."
    };
    let caption = format!(
        "{title}. Shades: depth behind a place, in five steps up to {:.2} m. {lines}",
        deepest as f64 * grid.side_m()
    );
    sheet(&[vec![side, front], vec![top]], ROOM, &caption)
}

fn view(
    title: &str,
    ((grid, free), along, deepest): ((&Grid, Option<&Grid>), usize, usize),
    (rest, extreme): (Vec<[f64; 2]>, &[SeenLine<'_>]),
    labels: [&str; 2],
) -> Chart {
    let depths = grid.depths(along);
    let behind: Vec<[f64; 2]> =
        free.map_or_else(Vec::new, |free| free.depths(along).into_iter().map(|(place, _)| place).collect());
    let lines = || rest.iter().chain(extreme.iter().flat_map(|(_, line)| line));
    let ranges = [0, 1].map(|axis: usize| {
        let values = depths
            .iter()
            .map(|(place, _)| place)
            .chain(&behind)
            .map(|place| place[axis])
            .chain(lines().map(|point| point[axis]));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let rim = RIM * (high - low).max(0.1);
        [low - rim, high + rim]
    });
    let sizes = ranges.map(|[low, high]| high - low);
    let scale = SIDE / sizes[0].max(sizes[1]);
    let [x, y] =
        [0, 1].map(|axis: usize| Axis { label: labels[axis].into(), range: ranges[axis], ticks: Ticks::Round });
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
    // Shades are translucent: over grey they would be other shades.
    let is_covered = |[x, y]: &[f64; 2]| {
        let half = 0.5 * grid.side_m();
        depths.iter().any(|(place, _)| (place[0] - x).abs() <= half && (place[1] - y).abs() <= half)
    };
    let bare = behind.into_iter().filter(|place| !is_covered(place)).collect();
    all.insert(0, series("", Color::Faint, Stroke::Cells { side, shade: 2 }, bare));
    all.extend(extreme.iter().map(|(_, line)| series("", Color::Ink, Stroke::Solid, line.clone())));
    let notes =
        extreme.iter().filter_map(|(name, line)| Some(Note { at: *line.last()?, text: (*name).into() })).collect();
    all.push(series("", Color::Second, Stroke::Solid, rest));
    Chart {
        title: title.into(),
        area: sizes.map(|size| (size * scale).max(120.0)),
        x,
        y,
        series: all,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}
