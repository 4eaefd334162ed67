//! A limb moved by hand on a device, recorded like a run.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use softlimb_protocol::{DeviceState, Outputs};

use super::assemble::{Assembler, run_info};
use super::bodied::Laws;
use super::disturbed::disturbed;
use super::observed::Observed;
use super::observer::observing;
use super::paced::Paced;
use super::prepared::{Origin, SESSION, stream_options};
use super::recording::{Bench, recorded_by};
use super::timed_fault::TimedFault;
use super::track::{SharedTrack, Tracked};
use super::unobserved::Unobserved;
use super::{Mcu, RunError, RunFiles, simulated_device, unix_ns};
use crate::link;
use crate::link::port::{self, Port, PortAddress};
use crate::link::{DeviceConfiguration, DeviceFault, Event, Knot, LinkFaults, Pilot, Wish};
use crate::record::{Body, InjectedFault, Posture, RunLog, Sample, TargetRecord};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_motion::jog::{Attempt, Jog, Order, Targets};
use softlimb_scene::Scene;

/// A key.
#[derive(Clone, Debug, PartialEq)]
pub enum Press {
    /// An order to the limb.
    Order(Order),
    /// Lead the drives to setpoints, one a drive.
    Lead(Vec<f64>),
    /// Let the pressures down.
    Vent,
    /// Go on after that.
    Resume,
    /// Let the pressures down and end.
    End,
    /// Start the plan of [`JogOptions::task`] at rest, or go on with it. [`Order::Stop`] holds it.
    Task,
    /// Break a part of the simulated device now: the name of a fault and its channel, from 0, where it has one.
    Break(String, Option<usize>),
}

/// Moves the limb by keys.
pub trait Operator {
    /// The keys since the last look.
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press>;

    /// Called when the setpoint of the last keys is on the wire, with the longest time since they were pressed, us of the link's clock.
    fn sent(&mut self, _waited_us: u64) {}
}

/// What the operator sees.
#[derive(Clone, Copy)]
pub struct JogView<'v, 'a> {
    /// The limb.
    pub jog: &'v Jog<'a>,
    /// The latest measurements; `None` before the first.
    pub sample: Option<&'v Sample>,
    /// The limb as it was last seen, by the model on a device; `None` before the first look.
    pub body: Option<&'v Body>,
    /// Its frames then, as the log has them.
    pub posture: Option<&'v Posture>,
    /// State of the device.
    pub state: Option<DeviceState>,
    /// Faults so far.
    pub faults: &'v [SeenFault],
    /// Whether the limb is vented, and waits for [`Press::Resume`].
    pub is_vented: bool,
}

/// A fault as the operator sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeenFault {
    /// The fault in words.
    pub text: String,
    /// Channel that the device has named; `None` for the whole system, and for a part broken on purpose.
    pub channel: Option<u8>,
}

/// Settings of a session by hand.
#[derive(Clone, Debug)]
pub struct JogOptions {
    /// The folder that takes `run.mcap` and `run.html`.
    pub out: PathBuf,
    /// Largest distance at which the tip is at a target, m.
    pub within_m: f64,
    /// Faults of the link.
    pub link_faults: Option<LinkFaults>,
    /// The plan that [`Press::Task`] runs.
    pub task: Option<Arc<Plan>>,
}

/// The simulated device of a session by hand.
#[derive(Clone, Debug)]
pub struct JogDevice {
    /// Seed of everything random in the plant.
    pub seed: u64,
    /// Processor of the controller.
    pub mcu: Mcu,
    /// Whether it keeps the time of this computer's clock.
    pub in_real_time: bool,
}

/// Moves the limb of a scene by hand, on the simulated device. `cancel` vents the limb and ends the session.
///
/// # Errors
/// As [`run`](super::run()).
pub fn jog(
    scene: &Scene,
    device: &JogDevice,
    options: &JogOptions,
    operator: &mut dyn Operator,
    cancel: &AtomicBool,
) -> Result<RunFiles, RunError> {
    let limb = Limb::new(scene)?;
    let simulated = Observed::recording(simulated_device((scene, &limb), device.seed, &device.mcu)?);
    let origin = Origin::Simulated { seed: device.seed };
    let mut link = disturbed(simulated, options.link_faults, device.seed);
    let (ended, failure) = if device.in_real_time {
        let mut paced = Paced::new(link);
        let ended = by_hand((scene, &limb), &mut paced, (SESSION, origin), options, operator, (cancel, true));
        (ended, paced.device_mut().port_mut().take_failure())
    } else {
        let ended = by_hand((scene, &limb), &mut link, (SESSION, origin), options, operator, (cancel, false));
        (ended, link.port_mut().take_failure())
    };
    failure.map_or(ended, |failure| Err(failure.into()))
}

/// [`jog`] on the device behind a port, in real time.
///
/// # Errors
/// As [`run_behind`](super::run_behind).
pub fn jog_behind(
    scene: &Scene,
    address: &PortAddress,
    options: &JogOptions,
    operator: &mut dyn Operator,
    cancel: &AtomicBool,
) -> Result<RunFiles, RunError> {
    let limb = Limb::new(scene)?;
    let mut link = disturbed(Unobserved::new(Port::open(address)?), options.link_faults, 0);
    let origin = Origin::Device { unix_ns: unix_ns() };
    by_hand((scene, &limb), &mut link, (port::session_number(), origin), options, operator, (cancel, true))
}

/// How the targets of a scene were met in a log, by the true tip, or by the model's tip on a device.
pub fn attempts(scene: &Scene, log: &RunLog, within_m: f64) -> Result<Vec<Attempt>, RunError> {
    let mut targets = Targets::new(scene, &Limb::new(scene)?, within_m);
    log.samples.iter().for_each(|sample| see(sample, |time_s, tip_m, gripping| targets.see(time_s, tip_m, gripping)));
    Ok(targets.attempts().to_vec())
}

fn see(sample: &Sample, mut take: impl FnMut(f64, [f64; 3], bool)) {
    let gripping = sample.outputs.bits & Outputs::GRIPPER.bits() != 0;
    take(sample.time_s, sample.tip_achieved_m.unwrap_or(sample.tip_modelled_m), gripping);
}

fn by_hand<D: Bench>(
    (scene, limb): (&Scene, &Limb),
    device: &mut D,
    (number, origin): (u16, Origin),
    options: &JogOptions,
    operator: &mut dyn Operator,
    (cancel, is_in_real_time): (&AtomicBool, bool),
) -> Result<RunFiles, RunError> {
    let jog = Jog::new(scene, limb, options.within_m)?;
    let configuration: DeviceConfiguration = crate::configuration(scene, &motion::inverses(scene, limb)?, limb);
    let (track, tier) = (SharedTrack::default(), jog.tier());
    let reference = Tracked::new(scene, limb, tier, track.clone());
    let assembler =
        Assembler::new((scene, limb), reference, tier, (scene, limb), (origin.seed().unwrap_or(0), Laws::default()));
    let desk = RefCell::new(Desk::default());
    let task = options.task.as_deref();
    let mut hand = Hand {
        jog,
        operator,
        task,
        track,
        desk: &desk,
        is_vented: false,
        goes_on: false,
        looked_us: 0,
        pressed_us: None,
    };
    let info = run_info(scene, limb, Vec::new(), origin);
    let period_us = u64::from(scene.controller().telemetry_period_us);
    recorded_by(device, (info, assembler, period_us), &options.out, |device, recording| {
        let settings = stream_options(&configuration, limb, number, cancel);
        let ended = observing(recording, is_in_real_time, |observer| {
            link::live(device, &configuration, &settings, &mut hand, |device, event| {
                let mut desk = desk.borrow_mut();
                for (name, channel) in std::mem::take(&mut desk.breaks) {
                    let fault = TimedFault::now(&name, channel).map_err(|error| error.to_string());
                    let broken = fault.and_then(|fault| device.break_now(fault.clone()).map(|()| fault.injected()));
                    let text = match &broken {
                        Ok(fault) => on_purpose(fault),
                        Err(reason) => format!("{name} is refused: {reason}"),
                    };
                    desk.faults.push(SeenFault { text, channel: None });
                    broken.into_iter().for_each(|fault| observer.on_purpose(fault));
                }
                match &event {
                    Event::State(state) => desk.state = Some(*state),
                    Event::Fault { message, .. } => {
                        let fault = DeviceFault::from(message);
                        desk.faults.push(SeenFault { text: fault.to_string(), channel: fault.channel });
                    }
                    _ => {}
                }
                observer.take(device, event);
                let look = observer.look();
                desk.sample = look.sample.or(desk.sample.take());
                desk.body = look.body.or(desk.body.take());
                desk.posture = look.posture.or(desk.posture.take());
            })
        });
        recording.targets = hand.jog.targets().attempts().iter().map(target).collect();
        ended
    })
}

/// A fault on purpose in words.
fn on_purpose(fault: &InjectedFault) -> String {
    let text = format!("{}, on purpose", fault.name);
    fault.channel.map_or(text.clone(), |channel| format!("{text}, on channel {channel}"))
}

fn target(attempt: &Attempt) -> TargetRecord {
    TargetRecord {
        name: attempt.name.clone(),
        time_s: attempt.time_s,
        least_m: Some(attempt.least_m).filter(|least_m| least_m.is_finite()),
        held_s: attempt.held_s,
    }
}

/// What the device told.
#[derive(Default)]
struct Desk {
    sample: Option<Sample>,
    body: Option<Body>,
    posture: Option<Posture>,
    state: Option<DeviceState>,
    faults: Vec<SeenFault>,
    /// Faults to inject at the next event.
    breaks: Vec<(String, Option<usize>)>,
}

/// The operator's orders as setpoints.
struct Hand<'a, 'h> {
    jog: Jog<'a>,
    operator: &'h mut dyn Operator,
    task: Option<&'a Plan>,
    track: SharedTrack,
    desk: &'h RefCell<Desk>,
    is_vented: bool,
    /// Whether the operator wishes to go on once the pressures are down.
    goes_on: bool,
    looked_us: u64,
    /// Time of the look before the last keys, us.
    pressed_us: Option<u64>,
}

impl Pilot for Hand<'_, '_> {
    fn look(&mut self, now_us: u64) -> Wish {
        let before_us = std::mem::replace(&mut self.looked_us, now_us);
        let desk = self.desk.borrow();
        desk.sample
            .iter()
            .for_each(|sample| see(sample, |time_s, tip_m, gripping| self.jog.see(time_s, tip_m, gripping)));
        let view = JogView {
            jog: &self.jog,
            sample: desk.sample.as_ref(),
            body: desk.body.as_ref(),
            posture: desk.posture.as_ref(),
            state: desk.state,
            faults: &desk.faults,
            is_vented: self.is_vented,
        };
        let mut wish = Wish::Nothing;
        let presses = self.operator.presses(&view);
        let is_ready = desk.state == Some(DeviceState::Ready);
        drop(desk);
        for press in presses {
            match press {
                Press::End => return Wish::End,
                Press::Vent => {
                    self.goes_on = false;
                    return Wish::Vent;
                }
                Press::Resume => self.goes_on = self.is_vented,
                Press::Order(order) if !self.is_vented => {
                    self.jog.order(order);
                    self.pressed_us = Some(before_us);
                    wish = Wish::Move;
                }
                Press::Lead(setpoints) if !self.is_vented => {
                    self.jog.lead(&setpoints);
                    self.pressed_us = Some(before_us);
                    wish = Wish::Move;
                }
                Press::Task if !self.is_vented => {
                    if let Some(plan) = self.task {
                        self.jog.play(plan);
                    }
                    wish = Wish::Move;
                }
                Press::Break(name, channel) => self.desk.borrow_mut().breaks.push((name, channel)),
                Press::Order(_) | Press::Lead(_) | Press::Task => {}
            }
        }
        // The pressures have to be down first.
        if self.goes_on && is_ready {
            (self.goes_on, self.is_vented) = (false, false);
            wish = Wish::Move;
        }
        wish
    }

    fn knot(&mut self, time_us: u64) -> Knot {
        let knot = self.jog.knot(time_us);
        let outputs = Outputs::default().with(Outputs::GRIPPER, knot.gripping);
        let values = knot.values.clone();
        self.track.lock().push(time_us, knot);
        Knot { time_us, outputs, values }
    }

    fn sent(&mut self, now_us: u64) {
        if let Some(pressed_us) = self.pressed_us.take() {
            self.operator.sent(now_us.saturating_sub(pressed_us));
        }
    }

    fn stop(&mut self) {
        self.jog.order(Order::Stop);
    }

    fn vented(&mut self) {
        (self.is_vented, self.goes_on) = (true, false);
        self.jog.rest();
    }
}

/// The default folder of a scene's session by hand.
pub fn jog_folder(scene: &Scene) -> PathBuf {
    Path::new("out").join(format!("{}-jog", scene.name()))
}
