//! Straight actuators with blocked ends.

use fra_model::{Actuator, Status};

use super::answers::{FEW, Table};
use super::refused::Refusal;
use super::solve::code;

/// Force, torque, their derivatives by the pressure and by length and twist, lumen volume; one row a pressure.
pub(crate) fn solve(
    actuators: &[Actuator<f64>],
    pressures: &[f64],
    stretches: &[f64],
    twists: &[f64],
) -> Result<Table<1, 9>, Refusal> {
    Table::filled(pressures.len(), pressures.len(), FEW, |piece| {
        for row in 0..piece.rows() {
            let i = piece.from + row;
            let actuator = &actuators[i % actuators.len()];
            let blocked = actuator.blocked(pressures[i], stretches[i], twists[i]);
            let blocked = blocked.map_err(|error| Refusal::new(i, error))?;
            let [[a, b], [c, d]] = blocked.stiffness;
            let [by_force, by_torque] = blocked.by_pressure;
            let volume = blocked.state.volume_m3;
            let numbers = [blocked.force_n, blocked.torque_nm, by_force, by_torque, a, b, c, d, volume];
            let is_solved = blocked.status == Status::Solved;
            let numbers = if is_solved { numbers } else { [f64::NAN; 9] };
            piece.set(row, [code(blocked.status)], blocked.iterations, numbers);
        }
        Ok(())
    })
}
