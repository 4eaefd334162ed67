//! A limb that Python leads on the simulated device, step by step, in virtual time.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::thread::JoinHandle;
use std::time::Duration;

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use softlimb::motion::jog::Order;
use softlimb::results::{RunSummary, json, recorded_limb};
use softlimb::rig::record::{ChannelSample, ModuleSample, Pose, Posture};
use softlimb::rig::report;
use softlimb::rig::run::{JogDevice, JogOptions, JogView, Mcu, Operator, Press, RunError, RunFiles, jog};

use super::failed::{not_computed, run_error};
use super::scenes::Scene;

/// Distance at which the tip is at a target of the scene, m: that of `softlimb jog`.
const WITHIN_M: f64 = 0.01;
/// Time between two looks for a signal, such as that of Ctrl-C.
const SIGNAL: Duration = Duration::from_millis(100);
const OVER: &str = "the session is over";

type Flat<'py> = Bound<'py, PyArray1<f64>>;
/// Frames by name: position and quaternion.
pub(crate) type Frames = Vec<(String, [f64; 7])>;
/// What Python gets: time, state, whether the gripper is closed, whether setpoints change, reason of a refusal, faults, columns, frames and their time,
/// clearance.
type Observed<'py> = (f64, String, bool, bool, Option<String>, Vec<String>, Vec<Flat<'py>>, (f64, Frames), f64);

/// End of a step.
#[derive(Clone, Copy, Debug)]
enum Goal {
    /// A time of the session, s.
    Time(f64),
    /// The pressures are down.
    Rest,
    /// The limb is led again.
    Led,
}

/// One step.
#[derive(Debug)]
struct Step {
    presses: Vec<Press>,
    /// Command to the gripper; `None` leaves it.
    gripping: Option<bool>,
    goal: Goal,
}

/// The limb after a step.
#[derive(Debug)]
struct Seen {
    time_s: f64,
    state: String,
    gripping: bool,
    is_moving: bool,
    refusal: Option<String>,
    faults: Vec<String>,
    /// Setpoint, model and true value of each drive; pressure and its reference of each channel; tip of setpoints, of the model, true.
    columns: [Vec<f64>; 8],
    frames: (f64, Frames),
    clearance_m: f64,
}

/// Python's hand.
struct Hand {
    steps: Receiver<Step>,
    seen: Sender<Seen>,
    goal: Goal,
    /// Half of the time between two measurements, s.
    slack_s: f64,
    modules: Vec<String>,
}

impl Operator for Hand {
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press> {
        let Some(sample) = view.sample else { return Vec::new() };
        let rests = name(view) == "ready";
        let is_there = match self.goal {
            Goal::Time(until_s) => sample.time_s >= until_s - self.slack_s,
            Goal::Rest if view.is_vented && rests => {
                self.goal = Goal::Led;
                return vec![Press::Resume];
            }
            Goal::Rest => false,
            Goal::Led => !view.is_vented && !rests,
        };
        if !is_there {
            return Vec::new();
        }
        if self.seen.send(Seen::new(view, &self.modules)).is_err() {
            return vec![Press::End];
        }
        // A session that nobody holds any more ends.
        let Ok(Step { mut presses, gripping, goal }) = self.steps.recv() else { return vec![Press::End] };
        self.goal = goal;
        if gripping.is_some_and(|wanted| wanted != view.jog.is_gripping()) {
            presses.push(Press::Order(Order::Gripper));
        }
        presses
    }
}

/// Position and quaternion in a row.
pub(crate) fn flat(pose: Pose) -> [f64; 7] {
    let ([x, y, z], [i, j, k, w]) = (pose.position_m, pose.rotation);
    [x, y, z, i, j, k, w]
}

/// Name of the device's state.
fn name(view: &JogView<'_, '_>) -> String {
    view.state.map_or_else(String::new, |state| format!("{state:?}").to_lowercase())
}

impl Seen {
    fn new(view: &JogView<'_, '_>, modules: &[String]) -> Self {
        let sample = view.sample.expect("an operator looks here behind the first sample");
        let drives = |value: fn(&ModuleSample) -> f64| sample.modules.iter().map(value).collect();
        let channels = |value: fn(&ChannelSample) -> f64| sample.channels.iter().map(value).collect();
        let nowhere = [f64::NAN; 3];
        let posed = |posture: &Posture| {
            (posture.time_s, posture.frames(modules).map(|(name, pose)| (name, flat(pose))).collect())
        };
        Self {
            time_s: sample.time_s,
            state: name(view),
            gripping: view.jog.is_gripping(),
            is_moving: view.jog.is_moving(),
            refusal: view.jog.refusal().map(ToString::to_string),
            faults: view.faults.iter().map(|fault| fault.text.clone()).collect(),
            columns: [
                drives(|drive| drive.setpoint),
                drives(|drive| drive.modelled),
                drives(|drive| drive.achieved.unwrap_or(f64::NAN)),
                channels(|channel| channel.pressure_pa),
                channels(|channel| channel.reference_pa),
                sample.tip_setpoint_m.into(),
                sample.tip_modelled_m.into(),
                sample.tip_achieved_m.unwrap_or(nowhere).into(),
            ],
            frames: view.posture.map_or((f64::NAN, Vec::new()), posed),
            clearance_m: view
                .body
                .and_then(|body| body.nearest.as_ref())
                .map_or(f64::NAN, |(distance_m, _)| *distance_m),
        }
    }

    fn into_python(self, py: Python<'_>) -> Observed<'_> {
        let Self { time_s, state, gripping, is_moving, refusal, faults, columns, frames, clearance_m } = self;
        let columns = columns.into_iter().map(|column| column.into_pyarray(py)).collect();
        (time_s, state, gripping, is_moving, refusal, faults, columns, frames, clearance_m)
    }
}

/// The ends of a session that Python holds.
struct Held {
    steps: Sender<Step>,
    seen: Receiver<Seen>,
    device: JoinHandle<Result<RunFiles, RunError>>,
}

/// A limb under setpoints from Python.
#[pyclass(frozen, module = "softlimb._native")]
pub(crate) struct Session {
    held: Mutex<Option<Held>>,
}

#[pymethods]
impl Session {
    /// Connects, configures and arms the simulated device; the log goes to a folder.
    #[new]
    fn new(py: Python<'_>, scene: &Scene, out: PathBuf, seed: Option<u64>) -> Self {
        let plan = scene.scene.clone();
        let modules = scene.limb.modules().iter().map(|module| module.name.clone()).collect();
        let slack_s = 0.5e-6 * f64::from(plan.controller().telemetry_period_us);
        let (steps, to_device) = channel();
        let (to_python, seen) = channel();
        let mut hand = Hand { steps: to_device, seen: to_python, goal: Goal::Time(0.0), slack_s, modules };
        let device = py.detach(|| {
            thread::spawn(move || {
                let device = JogDevice { seed: seed.unwrap_or(plan.seed()), mcu: Mcu::Here, in_real_time: false };
                let options = JogOptions { out, within_m: WITHIN_M, link_faults: None, task: None };
                jog(&plan, &device, &options, &mut hand, &AtomicBool::new(false))
            })
        });
        Self { held: Mutex::new(Some(Held { steps, seen, device })) }
    }

    /// The limb at the start.
    fn begin<'py>(&self, py: Python<'py>) -> PyResult<Observed<'py>> {
        self.exchange(py, None)
    }

    /// Takes setpoints and a command to the gripper, and lets time pass until a time of the session, s.
    fn step<'py>(
        &self,
        py: Python<'py>,
        until_s: f64,
        setpoints: Option<Vec<f64>>,
        gripping: Option<bool>,
    ) -> PyResult<Observed<'py>> {
        let presses = setpoints.map(Press::Lead).into_iter().collect();
        self.exchange(py, Some(Step { presses, gripping, goal: Goal::Time(until_s) }))
    }

    /// Lets the pressures down, and begins anew from rest.
    fn vent<'py>(&self, py: Python<'py>) -> PyResult<Observed<'py>> {
        self.exchange(py, Some(Step { presses: vec![Press::Vent], gripping: None, goal: Goal::Rest }))
    }

    /// Lets the pressures down and ends the session: the summary as JSON, the log, the report.
    fn close(&self, py: Python<'_>) -> PyResult<(String, PathBuf, PathBuf)> {
        let ended = py.detach(|| self.lock().take().map(Held::end));
        let files = ended.ok_or_else(|| not_computed(py, OVER))?.map_err(|error| run_error(py, error))?;
        let (summary, limb) = (report::summary(&files.run), recorded_limb(&files.run));
        Ok((json(&RunSummary::new(&summary, limb.as_ref(), Vec::new(), Vec::new())), files.log, files.report))
    }
}

/// Why a step has no result.
enum NoStep {
    /// The session is over.
    Over,
    /// The device ended it.
    Device(RunError),
    /// A signal, such as that of Ctrl-C: the session is over.
    Signal(PyErr),
}

impl Session {
    fn lock(&self) -> MutexGuard<'_, Option<Held>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hands a step to the device; the limb after it.
    fn exchange<'py>(&self, py: Python<'py>, step: Option<Step>) -> PyResult<Observed<'py>> {
        let seen = py.detach(|| {
            // Without the interpreter's lock: who waits here keeps no other thread of Python from it.
            let mut held = self.lock();
            let ends = held.as_ref().ok_or(NoStep::Over)?;
            step.map_or(Ok(()), |step| ends.steps.send(step)).unwrap_or_default();
            loop {
                match ends.seen.recv_timeout(SIGNAL) {
                    Ok(seen) => return Ok(seen),
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(signal) = Python::attach(|py| py.check_signals()) {
                            *held = None;
                            return Err(NoStep::Signal(signal));
                        }
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        let ended = held.take().map(Held::end).and_then(Result::err);
                        return Err(ended.map_or(NoStep::Over, NoStep::Device));
                    }
                }
            }
        });
        let seen = seen.map_err(|error| match error {
            NoStep::Over => not_computed(py, OVER),
            NoStep::Device(error) => run_error(py, error),
            NoStep::Signal(signal) => signal,
        })?;
        Ok(seen.into_python(py))
    }
}

impl Held {
    /// Without a step to come, the device vents.
    fn end(self) -> Result<RunFiles, RunError> {
        let Self { steps, seen, device } = self;
        drop((steps, seen));
        device.join().expect("no panic on the simulated device")
    }
}
