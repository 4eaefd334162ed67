//! Every solution of an inverse question by finite elements of the section.

use std::f64::consts::PI;

use fra_model::{Status, Target};
use softlimb_fea::cross_section::{Answer, SectionError};

use super::section_fe::{Asked, STEPS, SectionAnswer, SectionQuery, is_reached};

/// Pressures at which the curve is sampled.
const SAMPLES: usize = 64;
/// Doublings of the pressure on the way to the end of the curve.
const DOUBLINGS: i32 = 12;
/// Relative distance of pressures that are one solution.
const SAME: f64 = 1e-6;

/// Solutions at rising pressures.
pub(super) struct Every {
    /// The first of them, or why there is none.
    pub(super) first: SectionAnswer,
    pub(super) solutions: Vec<SectionAnswer>,
    /// Whether no pressure in the range has another one.
    pub(super) complete: bool,
}

/// An equilibrium, and its distance beyond the target.
#[derive(Clone, Copy)]
struct Sample {
    answer: Answer,
    miss: f64,
}

/// Every solution at 0 Pa and above, as far as samples of the curve show it.
///
/// # Errors
/// As [`solve_section`](super::section_fe::solve_section).
pub(super) fn every_by_section(query: &SectionQuery<'_>, target: Target<f64>) -> Result<Every, SectionError> {
    let mut asked = Asked::new(query)?;
    let near_analytic = asked.reach(target)?;
    asked.every(near_analytic, target)
}

impl Asked<'_> {
    /// Every solution, with that of the search from the analytic answer: it comes closer to a limit point than samples do.
    pub(super) fn every(&mut self, near_analytic: SectionAnswer, target: Target<f64>) -> Result<Every, SectionError> {
        let range = &self.query.range;
        let low_pa = range.least_pa.max(0.0);
        let high_pa = range.most_pa.min(self.section.pressure_max_pa());
        let (samples, end) =
            if low_pa <= high_pa { self.samples([low_pa, high_pa], target)? } else { (Vec::new(), None) };
        let mut solutions = self.crossings(&samples, target)?;
        let pressure_pa = |one: &SectionAnswer| one.state.map_or(f64::NAN, |state| state.pressure_pa);
        let found_pa = pressure_pa(&near_analytic);
        let is_known = |one| (pressure_pa(one) - found_pa).abs() <= SAME * found_pa;
        if near_analytic.status == Status::Solved && !solutions.iter().any(is_known) {
            solutions.push(near_analytic);
        }
        solutions.sort_by(|a, b| pressure_pa(a).total_cmp(&pressure_pa(b)));
        // Between samples there may always be more; not beyond the end of the curve.
        let ended = end.map(|end| self.found(&end));
        let is_beyond = samples.is_empty() && ended.is_some_and(|end| end.status == Status::NoSolution);
        let complete = is_beyond && solutions.is_empty() && self.query.range.least_pa >= 0.0;
        let first = solutions.first().copied().or(ended).unwrap_or_else(|| self.nothing(Status::NoSolution, None));
        Ok(Every { first: SectionAnswer { iterations: self.iterations, ..first }, solutions, complete })
    }

    /// Equilibria at rising pressures of a range, and the answer beyond the end of the curve where that comes first.
    fn samples(
        &mut self,
        [low_pa, high_pa]: [f64; 2],
        target: Target<f64>,
    ) -> Result<(Vec<Sample>, Option<Answer>), SectionError> {
        let doubled: Vec<f64> = (0..=DOUBLINGS).map(|n| high_pa * 2_f64.powi(n - DOUBLINGS)).collect();
        let end = self.along(&doubled)?.into_iter().find(|answer| answer.equilibrium().is_none());
        let end_pa = end.map_or(high_pa, |end| end.end_pa().clamp(low_pa, high_pa));
        // Closer together at both ends: at a limit point the slopes are infinite.
        let fraction = |n: usize| (0.5 * PI * n as f64 / (SAMPLES - 1) as f64).sin().powi(2);
        let pressures_pa: Vec<f64> =
            (0..SAMPLES).map(|n| (low_pa + (end_pa - low_pa) * fraction(n)).min(end_pa)).collect();
        let answers = self.along(&pressures_pa)?;
        let mut samples: Vec<Sample> = answers.iter().filter_map(|answer| self.sample(answer, target)).collect();
        // An extremum next to the target may reach across it.
        let extrema: Vec<f64> = samples.windows(3).filter_map(extremum).collect();
        for pressure_pa in extrema {
            let answer = self.at(pressure_pa)?;
            samples.extend(self.sample(&answer, target));
        }
        samples.sort_by(|a, b| a.answer.pressure_pa.total_cmp(&b.answer.pressure_pa));
        Ok((samples, end))
    }

    fn sample(&self, answer: &Answer, target: Target<f64>) -> Option<Sample> {
        Some(Sample { answer: *answer, miss: self.miss(answer, target)? })
    }

    /// The solutions at samples and between them.
    fn crossings(&mut self, samples: &[Sample], target: Target<f64>) -> Result<Vec<SectionAnswer>, SectionError> {
        let mut solutions = Vec::new();
        let mut before: Option<&Sample> = None;
        for sample in samples {
            let is_new = !before.is_some_and(|before| is_reached(before.miss, target));
            if is_new && is_reached(sample.miss, target) {
                solutions.push(self.found(&sample.answer));
            } else if let Some(before) = before.filter(|before| is_new && before.miss * sample.miss < 0.0) {
                let answer = self.between(*before, *sample, target)?;
                solutions.extend(answer.map(|answer| self.found(&answer)));
            }
            before = Some(sample);
        }
        Ok(solutions)
    }

    /// The solution between samples on both sides of a target, by the Illinois method.
    fn between(&mut self, mut a: Sample, mut b: Sample, target: Target<f64>) -> Result<Option<Answer>, SectionError> {
        for _ in 0..STEPS {
            let (from_pa, to_pa) = (a.answer.pressure_pa, b.answer.pressure_pa);
            let answer = self.at((from_pa * b.miss - to_pa * a.miss) / (b.miss - a.miss))?;
            let Some(next) = self.sample(&answer, target) else { return Ok(None) };
            if is_reached(next.miss, target) {
                return Ok(Some(answer));
            }
            if next.miss * b.miss < 0.0 {
                a = b;
            } else {
                a.miss *= 0.5;
            }
            b = next;
        }
        Ok(None)
    }
}

/// Pressure of the extremum of the parabola through three samples on one side of the target, the middle one next to it.
fn extremum(samples: &[Sample]) -> Option<f64> {
    let [a, b, c] = samples else { return None };
    let is_next = a.miss * b.miss > 0.0 && b.miss * c.miss > 0.0 && b.miss.abs() < a.miss.abs().min(c.miss.abs());
    let [from_pa, at_pa, to_pa] = [a, b, c].map(|sample| sample.answer.pressure_pa);
    let [before, after] = [(b.miss - a.miss) / (at_pa - from_pa), (c.miss - b.miss) / (to_pa - at_pa)];
    let curvature = (after - before) / (to_pa - from_pa);
    let pressure_pa = 0.5 * (from_pa + at_pa - before / curvature);
    (is_next && pressure_pa > from_pa && pressure_pa < to_pa).then_some(pressure_pa)
}
