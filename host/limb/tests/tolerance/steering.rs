//! Steering modules: tolerances at a pressure for each actuator, against the plain module, differences of arcs in closed form, and limbs made by seed.

use std::f64::consts::TAU;

use fra_model::Actuator;
use nalgebra::{Matrix3, Vector3};
use softlimb_limb::Limb;
use softlimb_limb::statics::Tangent;
use softlimb_limb::tolerance::{Kind, Statistics, Study, Varied, linear, sample};

use crate::tolerance::{limb_of, pose, settings};

const LENGTH_M: f64 = 0.24;
const RIGID_M: f64 = 0.02;
const CIRCLE_M: f64 = 0.03;
const UNEQUAL_KPA: [f64; 3] = [70.0, 20.0, 40.0];

fn module(steering: bool) -> Limb {
    limb_of(&[("extension", "slant", 3, if steering { "steering = true" } else { "" })])
}

/// The plain module has exact derivatives, this one differences.
#[test]
fn equal_pressures_move_the_tip_as_the_plain_module_does() {
    let (plain, steering) = (module(false), module(true));
    for shared_modulus in [false, true] {
        let settings = softlimb_limb::tolerance::Settings { shared_modulus, ..settings(0.1, 1.0, 10.0) };
        let (one, three) = (pose(&[45.0]), pose(&[45.0; 3]));
        let plain = Study::new(&plain, &one, settings).expect("a study");
        let steering = Study::new(&steering, &three, settings).expect("a study");
        assert!((plain.nominal_tip_m(0) - steering.nominal_tip_m(0)).norm() < 1e-12);
        let [exact, found] = [&plain, &steering].map(|study| linear(study).expect("derivatives"));
        for varied in Varied::all(1) {
            let [exact, found] = [&exact, &found].map(|found| found[0].mean_square_of_m2(varied));
            assert!((found / exact - 1.0).abs() < 1e-5, "{varied:?}: {found} {exact}");
        }
    }
}

/// The tip of one module: the least of `sum k (l - u . r - l_i)^2 + b u^2`, then an arc and the rigid part.
fn tip(tubes: [Tangent; 3]) -> Vector3<f64> {
    let (mut stiffness, mut force) = (Matrix3::zeros(), Vector3::zeros());
    for (index, tube) in tubes.into_iter().enumerate() {
        let (sin, cos) = (TAU * index as f64 / 3.0).sin_cos();
        let arm = Vector3::new(1.0, -CIRCLE_M * cos, -CIRCLE_M * sin);
        let own = Matrix3::from_diagonal(&Vector3::new(0.0, tube.bending_nm2, tube.bending_nm2));
        stiffness += arm * arm.transpose() * tube.axial_n + own;
        force += arm * (tube.axial_n * tube.stretch);
    }
    let shape = stiffness.lu().solve(&force).expect("a minimum");
    let (angle, length_m) = (LENGTH_M * shape.y.hypot(shape.z), LENGTH_M * shape.x);
    let (sin, cos) = angle.sin_cos();
    let (aside, along) = (length_m * (1.0 - cos) / angle + RIGID_M * sin, length_m * sin / angle + RIGID_M * cos);
    Vector3::new(shape.y * aside, shape.z * aside, along * angle / LENGTH_M) * (LENGTH_M / angle)
}

#[test]
fn unequal_pressures_move_the_tip_as_differences_of_arcs_say() {
    let limb = module(true);
    let poses = pose(&UNEQUAL_KPA);
    let study = Study::new(&limb, &poses, settings(0.1, 1.0, 10.0)).expect("a study");
    let parameters = limb.modules()[0].actuator.parameters();
    // Outer radius and winding with the wall, fiber angle, modulus.
    let made = |kind: Kind, off: f64, kpa: f64| {
        let mut one = *parameters;
        let fiber = one.fiber.as_mut().expect("a winding");
        match kind {
            Kind::Wall => (one.outer_radius_m, fiber.radius_m) = (one.outer_radius_m + off, fiber.radius_m + off),
            Kind::Angle => fiber.angle_rad += off,
            Kind::Modulus => {
                one.material = fra_model::Material::NeoHookean { shear_modulus_pa: 0.2e6 * (1.0 + off) };
            }
        }
        Tangent::of(&Actuator::new(&one).expect("in range"), 1e3 * kpa).expect("an equilibrium")
    };
    let nominal = UNEQUAL_KPA.map(|kpa| made(Kind::Wall, 0.0, kpa));
    assert!((tip(nominal) - study.nominal_tip_m(0)).norm() < 1e-9, "{} {}", tip(nominal), study.nominal_tip_m(0));
    let found = linear(&study).expect("derivatives");
    for (kind, width, step) in
        [(Kind::Wall, 1e-4, 5e-6), (Kind::Angle, 1_f64.to_radians(), 5e-4), (Kind::Modulus, 0.1, 1e-3)]
    {
        let by = |actuator: usize| {
            let side = |sign: f64| {
                let mut tubes = nominal;
                tubes[actuator] = made(kind, sign * step, UNEQUAL_KPA[actuator]);
                tip(tubes)
            };
            (side(1.0) - side(-1.0)) * (width / (2.0 * step))
        };
        let expected = (0..3).map(|actuator| by(actuator).norm_squared()).sum::<f64>() / 3.0;
        let share = found[0].mean_square_of_m2(Varied::Kind(kind));
        assert!((share / expected - 1.0).abs() < 1e-4, "{kind:?}: {share} {expected}");
    }
}

/// What the derivatives leave out of limbs made by seed falls with the square of the tolerances.
#[test]
fn samples_of_unequal_pressures_follow_the_derivatives() {
    let limb = limb_of(&[("extension", "slant", 3, "steering = true"), ("bending", "", 2, "mount_angle = \"50 deg\"")]);
    let poses = pose(&[70.0, 20.0, 40.0, 30.0]);
    let off = |scale: f64| {
        let study = Study::new(&limb, &poses, settings(0.1 * scale, scale, 10.0 * scale)).expect("a study");
        let found = linear(&study).expect("derivatives");
        let statistics = Statistics::new(&found, &sample(&study, &found, 40, 1, 2), 2);
        assert_eq!((statistics.poses[0].answered, statistics.poses[0].lost.clone()), (40, vec![0, 0]));
        statistics.poses[0].departure()
    };
    let [coarse, fine] = [0.02, 0.01].map(off);
    assert!(coarse < 5e-3 && (coarse / fine - 2.0).abs() < 0.1, "{coarse} {fine}");
}

#[test]
fn another_number_of_pressures_is_refused() {
    let limb = module(true);
    let error = Study::new(&limb, &pose(&[45.0]), settings(0.1, 1.0, 10.0)).expect_err("one of three").to_string();
    assert!(error.contains("pressures_pa") && error.contains("one for each setpoint, 3 values"), "{error}");
}
