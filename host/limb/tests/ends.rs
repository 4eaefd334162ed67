//! What end caps take out of a motion.

use fra_model::{Actuator, Load, State};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Load as Weights, LoadedLimb};
use softlimb_scene::{Scene, parse};

const LENGTH_M: f64 = 0.2;
const END_M: f64 = 4e-3;

/// An upright limb of a twisting, an extending and a bending module.
fn scene(end: &str) -> Scene {
    let module = |name: &str, motion: &str, rest: &str| {
        format!(
            "[[module]]\nname = \"{name}\"\nmotion = \"{motion}\"\nactuators = 1\ninner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\n\
             length = \"200 mm\"\nmaterial = \"silicone\"\n{end}{rest}"
        )
    };
    let text = format!(
        "format = 1\nname = \"ends\"\n[materials.silicone]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.223 MPa\"\n\
         [windings.helix]\nangle = \"28 deg\"\nfamilies = 1\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [windings.hoop]\nangle = \"3 deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [limb]\nbase_direction = [0, 0, 1]\nbase_up = [1, 0, 0]\nconnector = {{ length = \"15 mm\", mass = \"100 g\" }}\n{}{}{}\
         [[phase]]\nname = \"rest\"\nduration = 1\ntargets = {{ turn = {{ twist = \"0 deg\" }} }}\n",
        module("turn", "twisting", "winding = \"helix\"\n"),
        module("reach", "extension", "winding = \"hoop\"\n"),
        module("bend", "bending", ""),
    );
    parse(&text, "ends.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn limb(end: &str) -> Limb {
    Limb::new(&scene(end)).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn states(limb: &Limb, pressure_pa: f64) -> Vec<State<f64>> {
    limb.modules().iter().map(|module| module.curve.at(pressure_pa)).collect()
}

#[test]
fn limb_at_rest_is_as_long_with_ends_as_without() {
    let (with, without) = (limb("end_length = \"4 mm\"\n"), limb(""));
    let tip = |limb: &Limb| limb.tip(&states(limb, 0.0));
    for (a, b) in tip(&with).iter().zip(tip(&without)) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert!((tip(&with)[2] - 3.0 * (LENGTH_M + 15e-3)).abs() < 1e-12);
}

/// Strain, bend and twist of a uniform tube are the same all along: an end takes its share of the length.
#[test]
fn ends_take_their_share_of_each_motion() {
    let (with, without) = (limb("end_length = \"4 mm\"\n"), limb(""));
    let share = 1.0 - 2.0 * END_M / LENGTH_M;
    let [a, b] = [&with, &without].map(|limb| states(limb, 10e3));
    assert!((a[0].twist_rad / (share * b[0].twist_rad) - 1.0).abs() < 1e-9, "{:?}", a[0]);
    assert!((a[2].bend_angle_rad / (share * b[2].bend_angle_rad) - 1.0).abs() < 1e-9, "{:?}", a[2]);
    // The extending module alone moves the tip of a straight limb.
    let rest = states(&with, 0.0);
    let moved = with.tip(&[rest[0], a[1], rest[2]])[2] - with.tip(&rest)[2];
    let made = scene("").modules()[1].actuator();
    let strain = Actuator::new(&made).expect("valid").forward(10e3, &Load::none()).expect("finite").state.axial_strain;
    assert!((moved / (share * LENGTH_M * strain) - 1.0).abs() < 1e-6, "{moved}");
}

/// The tip of the rods without load is that of the kinematics, and walls weigh what they weigh.
#[test]
fn statics_have_the_rigid_ends() {
    let (scene, limb) = (scene("end_length = \"4 mm\"\n"), limb("end_length = \"4 mm\"\n"));
    let pressures_pa = [5e3; 3];
    let bays: Vec<usize> = limb.modules().iter().map(|module| module.bays()).collect();
    let loaded = LoadedLimb::new(&scene, &limb, &pressures_pa, &bays, &Weights::default()).expect("an equilibrium");
    let tip = limb.tip_pose(&states(&limb, 5e3));
    assert!((loaded.free_tip().translation.vector - tip.translation.vector).norm() < 1e-6);
    // Walls of the whole length: pi (14^2 - 10^2) mm2 of 200 mm at 1080 kg/m3, three times; three connectors.
    let walls_kg = 3.0 * std::f64::consts::PI * 96e-6 * LENGTH_M * 1080.0;
    let all_kg: f64 = loaded
        .rod
        .pieces
        .iter()
        .map(|piece| piece.kg_per_m * piece.length_m + piece.masses.iter().map(|(_, kg)| kg).sum::<f64>())
        .sum();
    assert!((all_kg - walls_kg - 0.3).abs() < 1e-9, "{all_kg}");
}

#[test]
fn ends_longer_than_the_actuator_are_refused_at_their_line() {
    let text = "format = 1\nname = \"t\"\n[materials.m]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"\n[limb]\n\
                connector = { length = 0, mass = 0 }\n[[module]]\nname = \"b\"\nmotion = \"bending\"\nactuators = 1\n\
                inner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"200 mm\"\nend_length = \"100 mm\"\nmaterial = \"m\"\n\
                [[phase]]\nname = \"p\"\nduration = 1\ntargets = { b = { bend_angle = 0.0 } }\n";
    let error = parse(text, "t.toml").expect_err("no length is left").render(false);
    assert!(
        error.contains("`end_length` at both ends must be less than `length`") && error.contains("200 mm"),
        "{error}"
    );
}
