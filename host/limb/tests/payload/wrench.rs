//! Wrenches against the virtual work of an energy that the test integrates itself.

use fra_model::{Actuator, Families, Load, Motion};
use nalgebra::{UnitQuaternion, Vector3};
use softlimb_limb::payload::{Bundle, Hold, Mounted, PayloadError, lever, rank};

use super::common::*;

/// Potential of one actuator of `common` at a length, a twist and a pressure: strain energy of wall and threads less `P V`, least over the
/// volume. Legend: `p = (r/R)^2`, `t` twist per reference length, lumen volume `v` of rest.
fn potential(angle_deg: f64, families: Families, stretch: f64, twist_rad: f64, pressure_pa: f64) -> f64 {
    let q = parameters(angle_deg, families);
    let (ri, ro, length) = (q.inner_radius_m, q.outer_radius_m, q.length_m);
    let t = twist_rad / length;
    let at = |v: f64| {
        let wall = |radius: f64| {
            // r^2 = ri^2 v/lambda + (R^2 - ri^2)/lambda: incompressible.
            let p = (ri * ri * v + radius * radius - ri * ri) / (stretch * radius * radius);
            let first = stretch * stretch + p + 1.0 / (stretch * stretch * p) + p * radius * radius * t * t;
            0.5 * SHEAR_MODULUS_PA * (first - 3.0) * std::f64::consts::TAU * radius
        };
        // Simpson's rule with many intervals.
        let (n, h) = (400, (ro - ri) / 400.0);
        let sum: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                weight * wall(ri + h * i as f64)
            })
            .sum();
        let p = (ri * ri * v + ro * ro - ri * ri) / (stretch * ro * ro);
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let thread = |sign: f64| {
            let hoop = p.sqrt() * (sign * cos + ro * t * sin);
            let fourth = hoop * hoop + (stretch * sin).powi(2);
            std::f64::consts::TAU * ro * THICKNESS_M * 0.5 * FIBER_MODULUS_PA * (fourth - 1.0).powi(2)
        };
        let threads = thread(1.0) + if families == Families::Two { thread(-1.0) } else { 0.0 };
        let volume = std::f64::consts::PI * ri * ri * length * v;
        (sum * h / 3.0 + threads) * length - pressure_pa * volume
    };
    // Golden sections.
    let (mut low, mut high, golden) = (0.3, 4.0, 0.5 * (5.0_f64.sqrt() - 1.0));
    for _ in 0..200 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if at(a) < at(b) { high = b } else { low = a }
    }
    at(0.5 * (low + high))
}

/// Length and twist of an actuator whose far end moves with the connector.
fn moved(actuator: &Mounted, by: &Vector3<f64>, turn: &Vector3<f64>) -> (f64, f64) {
    let Hold::Straight { axial_stretch, twist_rad } = actuator.hold else { panic!("a straight one") };
    let length = axial_stretch * actuator.actuator.parameters().length_m;
    let near = actuator.point_m - actuator.axis * length;
    let far = UnitQuaternion::from_scaled_axis(*turn) * actuator.point_m + by;
    // To first order the far end turns about the axis by the turn's component along it.
    ((far - near).norm(), twist_rad + turn.dot(&actuator.axis))
}

fn tilted() -> (Bundle, Vec<(f64, Families)>) {
    let kinds = vec![(3.0, Families::Two), (28.0, Families::One), (12.0, Families::Two)];
    let places = [
        ([0.03, 0.0, 0.0], [0.1, 0.05, 1.0], (1.06, 0.0)),
        ([-0.015, 0.025, 0.01], [0.0, -0.2, 1.0], (1.02, 0.15)),
        ([-0.012, -0.03, -0.005], [0.3, 0.1, 0.8], (1.1, 0.0)),
    ];
    let made = kinds
        .iter()
        .zip(places)
        .map(|((angle, families), (point, axis, hold))| straight(*angle, *families, point, axis, hold));
    (Bundle { actuators: made.collect(), ..Bundle::default() }, kinds)
}

/// Along and about each axis: the work of the wrench is what the energy loses.
#[test]
fn the_wrench_does_the_work_that_the_energy_loses() {
    let (bundle, kinds) = tilted();
    let pressures = [60e3, 40e3, 80e3];
    let wrench = bundle.wrench(&pressures).unwrap();
    let energy = |by: Vector3<f64>, turn: Vector3<f64>| -> f64 {
        let each = bundle.actuators.iter().zip(&kinds).zip(pressures);
        each.map(|((actuator, (angle, families)), pressure)| {
            let (length, twist) = moved(actuator, &by, &turn);
            potential(*angle, *families, length / actuator.actuator.parameters().length_m, twist, pressure)
        })
        .sum()
    };
    for axis in 0..3 {
        let unit = Vector3::ith(axis, 1.0);
        let none = Vector3::zeros();
        let (h, turn) = (2e-5, 1e-3);
        let force = -(energy(unit * h, none) - energy(unit * -h, none)) / (2.0 * h);
        assert!((force - wrench[axis]).abs() < 2e-4 * wrench.norm(), "force {axis}: {force} against {}", wrench[axis]);
        let moment = -(energy(none, unit * turn) - energy(none, unit * -turn)) / (2.0 * turn);
        let most = 2e-4 * wrench.norm() * 0.03;
        assert!((moment - wrench[3 + axis]).abs() < most, "moment {axis}: {moment} against {}", wrench[3 + axis]);
    }
}

#[test]
fn columns_are_slopes_of_the_wrench() {
    let (bundle, _) = tilted();
    let pressures = [60e3, 40e3, 80e3];
    let columns = bundle.by_pressure(&pressures).unwrap();
    for (i, column) in columns.iter().enumerate() {
        let [mut more, mut less] = [pressures, pressures];
        more[i] += 50.0;
        less[i] -= 50.0;
        let slope = (bundle.wrench(&more).unwrap() - bundle.wrench(&less).unwrap()) / 100.0;
        assert!((column - slope).norm() < 1e-6 * column.norm(), "{i}: {column} against {slope}");
    }
}

/// Eqs. (15), (16): `D_1` to `D_3` as printed for three actuators on a circle.
#[test]
fn three_on_a_circle_have_the_printed_matrices() {
    let d = 0.045;
    let (half, root) = (0.5 * d, 0.5 * 3.0_f64.sqrt() * d);
    for (point, row) in
        [([d, 0.0, 0.0], [0.0, -d]), ([-half, root, 0.0], [root, half]), ([-half, -root, 0.0], [-root, half])]
    {
        let found = lever(&Vector3::from(point), &Vector3::z());
        let expected = [0.0, 0.0, 1.0, row[0], row[1], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found}");
    }
}

#[test]
fn pushes_add_up_and_colinear_actuators_lose_a_rank() {
    let bundle = three(0.03, 1.05);
    let one = Bundle { actuators: vec![bundle.actuators[0].clone()], ..Bundle::default() };
    let [together, alone] = [bundle.wrench(&[5e4; 3]).unwrap(), one.wrench(&[5e4]).unwrap()];
    assert!((together[2] - 3.0 * alone[2]).abs() < 1e-12 * together[2].abs());
    assert!(together.fixed_rows::<3>(3).norm() < 1e-12, "equal pressures on a circle do not turn");
    assert_eq!(rank(&bundle.by_pressure(&[5e4; 3]).unwrap(), 0.03), 3);
    // All on one line: no moment about it.
    let line = |x: f64| straight(3.0, Families::Two, [x, 0.0, 0.0], [0.0, 0.0, 1.0], (1.0, 0.0));
    let colinear = Bundle { actuators: [-0.03, 0.0, 0.03].map(line).to_vec(), ..Bundle::default() };
    assert_eq!(rank(&colinear.by_pressure(&[5e4; 3]).unwrap(), 0.03), 2);
    let pile = Bundle { actuators: vec![line(0.01); 4], ..Bundle::default() };
    assert_eq!(rank(&pile.by_pressure(&[5e4; 4]).unwrap(), 0.03), 1);
}

/// About another point the moment changes by the arm times the force, and nothing else.
#[test]
fn moment_changes_with_the_reference_point_by_the_arm() {
    let (bundle, _) = tilted();
    let shift = Vector3::new(0.02, -0.01, 0.05);
    let mut shifted = bundle.clone();
    shifted.actuators.iter_mut().for_each(|a| a.point_m -= shift);
    let [here, there] = [&bundle, &shifted].map(|b| b.wrench(&[5e4, 6e4, 7e4]).unwrap());
    let force: Vector3<f64> = here.fixed_rows::<3>(0).into();
    let expected = Vector3::from(here.fixed_rows::<3>(3)) - shift.cross(&force);
    assert!((there.fixed_rows::<3>(0) - force).norm() < 1e-12);
    assert!((there.fixed_rows::<3>(3) - expected).norm() < 1e-12);
}

/// A bending actuator under the moment that its push at the bend answers stays at that bend.
#[test]
fn moment_of_a_bent_actuator_is_what_balances_it() {
    let q = fra_model::ActuatorParameters { motion: Motion::Bending, fiber: None, ..parameters(3.0, Families::Two) };
    let actuator = Actuator::new(&q).unwrap();
    for (angle, share) in [(0.5, 0.0), (0.5, 0.4), (0.5, 0.9), (1.2, 0.7)] {
        // Below the pressure of the free bend, so that the moment bends further and not back through rest.
        let free = actuator.inverse(fra_model::Target::BendAngle(angle), &Load::none()).unwrap();
        let pressure = share * free.state.pressure_pa;
        let bent =
            Mounted::new("b", actuator, Hold::Bent { bend_angle_rad: angle }, Vector3::zeros(), Vector3::y()).unwrap();
        let push = bent.push(pressure).unwrap();
        let state = actuator.forward(pressure, &Load { force_n: 0.0, torque_nm: -push.load.y }).unwrap().state;
        assert!((state.bend_angle_rad - angle).abs() < 1e-6, "{angle}: {}", state.bend_angle_rad);
        assert_eq!(push.load.x, 0.0);
    }
}

#[test]
fn questions_that_make_no_sense_are_refused() {
    let actuator = Actuator::new(&parameters(3.0, Families::Two)).unwrap();
    let new = |hold, point: [f64; 3], axis: [f64; 3]| {
        Mounted::new("a", actuator, hold, Vector3::from(point), Vector3::from(axis)).map(|_| ())
    };
    let hold = Hold::Straight { axial_stretch: 1.0, twist_rad: 0.0 };
    let field = |found: Result<(), PayloadError>| match found.unwrap_err() {
        PayloadError::Invalid { field, .. } => field,
        other => panic!("{other}"),
    };
    assert_eq!(
        field(new(Hold::Straight { axial_stretch: 0.0, twist_rad: 0.0 }, [0.0; 3], [0.0, 0.0, 1.0])),
        "axial_stretch"
    );
    assert_eq!(field(new(Hold::Bent { bend_angle_rad: 0.3 }, [0.0; 3], [0.0, 0.0, 1.0])), "bend_angle_rad");
    assert_eq!(field(new(hold, [f64::NAN, 0.0, 0.0], [0.0, 0.0, 1.0])), "point_m");
    assert_eq!(field(new(hold, [0.0; 3], [0.0; 3])), "axis");
    assert_eq!(field(three(0.03, 1.0).wrench(&[1e4; 2]).map(|_| ())), "pressures_pa");
}
