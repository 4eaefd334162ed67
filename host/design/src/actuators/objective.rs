//! Eq. (14) at any geometry and pressures: what methods are asked that know nothing of the model.
//!
//! A point of the unit box is the place of every segment's geometry, segment by segment, then a share for every phase: on one supply line
//! once, otherwise for every segment in turn. A pressure is that share of the highest one its geometry may be given, so that no point is
//! ever beyond a limit point.

use super::actuator::{Candidate, Counts};
use super::answer::{Answer, DesignError, confirm};
use super::problem::Problem;
use super::search::{Found, SolveCounts};

/// Asks eq. (14) at points of the unit box.
pub struct Objective<'a> {
    problem: &'a Problem,
    counts: Counts,
    limits: Counts,
}

impl<'a> Objective<'a> {
    /// For a problem.
    pub fn new(problem: &'a Problem) -> Self {
        Self { problem, counts: Counts::default(), limits: Counts::default() }
    }

    /// Coordinates of a point.
    pub fn width(&self) -> usize {
        let geometry: usize = self.problem.segments.iter().map(|segment| segment.dimensions()).sum();
        let lines = if self.problem.shared_pressure { 1 } else { self.problem.segments.len() };
        geometry + lines * self.problem.phases()
    }

    /// What it has cost so far; without the solves for limit points, which are [`limits`](Self::limits).
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What the search for limit points has cost.
    pub fn limits(&self) -> Counts {
        self.limits
    }

    /// The weighted differences of all goals at a point, segment by segment and phase by phase, and with an effort the weighted pressures
    /// behind them; the sum of their squares is eq. (14).
    /// `point` has [`width`](Self::width) coordinates in `0..=1`. `None` where the model has no equilibrium.
    pub fn differences(&mut self, point: &[f64]) -> Option<Vec<f64>> {
        self.counts.evaluations += 1;
        let mut differences = Vec::with_capacity(self.problem.segments.len() * self.problem.phases());
        let mut efforts = Vec::new();
        for (candidate, pressures_pa) in self.candidates(point)? {
            let effort = candidate.segment.effort_per_pa2;
            efforts.extend(pressures_pa.iter().filter(|_| effort > 0.0).map(|pressure_pa| effort.sqrt() * pressure_pa));
            for (goal, pressure_pa) in candidate.segment.goals.iter().zip(pressures_pa) {
                let Some(goal) = goal else { continue };
                let found = candidate.measure(&candidate.at(pressure_pa, &mut self.counts)?);
                differences.push(goal.weight.sqrt() * (found - goal.value));
            }
        }
        differences.append(&mut efforts);
        Some(differences)
    }

    /// Eq. (14) at a point, as [`differences`](Self::differences).
    pub fn at(&mut self, point: &[f64]) -> Option<f64> {
        Some(self.differences(point)?.iter().map(|difference| difference * difference).sum())
    }

    /// The answer at a point whose value of eq. (14) is `objective`, checked by the forward model from rest.
    ///
    /// # Errors
    /// [`DesignError`] where the model has no equilibrium.
    pub fn answer(&mut self, point: &[f64], objective: f64, seed: u64) -> Result<Answer, DesignError> {
        let nowhere = || DesignError::NoEquilibrium { segment: self.problem.segments[0].name.clone() };
        let mut rest = point;
        let mut found = |(candidate, pressures_pa): (Candidate<'a>, Vec<f64>)| {
            let (place, others) = rest.split_at(candidate.segment.dimensions());
            rest = others;
            let starts = SolveCounts { made: 1, agreeing: 1 };
            Found { point: place.to_vec(), pressures_pa, objective, starts, counts: Counts::default() }
        };
        let parts: Vec<Found> = self.candidates(point).ok_or_else(nowhere)?.into_iter().map(&mut found).collect();
        let mut counts = self.counts;
        counts += self.limits;
        confirm(self.problem, &parts, counts, seed)
    }

    fn candidates(&mut self, point: &[f64]) -> Option<Vec<(Candidate<'a>, Vec<f64>)>> {
        let problem = self.problem;
        let (mut rest, mut geometries, mut least) = (point, Vec::with_capacity(problem.segments.len()), f64::INFINITY);
        for segment in &problem.segments {
            let (place, others) = rest.split_at(segment.dimensions());
            let candidate = Candidate::new(segment, place)?;
            let cap = candidate.cap(&mut self.limits)?.pressure_pa;
            least = least.min(cap);
            geometries.push((candidate, cap));
            rest = others;
        }
        let (phases, shared) = (problem.phases(), problem.shared_pressure);
        let with_pressures = |(index, (candidate, cap)): (usize, (Candidate<'a>, f64))| {
            let (first, cap) = if shared { (0, least) } else { (index * phases, cap) };
            (candidate, rest[first..first + phases].iter().map(|share| share * cap).collect())
        };
        Some(geometries.into_iter().enumerate().map(with_pressures).collect())
    }
}
