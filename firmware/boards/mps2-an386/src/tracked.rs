//! Queries to the tracker, compiled as it is for a device.

use core::hint::black_box;

use fra_model::{InvalidParameter, State, Tracker};

use crate::Bench;
use crate::actuators::{CASES, Case};

/// Steps on the way from rest to next to the pressure of the query.
const STEPS: u8 = 20;
/// A warm start is this share of the pressure away.
const NEAR: f32 = 0.98;

/// Puts all queries; whether all have answers.
pub(crate) fn put_all(bench: &mut impl Bench) -> bool {
    // The wound ones that extend, expand and twist.
    let answered = [&CASES[0], &CASES[1], &CASES[2]].map(|case| matches!(put(bench, case), Ok(Some(()))));
    answered == [true; 3]
}

fn put(bench: &mut impl Bench, case: &Case) -> Result<Option<()>, InvalidParameter<f32>> {
    let Some(tracker) = Tracker::new(&case.parameters)? else { return Ok(None) };
    let Some(near) = walk(&tracker, NEAR * case.pressure_pa)? else { return Ok(None) };
    let name = case.name;
    let forward = bench.put("forward, warm, as flashed", name, || {
        black_box(&tracker).forward(black_box(&near), black_box(case.pressure_pa))
    });
    let Some(found) = forward? else { return Ok(None) };
    let target = case.target(&found);
    let inverse = bench
        .put("inverse, warm, as flashed", name, || black_box(&tracker).inverse(black_box(&near), black_box(target)));
    Ok(inverse?.map(drop))
}

/// The state at a pressure, step by step from rest.
fn walk(tracker: &Tracker<f32>, pressure_pa: f32) -> Result<Option<State<f32>>, InvalidParameter<f32>> {
    let mut state = tracker.rest();
    for step in 1..=STEPS {
        let share = f32::from(step) / f32::from(STEPS);
        let Some(next) = tracker.forward(&state, share * pressure_pa)? else { return Ok(None) };
        state = next;
    }
    Ok(Some(state))
}
