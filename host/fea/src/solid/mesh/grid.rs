//! Mesh lines of one tube with its caps, in cylindrical coordinates.

/// Mesh lines in the three directions, mm and rad. Elements lie between neighbouring lines; a lattice index counts lines and the
/// midpoints between them, so that line `n` has index `2 n`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Radii from the axis outwards; the first is 0.
    pub(crate) radii: Vec<f64>,
    /// Which radius is the lumen's.
    pub(crate) lumen: usize,
    /// Elements in the radial direction, by index, that carry the winding.
    pub(crate) layer: std::ops::Range<usize>,
    /// Lattice index of the radius at which gauges measure the outside.
    pub(crate) outside: usize,
    /// Elements around in the domain.
    pub(crate) around: usize,
    /// The angle they cover, rad.
    pub(crate) sweep: f64,
    /// Whether the last meets the first.
    pub(crate) closed: bool,
    /// Heights from one end to the other; 0 is the middle of the actuator.
    pub(crate) heights: Vec<f64>,
    /// Elements along, by index, that are wall and not cap.
    pub(crate) wall: std::ops::Range<usize>,
}

impl Grid {
    /// Radius at a lattice index, mm.
    pub(crate) fn radius(&self, i: usize) -> f64 {
        midpoint(&self.radii, i)
    }

    /// Angle at a lattice index, rad.
    pub(crate) fn angle(&self, j: usize) -> f64 {
        self.sweep * j as f64 / (2 * self.around) as f64
    }

    /// Height at a lattice index, mm.
    pub(crate) fn height(&self, k: usize) -> f64 {
        midpoint(&self.heights, k)
    }

    /// Whether there is an element: caps reach to the axis, the wall does not.
    pub(crate) fn is_solid(&self, m: usize, q: usize) -> bool {
        m >= self.lumen || !self.wall.contains(&q)
    }

    /// Number of nodes, close to exact: about four for each element, and a skin.
    pub(crate) fn nodes_estimate(&self) -> usize {
        let wall = self.radii.len() - 1 - self.lumen;
        let around = self.around + usize::from(!self.closed);
        let layer = |across: usize| around * ((across + 1) * 2 + across) + (across + 1) * around;
        let caps = self.heights.len() - 1 - self.wall.len();
        self.wall.len() * layer(wall) + (caps + 1) * layer(self.radii.len() - 1)
    }
}

fn midpoint(lines: &[f64], index: usize) -> f64 {
    let (low, high) = (lines[index / 2], lines[index.div_ceil(2)]);
    0.5 * (low + high)
}
