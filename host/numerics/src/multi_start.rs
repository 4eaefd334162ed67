//! Best of several local solves, until enough agree.

use crate::least_squares::{Minimum, StoppingCriteria, SumOfSquares, minimise};

/// Settings of a multi-start search.
#[derive(Clone, Copy, Debug)]
pub struct MultiStart {
    /// Most starts.
    pub starts: usize,
    /// Local solves that must agree on the least objective.
    pub agreeing: usize,
    /// Objectives within this share of each other agree.
    pub same: f64,
    /// Criteria of each local solve.
    pub criteria: StoppingCriteria,
}

/// Local solves of a multi-start search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LocalSolves {
    /// LocalSolves tried.
    pub starts: usize,
    /// LocalSolves from which the problem has a minimum.
    pub minima: usize,
    /// Minima that agree with the best.
    pub agreeing: usize,
}

/// Result of a multi-start search: the best minimum, and the solves that found it.
pub type Best<P> = (Minimum<<P as SumOfSquares>::Evaluation>, LocalSolves);

/// Solves from one start after another until the objective is zero, enough minima agree, the starts are used up or `spent` says that the
/// budget is; the first start is tried in any case.
///
/// `start` gives the start of a number, `None` where there is none; `refine` goes on from each minimum. `None` without any minimum.
pub fn multi_start<P: SumOfSquares>(
    problem: &mut P,
    settings: MultiStart,
    spent: impl Fn(&P) -> bool,
    mut start: impl FnMut(&mut P, usize) -> Option<Vec<f64>>,
    refine: impl Fn(&mut P, Minimum<P::Evaluation>) -> Minimum<P::Evaluation>,
) -> Option<Best<P>> {
    let MultiStart { starts, agreeing, same, criteria } = settings;
    let mut best: Option<Minimum<P::Evaluation>> = None;
    let mut objectives: Vec<f64> = Vec::new();
    let mut solves = LocalSolves::default();
    while solves.starts < starts && (solves.starts == 0 || !spent(problem)) {
        let point = start(problem, solves.starts);
        solves.starts += 1;
        let Some(found) = point.and_then(|point| minimise(problem, &point, criteria)) else { continue };
        let found = refine(problem, found);
        objectives.push(found.objective);
        if best.as_ref().is_none_or(|best| found.objective < best.objective) {
            best = Some(found);
        }
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.objective);
        solves.minima = objectives.len();
        solves.agreeing = objectives.iter().filter(|one| **one <= least * (1.0 + same) + criteria.zero).count();
        if least <= criteria.zero || solves.agreeing >= agreeing {
            break;
        }
    }
    Some((best?, solves))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::LeastSquares;

    /// Two minima: 0.25 with the objective 0.01, and 0.75 with 0.
    struct TwoMinima;

    impl LeastSquares for TwoMinima {
        type Evaluation = f64;
        fn evaluate(&mut self, point: &[f64]) -> Option<f64> {
            (point[0] > 0.0).then(|| point[0])
        }
        fn residuals(&self, x: &f64) -> Vec<f64> {
            vec![if *x < 0.5 { x - 0.25 } else { x - 0.75 }, if *x < 0.5 { 0.1 } else { 0.0 }]
        }
        fn jacobian(&mut self, _: &f64) -> Option<Vec<Vec<f64>>> {
            Some(vec![vec![1.0], vec![0.0]])
        }
    }

    fn search(starts: &[f64], agreeing: usize) -> Option<Best<TwoMinima>> {
        let criteria = StoppingCriteria { zero: 1e-20, ..StoppingCriteria::default() };
        let settings = MultiStart { starts: starts.len(), agreeing, same: 1e-6, criteria };
        multi_start(&mut TwoMinima, settings, |_| false, |_, index| Some(vec![starts[index]]), |_, found| found)
    }

    #[test]
    fn search_stops_at_zero_and_skips_starts_without_a_value() {
        let (best, solves) = search(&[0.2, 0.0, 0.9, 0.1], 3).unwrap();
        assert!((best.point[0] - 0.75).abs() < 1e-9);
        assert_eq!(solves, LocalSolves { starts: 3, minima: 2, agreeing: 1 });
        assert!(search(&[0.0], 1).is_none());
    }

    #[test]
    fn search_stops_when_enough_minima_agree() {
        let (best, solves) = search(&[0.2, 0.3, 0.9], 2).unwrap();
        assert!((best.point[0] - 0.25).abs() < 1e-7);
        assert_eq!(solves, LocalSolves { starts: 2, minima: 2, agreeing: 2 });
    }
}
