//! Feedback of the tip's position within a run, from a camera's images.
//!
//! An image says that the tip is off its plan by `e`, which is integrated: `du/dt = -gain J+ e`, with the derivatives `J` of the model at the
//! planned pose, as in learning. A notch at each of the two slowest predicted vibrations keeps the loop from exciting them.
//!
//! The setpoints are sent a short lead ahead ([`link::live`]), so that an image has an effect after its latency and that lead.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::Vector3;
use softlimb_protocol::{DeviceState, Outputs};

use crate::correction::{columns, groups, step};
use crate::link;
use crate::link::{DeviceConfiguration, Event, Knot, LinkError, Pilot, StreamOptions, Transport, Wish};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::{Plan, Sent};
use softlimb_scene::Scene;

/// Rate at which the error is taken away at most: of the inverse of the delay from an image to its effect, a quarter of what is stable, and of the
/// angular frequency of the slowest vibration.
const GAIN_OF_DELAY: f64 = 0.4;
const GAIN_OF_MODE: f64 = 0.3;
/// Damping ratio of a notch: frequencies 10 % off are attenuated to 15 %.
const NOTCH: f64 = 0.7;
/// Longest time between two images that is integrated over, s.
const LONGEST_S: f64 = 0.1;
/// Time between the poses whose derivatives are computed, us.
const POSE_US: u64 = 200_000;

/// The limb and its motion.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limb: &'a Limb,
    pub(super) plan: &'a Plan,
    pub(super) sent: &'a Sent,
}

/// A look of the camera: all that feedback knows of the limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// Time since the start of the plan, s.
    pub(super) time_s: f64,
    /// The tip, m; `None` where no image was due or the tip was not found in it.
    pub(super) tip_m: Option<[f64; 3]>,
}

/// Positions on their way, and those that have arrived: time, s, and tip, m.
#[derive(Default)]
struct Desk {
    on_the_way: VecDeque<(f64, Vector3<f64>)>,
    arrived: Vec<(f64, Vector3<f64>)>,
}

impl Desk {
    /// Takes a look; what is older than the latency arrives.
    fn take(&mut self, frame: Frame, latency_s: f64) {
        self.on_the_way.extend(frame.tip_m.map(|tip_m| (frame.time_s, tip_m.into())));
        let arrived = self.on_the_way.partition_point(|(time_s, _)| *time_s + latency_s <= frame.time_s);
        self.arrived.extend(self.on_the_way.drain(..arrived));
    }
}

/// Streams the setpoints of a task to a device, corrected by a camera's images, which arrive a latency late, s. `on_event` gives the look at a report.
///
/// # Errors
/// As [`link::live`]; [`LinkError::Stopped`] if the device held because setpoints came too late.
pub(super) fn follow<D: Transport>(
    device: &mut D,
    (configuration, options): (&DeviceConfiguration, &StreamOptions<'_>),
    task: Task<'_>,
    latency_s: f64,
    mut on_event: impl FnMut(&mut D, Event) -> Option<Frame>,
) -> Result<link::Summary, LinkError> {
    let desk = RefCell::new(Desk::default());
    let mut pilot = Feedback::new(task, latency_s + link::START_US as f64 * 1e-6, &desk);
    let ended = link::live(device, configuration, options, &mut pilot, |device, event| {
        // The plan begins when the first setpoints have been held.
        let event = match event {
            Event::Armed { start_us, end_us } => Event::Armed { start_us: start_us + link::START_US, end_us },
            other => other,
        };
        if let Some(frame) = on_event(device, event) {
            desk.borrow_mut().take(frame, latency_s);
        }
    });
    match ended {
        Ok(_) if pilot.has_held => Err(LinkError::Stopped { state: Some(DeviceState::Holding) }),
        other => other,
    }
}

/// Setpoints of a plan, corrected by images.
struct Feedback<'a> {
    task: Task<'a>,
    desk: &'a RefCell<Desk>,
    /// Drive and channels of all that is corrected alike.
    groups: Vec<(usize, Range<usize>)>,
    /// Correction of each group, in the unit of its setpoint.
    values: Vec<f64>,
    /// Angular frequencies of the two slowest vibrations in each phase, 1/s.
    modes: Vec<[f64; 2]>,
    notches: [Notch; 2],
    gain_per_s: f64,
    /// The latest pose: its number, and the motion of the tip with the whole range of each group, m.
    pose: Option<(u64, Vec<Vector3<f64>>)>,
    /// Time of the last image, s.
    last_s: f64,
    /// Time of the last knot since the start of the plan, us.
    knot_us: u64,
    has_held: bool,
}

impl<'a> Feedback<'a> {
    /// `delay_s` is the time from an image to its effect, s; > 0.
    fn new(task: Task<'a>, delay_s: f64, desk: &'a RefCell<Desk>) -> Self {
        let Task { scene, limb, plan, .. } = task;
        let groups = groups(limb, plan.weighed().is_some());
        // A limb that falls was refused before.
        let swings = motion::swings(scene, limb, plan).unwrap_or_default();
        let modes: Vec<[f64; 2]> = swings.iter().map(|swing| swing.moved.frequency_hz.map(|hz| TAU * hz)).collect();
        let slowest = modes.iter().map(|mode| mode[0]).fold(f64::INFINITY, f64::min);
        Self {
            task,
            desk,
            values: vec![0.0; groups.len()],
            groups,
            gain_per_s: (GAIN_OF_DELAY / delay_s).min(GAIN_OF_MODE * slowest),
            modes,
            notches: [Notch::default(); 2],
            pose: None,
            last_s: 0.0,
            knot_us: 0,
            has_held: false,
        }
    }

    /// Corrects the setpoints by the position of the tip, m, in the image of a time, s.
    fn see(&mut self, (time_s, tip_m): (f64, Vector3<f64>)) {
        let Task { scene, limb, plan, sent } = self.task;
        let time_us = 1e6 * time_s;
        let span_s = (time_s - self.last_s).clamp(0.0, LONGEST_S);
        self.last_s = time_s;
        let mut error = tip_m - Vector3::from(plan.tip_m(limb, time_us));
        let phase = plan.phases.iter().rposition(|phase| phase.start_us as f64 <= time_us);
        if let Some(mode) = phase.and_then(|phase| self.modes.get(phase)) {
            for (notch, mode) in self.notches.iter_mut().zip(mode) {
                error = notch.passed(error, *mode, span_s);
            }
        }
        let gain = self.gain_per_s * span_s;
        if gain <= 0.0 {
            return;
        }
        let number = time_us as u64 / POSE_US;
        if self.pose.as_ref().is_none_or(|(known, _)| *known != number) {
            let middle_us = (number * POSE_US + POSE_US / 2).min(plan.duration_us());
            let slopes = motion::planned_slopes(scene, limb, plan, middle_us as f64);
            self.pose = Some((number, columns(limb, &self.groups, &slopes)));
        }
        let Some((_, columns)) = &self.pose else { return };
        let setpoints = sent.values_at(time_us);
        let ranges: Vec<(f64, f64)> = self.groups.iter().map(|(drive, _)| limb.drive(*drive).range()).collect();
        let places = self.groups.iter().zip(&self.values).zip(&ranges);
        let left = places.map(|(((_, channels), value), (rest, last))| {
            let (low, high) = (rest.min(*last), rest.max(*last));
            let wanted = (setpoints[channels.start] + value).clamp(low, high);
            [low - wanted, high - wanted].map(|left| left / (gain * (high - low)))
        });
        let shares = step(columns, &left.collect::<Vec<_>>(), &error);
        for ((value, share), (rest, last)) in self.values.iter_mut().zip(&shares).zip(&ranges) {
            *value += gain * share * (last - rest).abs();
        }
    }

    /// Setpoints of a time of the plan, us, on the wire.
    fn wire(&self, time_us: u64) -> Vec<i32> {
        let mut added = vec![0.0; self.task.limb.channels()];
        for ((_, channels), value) in self.groups.iter().zip(&self.values) {
            added[channels.clone()].fill(*value);
        }
        self.task.sent.corrected_at(self.task.limb, time_us as f64, &added)
    }
}

impl Pilot for Feedback<'_> {
    fn look(&mut self, _now_us: u64) -> Wish {
        let arrived = std::mem::take(&mut self.desk.borrow_mut().arrived);
        arrived.into_iter().for_each(|image| self.see(image));
        // The last knot is a lead ahead of the device.
        let end_us = self.task.plan.duration_us() + link::START_US;
        if self.has_held || self.knot_us >= end_us { Wish::End } else { Wish::Nothing }
    }

    fn knot(&mut self, time_us: u64) -> Knot {
        self.knot_us = time_us.saturating_sub(link::START_US);
        let at_us = self.knot_us.min(self.task.plan.duration_us());
        let outputs = Outputs::default().with(Outputs::GRIPPER, self.task.plan.is_gripping_at(at_us));
        Knot { time_us, outputs, values: self.wire(at_us) }
    }

    fn sent(&mut self, _now_us: u64) {}

    fn stop(&mut self) {
        self.has_held = true;
    }

    fn vented(&mut self) {}
}

/// A notch filter: `(s2 + w2) / (s2 + 2 z w s + w2)`, by the trapezoidal rule.
#[derive(Clone, Copy, Debug, Default)]
struct Notch {
    /// Input of the latest step.
    input: Vector3<f64>,
    /// States: of a constant input the first is the input, and the second is zero, at any frequency.
    slow: Vector3<f64>,
    fast: Vector3<f64>,
}

impl Notch {
    /// The output for an input after a time, s, by an angular frequency, 1/s.
    fn passed(&mut self, input: Vector3<f64>, mode: f64, span_s: f64) -> Vector3<f64> {
        let mean = (self.input + input) * 0.5;
        // The frequency at which the rule has its zero.
        let half = (0.5 * mode * span_s).tan();
        let (mode, half_s) = if span_s > 0.0 && half > 0.0 { (2.0 * half / span_s, 0.5 * span_s) } else { (mode, 0.0) };
        let (damped, turned) = (2.0 * NOTCH * mode * half_s, (mode * half_s).powi(2));
        let fast =
            (self.fast * (1.0 - damped - turned) + (mean - self.slow) * (2.0 * half_s)) / (1.0 + damped + turned);
        self.slow += (self.fast + fast) * (mode * mode * half_s);
        self.fast = fast;
        self.input = input;
        input - fast * (2.0 * NOTCH * mode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of the output for an input of amplitude one, after a transient of 20 s.
    fn passes(mode: f64, frequency: f64) -> f64 {
        let mut notch = Notch::default();
        let span_s = TAU / frequency / 200.0;
        let transient = (20.0 / span_s) as usize;
        let times = (0..transient + 200).map(|index| index as f64 * span_s);
        let outputs = times.map(|time_s| notch.passed(Vector3::x() * (frequency * time_s).sin(), mode, span_s).x);
        outputs.skip(transient).fold(0.0, |largest: f64, output| largest.max(output.abs()))
    }

    #[test]
    fn notch_takes_its_frequency_and_leaves_slow_and_fast() {
        let mode = TAU * 0.8;
        assert!(passes(mode, mode) < 1e-6, "{}", passes(mode, mode));
        for frequency in [0.1, 0.9, 1.1, 30.0_f64] {
            // |H| of the filter in continuous time.
            let away = 1.0 - frequency * frequency;
            let expected = away.abs() / away.hypot(2.0 * NOTCH * frequency);
            let found = passes(mode, frequency * mode);
            assert!((found - expected).abs() < 0.01, "{frequency}: {found} of {expected}");
        }
    }

    #[test]
    fn constant_passes_a_notch_whose_frequency_changes() {
        let mut notch = Notch::default();
        let constant = Vector3::new(1.0, -2.0, 3.0);
        for _ in 0..2_000 {
            notch.passed(constant, 3.0, 0.02);
        }
        assert!((notch.passed(constant, 9.0, 0.02) - constant).norm() < 1e-9);
        assert!((notch.passed(constant, 9.0, 0.0) - constant).norm() < 1e-9, "two images of one time");
    }
}
