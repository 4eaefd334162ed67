//! Feedback of the tip's position within a run, from a camera's images or from the orientations of IMUs.
//!
//! A measurement says that the tip is off its plan by `e`, which is integrated: `du/dt = -gain J+ e`, with the derivatives `J` of the model at the
//! planned pose, as in learning; with IMUs they are those of the estimate. A notch at each of the two slowest predicted vibrations keeps the loop
//! from exciting them.
//!
//! The setpoints are sent a short lead ahead ([`link::live`]), so that a measurement has an effect after its latency and that lead.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use nalgebra::{UnitQuaternion, Vector3};
use softlimb_protocol::{DeviceState, Outputs};

use super::tip_estimate::TipEstimate;
use crate::correction::{Columns, columns, groups};
use crate::imu::Reading;
use crate::link;
use crate::link::{DeviceConfiguration, Event, Knot, LinkError, Pilot, StreamOptions, Transport, Wish};
use crate::record::Observer;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::{Plan, Sent, Vibrations};
use softlimb_scene::{Scene, SceneError};

/// Bounds of the rate at which the error is taken away: of the inverse of the delay from a measurement to its effect, a quarter of what is stable, and of the
/// angular frequency of the slowest vibration.
const GAIN_OF_DELAY: f64 = 0.4;
const GAIN_OF_MODE: f64 = 0.3;
/// Damping ratio of a notch: frequencies 10 % off are attenuated to 15 %.
const NOTCH: f64 = 0.7;
/// Longest time between two measurements that is integrated over, s.
const LONGEST_S: f64 = 0.1;
/// Time between the poses whose derivatives are computed, us.
const POSE_US: u64 = 200_000;

/// What feedback knows in advance.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    observer: Observer,
    /// Time from a measurement to its arrival, s.
    latency_s: f64,
    /// Angular frequencies of the two slowest vibrations at the end of each move, 1/s; none where they are not predicted.
    modes: Vec<[f64; 2]>,
    /// The slowest of all, also at the ends of holds, 1/s; infinity without any.
    slowest: f64,
}

impl Settings {
    /// The settings of a scene with feedback; `None` without.
    ///
    /// # Errors
    /// A diagnostic at the phase in which the limb falls.
    pub(super) fn of(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Option<Self>, SceneError> {
        let camera = scene.camera().filter(|camera| camera.feedback);
        let imus = scene.imu().filter(|imu| imu.feedback);
        let Some((observer, latency_s)) = camera
            .map(|camera| (Observer::Camera, camera.latency_s))
            .or(imus.map(|imus| (Observer::Imus, imus.latency_s)))
        else {
            return Ok(None);
        };
        let angular = |vibrations: &Vibrations| vibrations.frequency_hz.map(|hz| TAU * hz);
        let swings = motion::swings(scene, limb, plan)?;
        let all = swings.iter().flat_map(|swing| std::iter::once(&swing.moved).chain(&swing.held));
        let slowest = all.map(|vibrations| angular(vibrations)[0]).fold(f64::INFINITY, f64::min);
        let modes = swings.iter().map(|swing| angular(&swing.moved)).collect();
        Ok(Some(Self { observer, latency_s, modes, slowest }))
    }

    pub(super) fn observer(&self) -> Observer {
        self.observer
    }

    /// Rate at which the error is taken away, 1/s.
    fn gain_per_s(&self) -> f64 {
        let delay_s = self.latency_s + link::START_US as f64 * 1e-6;
        (GAIN_OF_DELAY / delay_s).min(GAIN_OF_MODE * self.slowest)
    }
}

/// The limb and its motion.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limb: &'a Limb,
    pub(super) plan: &'a Plan,
    pub(super) sent: &'a Sent,
    pub(super) settings: &'a Settings,
}

/// Measurements of camera and IMUs at a report of the device: all that feedback knows of the limb.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    /// Time since the start of the plan, s.
    pub(super) time_s: f64,
    /// The tip, m; `None` where no image was due or the tip was not found in it.
    pub(super) tip_m: Option<[f64; 3]>,
    /// Readings of the IMUs, `None` where one is lost; none where they were not due.
    pub(super) readings: Vec<Option<Reading>>,
}

/// Measurements on their way, and those that have arrived.
#[derive(Default)]
struct Arrivals {
    on_the_way: VecDeque<Frame>,
    arrived: Vec<Frame>,
}

impl Arrivals {
    /// Takes the measurements at a report; those of the latency's age arrive.
    fn take(&mut self, frame: Frame, latency_s: f64) {
        let now_s = frame.time_s;
        self.on_the_way.push_back(frame);
        // A microsecond is the resolution of the device's clock.
        let is_due = |frame: &Frame| now_s - frame.time_s >= latency_s - 0.5e-6;
        let due = self.on_the_way.partition_point(is_due);
        self.arrived.extend(self.on_the_way.drain(..due));
    }
}

/// Streams the setpoints of a task to a device, corrected by measurements. `on_event` gives those at a report.
///
/// # Errors
/// As [`link::live`]; [`LinkError::Stopped`] if the device held because setpoints came too late.
pub(super) fn follow<D: Transport>(
    device: &mut D,
    (configuration, options): (&DeviceConfiguration, &StreamOptions<'_>),
    task: Task<'_>,
    mut on_event: impl FnMut(&mut D, Event) -> Option<Frame>,
) -> Result<link::Summary, LinkError> {
    let arrivals = RefCell::new(Arrivals::default());
    let mut pilot = Feedback::new(task, &arrivals);
    let ended = link::live(device, configuration, options, &mut pilot, |device, event| {
        // The plan begins when the first setpoints have been held.
        let event = match event {
            Event::Armed { start_us, end_us } => Event::Armed { start_us: start_us + link::START_US, end_us },
            other => other,
        };
        if let Some(frame) = on_event(device, event) {
            arrivals.borrow_mut().take(frame, task.settings.latency_s);
        }
    });
    match ended {
        Ok(_) if pilot.has_held => Err(LinkError::Stopped { state: Some(DeviceState::Holding) }),
        other => other,
    }
}

/// Setpoints of a plan, corrected by measurements.
struct Feedback<'a> {
    task: Task<'a>,
    arrivals: &'a RefCell<Arrivals>,
    /// Drive and channels of all that is corrected alike.
    groups: Vec<(usize, Range<usize>)>,
    /// Correction of each group, in the unit of its setpoint.
    values: Vec<f64>,
    notches: [Notch; 2],
    /// The tip by the IMUs, where they correct.
    estimate: Option<TipEstimate<'a>>,
    /// The latest pose: its number, and the motion of the tip with the whole range of each group, m.
    pose: Option<(u64, Vec<Vector3<f64>>)>,
    /// Time of the last measurement, s.
    last_s: f64,
    /// Time of the last knot since the start of the plan, us.
    knot_us: u64,
    has_held: bool,
}

impl<'a> Feedback<'a> {
    fn new(task: Task<'a>, arrivals: &'a RefCell<Arrivals>) -> Self {
        let groups = groups(task.limb, task.plan.weighed().is_some());
        Self {
            task,
            arrivals,
            values: vec![0.0; groups.len()],
            groups,
            notches: [Notch::default(); 2],
            estimate: (task.settings.observer == Observer::Imus)
                .then(|| TipEstimate::new(task.scene, task.limb, task.plan)),
            pose: None,
            last_s: 0.0,
            knot_us: 0,
            has_held: false,
        }
    }

    /// The tip by measurements, m; `None` where they do not give it.
    fn tip_m(&mut self, frame: &Frame) -> Option<Vector3<f64>> {
        let Some(estimate) = &mut self.estimate else { return frame.tip_m.map(Into::into) };
        let of_reading = |reading: &Option<Reading>| reading.map(|reading| reading.orientation);
        let orientations = frame.readings.iter().map(of_reading).collect::<Option<Vec<UnitQuaternion<f64>>>>()?;
        if orientations.is_empty() { None } else { estimate.tip_m(1e6 * frame.time_s, &orientations) }
    }

    /// Corrects the setpoints by measurements.
    fn see(&mut self, frame: &Frame) {
        let Some(tip_m) = self.tip_m(frame) else { return };
        let Task { scene, limb, plan, sent, settings } = self.task;
        let time_s = frame.time_s;
        let time_us = 1e6 * time_s;
        let span_s = (time_s - self.last_s).max(0.0);
        self.last_s = time_s;
        let mut error = tip_m - Vector3::from(plan.tip_m(limb, time_us));
        let phase = plan.phases.iter().rposition(|phase| phase.start_us as f64 <= time_us);
        if let Some(modes) = phase.and_then(|phase| settings.modes.get(phase)) {
            for (notch, mode) in self.notches.iter_mut().zip(modes) {
                error = notch.passed(error, *mode, span_s);
            }
        }
        let gain = settings.gain_per_s() * span_s.min(LONGEST_S);
        if gain <= 0.0 {
            return;
        }
        let number = time_us as u64 / POSE_US;
        if self.pose.as_ref().is_none_or(|(known, _)| *known != number) {
            let middle_us = (number * POSE_US + POSE_US / 2).min(plan.duration_us());
            let slopes = match &mut self.estimate {
                Some(estimate) => estimate.slopes(&self.groups, middle_us as f64),
                None => motion::planned_slopes(scene, limb, plan, middle_us as f64),
            };
            self.pose = Some((number, columns(limb, &self.groups, &slopes)));
        }
        let Some((_, columns)) = &self.pose else { return };
        let setpoints = sent.values_at(time_us);
        let setpoints: Vec<f64> = self.groups.iter().map(|(_, channels)| setpoints[channels.start]).collect();
        let columns = Columns { limb, groups: &self.groups, columns };
        let changes = columns.changes(&setpoints, &self.values, &error, gain);
        // A correction that goes beyond a range is sent up to its end, and kept for when the plan leaves it.
        self.values.iter_mut().zip(changes).for_each(|(value, change)| *value += change);
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
        let arrived = std::mem::take(&mut self.arrivals.borrow_mut().arrived);
        arrived.iter().for_each(|frame| self.see(frame));
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
        // The frequency at which the trapezoidal rule has its zero. Measurements too few for the frequency pass as they are.
        let half = 0.5 * mode * span_s;
        if half >= FRAC_PI_2 {
            *self = Self { input, slow: input, fast: Vector3::zeros() };
            return input;
        }
        let (mode, half_s) = if half > 0.0 { (2.0 * half.tan() / span_s, 0.5 * span_s) } else { (mode, 0.0) };
        let mean = (self.input + input) * 0.5;
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
        assert!((notch.passed(constant, 9.0, 0.0) - constant).norm() < 1e-9, "two measurements of one time");
    }

    #[test]
    fn measurements_arrive_a_latency_late_in_order() {
        let mut arrivals = Arrivals::default();
        for index in 0..10 {
            let time_s = 0.02 * f64::from(index);
            arrivals.take(Frame { time_s, tip_m: Some([f64::from(index); 3]), readings: Vec::new() }, 0.06);
            let arrived: Vec<f64> = arrivals.arrived.drain(..).map(|frame| frame.tip_m.unwrap()[0]).collect();
            let expected = (index >= 3).then(|| f64::from(index - 3));
            assert_eq!(arrived, Vec::from_iter(expected), "{index}");
        }
    }

    #[test]
    fn lost_reading_leaves_no_estimate() {
        let path = format!("{}/../../scenes/single-bending.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap() + "[imu]\nfeedback = true\n";
        let scene = softlimb_scene::parse(&text, "scene.toml").unwrap();
        let limb = Limb::new(&scene).unwrap();
        let plan = motion::plan(&scene, &limb).unwrap();
        let (sent, settings) = (Sent::uncorrected(&limb, &plan), Settings::of(&scene, &limb, &plan).unwrap().unwrap());
        let task = Task { scene: &scene, limb: &limb, plan: &plan, sent: &sent, settings: &settings };
        let arrivals = RefCell::default();
        let mut feedback = Feedback::new(task, &arrivals);
        let reading = Reading { orientation: limb.base().rotation, rate_rad_per_s: Vector3::zeros() };
        let mut has_tip = |readings: &[Option<Reading>]| {
            // The tip of a camera is there, too, and is not taken.
            feedback.tip_m(&Frame { time_s: 0.5, tip_m: Some([0.0; 3]), readings: readings.to_vec() }).is_some()
        };
        assert!(has_tip(&[Some(reading)]));
        assert!(!has_tip(&[None]) && !has_tip(&[]));
    }

    /// Largest error in the last of 60 s of a limb of one lightly damped vibration of 1 Hz that follows its setpoint after the delay, by images every
    /// 20 ms, from an error of one.
    fn left(notched: bool) -> f64 {
        let (mode, damping, span_s) = (TAU, 0.025, 1e-3);
        let settings = Settings { observer: Observer::Camera, latency_s: 0.03, modes: Vec::new(), slowest: mode };
        let (mut notch, mut setpoint, mut place, mut speed, mut most) = (Notch::default(), 0.0, 0.0, 0.0, 0.0_f64);
        let mut sent = VecDeque::from(vec![0.0; 170]);
        for index in 0..60_000 {
            let error = 1.0 + place;
            if index % 20 == 0 {
                let seen = if notched { notch.passed(Vector3::x() * error, mode, 0.02).x } else { error };
                setpoint -= settings.gain_per_s() * 0.02 * seen;
            }
            sent.push_back(setpoint);
            let target = sent.pop_front().unwrap();
            speed += span_s * (mode * mode * (target - place) - 2.0 * damping * mode * speed);
            place += span_s * speed;
            most = if index >= 59_000 { most.max(error.abs()) } else { 0.0 };
        }
        most
    }

    #[test]
    fn notch_keeps_the_loop_from_shaking_a_limb_that_swings() {
        assert!(left(true) < 1e-3, "{}", left(true));
        assert!(left(false) > 1.0, "{}", left(false));
    }
}
