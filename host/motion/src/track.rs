//! Setpoints and states over the time of a run, straight between knots.

use fra_model::{State, StateQuantity};

use super::plan::{PlannedPhase, phase_at};
use super::setpoint::state_at;
use super::unreachable::Unreachable;
use super::wire::from_wire;
use softlimb_limb::Limb;

/// Rows of setpoints at equal times, a column a drive or a channel, with the model's states.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    /// Time between two knots, us.
    pub(super) period_us: u64,
    pub(super) kinds: Vec<StateQuantity>,
    /// Setpoints as the device gets them, in wire units.
    pub(super) knots: Vec<Vec<i32>>,
    /// The model's states at the knots.
    pub(super) states: Vec<Vec<State<f64>>>,
}

impl Track {
    /// Time of the last knot, us after the start.
    pub(super) fn duration_us(&self) -> u64 {
        (self.knots.len().saturating_sub(1)) as u64 * self.period_us
    }

    /// Setpoints at a time, interpolated between knots as the device does.
    pub(super) fn values_at(&self, time_us: f64) -> Vec<f64> {
        let (before, after, share) = self.between(time_us);
        let columns = self.kinds.iter().zip(&self.knots[before]).zip(&self.knots[after]);
        columns
            .map(|((kind, a), b)| {
                let (a, b) = (from_wire(*kind, *a), from_wire(*kind, *b));
                a + (b - a) * share
            })
            .collect()
    }

    /// States at a time.
    pub(super) fn states_at(&self, time_us: f64) -> Vec<State<f64>> {
        let (before, after, share) = self.between(time_us);
        self.states[before]
            .iter()
            .zip(&self.states[after])
            .map(|(a, b)| State::combine([a, b], |[a, b]| a + (b - a) * share))
            .collect()
    }

    /// The knots around a time, and its share of the way from the first to the second.
    pub(super) fn between(&self, time_us: f64) -> (usize, usize, f64) {
        let last = self.knots.len() - 1;
        let position = (time_us / self.period_us as f64).clamp(0.0, last as f64);
        let before = position as usize;
        (before, (before + 1).min(last), position - before as f64)
    }
}

/// Index of the module of each drive.
pub(super) fn owners(limb: &Limb) -> Vec<usize> {
    limb.drives().map(|drive| drive.index).collect()
}

/// The model's states at all knots, of columns that belong to modules: the check that a move stays within reach also between its ends.
///
/// # Errors
/// [`Unreachable::OnTheWay`].
pub(super) fn states(
    limb: &Limb,
    phases: &[PlannedPhase],
    owners: &[usize],
    knots: &[Vec<i32>],
    period_us: u64,
) -> Result<Vec<Vec<State<f64>>>, Unreachable> {
    let mut here: Vec<State<f64>> = owners.iter().map(|owner| limb.modules()[*owner].actuator.rest()).collect();
    let mut last: Option<&Vec<i32>> = None;
    let mut all = Vec::with_capacity(knots.len());
    for (index, knot) in knots.iter().enumerate() {
        for (column, (owner, wire)) in owners.iter().zip(knot).enumerate() {
            // While an actuator rests its state does, too.
            if last.is_some_and(|last| last[column] == *wire) {
                continue;
            }
            let equal_neighbour = column > 0 && owners[column - 1] == *owner && knot[column - 1] == *wire;
            here[column] = if equal_neighbour {
                here[column - 1]
            } else {
                let module = &limb.modules()[*owner];
                state_at(module, &here[column], from_wire(module.kind, *wire)).map_err(|cause| {
                    let phase = phase_at(phases, index as u64 * period_us);
                    Unreachable::OnTheWay { phase, module: *owner, cause }
                })?
            };
        }
        last = Some(knot);
        all.push(here.clone());
    }
    Ok(all)
}
