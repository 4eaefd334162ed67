//! Starts CalculiX on a deck, watches it, and says in plain words how it ended.

mod guard;

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use super::dat::{Progress, progress};
use super::scratch::Scratch;
use super::{Deck, FemError};
use guard::Running;
use softlimb_files::range::require;
use softlimb_files::{FileError, make_folder};

/// Time between two looks at the run.
const PAUSE: Duration = Duration::from_millis(50);
/// CalculiX's exit code for whatever it calls an error, divergence included.
const STOPPED: i32 = 201;

/// Settings of a run of CalculiX.
#[derive(Clone, Debug, PartialEq)]
pub struct Runner {
    /// The program; a bare name is looked up in `PATH`.
    pub ccx: PathBuf,
    /// Seconds after which a run is ended; what had converged by then stands. 0.1 to 1e6.
    pub timeout_s: f64,
    /// Threads it may use, 1 to 64. Debian's package gains nothing from more than one.
    pub threads: u32,
    /// Folder for deck and output; a temporary folder that goes away where there is none.
    pub keep: Option<PathBuf>,
}

impl Default for Runner {
    fn default() -> Self {
        Self { ccx: PathBuf::from("ccx"), timeout_s: 1800.0, threads: 1, keep: None }
    }
}

impl Runner {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`FemError::Invalid`].
    pub fn check(&self) -> Result<(), FemError> {
        let timeout = self.timeout_s;
        require((0.1..=1e6).contains(&timeout), "timeout_s", timeout, "0.1 to 1e6")?;
        require((1..=64).contains(&self.threads), "threads", f64::from(self.threads), "1 to 64")?;
        Ok(())
    }
}

/// End of a run with usable output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// At the end of the load.
    Finished,
    /// Before it: CalculiX gave up. What converged before stands.
    Diverged {
        /// Why, in plain words.
        diagnosis: String,
        /// Whether an iterate overstretched a fiber, which smaller increments cure.
        overstretched: bool,
    },
    /// Before it: the time was up. What converged before stands.
    TimedOut,
}

/// Output of a run.
pub(crate) struct Raw {
    pub(crate) end: End,
    /// The `.dat` file.
    pub(crate) dat: String,
    pub(crate) progress: Progress,
    /// Seconds at which each step was seen to be done.
    pub(crate) step_seconds: Vec<f64>,
    pub(crate) seconds: f64,
    /// Whether the disk was full when it had ended. CalculiX does not always notice.
    pub(crate) disk_is_full: bool,
}

/// Runs a deck. `clock` tells seconds from any beginning; `watch` is told the progress.
pub(crate) fn drive(
    runner: &Runner,
    deck: &Deck,
    clock: &dyn Fn() -> f64,
    watch: &mut dyn FnMut(Progress),
) -> Result<Raw, FemError> {
    runner.check()?;
    let scratch = Scratch::new()?;
    let folder = runner.keep.as_deref().unwrap_or(scratch.path());
    make_folder(folder)?;
    forget(folder, deck)?;
    deck.write(folder)?;
    let begin = clock();
    let mut running = Running::new(start(runner, folder, deck.name(), scratch.lock())?);
    let (mut step_seconds, mut timed_out) = (Vec::new(), false);
    let status = loop {
        let ended = running.try_wait().map_err(|source| FemError::Program { program: runner.ccx.clone(), source })?;
        let seconds = clock() - begin;
        let reached = progress(&text(&folder.join(format!("{}.sta", deck.name())))?);
        while step_seconds.len() < deck.steps() && (step_seconds.len() as f64) < (reached.time + 1e-6).floor() {
            step_seconds.push(seconds);
        }
        watch(reached);
        match ended {
            Some(status) => break Some(status),
            None if seconds > runner.timeout_s => {
                timed_out = true;
                break None;
            }
            None => thread::sleep(PAUSE),
        }
    };
    drop(running);
    let seconds = clock() - begin;
    let disk_is_full = is_full(folder);
    let read = |kind: &str| text(&folder.join(format!("{}.{kind}", deck.name())));
    let reached = progress(&read("sta")?);
    let end = match status {
        _ if timed_out => End::TimedOut,
        Some(status) => {
            end(status, &text(&folder.join(LOG))?, &reached).map_err(|error| error.blaming(disk_is_full))?
        }
        None => End::TimedOut,
    };
    Ok(Raw { end, dat: read("dat")?, progress: reached, step_seconds, seconds, disk_is_full })
}

/// Whether a folder has no room for another line or two of output.
fn is_full(folder: &Path) -> bool {
    let path = folder.join("room");
    let room = fs::write(&path, [b' '; 1 << 16]);
    // There may be nothing to remove.
    let _ = fs::remove_file(&path);
    room.is_err_and(|error| matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded))
}

/// File for the output of CalculiX.
const LOG: &str = "ccx.log";

/// Removes what an earlier run left, which could be taken for this run's.
fn forget(folder: &Path, deck: &Deck) -> Result<(), FemError> {
    for kind in ["dat", "sta", "cvg", "frd"] {
        let path = folder.join(format!("{}.{kind}", deck.name()));
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(FileError::at("write", &path)(error).into());
            }
            _ => {}
        }
    }
    Ok(())
}

/// Starts the program in a folder. It has `lock` open as long as it runs, as the input that it does not read.
fn start(runner: &Runner, folder: &Path, name: &str, lock: io::Result<File>) -> Result<Child, FemError> {
    let failed = |source| FemError::Program { program: runner.ccx.clone(), source };
    let path = folder.join(LOG);
    let log = File::create(&path).map_err(FileError::at("create", &path))?;
    let errors = log.try_clone().map_err(FileError::at("create", &path))?;
    let threads = runner.threads.to_string();
    // The program starts in its own folder, from which a path of ours would lead elsewhere.
    let is_path = runner.ccx.components().count() > 1;
    let program = if is_path { std::path::absolute(&runner.ccx).map_err(failed)? } else { runner.ccx.clone() };
    let mut command = Command::new(program);
    command.args(["-i", name]).current_dir(folder).stdout(log).stderr(errors);
    command.stdin(lock.map_or_else(|_| Stdio::null(), Stdio::from));
    command.env("OMP_NUM_THREADS", &threads).env("CCX_NPROC_STIFFNESS", &threads);
    command.spawn().map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => FemError::Missing { program: runner.ccx.clone() },
        _ => failed(source),
    })
}

/// The text of a file, empty where there is none. What is not text becomes signs that no number has.
fn text(path: &Path) -> Result<String, FemError> {
    match fs::read(path) {
        Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        Err(error) => Err(FileError::at("read", path)(error).into()),
    }
}

/// End of the run, by exit code and output.
fn end(status: ExitStatus, log: &str, reached: &Progress) -> Result<End, FemError> {
    let Some(code) = status.code() else {
        let reached = format!("{:.2} steps", reached.time);
        return Err(FemError::Killed { signal: signal(status), reached });
    };
    let found = WORDS.iter().find(|(words, _)| log.contains(words));
    let last = || log.lines().rev().find(|line| line.contains("*ERROR")).unwrap_or("no reason is given").trim();
    let overstretched = log.contains(OVERSTRETCHED);
    match (code, found) {
        (0, None) => Ok(End::Finished),
        // A full disk does not always show in the exit code.
        (0, Some((words, diagnosis))) if *words == DISK_FULL => {
            Err(FemError::Failed { code, diagnosis: (*diagnosis).to_owned() })
        }
        (0, Some(_)) => Ok(End::Finished),
        (STOPPED, Some((words, diagnosis))) if *words != DISK_FULL => {
            Ok(End::Diverged { diagnosis: (*diagnosis).to_owned(), overstretched })
        }
        (_, Some((_, diagnosis))) => Err(FemError::Failed { code, diagnosis: (*diagnosis).to_owned() }),
        (STOPPED, None) if reached.increments > 0 => {
            Ok(End::Diverged { diagnosis: format!("CalculiX gave up: {}", last()), overstretched })
        }
        (_, None) => Err(FemError::Failed { code, diagnosis: last().to_owned() }),
    }
}

const DISK_FULL: &str = "No space left on device";
const OVERSTRETCHED: &str = "fiber extension is too large";

const NO_EQUILIBRIUM: &str = "no equilibrium was found however small the increment: a limit point or a buckle is near, or the mesh is too coarse";

/// Words that CalculiX prints, and their meaning; the first that is found counts.
const WORDS: [(&str, &str); 6] = [
    (DISK_FULL, "the disk is full: free some space, or set TMPDIR to a folder on another disk"),
    (OVERSTRETCHED, "an iterate overstretched a fiber, where CalculiX stops without trying a smaller increment"),
    ("increment size smaller than minimum", NO_EQUILIBRIUM),
    ("too many cutbacks", NO_EQUILIBRIUM),
    ("max. # of increments reached", "the increments allowed were used up: it crept, as it does near a limit point"),
    ("nonpositive jacobian", "an element turned inside out: use smaller increments or a finer mesh"),
];

#[cfg(unix)]
fn signal(status: ExitStatus) -> i32 {
    std::os::unix::process::ExitStatusExt::signal(&status).unwrap_or(0)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> i32 {
    0
}
