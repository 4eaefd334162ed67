//! The plan of the scene within a session by hand: the operator starts, holds and continues it.

use super::JogKnot;
use crate::payload::{Carried, Carrying, carried, payload_kg};
use crate::plan::{Plan, PlannedPhase, phase_at};
use crate::wire::to_wire;
use softlimb_limb::Limb;
use softlimb_scene::Scene;

/// A plan and how far it has come.
pub(super) struct Task<'a> {
    limb: &'a Limb,
    plan: &'a Plan,
    carried: Vec<Carried>,
    /// Time of the plan, us.
    time_us: u64,
    pub(super) is_held: bool,
}

/// How far the task has come.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskProgress {
    /// Time of the plan, s.
    pub time_s: f64,
    /// Duration of the plan, s.
    pub duration_s: f64,
    /// Name of the phase.
    pub phase: String,
    /// Whether it waits for [`Jog::play`](super::Jog::play).
    pub is_held: bool,
}

impl<'a> Task<'a> {
    pub(super) fn new(scene: &Scene, limb: &'a Limb, plan: &'a Plan) -> Self {
        Self { limb, plan, carried: carried(scene.phases()), time_us: 0, is_held: false }
    }

    /// Advances by a time, us, unless it is held.
    pub(super) fn advance(&mut self, by_us: u64) {
        if !self.is_held {
            self.time_us = (self.time_us + by_us).min(self.plan.duration_us());
        }
    }

    pub(super) fn is_over(&self) -> bool {
        self.time_us == self.plan.duration_us()
    }

    pub(super) fn knot(&self) -> JogKnot {
        let setpoints = self.plan.values_at(self.time_us as f64);
        let drives = self.limb.drives().zip(&setpoints);
        let wire: Vec<i32> = drives.map(|(drive, value)| to_wire(drive.kind, *value)).collect();
        JogKnot {
            values: self.limb.channel_values(&wire),
            setpoints,
            gripping: self.is_gripping(),
            payload_kg: payload_kg(&self.carried, &self.plan.phases, self.time_us),
            tip_m: self.plan.tip_m(self.limb, self.time_us as f64),
        }
    }

    /// Whether the gripper is commanded to close.
    pub(super) fn is_gripping(&self) -> bool {
        self.plan.is_gripping_at(self.time_us)
    }

    /// Load at the tip, from the start of the hold in which the gripper takes it.
    pub(super) fn carrying(&self) -> Carrying {
        let index = phase_at(&self.plan.phases, self.time_us);
        let hands_over = |phase: &PlannedPhase| phase.held_share(self.time_us) > 0.0;
        let Some(carried) = self.carried.get(index) else { return Carrying::default() };
        if self.plan.phases.get(index).is_some_and(hands_over) { carried.held } else { carried.moved }
    }

    pub(super) fn progress(&self) -> TaskProgress {
        let phase = self.plan.phases.get(phase_at(&self.plan.phases, self.time_us));
        TaskProgress {
            time_s: self.time_us as f64 * 1e-6,
            duration_s: self.plan.duration_us() as f64 * 1e-6,
            phase: phase.map_or_else(String::new, |phase| phase.name.clone()),
            is_held: self.is_held,
        }
    }
}
