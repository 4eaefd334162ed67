//! Scripts that stand for CalculiX, and output for them to leave.

use std::fmt::Write;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use fra_model::Motion;
use softlimb_fea::solid::{Deck, FemError, Model, Options, Run, Runner, Subject, run};
use tempfile::TempDir;

use super::sample::plain;

/// The pressures of the runs, Pa: two steps.
pub(crate) const PRESSURES: [f64; 2] = [20e3, 30e3];

pub(crate) fn subject() -> Subject {
    Subject::single(plain(Motion::Expansion))
}

/// A folder with a script and what it leaves.
pub(crate) struct Fake {
    pub(crate) folder: TempDir,
}

impl Fake {
    /// A script of a body that runs in the folder of the deck; `$HERE` is this one's.
    pub(crate) fn new(body: &str) -> Self {
        let fake = Self { folder: tempfile::tempdir().unwrap() };
        let text = format!("#!/bin/sh\nHERE='{}'\n{body}\n", fake.folder.path().display());
        fs::write(fake.path("draft"), text).unwrap();
        fs::set_permissions(fake.path("draft"), fs::Permissions::from_mode(0o755)).unwrap();
        // A file cannot be started while anybody has it open for writing: a child that another thread forks would have what this process has.
        assert!(Command::new("cp").args([fake.path("draft"), fake.path("ccx")]).status().unwrap().success());
        fake
    }

    /// Adds a file.
    pub(crate) fn with(self, name: &str, text: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), text).unwrap();
        self
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn run(&self) -> Result<Run, FemError> {
        self.run_with(Runner::default())
    }

    pub(crate) fn run_with(&self, runner: Runner) -> Result<Run, FemError> {
        self.run_for(runner, Options::default())
    }

    /// Runs it with a clock that advances ten seconds at each look.
    pub(crate) fn run_for(&self, runner: Runner, options: Options) -> Result<Run, FemError> {
        let runner = Runner { ccx: self.path("ccx"), ..runner };
        let time = std::cell::Cell::new(0.0);
        let clock = || {
            time.set(time.get() + 10.0);
            time.get()
        };
        run(&subject(), &options, &PRESSURES, &runner, &clock, &mut |_| {})
    }
}

/// Nodes that the deck asks to be printed, with their places in mm.
fn printed(options: &Options) -> Vec<(usize, [f64; 3])> {
    let model = Model::new(&subject(), options).unwrap();
    let text = Deck::new(&model, "actuator", &PRESSURES).unwrap().model;
    let set = text.split_once("*NSET, NSET=GAUGES\n").unwrap().1;
    let set = set.split_once('*').unwrap().0;
    let nodes = set.split([',', '\n']).filter_map(|word| word.trim().parse::<usize>().ok());
    nodes.map(|node| (node, model.mesh().nodes[node - 1])).collect()
}

/// A `.dat` file of an even deformation: radii grow to `swelling(t)`, lengths to `stretch(t)` times theirs.
pub(crate) fn dat(times: &[f64], swelling: impl Fn(f64) -> f64, stretch: impl Fn(f64) -> f64) -> String {
    dat_for(&Options::default(), times, swelling, stretch)
}

/// The same with the nodes that some options print.
pub(crate) fn dat_for(
    options: &Options,
    times: &[f64],
    swelling: impl Fn(f64) -> f64,
    stretch: impl Fn(f64) -> f64,
) -> String {
    let nodes = printed(options);
    assert!(nodes.len() >= 12);
    let mut text = String::new();
    for &time in times {
        writeln!(text, "\n displacements (vx,vy,vz) for set GAUGES and time  {time:.7E}\n").unwrap();
        let (g, l) = (swelling(time) - 1.0, stretch(time) - 1.0);
        for (node, [x, y, z]) in &nodes {
            writeln!(text, "{node:10} {:13.6E} {:13.6E} {:13.6E}", g * x, g * y, l * z).unwrap();
        }
    }
    text
}

/// The output of a run that goes well: radii grow by 5 %, lengths by 10 % a step.
pub(crate) fn good(times: &[f64]) -> String {
    dat(times, |t| 1.0 + 0.05 * t, |t| 1.0 + 0.1 * t)
}

/// Whether a process still runs.
pub(crate) fn is_running(id: &str) -> bool {
    Path::new("/proc").join(id.trim()).join("exe").read_link().is_ok()
}
