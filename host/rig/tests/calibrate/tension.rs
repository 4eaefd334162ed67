//! Tensile tests: closed forms, published curves, intervals, and what a test cannot tell.

use fra_model::Material;
use softlimb_rig::calibrate::{Law, Settings, Tension, fit_tension};

use crate::calibrate::noise::{Noise, is_binomial};
use crate::calibrate::tube::grid;

/// Nominal stress of an incompressible wall in tension from the stress in it: `(2 W' (l^2 - 1/l)) / l`.
fn nominal(c: [f64; 3], stretch: f64) -> f64 {
    let x = stretch.powi(2) + 2.0 / stretch - 3.0;
    let slope = c[0] + 2.0 * c[1] * x + 3.0 * c[2] * x * x;
    2.0 * slope * (stretch.powi(2) - 1.0 / stretch) / stretch
}

fn table(c: [f64; 3], stretches: &[f64]) -> String {
    let rows = stretches.iter().map(|stretch| format!("{stretch},{}\n", nominal(c, *stretch)));
    format!("# a test\nstretch,nominal_stress_pa\n{}", rows.collect::<String>())
}

fn read(text: &str) -> Tension {
    Tension::read(text, None).unwrap()
}

#[test]
fn exact_tests_give_their_laws_to_nine_digits() {
    let stretches = grid(1.0, 2.2, 15);
    let neo = fit_tension(&read(&table([1e5, 0.0, 0.0], &stretches)), Law::NeoHookean, 0.002, &Settings::default());
    let neo = neo.unwrap();
    assert!((neo.values[0].value / 2e5 - 1.0).abs() < 1e-9, "{:?}", neo.values);
    assert_eq!((neo.tested, neo.softens_at), ([1.0, 2.2], None));
    let truth = [86_560.0, 13_805.0, -1_466.1];
    let yeoh = fit_tension(&read(&table(truth, &stretches)), Law::Yeoh, 0.002, &Settings::default()).unwrap();
    for (value, truth) in yeoh.values.iter().zip(truth) {
        assert!((value.value / truth - 1.0).abs() < 1e-9, "{}: {}", value.name, value.value);
    }
    assert!(matches!(yeoh.material, Material::Yeoh { c_pa } if (c_pa[2] + 1_466.1).abs() < 1e-4));
    // W' of these coefficients vanishes at I1 - 3 = 8.6, and the stress stops growing before that.
    let softens = yeoh.softens_at.unwrap();
    assert!((2.2..3.4).contains(&softens), "{softens}");
    let slope = |l: f64| (nominal(truth, l + 1e-4) - nominal(truth, l - 1e-4)).signum();
    assert!(slope(softens - 0.01) > 0.0 && slope(softens + 0.01) < 0.0);
}

/// DragonSkin 30: stresses read off the published curve (Marechal et al. 2020), and fits to all of it by another program.
#[test]
fn the_published_curve_of_dragon_skin_30_has_the_published_fits() {
    let text = "stretch,nominal_stress_kpa\n1.1,45.7\n1.2,89.9\n1.3,131.9\n1.5,213.9\n1.75,322.1\n2,437.1\n2.5,689.4\n3,959.5\n";
    let test = read(text);
    for (up_to, modulus) in [(1.5, 0.192e6), (2.0, 0.223e6), (3.0, 0.287e6)] {
        let fit = fit_tension(&test.up_to(up_to), Law::NeoHookean, 0.002, &Settings::default()).unwrap();
        // Eight points weigh the curve differently than all of it.
        assert!((fit.values[0].value / modulus - 1.0).abs() < 0.03, "{up_to}: {:?}", fit.values);
    }
    let fit = fit_tension(&test.up_to(2.0), Law::Yeoh, 0.002, &Settings::default()).unwrap();
    for (value, published) in fit.values.iter().zip([86_560.0, 13_805.0, -1_466.1]) {
        let [low, high] = value.interval;
        assert!((low..=high).contains(&published), "{}: {published} is not within {low} to {high}", value.name);
    }
    assert!((fit.values[0].value / 86_560.0 - 1.0).abs() < 0.01);
    assert!(fit.rms_pa < 0.005 * 437e3, "{}", fit.rms_pa);
}

#[test]
fn intervals_of_a_tensile_test_hold_the_truth_as_often_as_they_say() {
    let (truth, stretches) = ([86_560.0, 13_805.0, -1_466.1], grid(1.1, 2.4, 14));
    let mut counts = [0; 3];
    for seed in 0..400 {
        let mut noise = Noise::seeded(1000 + seed);
        let rows = stretches
            .iter()
            .map(|stretch| format!("{stretch},{}\n", nominal(truth, *stretch) + 500.0 * noise.normal()));
        let test = read(&format!("stretch,nominal_stress_pa\n{}", rows.collect::<String>()));
        let fit = fit_tension(&test, Law::Yeoh, 0.001, &Settings::default()).unwrap();
        for (count, (value, truth)) in counts.iter_mut().zip(fit.values.iter().zip(truth)) {
            *count += usize::from((value.interval[0]..=value.interval[1]).contains(&truth));
        }
    }
    println!("of 400 tensile tests the 95 % intervals hold the truth: {counts:?}");
    assert!(counts.iter().all(|count| is_binomial(*count, 400, 0.95)), "{counts:?}");
}

#[test]
fn a_test_up_to_1_2_does_not_tell_the_third_coefficient() {
    let test = read(&table([86_560.0, 13_805.0, -1_466.1], &grid(1.0, 1.2, 40)));
    let refused = fit_tension(&test, Law::Yeoh, 0.002, &Settings::default()).unwrap_err().to_string();
    assert!(refused.contains("c3_pa") && refused.contains("Larger stretches help, to about 2"), "{refused}");
    fit_tension(&test, Law::NeoHookean, 0.002, &Settings::default()).unwrap();
    let one =
        fit_tension(&read("stretch,nominal_stress_pa\n1,0\n1.5,2e5\n"), Law::NeoHookean, 0.002, &Settings::default());
    assert!(one.unwrap_err().to_string().starts_with("1 unknown from 1 point: 2 points are the fewest"));
}

#[test]
fn strain_and_force_are_stretch_and_stress_in_other_words() {
    let stretches = grid(1.0, 1.8, 9);
    let direct = read(&table([1e5, 0.0, 0.0], &stretches));
    let rows = stretches.iter().map(|l| format!("{},{}\r\n", 100.0 * (l - 1.0), nominal([1e5, 0.0, 0.0], *l) * 12e-6));
    let text = format!("\u{feff}strain_percent , force_n\r\n{}", rows.collect::<String>());
    let other = Tension::read(&text, Some(12e-6)).unwrap();
    for (a, b) in direct.points().iter().zip(other.points()) {
        assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-6);
    }
}

#[test]
fn bad_tables_are_told_line_column_value_and_what_is_allowed() {
    for (text, section, expected) in [
        ("", None, "there is nothing: expected a header and at least one row of numbers below it"),
        (
            "stretch,nominal_stress_pa\n",
            None,
            "there is a header alone: expected a header and at least one row of numbers below it",
        ),
        ("stretch;force_n\n1;2\n", None, "line 1: separate the columns by commas, and write numbers with a point"),
        (
            "stretch,nominal_stress_pa\n1.1,2\n\n# x\n1.2,abc\n",
            None,
            "line 5, column `nominal_stress_pa`: `abc` is not allowed: a number from -1000000000 to 1000000000",
        ),
        (
            "stretch,nominal_stress_pa\n0.1,2\n",
            None,
            "line 2, column `stretch`: `0.1` is not allowed: a number from 0.2 to 20",
        ),
        (
            "stretch,nominal_stress_pa\nNaN,2\n",
            None,
            "line 2, column `stretch`: `NaN` is not allowed: a number from 0.2 to 20",
        ),
        ("stretch,nominal_stress_pa\n,2\n", None, "line 2, column `stretch`: `` is not allowed: a number"),
        ("stretch,nominal_stress_pa\n1,2,3\n", None, "line 2: 3 cells where the header has 2"),
        (
            "stretch,stress\n1,2\n",
            None,
            "line 1: unknown column `stress`; known are stretch, strain, strain_percent, nominal_stress_pa, nominal_stress_kpa, nominal_stress_mpa, force_n",
        ),
        (
            "stretch,strain,force_n\n1,0,2\n",
            Some(1e-6),
            "line 1: 2 columns of stretch; give one of stretch, strain, strain_percent",
        ),
        ("stretch,stretch\n1,1\n", None, "line 1: there are two columns `stretch`"),
        (
            "stretch,force_n\n1,1\n",
            None,
            "line 1: a force needs the undeformed section: give it as `--section \"6 mm2\"`",
        ),
        ("stretch,nominal_stress_pa\n1,1\n", Some(1e-6), "line 1: a stress is already per section: give a force"),
    ] {
        assert_eq!(Tension::read(text, section).unwrap_err().to_string(), expected, "{text:?}");
    }
}

/// A law of one coefficient: the interval of its stress is the lever times that of the modulus.
#[test]
fn interval_of_the_stress_is_that_of_the_modulus_times_its_lever() {
    let stretches = grid(1.1, 2.0, 10);
    let off = |index: usize| if index.is_multiple_of(2) { 1.02 } else { 0.98 };
    let rows =
        stretches.iter().enumerate().map(|(index, l)| format!("{l},{}\n", off(index) * nominal([1e5, 0.0, 0.0], *l)));
    let text = format!("stretch,nominal_stress_pa\n{}", rows.collect::<String>());
    let fit = fit_tension(&read(&text), Law::NeoHookean, 0.02, &Settings::default()).unwrap();
    let [low, high] = fit.values[0].interval;
    for (stretch, half_pa) in stretches.iter().zip(&fit.half_widths_pa) {
        let exact = 0.5 * (high - low) * (stretch - stretch.powi(-2));
        assert!((half_pa - exact).abs() < 1e-9 * exact && exact > 0.0, "{stretch}: {half_pa} and {exact} Pa");
    }
}
