//! Local solve of eq. (14) with bends by finite elements of the section, from a design that an analytic search has found.
//!
//! The factor between both models depends on the geometry, so the best geometry of the analytic model is not quite that of finite elements.
//! Derivatives are differences. Pressures that are free are eliminated; on one supply line they are fractions of the least highest one.

use std::rc::Rc;

use super::actuator::{Candidate, Counts};
use super::problem::Problem;
use super::search::Found;
use super::section::Model;
use softlimb_numerics::least_squares::{LeastSquares, StoppingCriteria, minimise};

/// Step of a difference, as a share of a variable's bounds.
const STEP: f64 = 1e-3;
/// A step that gains less is idle; three of them end the solve.
const LEAST_GAIN: f64 = 1e-5;
/// Most evaluations of a solve.
const EVALUATIONS: usize = 40;

/// Eq. (14) of all segments together.
struct Refined<'a> {
    problem: &'a Problem,
    counts: Counts,
}

/// A segment at a geometry.
struct Piece<'a> {
    candidate: Candidate<'a>,
    model: Option<Model>,
    cap_pa: f64,
}

struct Evaluation<'a> {
    point: Vec<f64>,
    pieces: Vec<Rc<Piece<'a>>>,
    pressures_pa: Vec<Vec<f64>>,
    residuals: Vec<f64>,
}

impl<'a> Refined<'a> {
    /// Where the coordinates of a segment begin, and behind them those of the pressures.
    fn first(&self, segment: usize) -> usize {
        self.problem.segments[..segment].iter().map(|segment| segment.dimensions()).sum()
    }

    fn piece(&mut self, index: usize, point: &[f64]) -> Option<Rc<Piece<'a>>> {
        let segment = &self.problem.segments[index];
        let first = self.first(index);
        let candidate = Candidate::new(segment, &point[first..first + segment.dimensions()])?;
        let analytic_pa = candidate.cap(&mut self.counts)?.pressure_pa;
        let model = Model::new(&candidate, analytic_pa);
        let section = model.as_ref().and_then(|model| model.section.as_ref());
        let cap_pa = section.map_or(analytic_pa, |section| section.cap_pa);
        Some(Rc::new(Piece { candidate, model, cap_pa }))
    }

    fn of(&mut self, point: Vec<f64>, pieces: Vec<Rc<Piece<'a>>>) -> Option<Evaluation<'a>> {
        let least_pa = pieces.iter().map(|piece| piece.cap_pa).fold(f64::INFINITY, f64::min);
        let shares = &point[self.first(pieces.len())..];
        let (mut residuals, mut efforts, mut pressures_pa) = (Vec::new(), Vec::new(), Vec::new());
        for piece in &pieces {
            let segment = piece.candidate.segment;
            let section = piece.model.as_ref().and_then(|model| model.section.as_ref());
            let per_pa = segment.effort_per_pa2.sqrt();
            let mut own_pa = Vec::with_capacity(segment.goals.len());
            for (phase, goal) in segment.goals.iter().enumerate() {
                let pressure_pa = match (shares.get(phase), section) {
                    (Some(share), _) => share * least_pa,
                    (None, Some(section)) => section.pressure_pa(goal.as_ref(), segment.effort_per_pa2),
                    (None, None) => return None,
                };
                let value = match section {
                    Some(section) => section.at(pressure_pa)?.bend_angle_rad,
                    None => piece.candidate.measure(&piece.candidate.at(pressure_pa, &mut self.counts)?),
                };
                residuals.push(goal.map_or(0.0, |goal| goal.weight.sqrt() * (value - goal.value)));
                efforts.push(per_pa * pressure_pa);
                own_pa.push(pressure_pa);
            }
            pressures_pa.push(own_pa);
        }
        residuals.append(&mut efforts);
        Some(Evaluation { point, pieces, pressures_pa, residuals })
    }
}

impl<'a> LeastSquares for Refined<'a> {
    type Evaluation = Evaluation<'a>;

    fn evaluate(&mut self, point: &[f64]) -> Option<Evaluation<'a>> {
        self.counts.evaluations += 1;
        let count = self.problem.segments.len();
        let pieces = (0..count).map(|index| self.piece(index, point)).collect::<Option<Vec<_>>>()?;
        self.of(point.to_vec(), pieces)
    }

    fn residuals(&self, evaluation: &Evaluation<'a>) -> Vec<f64> {
        evaluation.residuals.clone()
    }

    fn jacobian(&mut self, evaluation: &Evaluation<'a>) -> Option<Vec<Vec<f64>>> {
        self.counts.evaluations += 1;
        let mut rows = vec![vec![0.0; evaluation.point.len()]; evaluation.residuals.len()];
        let owners = self.problem.segments.iter().enumerate();
        let owners: Vec<usize> = owners.flat_map(|(index, segment)| vec![index; segment.dimensions()]).collect();
        for axis in 0..evaluation.point.len() {
            let step = if evaluation.point[axis] > 0.5 { -STEP } else { STEP };
            let (mut point, mut pieces) = (evaluation.point.clone(), evaluation.pieces.clone());
            point[axis] += step;
            if let Some(&owner) = owners.get(axis) {
                pieces[owner] = self.piece(owner, &point)?;
            }
            let moved = self.of(point, pieces)?;
            for (row, (after, before)) in rows.iter_mut().zip(moved.residuals.iter().zip(&evaluation.residuals)) {
                row[axis] = (after - before) / step;
            }
        }
        Some(rows)
    }
}

/// The design solved further, and the cost; `None` where that is not possible, or not needed.
pub(super) fn refined(
    problem: &Problem,
    parts: &[Found],
    models: &[Option<Model>],
    counts: &mut Counts,
) -> Option<Vec<Found>> {
    let is_by_section = |index: usize| models[index].as_ref().is_some_and(|model| model.section.is_some());
    (0..parts.len()).any(is_by_section).then_some(())?;
    if problem.shared_pressure {
        return together(problem, parts, counts);
    }
    let mut all = Vec::with_capacity(parts.len());
    for (index, found) in parts.iter().enumerate() {
        let alone = Problem { segments: vec![problem.segments[index].clone()], ..problem.clone() };
        let further = if is_by_section(index) { together(&alone, std::slice::from_ref(found), counts) } else { None };
        all.extend(further.unwrap_or_else(|| vec![found.clone()]));
    }
    Some(all)
}

fn together(problem: &Problem, parts: &[Found], counts: &mut Counts) -> Option<Vec<Found>> {
    let mut refined = Refined { problem, counts: Counts::default() };
    let mut start: Vec<f64> = parts.iter().flat_map(|found| found.point.clone()).collect();
    if problem.shared_pressure {
        let caps =
            (0..parts.len()).map(|index| Some(refined.piece(index, &start)?.cap_pa)).collect::<Option<Vec<_>>>()?;
        let least_pa = caps.into_iter().fold(f64::INFINITY, f64::min);
        start.extend(parts[0].pressures_pa.iter().map(|pressure_pa| (pressure_pa / least_pa).clamp(0.0, 1.0)));
    }
    let goals = problem.segments.iter().flat_map(|segment| segment.goals.iter().flatten());
    let scale: f64 = goals.map(|goal| goal.weight * goal.value * goal.value).sum();
    let criteria = StoppingCriteria {
        zero: 1e-12 * scale,
        least_gain: LEAST_GAIN,
        evaluations: EVALUATIONS,
        ..StoppingCriteria::default()
    };
    let minimum = minimise(&mut refined, &start, criteria);
    *counts += refined.counts;
    let minimum = minimum?;
    let mut first = 0;
    let each = parts.iter().zip(&minimum.evaluation.pressures_pa).zip(&problem.segments);
    let found = each.map(|((found, pressures_pa), segment)| {
        let from = first;
        first += segment.dimensions();
        let point = minimum.point[from..first].to_vec();
        Found { point, pressures_pa: pressures_pa.clone(), objective: minimum.objective, ..found.clone() }
    });
    Some(found.collect())
}
