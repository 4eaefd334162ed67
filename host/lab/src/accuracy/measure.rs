//! One method over the whole set: how far off, and how much work.

use std::hint::black_box;

use fra_model::Motion;
use qd::Quad;
use serde::Serialize;

use super::method::{Method, Problem, Ready};
use super::number::Number;
use super::question::{Question, Scalar};

/// Accuracy of a method for one motion in one scalar.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// Questions the method applies to.
    pub asked: usize,
    /// Those it answered.
    #[serde(rename = "found")]
    pub solved: usize,
    /// Largest and median relative error of the answers.
    pub max_error: f64,
    /// See `max_error`.
    pub median_error: f64,
    /// Mean number of Newton steps, where there are any.
    pub steps: f64,
}

/// The methods made ready for the questions of one motion.
pub(super) struct Bench<T> {
    solvers: Vec<Ready<T>>,
}

impl<T: Scalar> Bench<T> {
    /// All questions of a motion; `None` where the method applies to none.
    pub(super) fn new(method: &Method, questions: &[Question], motion: Motion) -> Option<Self> {
        let of_motion = questions.iter().filter(|question| question.motion() == motion);
        let solvers: Vec<_> = of_motion.filter_map(|question| method.ready::<T>(question)).collect();
        (!solvers.is_empty()).then_some(Self { solvers })
    }

    pub(super) fn len(&self) -> usize {
        self.solvers.len()
    }

    /// Answers every question once.
    pub(super) fn run(&self) {
        for solve in &self.solvers {
            black_box(solve());
        }
    }
}

/// Errors of a method over all questions of a motion.
pub(super) fn accuracy<T: Scalar>(method: &Method, questions: &[Question], motion: Motion) -> Option<Accuracy> {
    let (mut asked, mut steps, mut errors) = (0, 0.0, Vec::new());
    for question in questions.iter().filter(|question| question.motion() == motion) {
        let Some(solve) = method.ready::<T>(question) else { continue };
        asked += 1;
        let Some((value, taken)) = solve() else { continue };
        let error = match method.problem {
            Problem::Forward => off(value, question.truth.deformation),
            Problem::Inverse => off([value[0]], [question.truth.pressure]),
        };
        // What is no number is no answer.
        if error.is_finite() {
            errors.push(error);
            steps += f64::from(taken);
        }
    }
    errors.sort_by(f64::total_cmp);
    let (solved, last) = (errors.len(), errors.last().copied());
    (asked > 0).then(|| Accuracy {
        asked,
        solved,
        max_error: last.unwrap_or(f64::NAN),
        median_error: errors.get(solved / 2).copied().unwrap_or(f64::NAN),
        steps: if solved > 0 { steps / solved as f64 } else { 0.0 },
    })
}

/// Largest difference over the largest true value.
fn off<T: Number, const K: usize>(value: [T; K], truth: [Quad; K]) -> f64 {
    let differences = value.into_iter().zip(truth).map(|(a, b)| (Quad::of(a.nearest()) - b).nearest().abs());
    let largest = truth.into_iter().map(|b| b.nearest().abs()).fold(0.0, f64::max);
    // A value that is no number must not vanish in the maximum.
    differences.fold(0.0, |most, d| if d.is_nan() { f64::NAN } else { most.max(d) }) / largest
}
