//! Moves a limb by hand: takes orders and returns setpoints; the time is an argument.
//!
//! Every step is solved before anything moves: pressures and limit points, the scene's margin under load, reach, obstacles, the tilt of what is
//! held, and stability. A step that would violate one of them is refused with a [`Refusal`], and the limb stays. The path between two poses
//! is straight in the setpoints, at constant speed, and no faster than the scene's rates, its valves and its supply allow.
//!
//! Under load a step is solved by the rods of the scene's error, at the weight and the payload of the moment, as a plan does. The shift
//! of tubes between plates is left out: the operator sees the tip and corrects it.

mod leg;
mod mover;
mod order;
mod refusal;
mod targets;
mod task;

pub use order::{Order, SPEEDS, STEPS, Settings, Way, unit_of};
pub use refusal::Refusal;
pub use targets::{Attempt, JogTarget, Targets};
pub use task::TaskProgress;

use nalgebra::Vector3;

use crate::diagnostics::{jog_start, tier_at_rest};
use crate::payload::{Carried, Carrying};
use crate::plan::Plan;
use crate::wire::to_wire;
use leg::{Leg, Place};
use mover::Mover;
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Drive, Limb};
use softlimb_scene::{Gripper, Scene, SceneError};
use task::Task;

/// Duration of each part of a held move, s: the move is solved at most this far ahead.
const STRETCH_S: f64 = 0.1;
/// Setpoints within this share of their range are at rest.
const AT_REST: f64 = 1e-6;

/// Setpoints at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct JogKnot {
    /// Wire value of each channel.
    pub values: Vec<i32>,
    /// Setpoint of each drive.
    pub setpoints: Vec<f64>,
    /// Whether the gripper is commanded to close.
    pub gripping: bool,
    /// Mass that the model assumes at the tip, kg.
    pub payload_kg: f64,
    /// Position of the tip according to the model, m.
    pub tip_m: [f64; 3],
}

/// A limb moved by hand.
pub struct Jog<'a> {
    scene: &'a Scene,
    mover: Mover<'a>,
    targets: Targets<'a>,
    task: Option<Task<'a>>,
    settings: Settings,
    gripper_us: u64,
    here: Place,
    leg: Option<Leg>,
    /// Direction of the key that is held.
    held: Option<Way>,
    /// Direction of the step that is queued.
    next: Option<Way>,
    gripping: bool,
    opens: bool,
    time_us: u64,
    refusal: Option<Refusal>,
}

impl<'a> Jog<'a> {
    /// The limb of a scene at rest. A tip is at a target within a distance, m.
    ///
    /// # Errors
    /// A diagnostic of a limb that is too near an obstacle at rest, or does not stand there.
    pub fn new(scene: &'a Scene, limb: &'a Limb, within_m: f64) -> Result<Self, SceneError> {
        let tier = tier_at_rest(scene, limb)?;
        jog_start(scene, limb, tier)?;
        let mover = Mover::new(scene, limb, tier);
        let values = mover.at_rest();
        let tip_m = limb.tip(&limb.drives().map(|drive| drive.actuator.rest()).collect::<Vec<_>>());
        let here = mover.place(values.clone()).unwrap_or(Place { values, tip_m });
        Ok(Self {
            scene,
            mover,
            targets: Targets::new(scene, limb, within_m),
            task: None,
            settings: Settings::default(),
            gripper_us: (scene.gripper_time_s() * 1e6).round() as u64,
            here,
            leg: None,
            held: None,
            next: None,
            gripping: false,
            opens: false,
            time_us: 0,
            refusal: None,
        })
    }

    /// Takes an order at the time of the last knot. [`Jog::refusal`] says why it was refused, until the next order.
    pub fn order(&mut self, order: Order) {
        if order != Order::Stop {
            self.refusal = None;
        }
        let outcome = match order {
            Order::Go(_) | Order::Hold(_) | Order::Gripper if self.task.is_some() => Err(Refusal::TaskRuns),
            Order::Go(way) => self.step(way),
            Order::Hold(way) => self.hold(way),
            Order::Stop => {
                self.stop();
                Ok(())
            }
            Order::Gripper => self.grip(),
            other => {
                self.settings.take(other, self.mover.limb().drives().len());
                Ok(())
            }
        };
        self.refusal = outcome.err().or(self.refusal.take());
    }

    /// Leads the drives to setpoints, one a drive, along the straight line from where they are now. The move under way ends, also where the
    /// setpoints are refused; [`Jog::refusal`] says why they are.
    pub fn lead(&mut self, setpoints: &[f64]) {
        self.refusal = self.lead_to(setpoints).err();
    }

    /// Starts the plan of the scene at rest, or goes on with it where it is held. [`Order::Stop`] holds it. Behind its end the limb is moved by hand.
    pub fn play(&mut self, plan: &'a Plan) {
        self.refusal = None;
        if let Some(task) = &mut self.task {
            task.is_held = false;
        } else if self.is_at_rest() {
            self.task = Some(Task::new(self.scene, self.mover.limb(), plan));
        } else {
            self.refusal = Some(Refusal::NotAtRest);
        }
    }

    /// How far the task has come; `None` where the limb is moved by hand.
    pub fn task(&self) -> Option<TaskProgress> {
        self.task.as_ref().map(Task::progress)
    }

    /// Takes an observation of the tip, m, and of the command to the gripper, at a time, s.
    pub fn see(&mut self, time_s: f64, tip_m: [f64; 3], gripping: bool) {
        self.targets.see(time_s, tip_m, gripping);
    }

    /// Setpoints at a time, us. Times must not decrease.
    pub fn knot(&mut self, time_us: u64) -> JogKnot {
        if let Some(task) = &mut self.task {
            task.advance(time_us.saturating_sub(self.time_us));
            self.time_us = time_us;
            let knot = task.knot();
            if task.is_over() {
                self.end_task();
            }
            return knot;
        }
        while let Some(end_us) = self.leg.as_ref().map(Leg::end_us).filter(|end_us| *end_us <= time_us) {
            self.time_us = end_us;
            self.leg = None;
            if self.opens {
                (self.opens, self.gripping) = (false, false);
            }
            // Between two moves, so that no key waits for it.
            self.mover.judge(&self.here.values);
            let step = self.next.take();
            if let Some(way) = self.held.or(step)
                && let Err(refusal) = self.begin(way, self.held.is_some())
            {
                (self.held, self.refusal) = (None, Some(refusal));
            }
        }
        self.time_us = time_us;
        let setpoints = self.leg.as_ref().map_or_else(|| self.here.values.clone(), |leg| leg.at(time_us));
        let limb = self.mover.limb();
        let wire: Vec<i32> = limb.drives().zip(&setpoints).map(|(drive, value)| to_wire(drive.kind, *value)).collect();
        JogKnot {
            values: limb.channel_values(&wire),
            setpoints,
            gripping: self.gripping,
            payload_kg: self.leg.as_ref().map_or(self.mover.carrying().payload_kg, |leg| leg.payload_kg(time_us)),
            tip_m: self.leg.as_ref().map_or(self.here.tip_m, |leg| leg.tip_m(time_us)),
        }
    }

    /// Sets the limb to rest, vented. The gripper keeps what it holds.
    pub fn rest(&mut self) {
        self.end_task();
        (self.leg, self.held, self.next, self.opens) = (None, None, None, false);
        let values = self.mover.at_rest();
        if let Some(place) = self.mover.place(values.clone()) {
            self.here = place;
            return;
        }
        // Without pressure the limb does not carry its load.
        self.mover.drop();
        self.here = self.mover.place(values.clone()).unwrap_or(Place { values, ..self.here.clone() });
    }

    /// Whether setpoints change.
    pub fn is_moving(&self) -> bool {
        self.leg.is_some() || self.task.as_ref().is_some_and(|task| !task.is_held)
    }

    /// Whether the limb is at rest and carries nothing.
    fn is_at_rest(&self) -> bool {
        let is_there = |((drive, value), rest): ((Drive<'_>, &f64), f64)| {
            let (from, to) = drive.range();
            (value - rest).abs() <= AT_REST * (to - from).abs()
        };
        let limb = self.mover.limb();
        let mut drives = limb.drives().zip(&self.here.values).zip(self.mover.at_rest());
        self.leg.is_none() && !self.gripping && self.carrying() == Carrying::default() && drives.all(is_there)
    }

    /// The limb is moved by hand from where the task has brought it.
    fn end_task(&mut self) {
        let Some(task) = self.task.take() else { return };
        let JogKnot { setpoints, gripping, tip_m, .. } = task.knot();
        self.gripping = gripping;
        self.mover.hold(&setpoints, task.carrying());
        self.here = Place { values: setpoints, tip_m };
    }

    /// Why the last order was refused.
    pub fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// Settings of the keys.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Targets and attempts.
    pub fn targets(&self) -> &Targets<'a> {
        &self.targets
    }

    /// What the model assumes the tip carries.
    pub fn carrying(&self) -> Carrying {
        self.task.as_ref().map_or_else(|| self.mover.carrying(), Task::carrying)
    }

    /// Whether the gripper is commanded to close.
    pub fn is_gripping(&self) -> bool {
        self.task.as_ref().map_or(self.gripping, Task::is_gripping)
    }

    /// The statics of the limb under load; `None` without load.
    pub fn tier(&self) -> Option<Fidelity> {
        self.mover.tier()
    }

    /// Starts a step, or queues it behind the present one.
    fn step(&mut self, way: Way) -> Result<(), Refusal> {
        match &self.leg {
            Some(leg) if leg.whole => Err(Refusal::GripperMoves),
            Some(_) if self.held.is_some() || self.next.is_some() => Err(Refusal::Waits),
            Some(_) => {
                self.next = Some(way);
                Ok(())
            }
            None => self.begin(way, false),
        }
    }

    /// Starts a move to setpoints, in place of the present one.
    fn lead_to(&mut self, setpoints: &[f64]) -> Result<(), Refusal> {
        if self.task.is_some() {
            return Err(Refusal::TaskRuns);
        }
        if self.leg.as_ref().is_some_and(|leg| leg.whole) {
            return Err(Refusal::GripperMoves);
        }
        self.stop();
        let to = self.mover.to(&self.here, setpoints)?;
        if to.values == self.here.values {
            return Ok(());
        }
        let rows = vec![self.here.values.clone(), to.values.clone()];
        let seconds = self.mover.shortest_s(&rows)?;
        let payload_kg = self.mover.carrying().payload_kg;
        self.start(rows, seconds, to, [payload_kg; 2], false);
        Ok(())
    }

    /// A move that goes on.
    fn hold(&mut self, way: Way) -> Result<(), Refusal> {
        if self.leg.as_ref().is_some_and(|leg| leg.whole) {
            return Err(Refusal::GripperMoves);
        }
        if self.held == Some(way) {
            return Ok(());
        }
        self.stop();
        self.begin(way, true)?;
        self.held = Some(way);
        Ok(())
    }

    /// Stops at the last knot. A task is held.
    fn stop(&mut self) {
        (self.held, self.next) = (None, None);
        if let Some(task) = &mut self.task {
            task.is_held = true;
        }
        if let Some(leg) = self.leg.take_if(|leg| !leg.whole) {
            let values = leg.at(self.time_us);
            let tip_m = leg.tip_m(self.time_us);
            self.here = self.mover.place(values.clone()).unwrap_or(Place { values, tip_m });
        }
    }

    /// Starts a step or the next part of a held move.
    fn begin(&mut self, way: Way, goes_on: bool) -> Result<(), Refusal> {
        let amount = if goes_on { self.settings.speed() * STRETCH_S } else { self.settings.step() };
        let signed = if way.with { amount } else { -amount };
        let to = match self.settings.drive {
            None => {
                let mut way_m = Vector3::zeros();
                way_m[way.axis.min(2)] = 1e-3 * signed;
                self.mover.tip(&self.here, way_m)?
            }
            Some(index) => self.mover.drive(&self.here, index, signed)?,
        };
        let rows = vec![self.here.values.clone(), to.values.clone()];
        let seconds = self.mover.shortest_s(&rows)?.max(amount / self.settings.speed());
        let payload_kg = self.mover.carrying().payload_kg;
        self.start(rows, seconds, to, [payload_kg; 2], false);
        Ok(())
    }

    fn start(&mut self, rows: Vec<Vec<f64>>, seconds: f64, to: Place, payloads_kg: [f64; 2], whole: bool) {
        let tips_m = [self.here.tip_m, to.tip_m];
        let move_us = ((seconds * 1e6).ceil() as u64).max(1);
        self.leg = Some(Leg { rows, start_us: self.time_us, move_us, tips_m, payloads_kg, whole });
        self.here = to;
    }

    /// Closes or opens the gripper. When it closes at the next target, it takes that target's payload. Before it opens, the load is put down.
    fn grip(&mut self) -> Result<(), Refusal> {
        if self.leg.as_ref().is_some_and(|leg| leg.whole) {
            return Err(Refusal::GripperMoves);
        }
        self.stop();
        let closes = !self.gripping;
        let carrying = match self.targets.next() {
            Some(target) if closes && target.gripper == Some(Gripper::Close) && self.targets.is_there() => {
                let Carried { held, .. } = target.carried;
                held
            }
            _ => Carrying::default(),
        };
        let before_kg = self.mover.carrying().payload_kg;
        let (rows, to) = self.mover.carry(&self.here, carrying)?;
        let seconds = self.mover.shortest_s(&rows)?.max(self.gripper_us as f64 * 1e-6);
        if closes {
            self.gripping = true;
        } else {
            self.opens = true;
        }
        self.start(rows, seconds, to, [before_kg, carrying.payload_kg], true);
        Ok(())
    }
}
