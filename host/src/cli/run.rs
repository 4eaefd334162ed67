//! `softlimb run`: check, plan, stream to a device, record, report.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, ValueEnum};

use super::interrupt::interrupt;
use super::port::PortOption;
use super::shared::{bar, limb, show};
use super::{Failure, Outcome, warn};
use crate::results::bend::rows;
use crate::results::{RunSummary, margin_warning};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::link::port::Address;
use softlimb_rig::link::{LinkFaults, SampleRequest};
use softlimb_rig::report;
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, Progress, RunError, RunFiles, RunOptions, TimedFault};
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Run a scene: check, plan, stream to a device, record, report
#[derive(Args)]
#[command(after_help = "Writes run.mcap and run.html; those of an earlier run in the same folder are replaced.\n\
                  Behind a port Ctrl-C vents the limb and ends the run; a second one ends the program at once.\n\n\
                  Examples:\n  softlimb run scenes/pick-and-place-a.toml\n  \
                  softlimb run scenes/single-bending.toml --port /dev/ttyACM0\n  \
                  softlimb run scenes/single-bending.toml --link-fault loss=0.05,flip=0.01,stall=0.001:600ms\n  \
                  softlimb run scenes/pick-and-place-a.toml --fault sensor-frozen@4.5,1\n  \
                  softlimb run calibrated.toml --plant scenes/pick-and-place-a.toml")]
pub(super) struct Run {
    /// The scene file
    scene: PathBuf,
    /// Folder for run.mcap and run.html [default: out/<scene>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of the plant [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    /// Scene of the simulated limb and pneumatics [default: the scene itself]
    #[arg(long, value_name = "SCENE")]
    plant: Option<PathBuf>,
    #[command(flatten)]
    controller: Controller,
    #[command(flatten)]
    port: PortOption,
    /// Faults of the link, as shares of the frames each way: loss, flip, burst, cut, duplicate, reorder, garbage, wrong-baud, stall
    #[arg(long, value_name = "NAME=SHARE,..")]
    link_fault: Option<LinkFaults>,
    /// Fault that the simulated limb, its device or the link meets on purpose, by time in seconds into the run; may be repeated
    #[arg(long, value_name = "NAME@TIME[,CHANNEL]")]
    fault: Vec<TimedFault>,
    /// Time between samples of pressures and valves that a device behind a port sends beside its telemetry, whole ms; topic /softlimb/samples of the log
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    sample_period: Option<u32>,
    /// Log the converter codes of every control tick of a device behind a port: `softlimb replay` compares the log of a device that was reset before
    #[arg(long, conflicts_with = "sample_period")]
    record_codes: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Processor of the controller beside a simulated limb.
#[derive(Args)]
pub(super) struct Controller {
    /// Device of the controller [default: simulated]
    #[arg(long, value_enum)]
    mcu: Option<Device>,
    /// The image for an emulated device [default: where `cargo xtask firmware` puts it]
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
}

/// Device of the controller.
#[derive(Clone, Copy, ValueEnum)]
enum Device {
    /// This computer
    Simulated,
    /// The twin of the flashed image in qemu-system-arm, in lock-step
    Cosim,
    /// The flashed image in qemu-system-arm, through its serial port
    Qemu,
}

impl Controller {
    pub(super) fn mcu(&self) -> Mcu {
        match self.mcu {
            None | Some(Device::Simulated) => Mcu::Here,
            Some(Device::Cosim) => Mcu::LockStep(self.image("softlimb-cosim.elf")),
            Some(Device::Qemu) => self.flashed(),
        }
    }

    fn flashed(&self) -> Mcu {
        Mcu::Flashed(self.image("softlimb-stm32f405.elf"))
    }

    fn image(&self, name: &str) -> PathBuf {
        self.image.clone().unwrap_or_else(|| Path::new("target/firmware").join(name))
    }
}

impl Run {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let address = self.port.address()?;
        self.refuse_contradictions(address.as_ref())?;
        let (scene, limb) = limb(&self.scene)?;
        let plan = motion::plan(&scene, &limb)?;
        let margins = margin_warning(&scene, &limb, &plan)?;
        let windings = limb.winding_warnings(&scene);
        let moved = [motion::payload_warnings(scene.phases()), motion::moved_warnings(&scene, &limb, &plan)].concat();
        let planned = (limb.clone(), plan);
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name()));
        let bar = bar(1000, "running");
        let on_progress = |progress: Progress| {
            bar.set_position((1e3 * progress.time_s / progress.duration_s.max(1e-9)) as u64);
        };
        let cancel = interrupt()?;
        let outcome = match address {
            Some(Address::Port(port)) => {
                run::run_behind(&scene, planned, (&port, self.samples()), self.link_fault, &out, &cancel, on_progress)
            }
            Some(Address::Emulated) => {
                self.simulate(&scene, planned, self.controller.flashed(), (out, &cancel), on_progress)?
            }
            Some(Address::Simulated) => self.simulate(&scene, planned, Mcu::Here, (out, &cancel), on_progress)?,
            None => self.simulate(&scene, planned, self.controller.mcu(), (out, &cancel), on_progress)?,
        };
        bar.finish_and_clear();
        let (files, stopped) = match outcome {
            Ok(files) => (files, None),
            Err(RunError::Stopped { cause, files }) => (*files, Some(cause)),
            Err(error) => return Err(error.into()),
        };
        let summary = report::summary(&files.run);
        let before: Vec<String> =
            cancel.load(Ordering::Relaxed).then(|| "the run was canceled".to_owned()).into_iter().collect();
        let after = [windings, moved, margins.into_iter().collect()].concat();
        let result = RunSummary::new(&summary, Some(&limb), before, after);
        show(self.json, &result, || summary.table())?;
        if !self.json {
            rows(&limb).iter().for_each(|row| super::note(row.trim_start()));
        }
        super::note(&format!("log:    {}\nreport: {}", files.log.display(), files.report.display()));
        let outcome = warn(&result.warnings);
        stopped.map_or(Ok(outcome), |cause| Err(Failure::new(cause)))
    }

    fn samples(&self) -> Option<SampleRequest> {
        let measurements = self.sample_period.map(|ms| SampleRequest::Measurements(1_000 * ms));
        if self.record_codes { Some(SampleRequest::Codes) } else { measurements }
    }

    /// Runs beside a simulated limb; the outer error is of the command line or a file.
    fn simulate(
        &self,
        scene: &Scene,
        planned: (Limb, Plan),
        mcu: Mcu,
        (out, cancel): (PathBuf, &AtomicBool),
        on_progress: impl FnMut(Progress),
    ) -> Result<Result<RunFiles, RunError>, Failure> {
        let plant = self.plant.as_ref().map(scene::load).transpose()?;
        let plant = plant.as_ref().unwrap_or(scene);
        let seed = self.seed.unwrap_or(plant.seed());
        let options = RunOptions { seed, out, mcu, link_faults: self.link_fault, faults: self.fault.clone() };
        Ok(run::run_on(scene, planned, plant, &options, cancel, on_progress))
    }

    /// An address says which processor; a device behind a port has a limb of its own.
    fn refuse_contradictions(&self, address: Option<&Address>) -> Result<(), Failure> {
        let samples = self.sample_period.map(|_| "--sample-period").or(self.record_codes.then_some("--record-codes"));
        if let (Some(option), false) = (samples, matches!(address, Some(Address::Port(_)))) {
            let line = format!("{option} is for a device behind --port: the log of a simulated device has every tick");
            return Err(Failure::wrong_line(line));
        }
        let Some(address) = address else { return Ok(()) };
        let given = [
            ("--mcu", self.controller.mcu.is_some(), true),
            ("--image", self.controller.image.is_some(), *address != Address::Emulated),
            ("--seed", self.seed.is_some(), matches!(address, Address::Port(_))),
            ("--fault", !self.fault.is_empty(), matches!(address, Address::Port(_))),
            ("--plant", self.plant.is_some(), matches!(address, Address::Port(_))),
        ];
        match given.into_iter().find(|(_, is_given, contradicts)| *is_given && *contradicts) {
            Some((option, ..)) => Err(Failure::wrong_line(format!("{option} cannot be used with --port {address}"))),
            None => Ok(()),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Scene(error) => error.into(),
            other => Self::new(other),
        }
    }
}
