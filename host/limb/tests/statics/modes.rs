//! Natural frequencies beside closed forms and a chain of rigid links with its own assembly.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{DMatrix, DVector, Isometry3, UnitQuaternion, Vector3};
use softlimb_limb::statics::{Bends, Gyration, Mode, Rod, solve};

use super::closed_forms::{EI, LENGTH_M};
use crate::statics::{level, slender};

const KG_PER_M: f64 = 1.3;

/// The root of a function between two places where its sign changes.
fn root(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let first = value(low);
    assert!(first * value(high) < 0.0, "a change of sign");
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if value(middle) * first > 0.0 { low = middle } else { high = middle }
    }
    low
}

fn heavy(kg: f64) -> Rod {
    let mut rod = level(vec![slender(LENGTH_M, EI, 1e6)]);
    rod.pieces[0].kg_per_m = KG_PER_M;
    // Equal stiffness in both planes would mix their vibrations, so one plane is stiffer.
    rod.pieces[0].stiffness[(2, 2)] *= 1.7;
    rod.pieces[0].masses = vec![(0.0, kg)];
    rod
}

fn modes(rod: &Rod, parts: usize, gyration: &[Gyration], count: usize) -> Vec<Mode> {
    let rod = rod.split(parts);
    let shape = solve(&rod, Bends::Linear, None).expect("stable");
    shape.modes(&rod, gyration, count).expect("stable")
}

/// Frequencies of the vibrations in the plane of the first and the third axis of the scene, Hz.
fn in_plane_hz(modes: &[Mode]) -> Vec<f64> {
    let plane = modes.iter().filter(|mode| mode.tip.y.abs() < 1e-3 * mode.tip.norm());
    plane.map(|mode| mode.frequency_hz).collect()
}

/// Euler and Bernoulli: `1 + cos l cosh l + (m/rho L) l (cos l sinh l - sin l cosh l) = 0`.
#[test]
fn weightless_cantilever_with_a_mass_at_its_end_has_the_frequencies_of_its_closed_form() {
    for share in [0.0, 0.4, 2.0] {
        let mut rod = heavy(share * KG_PER_M * LENGTH_M);
        rod.gravity_m_per_s2 = Vector3::zeros();
        let equation = |l: f64| 1.0 + l.cos() * l.cosh() + share * l * (l.cos() * l.sinh() - l.sin() * l.cosh());
        let expected = [(0.1, 2.2), (3.0, 5.2)].map(|(low, high)| {
            let l = root(low, high, equation);
            l * l / (TAU * LENGTH_M * LENGTH_M) * (EI / KG_PER_M).sqrt()
        });
        for (parts, within) in [(2, 1e-2), (4, 5e-3)] {
            let found = in_plane_hz(&modes(&rod, parts, &[Gyration::default()], 6));
            let off = [0, 1].map(|index: usize| found[index] / expected[index] - 1.0);
            println!(
                "tip mass {share} of the beam, {parts} pieces: {expected:.4?} Hz, off by {:.1?} ppm",
                off.map(|off| 1e6 * off)
            );
            assert!(off.iter().all(|off| off.abs() < within), "{off:?}");
        }
    }
}

/// A rod that twists with a disk at its end: `l tan l = rho J L/J_end`.
#[test]
fn twisting_rod_with_a_disk_has_the_frequency_of_its_closed_form() {
    let (torsion_nm2, square_m2, disk_m2) = (0.31, 0.0021, 0.004);
    let mut rod = heavy(0.5);
    rod.gravity_m_per_s2 = Vector3::zeros();
    rod.pieces[0].stiffness[(3, 3)] = torsion_nm2;
    let gyration = Gyration { section_m2: [0.0, 0.0, square_m2], masses_m2: vec![[0.0, disk_m2]] };
    let ratio = KG_PER_M * square_m2 * LENGTH_M / (0.5 * disk_m2);
    let l = root(1e-3, FRAC_PI_2 - 1e-9, |l| l * l.tan() - ratio);
    let expected = l / (TAU * LENGTH_M) * (torsion_nm2 / (KG_PER_M * square_m2)).sqrt();
    let found = modes(&rod, 2, &[gyration], 12);
    let twisting = found.iter().find(|mode| mode.tip.norm() < 1e-6).expect("a mode that does not move the tip");
    assert!((twisting.frequency_hz / expected - 1.0).abs() < 5e-3, "{} {expected}", twisting.frequency_hz);
}

/// A planar chain of rigid links with springs between them, which shares nothing with the rods: angles of the links are its unknowns.
struct Links {
    count: usize,
    first_rad: f64,
    tip_kg: f64,
    tip_m2: f64,
    gravity: f64,
}

impl Links {
    fn h(&self) -> f64 {
        LENGTH_M / self.count as f64
    }

    fn spring(&self, joint: usize) -> f64 {
        EI / self.h() * if joint == 0 { 2.0 } else { 1.0 }
    }

    /// Mass behind the start of a link's middle: what its angle lifts per length.
    fn behind_kg(&self, link: usize) -> f64 {
        KG_PER_M * self.h() * ((self.count - link) as f64 - 0.5) + self.tip_kg
    }

    fn slope(&self, angles: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let (mut gradient, mut tangent) = (DVector::zeros(self.count), DMatrix::zeros(self.count, self.count));
        for joint in 0..self.count {
            let k = self.spring(joint);
            let before = if joint == 0 { self.first_rad } else { angles[joint - 1] };
            let moment = k * (angles[joint] - before);
            gradient[joint] += moment;
            tangent[(joint, joint)] += k;
            if joint > 0 {
                gradient[joint - 1] -= moment;
                tangent[(joint - 1, joint - 1)] += k;
                tangent[(joint - 1, joint)] -= k;
                tangent[(joint, joint - 1)] -= k;
            }
            let lifted = self.gravity * self.behind_kg(joint) * self.h();
            gradient[joint] += lifted * angles[joint].cos();
            tangent[(joint, joint)] -= lifted * angles[joint].sin();
        }
        (gradient, tangent)
    }

    fn mass(&self, angles: &DVector<f64>) -> DMatrix<f64> {
        let (h, link_kg) = (self.h(), KG_PER_M * self.h());
        DMatrix::from_fn(self.count, self.count, |a, b| {
            let last = a.max(b);
            // Each of the two links moves all later links by its whole length. The later of the two moves its own middle by half of its length.
            let whole = link_kg * (self.count - last - 1) as f64 + self.tip_kg;
            let own = if a == b { link_kg / 3.0 } else { 0.5 * link_kg };
            let turning = if a == b && a + 1 == self.count { self.tip_kg * self.tip_m2 } else { 0.0 };
            h * h * (whole + own) * (angles[a] - angles[b]).cos() + turning
        })
    }

    /// The first two frequencies about the equilibrium that growing weights lead to, Hz.
    fn frequencies_hz(&self) -> [f64; 2] {
        let mut angles = DVector::from_element(self.count, self.first_rad);
        for share in 1..=20 {
            let part = Self { gravity: self.gravity * f64::from(share) / 20.0, ..*self };
            for _ in 0..20 {
                let (gradient, tangent) = part.slope(&angles);
                angles -= tangent.cholesky().expect("stable").solve(&gradient);
            }
        }
        let (_, tangent) = self.slope(&angles);
        let factor = tangent.cholesky().expect("stable").l();
        let half = factor.solve_lower_triangular(&self.mass(&angles)).expect("regular");
        let inverse = factor.solve_lower_triangular(&half.transpose()).expect("regular");
        let mut found: Vec<f64> = inverse.symmetric_eigenvalues().iter().copied().collect();
        found.sort_by(|a, b| b.total_cmp(a));
        [0, 1].map(|index: usize| 1.0 / (TAU * found[index].sqrt()))
    }
}

/// Hanging, level and bent by its weight, rising, and nearly upright: weights stiffen it, bend it, and push it over.
#[test]
fn loaded_rod_has_the_frequencies_of_a_chain_of_links() {
    for (rise_rad, tip_kg, tip_m2) in
        [(-FRAC_PI_2, 0.6, 0.0), (-FRAC_PI_2, 0.6, 0.005), (0.0, 0.1, 0.003), (0.6, 0.1, 0.0), (1.5, 0.05, 0.0)]
    {
        let mut rod = heavy(tip_kg);
        // From along the axis of the base to a rise against the first axis of the scene.
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2 - rise_rad);
        rod.base = Isometry3::from_parts(nalgebra::Translation3::identity(), turn);
        let gyration = Gyration { section_m2: [0.0; 3], masses_m2: vec![[tip_m2, 0.0]] };
        let links = |count| Links { count, first_rad: rise_rad, tip_kg, tip_m2, gravity: 10.0 }.frequencies_hz();
        // The error of the chain goes with the square of its links' length.
        let (coarse, fine) = (links(60), links(120));
        let expected = [0, 1].map(|index: usize| fine[index] + (fine[index] - coarse[index]) / 3.0);
        let found = modes(&rod, 4, std::slice::from_ref(&gyration), 8);
        let hz = in_plane_hz(&found);
        let off = [0, 1].map(|index: usize| hz[index] / expected[index] - 1.0);
        println!(
            "rise {:.0} deg, {tip_kg} kg: {expected:.4?} Hz, off by {:.1?} ppm; springs are {:.2} of the first stiffness",
            rise_rad.to_degrees(),
            off.map(|off| 1e6 * off),
            found[0].elastic_share
        );
        assert!(off.iter().all(|off| off.abs() < 5e-3), "{off:?}");
        assert!(rise_rad >= 0.0 || found[0].elastic_share < 1.0, "{}", found[0].elastic_share);
    }
}

/// Of one unknown the shares are those of the energies: a short stiff beam under a long tool, `w^2 = k - m g/l` upright and `k + m g/l` hanging.
#[test]
fn damping_is_of_the_springs_alone() {
    let (arm_m, kg, loss_factor) = (0.6, 0.3, 0.1);
    for up in [1.0, -1.0] {
        let mut rod = level(vec![slender(0.02, 0.2, 1e6)]);
        rod.base = Isometry3::from_parts(
            nalgebra::Translation3::identity(),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), if up > 0.0 { 0.0 } else { PI }),
        );
        rod.pieces[0].rigid_m = arm_m;
        rod.pieces[0].masses = vec![(arm_m, kg)];
        let mode = modes(&rod, 1, &[Gyration::default()], 1).swap_remove(0);
        // The beam turns about its middle.
        let (spring, lever) = (0.2 / 0.02, arm_m + 0.01);
        let weight = kg * 10.0 * lever;
        let expected = 0.5 * loss_factor * spring / (spring - up * weight);
        assert!((mode.damping(loss_factor) / expected - 1.0).abs() < 2e-3, "{} {expected}", mode.damping(loss_factor));
        let hz = ((spring - up * weight) / (kg * lever * lever)).sqrt() / TAU;
        assert!((mode.frequency_hz / hz - 1.0).abs() < 2e-3, "{} {hz}", mode.frequency_hz);
    }
}
