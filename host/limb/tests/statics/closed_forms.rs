//! Beams, columns and bundles whose answers are known.

use std::f64::consts::PI;

use nalgebra::Vector3;
use softlimb_limb::statics::{Bends, EquilibriumError, LOAD_FACTOR_MAX, Rod, solve};

use crate::statics::{level, slender};

pub(crate) const EI: f64 = 1.4;
pub(crate) const LENGTH_M: f64 = 0.81;

fn drop_of(rod: &Rod) -> f64 {
    -solve(rod, Bends::Linear, None).expect("stable").tip().translation.vector.z
}

#[test]
fn small_loads_bend_as_beams_do() {
    let mut weighted = level(vec![slender(LENGTH_M, EI, 1e6)]);
    weighted.pieces[0].kg_per_m = 1e-5;
    let expected = 1e-4 * LENGTH_M.powi(4) / (8.0 * EI);
    assert!((drop_of(&weighted) / expected - 1.0).abs() < 1e-4, "{} {expected}", drop_of(&weighted));
    let mut loaded = level(vec![slender(LENGTH_M, EI, 1e6)]);
    loaded.tip_force_n = Vector3::new(0.0, 0.0, -1e-4);
    let expected = 1e-4 * LENGTH_M.powi(3) / (3.0 * EI);
    assert!((drop_of(&loaded) / expected - 1.0).abs() < 1e-4);
    // Shear adds F L/GA.
    loaded.pieces[0].shear_n = 5.0;
    let expected = expected + 1e-4 * LENGTH_M / 5.0;
    assert!((drop_of(&loaded) / expected - 1.0).abs() < 1e-4);
}

#[test]
fn equal_moments_make_an_arc() {
    // A free bend that the springs hold in part: two pieces of different stiffness would share a moment; here a dead couple of two
    // opposite weights on long arms is a moment that is the same everywhere.
    let mut rod = level(vec![slender(LENGTH_M, EI, 1e7)]);
    let (arm_m, kg) = (1e5, 1e-6);
    rod.pieces[0].masses = vec![(arm_m, kg), (-arm_m, -kg)];
    let angle = 2.0 * arm_m * kg * 10.0 * LENGTH_M / EI;
    let shape = solve(&rod, Bends::Linear, None).expect("stable");
    // The couple falls with the cosine of the end's angle: solve that, as the couple is the same all along.
    let mut turned = angle;
    for _ in 0..100 {
        turned = 0.5 * (turned + angle * turned.cos());
    }
    let tip = shape.tip().translation.vector;
    let expected = [LENGTH_M * turned.sin() / turned, -LENGTH_M * (1.0 - turned.cos()) / turned];
    assert!((tip.x - expected[0]).abs() < 1e-6 && (tip.z - expected[1]).abs() < 1e-6, "{tip} {expected:?}");
}

/// A heavy cantilever by Runge-Kutta and bisection on the moment at its root: `EI t'' = w (L - s) cos t`, with `t` the slope.
pub(crate) fn heavy_cantilever(weight_n_per_m: f64, force_n: f64) -> [f64; 2] {
    let steps = 4000;
    let h = LENGTH_M / f64::from(steps);
    let run = |root: f64| {
        let rate = |s: f64, y: [f64; 4]| {
            let force = weight_n_per_m * (LENGTH_M - s) + force_n;
            [y[1], -force * y[0].cos() / EI, y[0].cos(), y[0].sin()]
        };
        let mut y = [0.0, root, 0.0, 0.0];
        for step in 0..steps {
            let s = f64::from(step) * h;
            let add = |y: [f64; 4], k: [f64; 4], f: f64| std::array::from_fn(|i| y[i] + f * k[i]);
            let a = rate(s, y);
            let b = rate(s + 0.5 * h, add(y, a, 0.5 * h));
            let c = rate(s + 0.5 * h, add(y, b, 0.5 * h));
            let d = rate(s + h, add(y, c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    };
    // The curvature falls to 0 at the free end; the slope is counted downwards.
    let (mut low, mut high) = (0.0, 2.0 * (weight_n_per_m * LENGTH_M + force_n) * LENGTH_M / EI);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if run(middle)[1] > 0.0 { high = middle } else { low = middle }
    }
    let end = run(0.5 * (low + high));
    [end[2], -end[3]]
}

#[test]
fn heavy_cantilevers_are_elasticas() {
    for (weight, force) in [(8.0, 0.0), (0.0, 8.0), (20.0, 3.0)] {
        let expected = heavy_cantilever(weight, force);
        let mut off = Vec::new();
        for parts in [1, 2, 4] {
            let mut rod = level(vec![slender(LENGTH_M, EI, 1e5)]);
            rod.pieces[0].kg_per_m = weight / 10.0;
            rod.tip_force_n = Vector3::new(0.0, 0.0, -force);
            let tip = solve(&rod.split(parts), Bends::Linear, None).expect("stable").tip().translation.vector;
            off.push((tip.x - expected[0]).hypot(tip.z - expected[1]) / LENGTH_M);
        }
        println!("{weight} N/m and {force} N: {off:?} of the length with one, two and four pieces");
        assert!(off[0] < 2e-2 && off[1] < 2e-3 && off[2] < 3e-4, "{off:?}");
    }
}

/// Share of a load at which an upright column with a mass at its end loses its stability.
fn buckling_kg(parts: usize, shear_n: f64) -> f64 {
    let mut rod = level(vec![slender(LENGTH_M, EI, 1e6)]);
    rod.base = nalgebra::Isometry3::identity();
    rod.pieces[0].shear_n = shear_n;
    rod.pieces[0].masses = vec![(0.0, 1.0)];
    match solve(&rod.split(parts), Bends::Linear, None) {
        Err(EquilibriumError::Unstable { share }) => share,
        other => panic!("a column of 1 kg stands: {other:?}"),
    }
}

#[test]
fn columns_buckle_where_euler_says() {
    let euler_kg = PI * PI * EI / (4.0 * LENGTH_M * LENGTH_M) / 10.0;
    let [one, four] = [1, 4].map(|parts| buckling_kg(parts, 1e6) / euler_kg - 1.0);
    println!("buckling above Euler's load by {:.3} % with one piece, {:.4} % with four", 100.0 * one, 100.0 * four);
    assert!((0.0..0.01).contains(&one) && four.abs() < 5e-4, "{one} {four}");
    // With shear, of the two known forms the plates' sway is between: Engesser's and that of a rigid shear.
    let shear_n = 10.0;
    let engesser_kg = 1.0 / (1.0 / (euler_kg * 10.0) + 1.0 / shear_n) / 10.0;
    let found = buckling_kg(4, shear_n);
    println!("with soft shear: {:.3} of Engesser's load", found / engesser_kg);
    assert!(found < 0.9 * euler_kg && (0.8..1.1).contains(&(found / engesser_kg)), "{found} {engesser_kg}");
}

/// The load factor of a column is Euler's load over its own.
#[test]
fn load_factor_of_a_column_is_that_of_its_load_of_buckling() {
    let euler_n = PI * PI * EI / (4.0 * LENGTH_M * LENGTH_M);
    for share in [0.1, 0.4, 0.7, 0.95] {
        let mut rod = level(vec![slender(LENGTH_M, EI, 1e6)]).split(4);
        rod.base = nalgebra::Isometry3::identity();
        rod.tip_force_n = Vector3::new(0.0, 0.0, -share * euler_n);
        let shape = solve(&rod, Bends::Linear, None).expect("stable below Euler's load");
        let (found, expected) = (shape.load_factor(&rod, Bends::Linear), f64::min(1.0 / share, LOAD_FACTOR_MAX));
        println!("load factor of a column at {share} of Euler's load: {found:.4}, {expected:.4} expected");
        assert!((found - expected).abs() < 3e-3, "{share}: {found}");
    }
}

#[test]
fn a_soft_shear_is_no_instability_under_tension() {
    let mut rod = level(vec![slender(LENGTH_M, EI, 1e4)]);
    rod.base.rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), PI);
    rod.pieces[0].shear_n = 5.0;
    rod.pieces[0].masses = vec![(0.0, 20.0)];
    let shape = solve(&rod, Bends::Linear, None).expect("a pulled rod is stable");
    assert_eq!(shape.load_factor(&rod, Bends::Linear), LOAD_FACTOR_MAX);
    assert!(shape.tip().translation.vector.xy().norm() < 1e-9);
}

#[test]
fn shape_is_the_one_that_the_load_leads_to() {
    // A column leans a little to one side and carries twice its buckling load: it also has a shape on the other side.
    for lean in [0.05, -0.05] {
        let mut rod = level(vec![slender(LENGTH_M, EI, 1e5)]).split(2);
        rod.base.rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::y_axis(), lean);
        let kg = 2.0 * PI * PI * EI / (4.0 * LENGTH_M * LENGTH_M) / 10.0;
        rod.pieces[1].masses = vec![(0.0, kg)];
        let shape = solve(&rod, Bends::Linear, None).expect("a leaning column bends and holds");
        let x = shape.tip().translation.vector.x;
        assert!(x * lean > 0.0 && x.abs() > 0.3, "{lean}: {x}");
    }
}
