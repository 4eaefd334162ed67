//! Speed against error: every method, motion and scalar over a seeded set of actuators, against a reference of its own.
//!
//! [`accuracy`] makes the table; how to read it is in `docs/evidence/accuracy.md`, which is made from it.

mod callgrind;
pub mod choice;
mod command;
mod entry;
mod gauss;
mod kernel;
mod mcu;
mod measure;
mod method;
mod number;
mod page;
mod picture;
mod question;
mod reference;
mod report;
mod series;
mod set;
mod tsv;

use std::path::Path;
use std::thread;

pub use callgrind::{Count, missing_instruments};
pub(crate) use command::Accuracy as Command;
pub use mcu::{McuError, join};
pub use measure::Accuracy;
pub use page::{PLACE, page};
pub use picture::picture;
pub use reference::Doubt;
pub use report::{Cost, McuCost, Report, Row};
pub use set::{Sample, samples};
pub use tsv::TsvError;

use self::entry::{Polynomial, Work, entries, nanoseconds};
use self::question::Question;
use self::reference::Reference;

/// The seed of the published table.
pub const SEED: u64 = 1;
/// The actuators of the published table.
pub const ACTUATORS: usize = 1000;

/// Questions worked on between two reports of progress.
const AT_A_TIME: usize = 40;
/// The line that times are relative to.
const BASELINE: [&str; 4] = ["forward", "Newton, cold, to 1e-10", "extension", "f64"];
/// Number of the part whose size is known.
const POLYNOMIAL: usize = usize::MAX >> 1;

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Seed of the set.
    pub seed: u64,
    /// Number of actuators, > 0.
    pub actuators: usize,
}

/// How far the work is, in steps of which there are so many.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Steps done.
    pub done: usize,
    /// Steps in all.
    pub all: usize,
}

/// Measures every method. With a `clock` (seconds, of any origin) also how long each takes.
pub fn accuracy(settings: &Settings, clock: Option<&dyn Fn() -> f64>, progress: impl Fn(Progress)) -> Report {
    let entries = entries();
    let all = settings.actuators + entries.len();
    let samples = samples(settings.seed, settings.actuators);
    let reference = Reference::new();
    let mut questions = Vec::new();
    for (index, few) in samples.chunks(AT_A_TIME).enumerate() {
        questions.extend(ask(&reference, few));
        progress(Progress { done: (index * AT_A_TIME + few.len()).min(settings.actuators), all });
    }
    let doubt = questions.iter().fold(Doubt::default(), |doubt, question| doubt.or(question.truth.doubt));
    let mut rows = Vec::new();
    for (index, entry) in entries.iter().enumerate() {
        progress(Progress { done: settings.actuators + index, all });
        let Some(accuracy) = entry.accuracy(&questions) else { continue };
        let time = clock.and_then(|clock| Some(nanoseconds(&*entry.work(&questions)?, clock)));
        rows.push(Row { entry: index, names: entry.names(), accuracy, cost: Cost { time, ..Cost::default() } });
    }
    relate(&mut rows);
    progress(Progress { done: all, all });
    let asked = settings.actuators;
    Report { seed: settings.seed, asked, answered: questions.len(), doubt, rows, polynomial: None }
}

/// Questions about samples, on all processors. The order is that of the samples.
fn ask(reference: &Reference, samples: &[Sample]) -> Vec<Question> {
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let share = samples.len().div_ceil(threads);
    thread::scope(|scope| {
        let ask = |few: &[Sample]| few.iter().filter_map(|sample| Question::new(reference, sample)).collect::<Vec<_>>();
        let workers: Vec<_> = samples.chunks(share).map(|few| scope.spawn(move || ask(few))).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.flat_map(|found| found.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}

/// Times relative to that of the baseline.
fn relate(rows: &mut [Row]) {
    let baseline = rows.iter().find(|row| row.names.iter().eq(BASELINE.iter())).and_then(|row| row.cost.time);
    for row in rows {
        row.cost.time = row.cost.time.zip(baseline).map(|(time, unit)| time / unit);
    }
}

/// Adds the instructions of every line, counted on `program` run with `arguments`, which must end in [`workload`].
///
/// # Errors
/// A sentence that names what is missing or has failed.
pub fn count(report: &mut Report, program: &Path, arguments: &[String]) -> Result<(), String> {
    if let Some(missing) = missing_instruments().first().filter(|name| **name == "valgrind") {
        return Err(format!("{missing} is not installed, instructions are not counted"));
    }
    let counts = callgrind::counts(program, arguments)?;
    for row in &mut report.rows {
        row.cost.count = counts.get(&row.entry).copied();
    }
    report.polynomial = counts.get(&POLYNOMIAL).copied();
    Ok(())
}

/// The work that is counted: every line once, each inside of one region. Says number and answers of each line.
pub fn workload(seed: u64, mut say: impl FnMut(&str)) {
    let questions: Vec<_> = samples(seed, entry::COST_QUESTIONS).iter().filter_map(Question::untold).collect();
    let mut measure = |number: usize, work: &dyn Work| {
        measured_region(work);
        say(&format!("{number} {}", work.answers()));
    };
    measure(POLYNOMIAL, &Polynomial);
    for (number, entry) in entries().iter().enumerate() {
        if let Some(work) = entry.work(&questions) {
            measure(number, &*work);
        }
    }
}

/// Callgrind begins a part where this is entered ...
#[inline(never)]
fn measured_region(work: &dyn Work) {
    measured_work(std::hint::black_box(work));
    // Not the last call, so that it is not turned into a jump.
    std::hint::black_box(());
}

/// ... and ends it where this is left: one function cannot do both.
#[inline(never)]
fn measured_work(work: &dyn Work) {
    work.run();
    std::hint::black_box(());
}
