//! The volume: cubes of a grid that hold a tip.

use std::collections::{BTreeMap, HashSet};

use nalgebra::{Matrix3, Vector3};

/// Ratio of thickness to length below which a point cloud counts as flat: a hundred times the rounding in single precision.
const FLAT: f64 = 1e-5;

/// A cube's place in the grid.
type Cube = [i32; 3];

/// The cubes that hold at least one tip.
#[derive(Clone, Debug)]
pub struct Grid {
    side_m: f64,
    cubes: HashSet<Cube>,
    is_solid: bool,
}

impl Grid {
    /// Grid of cubes of a side, m, > 0, aligned with the origin of the scene. `pressures` is the number of independent pressures of the limb.
    pub fn new<T: Copy + Into<f64>>(tips_m: &[[T; 3]], side_m: f64, pressures: usize) -> Self {
        let cubes = tips_m.iter().map(|tip| tip.map(|x| (x.into() / side_m).floor() as i32)).collect();
        Self { side_m, cubes, is_solid: pressures >= 3 && !is_flat(tips_m) }
    }

    /// Whether the tips fill a volume: with fewer than three pressures, or with planar bending, they do not.
    pub fn is_solid(&self) -> bool {
        self.is_solid
    }

    /// Number of cubes with a tip.
    pub fn count(&self) -> usize {
        self.cubes.len()
    }

    /// Their volume, m3; 0 where the tips fill none. It grows with the number of samples and falls with the side: too small where a cube of the workspace has not been met
    /// yet, too large by the cubes that its surface cuts.
    pub fn volume_m3(&self) -> f64 {
        if self.is_solid { self.cubes.len() as f64 * self.side_m.powi(3) } else { 0.0 }
    }

    /// Side of a cube, m.
    pub fn side_m(&self) -> f64 {
        self.side_m
    }

    /// Centers of the squares that the cubes have seen along a coordinate (0 to 2), m, in order, each with its depth: the number of cubes behind
    /// each other.
    pub fn depths(&self, along: usize) -> Vec<([f64; 2], usize)> {
        let others: Vec<usize> = (0..3).filter(|axis| *axis != along).collect();
        let mut depths: BTreeMap<[i32; 2], usize> = BTreeMap::new();
        for cube in &self.cubes {
            *depths.entry([cube[others[0]], cube[others[1]]]).or_default() += 1;
        }
        depths
            .into_iter()
            .map(|(square, depth)| (square.map(|place| (f64::from(place) + 0.5) * self.side_m), depth))
            .collect()
    }
}

/// Whether points lie in a plane, or on a line.
fn is_flat<T: Copy + Into<f64>>(points: &[[T; 3]]) -> bool {
    let points = || points.iter().map(|point| Vector3::from(point.map(Into::into)));
    let mean: Vector3<f64> = points().sum::<Vector3<f64>>() / points().count().max(1) as f64;
    let spread: Matrix3<f64> = points().map(|point| (point - mean) * (point - mean).transpose()).sum();
    let squares = spread.symmetric_eigenvalues();
    squares.min() <= FLAT * FLAT * squares.max()
}
