//! The hard cases of the model, by name, in both scalars, against values of 25 digits from an independent method.
//!
//! `oracle/hard_cases.py` solves the equilibrium of stresses in decimal arithmetic and follows the branch from rest in its arclength.
//! The pass rule: the error is at most ten roundings times the condition number of the case, where the error is that of the displacement
//! vector `(e, w, g)` relative to its largest component, of the pressure, or of the bend angle, and the condition number sums the
//! effects of all inputs. The inputs are exact in the scalar under test.

use crate::oracle::polish::largest;
use crate::oracle::scalar::Scalar;
use crate::oracle::table::{Row, groups, rows};
use fra_model::*;

/// Roundings per unit of the condition number.
const ROUNDINGS: f64 = 10.0;

/// Relative error allowed to a limit pressure where the rule above asks for less.
const LIMIT_PRESSURE: f64 = 1e-6;

/// Error in units of `eps condition`; `Err` where the answer is of the wrong kind.
fn error<T: Scalar>(row: &Row) -> Result<f64, String> {
    let actuator = Actuator::new(&row.parameters(T::rounded)).map_err(|e| format!("{e:?}"))?;
    let load = row.load(T::rounded);
    let kind = row.text("kind");
    let solution = match kind {
        // A pressure that reaches the same target goes before a vacuum.
        "inverse" if row.number("first") < 0.0 => {
            let vacuums = PressureRange { most_pa: T::rounded(0.0), ..PressureRange::physical() };
            actuator.inverse_within(&vacuums, row.target(T::rounded), &load)
        }
        "inverse" | "bend_inverse" => actuator.inverse(row.target(T::rounded), &load),
        _ => actuator.forward(T::rounded(row.number("pressure")), &load),
    }
    .map_err(|e| format!("{e:?}"))?;
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

/// Checks one group in one scalar; lists all cases that fail.
fn check<T: Scalar>(group: &str) {
    let rows = rows(group, T::NAME);
    assert!(!rows.is_empty(), "no case in {group}");
    let mut failures = Vec::new();
    let mut worst: f64 = 0.0;
    for row in &rows {
        let name = format!("{group}/{}/{}/{}", row.text("case"), row.text("kind"), T::NAME);
        match error::<T>(row) {
            Ok(ratio) if ratio <= ROUNDINGS => worst = worst.max(ratio),
            Ok(ratio) => failures.push(format!("{name}: {ratio:.3e} roundings, condition {}", row.text("condition"))),
            Err(kind) => failures.push(format!("{name}: {kind}")),
        }
    }
    println!("{group}, {}: {} cases, worst {worst:.2} roundings per condition", T::NAME, rows.len());
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), rows.len(), failures.join("\n"));
}

macro_rules! hard_cases {
    ($($group:ident),* $(,)?) => {
        $(mod $group {
            #[test]
            fn in_double_precision() {
                super::check::<f64>(stringify!($group));
            }
            #[test]
            fn in_single_precision() {
                super::check::<f32>(stringify!($group));
            }
        })*

        #[test]
        fn every_group_of_the_table_is_a_test() {
            let mut found = groups();
            let mut tested = vec![$(stringify!($group)),*];
            found.sort_unstable();
            found.dedup();
            tested.sort_unstable();
            assert_eq!(found, tested);
        }
    };
}

hard_cases![
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
