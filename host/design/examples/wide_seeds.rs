//! Wide supply lines by the default search with many seeds, beside the best of searches ten times as long.
//!
//! `cargo run --release -p softlimb-design --example wide_seeds [SEEDS] [PROBLEM,...]`
//!
//! A silent miss ends above the best known without the warning; a doubt is the warning at the best known. Seconds are of processor on
//! Linux, and by the clock elsewhere.

#![allow(clippy::print_stdout)]

use std::time::Instant;

use softlimb_design::actuators::kinds::wide_line;
use softlimb_design::actuators::{Budget, solve};

/// Objectives within this share of the best known are it.
const SAME: f64 = 1e-4;
/// Objectives below this are zero.
const ZERO: f64 = 1e-9;

fn main() {
    let seeds = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(20_u64);
    let clock = Instant::now();
    println!("problem  best known     found  silent misses  doubts  failures  longest s  worst gap");
    let problems: Vec<u64> = std::env::args()
        .nth(2)
        .map_or((0..25).collect(), |text| text.split(',').filter_map(|one| one.parse().ok()).collect());
    for problem in problems {
        let line = wide_line(problem);
        let objective = |answer: &softlimb_design::actuators::Answer| answer.objective;
        let long = |seed| Budget { seed, starts: 400, agreeing: 160, evaluations: 25_000 };
        let best = (101..104).filter_map(|seed| solve(&line, &long(seed)).ok()).map(|answer| objective(&answer));
        let mut best = best.fold(f64::INFINITY, f64::min);
        let mut runs = Vec::new();
        for seed in 1..=seeds {
            let start = seconds(&clock);
            let Ok(answer) = solve(&line, &Budget { seed, ..Budget::default() }) else { continue };
            runs.push((objective(&answer), answer.disagreeing_starts().is_none(), seconds(&clock) - start));
            best = best.min(objective(&answer));
        }
        // An objective of zero is reached to rounding.
        let gap = |objective: f64| (objective - best) / best.max(ZERO);
        let found = runs.iter().filter(|run| gap(run.0) <= SAME).count();
        let silent = runs.iter().filter(|run| gap(run.0) > SAME && run.1).count();
        let doubts = runs.iter().filter(|run| gap(run.0) <= SAME && !run.1).count();
        let failures = seeds as usize - runs.len();
        let longest = runs.iter().map(|run| run.2).fold(0.0, f64::max);
        let worst = runs.iter().map(|run| gap(run.0)).fold(0.0, f64::max);
        println!(
            "{problem:>7}  {best:>12.4}  {found:>2} of {:>2}  {silent:>13}  {doubts:>6}  {failures:>8}  {longest:>9.2}  {worst:>9.1e}",
            runs.len()
        );
    }
}

/// Time of this thread on a processor, s.
fn seconds(clock: &Instant) -> f64 {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = schedule.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| clock.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}
