//! Springs about the strains of a load, against the model of the actuator itself.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement};
use softlimb_limb::statics::{Bundle, Spring};

use super::tiers::loaded;
use softlimb_limb::statics::Fidelity;

fn actuator(motion: Motion) -> Actuator<f64> {
    let angle_deg: f64 = if motion == Motion::Twisting { -28.0 } else { 3.0 };
    Actuator::new(&ActuatorParameters {
        motion,
        inner_radius_m: 13e-3,
        outer_radius_m: 19e-3,
        length_m: 0.2,
        material: Material::NeoHookean { shear_modulus_pa: 0.223e6 },
        fiber: (motion != Motion::Bending).then(|| Fiber {
            angle_rad: angle_deg.to_radians(),
            families: if motion == Motion::Twisting { Families::One } else { Families::Two },
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 19e-3,
        }),
    })
    .expect("an actuator")
}

/// A tube under a force has the stretch at which its springs have that force.
#[test]
fn stretched_tubes_have_the_force_of_the_model() {
    let actuator = actuator(Motion::Extension);
    for (pressure_pa, force_n) in [(0.0, 5.0), (60e3, 12.0), (60e3, -20.0), (90e3, 30.0)] {
        let state = actuator.forward(pressure_pa, &Load { force_n, torque_nm: 0.0 }).expect("finite").state;
        let spring = Spring::new(&actuator, pressure_pa).expect("a tube");
        let there = spring.tangent_at(&[state.axial_stretch, 0.0, 0.0]).expect("stable");
        let found = there.axial_n * (state.axial_stretch - there.stretch);
        assert!((found - force_n).abs() < 1e-6 * force_n.abs(), "{pressure_pa} {force_n}: {found}");
        // The springs about the free shape are off by what the issue is about.
        let free = spring.tangent();
        println!(
            "{pressure_pa} Pa, {force_n} N: {:.2} N by the free springs",
            free.axial_n * (state.axial_stretch - free.stretch)
        );
    }
}

/// A tube that is wound to twist keeps the springs of its free shape.
#[test]
fn twisted_tubes_keep_their_free_springs() {
    let spring = Spring::new(&actuator(Motion::Twisting), 40e3).expect("a tube");
    assert_eq!(spring.tangent_at(&[1.2, 0.0, 3.0]), Some(spring.tangent()));
}

/// A bender that a moment straightens, or bends on.
#[test]
fn bent_tubes_have_the_moment_of_the_model() {
    let actuator = actuator(Motion::Bending);
    for torque_nm in [-0.3, 0.2] {
        let state = actuator.forward(80e3, &Load { force_n: 0.0, torque_nm }).expect("finite").state;
        let bend = state.bend_angle_rad / 0.2;
        let spring = Spring::new(&actuator, 80e3).expect("a tube");
        let there = spring.tangent_at(&[1.0, bend, 0.0]).expect("stable");
        let found = there.bending_nm2 * (bend - there.bend_rad_per_m);
        let free = spring.tangent();
        let by_free = free.bending_nm2 * (bend - free.bend_rad_per_m);
        println!("{torque_nm} N m at {bend:.2} rad/m: {found:.6} N m, {by_free:.3} by the free springs");
        assert!((found - torque_nm).abs() < 1e-8, "{found}");
    }
}

/// What has crept has its own shape without load.
#[test]
fn crept_tubes_are_free_in_their_own_shape() {
    let actuator = actuator(Motion::Bending);
    let free = actuator.forward(80e3, &Load::none()).expect("finite").state;
    let crept = actuator.forward(85e3, &Load::none()).expect("finite").state;
    let spring = Spring::new(&actuator, 80e3).expect("a tube").about(&crept);
    let at = spring.tangent_at(&[crept.axial_stretch, crept.bend_angle_rad / 0.2, 0.0]).expect("stable");
    let own = Spring::new(&actuator, 80e3).expect("a tube").tangent();
    assert!((at.bend_rad_per_m - crept.bend_angle_rad / 0.2).abs() < 1e-9);
    assert!((at.bending_nm2 / own.bending_nm2 - 1.0).abs() < 1e-9 && free.bend_angle_rad < crept.bend_angle_rad);
}

/// A settled limb has springs about the strains that it has, whatever it begins with.
#[test]
fn settled_limbs_are_about_their_own_strains() {
    let (limb, length_m) = loaded("[0, 0, -1]", 1.0, 30e3, 6, 0.3).expect("a limb");
    let cold = limb.settle(Fidelity::Double, None).expect("stands");
    let about = limb.at_strains(&cold.limb.strains(&cold.rod, &cold.shape.q)).expect("stable");
    let warm = about.settle(Fidelity::Double, Some(&cold.shape.q)).expect("stands");
    let tip = |settled: &softlimb_limb::statics::Settled| settled.shape.tip().translation.vector;
    assert!((tip(&cold) - tip(&warm)).norm() < 1e-8 * length_m);
    let free = softlimb_limb::statics::by_fidelity(&limb.rod, Fidelity::Double, None).expect("stands").1;
    let moved = (tip(&cold) - free.tip().translation.vector).norm();
    println!("springs at the loaded strains move the tip by {:.1} mm", 1e3 * moved);
    assert!(moved > 1e-4 * length_m);
}

/// Also of twisting tubes, whose springs depend on each other.
#[test]
fn bundle_at_other_pressures_is_the_one_made_there() {
    let steering = [("extension", "slant", 3, "steering = true")];
    let all = [("extension", "slant", 3, ""), ("twisting", "helix", 3, ""), ("bending", "slant", 2, "")];
    for modules in [&steering[..], &all[..]] {
        let limb = crate::tolerance::limb_of(modules);
        for module in limb.modules() {
            let at = |kpa: [f64; 3]| kpa.map(|kpa| 1e3 * kpa)[..module.channels.len()].to_vec();
            let (from, to) =
                if module.is_steering() { ([20.0, 5.0, 30.0], [20.0, 7.0, 30.0]) } else { ([20.0; 3], [22.0; 3]) };
            let moved = Bundle::new(module, &at(from), 2)
                .and_then(|bundle| bundle.at_pressures(module, &at(to)))
                .expect("a bundle");
            let made = Bundle::new(module, &at(to), 2).expect("a bundle");
            assert_eq!(
                (moved.free, moved.stiffness, moved.tubes),
                (made.free, made.stiffness, made.tubes),
                "{}",
                module.name
            );
        }
    }
}
