//! How slowly samples find the extents: plain Monte Carlo beside points of low discrepancy and corners.

use super::extents::Extents;
use super::sample::Points;
use super::single_sample::sample_single;
use super::space::Workspace;

/// What a number of samples misses of a range.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// Number of samples.
    pub count: usize,
    /// Largest part of a range (x, y, z, distance) that the samples do not cover: random, even, and with faces.
    pub missing: [f64; 3],
}

/// What samples miss, for several numbers of them.
pub fn convergence(
    space: &Workspace<'_>,
    extents: &Extents,
    counts: &[usize],
    seed: u64,
    threads: usize,
) -> Vec<Convergence> {
    let most = counts.iter().copied().max().unwrap_or(0);
    let sets =
        [Points::Random, Points::Even, Points::Faces].map(|points| sample_single(space, points, most, seed, threads));
    let row = |count: &usize| Convergence {
        count: *count,
        missing: [0, 1, 2].map(|set: usize| missing(space, extents, &sets[set][..*count])),
    };
    counts.iter().map(row).collect()
}

/// The largest share of a range that the tips do not cover.
fn missing(space: &Workspace<'_>, extents: &Extents, tips_m: &[[f32; 3]]) -> f64 {
    let base = space.base();
    let value = |tip: &[f32; 3], index: usize| {
        let tip = tip.map(f64::from);
        if index < 3 { tip[index] } else { tip.iter().zip(base).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt() }
    };
    let share = |index: usize| {
        let (least, largest) = tips_m
            .iter()
            .map(|tip| value(tip, index))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, largest), value| (least.min(value), largest.max(value)));
        let range = extents.range_m(index);
        let covered = (largest - least).max(0.0);
        // A plane limb has no width to miss.
        if range > 1e-9 { 1.0 - covered / range } else { 0.0 }
    };
    (0..4).map(share).fold(0.0, f64::max)
}
