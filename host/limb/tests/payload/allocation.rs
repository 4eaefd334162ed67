//! Allocation beside an interior-point solver: objectives, since places of equal worth may be far apart.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use fra_model::{Allocation, AllocationStatus};

use super::common::Numbers;

const REGULARISER: f64 = 1e-6;

/// `1/2 s H s - g s` in shares of 1e5 Pa, as the model documents it.
fn stated(columns: &[[f64; 6]], wrench: &[f64; 6]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scaled: Vec<[f64; 6]> = columns.iter().map(|c| c.map(|x| x * 1e5)).collect();
    let h = scaled.iter().map(|c| dot(c, c)).fold(0.0, f64::max);
    let entry = |i: usize, j: usize| dot(&scaled[i], &scaled[j]) / h + if i == j { REGULARISER } else { 0.0 };
    let hessian = (0..columns.len()).map(|i| (0..columns.len()).map(|j| entry(i, j)).collect()).collect();
    (hessian, scaled.iter().map(|c| dot(c, wrench) / h).collect())
}

fn value(hessian: &[Vec<f64>], linear: &[f64], s: &[f64]) -> f64 {
    let row = |i: usize| 0.5 * hessian[i].iter().zip(s).map(|(h, s)| h * s).sum::<f64>() - linear[i];
    (0..s.len()).map(|i| s[i] * row(i)).sum()
}

fn interior_point(hessian: &[Vec<f64>], linear: &[f64]) -> Vec<f64> {
    let n = linear.len();
    let upper: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| if i <= j { hessian[i][j] } else { 0.0 }).collect()).collect();
    let mut rows = Vec::new();
    for sign in [-1.0, 1.0] {
        rows.extend((0..n).map(|i| (0..n).map(|j| if i == j { sign } else { 0.0 }).collect::<Vec<f64>>()));
    }
    let minus: Vec<f64> = linear.iter().map(|g| -g).collect();
    let right: Vec<f64> = (0..2 * n).map(|i| if i < n { 0.0 } else { 1.0 }).collect();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(2 * n)];
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&rows));
    let mut solver = DefaultSolver::new(&p, &minus, &a, &right, &cones, settings).unwrap();
    solver.solve();
    assert_eq!(solver.solution.status, SolverStatus::Solved);
    solver.solution.x.clone()
}

#[test]
fn objectives_are_no_worse_than_those_of_an_interior_point_method() {
    let mut numbers = Numbers(7);
    for round in 0..90 {
        let count = [9, 18, 27][round % 3];
        let columns: Vec<[f64; 6]> = (0..count).map(|_| [0; 6].map(|_| numbers.next() * 4e-4)).collect();
        let wrench = [0; 6].map(|_| numbers.next() * [10.0, 60.0, 400.0][round / 3 % 3]);
        let limits = vec![[0.0, 1e5]; count];
        let allocation = Allocation::<f64, 6, 27>::new(&columns, &limits, &[1.0; 6], REGULARISER).unwrap();
        let found = allocation.solve(&wrench);
        assert_eq!(found.status, AllocationStatus::Solved);
        assert!(found.residual <= 1e-9);
        let (hessian, linear) = stated(&columns, &wrench);
        let ours: Vec<f64> = found.pressures_pa[..count].iter().map(|p| p / 1e5).collect();
        let theirs: Vec<f64> = interior_point(&hessian, &linear).iter().map(|s| s.clamp(0.0, 1.0)).collect();
        let [one, other] = [&ours, &theirs].map(|s| value(&hessian, &linear, s));
        let size = 1.0 + other.abs();
        assert!(one <= other + 1e-12 * size, "round {round}: {one} above {other}");
        assert!(other - one <= 2e-7 * size, "round {round}: {other} is far above {one}");
    }
}
