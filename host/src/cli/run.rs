//! `softlimb run`: check, plan, stream to the simulated MCU, record, report.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Failure, Outcome};
use softlimb_rig::report;
use softlimb_rig::report::{Miss, Summary};
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, Progress, RunError, RunOptions};
use softlimb_scene as scene;

/// Run a scene: check, plan, stream to the simulated MCU, record, report
#[derive(Args)]
#[command(after_help = "Writes run.mcap and run.html; those of an earlier run in the same folder are replaced.\n\
                  Example: softlimb run scenes/pick-and-place-a.toml")]
pub(super) struct Run {
    /// The scene file
    scene: PathBuf,
    /// Folder for run.mcap and run.html [default: out/<scene>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of everything random in the plant [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    /// What runs the controller
    #[arg(long, value_enum, default_value_t = Device::Simulated)]
    mcu: Device,
    /// The image for an emulated device [default: where `cargo xtask firmware` puts it]
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// What runs the controller.
#[derive(Clone, Copy, ValueEnum)]
enum Device {
    /// This computer
    Simulated,
    /// The twin of the flashed image in qemu-system-arm, in lock-step
    Cosim,
    /// The flashed image in qemu-system-arm, through its serial port
    Qemu,
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
        let options = RunOptions {
            seed: self.seed.unwrap_or(scene.seed()),
            out: self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(scene.name())),
            mcu: self.mcu(),
        };
        let bar = Bar::new();
        let cancel = AtomicBool::new(false);
        let outcome = run::run(&scene, &options, &cancel, |progress| bar.show(progress));
        bar.finish();
        let (files, stopped) = match outcome {
            Ok(files) => (files, None),
            Err(RunError::Stopped { cause, files }) => (*files, Some(cause)),
            Err(error) => return Err(error.into()),
        };
        let summary = report::summary(&files.run);
        let warnings = [warnings(&summary), scene.winding_warnings()].concat();
        if self.json {
            let mut json = serde_json::json!(summary);
            json["warnings"] = warnings.clone().into();
            super::say(&json.to_string())?;
        } else {
            super::say(&summary.table())?;
        }
        super::note(&format!("log:    {}\nreport: {}", files.log.display(), files.report.display()));
        let outcome = super::warn(&warnings);
        stopped.map_or(Ok(outcome), |cause| Err(Failure::new(cause)))
    }
}

/// What the device complained about, and where the run did not arrive.
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

/// Progress on a terminal; nothing elsewhere.
struct Bar(Option<ProgressBar>);

impl Bar {
    fn new() -> Self {
        if !stderr().is_terminal() {
            return Self(None);
        }
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3} %  {elapsed_precise}");
        let bar = ProgressBar::new(1000).with_message("running");
        Self(Some(match style {
            Ok(style) => bar.with_style(style.progress_chars("=> ")),
            Err(_) => bar,
        }))
    }

    fn show(&self, progress: Progress) {
        if let Some(bar) = &self.0 {
            bar.set_position((1e3 * progress.time_s / progress.duration_s.max(1e-9)) as u64);
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
