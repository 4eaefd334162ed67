//! A way among obstacles: straight in the space of setpoints where that is clear, else by via points.
//!
//! Two trees of proven moves grow towards each other from both ends (RRT-connect); the way found is then cut short wherever a straight
//! move between two of its points is clear, too. The draws are seeded, so that the same scene has the same way.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::space::Space;

/// Points drawn before the search gives up.
const DRAWS: usize = 3000;
/// Longest move of a tree, as a share of the range of setpoints.
const REACH: f64 = 0.15;
/// Pairs of points that are tried for a short cut.
const CUTS: usize = 150;

/// One tree: rows of setpoints as shares of their ranges, each with the index of the one it came from.
type Tree = Vec<(Vec<f64>, usize)>;

/// Finds a way from row to row of setpoints, each leg proven clear. The rows between the ends are its via points.
///
/// `ranges` are the setpoints at rest and at the highest pressure, from which the points are drawn. `None` where no way was found.
pub(super) fn route(space: &Space<'_>, ranges: &[(f64, f64)], from: &[f64], to: &[f64]) -> Option<Vec<Vec<f64>>> {
    if space.blocked(from, to).is_none() {
        return Some(vec![from.to_vec(), to.to_vec()]);
    }
    let search = Search { space, ranges };
    let way = search.connect(&search.shares(from), &search.shares(to))?;
    let mut rows: Vec<Vec<f64>> = way.iter().map(|point| search.values(point)).collect();
    // The ends as they are, not as their shares give them back.
    let last = rows.len() - 1;
    rows[0] = from.to_vec();
    rows[last] = to.to_vec();
    Some(shorten(space, rows))
}

struct Search<'a, 's> {
    space: &'a Space<'s>,
    ranges: &'a [(f64, f64)],
}

impl Search<'_, '_> {
    fn shares(&self, values: &[f64]) -> Vec<f64> {
        let share = |(value, (rest, most)): (&f64, &(f64, f64))| {
            if most == rest { 0.0 } else { (value - rest) / (most - rest) }
        };
        values.iter().zip(self.ranges).map(share).collect()
    }

    fn values(&self, shares: &[f64]) -> Vec<f64> {
        shares.iter().zip(self.ranges).map(|(share, (rest, most))| rest + share * (most - rest)).collect()
    }

    fn clear(&self, from: &[f64], to: &[f64]) -> bool {
        self.space.blocked(&self.values(from), &self.values(to)).is_none()
    }

    fn connect(&self, from: &[f64], to: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut trees: [Tree; 2] = [vec![(from.to_vec(), 0)], vec![(to.to_vec(), 0)]];
        for draw in 0..DRAWS {
            let point: Vec<f64> =
                from.iter().map(|_| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64).collect();
            let (grown, other) = (draw % 2, 1 - draw % 2);
            let Some(tip) = self.extend(&mut trees[grown], &point) else { continue };
            let target = trees[grown][tip].0.clone();
            // The other tree goes on towards the new point as far as it gets.
            while let Some(end) = self.extend(&mut trees[other], &target) {
                if trees[other][end].0 == target {
                    let (mut first, mut second) = (branch(&trees[grown], tip), branch(&trees[other], end));
                    first.reverse();
                    first.extend(second.drain(1..));
                    if grown == 1 {
                        first.reverse();
                    }
                    return Some(first);
                }
            }
        }
        None
    }

    /// Grows a tree from its nearest point towards another, by a reach at most; gives the new point's index.
    fn extend(&self, tree: &mut Tree, towards: &[f64]) -> Option<usize> {
        let (near, way) = tree
            .iter()
            .map(|(point, _)| length(point, towards))
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, way)| *way > 0.0)?;
        let start = tree[near].0.clone();
        let next: Vec<f64> = if way <= REACH {
            towards.to_vec()
        } else {
            start.iter().zip(towards).map(|(a, b)| a + (b - a) * REACH / way).collect()
        };
        if !self.clear(&start, &next) {
            return None;
        }
        tree.push((next, near));
        Some(tree.len() - 1)
    }
}

/// The points from one of a tree to its root.
fn branch(tree: &Tree, tip: usize) -> Vec<Vec<f64>> {
    let (mut points, mut index) = (vec![tree[tip].0.clone()], tip);
    while index != 0 {
        index = tree[index].1;
        points.push(tree[index].0.clone());
    }
    points
}

/// Leaves out via points, in all pairs once and then between random places of the way.
fn shorten(space: &Space<'_>, mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..CUTS {
        if rows.len() < 3 {
            break;
        }
        let mut pick = || (random.next_u64() % rows.len() as u64) as usize;
        let (a, b) = (pick(), pick());
        let (a, b) = (a.min(b), a.max(b));
        if b > a + 1 && space.blocked(&rows[a], &rows[b]).is_none() {
            rows.drain(a + 1..b);
        }
    }
    rows
}

fn length(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
