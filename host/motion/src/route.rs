//! A way among obstacles: straight in the space of setpoints where that is clear, else by via points.
//!
//! Two trees of proven moves grow towards each other from both ends (RRT-connect); the way found is then cut short wherever a straight
//! move between two of its points is clear, too. The draws are seeded, so that the same scene has the same way.

use super::space::Space;
use softlimb_limb::{Limb, LimbModule};
use softlimb_numerics::Random;

/// Points drawn before the search gives up.
const DRAWS: usize = 3000;
/// Longest move of a tree, as a share of the range of setpoints.
const REACH: f64 = 0.15;
/// Pairs of points that are tried for a short cut.
const CUTS: usize = 150;

/// Points drawn to grow a tree that approaches something, and the last step towards it, as a share of the range.
const GROWN: usize = 800;
const FINEST: f64 = 1e-4;

/// One tree: rows of setpoints as shares of their ranges, each with the index of the one it came from.
type Tree = Vec<(Vec<f64>, usize)>;

/// The setpoints at rest and at the highest pressure up to which each belongs to one state: where via points are drawn from.
pub(super) fn ranges(limb: &Limb) -> Vec<(f64, f64)> {
    let range = |module: &LimbModule| {
        let end = module.curve.at(module.single_valued_max_pa());
        (module.range().0, module.measure(&end))
    };
    limb.drives().map(|drive| range(&drive)).collect()
}

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

/// Where a way leads that gets as near to something as was found; `away` is how far a row of setpoints is from it, `None` for what does
/// not count. The start itself where nothing is nearer.
///
/// A tree of proven moves is grown from the start; from its best place small steps go on, one setpoint or two at a time.
pub(super) fn approach(
    space: &Space<'_>,
    ranges: &[(f64, f64)],
    from: &[f64],
    away: impl Fn(&[f64]) -> Option<f64>,
) -> Vec<f64> {
    let search = Search { space, ranges };
    let far = |point: &[f64]| away(&search.values(point)).unwrap_or(f64::INFINITY);
    let mut random = Random::new(2, 0);
    let mut tree: Tree = vec![(search.shares(from), 0)];
    for _ in 0..GROWN {
        let point = random.point(from.len());
        search.extend(&mut tree, &point);
    }
    let measured = tree.into_iter().map(|(point, _)| (far(&point), point));
    let Some((mut least, mut here)) = measured.min_by(|a, b| a.0.total_cmp(&b.0)) else { return from.to_vec() };
    let mut step = REACH;
    while step > FINEST {
        let next = steps(&here, step).into_iter().map(|point| (far(&point), point));
        let mut nearer: Vec<_> = next.filter(|(distance, _)| *distance < least).collect();
        nearer.sort_by(|a, b| a.0.total_cmp(&b.0));
        match nearer.into_iter().find(|(_, point)| search.clear(&here, point)) {
            Some(found) => (least, here) = found,
            None => step *= 0.5,
        }
    }
    search.values(&here)
}

/// The places a step away, along one axis or two, within the ranges.
fn steps(here: &[f64], step: f64) -> Vec<Vec<f64>> {
    let moved = |point: &[f64], axis: usize, by: f64| {
        let mut next = point.to_vec();
        next[axis] = (next[axis] + by).clamp(0.0, 1.0);
        next
    };
    let mut all = Vec::new();
    for axis in 0..here.len() {
        for by in [-step, step] {
            let one = moved(here, axis, by);
            let others = (0..axis).flat_map(|other| [-step, step].map(|by| (other, by)));
            all.extend(others.map(|(other, by)| moved(&one, other, by)));
            all.push(one);
        }
    }
    all
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
        let mut random = Random::new(0, 0);
        let mut trees: [Tree; 2] = [vec![(from.to_vec(), 0)], vec![(to.to_vec(), 0)]];
        for draw in 0..DRAWS {
            let point = random.point(from.len());
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
    let mut random = Random::new(1, 0);
    for _ in 0..CUTS {
        if rows.len() < 3 {
            break;
        }
        let (a, b) = (random.index(rows.len()), random.index(rows.len()));
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
