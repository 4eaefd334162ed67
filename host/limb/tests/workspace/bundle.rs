//! The fast way to the tip against the model, and the free bundle against one whose tubes are not linear.

use fra_model::{Load, tip_pose};
use nalgebra::{Matrix3, Point3, Vector3};
use softlimb_limb::statics::{Bundle, Tangent};
use softlimb_limb::workspace::{Command, Workspace};

use crate::workspace::{Stream, limb_of, limb_with};

#[test]
fn the_polynomials_are_the_model_in_the_whole_box() {
    for name in ["weightless-a", "weightless-b", "weightless-c"] {
        let (_, limb) = limb_of(name);
        for command in [Command::Actuators, Command::Modules] {
            let space = Workspace::new(&limb, command).expect("a workspace");
            assert!(space.error() < 1e-7, "{name}: {:e}", space.error());
            let mut stream = Stream(7);
            for _ in 0..40 {
                let shares: Vec<f64> = space.axes().iter().map(|_| stream.next()).collect();
                let (fast, exact) = (space.tip(&shares), space.tip_by_the_model(&shares).expect("an equilibrium"));
                let off = fast.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 2e-7, "{name} {command:?} {shares:?}: {off:e} m");
            }
        }
    }
}

#[test]
fn equal_pressures_are_the_kinematics_of_the_modules() {
    let limb = limb_with(&[
        ("extension", 3, ""),
        ("bending", 3, "mount_angle = \"70 deg\""),
        ("twisting", 3, ""),
        ("bending", 1, ""),
    ]);
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    for share in [0.0, 0.2, 0.61, 1.0] {
        let links = limb.modules().iter().enumerate().map(|(index, module)| {
            let axis = space.axes().iter().find(|axis| axis.module == index).expect("an axis");
            let pressure_pa = share * axis.pressure_max_pa;
            // Plates hold twisting actuators back.
            module.link(&if module.is_restrained() {
                module.curve.at(pressure_pa)
            } else {
                module.actuator.forward(pressure_pa, &Load::none()).expect("finite").state
            })
        });
        let expected = tip_pose(limb.base(), links) * Point3::origin();
        let shares = vec![share; space.axes().len()];
        let model = space.tip_by_the_model(&shares).expect("an equilibrium");
        // The curve of the twisting bundle is interpolated.
        for (found, bound) in [(space.tip(&shares), 2e-7), (model, 1e-8)] {
            let off = (Point3::from(found) - expected).norm();
            assert!(off < bound, "{share}: {off:e} m");
        }
    }
}

/// Stretch and bends of a bundle whose tubes follow the model at any stretch ([`fra_model::Blocked`]), by Newton's method: forces and moments vanish.
fn nonlinear(limb: &softlimb_limb::Limb, pressures_pa: [f64; 3]) -> Vector3<f64> {
    let module = &limb.modules()[0];
    let places: Vec<[f64; 2]> =
        (0..3).map(|i| std::f64::consts::TAU * f64::from(i) / 3.0).map(|a| [0.03 * a.cos(), 0.03 * a.sin()]).collect();
    let own: f64 = pressures_pa.iter().map(|p| Tangent::of(&module.actuator, *p).expect("solved").bending_nm2).sum();
    let mut at = Vector3::new(1.05, 0.0, 0.0);
    for _ in 0..50 {
        let mut residual = Vector3::new(0.0, own * at.y, own * at.z);
        let mut slope = Matrix3::from_diagonal(&Vector3::new(0.0, own, own));
        for (place, pressure_pa) in places.iter().zip(pressures_pa) {
            let arm = Vector3::new(1.0, -place[0], -place[1]);
            let held = module.actuator.blocked(pressure_pa, arm.dot(&at), 0.0).expect("a stretch");
            residual += arm * held.force_n;
            slope += arm * arm.transpose() * (held.stiffness[0][0] * module.length_m());
        }
        let step = slope.lu().solve(&residual).expect("a slope");
        at -= step;
        if step.norm() < 1e-13 {
            return at;
        }
    }
    panic!("no equilibrium of the bundle at {pressures_pa:?}");
}

#[test]
fn tubes_as_springs_at_their_free_state_are_close_to_the_tubes_of_the_model() {
    let limb = limb_with(&[("extension", 3, "")]);
    let mut worst: f64 = 0.0;
    for pressures_pa in [[0.0; 3], [90e3, 0.0, 0.0], [90e3, 90e3, 0.0], [40e3, 80e3, 10e3], [95e3, 0.0, 95e3]] {
        let exact = nonlinear(&limb, pressures_pa);
        let free = Bundle::new(&limb.modules()[0], &pressures_pa, 1).expect("a bundle").free;
        let found = Vector3::new(free.stretch, free.bend_rad_per_m[0], free.bend_rad_per_m[1]);
        // Tip of a module of 0.24 m: 0.24 m by the stretch, 0.03 m2 by the bend.
        let off = 0.24 * (found.x - exact.x).abs() + 0.0288 * (found - exact).yz().norm();
        worst = worst.max(off / 0.24);
    }
    println!("largest difference of the tip of one module: {:.3} % of its length", 100.0 * worst);
    assert!(worst < 0.01, "{worst}");
}
