//! A verb that computes for long: on a terminal the time shows after two seconds, and Ctrl-C says what is kept.

use std::io::{IsTerminal, stderr};
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::SIGINT;
use signal_hook::flag;

use super::interrupt::INTERRUPTED;

/// Time before anything shows.
const PATIENCE: Duration = Duration::from_secs(2);
/// Time between looks at the flag of Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);
const TICK: Duration = Duration::from_millis(200);

/// The spinner on the terminal; none before it shows.
static SPINNER: Mutex<Option<ProgressBar>> = Mutex::new(None);
/// Whether the verb handles Ctrl-C by itself.
static HANDLED: AtomicBool = AtomicBool::new(false);
/// Whether the verb has its own display of its progress.
static DISPLAYED: AtomicBool = AtomicBool::new(false);

/// Watches a verb until it is dropped.
pub(super) struct Waiting {
    ended: Arc<AtomicBool>,
}

impl Waiting {
    /// Begins to watch. Where Ctrl-C cannot be caught, it ends the program at once.
    pub(super) fn begin() -> Self {
        let (ended, interrupted) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        HANDLED.store(flag::register(SIGINT, Arc::clone(&interrupted)).is_err(), Ordering::Relaxed);
        DISPLAYED.store(!stderr().is_terminal(), Ordering::Relaxed);
        let verb_ended = Arc::clone(&ended);
        spawn(move || watch(&verb_ended, &interrupted));
        Self { ended }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        clear();
    }
}

fn watch(ended: &AtomicBool, interrupted: &AtomicBool) {
    let began = Instant::now();
    while !ended.load(Ordering::Relaxed) {
        if interrupted.load(Ordering::Relaxed) && !HANDLED.load(Ordering::Relaxed) {
            clear();
            super::note("interrupted: files that were written are whole; unfinished results are lost");
            exit(INTERRUPTED);
        }
        if began.elapsed() >= PATIENCE && !DISPLAYED.swap(true, Ordering::Relaxed) {
            show(began);
        }
        sleep(LOOK);
    }
    clear();
}

fn show(began: Instant) {
    let style = ProgressStyle::with_template("{spinner} computing for {elapsed_precise}; Ctrl-C ends it");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
    let spinner = ProgressBar::new_spinner().with_style(style).with_elapsed(began.elapsed());
    spinner.enable_steady_tick(TICK);
    *SPINNER.lock().unwrap_or_else(PoisonError::into_inner) = Some(spinner);
}

fn clear() {
    if let Some(spinner) = SPINNER.lock().unwrap_or_else(PoisonError::into_inner).take() {
        spinner.finish_and_clear();
    }
}

/// Leaves Ctrl-C to the verb.
pub(super) fn handles_interrupt() {
    HANDLED.store(true, Ordering::Relaxed);
}

/// Leaves the terminal to the verb's own display.
pub(super) fn displays() {
    DISPLAYED.store(true, Ordering::Relaxed);
    clear();
}

/// Prints something while the spinner is off the terminal.
pub(super) fn printing<T>(print: impl FnOnce() -> T) -> T {
    let spinner = SPINNER.lock().unwrap_or_else(PoisonError::into_inner);
    match &*spinner {
        Some(spinner) => spinner.suspend(print),
        None => print(),
    }
}
