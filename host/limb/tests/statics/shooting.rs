//! A Cosserat solution by shooting: loads are dead, so the force in each section is known; what is sought is the moment at the root that
//! leaves none at the tip. Runge-Kutta on positions and directors; no code in common with the product.

use nalgebra::{Matrix3, Matrix4, Rotation3, Vector3, Vector4};
use softlimb_limb::statics::{Fidelity, Judged, Rod, UNKNOWNS, choose};

use crate::samples::samples;
use crate::statics::{Stream, random_rod};

const STEPS: usize = 24;

/// Position, directors (columns) and moment, in the frame of the scene.
#[derive(Clone, Copy)]
struct Section {
    x: Vector3<f64>,
    r: Matrix3<f64>,
    m: Vector3<f64>,
}

impl Section {
    fn moved(&self, rate: &Section, by: f64) -> Section {
        Section { x: self.x + rate.x * by, r: self.r + rate.r * by, m: self.m + rate.m * by }
    }
}

/// Tip and the moment that is left there.
fn shoot(rod: &Rod, share: f64, root: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let g = rod.gravity_m_per_s2 * share;
    let mut force = rod.tip_force_n * share + g * rod.mass_kg();
    let mut at =
        Section { x: rod.base.translation.vector, r: rod.base.rotation.to_rotation_matrix().into_inner(), m: root };
    for piece in &rod.pieces {
        let mount = Rotation3::from_axis_angle(&Vector3::z_axis(), piece.mount_angle_rad).into_inner();
        at.r *= mount;
        let compliance: Matrix4<f64> = piece.stiffness.try_inverse().expect("stiff");
        let rate = |s: f64, at: &Section| {
            let (n, m) = (at.r.transpose() * (force - g * (piece.kg_per_m * s)), at.r.transpose() * at.m);
            // Strains from stresses: the axial force, and moments about y, -x and z.
            let z = compliance * Vector4::new(n.z, m.y, -m.x, m.z);
            let soft = piece.shear_n + 2.0 * piece.sway * n.z / piece.free[0];
            let (vx, vy) = (n.x / soft, n.y / soft);
            let vz = piece.free[0] + z.x - piece.sway * (vx * vx + vy * vy) / piece.free[0];
            let k = Vector3::new(-(piece.free[2] + z.z), piece.free[1] + z.y, piece.free[3] + z.w);
            let along = at.r * Vector3::new(vx, vy, vz);
            Section { x: along, r: at.r * k.cross_matrix(), m: -along.cross(&(at.r * n)) }
        };
        let h = piece.length_m / STEPS as f64;
        for step in 0..STEPS {
            let s = step as f64 * h;
            let a = rate(s, &at);
            let b = rate(s + 0.5 * h, &at.moved(&a, 0.5 * h));
            let c = rate(s + 0.5 * h, &at.moved(&b, 0.5 * h));
            let d = rate(s + h, &at.moved(&c, h));
            at = at.moved(&a, h / 6.0).moved(&b, h / 3.0).moved(&c, h / 3.0).moved(&d, h / 6.0);
        }
        force -= g * (piece.kg_per_m * piece.length_m);
        at.r *= mount.transpose();
        let axis = at.r * Vector3::z();
        let mut here = 0.0;
        for (distance, kg) in &piece.masses {
            at.m -= (axis * (distance - here)).cross(&force);
            here = *distance;
            force -= g * *kg;
        }
        at.m -= (axis * (piece.rigid_m - here)).cross(&force);
        at.x += axis * piece.rigid_m;
    }
    (at.x, at.m)
}

/// The tip of the shape that growing loads lead to; `None` where the shooting does not follow.
pub(crate) fn tip(rod: &Rod) -> Option<Vector3<f64>> {
    let (mut root, mut share, mut step) = (Vector3::zeros(), 0.0, 0.125);
    while share < 1.0 {
        let next = f64::min(share + step, 1.0);
        match newton(rod, next, root) {
            Some(found) => (root, share) = (found, next),
            None if step < 1e-3 => return None,
            None => step *= 0.5,
        }
    }
    Some(shoot(rod, 1.0, root).0)
}

fn newton(rod: &Rod, share: f64, start: Vector3<f64>) -> Option<Vector3<f64>> {
    let mut root = start;
    for _ in 0..12 {
        let left = shoot(rod, share, root).1;
        if left.norm() < 1e-10 {
            return ((root - start).norm() < 1.5).then_some(root);
        }
        let step = 1e-6;
        let column = |axis: usize| {
            let mut moved = root;
            moved[axis] += step;
            (shoot(rod, share, moved).1 - left) / step
        };
        let slope = Matrix3::from_columns(&[column(0), column(1), column(2)]);
        root -= slope.lu().solve(&left)?;
    }
    None
}

/// Tip by a tier with pieces that are split.
fn by_fidelity(rod: &Rod, tier: Fidelity) -> Option<Vector3<f64>> {
    let (parts, bends) = tier.pieces();
    softlimb_limb::statics::solve(&rod.split(parts), bends, None).ok().map(|shape| shape.tip().translation.vector)
}

#[test]
fn two_hundred_limbs_against_shooting() {
    let mut stream = Stream(21);
    let (mut compared, mut lost) = (0, 0);
    let mut worst = [0.0_f64; 4];
    let (mut judged, mut within, mut unnamed) = (0, 0, 0);
    let mut linear = [0; 2];
    let mut taken = [0; Fidelity::ALL.len()];
    let limbs = samples(200) as usize;
    for _ in 0..limbs {
        let load = stream.between(0.05, 0.6);
        let rod = random_rod(&mut stream, load);
        assert_eq!(rod.unknowns(), 3 * UNKNOWNS);
        let length_m: f64 = rod.pieces.iter().map(|piece| piece.length_m + piece.rigid_m).sum();
        let tiers = [Fidelity::Constant, Fidelity::Linear, Fidelity::Double, Fidelity::Fourfold]
            .map(|tier| by_fidelity(&rod, tier));
        let (Some(exact), [Some(a), Some(b), Some(c), Some(d)]) = (tip(&rod), tiers) else {
            lost += 1;
            continue;
        };
        let errors = [a, b, c, d].map(|tip| (tip - exact).norm() / length_m);
        compared += 1;
        worst = [0, 1, 2, 3].map(|i: usize| worst[i].max(errors[i]));
        // The linear tier's distance from the next one as an estimate of its error.
        if errors[1] > 1e-3 {
            linear[1] += 1;
            linear[0] += usize::from((0.4..=2.5).contains(&((c - b).norm() / length_m / errors[1])));
        }
        let answer = choose(&rod, 0.01, length_m, |_, _, _| Judged::default()).expect("stable, as above");
        taken[Fidelity::ALL.iter().position(|tier| *tier == answer.tier).expect("one of them")] += 1;
        let error = (answer.shape.tip().translation.vector - exact).norm() / length_m;
        unnamed += usize::from(error > 0.01 && answer.order_error <= 0.01);
        if error > 1e-3 {
            judged += 1;
            within += usize::from((0.4..=2.5).contains(&(answer.order_error / error)));
        }
    }
    println!(
        "{compared} limbs, {lost} without a shape by one of both; largest error of the tip by tier: {worst:?} of the length"
    );
    println!("estimates of the linear tier within 0.4 to 2.5 of its error above 0.1 %: {} of {}", linear[0], linear[1]);
    println!(
        "a tolerance of 1 % takes {taken:?}; estimates within 0.4 to 2.5: {within} of {judged}; {unnamed} beyond 1 % without being named"
    );
    assert!(compared * 200 >= limbs * 190 && worst[3] < 1e-2, "{compared} of {limbs}: {worst:?}");
    assert!(linear[0] * 100 >= linear[1] * 95 && unnamed * 20 <= compared, "{linear:?} {unnamed}");
    assert!(within * 10 >= judged * 9, "{within} of {judged}");
}
