//! Plans against plane geometry, the model's own forward direction, and what a wrong scene is told.

use fra_model::{Load, Status};
use softlimb_limb::Limb;
use softlimb_limb::statics::Bundle;
use softlimb_motion as motion;
use softlimb_motion::{Plan, Sent, solve_tip};
use softlimb_scene as scene;
use softlimb_scene::{Corrections, Scene};

fn scene(name: &str) -> Scene {
    scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene of the repository")
}

fn changed(name: &str, from: &str, to: &str) -> Result<Plan, String> {
    let text = scene(name).source_text().to_owned();
    assert!(text.contains(from), "{from} is not in {name}");
    let scene = scene::parse(&text.replacen(from, to, 1), "test.toml").map_err(|e| e.render(false))?;
    let limb = Limb::new(&scene).map_err(|e| e.render(false))?;
    motion::plan(&scene, &limb).map_err(|e| e.render(false))
}

#[test]
fn phases_end_at_their_targets_and_modules_left_out_keep_theirs() {
    let scene = scene("weightless-a");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let end_of = |phase: usize| {
        let phase = &plan.phases[phase];
        plan.values_at((phase.start_us + phase.move_us + phase.hold_us / 2) as f64)
    };
    let expected = [[1.12, 40.0, 1.08], [1.12, 75.0, 1.16], [1.20, 45.0, 1.10], [1.20, 70.0, 1.14]];
    for (phase, [shoulder, elbow, wrist]) in expected.into_iter().enumerate() {
        let found = end_of(phase);
        // Wire units are 1e-6.
        assert!((found[0] - shoulder).abs() <= 5e-7 && (found[2] - wrist).abs() <= 5e-7, "{phase}: {found:?}");
        assert!((found[1] - f64::to_radians(elbow)).abs() <= 5e-7);
    }
    assert_eq!(plan.duration_us(), 15_000_000);
    assert_eq!(plan.values_at(0.0), [1.0, 0.0, 1.0]);
}

/// One instant is 0.2 us before the end of a phase, and one phase has none.
#[test]
fn corrections_by_phase_are_the_same_over_the_same_times() {
    let scene = scene("weightless-a");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let times = plan.phase_times();
    let end_s = times[1].end_s();
    let times_s = vec![0.3, 0.31, times[0].end_s(), times[1].start_s + 0.7, end_s - 2e-7, times[3].end_s()];
    let rows = (0..times_s.len()).map(|index| vec![(index * index) as f64; limb.channels()]).collect();
    let corrections = Corrections { times_s, rows };
    let by_phase = plan.by_phase(&limb, &corrections);
    let over = by_phase.over(&times);
    for ms in 0..plan.duration_us() / 1_000 {
        let time_s = 1e-3 * ms as f64;
        let (found, expected) = (over.at(time_s)[0], corrections.at(time_s)[0]);
        assert!((found - expected).abs() < 1e-4, "{time_s} s: {found} and not {expected}");
    }
    // Rows also rise in a file, which has 1 us, and nine decimals of the move.
    for rows in &by_phase.phases {
        assert!(
            rows.windows(2)
                .all(|pair| pair[1].move_share - pair[0].move_share > 1e-6 || pair[1].hold_s - pair[0].hold_s > 1e-4)
        );
        assert_eq!(rows.last().map(|row| row.move_share), Some(1.0));
        assert!(rows.iter().any(|row| (row.move_share, row.hold_s) == (1.0, 0.0)), "{rows:?}");
    }
    // The planned setpoints of an end are the targets of its phase.
    let planned = &by_phase.phases[0].last().unwrap().planned;
    assert!((planned[0] - 1.12).abs() < 1e-6 && (planned[3] - 40_f64.to_radians()).abs() < 1e-6, "{planned:?}");
}

/// Extension, bend, extension in one plane: the tip by elementary geometry from the targets. The bend's axis is `R_o` outside of
/// its inextensible line, whose length stays 240 mm.
#[test]
fn the_tip_of_a_plane_limb_is_where_geometry_puts_it() {
    let scene = scene("weightless-a");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let (shoulder, bend, wrist) = (1.12 * 0.24, 75.0_f64.to_radians(), 1.16 * 0.24);
    let (connector, tool, outer) = (0.015, 0.05, 0.014);
    let radius = 0.24 / bend + outer;
    let straight = wrist + connector + tool + connector;
    let forward = shoulder + connector + radius * bend.sin() + straight * bend.cos();
    let down = radius * (1.0 - bend.cos()) + straight * bend.sin();
    let phase = &plan.phases[1];
    let states = plan.states_at((phase.start_us + phase.move_us) as f64);
    let tip = limb.tip(&states);
    for (found, expected) in tip.into_iter().zip([forward, 0.0, 1.1 - down]) {
        assert!((found - expected).abs() < 2e-6, "{tip:?} against [{forward}, 0, {}]", 1.1 - down);
    }
}

#[test]
fn planned_states_are_equilibria_of_the_model() {
    for name in ["weightless-b", "weightless-c", "tip-waypoints"] {
        let scene = scene(name);
        let limb = Limb::new(&scene).unwrap();
        let plan = motion::plan(&scene, &limb).unwrap();
        for step in 0..40 {
            let time_us = step as f64 / 40.0 * plan.duration_us() as f64;
            // On a knot nothing is interpolated.
            let knot_us = (time_us / plan.knot_period_us() as f64).floor() * plan.knot_period_us() as f64;
            for ((module, state), value) in
                limb.modules().iter().zip(plan.states_at(knot_us)).zip(plan.values_at(knot_us))
            {
                assert!((module.measure(&state) - value).abs() < 1e-9);
                if module.is_restrained() {
                    // The bundle at this pressure, of which the states are interpolated.
                    let pressures_pa = vec![state.pressure_pa.max(0.0); module.channels.len()];
                    let free = Bundle::new(module, &pressures_pa, module.bays()).unwrap().free;
                    assert!((free.twist_rad_per_m * module.length_m() - state.twist_rad).abs() < 1e-6);
                    assert!((free.stretch - state.axial_stretch).abs() < 1e-7);
                    continue;
                }
                let again = module.actuator.forward(state.pressure_pa, &Load::none()).unwrap();
                assert_eq!(again.status, Status::Solved);
                assert!((again.state.volume_m3 / state.volume_m3 - 1.0).abs() < 1e-6, "{name} {}", module.name);
            }
        }
    }
}

#[test]
fn way_points_are_reached_by_the_tip() {
    let scene = scene("tip-waypoints");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let points = [[0.768, -0.172, 0.895], [0.645, -0.276, 0.771], [0.718, -0.284, 0.936], [0.642, -0.394, 1.244]];
    for (phase, point) in plan.phases.iter().zip(points) {
        let tip = limb.tip(&plan.states_at((phase.start_us + phase.move_us) as f64));
        let off: f64 = tip.iter().zip(point).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        assert!(off < 1.05e-4, "{}: {:.3} mm", phase.name, off * 1e3);
    }
}

/// Where the model itself has been, inverse kinematics finds a way.
#[test]
fn inverse_kinematics_finds_poses_made_by_the_model() {
    for name in ["weightless-a", "weightless-b", "weightless-c"] {
        let limb = Limb::new(&scene(name)).unwrap();
        for step in 0..30_u32 {
            let share = |i: u32| f64::from((step * (7 + 4 * i) + 3 * i) % 31) / 31.0 * 0.8;
            let states: Vec<_> =
                limb.modules().iter().zip(0..).map(|(m, i)| m.curve.at(share(i) * m.curve.pressure_max_pa())).collect();
            let target = limb.tip(&states);
            let reach = solve_tip(&limb, target, &[0.0; 3]);
            assert!(reach.reached(), "{name} {step}: {} mm away", reach.distance_m * 1e3);
            assert!(reach.pressures_pa.iter().all(|p| (0.0..=100e3).contains(p)));
        }
    }
}

#[test]
fn impossible_goals_are_reported_at_their_line() {
    let error = changed("weightless-a", "\"75 deg\"", "\"350 deg\"").unwrap_err();
    assert!(error.contains("bend_angle = \"350 deg\"") && error.contains("`elbow` would need"), "{error}");
    assert!(error.contains("it reaches 0.00 deg to"), "{error}");
    let error = changed("weightless-a", "axial_stretch = 1.16", "axial_stretch = 0.9").unwrap_err();
    assert!(error.contains("a vacuum, which the valves cannot make"), "{error}");
    let error = changed("tip-waypoints", "tip = [0.768, -0.172, 0.895]", "tip = [2, 0, 0]").unwrap_err();
    assert!(
        error.contains("the limb cannot reach this way-point") && error.contains("nearest reachable point"),
        "{error}"
    );
    let error = changed("weightless-a", "[limits]", "[limits]\nangle_rate_max = \"10 deg/s\"").unwrap_err();
    assert!(error.contains("this move is too fast") && error.contains("a duration of 7.50 s is enough"), "{error}");
}

/// A finger that only fills: the air of the run is that in chamber and line at the end, less that at the start.
#[test]
fn air_of_a_run_that_only_fills_is_what_is_in_the_chamber() {
    let scene = scene("single-bending");
    let limb = Limb::new(&scene).unwrap();
    let plan = motion::plan(&scene, &limb).unwrap();
    let demand = motion::air_demand(&scene, &limb, &Sent::uncorrected(&limb, &plan));
    let (ambient, dead_m3) = (&scene.plant().ambient, motion::dead_volume_m3(&scene));
    let ends = [0, plan.duration_us()].map(|time_us| plan.states_at(time_us as f64)[0]);
    let joule = ends.map(|state| (state.pressure_pa + ambient.pressure_pa) * (state.volume_m3 + dead_m3));
    // At ISO 8778's reference the density of air is 1.185 kg/m3.
    let expected_m3 = (joule[1] - joule[0]) / (287.05 * ambient.temperature_k * 1.185);
    assert!((demand.volume_m3 / expected_m3 - 1.0).abs() < 1e-9, "{demand:?} {expected_m3}");
    assert!(demand.supply_min_pa > 0.0);
}
