//! Eq. (18): what can be had, what is beyond, and files.

use softlimb_design::bundle::{Budget, ForceProblem, Place, search};
use softlimb_lab::payload::{Barrier, barrier, kind};

const SEEDS: u64 = 20;

#[test]
fn what_some_bundle_has_is_found_for_every_seed() {
    for (name, numbers) in [("P1", 17), ("P2", 72)] {
        let (mut costs, mut most) = (Vec::new(), 0.0_f64);
        for seed in 0..SEEDS {
            let problem = kind(name, seed).unwrap();
            let free = |bounds: [f64; 2]| usize::from(bounds[1] > bounds[0]);
            let tube = &problem.actuators[0].tube;
            let geometry = [tube.inner_radius_m, tube.wall_m, tube.length_m, tube.angle_rad].map(free);
            let placed = |place| match place {
                Place::Polar { radius_m, azimuth_rad } => [radius_m, azimuth_rad],
                Place::Cartesian { x_m, y_m } => [x_m, y_m],
            };
            let places: Vec<usize> = problem
                .actuators
                .iter()
                .map(|a| placed(a.place).iter().chain(&a.slopes).map(|bounds| free(*bounds)).sum())
                .collect();
            let each: usize = geometry.iter().sum();
            let (count, samples) = (problem.actuators.len(), problem.samples.len());
            let all = if problem.shared { each + places[0] } else { count * each + places.iter().sum::<usize>() };
            assert_eq!(all + count * samples, numbers);
            let found = search(&problem, &Budget::default()).unwrap();
            let cost = found.evaluations + found.jacobians;
            most = most.max(found.objective);
            costs.push(cost);
        }
        println!("{name}: at most {most:e}, evaluations and Jacobians {costs:?}");
        assert!(most <= 1e-18, "{name}: {most:e}");
        assert!(costs.iter().all(|cost| *cost <= 100), "{name}: {costs:?}");
    }
}

#[test]
fn beyond_capacity_no_other_start_and_no_barrier_is_better() {
    for seed in 0..SEEDS {
        let problem = kind("P1u", seed).unwrap();
        let found = search(&problem, &Budget::default()).unwrap();
        let cost = found.evaluations + found.jacobians;
        let many = Budget { seed: 77 + seed, starts: 12, agreeing: 12, evaluations: u64::MAX };
        let best = search(&problem, &many).unwrap().objective;
        assert!(found.objective <= best * (1.0 + 1e-9), "seed {seed}: {} against {best}", found.objective);
        assert!(cost <= 100, "seed {seed}: {cost} evaluations and Jacobians");
        assert_eq!(found.status, "best_found");
    }
}

#[test]
fn the_barrier_is_never_better_and_needs_far_more() {
    for (name, seeds) in [("P1", 3), ("P1u", 3)] {
        for seed in 0..seeds {
            let problem = kind(name, seed).unwrap();
            let found = search(&problem, &Budget::default()).unwrap();
            let other = barrier(&problem, &Barrier::default()).unwrap();
            assert!(
                found.objective <= other.objective * (1.0 + 1e-12),
                "{name} {seed}: {} {}",
                found.objective,
                other.objective
            );
            assert!(
                other.evaluations > 30 * (found.evaluations + found.jacobians),
                "{name} {seed}: {}",
                other.evaluations
            );
        }
    }
}

/// Pushes that the model itself has at the answer, by its public face.
#[test]
fn answer_is_what_its_bundle_does() {
    use nalgebra::{Vector3, Vector6};
    use softlimb_limb::payload::lever;
    let problem = kind("P2", 3).unwrap();
    let found = search(&problem, &Budget::default()).unwrap();
    for (index, sample) in found.samples.iter().enumerate() {
        let mut sum = Vector6::zeros();
        for actuator in &found.actuators {
            let p = fra_model::ActuatorParameters {
                motion: fra_model::Motion::Extension,
                inner_radius_m: actuator.inner_radius_m,
                outer_radius_m: actuator.outer_radius_m,
                length_m: actuator.length_m,
                material: problem.actuators[0].tube.material,
                fiber: Some(fra_model::Fiber {
                    angle_rad: actuator.angle_deg.to_radians(),
                    families: fra_model::Families::Two,
                    modulus_pa: 361e6,
                    placement: fra_model::Placement::Sheet,
                    thickness_m: 0.178e-3,
                    radius_m: actuator.outer_radius_m,
                }),
            };
            let held = fra_model::Actuator::new(&p)
                .unwrap()
                .blocked(actuator.pressures_pa[index], 0.24 / actuator.length_m, 0.0)
                .unwrap();
            let load = nalgebra::Vector2::new(-held.force_n, -held.torque_nm);
            sum += lever(&Vector3::from(actuator.point_m), &Vector3::from(actuator.axis)) * load;
        }
        for row in 0..6 {
            assert!((sum[row] - sample.target[row]).abs() < 1e-8, "sample {index}, row {row}");
        }
    }
}

fn text() -> String {
    include_str!("../../design/tests/problems/forces.json").into()
}

#[test]
fn file_is_read_and_solved() {
    let problem = ForceProblem::read(&text()).unwrap();
    let found = search(&problem, &Budget::default()).unwrap();
    assert_eq!(found.status, "reached", "{found:?}");
    // No pressure and no load: nothing to do, and said so.
    let rest = text()
        .replace("[0, 0, 30], \"torque_nm\": [0.1, 0, 0]", "[0, 0, 0]")
        .replace("[0, 0, 15], \"torque_nm\": [0, 0.2, 0]", "[0, 0, 0]");
    let rest = rest.replace(", \"held_length_m\": 0.24", "");
    let found = search(&ForceProblem::read(&rest).unwrap(), &Budget::default()).unwrap();
    assert!(found.objective <= 1e-18);
    assert!(found.actuators.iter().flat_map(|a| &a.pressures_pa).all(|p| *p < 1e-3));
}

#[test]
fn errors_in_a_file_have_their_line() {
    for (from, to, expected) in [
        ("\"format\": 1", "\"format\": 2", "line 2: format = 2 is not allowed: 1"),
        ("[0.003, 0.006]", "[0.006, 0.003]", "line 7: bounds.wall_m[1] = 0.003 is not allowed: at least 0.006"),
        ("[0, 30]", "[0, 95]", "line 7: bounds.angle_deg[1] = 95 is not allowed: -90 to 90"),
        ("\"torque_per_nm\": 20", "\"torque_per_nm\": -1", "line 4: weights.torque_per_nm = -1 is not allowed: >= 0"),
        ("\"families\": 2", "\"families\": 3", "line 6: fiber.families = 3 is not allowed: 1 or 2"),
        ("\"law\": \"neo-hookean\"", "\"law\": \"ogden\"", "line 5: material.law is not allowed"),
        (
            "[0.1, 0, 0], \"held_length_m\": 0.24",
            "[0.1, 0, 0], \"held_length_m\": -1",
            "line 15: samples[0].held_length_m = -1 is not allowed: > 0",
        ),
        ("\"azimuth_deg\": [120, 120]", "\"azimut_deg\": [120, 120]", "line 11, column"),
    ] {
        let said = ForceProblem::read(&text().replacen(from, to, 1)).unwrap_err().to_string();
        assert!(said.starts_with(expected), "{said}");
    }
    assert!(kind("P9", 0).is_none());
}
