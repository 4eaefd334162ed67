//! Sweeps: runs each simulated limb of each design of a study, and tabulates the figures of merit.
//!
//! A row depends on the study and its index alone, not on the number of threads or the order of runs.

mod figures;
mod table;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use softlimb_rig::learning::{Settings, learn};
use softlimb_rig::run;
use softlimb_scene::{Experiment, Study};

pub use table::{SweepError, Table};

/// Largest number of limbs of a design in a batch. A thread plans the design once for each batch.
const BATCH: usize = 16;

/// Seed of the noise of limbs that learn.
const NOISE: u64 = 1;

/// One of several equal parts of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of this part, from 1.
    pub index: u64,
    /// Number of parts.
    pub count: u64,
}

impl Shard {
    /// All rows.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether a design belongs to it; a row, where a study has fewer designs than parts.
    fn has(self, index: u64) -> bool {
        index % self.count == self.index - 1
    }
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Index in the study.
    pub index: u64,
    /// The row as a line of the table, without a line break.
    pub line: String,
}

/// Runs rows, whose indices must rise, and passes each to `on_row` when its run ends. After `cancel` becomes true, no more rows are passed.
pub fn run_rows(study: &Study, rows: &[u64], threads: usize, cancel: &AtomicBool, mut on_row: impl FnMut(Row)) {
    let batches = batches(study, rows);
    let next = AtomicUsize::new(0);
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, batches.len().max(1)) {
            let (sender, batches, next) = (sender.clone(), &batches, &next);
            scope.spawn(move || {
                while let Some(batch) = batches.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if cancel.load(Ordering::Relaxed) || !run_batch(study, &rows[batch.clone()], cancel, &sender) {
                        return;
                    }
                }
            });
        }
        drop(sender);
        receiver.iter().for_each(&mut on_row);
    });
}

/// Ranges of rows of one design each.
fn batches(study: &Study, rows: &[u64]) -> Vec<Range<usize>> {
    let limbs = u64::from(study.limbs());
    let mut batches: Vec<Range<usize>> = Vec::new();
    for (place, row) in rows.iter().enumerate() {
        match batches.last_mut() {
            Some(last) if last.len() < BATCH && rows[last.start] / limbs == row / limbs => last.end = place + 1,
            _ => batches.push(place..place + 1),
        }
    }
    batches
}

/// Runs rows of one design; `false` after cancellation.
fn run_batch(study: &Study, rows: &[u64], cancel: &AtomicBool, sender: &Sender<Row>) -> bool {
    let limbs = u64::from(study.limbs());
    let design = rows[0] / limbs;
    let drawn = drawn(study, design);
    let cells = study.cells(design, &drawn);
    let row = |index: u64, found: Result<Vec<String>, String>| {
        let mut cells = cells.clone();
        cells.insert(0, index.to_string());
        cells.push((index % limbs + 1).to_string());
        let (figures, outcome) = match found {
            Ok(figures) => (figures, "ok".to_owned()),
            Err(text) => (vec![String::new(); figures::headings(study.experiment()).len()], text),
        };
        cells.extend(figures);
        cells.push(outcome);
        Row { index, line: table::line(&cells) }
    };
    let send = |row: Row| sender.send(row).is_ok() && !cancel.load(Ordering::Relaxed);
    let refused = |text: String| rows.iter().all(|index| send(row(*index, Err(text.clone()))));
    let scene = match study.scene(design, &drawn) {
        Ok(scene) => scene,
        Err(error) => return refused(error.to_string()),
    };
    if let Experiment::Learn { iterations, runs, camera_noise_m } = study.experiment() {
        return rows.iter().all(|index| {
            let limb = index % limbs + 1;
            let settings = Settings { limb, noise: NOISE, iterations, runs, camera_noise_m };
            let found = learn(&scene, &settings).map(|found| figures::of_learning(&found));
            send(row(*index, found.map_err(|error| error.to_string())))
        });
    }
    let mut is_wanted = true;
    let seeds = rows.iter().map(|index| index % limbs + 1);
    let ended = run::summaries(&scene, seeds, |seed, found| {
        let found = found.map(|found| figures::of_a_run(&found)).map_err(|error| error.to_string());
        is_wanted = send(row(design * limbs + seed - 1, found));
        is_wanted
    });
    ended.map_or_else(|error| refused(error.to_string()), |()| is_wanted)
}

/// Coordinates, 0 to 1, of the design's point in the ranges of the drawn parameters.
fn drawn(study: &Study, design: u64) -> Vec<f64> {
    let dimensions = 0..study.drawn_count() as u32;
    dimensions.map(|dimension| sobol_burley::sample(study.point(design), dimension, study.seed()).into()).collect()
}

/// Headings of the table.
fn headings(study: &Study) -> Vec<String> {
    let mut headings = study.headings();
    headings.insert(0, "row".to_owned());
    headings.push("limb".to_owned());
    headings.extend(figures::headings(study.experiment()).iter().map(|heading| (*heading).to_owned()));
    headings.push("outcome".to_owned());
    headings
}
