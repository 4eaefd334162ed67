//! Segments on one supply line: one pressure a phase for all of them, so that geometry and pressures are searched together.
//!
//! A pressure is searched as a share of the highest one of the bounds. The margins to the limit points are constraints,
//! `c = (P - (1 - margin) P_limit)/P_max <= 0` for each phase and each segment, by the augmented Lagrangian: rows
//! `sqrt(rho) max(0, c + m)` are added to the least squares, and after each solve `m` becomes `max(0, c + m)`. So a limit point is
//! solved for only where a pressure is near it, and where several segments are at their margins at once the objective has no kink.

use fra_model::State;

use super::actuator::{Candidate, Cap, Counts};
use super::problem::{Goal, Problem, Segment};
use super::search::Counted;
use super::slopes::slopes;
use softlimb_numerics::least_squares::{LeastSquares, sum_of_squares};

/// `rho` of a start as a multiple of its objective: a solve ends about its inverse beyond a margin.
pub(super) const STIFFNESS: f64 = 1e3;

/// The least squares of a limb with one pressure: the geometry of every segment, then the share of every phase.
pub(super) struct Shared<'a> {
    pub(super) segments: &'a [Segment],
    pub(super) counts: Counts,
    /// The highest pressure that the bounds of all segments allow, Pa.
    pub(super) highest_pa: f64,
    /// Shares of the pressures that are no variables.
    fixed: Option<Vec<f64>>,
    rho: f64,
    /// A multiplier over `rho` for each segment and phase in turn.
    multipliers: Vec<f64>,
    /// The least objective of all descents so far.
    pub(super) least: f64,
}

/// Geometries with pressures.
pub(super) struct Line<'a> {
    candidates: Vec<Candidate<'a>>,
    /// The caps that a pressure is near to or above.
    pub(super) caps: Vec<Option<Cap>>,
    pub(super) pressures_pa: Vec<f64>,
    /// A state for each segment and phase in turn.
    pub(super) states: Vec<State<f64>>,
    /// The segment whose pressures are explicit, its deformations given.
    pub(super) explicit: Option<usize>,
    pub(super) place: Vec<f64>,
}

impl Line<'_> {
    /// The states of a segment by phase.
    pub(super) fn states_of(&self, segment: usize) -> &[State<f64>] {
        let phases = self.pressures_pa.len();
        &self.states[segment * phases..(segment + 1) * phases]
    }

    /// The highest of the pressures, Pa.
    pub(super) fn highest_pa(&self) -> f64 {
        self.pressures_pa.iter().copied().fold(0.0, f64::max)
    }

    /// Pressure above a segment's cap, Pa; negative below it.
    fn excess_pa(&self, segment: usize, phase: usize) -> f64 {
        self.caps[segment].map_or(f64::NEG_INFINITY, |cap| self.pressures_pa[phase] - cap.pressure_pa)
    }
}

impl<'a> Shared<'a> {
    pub(super) fn new(problem: &'a Problem) -> Self {
        let highest_pa = problem.segments.iter().map(|segment| segment.pressure_max_pa).fold(f64::INFINITY, f64::min);
        Self::of(&problem.segments, highest_pa, None)
    }

    fn of(segments: &'a [Segment], highest_pa: f64, fixed: Option<Vec<f64>>) -> Self {
        let multipliers = segments.iter().flat_map(|segment| segment.goals.iter().map(|_| 0.0)).collect();
        Self { segments, counts: Counts::default(), highest_pa, fixed, rho: 0.0, multipliers, least: f64::INFINITY }
    }

    /// One segment at pressures that are given as shares of the highest one.
    pub(super) fn alone(&self, segment: usize, shares: &[f64]) -> Self {
        Self::of(&self.segments[segment..=segment], self.highest_pa, Some(shares.to_vec()))
    }

    /// What a segment alone has cost: an evaluation of the limb is one of each.
    pub(super) fn add(&mut self, alone: Counts) {
        self.counts += Counts { evaluations: alone.evaluations.div_ceil(self.segments.len() as u64), ..alone };
    }

    /// The least squares at a point; infinite where there is no equilibrium.
    pub(super) fn objective_at(&mut self, point: &[f64]) -> f64 {
        self.evaluate(point).map_or(f64::INFINITY, |line| sum_of_squares(&self.differences(&line)))
    }

    fn phases(&self) -> usize {
        self.segments.first().map_or(0, |segment| segment.goals.len())
    }

    /// Variables of the geometry, all segments.
    pub(super) fn dimensions(&self) -> usize {
        self.segments.iter().map(|segment| segment.dimensions()).sum()
    }

    fn candidates(&self, place: &[f64]) -> Option<Vec<Candidate<'a>>> {
        let mut rest = place;
        let mut candidate = |segment: &'a Segment| {
            let (here, others) = rest.split_at(segment.dimensions());
            rest = others;
            Candidate::new(segment, here)
        };
        self.segments.iter().map(&mut candidate).collect()
    }

    /// A start at a geometry with shares of the highest pressure there.
    pub(super) fn start(&mut self, mut point: Vec<f64>, shares: Vec<f64>) -> Option<Vec<f64>> {
        let most = self.most(&point)?;
        point.extend(shares.iter().map(|share| share * most));
        self.begin(point)
    }

    /// A start at a geometry with shares of the highest pressure of the bounds; those above a cap are lowered to it.
    pub(super) fn start_at(&mut self, mut point: Vec<f64>) -> Option<Vec<f64>> {
        let shares = point.split_off(self.dimensions());
        let most = self.most(&point)?;
        point.extend(shares.iter().map(|share| share.min(most)));
        self.begin(point)
    }

    /// The highest pressure at a geometry, as a share of that of the bounds.
    fn most(&mut self, place: &[f64]) -> Option<f64> {
        self.counts.evaluations += 1;
        let mut highest = self.highest_pa;
        for candidate in &self.candidates(place)? {
            highest = candidate.cap_below(highest, &mut self.counts)?.map_or(highest, |cap| cap.pressure_pa);
        }
        Some(highest / self.highest_pa)
    }

    /// Multipliers and penalty begin anew.
    pub(super) fn begin(&mut self, point: Vec<f64>) -> Option<Vec<f64>> {
        self.multipliers.fill(0.0);
        self.rho = 0.0;
        let line = self.evaluate(&point)?;
        self.rho = STIFFNESS * sum_of_squares(&self.differences(&line));
        Some(point)
    }

    /// Eq. (14) without the constraints: goals, and with an effort the pressures.
    pub(super) fn differences(&self, line: &Line<'a>) -> Vec<f64> {
        let mut states = line.states.iter();
        let found = line
            .candidates
            .iter()
            .flat_map(|candidate| candidate.segment.goals.iter().map(move |goal| (candidate, goal)));
        let goals = found.zip(&mut states).map(|((candidate, goal), state)| difference(goal, candidate.measure(state)));
        let effort_per_pa = self.effort_per_pa();
        let pressures = line.pressures_pa.iter().filter(|_| effort_per_pa > 0.0);
        goals.chain(pressures.map(|pressure| effort_per_pa * pressure)).collect()
    }

    /// The factor of a pressure in its row of the effort.
    fn effort_per_pa(&self) -> f64 {
        self.segments.iter().map(|segment| segment.effort_per_pa2).sum::<f64>().sqrt()
    }

    /// `c + m` of a segment and a phase.
    fn pressed(&self, line: &Line<'a>, segment: usize, phase: usize) -> f64 {
        line.excess_pa(segment, phase) / self.highest_pa + self.multipliers[segment * self.phases() + phase]
    }

    fn margins(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let phases = self.phases();
        (0..self.segments.len()).flat_map(move |segment| (0..phases).map(move |phase| (segment, phase)))
    }

    /// Updates the multipliers; the largest violation, as a share of the highest pressure.
    pub(super) fn update(&mut self, line: &Line<'a>) -> f64 {
        let mut worst: f64 = 0.0;
        let pressed: Vec<f64> = self.margins().map(|(i, k)| self.pressed(line, i, k).max(0.0)).collect();
        for (before, after) in self.multipliers.iter_mut().zip(pressed) {
            worst = worst.max((after - *before).abs());
            *before = after;
        }
        worst
    }

    /// Changes `rho`, the multipliers themselves unchanged.
    pub(super) fn stiffen(&mut self, rho: f64) {
        self.multipliers.iter_mut().for_each(|multiplier| *multiplier *= self.rho / rho);
        self.rho = rho;
    }

    /// Eq. (14) with no pressure above a cap; `None` where the model does not know one.
    pub(super) fn allowed(&mut self, line: &Line<'a>) -> Option<(f64, Line<'a>)> {
        for candidate in &line.candidates {
            candidate.cap(&mut self.counts)?;
        }
        let caps = line.caps.iter().flatten().map(|cap| cap.pressure_pa);
        let most = caps.fold(self.highest_pa, f64::min) / self.highest_pa;
        let mut point = self.point(line);
        point[self.dimensions()..].iter_mut().for_each(|share| *share = share.min(most));
        self.multipliers.fill(0.0);
        let evaluation = self.evaluate(&point)?;
        Some((sum_of_squares(&self.differences(&evaluation)), evaluation))
    }

    /// The states at a point. Of an explicit segment, which has no limit point there, they are known but for phases without a goal.
    pub(super) fn line(
        &mut self,
        point: &[f64],
        explicit: Option<(usize, Vec<Option<State<f64>>>)>,
    ) -> Option<Line<'a>> {
        self.counts.evaluations += 1;
        let (place, shares) = point.split_at(self.dimensions());
        let shares = self.fixed.as_deref().unwrap_or(shares);
        let candidates = self.candidates(place)?;
        let pressures_pa: Vec<f64> = shares.iter().map(|share| share * self.highest_pa).collect();
        let (mut states, mut caps) = (Vec::new(), Vec::new());
        let multipliers = self.multipliers.chunks(pressures_pa.len());
        for (index, (candidate, multipliers)) in candidates.iter().zip(multipliers).enumerate() {
            let known = explicit.as_ref().filter(|explicit| explicit.0 == index).map(|explicit| &explicit.1);
            caps.push(match known {
                // The bound of the pressures, which the box of deformations does not have.
                Some(_) => Some(Cap { pressure_pa: self.highest_pa, limit: None }),
                None => {
                    let near = pressures_pa.iter().zip(multipliers).map(|(pressure, m)| pressure + m * self.highest_pa);
                    candidate.cap_below(near.fold(0.0, f64::max), &mut self.counts)?
                }
            });
            for (phase, pressure_pa) in pressures_pa.iter().enumerate() {
                let known = known.and_then(|states| states[phase]);
                states.push(known.or_else(|| candidate.at(*pressure_pa, &mut self.counts))?);
            }
        }
        let explicit = explicit.map(|explicit| explicit.0);
        Some(Line { candidates, caps, pressures_pa, states, explicit, place: place.to_vec() })
    }

    /// The point of an evaluation.
    pub(super) fn point(&self, line: &Line<'a>) -> Vec<f64> {
        let shares = line.pressures_pa.iter().map(|pressure_pa| pressure_pa / self.highest_pa);
        line.place.iter().copied().chain(shares).collect()
    }
}

/// The difference of one goal, with the root of its weight.
fn difference(goal: &Option<Goal>, found: f64) -> f64 {
    goal.map_or(0.0, |goal| goal.weight.sqrt() * (found - goal.value))
}

impl Counted for Shared<'_> {
    fn counts(&self) -> Counts {
        self.counts
    }

    fn is_allowed(&self, line: &Self::Evaluation) -> bool {
        self.margins().all(|(segment, phase)| line.excess_pa(segment, phase) <= 0.0)
    }
}

impl<'a> LeastSquares for Shared<'a> {
    type Evaluation = Line<'a>;

    fn evaluate(&mut self, point: &[f64]) -> Option<Line<'a>> {
        self.line(point, None)
    }

    fn residuals(&self, line: &Line<'a>) -> Vec<f64> {
        let mut residuals = self.differences(line);
        let root = self.rho.sqrt();
        residuals.extend(self.margins().map(|(i, k)| root * self.pressed(line, i, k).max(0.0)));
        residuals
    }

    fn jacobian(&mut self, line: &Line<'a>) -> Option<Vec<Vec<f64>>> {
        self.counts.evaluations += 1;
        let (geometry, phases) = (self.dimensions(), line.pressures_pa.len());
        let (mut goals, mut margins) = (Vec::new(), Vec::new());
        let (mut first, root) = (0, self.rho.sqrt());
        for (index, candidate) in line.candidates.iter().enumerate() {
            let width = candidate.segment.dimensions();
            let place = &line.place[first..first + width];
            let is_explicit = candidate.segment.bends_without_limit() || line.explicit == Some(index);
            let slopes = slopes(candidate, place, line.states_of(index), is_explicit, &mut self.counts)?;
            for (phase, goal) in candidate.segment.goals.iter().enumerate() {
                let mut row = vec![0.0; geometry + phases];
                let scale = goal.map_or(0.0, |goal| goal.weight.sqrt());
                (0..width).for_each(|i| row[first + i] = scale * slopes[phase].by_place[i]);
                row[geometry + phase] = scale * slopes[phase].by_pressure * self.highest_pa;
                goals.push(row);
            }
            let is_pressed: Vec<bool> = (0..phases).map(|phase| self.pressed(line, index, phase) > 0.0).collect();
            let moved = match line.caps[index].filter(|_| is_pressed.contains(&true)) {
                Some(cap) => candidate.cap_by_place(&cap, &mut self.counts)?,
                None => [0.0; 4],
            };
            for (phase, is_pressed) in is_pressed.into_iter().enumerate() {
                let mut row = vec![0.0; geometry + phases];
                if is_pressed {
                    (0..width).for_each(|i| row[first + i] = -root * moved[i] / self.highest_pa);
                    row[geometry + phase] = root;
                }
                margins.push(row);
            }
            first += width;
        }
        let effort_per_pa = self.effort_per_pa();
        for phase in (0..phases).filter(|_| effort_per_pa > 0.0) {
            let mut row = vec![0.0; geometry + phases];
            row[geometry + phase] = effort_per_pa * self.highest_pa;
            goals.push(row);
        }
        goals.append(&mut margins);
        if self.fixed.is_some() {
            goals.iter_mut().for_each(|row| row.truncate(geometry));
        }
        Some(goals)
    }
}
