//! Benders by finite elements of their section. The expected tip of a specimen is the end of an arc whose bend is solved on the finer mesh.

use fra_model::{ActuatorParameters, Fiber, Material};
use nalgebra::Vector3;
use softlimb_fea::cross_section::{EndLoad, Options, Section, SectionState};
use softlimb_limb::Limb;
use softlimb_limb::fabricate::Tolerances;
use softlimb_limb::tolerance::{Kind, Pose, Settings, Statistics, Study, Varied, linear, sample};
use softlimb_numerics::Random;

use softlimb_scene::parse;

use crate::tolerance::text::text_of;
use crate::tolerance::{pose, settings};

const LENGTH_M: f64 = 0.24;
const RIGID_M: f64 = 0.02;
/// By name: the first winding, and the second.
const WINDINGS: [&str; 5] = ["slant", "soft", "slant soft", "helix mirrored", "soft helix"];

/// Without weight benders may twist.
fn weightless(modules: &[(&str, &str, u8, &str)]) -> Limb {
    let text = text_of(modules).replace("[limb]\n", "[weight]\nsimulated = false\n[limb]\n");
    Limb::new(&parse(&text, "test.toml").expect("a scene")).expect("a limb")
}

fn bender(winding: &str, actuators: u8) -> Limb {
    let limb = weightless(&[("bending", winding, actuators, "")]);
    assert!(limb.modules()[0].is_by_section(), "{winding}");
    limb
}

/// The actuator with walls, angles and moduli off: both windings wider or narrower alike.
fn specimen(limb: &Limb, tolerances: &Tolerances, place: [f64; 3]) -> (ActuatorParameters<f64>, Option<Fiber<f64>>) {
    let module = &limb.modules()[0];
    let mut parameters = *module.actuator.parameters();
    let Material::NeoHookean { shear_modulus_pa } = &mut parameters.material else { panic!("neo-Hookean") };
    *shear_modulus_pa *= 1.0 + tolerances.modulus * place[2];
    parameters.outer_radius_m += tolerances.wall_m * place[0];
    let off = |fiber: &Fiber<f64>| Fiber {
        // Sheets on the outer surface.
        radius_m: parameters.outer_radius_m,
        angle_rad: fiber.angle_rad.signum() * (fiber.angle_rad.abs() + tolerances.angle_rad * place[1]),
        ..*fiber
    };
    let second = module.second_fiber().map(off);
    parameters.fiber = parameters.fiber.as_ref().map(off);
    (parameters, second)
}

fn states(
    limb: &Limb,
    tolerances: &Tolerances,
    place: [f64; 3],
    pressures_pa: &[f64],
    moment_nm: f64,
) -> Vec<SectionState> {
    let (parameters, second) = specimen(limb, tolerances, place);
    let section = match &second {
        None => Section::new(&parameters, &Options::default()),
        Some(second) => Section::with_two_windings(&parameters, second, &Options::default()),
    };
    let load = EndLoad { bending_moments_nm: [moment_nm, 0.0], ..EndLoad::default() };
    let curve = section.expect("a section").curve(pressures_pa, &load).expect("in range");
    curve.answers.iter().map(|answer| answer.equilibrium().expect("an equilibrium").state).collect()
}

/// The end of a screw about the axis that it turns about, and of the rigid part behind it.
fn tip(state: &SectionState) -> Vector3<f64> {
    let state = state.over(LENGTH_M);
    let (bend, twist, length_m) = (state.bend_angle_rad, state.twist_rad, LENGTH_M * state.axial_stretch);
    let turn = bend.hypot(twist);
    let axis = Vector3::new(0.0, bend, twist) / turn;
    // Rodrigues, integrated along the centre line.
    let along = axis * axis.z;
    let (aside, across) = (Vector3::z() - along, axis.cross(&Vector3::z()));
    let (sin, cos) = turn.sin_cos();
    along * (length_m + RIGID_M)
        + aside * (length_m * sin / turn + RIGID_M * cos)
        + across * (length_m * (1.0 - cos) / turn + RIGID_M * sin)
}

/// The draws of a limb: wall, angle and modulus of each channel.
fn places(seed: u64, number: usize, channels: usize) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed, number as u64);
    (0..channels).map(|_| std::array::from_fn(|_| 2.0 * random.uniform() - 1.0)).collect()
}

fn poses(kpa: &[f64]) -> Vec<Pose> {
    kpa.iter().flat_map(|kpa| pose(&[*kpa])).collect()
}

#[test]
fn nominal_limb_is_that_of_the_plan() {
    for winding in WINDINGS {
        let limb = bender(winding, 1);
        let poses = poses(&[0.0, 13.0, 40.0]);
        let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
        for (index, pose) in poses.iter().enumerate() {
            let planned = Vector3::from(limb.tip([&limb.modules()[0].curve.at(pose.pressures_pa[0])]));
            let off = (study.nominal_tip_m(index) - planned).norm();
            assert!(off < 1e-12, "{winding} {}: {off}", pose.pressures_pa[0]);
        }
    }
}

/// The polynomial in the tolerances against specimens that are each solved.
#[test]
fn specimens_move_the_tip_as_their_own_finite_elements_do() {
    let kpa = [10.0, 25.0, 45.0];
    let pressures_pa = kpa.map(|kpa| 1e3 * kpa);
    for (scale, most) in [(1.0, 1e-3), (4.0, 2e-2)] {
        for winding in WINDINGS {
            let limb = bender(winding, 1);
            let poses = poses(&kpa);
            let settings = settings(0.1 * scale, scale, 10.0 * scale);
            let study = Study::new(&limb, &poses, settings).expect("a study");
            let samples = sample(&study, &linear(&study).expect("derivatives"), 8, 3, 2);
            let nominal = states(&limb, &settings.tolerances, [0.0; 3], &pressures_pa, 0.0);
            let (mut off, mut whole) = ([0.0; 3], [0.0; 3]);
            for (number, limb_made) in samples.iter().enumerate() {
                let found = states(&limb, &settings.tolerances, places(3, number, 1)[0], &pressures_pa, 0.0);
                for pose in 0..3 {
                    let expected = tip(&found[pose]) - tip(&nominal[pose]);
                    off[pose] += (limb_made[pose].displacement_m.expect("an equilibrium") - expected).norm_squared();
                    whole[pose] += expected.norm_squared();
                }
            }
            let off = [0, 1, 2].map(|pose: usize| (off[pose] / whole[pose]).sqrt());
            println!("{scale} {winding}: off by {off:?} of the RMS displacement");
            assert!(off.iter().all(|off| *off < most), "{scale} {winding}: {off:?}");
        }
    }
}

/// Finite elements of the section scale: moduli `1 + m` times as large bend as a pressure and threads less by that.
#[test]
fn derivative_by_the_modulus_is_that_by_pressure_and_thread() {
    for winding in ["slant", "soft"] {
        let limb = bender(winding, 1);
        let poses = pose(&[30.0]);
        let study = Study::new(&limb, &poses, settings(0.0, 0.0, 10.0)).expect("a study");
        let found = linear(&study).expect("derivatives")[0].mean_square_of_m2(Varied::Kind(Kind::Modulus)).sqrt();
        let scaled = |modulus: f64| {
            let (mut parameters, _) = specimen(&limb, &settings(0.0, 0.0, 0.0).tolerances, [0.0; 3]);
            parameters.fiber.as_mut().expect("wound").modulus_pa /= 1.0 + modulus;
            let section = Section::new(&parameters, &Options::default()).expect("a section");
            let curve = section.curve(&[30e3 / (1.0 + modulus)], &EndLoad::default()).expect("in range");
            tip(&curve.answers[0].equilibrium().expect("an equilibrium").state)
        };
        let expected = ((scaled(1e-3) - scaled(-1e-3)) / 2e-3 * 0.1).norm() / 3_f64.sqrt();
        println!("{winding}: off by {:.1e}", found / expected - 1.0);
        assert!((found / expected - 1.0).abs() < 1e-4, "{winding}: {found} {expected}");
    }
}

/// What the derivatives leave out falls with the square of the tolerances.
#[test]
fn small_tolerances_of_wound_benders_move_the_tip_as_their_derivatives_say() {
    for (winding, actuators) in [("slant", 3), ("slant soft", 2), ("soft helix", 1)] {
        let limb = weightless(&[("bending", winding, actuators, ""), ("extension", "slant", 1, "")]);
        let poses = pose(&[30.0, 20.0]);
        let off = |scale: f64| {
            let study = Study::new(&limb, &poses, settings(0.1 * scale, scale, 10.0 * scale)).expect("a study");
            let derivatives = linear(&study).expect("derivatives");
            Statistics::new(&derivatives, &sample(&study, &derivatives, 40, 1, 2), 2).poses[0].departure()
        };
        let [coarse, fine] = [0.02, 0.01].map(off);
        assert!(coarse < 5e-3 && (coarse / fine - 2.0).abs() < 0.1, "{winding} {actuators}: {coarse} {fine}");
    }
}

/// Benders in a row across the bend have the mean of their bends, by their stiffnesses.
#[test]
fn unlike_benders_share_their_bend_by_stiffness() {
    let limb = bender("slant", 2);
    let poses = pose(&[30.0]);
    let settings = Settings { shared_modulus: false, ..settings(0.0, 0.0, 10.0) };
    let study = Study::new(&limb, &poses, settings).expect("a study");
    let samples = sample(&study, &linear(&study).expect("derivatives"), 4, 1, 1);
    for (number, made) in samples.iter().enumerate() {
        let (mut stiffness, mut moment, mut mean) = (0.0, 0.0, 0.0);
        for place in places(1, number, 2) {
            let at = |moment_nm: f64| states(&limb, &settings.tolerances, place, &[30e3], moment_nm)[0];
            let bends = [-1e-3, 0.0, 1e-3].map(|moment_nm| at(moment_nm).bend_rates_rad_per_m[0]);
            let own = 2e-3 / (bends[2] - bends[0]);
            (stiffness, moment, mean) = (stiffness + own, moment + own * bends[1], mean + 0.5 * bends[1]);
        }
        let nominal = states(&limb, &settings.tolerances, [0.0; 3], &[30e3], 0.0)[0];
        let bent = |bend: f64| {
            // Of a line at the outer radius that keeps its length.
            let axial_stretch = nominal.axial_stretch + 14e-3 * (bend - nominal.bend_rates_rad_per_m[0]);
            tip(&SectionState { bend_rates_rad_per_m: [bend, 0.0], axial_stretch, ..nominal })
        };
        let found = made[0].displacement_m.expect("an equilibrium");
        let off = |bend: f64| {
            let expected = bent(bend) - bent(nominal.bend_rates_rad_per_m[0]);
            (found.x - expected.x).hypot(found.z - expected.z)
        };
        let off = [off(moment / stiffness), off(mean)];
        println!("{number}: off by {off:?} m of {}", found.norm());
        // The mean without stiffnesses is another.
        assert!(off[0] < 1e-3 * found.norm() && off[0] < 0.1 * off[1], "{number}: {off:?}");
    }
}

/// Beyond the end of its branch a specimen has no equilibrium; then each is solved.
#[test]
fn wound_benders_without_an_equilibrium_are_counted() {
    let limb = bender("weak", 1);
    let module = &limb.modules()[0];
    let most_kpa = 1e-3 * module.curve.limit_point_pa().expect("a limit point");
    let poses = pose(&[0.97 * most_kpa]);
    let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
    let derivatives = linear(&study).expect("derivatives");
    let samples = sample(&study, &derivatives, 12, 1, 2);
    let found = &Statistics::new(&derivatives, &samples, 1).poses[0];
    let expected = (0..12).filter(|number| {
        let (parameters, _) = specimen(&limb, &settings(0.1, 1.0, 10.0).tolerances, places(1, *number, 1)[0]);
        let section = Section::new(&parameters, &Options::default()).expect("a section");
        let curve = section.curve(&[0.97e3 * most_kpa], &EndLoad::default()).expect("in range");
        curve.answers[0].equilibrium().is_none()
    });
    assert!(found.lost_in_all() > 0 && found.lost_in_all() < 12, "{found:?}");
    assert_eq!(found.lost_in_all(), expected.count());
}
