//! The scenes that come with the tool.

use std::path::PathBuf;

use fra_model::{Actuator, Load, StateQuantity, Status, Target};
use softlimb_scene::{Goal, Module, Scene, load};

const PICK_AND_PLACE: [&str; 3] = ["weightless-a", "weightless-b", "weightless-c"];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

#[track_caller]
fn scene(name: &str) -> Scene {
    load(folder().join(format!("{name}.toml"))).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

#[test]
fn scenes_load_under_their_own_name() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_stem().unwrap().to_str().unwrap();
            let scene = scene(name);
            assert_eq!(scene.name(), name);
            assert_eq!(scene.source_text(), std::fs::read_to_string(&path).unwrap());
            count += 1;
        }
    }
    assert!(count >= 5, "{count}");
}

#[test]
fn pick_and_place_limbs_have_the_size_of_the_paper() {
    for name in PICK_AND_PLACE {
        let scene = scene(name);
        assert_eq!((scene.modules().len(), scene.channels(), scene.phases().len()), (3, 9, 4), "{name}");
        // 3 x (240 + 15) mm + 50 mm; 9 walls of pi (14^2 - 10^2) mm2 x 240 mm at 1080 kg/m3, 3 x 0.3 kg, 0.4 kg.
        assert!((scene.rest_length_m() - 0.815).abs() < 1e-12, "{name}: {}", scene.rest_length_m());
        let walls = 9.0 * std::f64::consts::PI * 96e-6 * 0.24 * 1080.0;
        assert!((scene.mass_kg() - (walls + 1.3)).abs() < 1e-9, "{name}: {}", scene.mass_kg());
        assert!((scene.mass_kg() - 2.0).abs() < 0.1, "{name}: {}", scene.mass_kg());
        assert!(scene.duration_us() <= 20_000_000, "{name}");
    }
}

/// The pressure a target needs, by the model, without load.
fn pressure_pa(module: &Module, kind: StateQuantity, value: f64) -> f64 {
    let target = match kind {
        StateQuantity::Pressure => return value,
        StateQuantity::AxialStretch => Target::AxialStretch(value),
        StateQuantity::OuterRadius => Target::OuterRadius(value),
        StateQuantity::InnerRadius => Target::InnerRadius(value),
        StateQuantity::Twist => Target::Twist(value),
        StateQuantity::BendAngle => Target::BendAngle(value),
    };
    let solution = Actuator::new(&module.actuator()).unwrap().inverse(target, &Load::none()).unwrap();
    assert_eq!(solution.status, Status::Solved, "{} {value}", module.name.value);
    solution.state.pressure_pa
}

#[test]
fn every_target_is_within_its_pressure() {
    for name in PICK_AND_PLACE.into_iter().chain(["single-bending"]) {
        let scene = scene(name);
        let mut count = 0;
        for phase in scene.phases() {
            let Goal::Targets(targets) = &phase.goal else { panic!("{name}: a way-point") };
            for target in targets {
                let module = &scene.modules()[target.module];
                assert_eq!(target.kind, module.setpoint_kind);
                let pressure = pressure_pa(module, target.kind, *target.value);
                assert!((0.0..0.9 * *module.pressure_max_pa).contains(&pressure), "{name}: {pressure} Pa");
                count += 1;
            }
        }
        assert!(count >= 3, "{name}: {count}");
    }
}

#[test]
fn way_points_are_within_reach() {
    let scene = scene("tip-waypoints");
    for phase in scene.phases() {
        let Goal::Tip(tip) = &phase.goal else { panic!("targets") };
        let base = scene.limb().base_position_m;
        let distance = tip.iter().zip(base).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        assert!(distance < scene.rest_length_m() * 1.1, "{}: {distance} m", phase.name.value);
    }
}
