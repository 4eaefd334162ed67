//! Largest loads against the enumeration of all vertices, and closed forms.

use nalgebra::{DMatrix, DVector, Vector6};
use softlimb_limb::payload::{Active, Linearised, LoadQuery, Outcome, Program, capacity};

use super::common::*;

/// The best vertex: as many limits as leave the rest determined, in all combinations.
fn enumerated(program: &Program) -> Option<f64> {
    let (count, height) = (program.columns.len(), program.constant.len());
    // Limits: lower and upper of each pressure, then the sides.
    let mut limits: Vec<(Vec<f64>, f64)> = Vec::new();
    for (j, [low, high]) in program.limits.iter().enumerate() {
        let row = |sign: f64| (0..count).map(|k| if k == j { sign } else { 0.0 }).collect::<Vec<f64>>();
        limits.push((row(-1.0), -low));
        limits.push((row(1.0), *high));
    }
    limits.extend(program.sides.iter().cloned());
    let needed = count + 1 - height;
    let mut best: Option<f64> = None;
    let mut chosen: Vec<usize> = (0..needed).collect();
    loop {
        let rows = DMatrix::from_fn(count + 1, count + 1, |r, j| match r.checked_sub(height) {
            None if j < count => program.columns[j][r],
            None => program.load[r],
            Some(k) if j < count => limits[chosen[k]].0[j],
            Some(_) => 0.0,
        });
        let right = DVector::from_fn(count + 1, |r, _| match r.checked_sub(height) {
            None => -program.constant[r],
            Some(k) => limits[chosen[k]].1,
        });
        // Rows of one size, so that a determinant of nothing is one.
        let sizes: Vec<f64> = rows.row_iter().map(|row| row.amax().max(1e-300)).collect();
        let scaled = DMatrix::from_fn(count + 1, count + 1, |r, j| rows[(r, j)] / sizes[r]);
        let right = DVector::from_fn(count + 1, |r, _| right[r] / sizes[r]);
        if let Some(x) = scaled.full_piv_lu().solve(&right) {
            let inside = limits.iter().all(|(row, bound)| {
                let value: f64 = row.iter().zip(x.iter()).map(|(a, x)| a * x).sum();
                value <= bound + 1e-9 * (1.0 + bound.abs())
            });
            if inside && x.iter().all(|x| x.is_finite()) && best.is_none_or(|best| x[count] > best) {
                best = Some(x[count]);
            }
        }
        let Some(place) = (0..needed).rev().find(|i| chosen[*i] < limits.len() - (needed - i)) else { return best };
        chosen[place] += 1;
        (place + 1..needed).for_each(|i| chosen[i] = chosen[i - 1] + 1);
    }
}

fn random(numbers: &mut Numbers, count: usize, height: usize, sides: usize) -> Program {
    Program {
        columns: (0..count).map(|_| (0..height).map(|_| numbers.next() * 4e-4).collect()).collect(),
        load: (0..height).map(|_| numbers.next()).collect(),
        constant: (0..height).map(|_| numbers.next() * 30.0).collect(),
        limits: (0..count).map(|_| [0.0, 1e5]).collect(),
        sides: (0..sides)
            .map(|_| ((0..count).map(|_| numbers.next() * 3e-4).collect(), 20.0 + 15.0 * numbers.next()))
            .collect(),
        rows_scale: vec![40.0; height],
    }
}

#[test]
fn the_largest_load_is_that_of_the_best_vertex() {
    let mut numbers = Numbers(4);
    let (mut solved, mut infeasible) = (0, 0);
    for round in 0..200 {
        let height = 1 + round % 3;
        let count = height + 1 + round % 4;
        let program = random(&mut numbers, count, height, round % 3);
        let (found, best) = (program.solve().unwrap(), enumerated(&program));
        match best {
            Some(best) => {
                assert_eq!(found.outcome, Outcome::Solved, "round {round}");
                let size = 1.0 + best.abs();
                assert!((found.load - best).abs() <= 1e-7 * size, "round {round}: {} against {best}", found.load);
                assert!(found.bound >= best - 1e-9 * size, "round {round}: a bound below the best");
                assert!(found.bound - found.load <= 1e-7 * size, "round {round}: {} certified for {best}", found.bound);
                assert!(found.residual <= 1e-8, "round {round}: {}", found.residual);
                assert!(found.pressures.iter().all(|p| (0.0..=1e5).contains(p)));
                solved += 1;
            }
            None => {
                assert_eq!(found.outcome, Outcome::Infeasible, "round {round}");
                infeasible += 1;
            }
        }
    }
    assert!(solved > 100 && infeasible > 5, "{solved} solved, {infeasible} infeasible");
}

fn question(circle_m: f64, per_load: [f64; 6], constant: [f64; 6], push_max_n: f64) -> LoadQuery {
    let station = Linearised {
        name: "bundle".into(),
        bundle: three(circle_m, 1.0),
        rows: [false, false, true, true, true, false],
        constant: Vector6::from(constant),
        per_load: Vector6::from(per_load),
        limits_pa: vec![[0.0, 1e5]; 3],
        push_max_n: vec![push_max_n; 3],
    };
    LoadQuery { bundles: vec![station], arm_m: 0.03 }
}

/// Against a push along the axis all three push with all they have.
#[test]
fn along_the_axis_the_bundle_holds_the_sum_of_its_pushes() {
    let found = capacity(&question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6], f64::INFINITY)).unwrap();
    let all = three(0.03, 1.0).wrench(&[1e5; 3]).unwrap()[2];
    assert!((found.load_n - all).abs() < 1e-6 * all, "{} against {all}", found.load_n);
    assert!((found.bound_n - found.load_n).abs() < 1e-6 * all);
    assert_eq!(found.active.len(), 3);
    assert!(found.active.iter().all(|one| matches!(one, Active::PressureMax { .. })));
    // The answer is where the second program was linearised: the rest is rounding.
    assert!(found.remainder_n < 1e-6 * all, "{}", found.remainder_n);
}

/// A push may not exceed its limit, whatever the pressure could do.
#[test]
fn a_buckling_limit_ends_the_push_before_the_pressure_does() {
    let found = capacity(&question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6], 12.0)).unwrap();
    assert!((found.load_n - 36.0).abs() < 36.0 * 1e-3, "{}", found.load_n);
    assert!(found.active.iter().all(|one| matches!(one, Active::Push { .. })), "{:?}", found.active);
    assert_eq!(found.active.len(), 3);
}

/// A moment alone, about the axis through one actuator: the pair across pushes, with an upper bound by hand.
#[test]
fn moment_with_the_axial_force_balanced_by_a_pull_of_the_surroundings() {
    // The surroundings push with half of what the bundle can do, so that pressures can go either way.
    let all = three(0.03, 1.0).wrench(&[1e5; 3]).unwrap()[2];
    let found =
        capacity(&question(0.03, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 0.0, -0.5 * all, 0.0, 0.0, 0.0], f64::INFINITY))
            .unwrap();
    // p1 at the lower limit would leave 0.5 all = p2 + p3 <= 2/3 all; p1 free: M_y = -d (p1 - (p2 + p3)/2) A, with p1 + p2 + p3 = 1.5.
    // Largest load has p1 as large as can be, 1: M = -d A (1 - 0.25) -> load 0.75 d A.
    let expected = 0.75 * 0.03 * all / 3.0;
    assert!((found.load_n - expected).abs() < 1e-3 * expected, "{} against {expected}", found.load_n);
}

#[test]
fn what_cannot_be_held_and_what_needs_no_pressure_is_said() {
    // A pull: these actuators cannot pull at rest.
    let found =
        capacity(&question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 50.0, 0.0, 0.0], f64::INFINITY))
            .unwrap();
    assert_eq!(found.outcome, Outcome::Infeasible, "a moment beyond what pressures can balance");
    let found = capacity(&question(0.03, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6], f64::INFINITY)).unwrap();
    assert_eq!(found.outcome, Outcome::Unbounded, "shear is left to the walls");
    let found = capacity(&question(0.03, [1.0, 0.0, 0.0, 0.0, 1e-17, 0.0], [0.0; 6], f64::INFINITY)).unwrap();
    assert_eq!(found.outcome, Outcome::Unbounded, "an arm of rounding needs no moment");
    // All three at one point: moments are the walls' business then, and the axial force is what it was.
    let found = capacity(&question(0.0, [0.0, 0.0, -1.0, 0.0, 1.0, 0.0], [0.0; 6], f64::INFINITY)).unwrap();
    let all = three(0.0, 1.0).wrench(&[1e5; 3]).unwrap()[2];
    assert!((found.load_n - all).abs() < 1e-6 * all);
}

#[test]
fn limits_that_make_no_sense_are_refused() {
    let mut wrong = question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6], f64::INFINITY);
    wrong.bundles[0].limits_pa[1] = [1e5, 0.0];
    assert!(capacity(&wrong).unwrap_err().to_string().contains("limits_pa"));
    let mut wrong = question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6], f64::INFINITY);
    wrong.bundles[0].per_load[2] = f64::NAN;
    assert!(capacity(&wrong).unwrap_err().to_string().contains("load"));
    let wrong = question(0.03, [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], [0.0; 6], 0.0);
    assert!(capacity(&wrong).unwrap_err().to_string().contains("push_max_n"));
}
