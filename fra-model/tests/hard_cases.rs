//! The hard cases of the model, by name, in both scalars, against values of 25 digits, or of 30 with two windings, from an independent method.
//!
//! `oracle/hard_cases.py`, and `oracle/two_windings.py` for tubes with two windings, solves the equilibrium of stresses in decimal arithmetic and follows the branch from rest in its arclength.
//! The pass rule: the error is at most ten roundings times the condition number of the case, where the error is that of the displacement
//! vector `(e, w, g)` relative to its largest component, of the pressure, or of the bend angle, and the condition number sums the
//! effects of all inputs. The inputs are exact in the scalar under test.

use crate::oracle::polish::largest;
use crate::oracle::scalar::Scalar;
use crate::oracle::table::{Row, rows};
use fra_model::*;

/// Roundings per unit of the condition number.
const ROUNDINGS: f64 = 10.0;

/// Relative error allowed to a limit pressure where the rule above asks for less.
const LIMIT_PRESSURE: f64 = 1e-6;

/// An actuator with one winding or none.
fn wound_once<T: Scalar>(row: &Row) -> Result<Actuator<T>, InvalidParameter<T>> {
    Actuator::new(&row.parameters(T::rounded))
}

/// A tube with two windings.
fn wound_twice<T: Scalar>(row: &Row) -> Result<Actuator<T>, InvalidParameter<T>> {
    wound_once(row)?.with_second_fiber(&row.fiber("_2", T::rounded).expect("stated"))
}

fn answer<T: Scalar>(actuator: &Actuator<T>, row: &Row) -> Result<Solution<T>, InvalidParameter<T>> {
    let load = row.load(T::rounded);
    match row.text("kind") {
        "inverse" | "bend_inverse" => actuator.inverse_within(&range(row), row.target(T::rounded), &load),
        _ => actuator.forward(T::rounded(row.number("pressure")), &load),
    }
}

/// A pressure that reaches the same target goes before a vacuum.
fn range<T: Scalar>(row: &Row) -> PressureRange<T> {
    let physical = PressureRange::physical();
    if row.number("first") < 0.0 { PressureRange { most_pa: T::rounded(0.0), ..physical } } else { physical }
}

/// Error in units of `eps condition`; `Err` where the answer is of the wrong kind.
fn error<T: Scalar>(row: &Row, built: Build<T>) -> Result<f64, String> {
    let kind = row.text("kind");
    let solution = built(row).and_then(|actuator| answer(&actuator, row)).map_err(|e| format!("{e:?}"))?;
    let expected = if kind == "limit" { Status::NoSolution } else { Status::Solved };
    if solution.status != expected {
        return Err(format!("{:?}, limit {:?}", solution.status, solution.limit_pressure_pa));
    }
    let state = &solution.state;
    let references = ["first", "second", "third"].map(|column| row.number(column));
    let (found, reference): (Vec<f64>, &[f64]) = match kind {
        "forward" => {
            let g = state.twist_rad.exact() * row.number("inner") / row.number("length");
            (vec![state.axial_strain.exact(), state.volume_strain.exact(), g], &references)
        }
        "limit" => (vec![solution.limit_pressure_pa.map_or(f64::NAN, T::exact)], &references[..1]),
        "bend" => (vec![state.bend_angle_rad.exact()], &references[..1]),
        _ => (vec![state.pressure_pa.exact()], &references[..1]),
    };
    let size = largest(reference);
    if size == 0.0 {
        return if largest(&found) == 0.0 { Ok(0.0) } else { Err(format!("{found:?} instead of rest")) };
    }
    let difference: f64 = found.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if found.iter().any(|v| !v.is_finite()) {
        return Err(format!("{found:?}"));
    }
    let unit = T::EPSILON * row.number("condition");
    let unit = if kind == "limit" { unit.max(LIMIT_PRESSURE / ROUNDINGS) } else { unit };
    Ok(difference / size / unit)
}

/// Builds the actuator of a row.
type Build<T> = fn(&Row) -> Result<Actuator<T>, InvalidParameter<T>>;

/// Checks one group in one scalar; lists all cases that fail.
fn check<T: Scalar>(table: &'static str, group: &str, built: Build<T>) {
    let rows = rows(table, group, T::NAME);
    assert!(!rows.is_empty(), "no case in {group}");
    let mut failures = Vec::new();
    let mut worst: f64 = 0.0;
    for row in &rows {
        let name = format!("{group}/{}/{}/{}", row.text("case"), row.text("kind"), T::NAME);
        match error(row, built) {
            Ok(ratio) if ratio <= ROUNDINGS => worst = worst.max(ratio),
            Ok(ratio) => failures.push(format!("{name}: {ratio:.3e} roundings, condition {}", row.text("condition"))),
            Err(kind) => failures.push(format!("{name}: {kind}")),
        }
    }
    println!("{group}, {}: {} cases, worst {worst:.2} roundings per condition", T::NAME, rows.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), rows.len(), failures.join("\n"));
}

macro_rules! hard_cases {
    ($table:ident, $built:ident: $($group:ident),* $(,)?) => {
        $(mod $group {
            use crate::hard_cases::{$built, check};
            use crate::oracle::table::$table;

            #[test]
            fn in_double_precision() {
                check($table, stringify!($group), $built::<f64>);
            }
            #[test]
            fn in_single_precision() {
                check($table, stringify!($group), $built::<f32>);
            }
        })*

        #[test]
        fn every_group_of_the_table_is_a_test() {
            let mut found = crate::oracle::table::groups(crate::oracle::table::$table);
            let mut tested = vec![$(stringify!($group)),*];
            found.sort_unstable();
            found.dedup();
            tested.sort_unstable();
            assert_eq!(found, tested);
        }
    };
}

hard_cases![
    HARD_CASES, wound_once:
    hardly_any_pressure,
    hardly_any_pressure_yeoh,
    vacuum,
    just_below_the_limit,
    just_above_the_limit,
    far_above_the_limit,
    near_the_limit,
    second_stable_equilibrium,
    angle_near_0,
    angle_near_35,
    angle_near_55,
    angle_near_90,
    stiff_fibers,
    thin_and_thick_walls,
    large_rotations,
    loads_of_both_signs,
    yeoh,
    inverse,
    bending,
];

mod two_windings {
    hard_cases![
        TWO_WINDINGS, wound_twice:
        hardly_any_pressure,
        vacuum,
        usual_pressures,
        saturation,
        just_below_the_limit,
        just_above_the_limit,
        far_above_the_limit,
        special_angles,
        stiff_fibers,
        thin_and_thick_walls,
        large_rotations,
        loads_of_both_signs,
        tiny_torques,
        near_equal_families,
        hardly_any_modulus,
        yeoh,
        inverse,
    ];
}
