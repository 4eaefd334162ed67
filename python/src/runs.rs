//! Runs on the simulated device.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use softlimb::motion;
use softlimb::results::{RunSummary, json, margin_warning};
use softlimb::rig::report;
use softlimb::rig::run::{Mcu, Progress, RunOptions, run_on};

use super::failed::run_error;
use super::scenes::Scene;

/// Samples between two looks for a signal, such as that of Ctrl-C.
const SAMPLES: u32 = 100;

/// Settings of a simulated run.
pub(crate) struct Simulation<'a> {
    /// Folder for log and report.
    pub(crate) out: PathBuf,
    /// Seed of the plant; that of its scene if there is none.
    pub(crate) seed: Option<u64>,
    pub(crate) link_fault: Option<&'a str>,
    pub(crate) faults: &'a [String],
}

/// Runs a scene on the limb of another: the summary as JSON, the log, the report.
///
/// # Errors
/// `SceneError`, `RunError` of Python; `KeyboardInterrupt`.
pub(crate) fn run(
    py: Python<'_>,
    Scene { scene, limb }: &Scene,
    plant: &Scene,
    settings: &Simulation<'_>,
) -> PyResult<(String, PathBuf, PathBuf)> {
    let options = RunOptions {
        seed: settings.seed.unwrap_or(plant.scene.seed()),
        out: settings.out.clone(),
        mcu: Mcu::Here,
        link_faults: settings.link_fault.map(|text| read("link_fault", text)).transpose()?,
        faults: settings.faults.iter().map(|text| read("faults", text)).collect::<PyResult<_>>()?,
    };
    let (cancel, mut signal, mut samples) = (AtomicBool::new(false), Ok(()), 0_u32);
    let on_progress = |_: Progress| {
        samples += 1;
        if samples.is_multiple_of(SAMPLES) && signal.is_ok() {
            signal = Python::attach(|py| py.check_signals());
            cancel.store(signal.is_err(), Ordering::Relaxed);
        }
    };
    let outcome = py.detach(|| {
        let plan = motion::plan(scene, limb)?;
        let margins = margin_warning(scene, limb, &plan)?;
        let files = run_on(scene, (limb.clone(), plan), &plant.scene, &options, &cancel, on_progress)?;
        let summary = report::summary(&files.run);
        let after = [limb.winding_warnings(scene), margins.into_iter().collect()].concat();
        Ok((json(&RunSummary::new(&summary, Some(limb), Vec::new(), after)), files.log, files.report))
    });
    signal?;
    outcome.map_err(|error| run_error(py, error))
}

/// A fault from its text.
fn read<T: FromStr<Err: Display>>(field: &str, text: &str) -> PyResult<T> {
    text.parse().map_err(|error| PyValueError::new_err(format!("{field} = {text:?} is not allowed: {error}")))
}
