//! A whole run of a scene: plan, device, recording, report.

mod assemble;
mod error;
mod hanging;
mod observed;
mod prepared;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use softlimb_sim::emulated::{Flashed, LockStep};
use softlimb_sim::{Processor, SimulatedMcu, here};

use crate::link::{Event, LinkStatistics};
use crate::record;
use crate::record::{LinkSummary, Recorder, RunInfo, RunLog};
use crate::report;
use crate::simulate;
use softlimb_files::write_whole;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_scene::Scene;

use assemble::{Assembler, Seen};
pub use error::RunError;
use observed::Observed;
pub(crate) use prepared::Prepared;
pub use prepared::samples;

/// Settings of a run, and its destination.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Seed of everything random in the plant.
    pub seed: u64,
    /// The folder that takes `run.mcap` and `run.html`.
    pub out: PathBuf,
    /// Processor of the controller.
    pub mcu: Mcu,
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
    recorded(&prepared, (scene, prepared.limb()), options, cancel, on_progress)
}

/// [`run`] with the simulated limb and pneumatics of another scene, about whose parameters those of the plant are drawn: a scene that has been
/// calibrated to a limb runs on that limb.
///
/// # Errors
/// As [`run`], and [`RunError::OtherLimb`].
pub fn run_on(
    scene: &Scene,
    plant: &Scene,
    options: &RunOptions,
    cancel: &AtomicBool,
    on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let planned = Limb::new(scene)?;
    let plan = motion::plan(scene, &planned)?;
    let prepared = Prepared::planned(scene, planned, plan)?;
    let limb = Limb::new(plant)?;
    same_drives(prepared.limb(), &limb)?;
    recorded(&prepared, (plant, &limb), options, cancel, on_progress)
}

/// Streams what is prepared to the simulated limb and pneumatics of `plant`.
fn recorded(
    prepared: &Prepared<'_>,
    (plant, limb): (&Scene, &Limb),
    options: &RunOptions,
    cancel: &AtomicBool,
    mut on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let settings = simulate::settings(plant, limb, options.seed);
    let mut device = Observed::new(SimulatedMcu::with_processor(&settings, options.mcu.start()?)?);
    fs::create_dir_all(&options.out).map_err(|error| RunError::folder(&options.out, error))?;
    let path = options.out.join("run.mcap");

    let began = Instant::now();
    let mut recording = Recording::new(prepared.info(options.seed), prepared.assembler(plant, limb), &path);
    let ended = prepared.stream(&mut device, cancel, |device, event| {
        if let Some(progress) = recording.take(device, event) {
            on_progress(progress);
        }
    });
    let link = assemble::link_summary(&recording.statistics, device.traffic());
    let logged = recording.finish(link, began.elapsed().as_secs_f64())?;
    if let Some(failure) = device.take_failure() {
        return Err(failure.into());
    }
    match (ended, logged) {
        (Ok(_), true) => finish_report(&path),
        (Ok(_), false) => Err(RunError::NotRecorded),
        (Err(cause), true) => {
            let files = finish_report(&path)?;
            Err(RunError::Stopped { cause: Box::new(cause), files: Box::new(files) })
        }
        (Err(cause), false) => Err(RunError::Link(Box::new(cause))),
    }
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

/// Reads the log back, so that the report shows what the log holds and nothing else.
fn finish_report(log: &Path) -> Result<RunFiles, RunError> {
    let run = record::read(log)?;
    let report = log.with_extension("html");
    write_report(&report, &run)?;
    Ok(RunFiles { log: log.to_owned(), report, run })
}

/// Writes the report of a log; under its name there is the whole of it, or what was there before.
///
/// # Errors
/// [`RunError::Report`].
pub fn write_report(path: &Path, log: &RunLog) -> Result<(), RunError> {
    Ok(write_whole(path, &report::html(log))?)
}

/// The recording of a run, from the moment its configuration is known.
struct Recording<'a> {
    info: RunInfo,
    path: &'a Path,
    assembler: Assembler<'a>,
    recorder: Option<Recorder>,
    failure: Option<RunError>,
    statistics: LinkStatistics,
}

impl<'a> Recording<'a> {
    fn new(info: RunInfo, assembler: Assembler<'a>, path: &'a Path) -> Self {
        Self { info, path, assembler, recorder: None, failure: None, statistics: LinkStatistics::default() }
    }

    /// Takes an event of the link. A log that cannot be written does not stop the limb; it is told at the end.
    fn take(&mut self, device: &mut Observed, event: Event) -> Option<Progress> {
        match self.note(device, event) {
            Ok(progress) => progress,
            Err(error) => {
                self.recorder = None;
                self.failure.get_or_insert(error);
                None
            }
        }
    }

    fn note(&mut self, device: &mut Observed, event: Event) -> Result<Option<Progress>, RunError> {
        match event {
            Event::Connected(device) => self.info.firmware_version = device.firmware.to_string(),
            Event::Configured { config_hash } if self.failure.is_none() => {
                self.info.config_hash = config_hash;
                self.recorder = Some(Recorder::create(self.path, &self.info)?);
            }
            Event::Closed(statistics) => self.statistics = statistics,
            Event::Armed { start_us, end_us } => self.assembler.start(start_us, end_us),
            Event::Telemetry { message, .. } => {
                let truth = device.truth_at(message.time_us);
                if let Some(Seen { sample, shape, faults }) = self.assembler.sample(&message, truth.as_ref()) {
                    let progress = self.assembler.progress(sample.time_s);
                    if let Some(recorder) = &mut self.recorder {
                        recorder.sample(&sample)?;
                        shape.map_or(Ok(()), |shape| recorder.shape(&shape))?;
                        faults.iter().try_for_each(|fault| recorder.fault(fault))?;
                    }
                    return Ok(Some(progress));
                }
            }
            Event::Fault { message, .. } => {
                let fault = self.assembler.fault(&message);
                if let Some(recorder) = &mut self.recorder {
                    recorder.fault(&fault)?;
                }
            }
            _ => {}
        }
        Ok(None)
    }

    /// Closes the log; `false` when there is none.
    fn finish(self, link: LinkSummary, wall_s: f64) -> Result<bool, RunError> {
        match (self.failure, self.recorder) {
            (Some(failure), _) => Err(failure),
            (None, Some(recorder)) => {
                recorder.finish(link, Some(wall_s))?;
                Ok(true)
            }
            (None, None) => Ok(false),
        }
    }
}
