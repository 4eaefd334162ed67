//! What designs cost and how good they are, over problems by kind and seed: `softlimb::design::fit` on one thread.
//!
//!     cargo run --release -p softlimb --example design_cost [SEEDS [KINDS [swarm|longer]]]
//!
//! `swarm` runs the particle swarm on the same problems; `longer` compares with a search of twenty times as many agreeing descents from
//! other starts.

use std::time::Instant;

use softlimb::design::fit::kinds::Kind;
use softlimb::design::fit::{Effort, Swarm, search, solve, swarm};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(100, |text| text.parse().expect("SEEDS is a number"));
    let kinds = arguments.next().unwrap_or_else(|| Kind::ALL.map(Kind::letter).iter().collect());
    let more = arguments.next();
    for kind in Kind::ALL.into_iter().filter(|kind| kinds.contains(kind.letter())) {
        match more.as_deref() {
            None => ours(kind, seeds),
            Some("swarm") => swarms(kind, seeds),
            Some("longer") => longer(kind, seeds),
            Some(other) => panic!("{other}: swarm or longer"),
        }
    }
}

/// Median, 90th percentile and largest of some values.
fn spread(mut values: Vec<f64>) -> String {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
    format!("{:.3e} / {:.3e} / {:.3e}", at(0.5), at(0.9), at(1.0))
}

fn ours(kind: Kind, seeds: u64) {
    let (mut times, mut full, mut objectives, mut solves, mut evaluations) = (vec![], vec![], vec![], vec![], vec![]);
    for seed in 0..seeds {
        let (problem, effort) = (kind.problem(seed), Effort { seed, ..Effort::default() });
        // The faster of two: the first may have met cold memory or another program.
        let searched = [0; 2].map(|_| {
            let begin = Instant::now();
            let design = search(&problem, &effort);
            (begin.elapsed().as_secs_f64() * 1e6, design.is_ok()).0
        });
        times.push(searched[0].min(searched[1]));
        let begin = Instant::now();
        let answer = solve(&problem, &effort).expect("an answer");
        full.push(begin.elapsed().as_secs_f64() * 1e6);
        objectives.push(answer.objective);
        solves.push(answer.cost.solves as f64);
        evaluations.push(answer.cost.evaluations as f64);
    }
    println!("kind {}, {seeds} seeds: median / 90 % / largest", kind.letter());
    let within = objectives.iter().filter(|objective| **objective <= 1e-12).count();
    println!("  objective      {}, {within} of {seeds} at most 1e-12", spread(objectives));
    println!("  search, us     {}", spread(times));
    println!("  all, us        {}", spread(full));
    println!("  model solves   {}", spread(solves));
    println!("  evaluations    {}", spread(evaluations));
}

fn swarms(kind: Kind, seeds: u64) {
    for seed in 0..seeds {
        let problem = kind.problem(seed);
        let (begin, mut first) = (Instant::now(), None);
        let settings = Swarm { seed, ..Swarm::default() };
        let told = |evaluations, objective| first = first.or((objective <= 1e-8).then_some(evaluations));
        let answer = swarm(&problem, &settings, told).expect("an answer");
        let needed = first.map_or("never".to_owned(), |evaluations| {
            let each = problem.segments().len() * problem.phases();
            format!("after {evaluations} evaluations, {} model solves", evaluations * each)
        });
        let (objective, seconds) = (answer.objective, begin.elapsed().as_secs_f64());
        println!("swarm on {} {seed}: {objective:.3e} in {seconds:.1} s, 1e-8 {needed}", kind.letter());
    }
}

fn longer(kind: Kind, seeds: u64) {
    for seed in 0..seeds {
        let problem = kind.problem(seed);
        let usual = solve(&problem, &Effort { seed, ..Effort::default() }).expect("an answer");
        let effort = Effort { seed: seed + 1_000_000, starts: 100, agreeing: 100, evaluations: 30_000 };
        let other = solve(&problem, &effort).expect("an answer");
        let best = usual.objective.min(other.objective);
        println!(
            "{} {seed}: gap {:.1e} after {} evaluations; objective {:.9e}, other search {:.9e} after {}",
            kind.letter(),
            (usual.objective - best) / best,
            usual.cost.evaluations,
            usual.objective,
            other.objective,
            other.cost.evaluations
        );
    }
}
