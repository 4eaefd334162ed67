//! The setpoints of a run as its log needs them.

use softlimb_limb::Limb;
use softlimb_motion::{Carried, Plan, carried, payload_kg};
use softlimb_scene::Scene;

/// Setpoints over the time of a run, us.
pub(super) trait Reference {
    /// One a drive, as the device interpolates between knots.
    fn values_at(&self, time_us: u64) -> Vec<f64>;

    /// Mass at the tip, kg.
    fn payload_kg(&self, time_us: u64) -> f64;

    /// Where the setpoints bring the tip, m.
    fn tip_m(&self, time_us: u64) -> [f64; 3];

    /// Where they bring the centre line, m.
    fn line_m(&self, time_us: u64) -> Vec<[f64; 3]>;

    /// How long the setpoints last, us; `None` where that is not known in advance.
    fn duration_us(&self) -> Option<u64> {
        None
    }

    /// The object that hangs from the tip, as the plan keeps it clear of obstacles: its index in the scene.
    fn object_at(&self, _time_us: u64) -> Option<usize> {
        None
    }

    /// The object in the gripper, also while it changes hands and something else bears a part of it: its index in the scene.
    fn gripped_at(&self, _time_us: u64) -> Option<usize> {
        None
    }
}

/// A plan of a scene's limb.
pub(super) struct Planned<'a> {
    limb: &'a Limb,
    plan: &'a Plan,
    carried: Vec<Carried>,
}

impl<'a> Planned<'a> {
    pub(super) fn new(scene: &Scene, limb: &'a Limb, plan: &'a Plan) -> Self {
        Self { limb, plan, carried: carried(scene.phases()) }
    }

    /// Whether the limb holds, and what the tip carries in the phase of a time, us.
    fn at(&self, time_us: u64) -> Option<(bool, &Carried)> {
        let index = self.plan.phases.iter().rposition(|phase| phase.start_us <= time_us)?;
        let phase = &self.plan.phases[index];
        Some((time_us > phase.start_us + phase.move_us, self.carried.get(index)?))
    }
}

impl Reference for Planned<'_> {
    fn values_at(&self, time_us: u64) -> Vec<f64> {
        self.plan.values_at(time_us as f64)
    }

    fn payload_kg(&self, time_us: u64) -> f64 {
        payload_kg(&self.carried, &self.plan.phases, time_us)
    }

    fn tip_m(&self, time_us: u64) -> [f64; 3] {
        self.plan.tip_m(self.limb, time_us as f64)
    }

    fn line_m(&self, time_us: u64) -> Vec<[f64; 3]> {
        self.plan.line_m(self.limb, time_us as f64)
    }

    fn duration_us(&self) -> Option<u64> {
        Some(self.plan.duration_us())
    }

    fn object_at(&self, time_us: u64) -> Option<usize> {
        let (holds, carried) = self.at(time_us)?;
        if holds { carried.held_object() } else { carried.moved.object }
    }

    fn gripped_at(&self, time_us: u64) -> Option<usize> {
        let (holds, carried) = self.at(time_us)?;
        let held = carried.held.object.filter(|_| holds);
        carried.moved.object.or(held)
    }
}
