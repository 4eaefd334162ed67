//! Starting points of further local solves about the best minimum on a supply line.
//!
//! Two neighbouring basins are looked for. In the first, a single segment has another geometry. In the second, all pressures are about
//! proportional to those of the minimum and most segments have other geometries: wider or narrower sections deform alike at pressures
//! times a factor, so that the objective changes little along the factor. Given the pressures the segments are independent, and a local solve of one
//! segment is cheap.

use super::grid::Grid;
use super::search::SAME;
use super::shared::Shared;
use softlimb_numerics::least_squares::{StoppingCriteria, minimise};

/// Starting points about a minimum at a point with its objective; the most promising one last.
pub(super) type Hops = fn(&Grid, &mut Shared, &[f64], f64) -> Vec<Vec<f64>>;
/// In turn, each until it finds nothing better; the search ends when none does.
pub(super) const HOPS: &[Hops] = &[scaled, exchanges];

/// Most evaluations of a segment whose geometry is exchanged.
const ALONE: usize = 60;
/// Geometries that leave more than this share of the objective in addition are not exchanged.
const PROMISING: f64 = 0.1;
/// Factor from one level of scaled pressures to the next.
const SCALE: f64 = 0.75;
/// Lowest level: the highest pressure as a share of that of the bounds.
const LOWEST: f64 = 0.08;
/// Levels that leave more than this share of the objective in addition are not gone beyond.
const HOPELESS: f64 = 0.3;
/// Geometries of the grid from which a segment is solved at each level, and most evaluations of each.
const GEOMETRIES: usize = 2;
const BRIEF: usize = 20;
/// Least relative gain of a step there.
const ROUGH: f64 = 1e-3;
/// Segments that leave less than this share of the objective need no other geometry.
const NEGLIGIBLE: f64 = 1e-4;

/// Points that differ from a minimum in one segment, whose geometry is at another minimum for the same pressures.
fn exchanges(grid: &Grid, limb: &mut Shared, point: &[f64], objective: f64) -> Vec<Vec<f64>> {
    let (places, shares) = point.split_at(limb.dimensions());
    let criteria = StoppingCriteria { evaluations: ALONE, least_gain: SAME, ..StoppingCriteria::default() };
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut first = 0;
    for (index, segment) in limb.segments.iter().enumerate() {
        let mut alone = limb.alone(index, shares);
        let range = first..first + segment.dimensions();
        first = range.end;
        let here = alone.objective_at(&places[range.clone()]);
        for place in grid.geometries(index, shares) {
            let Some(start) = alone.begin(place) else { continue };
            let Some(end) = minimise(&mut alone, &start, criteria) else { continue };
            let more = (end.objective - here) / objective;
            // As good is as likely a section of another size that deforms alike.
            let is_known = more.abs() <= SAME || found.iter().any(|(known, _)| (known - more).abs() <= SAME);
            if more < PROMISING && !is_known {
                let mut other = point.to_vec();
                other[range.clone()].copy_from_slice(&end.point);
                found.push((more, other));
            }
        }
        limb.add(alone.counts);
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, point)| point).collect()
}

/// A limb at scaled pressures, each segment at its best geometry there.
struct Level {
    left: f64,
    point: Vec<f64>,
    /// Whether a local solve of the whole limb may lead elsewhere than to the minimum that the pressures are scaled from.
    is_elsewhere: bool,
}

/// Points at the pressures of a minimum times a factor: the least along the factor, upwards and downwards.
fn scaled(grid: &Grid, limb: &mut Shared, point: &[f64], objective: f64) -> Vec<Vec<f64>> {
    let (places, shares) = point.split_at(limb.dimensions());
    let highest = shares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let up = |level: &f64| (*level < 1.0).then(|| (level / SCALE).min(1.0));
    let down = |level: &f64| Some(level * SCALE).filter(|level| *level > LOWEST);
    let upwards: Vec<f64> = std::iter::successors(Some(highest), up).skip(1).collect();
    let downwards: Vec<f64> = std::iter::successors(Some(highest), down).skip(1).collect();
    let mut found = Vec::new();
    for levels in [upwards, downwards] {
        let factors = levels.into_iter().map(|level| level / highest);
        found.extend(least(walk(grid, limb, (places, shares), factors, objective)));
    }
    found.sort_by(|a, b| b.left.total_cmp(&a.left));
    found.into_iter().map(|level| level.point).collect()
}

/// Levels one after the other, as long as they are not hopeless.
fn walk(
    grid: &Grid,
    limb: &mut Shared,
    (places, shares): (&[f64], &[f64]),
    factors: impl Iterator<Item = f64>,
    objective: f64,
) -> Vec<Level> {
    let (mut levels, mut places, mut is_elsewhere) = (Vec::new(), places.to_vec(), false);
    for factor in factors {
        let shares: Vec<f64> = shares.iter().map(|share| share * factor).collect();
        let Some((left, is_other)) = best_apart(grid, limb, &mut places, &shares, NEGLIGIBLE * objective) else {
            break;
        };
        if left > objective * (1.0 + HOPELESS) {
            break;
        }
        is_elsewhere |= is_other || left < objective;
        levels.push(Level { left, point: [places.as_slice(), &shares].concat(), is_elsewhere });
    }
    levels
}

/// The levels that leave less than their neighbours.
fn least(levels: Vec<Level>) -> Vec<Level> {
    let left: Vec<f64> = levels.iter().map(|level| level.left).collect();
    let is_least = |index: usize| {
        let beside =
            [index.checked_sub(1), Some(index + 1)].into_iter().flatten().filter_map(|beside| left.get(beside));
        beside.into_iter().all(|beside| left[index] <= *beside)
    };
    let kept = levels.into_iter().enumerate().filter(|(index, level)| level.is_elsewhere && is_least(*index));
    kept.map(|(_, level)| level).collect()
}

/// Moves each segment to its best geometry at these pressures, from where it is and from geometries of the grid. Returns the sum of
/// squares, and whether geometries of the grid are better by more than a negligible sum. `None` where a segment has no equilibrium.
fn best_apart(
    grid: &Grid,
    limb: &mut Shared,
    places: &mut [f64],
    shares: &[f64],
    negligible: f64,
) -> Option<(f64, bool)> {
    let criteria = StoppingCriteria { evaluations: BRIEF, least_gain: ROUGH, ..StoppingCriteria::default() };
    let (mut sum, mut is_other, mut first) = (0.0, false, 0);
    for (index, segment) in limb.segments.iter().enumerate() {
        let mut alone = limb.alone(index, shares);
        let place = &mut places[first..first + segment.dimensions()];
        first += place.len();
        let mut solve = |start: Vec<f64>| {
            let start = alone.begin(start)?;
            minimise(&mut alone, &start, criteria).map(|end| (end.objective, end.point))
        };
        let mut best = solve(place.to_vec());
        for start in grid.between(index, shares, GEOMETRIES) {
            let left = best.as_ref().map_or(f64::INFINITY, |best| best.0);
            if left <= negligible {
                break;
            }
            if let Some(other) = solve(start).filter(|other| other.0 < left) {
                is_other |= other.0 < left - negligible;
                best = Some(other);
            }
        }
        limb.add(alone.counts);
        let (left, end) = best?;
        place.copy_from_slice(&end);
        sum += left;
    }
    Some((sum, is_other))
}
