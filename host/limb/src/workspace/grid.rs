//! The volume: cubes of a grid that hold a tip.

use std::collections::{BTreeMap, HashSet};

/// A cube's place in the grid.
type Cube = [i32; 3];

/// The cubes that hold at least one tip.
#[derive(Clone, Debug)]
pub struct Grid {
    side_m: f64,
    cubes: HashSet<Cube>,
}

impl Grid {
    /// The grid of cubes of a side, m, > 0, through the origin of the scene.
    pub fn new<T: Copy + Into<f64>>(tips_m: &[[T; 3]], side_m: f64) -> Self {
        let cubes = tips_m.iter().map(|tip| tip.map(|x| (x.into() / side_m).floor() as i32)).collect();
        Self { side_m, cubes }
    }

    /// Number of cubes with a tip.
    pub fn count(&self) -> usize {
        self.cubes.len()
    }

    /// Their volume, m3. It grows with the number of samples and falls with the side: too small where a cube of the workspace has not been met
    /// yet, too large by the cubes that its surface cuts.
    pub fn volume_m3(&self) -> f64 {
        self.cubes.len() as f64 * self.side_m.powi(3)
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
