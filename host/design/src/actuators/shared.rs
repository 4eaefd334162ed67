//! Segments on one supply line: one pressure a phase for all of them, so that geometry and pressures are searched together.
//!
//! A pressure is searched as a share of the highest one that every segment may be given at its geometry: every place of the unit box is
//! then within the margin to the limit points, and the bound moves with the geometry as it does in truth.

use fra_model::State;

use super::actuator::{Candidate, Cap, Counts};
use super::problem::{Goal, Problem};
use super::search::Counted;
use softlimb_numerics::least_squares::LeastSquares;

/// The least squares of a limb with one pressure: the geometry of every segment, then the share of every phase.
pub(super) struct Shared<'a> {
    pub(super) problem: &'a Problem,
    pub(super) counts: Counts,
}

/// Geometries with pressures.
pub(super) struct Line<'a> {
    candidates: Vec<Candidate<'a>>,
    caps: Vec<Cap>,
    /// The segment whose cap is the least.
    least: usize,
    pub(super) pressures_pa: Vec<f64>,
    /// A state for each segment and phase in turn.
    states: Vec<State<f64>>,
    shares: Vec<f64>,
}

impl<'a> Shared<'a> {
    /// Variables of the geometry, all segments.
    pub(super) fn dimensions(&self) -> usize {
        self.problem.segments.iter().map(|segment| segment.dimensions()).sum()
    }

    fn candidates(&mut self, place: &[f64]) -> Option<(Vec<Candidate<'a>>, Vec<Cap>)> {
        let mut rest = place;
        let mut candidates = Vec::new();
        let mut caps = Vec::new();
        for segment in &self.problem.segments {
            let (here, others) = rest.split_at(segment.dimensions());
            let candidate = Candidate::new(segment, here)?;
            caps.push(candidate.cap(&mut self.counts)?);
            candidates.push(candidate);
            rest = others;
        }
        Some((candidates, caps))
    }

    /// Shares to begin with at a geometry: the mean of what the segments would choose for themselves.
    pub(super) fn shares(&mut self, place: &[f64]) -> Option<Vec<f64>> {
        self.counts.evaluations += 1;
        let (candidates, caps) = self.candidates(place)?;
        let cap = caps.iter().map(|cap| cap.pressure_pa).fold(f64::INFINITY, f64::min);
        let mut shares = Vec::new();
        for phase in 0..self.problem.phases() {
            let (mut sum, mut count) = (0.0, 0.0);
            for candidate in &candidates {
                let goal = candidate.segment.goals[phase].filter(|goal| goal.weight > 0.0);
                let Some(state) = goal.and_then(|goal| candidate.inverse(goal.value, &mut self.counts)) else {
                    continue;
                };
                sum += (state.pressure_pa / cap).clamp(0.0, 1.0);
                count += 1.0;
            }
            shares.push(if count > 0.0 { sum / count } else { 0.5 });
        }
        Some(shares)
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
}

impl<'a> LeastSquares for Shared<'a> {
    type Evaluation = Line<'a>;

    fn evaluate(&mut self, point: &[f64]) -> Option<Line<'a>> {
        self.counts.evaluations += 1;
        let shares = point[self.dimensions()..].to_vec();
        let (candidates, caps) = self.candidates(point)?;
        let least = (0..caps.len()).min_by(|a, b| caps[*a].pressure_pa.total_cmp(&caps[*b].pressure_pa))?;
        let pressures_pa: Vec<f64> = shares.iter().map(|share| share * caps[least].pressure_pa).collect();
        let mut states = Vec::new();
        for candidate in &candidates {
            for pressure_pa in &pressures_pa {
                states.push(candidate.at(*pressure_pa, &mut self.counts)?);
            }
        }
        Some(Line { candidates, caps, least, pressures_pa, states, shares })
    }

    fn residuals(&self, line: &Line<'a>) -> Vec<f64> {
        let mut states = line.states.iter();
        let found = line
            .candidates
            .iter()
            .flat_map(|candidate| candidate.segment.goals.iter().map(move |goal| (candidate, goal)));
        found.zip(&mut states).map(|((candidate, goal), state)| difference(goal, candidate.measure(state))).collect()
    }

    fn jacobian(&mut self, line: &Line<'a>) -> Option<Vec<Vec<f64>>> {
        self.counts.evaluations += 1;
        let (geometry, phases) = (self.dimensions(), line.shares.len());
        let cap = line.caps[line.least];
        let moved = line.candidates[line.least].cap_by_place(&cap, &mut self.counts)?;
        let offset = |index: usize| line.candidates[..index].iter().map(|c| c.segment.dimensions()).sum::<usize>();
        let mut rows = Vec::new();
        for (index, candidate) in line.candidates.iter().enumerate() {
            for (phase, goal) in candidate.segment.goals.iter().enumerate() {
                let mut row = vec![0.0; geometry + phases];
                if let Some(goal) = goal.filter(|goal| goal.weight > 0.0) {
                    let state = &line.states[index * phases + phase];
                    let scale = goal.weight.sqrt();
                    let by_place = candidate.by_place(state, &mut self.counts)?;
                    let by_pressure = candidate.by_pressure(state, &mut self.counts)?;
                    let own = offset(index);
                    (0..candidate.segment.dimensions()).for_each(|i| row[own + i] += scale * by_place[i]);
                    let least = offset(line.least);
                    let by_cap = scale * by_pressure * line.shares[phase];
                    (0..line.candidates[line.least].segment.dimensions())
                        .for_each(|i| row[least + i] += by_cap * moved[i]);
                    row[geometry + phase] = scale * by_pressure * cap.pressure_pa;
                }
                rows.push(row);
            }
        }
        Some(rows)
    }
}
