//! Queries to the tables that stand in for a solver.

use core::hint::black_box;

use fra_model::{Argument, InverseTable, TABLE_COEFFICIENTS, TableParameters, VolumeTable};

use crate::Bench;

/// A bend up to 3 rad at up to this gauge pressure, Pa.
const PRESSURE_MAX_PA: f32 = 97e3;
const BEND_MAX_RAD: f32 = 3.0;

/// Tables with their coefficients: of the degree that most actuators need, and of the highest one.
const TABLES: [(&str, Argument, usize); 3] = [
    ("degree 5", Argument::Linear, 6),
    ("degree 16", Argument::Linear, TABLE_COEFFICIENTS),
    ("degree 16, of a root", Argument::Root, TABLE_COEFFICIENTS),
];

/// Puts all queries; whether each table could be built and answers.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    let answered = TABLES.map(|(name, argument, count)| put(bench, name, argument, count));
    answered.into_iter().all(|well| well)
}

/// With all coefficients in use: the cost of a lookup depends on nothing else.
fn put(bench: &mut impl Bench, name: &str, argument: Argument, count: usize) -> bool {
    let half = 0.5 * PRESSURE_MAX_PA;
    let mut pressures = [0.25; TABLE_COEFFICIENTS];
    let mut volumes = [1e-9; TABLE_COEFFICIENTS];
    pressures[..2].copy_from_slice(&[half, half]);
    volumes[..2].copy_from_slice(&[90e-6, 15e-6]);
    let inverse = InverseTable::new(&TableParameters {
        from: 0.0,
        to: BEND_MAX_RAD,
        argument,
        steps: 32_768,
        pressure_max_pa: PRESSURE_MAX_PA,
        coefficients: &pressures[..count],
    });
    let volume = VolumeTable::new(PRESSURE_MAX_PA, &volumes[..count]);
    let (Ok(inverse), Ok(volume)) = (inverse, volume) else { return false };
    let found = bench.put("inverse, table", name, || black_box(&inverse).lookup(black_box(1.234)));
    bench.put("step of a table", name, || black_box(&inverse).at_step(black_box(13_479)));
    let air = bench.put("volume, table", name, || black_box(&volume).lookup(black_box(40e3)));
    let limits = [inverse.pressure_max_pa(), volume.pressure_max_pa()];
    found.is_ok() && air.is_ok() && limits == [PRESSURE_MAX_PA; 2]
}
