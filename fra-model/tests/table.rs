//! Tables against closed forms, and what they do with numbers that are no setpoints.

use fra_model::*;

const KPA: f32 = 1e3;

/// `50 kPa (1 + x)` with `x = 2u - 1`: the pressure is `100 kPa u`.
const LINE: &[f32] = &[50.0 * KPA, 50.0 * KPA];

fn parameters(coefficients: &[f32]) -> TableParameters<'_, f32> {
    TableParameters {
        from: 1.0,
        to: 1.5,
        argument: Argument::Linear,
        steps: 32_768,
        pressure_max_pa: 100.0 * KPA,
        coefficients,
    }
}

fn table(parameters: &TableParameters<f32>) -> InverseTable<f32> {
    InverseTable::new(parameters).expect("good parameters")
}

/// Every 4091st bit pattern of `f32`, and the last.
fn bit_patterns() -> impl Iterator<Item = f32> {
    (0..=u32::MAX / 4091).map(|index| f32::from_bits(index * 4091)).chain([f32::from_bits(u32::MAX)])
}

#[test]
fn series_is_that_of_the_chebyshev_polynomials() {
    // T_k(cos a) = cos(k a), for every degree alone.
    for degree in 0..TABLE_COEFFICIENTS {
        let mut coefficients = [0.0_f64; TABLE_COEFFICIENTS];
        coefficients[0] = 1.0;
        coefficients[degree] += 0.5;
        let table = InverseTable::new(&TableParameters {
            from: -1.0,
            to: 1.0,
            argument: Argument::Linear,
            steps: 1024,
            pressure_max_pa: 2.0,
            coefficients: &coefficients,
        })
        .unwrap();
        for step in 0..=1024_u16 {
            let x = f64::from(step) / 512.0 - 1.0;
            let wanted = 1.0 + 0.5 * (degree as f64 * x.acos()).cos();
            let found = table.lookup(x).unwrap().pressure_pa;
            assert!((found - wanted).abs() < 1e-12, "degree {degree} at {x}: {found} {wanted}");
        }
    }
}

#[test]
fn argument_is_rounded_to_the_grid_and_no_further() {
    let table = table(&TableParameters { steps: 1024, ..parameters(LINE) });
    for thousandth in 0..=1000 {
        let target = 1.0 + 0.5 * thousandth as f32 / 1000.0;
        let found = table.lookup(target).unwrap();
        let exact = f64::from(target - 1.0) / 0.5 * 100e3;
        assert!((f64::from(found.pressure_pa) - exact).abs() <= 100e3 / 2048.0 * 1.000_1, "{target}: {found:?}");
        let steps = found.pressure_pa / (100.0 * KPA) * 1024.0;
        assert_eq!(steps, steps.round(), "{target}");
        assert_eq!(found.beyond, 0.0);
    }
}

#[test]
fn root_table_follows_a_square_root() {
    let table = table(&TableParameters { argument: Argument::Root, ..parameters(LINE) });
    for thousandth in 0..=1000 {
        let share = f64::from(thousandth) / 1000.0;
        let found = table.lookup(1.0 + 0.5 * share as f32).unwrap().pressure_pa;
        // Half a step of the grid, and what the rounding of the target is worth next to the root's vertical start.
        let allowed = 100e3 * (0.5 / 32_768.0 + 2.4e-7 / share.sqrt().max(5e-4));
        assert!((f64::from(found) - 100e3 * share.sqrt()).abs() <= allowed, "{share}: {found}");
    }
}

#[test]
fn targets_may_fall_with_the_pressure() {
    let table = table(&TableParameters { from: 0.0, to: -2.0, ..parameters(LINE) });
    assert_eq!(table.lookup(-0.5), Ok(Lookup { pressure_pa: 25.0 * KPA, beyond: 0.0 }));
    assert_eq!(table.lookup(0.5), Ok(Lookup { pressure_pa: 0.0, beyond: 0.25 }));
    assert_eq!(table.lookup(-3.0), Ok(Lookup { pressure_pa: 100.0 * KPA, beyond: 0.5 }));
}

#[test]
fn any_bit_pattern_gives_a_pressure_within_the_limits_or_an_error() {
    let wild: Vec<f32> = (0..TABLE_COEFFICIENTS).map(|k| 200e3 * (1.0 - 2.0 * (k % 2) as f32)).collect();
    for parameters in [
        parameters(LINE),
        TableParameters { argument: Argument::Root, ..parameters(LINE) },
        TableParameters { from: 2.0, to: -1e-3, steps: 256, ..parameters(&wild) },
        TableParameters { from: 0.0, to: f32::MAX, ..parameters(LINE) },
        TableParameters { from: 1.0, to: 1.0 + f32::EPSILON, ..parameters(LINE) },
    ] {
        let table = table(&parameters);
        for target in bit_patterns() {
            match table.lookup(target) {
                Ok(found) => {
                    assert!(
                        target.is_finite() && (0.0..=100.0 * KPA).contains(&found.pressure_pa),
                        "{target:e}: {found:?}"
                    );
                    assert!(found.beyond >= 0.0, "{target:e}: {found:?}");
                }
                Err(NotFinite) => assert!(!target.is_finite(), "{target:e}"),
            }
        }
    }
}

#[test]
fn table_that_rises_on_the_grid_rises_everywhere() {
    for argument in [Argument::Linear, Argument::Root] {
        let table =
            table(&TableParameters { argument, ..parameters(&[40.0 * KPA, 48.0 * KPA, 10.0 * KPA, 2.0 * KPA]) });
        let on_the_grid = (0..32_768).all(|step| table.at_step(step) <= table.at_step(step + 1));
        assert!(on_the_grid, "{argument:?}");
        // All single-precision numbers of the range, one after another.
        let (mut target, mut highest_pa) = (0.999_f32, 0.0);
        while target < 1.501 {
            let pressure_pa = table.lookup(target).unwrap().pressure_pa;
            assert!(pressure_pa >= highest_pa, "{argument:?} falls at {target}");
            (target, highest_pa) = (target.next_up(), pressure_pa);
        }
        assert_eq!(highest_pa, table.at_step(u16::MAX));
    }
}

#[test]
fn values_on_the_grid_are_all_values_there_are() {
    let table = table(&TableParameters { steps: 256, ..parameters(&[40.0 * KPA, 48.0 * KPA, 10.0 * KPA, 2.0 * KPA]) });
    let all: Vec<f32> = (0..=256).map(|step| table.at_step(step)).collect();
    for target in bit_patterns().filter(|target| target.is_finite()) {
        let found = table.lookup(target).unwrap().pressure_pa;
        assert!(all.contains(&found), "{target}: {found}");
    }
}

#[test]
fn parameters_that_make_no_table_are_refused_by_name() {
    let nan = f32::NAN;
    let many = [1.0; TABLE_COEFFICIENTS + 1];
    for (field, bad) in [
        ("from", TableParameters { from: nan, ..parameters(LINE) }),
        ("from", TableParameters { from: f32::INFINITY, ..parameters(LINE) }),
        ("to", TableParameters { to: nan, ..parameters(LINE) }),
        ("to", TableParameters { to: 1.0, ..parameters(LINE) }),
        ("to", TableParameters { from: -3e38, to: 3e38, ..parameters(LINE) }),
        ("to", TableParameters { from: 0.0, to: 1e-45, ..parameters(LINE) }),
        ("steps", TableParameters { steps: 255, ..parameters(LINE) }),
        ("steps", TableParameters { steps: 32_769, ..parameters(LINE) }),
        ("pressure_max_pa", TableParameters { pressure_max_pa: 0.0, ..parameters(LINE) }),
        ("pressure_max_pa", TableParameters { pressure_max_pa: nan, ..parameters(LINE) }),
        ("pressure_max_pa", TableParameters { pressure_max_pa: 1.1e9, ..parameters(LINE) }),
        ("coefficients", parameters(&[])),
        ("coefficients", parameters(&many)),
        ("coefficients", parameters(&[nan])),
        ("coefficients", parameters(&[1.0, f32::NEG_INFINITY])),
        ("coefficients", parameters(&[1.0, -200.1 * KPA])),
    ] {
        let error = InverseTable::new(&bad).expect_err(field);
        assert_eq!(error.field, field, "{bad:?}: {error}");
    }
}

#[test]
fn volume_has_the_slope_of_its_series() {
    // V = 1e-4 (1 + t^2) m3 over 100 kPa: t^2 = 3/8 + x/2 + T_2/8.
    let table = VolumeTable::new(100e3, &[1.375e-4, 0.5e-4, 0.125e-4]).unwrap();
    for percent in 0..=100 {
        let t = f64::from(percent) / 100.0;
        let found = table.lookup(1e5 * t).unwrap();
        assert!((found.volume_m3 - 1e-4 * (1.0 + t * t)).abs() < 1e-18, "{t}: {found:?}");
        assert!((found.compliance_m3_per_pa - 2e-9 * t).abs() < 1e-22, "{t}: {found:?}");
    }
    assert_eq!(table.lookup(-5e3), table.lookup(0.0));
    assert_eq!(table.lookup(2e5), table.lookup(1e5));
}

#[test]
fn volumes_of_any_pressure_are_positive_and_finite() {
    let table = VolumeTable::new(100e3_f32, &[1.375e-4, -0.5e-4, 0.125e-4]).unwrap();
    let rest_m3 = table.lookup(0.0).unwrap().volume_m3;
    for pressure_pa in bit_patterns() {
        match table.lookup(pressure_pa) {
            Ok(found) => {
                assert!(found.volume_m3 >= rest_m3 && found.volume_m3.is_finite(), "{pressure_pa}: {found:?}");
                assert!(found.compliance_m3_per_pa >= 0.0 && found.compliance_m3_per_pa.is_finite());
            }
            Err(NotFinite) => assert!(!pressure_pa.is_finite()),
        }
    }
    for (field, pressure_pa, coefficients) in [
        ("pressure_max_pa", 0.0, &[1e-4_f32][..]),
        ("pressure_max_pa", f32::NAN, &[1e-4]),
        ("coefficients", 1e5, &[]),
        ("coefficients", 1e5, &[f32::NAN]),
        ("coefficients", 1e5, &[1.1]),
        ("coefficients", 1e5, &[1e-4, 1e-4]),
    ] {
        assert_eq!(VolumeTable::new(pressure_pa, coefficients).expect_err(field).field, field);
    }
}
