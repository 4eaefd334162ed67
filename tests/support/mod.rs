//! Scenes of the repository, changed and run in a folder of their own.
#![allow(dead_code, reason = "each test takes its own part")]

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use softlimb_limb::Limb;
use softlimb_motion::Plan;
use softlimb_rig::record::read_capture;
use softlimb_rig::replay::{Replay, replay};
use softlimb_rig::report;
use softlimb_rig::report::Summary;
use softlimb_rig::run;
use softlimb_rig::run::{Mcu, RunError, RunFiles, RunOptions};
use softlimb_scene as scene;
use softlimb_scene::Scene;
use tempfile::TempDir;

/// A plant whose parameters are exactly those of the scene. Noise, jitter and creep stay.
pub(crate) const NO_SPREAD: &str = "
[plant.spread]
modulus = 0
wall = 0
fiber_angle = 0
dead_volume = 0
valve_conductance = 0
valve_delay = 0
sensor_offset = 0
sensor_gain = 0
";

/// Actuators that take their shape at once.
pub(crate) const NO_CREEP: &str = "
[plant.chamber]
creep_share = 0
";

/// Names of all scenes, sorted.
pub(crate) fn names() -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let mut names: Vec<String> = scenes.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    assert!(names.len() >= 5, "{names:?}");
    names
}

/// Names of the scenes without weight.
pub(crate) fn weightless() -> Vec<String> {
    let light = |name: &String| !scene_with(name, "").weight().is_some_and(|weight| weight.simulated);
    names().into_iter().filter(light).collect()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// A scene with more text behind it.
pub(crate) fn scene_with(name: &str, more: &str) -> Scene {
    scene_of(name, &(scene_text(name) + more))
}

/// The text of a scene.
pub(crate) fn scene_text(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap()
}

/// The scene of a text.
pub(crate) fn scene_of(name: &str, text: &str) -> Scene {
    scene::parse(text, name).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

/// A finished run; its files live as long as it does.
pub(crate) struct Ran {
    pub(crate) files: RunFiles,
    pub(crate) summary: Summary,
    folder: TempDir,
}

impl Ran {
    /// Names of all files that the run left, sorted.
    pub(crate) fn left_behind(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

pub(crate) fn run(scene: &Scene, seed: u64) -> Ran {
    run_on(Mcu::Here, scene, seed)
}

pub(crate) fn run_on(mcu: Mcu, scene: &Scene, seed: u64) -> Ran {
    ran(scene, seed, mcu, |options| run_with(scene, options))
}

/// The run of a plan.
pub(crate) fn run_planned(scene: &Scene, planned: (Limb, Plan), seed: u64) -> Ran {
    ran(scene, seed, Mcu::Here, |options| run::run_planned(scene, planned, options, &AtomicBool::new(false), |_| ()))
}

/// The controller run again on the inputs of a log: it gives what the log has.
#[track_caller]
pub(crate) fn rerun(log: &Path) -> Replay {
    let rerun = replayed(log);
    agrees(&rerun);
    rerun
}

/// The replay of a log, without a check.
pub(crate) fn replayed(log: &Path) -> Replay {
    replay(&read_capture(log).unwrap()).unwrap()
}

/// Checks that a replay reproduces its log.
#[track_caller]
pub(crate) fn agrees(rerun: &Replay) {
    assert_eq!(rerun.difference, None, "{rerun:?}");
    assert!(rerun.messages > 300 && rerun.messages_missing == 0, "{rerun:?}");
}

/// Options of a run in this process, without faults.
pub(crate) fn options(out: &Path, seed: u64) -> RunOptions {
    RunOptions { seed, out: out.to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() }
}

pub(crate) fn run_with(scene: &Scene, options: &RunOptions) -> Result<RunFiles, RunError> {
    run::run(scene, options, &AtomicBool::new(false), |_| ())
}

fn ran(scene: &Scene, seed: u64, mcu: Mcu, run: impl FnOnce(&RunOptions) -> Result<RunFiles, RunError>) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { mcu, ..options(folder.path(), seed) };
    let files = run(&options).unwrap_or_else(|error| panic!("{}, seed {seed}: {error}", scene.name()));
    let summary = report::summary(&files.run);
    Ran { files, summary, folder }
}
