//! What the tip carries when: the payloads of the phases and the gripper.

use super::plan::{PlannedPhase, phase_at};
use softlimb_scene::{Gripper, Phase};

/// What hangs from the tip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carrying {
    /// Mass, kg.
    pub payload_kg: f64,
    /// The object that it is: its index in [`Scene::objects`](softlimb_scene::Scene::objects).
    pub object: Option<usize>,
}

/// What the tip carries in a phase: during its move and at the end of its hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Until the end of the move: without what the gripper takes up there, with what it puts down there.
    pub moved: Carrying,
    /// At the end of the hold. The mass changes hands during the hold: before, what the object stands on carries the rest.
    pub held: Carrying,
}

impl Carried {
    /// The larger of both masses, kg.
    pub fn payload_kg(&self) -> f64 {
        self.moved.payload_kg.max(self.held.payload_kg)
    }

    /// The object that hangs from the tip throughout the hold; none while one changes hands.
    pub fn held_object(&self) -> Option<usize> {
        self.held.object.filter(|_| self.held == self.moved)
    }

    /// Mass at the tip at a share of the way from the end of the move to that of the hold, kg.
    pub fn handed_kg(&self, share: f64) -> f64 {
        self.moved.payload_kg + share * (self.held.payload_kg - self.moved.payload_kg)
    }
}

/// What the tip carries in each phase. A phase has its `payload` throughout; where the gripper closes at the end of the move it is taken up
/// then, and the move still has what the phase before ended with; where it opens it is put down then.
pub fn carried(phases: &[Phase]) -> Vec<Carried> {
    let mut before = Carrying::default();
    let of_phase = |phase: &Phase| {
        let own = Carrying { payload_kg: phase.payload_kg, object: phase.object };
        let carried = match phase.gripper {
            Some(Gripper::Close) => Carried { moved: before, held: own },
            Some(Gripper::Open) => Carried { moved: own, held: Carrying::default() },
            None => Carried { moved: own, held: own },
        };
        before = carried.held;
        carried
    };
    phases.iter().map(of_phase).collect()
}

/// Warnings for phases whose initial payload differs from the final payload of the previous phase. Without a gripper command the setpoints jump.
pub fn payload_warnings(phases: &[Phase]) -> Vec<String> {
    let carried = carried(phases);
    let followed = phases.iter().zip(&carried).zip(phases.iter().zip(&carried).skip(1));
    let changed = followed.filter(|((_, before), (_, after))| before.held.payload_kg != after.moved.payload_kg);
    let worded = changed.map(|((phase, before), (next, after))| {
        format!(
            "`{}` ends with {:.2} kg at the tip and `{}` begins with {:.2} kg: without a `gripper` command the setpoints jump",
            *phase.name, before.held.payload_kg, *next.name, after.moved.payload_kg
        )
    });
    worded.collect()
}

/// Mass at the tip at a time of the run, kg; behind its end what it ended with.
pub fn payload_kg(carried: &[Carried], phases: &[PlannedPhase], time_us: u64) -> f64 {
    let index = phase_at(phases, time_us);
    let (Some(phase), Some(carried)) = (phases.get(index), carried.get(index)) else { return 0.0 };
    carried.handed_kg(phase.held_share(time_us))
}
