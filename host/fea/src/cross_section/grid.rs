//! The mesh of a section: rings and columns of nine-node elements.

use std::f64::consts::PI;

use super::build::{Build, Limit, Part};
use crate::spacing::evenly;

/// Columns around a turn that the wedge is one of: the section of its edges departs from circles by less than 1e-9.
const WEDGES: f64 = 256.0;

/// Elements of the wedge for one of the other parts.
const WEDGE_RINGS: usize = 2;

/// Node positions of one mesh.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) part: Part,
    /// Radii of the nodes outwards: two for each element and one more.
    pub(super) radii: Vec<f64>,
    /// Angles of the lines of nodes: two for each column and one more.
    pub(super) angles: Vec<f64>,
    /// Index of the nodes on the surface in whose middle the axis is.
    pub(super) axis_surface: usize,
    /// Columns from either end that carry the strip.
    pub(super) strip_columns: usize,
}

impl Grid {
    /// The mesh of a number of elements through the wall and around half a turn, each cut into `refine` in both directions.
    pub(super) fn new(build: &Build, part: Part, radial: usize, around: usize, refine: usize) -> Self {
        let ends: Vec<f64> = [1.0].into_iter().chain(build.radii_inside()).chain([build.outer]).collect();
        let elements = match part {
            Part::Wedge if build.windings.len() > 1 => no_larger(&ends, WEDGE_RINGS * radial),
            Part::Wedge => shared(&ends, WEDGE_RINGS * radial),
            _ => shared(&ends, radial),
        };
        let radii = steps(&ends, &elements.iter().map(|count| refine * count).collect::<Vec<_>>());
        let axis_surface = node_at(&radii, build.axis_surface());
        let (angles, strip_columns) = angles(build, part, around, refine);
        Self { part, radii, angles, axis_surface, strip_columns }
    }

    /// Index of the nodes on a winding's radius, which is a line of the mesh.
    pub(super) fn node_at(&self, radius: f64) -> usize {
        node_at(&self.radii, radius)
    }

    /// Elements through the wall.
    pub(super) fn rings(&self) -> usize {
        self.radii.len() / 2
    }

    /// Columns of elements.
    pub(super) fn columns(&self) -> usize {
        self.angles.len() / 2
    }

    /// Displacements of a node: two, or three where the section warps.
    pub(super) fn dofs(&self) -> usize {
        if self.part == Part::Ring { 3 } else { 2 }
    }

    /// Whether the last line of nodes is the first one again.
    pub(super) fn closed(&self) -> bool {
        self.part != Part::Half
    }

    /// Lines of nodes that are not the same.
    pub(super) fn lines(&self) -> usize {
        self.angles.len() - usize::from(self.closed())
    }

    /// Number of such parts in the section.
    pub(super) fn multiplicity(&self) -> f64 {
        match self.part {
            Part::Wedge => WEDGES,
            Part::Half => 2.0,
            Part::Ring => 1.0,
        }
    }

    /// Which of stretch, two bends and twist are free.
    pub(super) fn free(&self) -> [bool; 4] {
        match self.part {
            Part::Wedge => [true, false, false, true],
            Part::Half => [true, true, false, false],
            Part::Ring => [true; 4],
        }
    }
}

/// Index of the first node that is not within a radius.
fn node_at(radii: &[f64], radius: f64) -> usize {
    radii.iter().position(|node| *node >= radius).unwrap_or(radii.len() - 1)
}

/// Elements of the zones between `ends`: a number in all, or one a zone if that is more.
fn shared(ends: &[f64], elements: usize) -> Vec<usize> {
    let zones = ends.len() - 1;
    let elements = elements.max(zones);
    let (mut within, mut counts) = (0, Vec::new());
    for (zone, end) in ends.iter().enumerate().skip(1) {
        let share = end.ln() / ends[zones].ln();
        let most = elements - (zones - zone);
        let next = ((elements as f64 * share).round() as usize).clamp(within + 1, most);
        counts.push(next - within);
        within = next;
    }
    counts
}

/// Elements of the zones between `ends` that are no larger than those of an undivided wall: a narrow zone takes none from its neighbours.
fn no_larger(ends: &[f64], elements: usize) -> Vec<usize> {
    let size = ends[ends.len() - 1].ln() / elements as f64;
    ends.windows(2).map(|zone| ((zone[1] / zone[0]).ln() / size).ceil() as usize).collect()
}

/// Radii of the nodes, in geometric steps within each zone.
fn steps(ends: &[f64], elements: &[usize]) -> Vec<f64> {
    let mut radii = vec![ends[0]];
    for (zone, &count) in ends.windows(2).zip(elements) {
        let ratio = zone[1] / zone[0];
        for element in 1..=count {
            let before = radii[radii.len() - 1];
            let next = if element == count { zone[1] } else { zone[0] * ratio.powf(element as f64 / count as f64) };
            radii.extend([0.5 * (before + next), next]);
        }
    }
    radii
}

/// Angles of the lines and the columns under half of the strip.
fn angles(build: &Build, part: Part, around: usize, refine: usize) -> (Vec<f64>, usize) {
    if part == Part::Wedge {
        let width = 2.0 * PI / WEDGES;
        return (vec![0.0, 0.5 * width, width], 0);
    }
    let (ends, strip_columns) = half_turn(build, around, refine);
    let mut lines = vec![0.0];
    for pair in ends.windows(2) {
        lines.extend([0.5 * (pair[0] + pair[1]), pair[1]]);
    }
    if part == Part::Ring {
        let mirrored: Vec<f64> = lines.iter().rev().skip(1).map(|angle| 2.0 * PI - angle).collect();
        lines.extend(mirrored);
    }
    (lines, strip_columns)
}

/// Ends of the columns on half a turn.
fn half_turn(build: &Build, around: usize, refine: usize) -> (Vec<f64>, usize) {
    let Some(Limit::Strip { half_angle, .. }) = build.limit else {
        return (evenly(0.0, PI, refine * around).collect(), 0);
    };
    let under = ((around as f64 * half_angle / PI).round() as usize).clamp(1, around - 1);
    let (under, around) = (refine * under, refine * around);
    (evenly(0.0, half_angle, under).chain(evenly(half_angle, PI, around - under).skip(1)).collect(), under)
}
