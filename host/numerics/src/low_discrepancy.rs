//! Points of low discrepancy in the unit box.

use crate::random::uniform_at;

/// Kronecker's sequence: on each axis multiples of a power of the root of `x^(d+1) = x + 1`, from an offset, modulo one.
#[derive(Clone, Debug)]
pub struct Kronecker {
    /// Offset of each axis.
    pub offsets: Vec<f64>,
    /// Step of each axis from a point to the next.
    pub steps: Vec<f64>,
}

impl Kronecker {
    /// The sequence of a box with so many axes. Offsets are 1/2 for the seed 0, else drawn by seed.
    pub fn new(axes: usize, seed: u64) -> Self {
        let mut root = 1.5_f64;
        for _ in 0..60 {
            root = (1.0 + root).powf(1.0 / (axes as f64 + 1.0));
        }
        let steps = (0..axes).map(|axis| root.powi(-(axis as i32 + 1))).collect();
        let offsets = (0..axes).map(|axis| if seed == 0 { 0.5 } else { uniform_at(seed, axis as u64) }).collect();
        Self { offsets, steps }
    }

    /// A coordinate of a point of the sequence.
    pub fn coordinate(&self, index: usize, axis: usize) -> f64 {
        let along = self.offsets[axis] + (index as f64 + 1.0) * self.steps[axis];
        along - along.floor()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of points in the box below each of them, against its volume: the star discrepancy on the points themselves.
    #[test]
    fn points_fill_a_square_more_evenly_than_random_ones() {
        let discrepancy = |points: &[[f64; 2]]| {
            let off = |[x, y]: &[f64; 2]| {
                let inside = points.iter().filter(|[a, b]| a < x && b < y).count();
                (inside as f64 / points.len() as f64 - x * y).abs()
            };
            points.iter().map(off).fold(0.0, f64::max)
        };
        let sequence = Kronecker::new(2, 0);
        let even: Vec<_> = (0..1000).map(|i| [0, 1].map(|axis| sequence.coordinate(i, axis))).collect();
        let random: Vec<_> = (0..1000).map(|i| [0, 1].map(|axis| uniform_at(1, 2 * i + axis))).collect();
        assert!(discrepancy(&even) < 1e-2, "{}", discrepancy(&even));
        assert!(discrepancy(&random) > 2e-2, "{}", discrepancy(&random));
    }

    #[test]
    fn one_axis_steps_by_the_golden_section() {
        let sequence = Kronecker::new(1, 0);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        assert!((sequence.steps[0] - golden).abs() < 1e-15);
        assert!((sequence.coordinate(0, 0) - (golden - 0.5)).abs() < 1e-15);
        assert!(Kronecker::new(3, 5).offsets.iter().all(|offset| (0.0..1.0).contains(offset) && *offset != 0.5));
    }
}
