//! A cylinder with grooves, meshed along its threads.
//!
//! On the unrolled cylinder of the winding radius `R`, with `x = R theta`, a right-handed thread at the angle `a` from the hoop lies
//! on a line of constant `xi = x sin a - z cos a`, a left-handed one on a line of constant `eta = x sin a + z cos a`, and once around adds
//! `2 pi R sin a`, a whole number of distances between threads, to both. So the edges of all grooves are lines of two rulings with one
//! common period, and the lines of both rulings meet in the corners of the mesh. Threads along the axis are lines of constant `x`.

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::super::path::step_rad;
use super::super::piece::{Groove, Piece};
use super::super::winding::Hand;
use super::clip::{Axis, Cut, Patch, Spot};

/// Corners nearer to a cut than this share of a cell are moved onto it.
const SNAP: f64 = 2e-3;

/// What the surface carries.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    groove: Option<Groove>,
    hands: Vec<Hand>,
    angle_rad: f64,
    starts: u32,
    /// Radius on which the angle is that of the threads, m; of no meaning without a groove.
    winding_m: f64,
}

impl Profile {
    pub(super) fn of(piece: &Piece) -> Self {
        let winding = &piece.winding;
        Self {
            groove: Some(piece.groove),
            hands: winding.hands.clone(),
            angle_rad: winding.angle_rad,
            starts: winding.starts,
            winding_m: winding.radius_m,
        }
    }

    /// A plain cylinder.
    pub(super) fn plain() -> Self {
        Self {
            groove: None,
            hands: vec![Hand::Straight],
            angle_rad: std::f64::consts::FRAC_PI_2,
            starts: 1,
            winding_m: 1.0,
        }
    }
}

/// One line of a ruling within its period.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Its coordinate, m.
    place: f64,
    /// Share of the groove's depth that it lies below the surface.
    depth: f64,
}

/// The rulings of a grooved cylinder.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    surface_m: f64,
    depth_m: f64,
    winding_m: f64,
    sin: f64,
    cos: f64,
    right: bool,
    left: bool,
    straight: bool,
    /// Distance of threads, m, after which the lines repeat.
    period: f64,
    lines: Vec<Line>,
    /// Longest part between lines, m.
    part: f64,
}

impl Lattice {
    /// The cylinder of a radius whose grooves go inwards; chords are within `chord_m`.
    pub(super) fn new(profile: &Profile, surface_m: f64, chord_m: f64) -> Self {
        let (sin, cos) = profile.angle_rad.sin_cos();
        let has = |hand| profile.hands.contains(&hand);
        let straight = has(Hand::Straight);
        let period = TAU * profile.winding_m * sin / f64::from(profile.starts);
        // A cell of two parts is as wide as one of them over the sine; along the axis a part is a part.
        let step = profile.winding_m * sin * step_rad(surface_m, chord_m).min(0.5);
        let part = if straight { step } else { 2.0 * step };
        let lines = match &profile.groove {
            Some(groove) => lines(groove, period, [part, step]),
            None => subdivided([-0.5 * period, 0.5 * period], [0.0, 0.0], part),
        };
        let depth_m = profile.groove.map_or(0.0, |groove| groove.depth_m);
        let (right, left) = (has(Hand::Right) || straight, has(Hand::Left));
        Self { surface_m, depth_m, winding_m: profile.winding_m, sin, cos, right, left, straight, period, lines, part }
    }

    /// Radius of the surface outside the grooves, m.
    pub(super) fn surface_m(&self) -> f64 {
        self.surface_m
    }

    /// About how many triangles a patch will have.
    pub(super) fn triangles(&self, sweep_rad: f64, length_m: f64) -> f64 {
        let lines = self.lines.len() as f64 / self.period;
        let around = sweep_rad * self.winding_m;
        if self.straight {
            return 2.0 * around * lines;
        }
        // Two triangles a cell, whose corners are as dense as the lines of both rulings cross.
        2.0 * around * length_m * lines * lines * 2.0 * self.sin * self.cos
    }

    /// The surface between two angles over a length.
    pub(super) fn patch(&self, [from, to]: [f64; 2], length_m: f64) -> Patch {
        let patch =
            if self.straight { self.straight_cells([from, to], length_m) } else { self.cells([from, to], length_m) };
        let wide = if self.straight { self.part } else { 0.5 * self.part } / (self.winding_m * self.sin);
        let mut patch = patch;
        for (at, side) in [(from, 1.0), (to, -1.0)] {
            patch = patch.cut(&Cut { axis: Axis::Angle, at, side, snap: SNAP * wide });
        }
        if !self.straight {
            let high = 0.5 * self.part / self.cos;
            for (at, side) in [(0.0, 1.0), (length_m, -1.0)] {
                patch = patch.cut(&Cut { axis: Axis::Height, at, side, snap: SNAP * high.min(length_m) });
            }
        }
        patch.compact()
    }

    /// A line by its number, over all periods.
    fn line(&self, number: i64) -> Line {
        let count = self.lines.len() as i64;
        let line = self.lines[number.rem_euclid(count) as usize];
        Line { place: line.place + self.period * number.div_euclid(count) as f64, ..line }
    }

    /// The last line at or below a coordinate.
    fn below(&self, place: f64) -> i64 {
        let periods = ((place - self.lines[0].place) / self.period).floor();
        let within = place - periods * self.period;
        let lines = self.lines.partition_point(|line| line.place <= within).max(1) as i64;
        periods as i64 * self.lines.len() as i64 + lines - 1
    }

    /// All cells that touch the range of angles and the length.
    fn cells(&self, [from, to]: [f64; 2], length_m: f64) -> Patch {
        let around = [from, to].map(|angle| 2.0 * angle * self.winding_m * self.sin);
        let up = 2.0 * length_m * self.cos;
        let mut corners = Corners { lattice: self, numbers: HashMap::new(), patch: Patch::default() };
        // xi + eta lies within `around`, eta - xi between 0 and `up`.
        let first = self.below(0.5 * (around[0] - up)) - 1;
        let last = self.below(0.5 * around[1]) + 1;
        for a in first..=last {
            let [low, high] = [self.line(a).place, self.line(a + 1).place];
            let from = f64::max(around[0] - high, low);
            let to = f64::min(around[1] - low, high + up);
            for b in self.below(from) - 1..=self.below(to) {
                corners.cell(a, b);
            }
        }
        corners.patch
    }

    /// Strips along the axis.
    fn straight_cells(&self, [from, to]: [f64; 2], length_m: f64) -> Patch {
        let [first, last] = [from, to].map(|angle| self.below(angle * self.winding_m));
        let mut patch = Patch::default();
        for (column, number) in (first..=last + 1).enumerate() {
            let line = self.line(number);
            let radius_m = self.surface_m - self.depth_m * line.depth;
            let angle = line.place / self.winding_m;
            patch.spots.extend([0.0, length_m].map(|height| Spot { place: [angle, height], radius_m }));
            let [a, c] = [2 * column as u32, 2 * column as u32 + 2];
            if number <= last {
                patch.triangles.extend([[a, c, c + 1], [a, c + 1, a + 1]]);
            }
        }
        patch
    }

    fn spot(&self, [a, b]: [i64; 2]) -> Spot {
        let [xi, eta] = [a, b].map(|number| self.line(number));
        let angle = (xi.place + eta.place) / (2.0 * self.winding_m * self.sin);
        let height = (eta.place - xi.place) / (2.0 * self.cos);
        let depth = f64::max(if self.right { xi.depth } else { 0.0 }, if self.left { eta.depth } else { 0.0 });
        Spot { place: [angle, height], radius_m: self.surface_m - self.depth_m * depth }
    }
}

/// The corners made so far, by the lines that meet in them.
struct Corners<'a> {
    lattice: &'a Lattice,
    numbers: HashMap<[i64; 2], u32>,
    patch: Patch,
}

impl Corners<'_> {
    fn cell(&mut self, a: i64, b: i64) {
        let [left, bottom, right, top] = [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]].map(|at| self.number(at));
        // Where two flanks meet, the edge between them is a diagonal of the cells.
        let slope = |number: i64| self.lattice.line(number + 1).depth - self.lattice.line(number).depth;
        let crease = self.lattice.right && self.lattice.left && slope(a) * slope(b) > 0.0;
        let triangles = if crease {
            [[left, bottom, right], [left, right, top]]
        } else {
            [[left, bottom, top], [bottom, right, top]]
        };
        self.patch.triangles.extend(triangles);
    }

    fn number(&mut self, at: [i64; 2]) -> u32 {
        *self.numbers.entry(at).or_insert_with(|| {
            self.patch.spots.push(self.lattice.spot(at));
            self.patch.spots.len() as u32 - 1
        })
    }
}

/// The lines of one period: groove, then land. Flanks are divided more finely, because their cells may be cut along the longer diagonal.
fn lines(groove: &Groove, period: f64, [part, flank]: [f64; 2]) -> Vec<Line> {
    let [top, floor] = [0.5 * groove.top_m, 0.5 * groove.floor_m];
    let pieces = [
        ([-top, -floor], [0.0, 1.0], flank),
        ([-floor, floor], [1.0, 1.0], part),
        ([floor, top], [1.0, 0.0], flank),
        ([top, period - top], [0.0, 0.0], part),
    ];
    pieces.into_iter().flat_map(|(ends, depths, most)| subdivided(ends, depths, most)).collect()
}

/// Lines from one place up to another, which is left to the next piece, no further apart than `most`.
fn subdivided([from, to]: [f64; 2], [first, last]: [f64; 2], most: f64) -> Vec<Line> {
    let count = ((to - from) / most).ceil().max(1.0) as u32;
    let line = |number: u32| {
        let share = f64::from(number) / f64::from(count);
        Line { place: from + (to - from) * share, depth: first + (last - first) * share }
    };
    (0..count).map(line).collect()
}
