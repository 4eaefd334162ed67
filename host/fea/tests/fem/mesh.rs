//! Meshes: no element turned inside out, the volume of a tube, options out of range.

use std::f64::consts::PI;

use fra_model::{Arrangement, Families, Motion};
use softlimb_fea::solid::{Around, FemError, FiberModel, Model, Options, Part, Subject, SymmetryUse};
use softlimb_files::range::OutOfRange;

use crate::fem::motions;
use crate::fem::sample::{plain, wound};

const THREADS: FiberModel = FiberModel::Threads { spacing_m: None };
const WHOLE: Options = Options {
    fibers: FiberModel::Smeared { layer_m: None },
    symmetry: SymmetryUse::Whole,
    radial: None,
    around: Some(12),
    along: Some(8),
    bulk_ratio: 2000.0,
    increment: None,
    nodes_max: 400_000,
    all_nodes: false,
};

/// The share of the whole actuator that a model has.
fn share(model: &Model) -> f64 {
    let around = match model.symmetry().around {
        Around::Whole => 1.0,
        Around::Half => 0.5,
        Around::Sector(count) => 1.0 / f64::from(count),
    };
    around * if model.symmetry().half_length { 0.5 } else { 1.0 }
}

#[test]
fn meshes_are_sound_and_fill_the_tube_with_any_symmetry() {
    for parameters in motions() {
        for fibers in [FiberModel::Smeared { layer_m: Some(0.1e-3) }, THREADS] {
            for symmetry in [SymmetryUse::Auto, SymmetryUse::Whole] {
                let options = Options { fibers, symmetry, nodes_max: 400_000, ..Options::default() };
                let model = Model::new(&Subject::single(parameters), &options).unwrap();
                let all = model.mesh().quality(|_| true);
                assert!(all.worst_jacobian > 0.3, "{:?} {fibers:?}: {all:?}", parameters.motion);
                // Half of the layer sticks out of the wall.
                let outer = if fibers == THREADS { 8.0 } else { 8.05 };
                let tube = PI * (outer * outer - 36.0) * 60.0 * share(&model);
                let wall = model.mesh().quality(|element| matches!(element.part, Part::Wall | Part::Layer));
                // An arc of 15 degrees as a parabola: the area is off by a few parts in a million.
                assert!((wall.volume_mm3 / tube - 1.0).abs() < 2e-5, "{}: {wall:?} {tube}", parameters.motion as u8);
                let caps = model.mesh().quality(|element| element.part == Part::Cap);
                // The whole actuator has two, each 0.4 of the outer radius high.
                let cap = 2.0 * PI * outer * outer * 3.2 * share(&model);
                assert!((caps.volume_mm3 / cap - 1.0).abs() < 2e-5, "{caps:?} {cap}");
            }
        }
    }
}

#[test]
fn volume_converges_with_the_fourth_power_of_the_elements_around() {
    let error = |around| {
        let options = Options { around: Some(around), ..WHOLE };
        let model = Model::new(&Subject::single(plain(Motion::Expansion)), &options).unwrap();
        let volume = model.mesh().quality(|element| element.part == Part::Wall).volume_mm3;
        (volume / (PI * 28.0 * 60.0) - 1.0).abs()
    };
    let order = (error(8) / error(16)).log2();
    assert!((3.8..4.2).contains(&order), "{order}");
}

#[test]
fn symmetry_is_used_only_where_the_winding_has_it() {
    let symmetry = |motion, angle, families, fibers| {
        let options = Options { fibers, ..Options::default() };
        let model = Model::new(&Subject::single(wound(motion, angle, families)), &options).unwrap();
        (model.symmetry().around, model.symmetry().half_length)
    };
    let smeared = FiberModel::Smeared { layer_m: None };
    let threads = |mm: f64| FiberModel::Threads { spacing_m: Some(mm * 1e-3) };
    let sector = Around::Sector(12);
    assert_eq!(symmetry(Motion::Extension, 3.0, Families::Two, smeared), (sector, true));
    assert_eq!(symmetry(Motion::Extension, 3.0, Families::One, smeared), (sector, false));
    assert_eq!(symmetry(Motion::Expansion, 90.0, Families::One, smeared), (sector, true));
    assert_eq!(symmetry(Motion::Bending, 0.0, Families::One, smeared), (Around::Half, true));
    assert_eq!(symmetry(Motion::Bending, 3.0, Families::One, smeared), (Around::Whole, false));
    // Eight threads side by side turn into each other; a double helix of one thread each is its own mirror image.
    assert_eq!(symmetry(Motion::Twisting, 30.0, Families::One, threads(3.1)), (Around::Sector(8), false));
    assert_eq!(symmetry(Motion::Extension, 3.0, Families::Two, threads(2.6)), (Around::Half, true));
    assert_eq!(symmetry(Motion::Twisting, 3.0, Families::One, threads(2.6)), (Around::Whole, false));
}

#[test]
fn bundle_has_its_actuators_side_by_side_and_a_connector() {
    let subject = Subject {
        actuators: 3,
        arrangement: Arrangement::Circle { radius_m: 10e-3 },
        ..Subject::single(plain(Motion::Bending))
    };
    let model = Model::new(&subject, &WHOLE).unwrap();
    let all = model.mesh().quality(|_| true);
    assert!(all.worst_jacobian > 0.3, "{all:?}");
    let wall = model.mesh().quality(|element| matches!(element.part, Part::Wall | Part::Layer)).volume_mm3;
    let outer = 8.0 + 0.5 * 0.04;
    assert!((wall / (3.0 * PI * (outer * outer - 36.0) * 60.0) - 1.0).abs() < 2e-4, "{wall}");
    let plate = model.mesh().quality(|element| element.part == Part::Plate);
    assert!(plate.volume_mm3 > 3.0 * PI * 64.0 * 3.2);
    let gap = Subject { arrangement: Arrangement::Circle { radius_m: 9e-3 }, ..subject };
    let refused = Model::new(&gap, &WHOLE).unwrap_err().to_string();
    assert!(refused.contains("circle_radius_m = 0.009") && refused.contains("at least 0.009238 m"), "{refused}");
}

#[test]
fn absurd_wishes_are_refused_with_field_value_and_range() {
    let subject = Subject::single(wound(Motion::Extension, 3.0, Families::Two));
    let base = Options::default();
    for (options, words) in [
        (Options { radial: Some(0), ..base }, ["radial = 0", "1 to 12"]),
        (Options { around: Some(200), ..base }, ["around = 200", "8 to 96"]),
        (Options { around: Some(13), ..base }, ["around = 13", "even"]),
        (Options { along: Some(2), ..base }, ["along = 2", "4 to 800"]),
        (Options { bulk_ratio: f64::NAN, ..base }, ["bulk_ratio = NaN", "100 to 10000"]),
        (Options { bulk_ratio: 1e9, ..base }, ["bulk_ratio = 1000000000", "100 to 10000"]),
        (Options { increment: Some(0.9), ..base }, ["increment = 0.9", "0.001 to 0.5"]),
        (Options { nodes_max: 10, ..base }, ["nodes_max = 10", "100 to 400000"]),
        (Options { nodes_max: 300, ..base }, ["about", "nodes_max allows 300"]),
        (
            Options { fibers: FiberModel::Smeared { layer_m: Some(1.5e-3) }, ..base },
            ["layer_mm = 1.5", "0.0020 to 1.0000 mm"],
        ),
        (Options { fibers: FiberModel::Smeared { layer_m: Some(-1.0) }, ..base }, ["layer_mm = -1000", "> 0"]),
        (
            Options { fibers: FiberModel::Threads { spacing_m: Some(1e-6) }, ..base },
            ["spacing_mm = 0.001", "0.1005 to 50.2655 mm"],
        ),
        (
            Options { fibers: FiberModel::Threads { spacing_m: Some(f64::INFINITY) }, ..base },
            ["spacing_mm = inf", "finite"],
        ),
    ] {
        let text = Model::new(&subject, &options).expect_err("refused").to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{words:?}: {text}");
    }
    let mut short = subject;
    short.parameters.length_m = 5e-3;
    assert!(matches!(
        Model::new(&short, &base),
        Err(FemError::Invalid(OutOfRange { field: "length_m / outer_radius_m", .. }))
    ));
    let mut inside_out = subject;
    inside_out.parameters.inner_radius_m = 9e-3;
    assert!(matches!(Model::new(&inside_out, &base), Err(FemError::Parameters(_))));
}

#[test]
fn estimate_of_nodes_is_close() {
    for parameters in motions() {
        let model = Model::new(&Subject::single(parameters), &WHOLE).unwrap();
        let text = Model::new(&Subject::single(parameters), &Options { nodes_max: 100, ..WHOLE }).unwrap_err();
        let FemError::TooFine { nodes, allowed: 100 } = text else { panic!("{text}") };
        assert!((nodes as f64 / model.nodes() as f64 - 1.0).abs() < 0.1, "{nodes} {}", model.nodes());
    }
}
