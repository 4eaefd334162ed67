//! A single query gets the answer of an actuator that is built for many, to the last bit.

use crate::common::*;
use fra_model::*;

/// Straight and bending, bare and wound in every way, neo-Hookean and Yeoh.
fn actuators() -> Vec<ActuatorParameters<f64>> {
    let mut all = vec![];
    for (motion, outer_mm, material) in [
        (Motion::Extension, 6.05, neo_hookean(2e5)),
        (Motion::Twisting, 8.0, neo_hookean(2e5)),
        (Motion::Expansion, 20.0, neo_hookean(1e4)),
        (Motion::Extension, 8.0, DRAGONSKIN_30),
        (Motion::Bending, 8.0, neo_hookean(2e5)),
    ] {
        let bare = tube(motion, 6.0, outer_mm, material);
        all.push(bare);
        let thickness_mm = 0.1 * (outer_mm - 6.0);
        for angle_deg in [0.0, 5.0, -30.0, 35.264389682754654, 70.0, 90.0] {
            for families in [Families::One, Families::Two] {
                for modulus_pa in [1e4, 1e7, 1e10] {
                    all.push(wound(bare, angle_deg, families, modulus_pa, Placement::Sheet, thickness_mm));
                }
                all.push(wound(bare, angle_deg, families, 1e7, Placement::Layer, thickness_mm));
            }
        }
    }
    all
}

/// `Debug` prints every bit of a float, and the sign of zero.
fn answers<T: Precision>(p: &ActuatorParameters<T>, pressure_pa: T, load: &Load<T>) -> [String; 2] {
    let many = Actuator::new(p).and_then(|actuator| actuator.forward(pressure_pa, load));
    [format!("{:?}", Actuator::forward_once(p, pressure_pa, load)), format!("{many:?}")]
}

#[test]
fn single_query_is_answered_as_many_are() {
    let pull = Load { force_n: 0.1, torque_nm: 0.0 };
    for p in actuators() {
        let limit_pa = p.material.shear_modulus_pa() * (p.outer_radius_m / p.inner_radius_m).ln();
        // From pressures that the first term of the series answers to those beyond the end of the branch.
        for share in [-0.5, -1e-3, 0.0, 1e-9, 1e-4, 3e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.8, 1.5] {
            let pressure_pa = share * limit_pa;
            let [once, many] = answers(&p, pressure_pa, &Load::none());
            assert_eq!(once, many, "{p:?} {pressure_pa}");
            let [once, many] = answers(&single(&p), pressure_pa as f32, &Load::none());
            assert_eq!(once, many, "{p:?} {pressure_pa} in f32");
        }
        let [once, many] = answers(&p, 0.1 * limit_pa, &pull);
        assert_eq!(once, many, "{p:?} under a load");
    }
}

#[test]
fn single_query_is_refused_as_many_are() {
    let good = tube(Motion::Extension, 6.0, 8.0, neo_hookean(2e5));
    let flat = tube(Motion::Extension, 8.0, 6.0, neo_hookean(2e5));
    let endless = Load { force_n: f64::INFINITY, torque_nm: 0.0 };
    for (p, pressure_pa, load, field) in [
        (flat, f64::NAN, endless, "outer_radius_m"),
        (good, f64::NAN, endless, "external_force_n"),
        (good, f64::NAN, Load::none(), "pressure_pa"),
    ] {
        let refused = Actuator::forward_once(&p, pressure_pa, &load).expect_err("not accepted");
        assert_eq!(refused.field, field);
        let [once, many] = answers(&p, pressure_pa, &load);
        assert_eq!(once, many);
    }
}
