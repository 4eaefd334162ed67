//! Where to begin, and when enough descents agree.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use serde::Serialize;

use super::actuator::Counts;
use super::minimise::{Descent, LeastSquares, Stop, minimise};
use super::problem::{Problem, Segment};
use super::reach::{Separate, Span};
use super::shared::Shared;

/// Geometries that are looked at before any descent.
const TRIALS: usize = 24;
/// The first of them: the middle of the bounds, then towards wide and thin sections, which deform most; the rest are random. Lengths adapt.
const LOOKED_AT: [[f64; 4]; 5] =
    [[0.5, 0.5, 0.5, 0.5], [0.8, 0.2, 0.7, 0.5], [1.0, 0.0, 1.0, 0.5], [1.0, 0.0, 1.0, 0.0], [1.0, 0.0, 1.0, 1.0]];
/// Objectives within this share of each other agree.
const SAME: f64 = 1e-6;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Seed of the starts.
    pub seed: u64,
    /// Most descents, of each segment or of the limb on one supply line; at least 1.
    pub starts: usize,
    /// As many descents must end at the best objective before the search stops early.
    pub agreeing: usize,
    /// No descent begins after as many evaluations.
    pub evaluations: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { seed: 1, starts: 40, agreeing: 5, evaluations: 2500 }
    }
}

/// How the descents of a search ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Starts {
    /// Descents made; a geometry that reaches every goal at once counts as one.
    pub made: usize,
    /// Those that ended at the best objective.
    pub agreeing: usize,
}

/// Uniform numbers from a seed.
pub(in crate::design) struct Random(ChaCha8Rng);

impl Random {
    pub(in crate::design) fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// In `0..1`.
    pub(in crate::design) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(in crate::design) fn place(&mut self, width: usize) -> Vec<f64> {
        (0..width).map(|_| self.uniform()).collect()
    }
}

/// The best of a search.
pub(super) struct Found {
    /// Place of the geometry in its unit box, and of the shares behind it where there are.
    pub(super) place: Vec<f64>,
    pub(super) pressures_pa: Vec<f64>,
    pub(super) starts: Starts,
    pub(super) counts: Counts,
}

/// The size of the goals: `sum w q^2`.
fn scale<'a>(segments: impl IntoIterator<Item = &'a Segment>) -> f64 {
    let goals = segments.into_iter().flat_map(|segment| segment.goals.iter().flatten());
    goals.map(|goal| goal.weight * goal.value * goal.value).sum()
}

fn stop(scale: f64) -> Stop {
    Stop { zero: 1e-24 * scale, relative: 1e-16 }
}

/// Descends from one start after another until enough agree. `start` makes the next one.
fn descend<L: LeastSquares>(
    problem: &mut L,
    effort: &Effort,
    stop: Stop,
    mut start: impl FnMut(&mut L, usize) -> Option<Vec<f64>>,
    spent: impl Fn(&L) -> u64,
) -> Option<(Descent<L::Point>, Starts)> {
    let mut best: Option<Descent<L::Point>> = None;
    let mut ends: Vec<f64> = Vec::new();
    let mut starts = Starts::default();
    for index in 0..effort.starts {
        if index > 0 && spent(problem) >= effort.evaluations {
            break;
        }
        let Some(end) = start(problem, index).and_then(|place| minimise(problem, &place, stop)) else { continue };
        ends.push(end.objective);
        if best.as_ref().is_none_or(|best| end.objective < best.objective) {
            best = Some(end);
        }
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.objective);
        let agreeing = ends.iter().filter(|end| **end <= least * (1.0 + SAME) + stop.zero).count();
        starts = Starts { made: ends.len(), agreeing };
        if least <= stop.zero || agreeing >= effort.agreeing {
            break;
        }
    }
    Some((best?, starts))
}

/// The best geometry of a segment with pressures of its own; `None` where the model answers nowhere.
pub(super) fn separate(segment: &Segment, index: usize, effort: &Effort) -> Option<Found> {
    let mut random = Random::new(effort.seed, index as u64);
    let mut problem = Separate { segment, counts: Counts::default() };
    let width = segment.dimensions();
    let mut ranked = Vec::new();
    for trial in 0..TRIALS {
        let mut place = LOOKED_AT.get(trial).map_or_else(|| random.place(width), |place| place[..width].to_vec());
        let Some(mut span) = Span::new(segment, &place, &mut problem.counts) else { continue };
        if let Some(length_m) = span.better_length().filter(|_| span.estimate() > 0.0) {
            let [low, width] = segment.axis(2);
            place[2] = if width > 0.0 { (length_m - low) / width } else { 0.0 };
            let Some(adapted) = Span::new(segment, &place, &mut problem.counts) else { continue };
            span = adapted;
        }
        let estimate = span.estimate();
        if estimate == 0.0
            && let Some(reach) = span.reach(&mut problem.counts).filter(|reach| reach.exact())
        {
            let pressures_pa = reach.phases.iter().map(|phase| phase.pressure_pa).collect();
            let starts = Starts { made: 1, agreeing: 1 };
            return Some(Found { place, pressures_pa, starts, counts: problem.counts });
        }
        ranked.push((estimate, place));
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The best trials first, every second start from anywhere: a basin that starts high may end low.
    let next = |_: &mut Separate, start: usize| {
        let good = start.is_multiple_of(2).then(|| ranked.get(start / 2)).flatten();
        Some(good.map_or_else(|| random.place(width), |(_, place)| place.clone()))
    };
    let stop = stop(scale([segment]));
    let (end, starts) = descend(&mut problem, effort, stop, next, |problem| problem.counts.evaluations)?;
    let pressures_pa = end.point.phases.iter().map(|phase| phase.pressure_pa).collect();
    Some(Found { place: end.place, pressures_pa, starts, counts: problem.counts })
}

/// The best geometries of segments on one supply line; `None` where the model answers nowhere.
pub(super) fn shared(problem: &Problem, effort: &Effort) -> Option<Found> {
    let mut random = Random::new(effort.seed, 0);
    let mut limb = Shared { problem, counts: Counts::default() };
    let next = |limb: &mut Shared, start: usize| {
        let width = limb.dimensions();
        let mut place = if start == 0 { vec![0.5; width] } else { random.place(width) };
        let shares = limb.shares(&place)?;
        place.extend(shares);
        Some(place)
    };
    let stop = stop(scale(&problem.segments));
    let (end, starts) = descend(&mut limb, effort, stop, next, |limb| limb.counts.evaluations)?;
    Some(Found { place: end.place, pressures_pa: end.point.pressures_pa, starts, counts: limb.counts })
}
