//! What designs cost and how good they are, over problems by kind and seed: `softlimb::design::fit` on one thread.
//!
//!     cargo run --release -p softlimb --example design_cost [SEEDS [KINDS [swarm|tune|longer]]]
//!
//! `swarm` runs the particle swarm on the same problems; `tune` runs it with several settings until 1e-8; `longer` compares with a search
//! of twenty times as many agreeing descents from other starts.

use std::time::Instant;

use softlimb::design::fit::kinds::Kind;
use softlimb::design::fit::{Effort, Faces, Problem, Progress, Swarm, search, solve, swarm};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(100, |text| text.parse().expect("SEEDS is a number"));
    let kinds = arguments.next().unwrap_or_else(|| Kind::ALL.map(Kind::letter).iter().collect());
    let more = arguments.next();
    for kind in Kind::ALL.into_iter().filter(|kind| kinds.contains(kind.letter())) {
        match more.as_deref() {
            None => ours(kind, seeds),
            Some("swarm") => swarms(kind, seeds),
            Some("tune") => tune(kind, seeds),
            Some("longer") => longer(kind, seeds),
            Some(other) => panic!("{other}: swarm, tune or longer"),
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

/// Runs a swarm until 1e-8; evaluations and solves to there, and what the objective was in the end.
fn swarm_until(problem: &Problem, settings: &Swarm) -> (Option<[u64; 2]>, f64) {
    let mut first = None;
    let told = |progress: &Progress| {
        let counts = progress.counts;
        first = first.or((progress.objective <= 1e-8).then_some([counts.evaluations, counts.solves]));
    };
    let answer = swarm(problem, settings, told).expect("an answer");
    (first, answer.objective)
}

fn swarms(kind: Kind, seeds: u64) {
    for seed in 0..seeds {
        let begin = Instant::now();
        let settings = Swarm { seed, enough: 1e-8, ..Swarm::default() };
        let (first, objective) = swarm_until(&kind.problem(seed), &settings);
        let needed = first.map_or("never".to_owned(), |[evaluations, solves]| {
            format!("after {evaluations} evaluations, {solves} model solves")
        });
        let seconds = begin.elapsed().as_secs_f64();
        println!("swarm on {} {seed}: {objective:.3e} in {seconds:.1} s, 1e-8 {needed}", kind.letter());
    }
}

/// Settings of the swarm, one changed at a time.
fn tune(kind: Kind, seeds: u64) {
    let usual = Swarm::default();
    let mut all = vec![("usual", usual)];
    all.extend([10, 15, 20, 30, 100].map(|particles| ("particles", Swarm { particles, ..usual })));
    all.extend([0.6, 0.65, 0.8].map(|inertia| ("inertia", Swarm { inertia, ..usual })));
    all.extend([0.05, 0.1, 0.5].map(|fastest| ("fastest", Swarm { fastest, ..usual })));
    all.extend([Faces::Nearest, Faces::Reflective, Faces::Random].map(|faces| ("faces", Swarm { faces, ..usual })));
    println!("kind {}, {seeds} seeds: solved to 1e-8, and model solves to there, least / median / most", kind.letter());
    for (what, settings) in all {
        let run = |seed| swarm_until(&kind.problem(seed), &Swarm { seed, enough: 1e-8, ..settings }).0;
        let mut solves: Vec<u64> = (0..seeds).filter_map(run).map(|[_, solves]| solves).collect();
        solves.sort_unstable();
        let at = |index: usize| solves.get(index).map_or("-".to_owned(), u64::to_string);
        let Swarm { particles, inertia, pull, fastest, faces, .. } = settings;
        println!(
            "  {what:<9} {particles:>3} particles, inertia {inertia}, pull {pull}, fastest {fastest}, {faces:?}: {} of {seeds}, {} / {} / {}",
            solves.len(),
            at(0),
            at(solves.len().saturating_sub(1) / 2),
            at(solves.len().saturating_sub(1))
        );
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
