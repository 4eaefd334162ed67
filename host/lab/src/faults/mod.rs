//! The fault matrix: every fault that the plant, the line and the host can have, in every phase of a run, on chambers of three sizes, in virtual
//! time. Each case is a whole session: the host's stream, the controller, the plant.

pub(crate) mod bench;
mod case;
mod command;
mod rows;
mod session;
mod table;
mod trace;

pub use case::{Case, Outcome, Verdict};
pub use rows::{Deadline, Row, rows};
pub use table::{HEADING, Line, PLACE, lines, page, parse};
pub use trace::Trace;

pub(crate) use command::Faults;

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::thread;

/// Limit of the channels, Pa.
pub const LIMIT_PA: f64 = 150e3;

/// Excess that a chamber of 30 mL or more survives, Pa.
pub const EXCESS_PA: f64 = 12e3;

/// Seeds of the plants.
pub const SEEDS: u64 = 6;

/// Phases of a run: name, and the time at which a part breaks, s after the start.
pub const PHASES: [(&str, f64); 5] = [("idle", -0.15), ("fill", 1.2), ("hold", 2.2), ("vent", 3.9), ("tracking", 5.6)];

/// All cases, in the order of the table.
#[must_use]
pub fn cases() -> Vec<Case> {
    let rows = rows();
    let phases = rows.iter().flat_map(|row| (0..PHASES.len()).map(move |phase| (*row, phase)));
    let channels = phases.flat_map(|(row, phase)| row.channels().map(move |channel| (row, phase, channel)));
    channels.flat_map(|(row, phase, channel)| (1..=SEEDS).map(move |seed| Case { row, phase, channel, seed })).collect()
}

/// Runs cases side by side; the outcomes are in their order.
#[must_use]
pub fn run(cases: &[Case]) -> Vec<(Case, Outcome)> {
    let seeds = cases.iter().map(|case| case.seed).collect::<BTreeSet<_>>();
    let sound: BTreeMap<_, _> = seeds.into_iter().map(|seed| (seed, case::sound(seed))).collect();
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let share = cases.len().div_ceil(threads).max(1);
    let run = |cases: &[Case]| cases.iter().map(|case| (*case, case.run(&sound[&case.seed]))).collect::<Vec<_>>();
    let run = &run;
    thread::scope(|scope| {
        let parts: Vec<_> = cases.chunks(share).map(|part| scope.spawn(move || run(part))).collect();
        parts.into_iter().flat_map(|part| part.join().expect("a case of the matrix")).collect()
    })
}
