//! Coarse grids of the segments' geometries: starting points of a search on one supply line.
//!
//! Given the pressures, the segments are independent. Stretch, twist and bend per length do not depend on the length, so that the
//! best length of a section is explicit: `L = sum w u g / sum w u^2` within its bounds, of deformations `u` per length and goals `g`. So a
//! table of `u` by section, fiber angle and pressure answers eq. (14) at any pressures without another model solve, and the choice of every
//! segment is its best row. What is left are the pressures: each phase in turn takes its best level, until none changes.

use fra_model::Motion;

use super::actuator::{Candidate, Counts};
use super::edge::between;
use super::problem::{Goal, Segment};
use softlimb_numerics::Random;

/// Intervals of the pressure range.
const INTERVALS: usize = 12;
/// Values of inner radius, wall and fiber angle: their bounds and between them. The least objectives lie on bounds mostly.
const VALUES: usize = 5;
/// Random pressures from which levels are improved.
const TRIALS: usize = 32;
/// Most products of a row and two phases in these trials: a bound for large problems alone.
const WORK: usize = 10_000_000;
/// Fractions of the way between neighbouring rows: most near the lower bounds, where thin walls deform most.
const BETWEEN: [f64; 4] = [0.1, 0.25, 0.5, 0.75];
/// Sections nearer to each other in each variable, as a share of its bounds, are alike.
const ALIKE: f64 = 0.3;
/// Most rounds over all phases.
const ROUNDS: usize = 8;
/// A section with its fiber angle.
struct Row {
    place: Vec<f64>,
    /// Pressure as a share of the highest one, deformation per length there; up to the cap of the section.
    curve: Vec<[f64; 2]>,
}

/// The rows of a segment, inner radius first and fiber angle last; behind them those on an [`edge`](super::edge).
struct Rows<'a> {
    segment: &'a Segment,
    /// Number of values of each variable but the length.
    sizes: [usize; 3],
    /// `None` where the model has no answer.
    rows: Vec<Option<Row>>,
}

/// The grids of all segments.
pub(super) struct Grid<'a> {
    segments: Vec<Rows<'a>>,
    phases: usize,
    /// Weight of the squared share of a pressure: the effort.
    effort: f64,
}

/// What a row leaves of eq. (14): `C - 2 L A + L^2 B`.
#[derive(Clone, Copy, Default)]
struct Sums {
    a: f64,
    b: f64,
    c: f64,
}

impl Sums {
    fn with(self, goal: Option<Goal>, found: f64) -> Self {
        let Some(Goal { value, weight }) = goal else { return self };
        Self {
            a: self.a + weight * found * value,
            b: self.b + weight * found * found,
            c: self.c + weight * value * value,
        }
    }

    /// The best length, m, and the sum of squares that remains. An expanded radius does not scale with the length.
    fn best(self, segment: &Segment) -> (f64, f64) {
        let [low, high] = segment.bounds.length_m;
        let length_m = if self.b > 0.0 { (self.a / self.b).clamp(low, high) } else { low };
        let times = if segment.motion == Motion::Expansion { 1.0 } else { length_m };
        (length_m, (self.c - 2.0 * times * self.a + times * times * self.b).max(0.0))
    }
}

impl Row {
    fn new(segment: &Segment, place: Vec<f64>, highest_pa: f64, counts: &mut Counts) -> Option<Self> {
        let candidate = Candidate::new(segment, &place)?;
        let cap = candidate.cap_below(highest_pa, counts)?.map_or(1.0, |cap| cap.pressure_pa / highest_pa);
        let per = if segment.motion == Motion::Expansion { 1.0 } else { candidate.geometry.length_m };
        let mut curve = Vec::with_capacity(INTERVALS + 1);
        let mut state = candidate.actuator.rest();
        curve.push([0.0, candidate.measure(&state) / per]);
        for level in 1..=INTERVALS {
            let share = (level as f64 / INTERVALS as f64).min(cap);
            state = candidate.near(&state, share * highest_pa, counts)?;
            curve.push([share, candidate.measure(&state) / per]);
            if share == cap {
                break;
            }
        }
        Some(Self { place, curve })
    }

    /// The cap as a share of the highest pressure.
    fn cap(&self) -> f64 {
        self.curve.last().map_or(0.0, |[share, _]| *share)
    }

    /// The row on an edge between two rows, where there is one.
    fn between(&self, other: &Self, segment: &Segment, highest_pa: f64, counts: &mut Counts) -> Option<Self> {
        let (free, bounded) = if self.cap() < other.cap() { (other, self) } else { (self, other) };
        (free.cap() == 1.0 && bounded.cap() < 1.0).then_some(())?;
        let places = [free.place.clone(), bounded.place.clone()];
        let place = between(segment, places, bounded.cap() * highest_pa, highest_pa, counts)?;
        Self::new(segment, place, highest_pa, counts)
    }

    /// Deformation per length; `None` beyond the cap.
    fn at(&self, share: f64) -> Option<f64> {
        let index = ((share * INTERVALS as f64) as usize).min(self.curve.len().saturating_sub(2));
        let ([low, from], [high, to]) = (*self.curve.get(index)?, *self.curve.get(index + 1)?);
        let along = (share - low) / (high - low);
        (along <= 1.0 + 1e-9).then_some(from + along * (to - from))
    }
}

impl<'a> Rows<'a> {
    fn new(segment: &'a Segment, highest_pa: f64, counts: &mut Counts) -> Self {
        let values = |axis: usize| {
            let is_free = axis < segment.dimensions() && segment.axis(axis)[1] > 0.0;
            if is_free { VALUES } else { 1 }
        };
        let sizes = [values(0), values(1), values(3)];
        let mut rows = Vec::new();
        for index in 0..sizes.iter().product() {
            let at = |index: usize, of: usize| if of > 1 { index as f64 / (of - 1) as f64 } else { 0.0 };
            let [inner, wall, angle] = [
                at(index / (sizes[1] * sizes[2]), sizes[0]),
                at(index / sizes[2] % sizes[1], sizes[1]),
                at(index % sizes[2], sizes[2]),
            ];
            let place = [inner, wall, 0.5, angle][..segment.dimensions()].to_vec();
            rows.push(Row::new(segment, place, highest_pa, counts));
        }
        for index in (0..rows.len()).filter(|index| index % sizes[2] > 0) {
            if let [Some(low), Some(high)] = &rows[index - 1..=index] {
                let edge = low.between(high, segment, highest_pa, counts);
                rows.extend(edge.map(Some));
            }
        }
        Self { segment, sizes, rows }
    }

    fn sums(&self, row: &Row, shares: &[f64], without: Option<usize>) -> Option<Sums> {
        let mut sums = Sums::default();
        for (phase, (share, goal)) in shares.iter().zip(&self.segment.goals).enumerate() {
            if without != Some(phase) {
                sums = sums.with(*goal, row.at(*share)?);
            }
        }
        Some(sums)
    }

    /// What the rows leave at pressures; infinite beyond their caps.
    fn left(&self, shares: &[f64]) -> Vec<f64> {
        let left = |row: &Option<Row>| {
            let sums = row.as_ref().and_then(|row| self.sums(row, shares, None));
            sums.map_or(f64::INFINITY, |sums| sums.best(self.segment).1)
        };
        self.rows.iter().map(left).collect()
    }

    /// The least that a row leaves at each level of one phase, the others as they are.
    fn by_level(&self, shares: &[f64], phase: usize) -> [f64; INTERVALS + 1] {
        let mut least = [f64::INFINITY; INTERVALS + 1];
        for row in self.rows.iter().flatten() {
            let Some(sums) = self.sums(row, shares, Some(phase)) else { continue };
            for (level, least) in least.iter_mut().enumerate() {
                let Some(found) = row.at(level as f64 / INTERVALS as f64) else { break };
                *least = least.min(sums.with(self.segment.goals[phase], found).best(self.segment).1);
            }
        }
        least
    }

    /// The geometry of a row at its best length.
    fn place(&self, row: &Row, shares: &[f64]) -> Option<Vec<f64>> {
        let (length_m, _) = self.sums(row, shares, None)?.best(self.segment);
        let [low, width] = self.segment.axis(2);
        let mut place = row.place.clone();
        place[2] = if width > 0.0 { (length_m - low) / width } else { 0.0 };
        Some(place)
    }

    /// The best row at these pressures.
    fn best(&self, shares: &[f64]) -> Option<Vec<f64>> {
        self.best_of(&self.left(shares), shares, |_| true)
    }

    /// The best row at these pressures for each fiber angle, of a bend for each inner radius, and at each bound of the wall.
    fn best_of_each(&self, shares: &[f64]) -> Vec<Vec<f64>> {
        let left = self.left(shares);
        let [inner, wall, angle] = self.sizes;
        let (stride, count) = if angle > 1 { (1, angle) } else { (wall, inner) };
        let on_grid = inner * wall * angle;
        let of_value =
            |value: usize| self.best_of(&left, shares, |index| index < on_grid && index / stride % count == value);
        let of_wall =
            |value: usize| self.best_of(&left, shares, |index| index < on_grid && index / angle % wall == value);
        let mut best: Vec<_> = (0..count).filter_map(of_value).collect();
        best.extend([0, wall - 1].into_iter().filter_map(of_wall));
        best.extend(self.best_of(&left, shares, |index| index >= on_grid));
        best.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        best.dedup();
        best
    }

    /// The rows and the points between neighbouring rows that leave least at these pressures, the best first, none alike another one.
    fn best_between(&self, shares: &[f64], most: usize) -> Vec<Vec<f64>> {
        let [_, wall, angle] = self.sizes;
        let on_grid: usize = self.sizes.iter().product();
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        for (index, row) in self.rows.iter().enumerate() {
            let Some(row) = row else { continue };
            found.extend(self.between(row, row, 0.0, shares));
            let steps = [(wall * angle, self.sizes[0]), (angle, wall), (1, angle)];
            let steps = steps.into_iter().filter(|(step, count)| index < on_grid && index / step % count + 1 < *count);
            for next in steps.filter_map(|(step, _)| self.rows[index + step].as_ref()) {
                found.extend(BETWEEN.iter().filter_map(|along| self.between(row, next, *along, shares)));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Vec<Vec<f64>> = Vec::new();
        for (_, place) in found {
            // The best length follows from the section.
            let differ = |axis: usize, other: &[f64]| axis != 2 && (place[axis] - other[axis]).abs() > ALIKE;
            let is_new = best.iter().all(|other| (0..place.len()).any(|axis| differ(axis, other)));
            if is_new && best.len() < most {
                best.push(place);
            }
        }
        best
    }

    /// The least that a point between two rows leaves by interpolation, and its geometry at its best length; `None` beyond a cap.
    fn between(&self, from: &Row, to: &Row, along: f64, shares: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut sums = Sums::default();
        for (share, goal) in shares.iter().zip(&self.segment.goals) {
            sums = sums.with(*goal, interpolated(from.at(*share)?, to.at(*share)?, along));
        }
        let (length_m, left) = sums.best(self.segment);
        let mut place: Vec<f64> = from.place.iter().zip(&to.place).map(|(a, b)| a + along * (b - a)).collect();
        let [low, width] = self.segment.axis(2);
        place[2] = if width > 0.0 { (length_m - low) / width } else { 0.0 };
        Some((left, place))
    }

    fn best_of(&self, left: &[f64], shares: &[f64], is_meant: impl Fn(usize) -> bool) -> Option<Vec<f64>> {
        let meant = (0..left.len()).filter(|index| is_meant(*index) && left[*index].is_finite());
        let best = meant.min_by(|a, b| left[*a].total_cmp(&left[*b]))?;
        self.place(self.rows[best].as_ref()?, shares)
    }
}

/// A deformation between those of two rows; by its logarithm, because it is about a power of the sizes.
fn interpolated(from: f64, to: f64, along: f64) -> f64 {
    if from * to > 0.0 { from * (to / from).powf(along) } else { from + along * (to - from) }
}

impl<'a> Grid<'a> {
    /// Solves for all rows, at pressures up to `highest_pa`.
    pub(super) fn new(segments: &'a [Segment], highest_pa: f64, counts: &mut Counts) -> Self {
        let phases = segments.first().map_or(0, |segment| segment.goals.len());
        let effort = segments.iter().map(|segment| segment.effort_per_pa2).sum::<f64>() * highest_pa.powi(2);
        Self {
            segments: segments.iter().map(|segment| Rows::new(segment, highest_pa, counts)).collect(),
            phases,
            effort,
        }
    }

    /// The best geometries of one segment at these pressures for each fiber angle, of a bend for each inner radius, and for bounds of the wall.
    pub(super) fn geometries(&self, segment: usize, shares: &[f64]) -> Vec<Vec<f64>> {
        self.segments[segment].best_of_each(shares)
    }

    /// The best geometries of one segment at these pressures, at most so many, between rows by interpolation.
    pub(super) fn between(&self, segment: usize, shares: &[f64], most: usize) -> Vec<Vec<f64>> {
        self.segments[segment].best_between(shares, most)
    }

    /// Geometries and shares of the pressures that no other level of a single phase makes better, the best first, each once.
    pub(super) fn starting_points(&self, random: &mut Random) -> Vec<Vec<f64>> {
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        let rows: usize = self.segments.iter().map(|rows| rows.rows.len()).sum();
        for _ in 0..TRIALS.min(WORK / (rows * self.phases.pow(2)).max(1)) {
            let scale = random.uniform();
            let level = |share: f64| (share * scale * INTERVALS as f64).round() / INTERVALS as f64;
            let shares = random.point(self.phases).into_iter().map(level).collect();
            let (left, shares) = self.improved(shares);
            if left.is_finite() && !found.iter().any(|(_, known)| *known == shares) {
                found.push((left, shares));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().filter_map(|(_, shares)| self.point(&shares)).collect()
    }

    /// What is left at the levels that no other level of a single phase makes better.
    fn improved(&self, mut shares: Vec<f64>) -> (f64, Vec<f64>) {
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            let before = least;
            for phase in 0..self.phases {
                let others: f64 =
                    (0..self.phases).filter(|other| *other != phase).map(|other| shares[other].powi(2)).sum();
                let squared = |level: usize| (level as f64 / INTERVALS as f64).powi(2);
                let mut left: [f64; INTERVALS + 1] =
                    std::array::from_fn(|level| self.effort * (others + squared(level)));
                for rows in &self.segments {
                    left.iter_mut().zip(rows.by_level(&shares, phase)).for_each(|(sum, own)| *sum += own);
                }
                if let Some(best) = (0..left.len()).min_by(|a, b| left[*a].total_cmp(&left[*b])) {
                    (least, shares[phase]) = (left[best], best as f64 / INTERVALS as f64);
                }
            }
            if least >= before {
                break;
            }
        }
        (least, shares)
    }

    /// The best geometries at shares of the highest pressure, and the shares; `None` where a segment has none.
    pub(super) fn point(&self, shares: &[f64]) -> Option<Vec<f64>> {
        let mut point = Vec::new();
        for rows in &self.segments {
            point.extend(rows.best(shares)?);
        }
        point.extend(shares);
        Some(point)
    }
}
