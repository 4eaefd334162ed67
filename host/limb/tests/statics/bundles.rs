//! Bundles as one rod beside their tubes, each a rod of its own between plates.

use std::f64::consts::{FRAC_PI_2, PI};

use fra_model::Motion;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use softlimb_limb::statics::{
    Bends, Bundle, Fidelity, LoadedLimb, Piece, Rod, Shape, Tangent, by_tubes, cheapest, cheapest_rod, solve,
};

use crate::samples::samples;
use crate::statics::Stream;
use crate::statics::beam::Tube;
use crate::statics::closed_forms::{EI, LENGTH_M, heavy_cantilever};
use crate::statics::tubes::{Bay, Tubes, around};

/// Tubes, bays and length at rest of each bundle of a limb; a rigid part with masses behind each.
struct Limb {
    bundles: Vec<(Vec<Tube>, usize, f64)>,
    rigid_m: f64,
    masses: Vec<(f64, f64)>,
    base: Isometry3<f64>,
    force_n: Vector3<f64>,
    gravity_m_per_s2: f64,
}

impl Limb {
    /// One bundle that stands upright, without weight.
    fn upright(tubes: Vec<Tube>, bays: usize, length_m: f64) -> Self {
        let (base, force_n) = (Isometry3::identity(), Vector3::zeros());
        Self {
            bundles: vec![(tubes, bays, length_m)],
            rigid_m: 0.0,
            masses: Vec::new(),
            base,
            force_n,
            gravity_m_per_s2: 0.0,
        }
    }

    fn length_m(&self) -> f64 {
        self.bundles.iter().map(|(_, _, length_m)| length_m + self.rigid_m).sum()
    }

    /// As tubes between plates, under a share of the loads.
    fn tubes(&self, load: f64) -> Tubes {
        let mut bays = Vec::new();
        for (tubes, count, length_m) in &self.bundles {
            let rest_m = length_m / *count as f64;
            let spacer = Bay { tubes: tubes.clone(), rest_m, rigid_m: 0.0, masses: Vec::new() };
            bays.extend(std::iter::repeat_n(spacer.clone(), count - 1));
            bays.push(Bay { rigid_m: self.rigid_m, masses: self.masses.clone(), ..spacer });
        }
        let gravity_m_per_s2 = Vector3::new(0.0, 0.0, -self.gravity_m_per_s2 * load);
        Tubes { base: self.base, bays, gravity_m_per_s2, tip_n: self.force_n * load, tip_nm: Vector3::zeros() }
    }

    /// As a chain of rods.
    fn loaded(&self, load: f64) -> LoadedLimb {
        let bundle = |(tubes, count, length_m): &(Vec<Tube>, usize, f64)| {
            let springs = tubes.iter().map(|tube| (tube.at_m, spring(tube))).collect();
            let bundle = Bundle::of_tubes(Motion::Extension, springs, length_m / *count as f64).expect("a bundle");
            let free = bundle.free;
            let piece = Piece {
                free: [free.stretch, free.bend_rad_per_m[0], free.bend_rad_per_m[1], free.twist_rad_per_m],
                free_shear: [0.0; 2],
                stiffness: bundle.stiffness,
                coupled: nalgebra::Matrix4x2::zeros(),
                shear_n: bundle.shear_n,
                sway: bundle.sway,
                length_m: *length_m,
                mount_angle_rad: 0.0,
                kg_per_m: tubes.iter().map(|tube| tube.kg_per_m).sum(),
                rigid_m: self.rigid_m,
                masses: self.masses.clone(),
            };
            (piece, (Motion::Extension, bundle))
        };
        let (pieces, bundles) = self.bundles.iter().map(bundle).unzip();
        let gravity_m_per_s2 = Vector3::new(0.0, 0.0, -self.gravity_m_per_s2 * load);
        LoadedLimb::of_rod(Rod { base: self.base, pieces, gravity_m_per_s2, tip_force_n: self.force_n * load }, bundles)
    }

    /// Shape by so many pieces a bundle.
    fn shape(&self, load: f64, parts: usize) -> Option<(LoadedLimb, Rod, Shape)> {
        let limb = self.loaded(load);
        let rod = limb.rod.split(parts);
        let shape = solve(&rod, Bends::Linear, None).ok()?;
        Some((limb, rod, shape))
    }

    fn tip_by_tubes(&self, load: f64) -> Option<Vector3<f64>> {
        self.tubes(load).tip().map(|tip| tip.translation.vector)
    }

    fn tip_by_rod(&self, load: f64) -> Vector3<f64> {
        self.shape(load, 6).expect("stable").2.tip().translation.vector
    }
}

fn spring(tube: &Tube) -> Tangent {
    Tangent {
        stretch: tube.stretch,
        bend_rad_per_m: 0.0,
        twist_rad_per_m: 0.0,
        axial_n: tube.axial_n,
        bending_nm2: tube.bending_nm2,
        across_nm2: tube.bending_nm2,
        torsion_nm2: tube.torsion_nm2,
        coupling_nm: 0.0,
        shear_n: tube.shear_n,
        outer_radius_m: 0.014,
    }
}

/// Tubes of the scenes, of walls of 10 to 14 mm, with stretches of their own.
fn tubes_of(stretches: &[f64]) -> Vec<Tube> {
    let (axial_n, bending_nm2) = (240.0, 0.0178);
    let tube = |(at_m, stretch): ([f64; 2], &f64)| {
        let stretch = *stretch;
        Tube { at_m, stretch, axial_n, bending_nm2, torsion_nm2: 0.0107, shear_n: 33.0, kg_per_m: 0.3 }
    };
    around(stretches.len(), 0.03).into_iter().zip(stretches).map(tube).collect()
}

/// One tube in the middle, nearly rigid in all but bending.
fn slender(length_m: f64) -> Limb {
    let (at_m, axial_n) = ([0.0, 0.0], 1e5);
    let tube = Tube { at_m, stretch: 1.0, axial_n, bending_nm2: EI, torsion_nm2: EI, shear_n: axial_n, kg_per_m: 0.8 };
    Limb::upright(vec![tube], 8, length_m)
}

#[test]
fn tube_alone_is_an_elastica_and_buckles_where_euler_says() {
    let mut level = slender(LENGTH_M);
    level.base.rotation = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    level.gravity_m_per_s2 = 10.0;
    level.force_n = Vector3::new(0.0, 0.0, -3.0);
    let [x, z] = heavy_cantilever(8.0, 3.0);
    let tip = level.tip_by_tubes(1.0).expect("stable");
    // Shear and stretch, which the elastica has not, give way by 1e-4 of the length.
    assert!((tip - Vector3::new(x, 0.0, z)).norm() < 3e-4 * LENGTH_M, "{tip} {x} {z}");
    let mut column = slender(LENGTH_M);
    column.force_n = Vector3::new(0.0, 0.0, -PI * PI * EI / (4.0 * LENGTH_M * LENGTH_M));
    assert!(column.tip_by_tubes(0.99).is_some() && column.tip_by_tubes(1.01).is_none());
}

/// Equal tubes: what a couple at the tip turns the end plate by has the closed form of Steiner; twist has that of the S of each tube.
#[test]
fn couples_turn_bundles_by_their_closed_forms() {
    let (tubes, length_m, couple_nm) = (tubes_of(&[1.1; 3]), 0.24, 1e-4);
    let steiner = 3.0 * tubes[0].bending_nm2 + 1.5 * tubes[0].axial_n * 9e-4;
    for bays in [1, 3] {
        let limb = Limb::upright(tubes.clone(), bays, length_m);
        let turn = |couple: Vector3<f64>| {
            let turned = Tubes { tip_nm: couple, ..limb.tubes(1.0) }.tip().expect("stable").rotation.scaled_axis();
            turned / couple_nm
        };
        let bent = turn(Vector3::new(couple_nm, 0.0, 0.0)).x;
        assert!((bent * steiner / length_m - 1.0).abs() < 1e-4, "{bent}");
        let long_m = 1.1 * length_m / bays as f64;
        let slide_n = 1.0 / (1.0 / tubes[0].shear_n + long_m.powi(2) / (12.0 * tubes[0].bending_nm2));
        let torsion = 3.0 * (tubes[0].torsion_nm2 + slide_n * 9e-4);
        let wound = turn(Vector3::new(0.0, 0.0, couple_nm)).z;
        assert!((wound * torsion / length_m - 1.0).abs() < 1e-4, "{wound}");
        let stiffness = limb.loaded(0.0).rod.pieces[0].stiffness;
        assert!((stiffness[(1, 1)] / steiner - 1.0).abs() < 1e-9, "{stiffness}");
        assert!((stiffness[(3, 3)] / torsion - 1.0).abs() < 1e-9, "{stiffness}");
    }
}

#[test]
fn small_loads_move_the_rod_as_they_move_its_tubes() {
    let cases: [&[f64]; 3] = [&[1.1; 3], &[1.11, 1.1, 1.1], &[1.1; 4]];
    for stretches in cases {
        for bays in [1, 3, 8] {
            let mut limb = Limb::upright(tubes_of(stretches), bays, 0.24);
            let (loaded, rod, shape) = limb.shape(0.0, 6).expect("stable");
            let free = [limb.tip_by_tubes(0.0).expect("stable"), shape.tip().translation.vector];
            // Unequal tubes hold each other: what the rod leaves out of that is told.
            let told = loaded.tubes_shift_m(&rod, &shape, Bends::Linear).expect("stable");
            assert!((free[0] - free[1] - told).norm() < 1e-6 + 0.05 * told.norm(), "{free:?} {told}");
            for force_n in [Vector3::x(), Vector3::y(), Vector3::z()] {
                limb.force_n = force_n;
                let load = 1e-2;
                let by_tubes = (limb.tip_by_tubes(load).expect("stable") - free[0]) / load;
                let by_rod = (limb.tip_by_rod(load) - free[1]) / load;
                let off = (by_tubes - by_rod).norm() / by_tubes.norm();
                let allowed = if stretches[0] == stretches[1] { 2e-5 } else { 5e-3 };
                println!("{stretches:?}, {bays} bays, {:?}: {off:.1e}", force_n.as_slice());
                assert!(off < allowed, "{by_tubes} {by_rod}");
            }
        }
    }
}

/// Compression changes the stiffness of a column of tubes against a force across it, at small forces of both.
#[test]
fn compression_softens_the_rod_as_it_softens_its_tubes() {
    for bays in [1, 3, 8] {
        let mut limb = Limb::upright(tubes_of(&[1.1; 3]), bays, 0.24);
        let mut softer = |by: &dyn Fn(&Limb) -> Vector3<f64>| {
            let mut across = |force_n: f64| {
                limb.force_n = Vector3::new(1e-2, 0.0, -force_n);
                by(&limb).x
            };
            (across(0.2) - across(-0.2)) / across(0.0)
        };
        let by_tubes = softer(&|limb| limb.tip_by_tubes(1.0).expect("stable"));
        let by_rod = softer(&|limb| limb.tip_by_rod(1.0));
        assert!(by_tubes > 0.0 && (by_rod / by_tubes - 1.0).abs() < 1e-2, "{bays}: {by_tubes} {by_rod}");
    }
}

/// Tubes like those of the scenes, at a pressure each.
fn random_bundle(stream: &mut Stream) -> Vec<Tube> {
    let count = if stream.next() < 0.7 { 3 } else { 4 };
    let radius_m = stream.between(0.025, 0.035);
    let (axial_n, gyration_m2) = (stream.between(150.0, 400.0), stream.between(6e-5, 9e-5));
    let stretch = stream.between(1.02, 1.2);
    let apart = stream.between(0.0, 0.05);
    let place = |at_m| Tube {
        at_m,
        stretch: stretch + apart * stream.between(-1.0, 1.0),
        axial_n: axial_n * stream.between(0.95, 1.05),
        bending_nm2: axial_n * gyration_m2,
        torsion_nm2: 0.6 * axial_n * gyration_m2,
        shear_n: 0.14 * axial_n,
        kg_per_m: stream.between(0.1, 0.3),
    };
    let mut tubes: Vec<Tube> = around(count, radius_m).into_iter().map(place).collect();
    // A limb knows the mass of a bundle only.
    let mean = tubes.iter().map(|tube| tube.kg_per_m).sum::<f64>() / count as f64;
    tubes.iter_mut().for_each(|tube| tube.kg_per_m = mean);
    tubes
}

/// One to three bundles of one to four bays, some way up, under weight and a force.
fn random_limb(stream: &mut Stream, modules: usize) -> Limb {
    let bundle =
        |stream: &mut Stream| (random_bundle(stream), 1 + (stream.next() * 4.0) as usize, stream.between(0.15, 0.3));
    let bundles = (0..modules).map(|_| bundle(stream)).collect();
    let masses = vec![(0.01, stream.between(0.05, 0.3))];
    let mut vector =
        |size: f64| Vector3::new(stream.between(-size, size), stream.between(-size, size), stream.between(-size, size));
    let base = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(vector(2.0)));
    Limb { bundles, rigid_m: 0.02, masses, base, force_n: vector(5.0), gravity_m_per_s2: 10.0 }
}

/// The greatest load up to four times that of [`random_limb`] at which the worst tube carries a share of its load of buckling.
fn load_for(limb: &Limb, share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 4.0);
    for _ in 0..8 {
        let middle = 0.5 * (low + high);
        let below = limb
            .shape(middle, 1)
            .is_some_and(|(limb, rod, shape)| limb.buckling(&rod, &shape).is_some_and(|tube| tube.ratio() < share));
        if below { low = middle } else { high = middle }
    }
    low
}

#[test]
fn what_rods_leave_out_of_tubes_is_told() {
    let mut stream = Stream(77);
    let (mut compared, mut judged, mut within, mut by_square, mut lost) = (0, 0, 0, 0, 0);
    let (mut ratios, mut left): (Vec<f64>, Vec<f64>) = Default::default();
    let limbs = samples(120) as usize;
    for case in 0..limbs {
        let limb = random_limb(&mut stream, 1 + case % 3);
        let load = load_for(&limb, 0.01 * 50_f64.powf(stream.next()));
        let (Some((loaded, rod, shape)), Some(exact)) = (limb.shape(load, 4), limb.tip_by_tubes(load)) else {
            lost += 1;
            continue;
        };
        let ratio = loaded.buckling(&rod, &shape).expect("tubes").ratio();
        if ratio > 0.5 {
            lost += 1;
            continue;
        }
        compared += 1;
        let error = (exact - shape.tip().translation.vector).norm() / limb.length_m();
        let shift = loaded.tubes_shift_m(&rod, &shape, Bends::Linear).expect("stable");
        let told = shift.norm() / limb.length_m();
        if error > 1e-3 {
            judged += 1;
            ratios.push(told / error);
            left.push((exact - shape.tip().translation.vector - shift).norm() / limb.length_m() / error);
            within += usize::from((0.4..=2.5).contains(&(told / error)));
            by_square += usize::from((0.4..=2.5).contains(&(0.25 * ratio * ratio / error)));
        }
    }
    left.sort_by(f64::total_cmp);
    ratios.sort_by(f64::total_cmp);
    println!("{compared} limbs, {lost} without a shape by one of both or beyond half of the load of buckling");
    println!("errors above 0.1 %: {judged}; told within 0.4 to 2.5: {within}; by 25 (N/N_c)^2 %: {by_square}");
    println!("told over true: {:.2} to {:.2}, median {:.2}", ratios[0], ratios[judged - 1], ratios[judged / 2]);
    println!(
        "what is left of the error with the shift added: {:.2} to {:.2}, median {:.2}",
        left[0],
        left[judged - 1],
        left[judged / 2]
    );
    assert!(left[judged / 2] < 0.3, "{left:?}");
    assert!(compared * 120 >= limbs * 100 && judged * 120 >= limbs * 40, "{compared} {judged} of {limbs}");
    assert!(within * 100 >= judged * 95, "{within} of {judged}");
}

/// Every tube a rod of its own, beside the solution that shares nothing with it: the tip, and what is told of its error.
#[test]
fn tubes_of_the_limb_are_the_tubes_that_are_shot() {
    let limbs = samples(120) as usize;
    for seed in [77, 78] {
        let mut stream = Stream(seed);
        let (mut compared, mut judged, mut within) = (0, 0, 0);
        let (mut errors, mut told, mut finest): ([f64; 2], Vec<f64>, f64) = Default::default();
        for case in 0..limbs {
            let limb = random_limb(&mut stream, 1 + case % 3);
            let load = load_for(&limb, 0.01 * 50_f64.powf(stream.next()));
            let (Some((loaded, rod, shape)), Some(exact)) = (limb.shape(load, 4), limb.tip_by_tubes(load)) else {
                continue;
            };
            let off = |tip: Isometry3<f64>| (exact - tip.translation.vector).norm() / limb.length_m();
            let rods = off(shape.tip());
            if rods <= 1e-3 {
                continue;
            }
            compared += 1;
            // What each number of pieces says of itself.
            for tolerance in [1.0, 1e-3, 1e-5] {
                let answer = by_tubes(&loaded, tolerance, limb.length_m()).expect("a shape");
                let error = off(answer.tip());
                errors = [errors[0].max(rods), errors[1].max(if tolerance < 1e-4 { error } else { 0.0 })];
                if error > 1e-3 {
                    judged += 1;
                    told.push(answer.error() / error);
                    within += usize::from((0.4..=2.5).contains(&(answer.error() / error)));
                }
            }
            // Four times the pieces leave a sixteenth, and what is told points the right way: added, next to nothing is left.
            let [coarse, fine] = [4, 8].map(|fine| {
                let near = loaded.tubes_near(&rod, &shape.q, fine);
                near.or_else(|| loaded.tubes_grown(fine)).expect("a shape").tip()
            });
            let way = (fine.translation.vector - coarse.translation.vector) / 3.0;
            finest = finest.max((exact - fine.translation.vector - way).norm() / limb.length_m());
        }
        told.sort_by(f64::total_cmp);
        let [rods, tubes] = errors.map(|error| 100.0 * error);
        println!("draw {seed}: {compared} limbs; rods are off by up to {rods:.2} %, tubes by up to {tubes:.3} %");
        println!("with their told error added by up to {:.4} %", 100.0 * finest);
        println!(
            "still above 0.1 %: {judged}; told within 0.4 to 2.5: {within}, {:.2?} to {:.2?}",
            told.first(),
            told.last()
        );
        assert!(compared >= limbs * 35 / 120 && judged >= limbs * 5 / 120, "{compared} {judged} of {limbs}");
        assert_eq!(within, judged);
        assert!(tubes < 0.05 * rods && 100.0 * finest < 0.005 * rods, "{tubes} {finest}");
    }
}

/// Tubes beyond half of their load of buckling, where rods are no longer right.
#[test]
fn tubes_are_right_where_one_of_them_is_near_buckling() {
    let mut stream = Stream(79);
    let (mut compared, mut missed, mut both_fall): (usize, usize, usize) = Default::default();
    let (mut rods, mut tubes, mut told): (f64, f64, Vec<f64>) = Default::default();
    let limbs = samples(30).max(6) as usize;
    for case in 0..limbs {
        let limb = random_limb(&mut stream, 1 + case % 3);
        let load = load_for(&limb, 0.5 + 0.45 * stream.next());
        let exact = limb.tip_by_tubes(load);
        let answer = by_tubes(&limb.loaded(load), 1e-4, limb.length_m());
        match (exact, answer) {
            (Some(exact), Some(answer)) if answer.buckling.is_some_and(|tube| tube.ratio() > 0.5) => {
                compared += 1;
                let off = |tip: Isometry3<f64>| (exact - tip.translation.vector).norm() / limb.length_m();
                rods = rods.max(off(answer.shape.tip()));
                let error = off(answer.tip());
                tubes = tubes.max(error);
                if error > 1e-3 {
                    told.push(answer.error() / error);
                }
            }
            (Some(_), None) => missed += 1,
            (None, None) => both_fall += 1,
            _ => {}
        }
    }
    let within = told.iter().filter(|told| (0.4..=2.5).contains(*told)).count();
    let [rods, tubes] = [rods, tubes].map(|error| 100.0 * error);
    println!(
        "{compared} limbs, {missed} without a shape, {both_fall} that both let fall; rods off by up to {rods:.1} %"
    );
    println!(
        "tubes off by up to {tubes:.2} %, above 0.1 % {}; told within 0.4 to 2.5: {within}, {told:.2?}",
        told.len()
    );
    assert!(compared * 30 >= limbs * 8 && missed * 4 <= compared, "{compared} {missed} of {limbs}");
    assert!(tubes < 0.05 * rods, "{rods} {tubes}");
    assert_eq!(within, told.len());
}

/// Stiffness of the tip by differences of the tubes that are shot; the load factor of a column is Euler's load over its own.
#[test]
fn tubes_give_way_as_the_tubes_that_are_shot_and_fall_at_eulers_load() {
    let mut limb = Limb::upright(tubes_of(&[1.12, 1.1, 1.1]), 2, 0.24);
    limb.base.rotation = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 1.0);
    limb.gravity_m_per_s2 = 10.0;
    let given =
        by_tubes(&limb.loaded(1.0), 1e-6, 0.24).and_then(|answer| answer.compliance_m_per_n()).expect("a shape");
    for axis in 0..3 {
        let mut at = |force_n: f64| {
            limb.force_n = Vector3::zeros();
            limb.force_n[axis] = force_n;
            limb.tip_by_tubes(1.0).expect("stable")
        };
        let expected = (at(1e-2) - at(-1e-2)) / 2e-2;
        let off = (given.column(axis) - expected).norm() / expected.norm();
        println!("stiffness along axis {axis} off by {off:.1e}");
        assert!(off < 1e-3, "{axis}: {off} {expected}");
    }
    let mut column = slender(LENGTH_M);
    let euler_n = PI * PI * EI / (4.0 * LENGTH_M * LENGTH_M);
    for share in [0.3, 0.5, 0.995] {
        column.force_n = Vector3::new(0.0, 0.0, -share * euler_n);
        let found = by_tubes(&column.loaded(1.0), 1e-3, LENGTH_M).expect("it stands").load_factor();
        println!("load factor at {share} of Euler's load: {found:.4}");
        assert!((found * share - 1.0).abs() < 3e-3, "{share}: {found}");
    }
    column.force_n = Vector3::new(0.0, 0.0, -1.005 * euler_n);
    assert!(column.loaded(1.0).tubes_grown(2).is_none());
}

/// Tubes are taken where rods hold a tolerance in all but that they are no tubes, and not where rods hold it or a tube is beyond half of its
/// load of buckling.
#[test]
fn tubes_are_taken_only_where_rods_do_not_do() {
    let mut stream = Stream(77);
    let mut taken = 0;
    for case in 0..24 {
        let limb = random_limb(&mut stream, 1 + case % 3);
        let load = load_for(&limb, 0.01 * 50_f64.powf(stream.next()));
        let (loaded, length_m) = (limb.loaded(load), limb.length_m());
        let Ok(fine) = cheapest_rod(&loaded, -1.0, length_m) else { continue };
        assert!(fine.tier == Fidelity::Fourfold && fine.tubes.is_none());
        let by = |tolerance: f64| cheapest(&loaded, tolerance, length_m).expect("rods carry it");
        assert!(by(1.5 * fine.error().max(0.01)).tier < Fidelity::Tubes);
        let sound = fine.buckling.is_some_and(|tube| tube.ratio() < 0.4);
        if sound && fine.bundle_error > 8.0 * fine.order_error.max(1e-5) {
            let answer = by(0.5 * fine.bundle_error);
            taken += 1;
            assert_eq!(answer.tier, Fidelity::Tubes);
            assert!(answer.error() <= 0.5 * fine.bundle_error);
            assert!(answer.tubes.is_some_and(|(_, rods)| rods >= fine.bundle_error));
        }
    }
    assert!(taken >= 8, "{taken}");
}
