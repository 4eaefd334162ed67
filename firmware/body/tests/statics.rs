//! The body at rest beside closed forms and exact rods.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use softlimb_body::{Bay, Body, Curve, Effects, Main, Mass, MemoryParameters, Plate, Tube};
use softlimb_numerics::Random;

use super::laws::Springs;
use super::rods::{Rod, plate};

const SPRINGS: Springs =
    Springs { axial_n: 800.0, bending_nm2: [0.25, 0.3], torsion_nm2: 0.2, shear_n: 150.0, by_pressure: 2e-6 };

fn elastic() -> MemoryParameters {
    MemoryParameters::default().with(Effects::NONE)
}

/// One bay of tubes at places of the plates, with its tip at `tip_m` of the upper plate; its tubes are of channels from 0.
fn bay(rods: &[Rod], base: &Isometry3<f64>, beams: usize, tip_m: [f64; 3]) -> Body {
    let length_m = rods[0].length_m;
    let tube = |(channel, rod): (usize, &Rod)| {
        Tube::new(Arc::new(rod.springs.law(rod.main)), channel, [rod.place; 2], (length_m, beams), elastic())
    };
    let tubes = rods.iter().enumerate().map(tube).collect();
    let rest = Isometry3::translation(0.0, 0.0, length_m);
    Body::new(base, vec![Bay { rest, tubes }], vec![Plate { masses: Vec::new() }], tip_m, [0.0; 3])
}

fn on_axis(length_m: f64) -> Rod {
    Rod { springs: SPRINGS, main: Main::Stretch, pressure_pa: 0.0, length_m, place: Isometry3::identity() }
}

#[test]
fn small_force_bends_a_cantilever_as_timoshenko_has_it() {
    let length_m = 0.3;
    for (axis, bending_nm2) in [(0, 0.25), (1, 0.3)] {
        let mut body = bay(&[on_axis(length_m)], &Isometry3::identity(), 3, [0.0; 3]);
        let mut force = [0.0; 3];
        force[axis] = 1e-4;
        body.settle_under(&[0.0], 0.0, force, 0.0).unwrap();
        let expected = 1e-4 * (length_m.powi(3) / (3.0 * bending_nm2) + length_m / SPRINGS.shear_n);
        assert!((body.tip_m()[axis] / expected - 1.0).abs() < 1e-5);
    }
}

#[test]
fn pressure_without_load_bends_a_tube_to_an_arc() {
    let mut body = bay(&[Rod { main: Main::Bend, ..on_axis(0.3) }], &Isometry3::identity(), 6, [0.0; 3]);
    body.settle(&[3e6], 0.0, 0.0).unwrap();
    let radius_m: f64 = 1.0 / 6.0;
    let [x, y, z] = body.tip_m();
    let angle = 0.3 / radius_m;
    assert!((x - radius_m * (1.0 - angle.cos())).abs() < 2e-5, "{x}");
    assert!((z - radius_m * angle.sin()).abs() < 2e-5 && y.abs() < 1e-9, "{y} {z}");
}

#[test]
fn column_falls_at_the_load_of_euler() {
    let length_m = 0.3;
    let euler_n = PI * PI * 0.25 / (4.0 * length_m * length_m);
    // Shear lowers it, and so does the shorter column: E. Engesser's formula, with a long stiff axis.
    let stiff = Springs { axial_n: 1e6, shear_n: 1e6, ..SPRINGS };
    let falls = |share: f64| {
        let rod = Rod { springs: stiff, ..on_axis(length_m) };
        let mut body = bay(&[rod], &Isometry3::identity(), 4, [0.0; 3]);
        let stands = body.settle_under(&[0.0], 0.0, [0.0, 0.0, -share * euler_n], 0.0).is_ok();
        // Beyond the load it may stand bent.
        let [x, y, _] = body.tip_m();
        !stands || x.hypot(y) > 1e-3
    };
    assert!(!falls(0.99) && falls(1.01));
}

#[test]
fn hanging_masses_stretch_tubes_by_their_weight() {
    let place = |x: f64| Rod { place: Isometry3::translation(x, 0.0, 0.0), ..on_axis(0.2) };
    let rods = [place(0.03), place(-0.03)];
    let base = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
    let law = Arc::new(SPRINGS.law(Main::Stretch));
    let bays = (0..2).map(|_| {
        let tube = |(channel, rod): (usize, &Rod)| Tube::new(law.clone(), channel, [rod.place; 2], (0.2, 2), elastic());
        Bay { rest: Isometry3::translation(0.0, 0.0, 0.2), tubes: rods.iter().enumerate().map(tube).collect() }
    });
    let plates = vec![Plate { masses: vec![Mass { place_m: [0.0, 0.0, 0.01], kg: 0.4 }] }; 2];
    let mut body = Body::new(&base, bays.collect(), plates, [0.0; 3], [0.0, 0.0, -9.8]);
    body.settle(&[1e4, 1e4], 1.0, 0.0).unwrap();
    let stretch = |kg: f64| 1.0 + 2e-2 + 9.8 * kg / (2.0 * SPRINGS.axial_n);
    let expected = -0.2 * (stretch(1.8) + stretch(1.4));
    assert!((body.tip_m()[2] - expected).abs() < 1e-9, "{} beside {expected}", body.tip_m()[2]);
}

/// Limbs of one to three tubes, drawn by a seed: kinds, springs, pressures, places, base, load.
fn drawn(seed: u64) -> (Vec<Rod>, Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
    let mut random = Random::new(seed, 3);
    let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
    let count = 1 + (seed % 3) as usize;
    let main = if seed.is_multiple_of(2) { Main::Stretch } else { Main::Bend };
    let length_m = within(0.15, 0.3);
    let bending = within(0.2, 0.6);
    let springs = Springs {
        axial_n: if main == Main::Bend { 2e4 } else { within(500.0, 1500.0) },
        bending_nm2: [bending, bending * within(0.8, 1.2)],
        torsion_nm2: within(0.2, 0.5),
        shear_n: within(100.0, 400.0),
        by_pressure: if main == Main::Bend { 3e-5 } else { 2e-6 },
    };
    // Benders stand in a row across their bend, so that their strips can keep one length.
    let place = |index: usize| match (count, main) {
        (1, _) => [0.0; 2],
        (_, Main::Bend) => [0.0, 0.05 * (index as f64 - 0.5 * (count as f64 - 1.0))],
        _ => {
            let angle = 2.0 * PI * index as f64 / count as f64;
            [0.04 * angle.cos(), 0.04 * angle.sin()]
        }
    };
    let rods: Vec<Rod> = (0..count)
        .map(|index| {
            let [x, y] = place(index);
            let pressure_pa = 8e4 * (0.8 + 0.2 * within(0.0, 1.0));
            Rod { springs, main, pressure_pa, length_m, place: Isometry3::translation(x, y, 0.0) }
        })
        .collect();
    let turn = Vector3::new(within(-1.0, 1.0), within(-1.0, 1.0), within(-1.0, 1.0));
    let base = Isometry3::new(Vector3::new(0.1, -0.2, 1.0), turn);
    let force = Vector3::new(within(-1.5, 1.5), within(-1.5, 1.5), within(-1.5, 1.5)) * count as f64;
    (rods, base, force, Vector3::new(0.01, -0.02, 0.08))
}

#[test]
fn tip_of_thirty_limbs_is_that_of_exact_rods() {
    let mut moved = Vec::new();
    for seed in 0..30 {
        let (rods, base, force, at_m) = drawn(seed);
        let expected = plate(&base, &rods, &force, &at_m) * nalgebra::Point3::from(at_m);
        let mut body = bay(&rods, &base, 4, at_m.into());
        let pressures: Vec<f64> = rods.iter().map(|rod| rod.pressure_pa).collect();
        body.settle_under(&pressures, 0.0, force.into(), 0.0).unwrap_or_else(|_| panic!("limb {seed} stands"));
        let length_m = rods[0].length_m + at_m.z;
        let error = (Vector3::from(body.tip_m()) - expected.coords).norm() / length_m;
        let straight = base * nalgebra::Point3::from(at_m + Vector3::z() * rods[0].length_m);
        moved.push((expected - straight).norm() / length_m);
        assert!(error < 1e-3, "limb {seed}: {:.3} % of its length", 100.0 * error);
    }
    // The limbs do bend.
    moved.sort_by(f64::total_cmp);
    assert!(moved[15] > 0.2, "half of them move by less than {} of their length", moved[15]);
}

#[test]
fn finer_beams_come_closer_to_exact_rods() {
    let (mut rods, base, force, at_m) = drawn(7);
    // A beam's shear follows its chord, a rod's its section: they differ by a second order that no beam is too short for.
    rods.iter_mut().for_each(|rod| rod.springs.shear_n = 1e6);
    let expected = plate(&base, &rods, &force, &at_m) * nalgebra::Point3::from(at_m);
    let pressures: Vec<f64> = rods.iter().map(|rod| rod.pressure_pa).collect();
    let error = |beams: usize| {
        let mut body = bay(&rods, &base, beams, at_m.into());
        body.settle_under(&pressures, 0.0, force.into(), 0.0).unwrap();
        (Vector3::from(body.tip_m()) - expected.coords).norm()
    };
    let [coarse, middle, fine] = [2, 4, 8].map(error);
    assert!(coarse > 3.0 * middle && middle > 3.0 * fine, "{coarse} {middle} {fine}");
}

#[test]
fn limb_turned_as_a_whole_has_the_same_shape() {
    let (rods, base, force, at_m) = drawn(5);
    let pressures: Vec<f64> = rods.iter().map(|rod| rod.pressure_pa).collect();
    let turn = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.4, -1.9, 0.8));
    let tip = |base: &Isometry3<f64>, force: Vector3<f64>| {
        let mut body = bay(&rods, base, 3, at_m.into());
        body.settle_under(&pressures, 0.0, force.into(), 0.0).unwrap();
        nalgebra::Point3::from(body.tip_m())
    };
    let apart = turn * tip(&base, force) - tip(&(turn * base), turn * force);
    assert!(apart.norm() < 1e-8, "{apart}");
}

#[test]
fn memory_makes_the_limb_stop_short_and_return_on_another_way() {
    let curve = Curve::rising(&[[0.0, 0.0], [0.2, 1e5]]).unwrap();
    assert_eq!(curve.end(), [0.2, 1e5]);
    let rod = on_axis(0.3);
    let law = Arc::new(rod.springs.law(rod.main));
    let tube = |effects| {
        let memory = MemoryParameters::default().with(effects);
        let tubes = vec![Tube::new(law.clone(), 0, [Isometry3::identity(); 2], (0.3, 2), memory)];
        let rest = Isometry3::translation(0.0, 0.0, 0.3);
        Body::new(
            &Isometry3::identity(),
            vec![Bay { rest, tubes }],
            vec![Plate { masses: Vec::new() }],
            [0.0; 3],
            [0.0; 3],
        )
    };
    let way = |effects| -> Vec<f64> {
        let mut body = tube(effects);
        let at = |k: i32| 2e5 * (1.0 - (f64::from(k) / 40.0 - 1.0).abs());
        (0..=80).map(|k| body.settle(&[at(k)], 0.0, 1.0).map(|()| body.tip_m()[2]).unwrap()).collect()
    };
    let (elastic, looped) = (way(Effects::NONE), way(Effects { hysteresis: true, ..Effects::NONE }));
    assert!((elastic[20] - elastic[60]).abs() < 1e-9 && (elastic[40] - 0.3 * 1.4).abs() < 1e-9);
    assert!(looped[20] < elastic[20] && looped[60] > looped[20] + 0.005, "{} {}", looped[20], looped[60]);
}
