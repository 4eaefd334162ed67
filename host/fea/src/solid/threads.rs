//! Discrete threads: helices cut at every mesh line, each piece a truss, each cut a node that follows the wall.
//!
//! A thread that followed the wall at the corners of quadratic elements alone would let it bulge in between, so it is cut at the lines of
//! midside nodes too.

use std::f64::consts::{PI, TAU};

use super::mesh::grid::Grid;

/// A winding of whole threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Winding {
    /// Threads of one family that start side by side; of rings, their number along the actuator.
    pub(crate) count: u32,
    /// Distance between neighbours of one family, across them, mm.
    pub(crate) spacing_mm: f64,
    /// Angle from the hoop direction, rad.
    angle: f64,
    /// Radius, mm.
    radius: f64,
    /// Length of the actuator, mm.
    length: f64,
    mirrored: bool,
}

/// Below this angle from the hoop, rad, threads are rings.
const RING: f64 = 1e-4;

impl Winding {
    /// The winding of an angle, rad, on a radius and length, mm, whose spacing is nearest to the one wanted, mm; of rings there is an even
    /// number. With `mirrored` there is a second family at the opposite angle.
    pub(crate) fn nearest(angle: f64, radius: f64, length: f64, wanted: f64, mirrored: bool) -> Self {
        let rings = angle.abs() < RING;
        // Threads side by side share the circumference, rings the length.
        let room = if rings { length } else { TAU * radius * angle.abs().sin() };
        // Rings are as many on either side of the middle, so that none lies in it, where half of the length is modelled.
        let count = if rings { 2.0 * (0.5 * room / wanted).round().max(1.0) } else { (room / wanted).round().max(1.0) };
        Self { count: count as u32, spacing_mm: room / count, angle, radius, length, mirrored }
    }

    /// Whether the threads are closed rings.
    pub(crate) fn has_rings(&self) -> bool {
        self.angle.abs() < RING
    }

    /// Distance along the axis between neighbours of one family, mm; infinite for threads along the axis.
    pub(crate) fn axial_spacing_mm(&self) -> f64 {
        if self.angle.cos() < RING { f64::INFINITY } else { self.spacing_mm / self.angle.cos() }
    }

    /// The straight lines of all threads on the unrolled domain of a grid: from `[angle, height]` to the same.
    pub(crate) fn lines(&self, grid: &Grid) -> Vec<[[f64; 2]; 2]> {
        let (low, high) = (grid.heights[grid.wall.start], grid.heights[grid.wall.end]);
        if self.has_rings() {
            let heights = (0..self.count).map(|n| -0.5 * self.length + self.spacing_mm * (f64::from(n) + 0.5));
            let within = heights.filter(|z| *z > low && *z < high);
            return within.map(|z| [[0.0, z], [grid.sweep, z]]).collect();
        }
        let mut lines = Vec::new();
        for family in 0..=u32::from(self.mirrored) {
            // Angle gained by height.
            let slope = if self.angle.cos() < RING { 0.0 } else { self.angle.cos() / (self.radius * self.angle.sin()) };
            let slope = if family == 0 { slope } else { -slope };
            for start in 0..self.count {
                // Threads along the axis keep off the planes of symmetry.
                let share = f64::from(start) + if slope == 0.0 { 0.5 } else { 0.0 };
                lines.extend(unrolled(TAU * share / f64::from(self.count), slope, grid.sweep, [low, high]));
            }
        }
        lines
    }
}

/// The pieces of the line `angle = first + slope height` within `0..=sweep`, modulo the whole circle.
fn unrolled(first: f64, slope: f64, sweep: f64, [low, high]: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    if slope == 0.0 {
        return if first <= sweep { vec![[[first, low], [first, high]]] } else { Vec::new() };
    }
    let ends = [first + slope * low, first + slope * high];
    let turns = |angle: f64| (angle / TAU).floor() as i64;
    let (from, to) = (turns(ends[0].min(ends[1])), turns(ends[0].max(ends[1])));
    let mut pieces = Vec::new();
    for turn in from..=to {
        let base = first - TAU * turn as f64;
        let height = |angle: f64| (angle - base) / slope;
        let (a, b) = (height(0.0), height(sweep));
        let (begin, end) = (a.min(b).max(low), a.max(b).min(high));
        if end > begin {
            pieces.push([begin, end].map(|z| [(base + slope * z).clamp(0.0, sweep), z]));
        }
    }
    pieces
}

/// The points at which a line crosses the mesh lines and the lines of midside nodes, its ends included, in order.
pub(crate) fn cuts(grid: &Grid, [a, b]: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
    let at = |share: f64| [0, 1].map(|n| a[n] + (b[n] - a[n]) * share);
    let mut shares = vec![0.0, 1.0];
    let mut cut = |line: f64, n: usize| {
        let share = (line - a[n]) / (b[n] - a[n]);
        if share > 0.0 && share < 1.0 {
            shares.push(share);
        }
    };
    (0..=2 * grid.around).for_each(|j| cut(grid.angle(j), 0));
    (2 * grid.wall.start..=2 * grid.wall.end).for_each(|k| cut(grid.height(k), 1));
    shares.sort_by(f64::total_cmp);
    // Where a line passes close to a crossing of mesh lines, one node does for both.
    let least = 1e-3 / shares.len() as f64;
    let mut kept = vec![0.0];
    for &share in &shares[1..] {
        let close = share - kept[kept.len() - 1] < least;
        match (close, share == 1.0) {
            (false, _) => kept.push(share),
            (true, true) if kept.len() > 1 => *kept.last_mut().unwrap_or(&mut 0.0) = share,
            _ => {}
        }
    }
    kept.into_iter().map(at).collect()
}

/// The number of threads of a whole winding that one sector repeats, where sectors can repeat them.
pub(crate) fn repeats(winding: &Winding) -> Option<u32> {
    (!winding.has_rings() && winding.count >= 2).then_some(winding.count)
}

/// Whether a winding of this angle, rad, and number of families is its own mirror image.
pub(crate) fn is_mirror_image(angle: f64, two_families: bool) -> bool {
    two_families || angle.abs() < RING || (angle.abs() - 0.5 * PI).abs() < RING
}
