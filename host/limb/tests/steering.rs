//! Steering modules: the closed kinematics of a limb against the statics of their tubes.

use nalgebra::Vector3;
use softlimb_limb::Limb;
use softlimb_limb::statics::{Bundle, Tangent};
use softlimb_scene as scene;

fn limb() -> Limb {
    let path = format!("{}/../../scenes/steering.toml", env!("CARGO_MANIFEST_DIR"));
    Limb::new(&scene::load(path).expect("a scene")).expect("a limb")
}

#[test]
fn each_actuator_of_a_steering_module_is_a_drive() {
    let limb = limb();
    assert!(limb.is_steering() && limb.modules().len() == 2 && limb.drives().len() == 6);
    let names: Vec<String> = limb.drives().map(|drive| drive.name()).collect();
    assert_eq!(names, ["upper.1", "upper.2", "upper.3", "lower.1", "lower.2", "lower.3"]);
    assert_eq!((limb.drives_of(0), limb.drives_of(1)), (0..3, 3..6));
    assert!(limb.drives().enumerate().all(|(index, drive)| drive.channels == (index..index + 1)));
}

/// Equal tubes at unequal stretches: the statics bend less by `1 + 2b/(k r^2)`, as [`fra_model::Segment::of_stretches`] states.
#[test]
fn bending_stiffness_of_the_tubes_is_what_the_kinematics_leave_out() {
    let limb = limb();
    let module = &limb.modules()[0];
    let tangent = Tangent::of(&module.actuator, 60e3).expect("an equilibrium");
    let (length_m, radius_m) = (module.length_m(), module.reach_m());
    let mean_nm2 = 0.5 * (tangent.bending_nm2 + tangent.across_nm2);
    assert!(
        (tangent.bending_nm2 - tangent.across_nm2).abs() < 1e-9 * mean_nm2,
        "a straight tube bends alike both ways"
    );
    let factor = 1.0 + 2.0 * mean_nm2 / (tangent.axial_n * radius_m * radius_m);
    for stretches in [[1.2, 1.1, 1.1], [1.05, 1.21, 1.3], [1.1; 3]] {
        let tubes = module.positions_m().into_iter().zip(stretches);
        let tubes = tubes.map(|(place, stretch)| (place, Tangent { stretch, ..tangent })).collect();
        let free = Bundle::of_tubes(module.motion, tubes, module.bay_m()).expect("a minimum").free;
        let (segment, towards_rad) = fra_model::Segment::of_stretches(length_m, radius_m, &stretches).expect("three");
        let bend = segment.bend_angle_rad / length_m;
        assert!((free.stretch * length_m - segment.length_m).abs() < 1e-12);
        for (found, share) in free.bend_rad_per_m.iter().zip([towards_rad.cos(), towards_rad.sin()]) {
            assert!((found * factor - bend * share).abs() < 1e-9, "{stretches:?}: {free:?} {bend} {towards_rad}");
        }
    }
}

/// The whole limb: the tip by the kinematics is where the statics without load have it, but for the tubes' own bending stiffness.
#[test]
fn tip_is_near_that_of_the_statics_without_load() {
    let limb = limb();
    let scene = scene::load(format!("{}/../../scenes/steering.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene");
    let bays: Vec<usize> = limb.modules().iter().map(softlimb_limb::LimbModule::bays).collect();
    let mut largest = 0.0_f64;
    for pressures_kpa in [[60.0; 6], [100.0, 40.0, 60.0, 30.0, 90.0, 60.0], [20.0, 80.0, 110.0, 20.0, 70.0, 100.0]] {
        let pressures_pa = pressures_kpa.map(|kpa| 1e3 * kpa);
        let states: Vec<_> = limb.drives().zip(&pressures_pa).map(|(drive, pa)| drive.curve.at(*pa)).collect();
        let load = softlimb_limb::statics::Load::default();
        let loaded =
            softlimb_limb::statics::LoadedLimb::new(&scene, &limb, &pressures_pa, &bays, &load).expect("bundles");
        let apart_m = (Vector3::from(limb.tip(&states)) - loaded.free_tip().translation.vector).norm();
        let aside_m = Vector3::from(limb.tip(&states)).xy().norm();
        println!("{pressures_kpa:?} kPa: {:.2} mm apart, {:.1} mm aside", 1e3 * apart_m, 1e3 * aside_m);
        largest = largest.max(apart_m / scene.rest_length_m());
        if pressures_kpa == [60.0; 6] {
            assert!(apart_m < 1e-5 && aside_m < 1e-9, "equal pressures bend nothing: {apart_m} {aside_m}");
        }
    }
    assert!(largest > 1e-3 && largest < 0.1, "{largest}");
}
