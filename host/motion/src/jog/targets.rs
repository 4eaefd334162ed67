//! The targets of a scene, and how the operator met them.

use fra_model::State;
use nalgebra::Vector3;

use crate::goal::with_targets;
use crate::inverse_kinematics::TipGoal;
use crate::payload::{Carried, carried};
use softlimb_limb::Limb;
use softlimb_scene::{Goal, Gripper, Scene};

/// Time at a target after which it is met, where the gripper has no command, s.
const HELD_S: f64 = 0.5;

/// Where a phase of a scene brings the tip, and what the gripper does there.
#[derive(Clone, Debug)]
pub struct JogTarget<'a> {
    /// Name of the phase.
    pub name: &'a str,
    /// Goal of the tip.
    pub goal: TipGoal<'a>,
    /// Command to the gripper at the target.
    pub gripper: Option<Gripper>,
    /// What the tip carries at the target.
    pub carried: Carried,
}

/// How a target was met.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// Name of the phase.
    pub name: String,
    /// Time from the previous target, or from the start, until this one was met, s; `None` before.
    pub time_s: Option<f64>,
    /// Least distance of the tip from the target in that time, m; infinite before the first observation.
    pub least_m: f64,
    /// Time that the tip was there, s.
    pub held_s: f64,
}

/// The targets in order, and the attempts at them so far. The caller chooses the clock.
#[derive(Clone, Debug)]
pub struct Targets<'a> {
    list: Vec<JogTarget<'a>>,
    attempts: Vec<Attempt>,
    within_m: f64,
    began_s: Option<f64>,
    seen_s: f64,
    tip_m: Option<[f64; 3]>,
}

impl<'a> Targets<'a> {
    /// The targets of a scene's phases; the tip is at one within this distance, m.
    pub fn new(scene: &'a Scene, limb: &Limb, within_m: f64) -> Self {
        let mut values: Vec<f64> = limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect();
        let mut list = Vec::new();
        for (phase, carried) in scene.phases().iter().zip(carried(scene.phases())) {
            let goal = match &phase.goal {
                Goal::Tip(tip) => Some(TipGoal::Point(tip.value)),
                Goal::Inside(region) => Some(TipGoal::Inside(&scene.regions()[region.value].shape)),
                Goal::Targets(targets) => {
                    values = with_targets(limb, targets, &values);
                    tip_at(limb, &values).map(TipGoal::Point)
                }
                Goal::Series(_) => {
                    scene.markers().and_then(|rows| rows.value.last()).map(|row| TipGoal::Point(row.tip_m))
                }
            };
            let (name, gripper) = (phase.name.value.as_str(), phase.gripper);
            list.extend(goal.map(|goal| JogTarget { name, goal, gripper, carried }));
        }
        let attempt = |target: &JogTarget<'_>| Attempt {
            name: target.name.to_owned(),
            time_s: None,
            least_m: f64::INFINITY,
            held_s: 0.0,
        };
        let attempts = list.iter().map(attempt).collect();
        Self { list, attempts, within_m, began_s: None, seen_s: 0.0, tip_m: None }
    }

    /// The next target; `None` when all are met.
    pub fn next(&self) -> Option<&JogTarget<'a>> {
        self.list.get(self.met())
    }

    /// Targets that are met.
    pub fn met(&self) -> usize {
        self.attempts.iter().take_while(|attempt| attempt.time_s.is_some()).count()
    }

    /// The attempts, one a target.
    pub fn attempts(&self) -> &[Attempt] {
        &self.attempts
    }

    /// Vector from the tip's last observed position to the next target, m.
    pub fn missing_m(&self) -> Option<Vector3<f64>> {
        Some(self.next()?.goal.missing_m(&Vector3::from(self.tip_m?)))
    }

    /// Whether the tip's last observed position is at the next target.
    pub fn is_there(&self) -> bool {
        self.missing_m().is_some_and(|way| way.norm() <= self.within_m)
    }

    /// Takes an observation: the tip, m, and whether the gripper is commanded to close. Times must not decrease.
    pub fn see(&mut self, time_s: f64, tip_m: [f64; 3], gripping: bool) {
        let began_s = *self.began_s.get_or_insert(time_s);
        let since_s = if self.tip_m.is_some() { time_s - self.seen_s } else { 0.0 };
        self.seen_s = time_s;
        if tip_m.iter().all(|coordinate| coordinate.is_finite()) {
            self.tip_m = Some(tip_m);
        }
        let Some(distance_m) = self.missing_m().map(|way| way.norm()) else { return };
        let (met, there) = (self.met(), distance_m <= self.within_m);
        let wanted = self.list[met].gripper.map(|gripper| gripper == Gripper::Close);
        let attempt = &mut self.attempts[met];
        attempt.least_m = attempt.least_m.min(distance_m);
        attempt.held_s = if there { attempt.held_s + since_s } else { attempt.held_s };
        let done = match wanted {
            Some(closed) => there && gripping == closed,
            None => there && attempt.held_s >= HELD_S,
        };
        if done {
            attempt.time_s = Some(time_s - began_s);
            self.began_s = Some(time_s);
        }
    }
}

fn tip_at(limb: &Limb, values: &[f64]) -> Option<[f64; 3]> {
    let states: Option<Vec<State<f64>>> =
        limb.drives().zip(values).map(|(drive, value)| drive.state_at(*value)).collect();
    Some(limb.tip(&states?))
}
