//! The pressures of a geometry where pressure has a price.
//!
//! A phase then has two residuals, `sqrt(w) (q - q^)` and `sqrt(k) P`, and its pressure is the least minimum of the sum of their squares,
//!
//! ```text
//! w (q - q^) dq/dP + k P = 0        inside,     dP/dx = -w q' dq/dx/(w q'^2 + k)
//! ```
//!
//! with `q' = dq/dP`. This `dP/dx` is that of Gauss-Newton: it leaves out second derivatives. The gradient of the objective is exact all
//! the same, because it does not depend on `dP/dx` there.

use fra_model::State;

use super::actuator::Counts;
use super::problem::Goal;
use super::reach::{Held, Phase, Reach, Separate, Span};

/// Intervals of the pressure range, or of a bend, in which the least minimum is looked for.
const INTERVALS: usize = 16;
/// Most steps to a minimum.
const STEPS: usize = 60;
/// Pressures as near as this share of the highest one are one.
const SAME: f64 = 1e-14;

impl<'a> Span<'a> {
    /// Finds the pressures, each with its price.
    pub(super) fn reach_with_effort(self, counts: &mut Counts) -> Option<Reach<'a>> {
        let goals = self.candidate.segment.goals.iter().map(|goal| goal.as_ref().filter(|goal| goal.weight > 0.0));
        let goals: Vec<Option<&Goal>> = goals.collect();
        let levels = if goals.iter().any(Option::is_some) { self.levels(counts)? } else { Vec::new() };
        let phase =
            |goal: &Option<&Goal>| goal.map_or_else(|| Some(self.idle()), |goal| self.priced(goal, &levels, counts));
        let phases = goals.iter().map(phase).collect::<Option<Vec<_>>>()?;
        Some(Reach { candidate: self.candidate, cap: self.cap, phases })
    }

    /// States from rest to the highest pressure that may be worth its price.
    fn levels(&self, counts: &mut Counts) -> Option<Vec<State<f64>>> {
        let mut levels = vec![self.candidate.actuator.rest()];
        let share = |index: usize| index as f64 / INTERVALS as f64;
        if let Some((value, largest)) = self.largest {
            // More than the largest bend serves no goal, and the pressure of a bend is explicit.
            for index in 1..INTERVALS {
                levels.push(self.candidate.inverse(share(index) * value, counts)?);
            }
            levels.push(largest);
            return Some(levels);
        }
        let highest = self.ends?[1];
        for index in 1..INTERVALS {
            levels.push(self.candidate.at(share(index) * self.cap.pressure_pa, counts)?);
        }
        levels.push(highest);
        Some(levels)
    }

    /// The pressure of the least sum of term and price.
    fn priced(&self, goal: &Goal, levels: &[State<f64>], counts: &mut Counts) -> Option<Phase> {
        let price = self.candidate.segment.effort_per_pa2;
        let cost = |state: &State<f64>| {
            goal.weight * (self.candidate.measure(state) - goal.value).powi(2) + price * state.pressure_pa.powi(2)
        };
        // Half the derivative of that by the pressure.
        let slope = |state: &State<f64>, counts: &mut Counts| {
            let away = self.candidate.measure(state) - goal.value;
            Some(goal.weight * away * self.candidate.by_pressure(state, counts)? + price * state.pressure_pa)
        };
        let last = levels.len() - 1;
        let best = (0..=last).min_by(|a, b| cost(&levels[*a]).total_cmp(&cost(&levels[*b])))?;
        let here = slope(&levels[best], counts)?;
        let (low, high) = match here {
            here if here >= 0.0 && best == 0 => return Some(self.at(&levels[0], goal, Held::Rest)),
            here if here <= 0.0 && best == last => return Some(self.at(&levels[last], goal, Held::Highest)),
            here if here > 0.0 => (best - 1, best),
            _ => (best, best + 1),
        };
        let mut states = [levels[low], levels[high]];
        let mut slopes = [slope(&states[0], counts)?, slope(&states[1], counts)?];
        // Regula falsi, a kept end at half its slope (Illinois).
        let mut kept = None;
        for _ in 0..STEPS {
            let [from, to] = states.map(|state| state.pressure_pa);
            let falsi = from - slopes[0] * (to - from) / (slopes[1] - slopes[0]);
            let inside = slopes[0] < 0.0 && slopes[1] > 0.0 && falsi > from && falsi < to;
            let pressure_pa = if inside { falsi } else { 0.5 * (from + to) };
            if to - from <= SAME * self.cap.pressure_pa || pressure_pa <= from || pressure_pa >= to {
                break;
            }
            let middle = self.candidate.at(pressure_pa, counts)?;
            let found = slope(&middle, counts)?;
            let end = usize::from(found > 0.0);
            (states[end], slopes[end]) = (middle, found);
            if found == 0.0 {
                break;
            }
            if kept == Some(1 - end) {
                slopes[1 - end] *= 0.5;
            }
            kept = Some(1 - end);
        }
        let found = [states[0], states[1], levels[best]].into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
        Some(self.at(&found, goal, Held::Balanced))
    }
}

impl Reach<'_> {
    /// The derivatives of both residuals of a phase by the geometry.
    fn rows_with_effort(&self, phase: &Phase, goal: &Goal, counts: &mut Counts) -> Option<[[f64; 4]; 2]> {
        let price = self.candidate.segment.effort_per_pa2;
        if phase.held == Held::Free {
            return Some([[0.0; 4]; 2]);
        }
        let by_place = self.candidate.by_place(&phase.state, counts)?;
        let mut by_pressure = 0.0;
        let mut moved = [0.0; 4];
        if phase.held == Held::Balanced || (phase.held == Held::Highest && self.cap.limit.is_some()) {
            by_pressure = self.candidate.by_pressure(&phase.state, counts)?;
            let share = -goal.weight * by_pressure / (goal.weight * by_pressure.powi(2) + price);
            moved = match phase.held {
                Held::Highest => self.candidate.cap_by_place(&self.cap, counts)?,
                _ => by_place.map(|slope| share * slope),
            };
        }
        let of_goal = std::array::from_fn(|i| goal.weight.sqrt() * (by_place[i] + by_pressure * moved[i]));
        Some([of_goal, moved.map(|slope| price.sqrt() * slope)])
    }
}

impl Separate<'_> {
    /// Rows of all goals, then of all pressures.
    pub(super) fn jacobian_with_effort(&mut self, reach: &Reach) -> Option<Vec<Vec<f64>>> {
        let (mut goals, mut pressures) = (Vec::new(), Vec::new());
        for (phase, goal) in reach.phases.iter().zip(&self.segment.goals) {
            let rows = goal.map(|goal| reach.rows_with_effort(phase, &goal, &mut self.counts));
            let [of_goal, of_pressure] =
                rows.unwrap_or(Some([[0.0; 4]; 2]))?.map(|row| row[..self.segment.dimensions()].to_vec());
            goals.push(of_goal);
            pressures.push(of_pressure);
        }
        goals.append(&mut pressures);
        Some(goals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuators::kinds::wide_line;
    use softlimb_numerics::least_squares::{LeastSquares, sum_of_squares};

    #[test]
    fn gradient_is_that_of_differences() {
        let mut compared = [0; 3];
        for seed in 0..12 {
            for segment in wide_line(seed).segments() {
                let mut segment = segment.clone();
                let sizes = segment.goals.iter().flatten().map(|goal| goal.weight * goal.value.powi(2));
                segment.effort_per_pa2 = 0.02 * sizes.sum::<f64>() / segment.pressure_max_pa.powi(2);
                let mut problem = Separate { segment: &segment, counts: Counts::default() };
                let place = &[0.4, 0.6, 0.3, 0.2][..segment.dimensions()];
                let Some(here) = problem.evaluate(place) else { continue };
                let held = |reach: &Reach| reach.phases.iter().map(|phase| phase.held).collect::<Vec<_>>();
                let (rows, residuals) = (problem.jacobian(&here).unwrap(), problem.residuals(&here));
                for axis in 0..segment.dimensions() {
                    let mut at = |by: f64| {
                        let mut there = place.to_vec();
                        there[axis] += by;
                        let there = problem.evaluate(&there)?;
                        (held(&there) == held(&here)).then(|| sum_of_squares(&problem.residuals(&there)))
                    };
                    let (Some(below), Some(above)) = (at(-1e-5), at(1e-5)) else { continue };
                    let slope = (above - below) / 2e-5;
                    let exact =
                        2.0 * rows.iter().zip(&residuals).map(|(row, residual)| row[axis] * residual).sum::<f64>();
                    let size = sum_of_squares(&residuals);
                    assert!((slope - exact).abs() < 1e-6 * size, "{seed} {:?} {axis}: {slope} {exact}", segment.motion);
                    let kinds = [Held::Rest, Held::Balanced, Held::Highest];
                    kinds
                        .iter()
                        .zip(&mut compared)
                        .for_each(|(kind, count)| *count += usize::from(held(&here).contains(kind)));
                }
            }
        }
        assert!(compared.iter().all(|count| *count > 10), "{compared:?}");
    }
}
