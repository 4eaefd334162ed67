//! The Yeoh law of a tensile test over the widest range that it describes.

use softlimb_rig::calibrate::{Tension, fit_range};
use softlimb_scene::{CASTABLE_ELASTOMERS, TENSILE_TESTS};

/// Nominal stress of an incompressible wall in tension, from the principal stress.
fn nominal(c: [f64; 3], stretch: f64) -> f64 {
    let x = stretch.powi(2) + 2.0 / stretch - 3.0;
    2.0 * (c[0] + 2.0 * c[1] * x + 3.0 * c[2] * x * x) * (stretch.powi(2) - 1.0 / stretch) / stretch
}

fn tests() -> Vec<(String, Tension)> {
    Tension::read_by_name(TENSILE_TESTS).unwrap()
}

fn named(points: impl Iterator<Item = [f64; 2]>) -> Tension {
    let rows = points.map(|[stretch, stress]| format!("{stretch},{stress}\n")).collect::<String>();
    Tension::read(&format!("stretch,nominal_stress_pa\n{rows}"), None).unwrap()
}

#[test]
fn laws_of_the_library_are_those_of_the_tests() {
    let tests = tests();
    assert_eq!(tests.len(), CASTABLE_ELASTOMERS.len());
    for known in &CASTABLE_ELASTOMERS {
        let (_, test) = tests.iter().find(|(name, _)| name == known.name).unwrap();
        let fit = fit_range(test).unwrap();
        assert_eq!(fit.stretch, known.stretch, "{}", known.name);
        for stretch in fit.stretch {
            let stored = nominal(known.c_pa, stretch);
            assert!((fit.stress_pa(stretch) / stored - 1.0).abs() < 1e-4, "{} at {stretch}", known.name);
        }
    }
}

#[test]
fn every_elastomer_is_described_within_five_percent_over_its_range() {
    for (name, test) in tests() {
        let known = CASTABLE_ELASTOMERS.iter().find(|known| known.name == name).unwrap();
        let [low, high] = known.stretch;
        assert!(high >= 2.0, "{name}: {high}");
        let within = test.points().iter().filter(|point| (low..=high).contains(&point[0]));
        let errors: Vec<f64> = within.map(|[stretch, stress]| nominal(known.c_pa, *stretch) / stress - 1.0).collect();
        let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        let worst = errors.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
        println!("{name}: {} readings, rms {:.1} %, worst {:.1} %", errors.len(), 100.0 * rms, 100.0 * worst);
        assert!(rms <= 0.05 && worst <= 0.1, "{name}: {rms} {worst}");
    }
}

#[test]
fn range_is_the_widest_that_the_law_describes() {
    let truth = [5e4, 2e3, -10.0];
    let stretches: Vec<f64> = (1..=40).map(|step| 1.0 + 0.1 * f64::from(step)).collect();
    let exact = named(stretches.iter().map(|stretch| [*stretch, nominal(truth, *stretch)]));
    let fit = fit_range(&exact).unwrap();
    assert_eq!(fit.stretch, [1.1, 5.0]);
    assert!(fit.c_pa.iter().zip(truth).all(|(found, truth)| (found / truth - 1.0).abs() < 1e-9), "{:?}", fit.c_pa);
    // The first reading of a slack specimen is left out, and no other.
    let slack = named(
        stretches.iter().map(|stretch| [*stretch, nominal(truth, *stretch) * if *stretch < 1.15 { 0.3 } else { 1.0 }]),
    );
    assert_eq!(fit_range(&slack).unwrap().stretch, [stretches[1], 5.0]);
    // A yield ends the range: no law of an elastomer has one.
    let yields = named(stretches.iter().map(|stretch| [*stretch, nominal(truth, stretch.min(3.0))]));
    let end = fit_range(&yields).unwrap().stretch[1];
    assert!((3.0..3.7).contains(&end), "{end}");
}

#[test]
fn no_range_is_told_where_none_reaches_twice_the_length() {
    let truth = [5e4, 2e3, 0.0];
    let short =
        named((1..=9).map(|step| 1.0 + 0.1 * f64::from(step)).map(|stretch| [stretch, nominal(truth, stretch)]));
    assert_eq!(fit_range(&short), None);
    let falling = named((1..=20).map(|step| 1.0 + 0.1 * f64::from(step)).map(|stretch| [stretch, 1e4 / stretch]));
    assert_eq!(fit_range(&falling), None);
}
