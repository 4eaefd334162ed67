//! Setpoints corrected for weight.

use fra_model::State;
use nalgebra::Vector3;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb, by_tubes};
use softlimb_limb::{Limb, LimbModule};
use softlimb_motion as motion;
use softlimb_motion::{Nominal, Plan, carried, payload_kg};
use softlimb_scene::Scene;

use crate::weight::{HANGING, NO_SPREAD, before, log, longer_m, parsed, repository};

fn planned(scene: &Scene) -> (Limb, Plan) {
    let limb = Limb::new(scene).expect("a limb");
    let plan = motion::plan(scene, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    (limb, plan)
}

fn refused(scene: &Scene) -> String {
    let limb = Limb::new(scene).expect("a limb");
    match motion::plan(scene, &limb) {
        Ok(_) => panic!("it is planned"),
        Err(error) => error.render(false),
    }
}

/// The tip of the loaded nominal limb, by tubes between plates.
fn tip(scene: &Scene, limb: &Limb, states: &[State<f64>], payload_kg: f64) -> Vector3<f64> {
    let channels: Vec<f64> = states.iter().flat_map(|state| [state.pressure_pa.max(0.0); 3]).collect();
    let bays: Vec<usize> = scene.modules().iter().map(|module| usize::from(module.spacers) + 1).collect();
    let load = Load { payload_kg, ..Load::default() };
    let loaded = LoadedLimb::new(scene, limb, &channels, &bays, &load).expect("a bundle");
    by_tubes(&loaded, 1e-5, scene.rest_length_m()).expect("it stands").tip().translation.vector
}

#[test]
fn under_load_the_tip_is_at_the_goals_of_the_plan_without() {
    let without = repository("loaded/carry-hanging", "compensated = false\n");
    let scene = repository("loaded/carry-hanging", "");
    let ((limb, free), (_, plan)) = (planned(&without), planned(&scene));
    assert!(free.weighed().is_none() && plan.weighed().expect("corrected").error < 1e-3);
    for (phase, carried) in plan.phases.iter().zip(carried(scene.phases())) {
        // A mass changes hands from the end of the move to that of the hold: at both ends, and in between.
        for (share, kg) in [
            (0.0, carried.moved.payload_kg),
            (0.5, 0.5 * (carried.moved.payload_kg + carried.held.payload_kg)),
            (1.0, carried.held.payload_kg),
        ] {
            let time_us = (phase.start_us + phase.move_us) as f64 + share * phase.hold_us as f64;
            let goal = Vector3::from(limb.tip(&free.states_at(time_us)));
            let off = |plan: &Plan| (tip(&scene, &limb, &plan.states_at(time_us), kg) - goal).norm();
            let (sag, error) = (off(&free), off(&plan));
            let said = (Vector3::from(plan.tip_m(&limb, time_us)) - goal).norm();
            println!("{}: {:.1} mm off without correction, {:.4} with", phase.name, 1e3 * sag, 1e3 * error);
            assert!(error < 1e-4 && sag > 5e-3 && said < 1e-4, "{}: {error} {said}", phase.name);
        }
    }
}

#[test]
fn a_hanging_module_is_told_to_be_shorter_by_what_its_load_adds() {
    let scene = parsed(&(HANGING.to_owned() + "[weight]\n"));
    let (_, plan) = planned(&scene);
    let mut shorter = Vec::new();
    // At the ends of moves: before the object is picked up, with it, and before it is put down.
    for (phase, kg, goal) in [(0, 0.1, 1.06), (2, 0.15, 1.06), (3, 0.15, 1.05)] {
        let value = plan.phases[phase].values[0];
        let end_us = (plan.phases[phase].start_us + plan.phases[phase].move_us) as f64;
        let pressure_pa = plan.states_at(end_us)[0].pressure_pa;
        let expected = longer_m(&scene, pressure_pa, kg) / 0.24;
        println!("{}: {:.5} shorter, {expected:.5} by the tubes", plan.phases[phase].name, goal - value);
        assert!(((goal - value) / expected - 1.0).abs() < 0.01, "{value}");
        shorter.push(goal - value);
    }
    assert!(shorter[1] > 1.2 * shorter[0], "more load, more correction: {shorter:?}");
}

#[test]
fn derivatives_of_the_loaded_tip_are_those_of_differences() {
    let scene = repository("loaded/carry-hanging", "");
    let limb = Limb::new(&scene).expect("a limb");
    let (pressures, spans, on) = ([30e3, 60e3, 20e3], [4e4, 15e4, 9e4], 0.7);
    let mut nominal = Nominal::new(&scene, &limb, Fidelity::Linear);
    let pose = nominal.at(&pressures, on).expect("it stands");
    let velocities = nominal.velocities_m_per_pa(&pose, &pressures).expect("stable");
    for (index, module) in limb.modules().iter().enumerate() {
        let mut sum = Vector3::zeros();
        for channel in module.channels.clone() {
            let mut moved = |way: f64| {
                let of_module = |(module, pressure_pa): (&LimbModule, f64)| vec![pressure_pa; module.channels.len()];
                let mut p: Vec<f64> = limb.modules().iter().zip(pressures).flat_map(of_module).collect();
                p[channel] += way * 1e-3 * spans[index];
                nominal.at_channels(&p, on).expect("it stands").tip_m()
            };
            let slope = (moved(1.0) - moved(-1.0)) / 2e-3;
            let velocity = velocities[channel] * spans[index];
            assert!((velocity - slope).norm() < 1e-4 * slope.norm(), "channel {channel}: {velocity} {slope}");
            sum += velocity;
        }
        let mut moved = |way: f64| {
            let mut p = pressures;
            p[index] += way * 1e-3 * spans[index];
            nominal.at(&p, on).expect("it stands").tip_m()
        };
        let slope = (moved(1.0) - moved(-1.0)) / 2e-3;
        assert!((sum - slope).norm() < 1e-4 * slope.norm(), "module {index}: {sum} {slope}");
    }
}

#[test]
fn setpoints_begin_at_rest_and_do_not_jump() {
    let (_, plan) = planned(&repository("loaded/carry-hanging", ""));
    assert!(plan.states_at(0.0).iter().all(|state| state.pressure_pa.abs() < 100.0));
    let period_us = plan.knot_period_us() as f64;
    for knot in 1..plan.knots().len() {
        let [a, b] = [knot - 1, knot].map(|knot| plan.states_at(knot as f64 * period_us));
        // A move takes some seconds from nothing to 100 kPa: 1 kPa in a knot of 20 ms.
        assert!(a.iter().zip(&b).all(|(a, b)| (a.pressure_pa - b.pressure_pa).abs() < 2.5e3), "knot {knot}");
    }
}

#[test]
fn on_the_nominal_limb_only_the_valves_are_left() {
    let rows = |more: &str| {
        let scene = repository("loaded/carry-hanging", &(more.to_owned() + NO_SPREAD));
        let log = log(&scene);
        assert_eq!(log.faults, []);
        // Just before the gripper acts.
        let ends = log.info.phases.iter().map(|phase| before(&log, phase.hold_start_s() - 1e-4).clone());
        ends.map(|sample| (Vector3::from(sample.tip_achieved_m.unwrap()) - Vector3::from(sample.tip_setpoint_m)).norm())
            .collect::<Vec<_>>()
    };
    let (corrected, bare) = (rows(""), rows("compensated = false\n"));
    println!("tip off its goals: {corrected:.5?} m corrected, {bare:.4?} m without");
    assert!(corrected.iter().all(|off| *off < 1.5e-3) && bare.iter().all(|off| *off > 5e-3));
}

#[test]
fn what_is_carried_follows_the_gripper() {
    let scene = parsed(&(HANGING.to_owned() + "[weight]\ncompensated = false\n"));
    let (_, plan) = planned(&scene);
    let carried = carried(scene.phases());
    let at = |time_s: f64| payload_kg(&carried, &plan.phases, (1e6 * time_s) as u64);
    // Changing hands within the holds from 1.8 s to 2.2 s and from 3.0 s to 3.4 s, half of it in half of the time.
    let known = [0.0, 0.0, 0.0, 0.025, 0.05, 0.05, 0.05, 0.025, 0.0, 0.0];
    for (time_s, kg) in [0.0, 1.3, 1.79, 2.0, 2.2, 2.3, 2.99, 3.2, 3.4, 9.0].into_iter().zip(known) {
        assert!((at(time_s) - kg).abs() < 1e-12, "{time_s} s: {}", at(time_s));
    }
}

#[test]
fn what_cannot_be_done_is_refused_at_its_line() {
    // Upright, under a connector that is heavier than what its tubes buckle at.
    let upright = HANGING.replace("base_direction = [0, 0, -1]", "base_direction = [0, 0, 1]");
    let text = refused(&parsed(&(upright.replace("mass = \"100 g\"", "mass = \"20 kg\"") + "[weight]\n")));
    assert!(text.contains("does not carry its own weight at rest"), "{text}");
    assert!(text.contains("spacers") && text.contains("loses its stability"), "{text}");
    let path = format!("{}/../../scenes/loaded/carry-hanging.toml", env!("CARGO_MANIFEST_DIR"));
    let heavy = std::fs::read_to_string(path).unwrap().replace("payload = \"1 kg\"", "payload = \"9 kg\"");
    let text = refused(&parsed(&heavy));
    assert!(
        text.contains("cannot reach this goal under its load") && text.contains("nearest reachable point"),
        "{text}"
    );
    assert!(text.contains("`wrist` is at its lowest pressure, 0"), "{text}");
}

/// A bender and an extender hang down under a hook: two setpoints, which leave the tip where the load has it.
const HOOK: &str = r#"
format = 1
name = "hook"
[windings.hoop]
angle = "4 deg"
families = 2
thread = { stiffness = "772 N", diameter = "0.178 mm", starts = 2 }
[limb]
base_position = [0, 0, 1.0]
base_direction = [0, 0, -1]
base_up = [1, 0, 0]
connector = { length = "15 mm", mass = "60 g" }
end_effector = { name = "hook", length = "30 mm", mass = "30 g" }
[[module]]
name = "bend"
motion = "bending"
actuators = 2
arrangement = "row"
spacing = "40 mm"
spacers = 3
inner_radius = "12 mm"
outer_radius = "18 mm"
length = "120 mm"
material = "Dragon Skin 30"
[[module]]
name = "reach"
motion = "extension"
actuators = 3
circle_radius = "35 mm"
spacers = 3
inner_radius = "10 mm"
outer_radius = "15 mm"
length = "100 mm"
material = "Dragon Skin 30"
winding = "hoop"
[[phase]]
name = "go"
payload = "20 kg"
duration = "2 s"
hold = "1 s"
targets = { bend = { bend_angle = "35 deg" }, reach = { axial_stretch = 1.15 } }
[limits]
pressure_max = "100 kPa"
[weight]
"#;

#[test]
fn load_beyond_the_statics_is_refused() {
    let text = refused(&parsed(HOOK));
    assert!(text.contains("deforms too far under its load") && text.contains("payload capacity"), "{text}");
    let text = refused(&parsed(&HOOK.replace("20 kg", "1.2 kg")));
    assert!(text.contains("`bend` would need more than 97.00 kPa"), "{text}");
}
