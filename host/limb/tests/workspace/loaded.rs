//! The workspace under weight: without it, against a spring, and what is not reached.

use softlimb_limb::Limb;
use softlimb_limb::statics::{GRAVITY_M_PER_S2, Load, LoadedLimb};
use softlimb_limb::workspace::{Command, Loaded, LoadedPoseError, Points, Workspace, extents, loaded_extents};
use softlimb_scene as scene;
use softlimb_scene::Scene;

use crate::workspace::{limb_of, text_with};

fn built(text: &str) -> (Scene, Limb) {
    let scene = scene::parse(text, "test.toml").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).expect("a limb");
    (scene, limb)
}

/// The reference limb with its base pointing elsewhere.
fn reference(direction: &str, up: &str) -> (Scene, Limb) {
    let file = format!("{}/../../scenes/weightless-a.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).expect("a scene");
    let turned = text
        .replace("base_direction = [1, 0, 0]", &format!("base_direction = {direction}"))
        .replace("base_up = [0, 0, 1]", &format!("base_up = {up}"));
    assert_ne!(text, turned);
    built(&turned)
}

fn hung<'a>(
    (scene, limb): &'a (Scene, Limb),
    bays: usize,
    payload_kg: f64,
) -> impl Fn(&[f64]) -> Option<LoadedLimb> + Sync + 'a {
    let bays = vec![bays; limb.modules().len()];
    move |pressures_pa| LoadedLimb::new(scene, limb, pressures_pa, &bays, &Load { payload_kg, ..Load::default() })
}

#[test]
fn workspace_without_weight_is_that_of_the_kinematics() {
    let both = limb_of("weightless-a");
    let space = Workspace::new(&both.1, Command::Modules).expect("a workspace");
    let hang = hung(&both, 1, 0.0);
    let loaded = Loaded::new(&space, |pressures_pa: &[f64]| {
        let mut limb = hang(pressures_pa)?;
        limb.rod.gravity_m_per_s2 *= 0.0;
        Some(limb)
    });
    let poses = loaded.sample(Points::Faces, 200, 1, 2);
    for (index, pose) in poses.iter().enumerate() {
        let exact = softlimb_limb::workspace::sample(&space, Points::Faces, 200, 1, 1)[index];
        let tip = pose.expect("nothing falls without weight");
        assert!(tip.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-6), "{tip:?} {exact:?}");
    }
    let (free, found) =
        (extents(&space).expect("extents"), loaded_extents(&loaded, &poses, (Points::Faces, 1), 2).expect("reached"));
    for index in 0..4 {
        let off = (found.range_m(index) - free.range_m(index)).abs();
        assert!(off < 1e-4 * free.range_m(index).max(1e-3), "{index}: {off:e}");
    }
}

/// A mass on an actuator is a mass on a spring: the lowest place is that of the pressure at which length and elongation are largest.
#[test]
fn hanging_actuator_is_a_spring() {
    let both =
        built(&text_with(&[("extension", 1, "")]).replace("base_direction = [0, 0, 1]", "base_direction = [0, 0, -1]"));
    let space = Workspace::new(&both.1, Command::Actuators).expect("a workspace");
    let kg = 0.2;
    let loaded = Loaded::new(&space, hung(&both, 1, kg));
    let poses = loaded.sample(Points::Faces, 64, 1, 1);
    assert_eq!(loaded.tally(&poses).reached, 64);
    let found = loaded_extents(&loaded, &poses, (Points::Faces, 1), 1).expect("reached");
    let module = &both.1.modules()[0];
    let depth = |share: f64| {
        let wall_kg = both.0.mass_kg() - both.0.limb().connector_mass_kg;
        let load = fra_model::Load { force_n: GRAVITY_M_PER_S2 * (kg + 0.5 * wall_kg), torque_nm: 0.0 };
        let pressure_pa = share * space.axes()[0].pressure_max_pa;
        module.length_m() * module.actuator.forward(pressure_pa, &load).expect("finite").state.axial_stretch
    };
    let all: Vec<f64> = (0..=1000).map(|i| depth(f64::from(i) * 1e-3)).collect();
    let (most, least) = all.iter().fold((0.0_f64, 9.0_f64), |(most, least), d| (most.max(*d), least.min(*d)));
    assert!((found.of[2][0].value_m + most).abs() < 1e-6, "{} {most}", found.of[2][0].value_m);
    assert!((found.of[2][1].value_m + least).abs() < 1e-6, "{} {least}", found.of[2][1].value_m);
}

#[test]
fn poses_are_the_same_on_any_number_of_threads() {
    let both = reference("[0, 0, -1]", "[1, 0, 0]");
    let space = Workspace::new(&both.1, Command::Modules).expect("a workspace");
    let loaded = Loaded::new(&space, hung(&both, 4, 0.3));
    let one = loaded.sample(Points::Faces, 150, 1, 1);
    let first = loaded_extents(&loaded, &one, (Points::Faces, 1), 1).expect("reached");
    for threads in [2, 3] {
        assert_eq!(one, loaded.sample(Points::Faces, 150, 1, threads));
        assert_eq!(Some(&first), loaded_extents(&loaded, &one, (Points::Faces, 1), threads).as_ref());
    }
    assert_eq!(one[..40], loaded.sample(Points::Faces, 40, 1, 2));
}

#[test]
fn poses_that_fall_or_buckle_are_counted_and_not_reached() {
    let heavy = reference("[0, 0, 1]", "[1, 0, 0]");
    let space = Workspace::new(&heavy.1, Command::Actuators).expect("a workspace");
    let loaded = Loaded::new(&space, hung(&heavy, 1, 50.0));
    let poses = loaded.sample(Points::Faces, 60, 1, 2);
    let tally = loaded.tally(&poses);
    assert_eq!((tally.reached, tally.total()), (0, 60), "{tally:?}");
    assert!(loaded_extents(&loaded, &poses, (Points::Faces, 1), 2).is_none());
    // Level, with slender bays: some of both.
    let level = limb_of("weightless-a");
    let space = Workspace::new(&level.1, Command::Actuators).expect("a workspace");
    let loaded = Loaded::new(&space, hung(&level, 2, 0.0));
    let poses = loaded.sample(Points::Faces, 200, 1, 2);
    let tally = loaded.tally(&poses);
    assert!(tally.total() == 200 && tally.reached < 200 && tally.buckles.iter().sum::<usize>() > 0, "{tally:?}");
    let buckles = |pose: &&Result<[f64; 3], LoadedPoseError>| matches!(pose, Err(LoadedPoseError::Buckles(_)));
    assert_eq!(poses.iter().filter(buckles).count(), tally.buckles.iter().sum::<usize>());
}

/// The scenes' limb hung up as the paper's was, under parts of its weight, for `docs/explanation/workspace.md`: the more of it, the less it lifts itself.
#[test]
fn the_hanging_limb_beside_the_paper_s() {
    let both = reference("[0, 0, -1]", "[1, 0, 0]");
    let space = Workspace::new(&both.1, Command::Actuators).expect("a workspace");
    let free = extents(&space).expect("extents");
    let print = |name: &str, range: &dyn Fn(usize) -> f64| {
        println!("{name:28} {}", [0, 1, 2].map(|axis| format!("{:.2}", range(axis))).join(" x "));
    };
    print("without weight", &|axis| free.range_m(axis));
    let mut last = free.range_m(2);
    for share in [0.1, 0.25, 0.5, 1.0] {
        let hang = hung(&both, 8, 0.0);
        let loaded = Loaded::new(&space, |pressures_pa: &[f64]| {
            let mut limb = hang(pressures_pa)?;
            limb.rod.gravity_m_per_s2 *= share;
            Some(limb)
        });
        let poses = loaded.sample(Points::Faces, 100, 1, 2);
        let found = loaded_extents(&loaded, &poses, (Points::Faces, 1), 2).expect("reached");
        print(&format!("{share} of {:.2} kg", both.0.mass_kg()), &|axis| found.range_m(axis));
        println!("    {:?}", loaded.tally(&poses));
        assert!(found.range_m(2) < last, "{share}: {} {last}", found.range_m(2));
        last = found.range_m(2);
    }
    print("paper, Fig. 8", &|axis| [0.81, 0.79, 1.20][axis]);
}
