//! A whole run of a scene: plan, device, recording, report.

mod assemble;
mod bodied;
mod disturbed;
mod error;
mod feedback;
mod grasp;
mod hanging;
mod jogged;
mod listening;
mod observed;
mod observer;
mod paced;
mod prepared;
mod recording;
mod reference;
mod solid;
mod tape;
mod timed_fault;
mod tip_estimate;
mod track;
mod tube_law;
mod unobserved;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

use softlimb_sim::emulated::{Flashed, LockStep};
use softlimb_sim::{Processor, SimulatedMcu, here};

use crate::link::port;
use crate::link::port::{Port, PortAddress};
use crate::link::{LinkFaults, SampleRequest};
use crate::record;
use crate::record::{Pose, RunLog};
use crate::report;
use crate::simulate;
use softlimb_files::write_whole;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_scene::Scene;

use assemble::run_info;
use disturbed::disturbed;
pub use error::RunError;
pub use jogged::{JogDevice, JogOptions, JogView, Operator, Press, SeenFault, attempts, jog, jog_behind, jog_folder};
pub use listening::{Heard, record_behind};
use observed::Observed;
pub(crate) use prepared::Prepared;
use prepared::{Origin, SESSION};
pub use prepared::{samples, summaries};
use recording::{Session, recorded};
pub use solid::at_rest;
pub use timed_fault::{TimedFault, TimedFaultError};
use unobserved::Unobserved;

/// Settings of a run, and its destination.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Seed of everything random in the plant.
    pub seed: u64,
    /// The folder that takes `run.mcap` and `run.html`.
    pub out: PathBuf,
    /// Processor of the controller.
    pub mcu: Mcu,
    /// Faults of the link, drawn by the seed.
    pub link_faults: Option<LinkFaults>,
    /// Faults that the run meets on purpose.
    pub faults: Vec<TimedFault>,
}

/// Processor of the controller.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Mcu {
    /// This computer, in the same process.
    #[default]
    Here,
    /// The twin image in an emulator, in lock-step: the bits of [`Mcu::Here`], from the processor of the device.
    LockStep(PathBuf),
    /// The image that is flashed, in an emulator, through its serial port.
    Flashed(PathBuf),
}

impl Mcu {
    fn start(&self) -> Result<Box<dyn Processor>, RunError> {
        Ok(match self {
            Self::Here => Box::new(here()),
            Self::LockStep(image) => Box::new(LockStep::start(image)?),
            Self::Flashed(image) => Box::new(Flashed::start(image, None)?),
        })
    }
}

/// Progress of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Time since the start of the trajectory, s.
    pub time_s: f64,
    /// Its duration, s.
    pub duration_s: f64,
}

/// Files of a run.
#[derive(Clone, Debug)]
pub struct RunFiles {
    /// The log.
    pub log: PathBuf,
    /// The report.
    pub report: PathBuf,
    /// The run, as read back from the log.
    pub run: RunLog,
}

/// Runs a scene on the simulated MCU, records it and writes the report. `cancel` vents the limb and ends the run.
///
/// # Errors
/// [`RunError`]. When the run began but did not end well, log and report are there and [`RunError::Stopped`] names them.
pub fn run(
    scene: &Scene,
    options: &RunOptions,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let limb = Limb::new(scene)?;
    let plan = motion::plan(scene, &limb)?;
    run_planned(scene, (limb, plan), options, cancel, on_progress)
}

/// [`run`] with the limb of the scene and its plan.
///
/// # Errors
/// As [`run`].
pub fn run_planned(
    scene: &Scene,
    (limb, plan): (Limb, Plan),
    options: &RunOptions,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let prepared = Prepared::planned(scene, limb, plan)?;
    simulated(&prepared, (scene, prepared.limb()), options, cancel, on_progress)
}

/// [`run_planned`] with the simulated limb and pneumatics of another scene, about whose parameters those of the plant are drawn: a scene that has been
/// calibrated to a limb runs on that limb.
///
/// # Errors
/// As [`run`], and [`RunError::OtherLimb`].
pub fn run_on(
    scene: &Scene,
    (planned, plan): (Limb, Plan),
    plant: &Scene,
    options: &RunOptions,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let prepared = Prepared::planned(scene, planned, plan)?;
    let limb = Limb::new(plant)?;
    same_drives(prepared.limb(), &limb)?;
    simulated(&prepared, (plant, &limb), options, cancel, on_progress)
}

/// The simulated device with the pneumatics and the limb of a scene, switched on.
///
/// # Errors
/// [`RunError::Simulation`], [`RunError::Emulator`].
pub fn simulated_device(
    (plant, limb): (&Scene, &Limb),
    seed: u64,
    mcu: &Mcu,
) -> Result<SimulatedMcu<Box<dyn Processor>>, RunError> {
    Ok(SimulatedMcu::with_processor(&simulate::settings(plant, limb, seed), mcu.start()?)?)
}

/// The limb of a scene as viewers load it: its description as URDF, and the frames that do not move, by their names in the log.
pub fn description(scene: &Scene, limb: &Limb) -> (String, Vec<(String, Pose)>) {
    let origin = Origin::Simulated { seed: scene.seed() };
    record::description(&run_info(scene, limb, Vec::new(), origin)).unwrap_or_default()
}

/// Streams what is prepared to the simulated limb and pneumatics of `plant`.
fn simulated(
    prepared: &Prepared<'_>,
    (plant, limb): (&Scene, &Limb),
    options: &RunOptions,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let device = simulated_device((plant, limb), options.seed, &options.mcu)?;
    let device = Observed::recording(device).with_faults(&options.faults, prepared.plan().duration_us())?;
    let mut link = disturbed(device, options.link_faults, options.seed);
    let origin = Origin::Simulated { seed: options.seed };
    let injected = options.faults.iter().map(TimedFault::injected).collect();
    let session = Session { number: SESSION, origin, injected, truth: plant.plant().truth.label(), out: &options.out };
    let assembler = prepared.assembler(plant, limb, (options.seed, options.seed));
    let ended = recorded(prepared, assembler, &mut link, &session, cancel, on_progress);
    link.port_mut().take_failure().map_or(ended, |failure| Err(failure.into()))
}

/// Runs a scene by its plan on the device behind a port, in real time, records it in `out` and writes the report. Nobody sees the limb itself: log and
/// report have what the device measures. With `samples` the device also sends samples: after a reset of the device, a log
/// with its converter codes can be run again bit for bit. Faults of the link are drawn by a seed of 0. `cancel` vents the limb and ends the run.
///
/// # Errors
/// As [`run`], and [`RunError::Sampling`]; a port that is unplugged stops the run.
pub fn run_behind(
    scene: &Scene,
    (limb, plan): (Limb, Plan),
    (port, samples): (&PortAddress, Option<SampleRequest>),
    link_faults: Option<LinkFaults>,
    out: &Path,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    if scene.camera().is_some_and(|camera| camera.feedback) {
        return Err(RunError::NoCamera);
    }
    if scene.imu().is_some_and(|imu| imu.feedback) {
        return Err(RunError::NoImus);
    }
    let mut prepared = Prepared::planned(scene, limb, plan)?;
    if let Some(request) = samples {
        let baud = if let PortAddress::Serial { baud, .. } = port { Some(*baud) } else { None };
        prepared = prepared.sampled(request, baud)?;
    }
    let mut link = disturbed(Unobserved::new(Port::open(port)?), link_faults, 0);
    let origin = Origin::Device { unix_ns: unix_ns() };
    let session = Session { number: port::session_number(), origin, injected: Vec::new(), truth: None, out };
    let assembler = prepared.assembler(scene, prepared.limb(), (0, 0));
    recorded(&prepared, assembler, &mut link, &session, cancel, on_progress)
}

/// Time since 1970-01-01 UTC, ns; 0 on a computer that believes to be before.
fn unix_ns() -> u64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}

/// Refuses a limb that does not take the setpoints of another.
fn same_drives(planned: &Limb, simulated: &Limb) -> Result<(), RunError> {
    let names = |limb: &Limb| limb.drives().map(|drive| (drive.name(), drive.kind, drive.channels)).collect::<Vec<_>>();
    if names(planned) == names(simulated) {
        return Ok(());
    }
    let list = |limb: &Limb| limb.drives().map(|drive| drive.name()).collect::<Vec<_>>().join(", ");
    Err(RunError::OtherLimb { planned: list(planned), simulated: list(simulated) })
}

/// Writes the report of a log; under its name there is the whole of it, or what was there before.
///
/// # Errors
/// [`RunError::File`].
pub fn write_report(path: &Path, log: &RunLog) -> Result<(), RunError> {
    Ok(write_whole(path, &report::html(log))?)
}

/// Writes the static report, without scripts.
///
/// # Errors
/// [`RunError::File`].
pub fn write_still_report(path: &Path, log: &RunLog) -> Result<(), RunError> {
    Ok(write_whole(path, &report::still_html(log))?)
}
