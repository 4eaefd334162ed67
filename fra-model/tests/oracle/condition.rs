//! How far a rounding of the inputs moves the answer.

use super::number::{Dual, Number};
use super::polish::{largest, solve};
use super::wall::{INPUTS, PRESSURE, Rule, Tube};

/// `d(loads - applied)/d ln(input)` at a state; row: load.
fn by_inputs(tube: &Tube, rule: &Rule, state: [f64; 3]) -> [[f64; INPUTS]; 3] {
    let inputs: [Dual<INPUTS>; INPUTS] = std::array::from_fn(|i| Dual::variable(tube.inputs[i], i));
    let loads = tube.loads(rule, &inputs, state.map(Dual::of));
    let applied = Tube::applied(&inputs, Dual::of(std::f64::consts::PI));
    std::array::from_fn(|i| {
        let slopes = (loads[i] - applied[i]).slopes;
        let counts = i < 2 || tube.twists;
        std::array::from_fn(|k| if counts { slopes[k] * tube.inputs[k] } else { 0.0 })
    })
}

/// Sum over the inputs `p` of `|p| max |dd/dp| / max |d|`, at least one; `d` is the state `(e, w, g)` of an equilibrium.
pub(crate) fn condition(tube: &Tube, rule: &Rule, state: [f64; 3]) -> Option<f64> {
    let rows = by_inputs(tube, rule, state);
    let (_, slopes) = tube.linearised(rule, state);
    let mut matrix = [[0.0; 4]; 4];
    for i in 0..3 {
        matrix[i][..3].copy_from_slice(&slopes[i]);
    }
    matrix[3][3] = 1.0;
    let moved = |k: usize| Some(largest(&solve(matrix, [rows[0][k], rows[1][k], rows[2][k], 0.0])?[..3]));
    let sum: f64 = (0..INPUTS).map(moved).sum::<Option<f64>>()?;
    let size = largest(&state);
    (size > 0.0).then(|| (sum / size).max(1.0))
}

/// Sum over the inputs of `|p dP/dp| / |P|` at a limit point, at least one. There the matrix of the equations is singular, and its null
/// vector, the tangent of the path, weighs the changes of the equations against that of the pressure.
pub(crate) fn condition_of_limit(tube: &Tube, rule: &Rule, state: [f64; 3], tangent: [f64; 3], pressure: f64) -> f64 {
    let rows = by_inputs(tube, rule, state);
    let moved = |k: usize| (0..3).map(|i| rows[i][k] * tangent[i]).sum::<f64>() / tangent[1];
    let sum: f64 = (0..INPUTS).filter(|&k| k != PRESSURE).map(|k| moved(k).abs()).sum();
    (sum / pressure.abs()).max(1.0)
}
