//! `softlimb run`: check, plan, stream to the simulated MCU, record, report.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::shared::{bar, show};
use super::{Failure, Outcome, warn};
use softlimb_rig::report;
use softlimb_rig::report::{Miss, Summary};
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, RunError, RunOptions};
use softlimb_scene as scene;

/// Run a scene: check, plan, stream to the simulated MCU, record, report
#[derive(Args)]
#[command(after_help = "Writes run.mcap and run.html; those of an earlier run in the same folder are replaced.\n\n\
                  Examples:\n  softlimb run scenes/pick-and-place-a.toml\n  \
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
    /// Device of the controller
    #[arg(long, value_enum, default_value_t = Device::Simulated)]
    mcu: Device,
    /// The image for an emulated device [default: where `cargo xtask firmware` puts it]
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
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

/// The result of `--json`, of a run and of a report.
#[derive(Serialize)]
pub(super) struct Printed<'a> {
    #[serde(flatten)]
    pub(super) summary: &'a Summary,
    pub(super) warnings: &'a [String],
}

impl Run {
    fn mcu(&self) -> Mcu {
        let image = |name: &str| self.image.clone().unwrap_or_else(|| PathBuf::from("target/firmware").join(name));
        match self.mcu {
            Device::Simulated => Mcu::Here,
            Device::Cosim => Mcu::LockStep(image("softlimb-cosim.elf")),
            Device::Qemu => Mcu::Flashed(image("softlimb-stm32f405.elf")),
        }
    }

    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let plant = self.plant.as_ref().map(scene::load).transpose()?;
        let plant = plant.as_ref().unwrap_or(&scene);
        let options = RunOptions {
            seed: self.seed.unwrap_or(plant.seed()),
            out: self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name())),
            mcu: self.mcu(),
        };
        let bar = bar(1000, "running");
        let cancel = AtomicBool::new(false);
        let outcome = run::run_on(&scene, plant, &options, &cancel, |progress| {
            bar.set_position((1e3 * progress.time_s / progress.duration_s.max(1e-9)) as u64);
        });
        bar.finish_and_clear();
        let (files, stopped) = match outcome {
            Ok(files) => (files, None),
            Err(RunError::Stopped { cause, files }) => (*files, Some(cause)),
            Err(error) => return Err(error.into()),
        };
        let summary = report::summary(&files.run);
        let warnings = [warnings(&summary), scene.winding_warnings()].concat();
        show(self.json, &Printed { summary: &summary, warnings: &warnings }, || summary.table())?;
        super::note(&format!("log:    {}\nreport: {}", files.log.display(), files.report.display()));
        let outcome = warn(&warnings);
        stopped.map_or(Ok(outcome), |cause| Err(Failure::new(cause)))
    }
}

/// Faults of the device, and goals that the run missed.
pub(super) fn warnings(summary: &Summary) -> Vec<String> {
    let mut warnings = Vec::new();
    for fault in &summary.faults {
        warnings.push(format!("{:.3} s into the run: {}", fault.time_s, fault.text));
    }
    for miss in &summary.misses {
        let Miss { module, phase, share_of_travel } = miss;
        let percent = 100.0 * share_of_travel;
        warnings.push(format!("the pressures had not brought `{module}` to its setpoint at the end of `{phase}`: {percent:.0} % of its travel off"));
    }
    for channel in &summary.limited_channels {
        warnings.push(format!("the device limited the reference of channel {channel}"));
    }
    warnings
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Scene(error) => error.into(),
            other => Self::new(other),
        }
    }
}
