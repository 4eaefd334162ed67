//! What the tip carries when: the payloads of the phases and the gripper.

use super::plan::{PlannedPhase, phase_at};
use softlimb_scene::{Gripper, Phase};

/// Masses that the tip carries in a phase, kg: during its move and during its hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Until the end of the move: without what the gripper takes up there, with what it puts down there.
    pub move_kg: f64,
    /// From then on.
    pub hold_kg: f64,
}

/// What the tip carries in each phase. A phase has its `payload` throughout; where the gripper closes at the end of the move it is taken up
/// then, and the move still has what the phase before ended with; where it opens it is put down then.
pub fn carried(phases: &[Phase]) -> Vec<Carried> {
    let mut before_kg = 0.0;
    let of_phase = |phase: &Phase| {
        let own_kg = phase.payload_kg;
        let carried = match phase.gripper {
            Some(Gripper::Close) => Carried { move_kg: before_kg, hold_kg: own_kg },
            Some(Gripper::Open) => Carried { move_kg: own_kg, hold_kg: 0.0 },
            None => Carried { move_kg: own_kg, hold_kg: own_kg },
        };
        before_kg = carried.hold_kg;
        carried
    };
    phases.iter().map(of_phase).collect()
}

/// What the tip carries at a time of the run, kg; behind its end what it ended with.
pub fn payload_kg(carried: &[Carried], phases: &[PlannedPhase], time_us: u64) -> f64 {
    let index = phase_at(phases, time_us);
    let (Some(phase), Some(carried)) = (phases.get(index), carried.get(index)) else { return 0.0 };
    if time_us < phase.start_us + phase.move_us { carried.move_kg } else { carried.hold_kg }
}
