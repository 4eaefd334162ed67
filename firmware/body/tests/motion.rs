//! The body in motion beside closed forms.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::{Complex, Isometry3, Translation3, UnitQuaternion, Vector3};
use softlimb_body::{Bay, Body, Curve, Effects, Main, Mass, MemoryParameters, Moving, Plate, Potential, Term, Tube};

use super::laws::Springs;

const GRAVITY: f64 = 9.8;
const STIFF: Springs =
    Springs { axial_n: 1e5, bending_nm2: [0.25; 2], torsion_nm2: 0.2, shear_n: 1e5, by_pressure: 1e-6 };

fn mass(x: f64, y: f64, z: f64, kg: f64) -> Mass {
    Mass { place_m: [x, y, z], kg }
}

fn hanging() -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI))
}

/// A tube a bay, one above the other, with these plates.
fn tower(
    springs: Springs,
    (bay_m, beams): (f64, usize),
    base: &Isometry3<f64>,
    plates: Vec<Vec<Mass>>,
    gravity: f64,
) -> Body {
    let law = Arc::new(springs.law(Main::Stretch));
    let elastic = MemoryParameters::default().with(Effects::NONE);
    let bay = |_: &Vec<Mass>| Bay {
        rest: Isometry3::translation(0.0, 0.0, bay_m),
        tubes: vec![Tube::new(law.clone(), 0, [Isometry3::identity(); 2], (bay_m, beams), elastic)],
    };
    let bays = plates.iter().map(bay).collect();
    let plates = plates.into_iter().map(|masses| Plate { masses }).collect();
    Body::new(base, bays, plates, [0.0; 3], [0.0, 0.0, -gravity])
}

/// Times at which the tip's `x` rises through 0, s.
fn rises(moving: &mut Moving, payload_kg: f64, step_s: f64, count: usize) -> Vec<f64> {
    let (mut times, mut time_s, mut before) = (Vec::new(), 0.0, moving.body().tip_m()[0]);
    while times.len() < count {
        moving.advance(&[0.0], payload_kg, step_s).unwrap();
        let here = moving.body().tip_m()[0];
        if before < 0.0 && here >= 0.0 {
            times.push(time_s + step_s * before / (before - here));
        }
        (time_s, before) = (time_s + step_s, here);
        assert!(time_s < 100.0, "it does not swing");
    }
    times
}

#[test]
fn limb_without_stiffness_falls_freely() {
    let springs =
        Springs { axial_n: 1e-9, bending_nm2: [1e-9; 2], torsion_nm2: 1e-9, shear_n: 1e-9, by_pressure: 1e-6 };
    let masses = vec![mass(0.03, 0.0, 0.0, 0.2), mass(-0.03, 0.02, 0.0, 0.2), mass(0.0, -0.02, 0.0, 0.2)];
    let mut moving = Moving::new(tower(springs, (0.2, 1), &Isometry3::identity(), vec![masses], GRAVITY));
    for _ in 0..100 {
        moving.advance(&[0.0], 0.0, 5e-3).unwrap();
    }
    // From 0.2 m above the base, hanging from it by nothing.
    let expected = 0.2 - 0.5 * GRAVITY * 0.25;
    assert!((moving.body().tip_m()[2] - expected).abs() < 1e-6, "{}", moving.body().tip_m()[2]);
    assert!((moving.tip_m_per_s()[2] + GRAVITY * 0.5).abs() < 1e-6);
}

/// A rod of no weight on a short tube, with a mass at its end, and the tube's spring against turns.
struct Pendulum {
    length_m: f64,
    kg: f64,
    spring_nm: f64,
}

/// Length of that tube, m, in whose middle the rod turns.
const HINGE_M: f64 = 1e-3;

impl Pendulum {
    const NEW: Self = Self { length_m: 0.5, kg: 0.7, spring_nm: 0.1 };

    /// At rest, given a spin, rad/s.
    fn moving(&self, spin: f64) -> Moving {
        // So stiff along the rod that it stretches by 0.05 %, and so soft that a step resolves its bounce.
        let springs = Springs { axial_n: 30.0, shear_n: 1e3, bending_nm2: [self.spring_nm * HINGE_M; 2], ..STIFF };
        let plates = vec![vec![mass(0.0, 0.0, self.length_m - 0.5 * HINGE_M, self.kg)]];
        let mut body = tower(springs, (HINGE_M, 2), &hanging(), plates, GRAVITY);
        body.settle(&[0.0], 0.0, 0.0).unwrap();
        let mut moving = Moving::new(body);
        moving.push([-0.5 * HINGE_M * spin, 0.0, 0.0], [0.0, spin, 0.0]);
        moving
    }

    fn lean_rad(moving: &Moving) -> f64 {
        let along = moving.body().poses().next().unwrap() * Vector3::z();
        along.x.atan2(-along.z)
    }

    fn potential_j(&self, lean_rad: f64) -> f64 {
        self.kg * GRAVITY * self.length_m * (1.0 - lean_rad.cos()) + 0.5 * self.spring_nm * lean_rad * lean_rad
    }

    /// Spin at the bottom that leads up to a lean.
    fn spin(&self, top_rad: f64) -> f64 {
        (2.0 * self.potential_j(top_rad) / self.kg).sqrt() / self.length_m
    }

    /// Period by quadrature: `4 times the integral of dt = d lean/sqrt(2 (E - V)/I)`, with `lean = top sin u`.
    fn period_s(&self, top_rad: f64) -> f64 {
        let (top_j, steps) = (self.potential_j(top_rad), 2000);
        let rate = |u: f64| {
            let left_j = top_j - self.potential_j(top_rad * u.sin());
            top_rad * u.cos() * self.length_m * (0.5 * self.kg / left_j).sqrt()
        };
        let h = 0.5 * PI / f64::from(steps);
        4.0 * h * (0..steps).map(|step| rate((f64::from(step) + 0.5) * h)).sum::<f64>()
    }

    /// Mean period over ten of them, and the largest change of energy from one passage of the bottom to another: the bounce has some in between.
    fn swing(&self, spin: f64, step_s: f64) -> (f64, f64) {
        let mut moving = self.moving(spin);
        let energy = |moving: &Moving| moving.kinetic_j(0.0) + self.potential_j(Self::lean_rad(moving));
        let (mut time_s, mut before, mut times, mut energies) = (0.0, 0.0, Vec::new(), Vec::new());
        while times.len() < 11 {
            moving.advance(&[0.0], 0.0, step_s).unwrap();
            let lean_rad = Self::lean_rad(&moving);
            if before < 0.0 && lean_rad >= 0.0 {
                times.push(time_s + step_s * before / (before - lean_rad));
                energies.push(energy(&moving));
            }
            (time_s, before) = (time_s + step_s, lean_rad);
            assert!(time_s < 100.0, "it does not swing");
        }
        let drift = energies.iter().map(|energy_j| (energy_j / energies[0] - 1.0).abs()).fold(0.0, f64::max);
        ((times[10] - times[0]) / 10.0, drift)
    }
}

#[test]
fn pendulum_has_its_period_and_keeps_its_energy() {
    let pendulum = Pendulum::NEW;
    for (degrees, most) in [(2.0_f64, 1e-5), (20.0, 5e-4)] {
        let top_rad = degrees.to_radians();
        let expected_s = pendulum.period_s(top_rad);
        for step_s in [4e-3, 2e-3] {
            let (period_s, drift) = pendulum.swing(pendulum.spin(top_rad), step_s);
            println!("{degrees} deg by {step_s} s: {period_s:.5} s of {expected_s:.5} s, energy off by {drift:.1e}");
            assert!((period_s / expected_s - 1.0).abs() < 5e-4, "{period_s} {expected_s}");
            assert!(drift < most, "{drift}");
        }
    }
}

/// The frequency that the midpoint rule has: `tan(w' h/2) = w h/2`. Halving the step leaves a quarter of the error.
#[test]
fn error_of_a_step_goes_with_its_square() {
    let periods = [16e-3, 8e-3, 4e-3].map(|step_s| Pendulum::NEW.swing(0.02, step_s).0);
    let ratio = (periods[0] - periods[1]) / (periods[1] - periods[2]);
    println!("periods {periods:?} s, ratio of their differences {ratio:.2}");
    assert!((3.6..4.4).contains(&ratio), "{ratio}");
    let w = TAU / periods[2];
    let lag = |h: f64| 2.0 / h * (0.5 * w * h).atan() / w;
    assert!((periods[2] / periods[0] - lag(16e-3) / lag(4e-3)).abs() < 1e-5);
}

/// An upright column without mass under a weight `P`: sideways it has the stiffness `P/(L (tan(kL)/(kL) - 1))`, `k^2 = P/EI`, which is gone at
/// Euler's load.
#[test]
fn column_swings_as_its_load_leaves_it_stiffness() {
    let length_m = 0.3;
    let euler_n = PI * PI * 0.25 / (4.0 * length_m * length_m);
    for share in [0.2, 0.6, 0.9] {
        let kg = share * euler_n / GRAVITY;
        let mut body = tower(STIFF, (length_m, 6), &Isometry3::identity(), vec![vec![]], GRAVITY);
        body.settle(&[0.0], kg, 0.0).unwrap();
        let load_n = kg * GRAVITY;
        let kl = length_m * (load_n / 0.25_f64).sqrt();
        let stiffness = load_n / (length_m * (kl.tan() / kl - 1.0));
        let expected_s = TAU * (kg / stiffness).sqrt();
        let mut moving = Moving::new(body);
        moving.push([1e-3, 0.0, 0.0], [0.0; 3]);
        let times = rises(&mut moving, kg, expected_s / 400.0, 4);
        let period_s = (times[3] - times[0]) / 3.0;
        println!("{share} of Euler's load: {period_s:.4} s, closed form {expected_s:.4} s");
        assert!((period_s / expected_s - 1.0).abs() < 5e-3, "{period_s} {expected_s}");
    }
}

/// Beyond the load of its spring an upright pendulum falls with the rate `sqrt((m g l - k)/(m l^2))`.
#[test]
fn overloaded_column_falls_at_its_rate() {
    let (arm_m, kg) = (0.5, 0.4);
    let springs = Springs { bending_nm2: [1e-3; 2], ..STIFF };
    let plates = vec![vec![mass(0.0, 0.0, arm_m - 1e-3, kg)]];
    // A spring of 1 N m/rad under a load of 1.96 N m.
    let mut moving = Moving::new(tower(springs, (1e-3, 1), &Isometry3::identity(), plates, GRAVITY));
    let spin = 1e-4;
    moving.push([0.0; 3], [0.0, spin, 0.0]);
    let (lever_m, span_s) = (arm_m - 0.5e-3, 1.0);
    let rate = ((kg * GRAVITY * lever_m - 1.0) / (kg * lever_m * lever_m)).sqrt();
    for _ in 0..500 {
        moving.advance(&[0.0], 0.0, span_s / 500.0).unwrap();
    }
    let pose = moving.body().poses().next().unwrap();
    let lean_rad = (pose * Vector3::z()).x;
    let expected = spin / rate * (rate * span_s).sinh();
    assert!((lean_rad / expected - 1.0).abs() < 1e-2, "{lean_rad} {expected}");
}

/// Euler and Bernoulli: `1 + cos l cosh l + (m/rho L) l (cos l sinh l - sin l cosh l) = 0` has the root 1.4200 where the mass at the end is half of the
/// beam's.
#[test]
fn cantilever_with_a_mass_swings_at_its_closed_form() {
    let (length_m, kg, bays) = (0.3, 0.2, 10);
    let share: f64 = 0.5;
    let equation = |l: f64| 1.0 + l.cos() * l.cosh() + share * l * (l.cos() * l.sinh() - l.sin() * l.cosh());
    let (mut low, mut high) = (1.0, 1.8);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if equation(middle) > 0.0 { low = middle } else { high = middle }
    }
    let own_kg = kg / bays as f64;
    let plates =
        (1..=bays).map(|bay| vec![mass(0.0, 0.0, 0.0, if bay == bays { 0.5 * own_kg + share * kg } else { own_kg })]);
    let mut body = tower(STIFF, (length_m / bays as f64, 1), &Isometry3::identity(), plates.collect(), 0.0);
    body.settle_under(&[0.0], 0.0, [-0.02, 0.0, 0.0], 0.0).unwrap();
    let expected_s = TAU * length_m * length_m / (low * low) * (kg / length_m / 0.25_f64).sqrt();
    let mut moving = Moving::new(body);
    let times = rises(&mut moving, 0.0, expected_s / 400.0, 7);
    let period_s = (times[6] - times[0]) / 6.0;
    println!("{period_s:.5} s, closed form {expected_s:.5} s");
    assert!((period_s / expected_s - 1.0).abs() < 5e-3);
}

/// A mass that bounces on a tube with damping: `m w^2 = k (1 + sum g i w t/(1 + i w t))`, times 0.02, 0.1 and 0.4 s, has a complex root.
#[test]
fn bounce_decays_by_the_loss_of_the_tube() {
    let (length_m, kg, axial_n) = (0.2, 1.0, 40.0);
    let springs = Springs { axial_n, ..STIFF };
    let damping = MemoryParameters { loop_stiffness: 0.0, creep: 0.0, damping: 0.18, softening: 0.0 };
    let law = Arc::new(springs.law(Main::Stretch));
    let tube = Tube::new(law, 0, [Isometry3::identity(); 2], (length_m, 1), damping);
    let bay = Bay { rest: Isometry3::translation(0.0, 0.0, length_m), tubes: vec![tube] };
    let plates = vec![Plate { masses: vec![mass(0.0, 0.0, 0.0, kg)] }];
    let body = Body::new(&Isometry3::identity(), vec![bay], plates, [0.0; 3], [0.0; 3]);
    let stiffness = axial_n / length_m;
    let equation = |w: Complex<f64>| {
        let terms = [0.02, 0.1, 0.4].map(|time_s| {
            let turn = Complex::<f64>::i() * w * time_s;
            turn / (turn + 1.0) * (0.18 / 3.0)
        });
        (terms.iter().sum::<Complex<f64>>() + 1.0) * stiffness - w * w * kg
    };
    let mut w = Complex::new((stiffness / kg).sqrt(), 0.1);
    for _ in 0..50 {
        let slope = (equation(w + 1e-6) - equation(w - 1e-6)) / 2e-6;
        w -= equation(w) / slope;
    }
    let mut moving = Moving::new(body);
    moving.push([0.0, 0.0, 0.01], [0.0; 3]);
    let step_s = TAU / w.re / 400.0;
    let (mut peaks, mut before, mut last) = (Vec::new(), [0.0; 2], length_m);
    for step in 0..4000 {
        moving.advance(&[0.0], 0.0, step_s).unwrap();
        let here = moving.body().tip_m()[2];
        let speed = moving.tip_m_per_s()[2];
        if before[1] > 0.0 && speed <= 0.0 {
            peaks.push((f64::from(step) * step_s, last.max(here) - length_m));
        }
        (before, last) = ([here, speed], here);
    }
    // After the first ones, which the slow terms of the series still move.
    let (first, later) = (peaks[2], peaks[7]);
    let rate = (first.1 / later.1).ln() / (later.0 - first.0);
    let period_s = (later.0 - first.0) / 5.0;
    println!("decay {rate:.4} 1/s beside {:.4}, period {period_s:.4} s beside {:.4}", w.im, TAU / w.re);
    assert!((rate / w.im - 1.0).abs() < 0.03 && (period_s * w.re / TAU - 1.0).abs() < 5e-3);
}

/// A tube that twists and stretches, with the pressure held: whatever the start, damping takes energy from its two vibrations. A memory of the twist alone
/// fed the one in which it stretches against its twist.
#[test]
fn vibrations_of_a_tube_that_twists_die_away() {
    // Loads `N = a s + c t - f p` and `Q = c s + b t - g p`: a free tube that a pressure twists and shortens.
    let (a, b, c, f, g) = (2e3, 0.2, 6.0, -0.01, 2e-4);
    let term = |powers, coefficient| Term { powers, coefficient };
    let terms = vec![
        term([2, 0, 0], 0.5 * a),
        term([0, 2, 0], 0.5 * b),
        term([1, 1, 0], c),
        term([1, 0, 1], -f),
        term([0, 1, 1], -g),
    ];
    let [stretch, twist] = [(f * b - g * c) / (a * b - c * c), (g * a - f * c) / (a * b - c * c)];
    let line = |by: f64, value: f64| Curve::rising(&[[0.0, 0.0], [by, value]]).unwrap();
    let mut law = STIFF.law(Main::Twist);
    law.potential = Potential { units: [1.0; 3], range: [[-1e3, 1e3]; 2], terms };
    law.elastic = line(twist * 1e5, 1e5);
    law.filled = Some(line((f * stretch + g * twist) * 1e5, twist * 1e5));
    let memory = MemoryParameters::default().with(Effects { damping: true, ..Effects::NONE });
    let tubes = vec![Tube::new(Arc::new(law), 0, [Isometry3::identity(); 2], (0.1, 1), memory)];
    let bay = Bay { rest: Isometry3::translation(0.0, 0.0, 0.1), tubes };
    let masses = vec![mass(0.05, 0.0, 0.0, 0.1), mass(-0.05, 0.0, 0.0, 0.1)];
    let body = Body::new(&Isometry3::identity(), vec![bay], vec![Plate { masses }], [0.0; 3], [0.0; 3]);
    for (velocity, spin) in [(0.02, 0.0), (0.0, 0.4), (0.02, 0.4), (0.02, -0.4)] {
        let mut moving = Moving::new(body.clone());
        moving.settle(&[0.0], 0.0, 0.0).unwrap();
        moving.push([0.0, 0.0, velocity], [0.0, 0.0, spin]);
        let mut most = [0.0_f64; 3];
        for step in 0..6000 {
            moving.advance(&[0.0], 0.0, 1e-3).unwrap();
            most[step / 2000] = most[step / 2000].max(moving.kinetic_j(0.0));
        }
        println!("{velocity} m/s, {spin} rad/s: {most:?} J");
        assert!(most[1] < 0.9 * most[0] && most[2] < 0.9 * most[1], "{most:?}");
    }
}
