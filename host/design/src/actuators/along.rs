//! Local solves of a limb on one supply line along the edge of a segment.
//!
//! A segment whose limit point is about to vanish deforms most for little pressure, and the best design may be there. Across the
//! [`edge`](super::edge) the limit point bounds the pressure at once, and the objective jumps: a local solve stops wherever it meets the
//! edge. So one variable `x_k` follows from the others along the edge, as on the [`ridge`](super::ridge). Near the edge
//! `dq/dP` is large, so the segment's deformations `q` replace its pressures `P(x, q)` as variables. The remaining problem is smooth,
//!
//! ```text
//! dr/dx_j = (dr/dx_j)_g + (dr/dx_k)_g dx_k/dx_j + (dr/dP) (dP/dx_j)_q,     dr/dq = (dr/dP) (dP/dq)_x
//! ```

use super::actuator::Candidate;
use super::edge::Edge;
use super::problem::{Goal, Segment};
use super::settle::{OnLine, settle};
use super::shared::{Line, Shared};
use softlimb_numerics::least_squares::{LeastSquares, Minimum, StoppingCriteria, sum_of_squares};

/// The least squares of a limb with one segment on its edge: all geometries but one variable, then the deformations of the segment.
struct Along<'l, 'a> {
    limb: &'l mut Shared<'a>,
    /// The segment on the edge.
    index: usize,
    /// Its first variable.
    first: usize,
    edge: Edge<'a>,
    /// Deformation at 0 in the unit box, and from there to 1.
    scale: [f64; 2],
}

impl<'a> Along<'_, 'a> {
    fn segment(&self) -> &'a Segment {
        &self.limb.segments[self.index]
    }

    fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.segment().dimensions()
    }

    /// The goal of a phase, where it has a weight.
    fn goal(&self, phase: usize) -> Option<&'a Goal> {
        self.segment().goals[phase].as_ref().filter(|goal| goal.weight > 0.0)
    }

    /// The variables of a limb, and the scale of the deformations.
    fn start(&mut self, line: &Line<'a>) -> Option<Vec<f64>> {
        let candidate = Candidate::new(self.segment(), &line.place[self.range()])?;
        let rest = candidate.measure(&candidate.actuator.rest());
        let moved = line.states_of(self.index).iter().map(|state| candidate.measure(state) - rest);
        let farthest = moved.clone().fold(0.0, |most: f64, one| if one.abs() > most.abs() { one } else { most });
        self.scale = [rest, 2.0 * farthest];
        let mut point = self.limb.point(line);
        for (phase, moved) in moved.enumerate().filter(|(phase, _)| self.goal(*phase).is_some()) {
            point[line.place.len() + phase] = moved / self.scale[1];
        }
        point.remove(self.first + self.edge.follows);
        Some(point)
    }

    /// The minimum along the edge from a limb that it has stopped.
    fn minimum(&mut self, line: &Line<'a>, criteria: StoppingCriteria) -> Option<Minimum<Line<'a>>> {
        let point = self.start(line)?;
        let evaluation = self.evaluate(&point)?;
        let objective = sum_of_squares(&self.residuals(&evaluation));
        let found = settle(self, Minimum { point, evaluation, objective, evaluations: 1 }, criteria);
        Some(Minimum { point: self.limb.point(&found.evaluation), ..found })
    }
}

impl<'a> OnLine<'a> for Along<'_, 'a> {
    fn limb(&mut self) -> &mut Shared<'a> {
        self.limb
    }
}

impl<'a> LeastSquares for Along<'_, 'a> {
    type Evaluation = Line<'a>;

    fn evaluate(&mut self, variables: &[f64]) -> Option<Line<'a>> {
        let (geometry, highest_pa, [rest, span]) = (self.limb.dimensions(), self.limb.highest_pa, self.scale);
        let mut point = variables.to_vec();
        point.insert(self.first + self.edge.follows, self.edge.value());
        let range = self.range();
        self.edge.meet(&mut point[range.clone()], &mut self.limb.counts)?;
        let candidate = Candidate::new(self.segment(), &point[range])?;
        let mut states = Vec::new();
        for (phase, variable) in point[geometry..].iter_mut().enumerate() {
            states.push(match self.goal(phase) {
                Some(_) => {
                    let state = candidate.inverse(rest + span * *variable, &mut self.limb.counts)?;
                    (state.pressure_pa >= 0.0).then_some(())?;
                    *variable = state.pressure_pa / highest_pa;
                    Some(state)
                }
                None => None,
            });
        }
        self.limb.line(&point, Some((self.index, states)))
    }

    fn residuals(&self, line: &Line<'a>) -> Vec<f64> {
        self.limb.residuals(line)
    }

    fn jacobian(&mut self, line: &Line<'a>) -> Option<Vec<Vec<f64>>> {
        let (range, following) = (self.range(), self.first + self.edge.follows);
        self.edge.find_slopes(&line.place[range.clone()], &mut self.limb.counts)?;
        let mut rows = self.limb.jacobian(line)?;
        for row in &mut rows {
            let by_following = row[following];
            row[range.clone()]
                .iter_mut()
                .enumerate()
                .for_each(|(axis, row)| *row += by_following * self.edge.slope(axis));
            row.remove(following);
        }
        let (phases, geometry) = (line.pressures_pa.len(), self.limb.dimensions());
        for phase in 0..phases {
            let Some(goal) = self.goal(phase) else { continue };
            let column = geometry - 1 + phase;
            let own = rows[self.index * phases + phase].clone();
            for row in &mut rows {
                let by_own = row[column] / own[column];
                row[column] = by_own * goal.weight.sqrt() * self.scale[1];
                (0..column).for_each(|i| row[i] -= by_own * own[i]);
            }
        }
        Some(rows)
    }
}

/// The edge that has stopped a local solve; `None` where none has.
fn stopped<'l, 'a>(limb: &'l mut Shared<'a>, line: &Line<'a>) -> Option<Along<'l, 'a>> {
    let mut first = 0;
    for (index, segment) in limb.segments.iter().enumerate() {
        let place = &line.place[first..first + segment.dimensions()];
        let has_limit = line.caps[index].is_some_and(|cap| cap.limit.is_some());
        if !has_limit && !segment.bends_without_limit() {
            let edge = Edge::beside(segment, place, line.highest_pa(), limb.highest_pa, &mut limb.counts);
            if let Some(edge) = edge {
                return Some(Along { limb, index, first, edge, scale: [0.0, 1.0] });
            }
        }
        first += place.len();
    }
    None
}

/// The minimum along an edge that has stopped a local solve; `None` where none has.
pub(super) fn along<'a>(
    limb: &mut Shared<'a>,
    line: &Line<'a>,
    criteria: StoppingCriteria,
) -> Option<Minimum<Line<'a>>> {
    stopped(limb, line)?.minimum(line, criteria)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuators::actuator::Counts;
    use crate::actuators::edge::between;
    use crate::actuators::kinds::wide_line;

    #[test]
    fn jacobian_is_that_of_differences() {
        let problem = wide_line(12);
        let mut limb = Shared::new(&problem);
        let sides = [0.75, 1.0].map(|angle| vec![0.1, 0.4, 0.5, angle]);
        let mut point = between(&problem.segments()[0], sides, 120e3, 120e3, &mut Counts::default()).unwrap();
        point.extend([0.4, 0.3, 0.5, 0.2, 0.86, 0.9, 0.8]);
        let point = limb.begin(point).unwrap();
        let line = limb.evaluate(&point).unwrap();
        let mut along = stopped(&mut limb, &line).unwrap();
        let variables = along.start(&line).unwrap();
        let here = along.evaluate(&variables).unwrap();
        assert!(here.pressures_pa.iter().zip(&line.pressures_pa).all(|(a, b)| (a / b - 1.0).abs() < 1e-4));
        let rows = along.jacobian(&here).unwrap();
        for axis in 0..variables.len() {
            let mut at = |by: f64| {
                let mut there = variables.clone();
                there[axis] += by;
                let there = along.evaluate(&there).unwrap();
                along.residuals(&there)
            };
            let (below, above) = (at(-1e-4), at(1e-4));
            let most = rows.iter().fold(0.0, |most: f64, row| most.max(row[axis].abs()));
            for ((row, below), above) in rows.iter().zip(below).zip(above) {
                let slope = (above - below) / 2e-4;
                assert!((slope - row[axis]).abs() <= 1e-3 * most, "{axis}: {slope} {}", row[axis]);
            }
        }
    }
}
