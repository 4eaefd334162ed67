//! Bounded, damped Gauss-Newton for a goal next to the start, while somebody waits for it.
//!
//! Derivatives cost as much as six poses. Those of the start serve the whole way, corrected by the change that each step was seen to make (Broyden). A step
//! that would leave the box is solved again with the drives that leave it at their bounds.

use nalgebra::{DMatrix, DVector};

use super::ARRIVED_M;
use super::problem::{Problem, WEIGHTS};

/// Most poses that are tried.
const TRIED: usize = 12;
/// A step that promises to lower the residual by less than this share of it is the end.
const PROMISED: f64 = 1e-3;

/// Goes down from a start in the unit box until the residuals vanish or no step helps; again with a larger weight where direction or
/// clearance are then missed.
pub(super) fn descend(problem: &Problem<'_, '_>, start: Vec<f64>) -> Vec<f64> {
    let [first, last] = WEIGHTS;
    let shares = descend_with(problem, start, first);
    if problem.reach(&shares).allowed() { shares } else { descend_with(problem, shares, last) }
}

fn descend_with(problem: &Problem<'_, '_>, mut shares: Vec<f64>, weight: f64) -> Vec<f64> {
    let Some(mut here) = problem.linear(&shares, weight) else { return shares };
    let (mut damping, mut is_corrected) = (1e-3, false);
    for _ in 0..TRIED {
        let miss = here.residual.norm();
        let Some(step) = step(&here.jacobian, &here.residual, &shares, damping).filter(|_| miss > ARRIVED_M) else {
            break;
        };
        let promised = &here.residual + &here.jacobian * &step;
        if promised.norm() > (1.0 - PROMISED) * miss {
            break;
        }
        let next: Vec<f64> = shares.iter().zip(step.iter()).map(|(s, d)| (s + d).clamp(0.0, 1.0)).collect();
        let found = problem.residual(&next, weight);
        let is_better = found.as_ref().is_some_and(|found| found.norm() < miss);
        match found.filter(|found| found.len() == promised.len()) {
            Some(found) => {
                here.jacobian += (&found - promised) * step.transpose() / step.norm_squared();
                is_corrected = true;
                if is_better {
                    (shares, here.residual) = (next, found);
                    damping *= 0.2;
                } else {
                    damping *= 10.0;
                }
            }
            // Another obstacle is near, or the limb does not stand there.
            None if is_better || is_corrected => {
                let at = if is_better { next } else { shares.clone() };
                let Some(there) = problem.linear(&at, weight) else { break };
                (shares, here, is_corrected) = (at, there, false);
            }
            None => damping *= 10.0,
        }
    }
    shares
}

/// The damped step within the unit box: drives that it would take out of the box go to its bounds, and the others do what is left.
fn step(jacobian: &DMatrix<f64>, residual: &DVector<f64>, shares: &[f64], damping: f64) -> Option<DVector<f64>> {
    let normal = jacobian.transpose() * jacobian;
    let scale = normal.diagonal().max().max(f64::MIN_POSITIVE);
    let mut bound: Vec<Option<f64>> = vec![None; shares.len()];
    loop {
        let fixed = DVector::from_iterator(shares.len(), bound.iter().map(|bound| bound.unwrap_or(0.0)));
        let pull = -(jacobian.transpose() * (residual + jacobian * &fixed));
        let mut matrix = normal.clone();
        let mut right = pull;
        for i in 0..shares.len() {
            matrix[(i, i)] += damping * scale;
            if let Some(bound) = bound[i] {
                matrix.row_mut(i).fill(0.0);
                matrix.column_mut(i).fill(0.0);
                (matrix[(i, i)], right[i]) = (1.0, bound);
            }
        }
        let step = matrix.cholesky()?.solve(&right);
        let beyond = |i: &usize| bound[*i].is_none() && !(0.0..=1.0).contains(&(shares[*i] + step[*i]));
        let out: Vec<usize> = (0..shares.len()).filter(beyond).collect();
        if out.is_empty() {
            return Some(step);
        }
        for i in out {
            bound[i] = Some((shares[i] + step[i]).clamp(0.0, 1.0) - shares[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::super::problem::{TipGoal, TipTask};
    use super::super::{descent, starts};
    use super::*;
    use crate::carrier::Carrier;
    use crate::diagnostics::tier_at_rest;
    use crate::payload::Carrying;
    use softlimb_limb::Limb;
    use softlimb_scene as scene;

    /// Beside a descent with derivatives at each pose and twenty times the poses, also where drives are at their bounds.
    #[test]
    fn steps_end_where_a_longer_descent_does() {
        for name in ["steering", "pick-and-place-a", "loaded/carry-hanging"] {
            let path = format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let scene = scene::load(path).unwrap();
            let limb = Limb::new(&scene).unwrap();
            let carrier = Carrier::new(&scene, &limb, tier_at_rest(&scene, &limb).unwrap(), Carrying::default());
            let drives = limb.drives().len();
            let (mut seen, mut exact, mut missed, mut worse) = (0, 0, 0, 0.0_f64);
            for (index, mut start) in starts(drives).take(24).enumerate() {
                // Up to half of the drives at a bound.
                (0..drives / 2)
                    .filter(|drive| index >> drive & 1 == 1)
                    .for_each(|drive| start[drive] = f64::from(u8::from(index % 3 > 0)));
                for (axis, way_m) in [(0, 1e-3), (1, -3e-3), (2, 1e-2), (2, -1e-3)] {
                    let task = |goal| TipTask { goal, aim: None, upright: None, obstacles: &[], clearance_m: 0.0 };
                    let none = task(TipGoal::Point([0.0; 3]));
                    let from = Problem::new(&carrier, &none, carrier.is_loaded()).reach(&start);
                    if !from.distance_m.is_finite() {
                        continue;
                    }
                    let mut goal = Vector3::from(from.tip_m);
                    goal[axis] += way_m;
                    let task = task(TipGoal::Point(goal.into()));
                    let problem = Problem::new(&carrier, &task, carrier.is_loaded());
                    let [few, many] = [descend(&problem, start.clone()), descent::descend(&problem, start.clone())];
                    let [few_m, many_m] = [few, many].map(|shares| problem.reach(&shares).distance_m);
                    seen += 1;
                    exact += usize::from(many_m <= ARRIVED_M);
                    missed += usize::from(many_m <= ARRIVED_M && few_m > 10.0 * ARRIVED_M);
                    worse = worse.max((few_m - many_m) / way_m.abs());
                }
            }
            println!("{name}: {seen} steps, {exact} exact, at most {worse:.1e} of a step farther off");
            assert!(seen > 80 && exact > 60 && missed == 0 && worse < 0.1, "{name}: {seen} {exact} {missed} {worse}");
        }
    }
}
