//! Limbs of scenes with weight by the default search with many seeds, without a planner, on one thread.
//!
//! `cargo run --release -p softlimb-design --example loaded_seeds SEEDS SCENE...`
//!
//! Seconds are of processor on Linux, and by the clock elsewhere.

#![allow(clippy::print_stdout)]

use std::time::Instant;

use softlimb_design::from_scene::loaded_design;
use softlimb_design::loaded::{Effort, search};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(10);
    let clock = Instant::now();
    for file in arguments {
        let scene = match softlimb_scene::load(std::path::Path::new(&file)) {
            Ok(scene) => scene,
            Err(error) => return println!("{error}"),
        };
        let Ok(design) = loaded_design(&scene) else { return println!("{file} is no task under load") };
        println!("{}\nseed  reached  reserve, %  mass, kg  limbs judged  seconds", scene.name());
        let mut all = Vec::new();
        for seed in 0..seeds {
            let start = seconds(&clock);
            let effort = Effort { seed, abreast: 1, ..Effort::default() };
            let found = search(&design.task, &design.space, &design.space.first_guess(), &effort, &|| false);
            let spent = seconds(&clock) - start;
            all.push(spent);
            let Some(found) = found else { continue };
            println!(
                "{seed:>4}  {:>7}  {:>10.1}  {:>8.2}  {:>12}  {spent:>7.1}",
                found.reached,
                100.0 * found.by.reserve,
                found.evaluation.mass_kg,
                found.evaluations
            );
        }
        all.sort_by(f64::total_cmp);
        println!("median {:.1} s, longest {:.1} s", all[all.len() / 2], all[all.len() - 1]);
    }
}

/// Time of all threads on processors, s; Linux counts it in hundredths.
fn seconds(clock: &Instant) -> f64 {
    let spent = std::fs::read_to_string("/proc/self/stat").ok().and_then(|text| {
        let after = text.rsplit_once(')')?.1;
        let mut fields = after.split_whitespace().skip(11).filter_map(|field| field.parse::<f64>().ok());
        Some(0.01 * (fields.next()? + fields.next()?))
    });
    spent.unwrap_or_else(|| clock.elapsed().as_secs_f64())
}
