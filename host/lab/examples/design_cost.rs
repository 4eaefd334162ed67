//! What designs cost and how good they are, over problems by kind and seed: `softlimb_design::actuators` on one thread.
//!
//!     cargo run --release -p softlimb-lab --example design_cost [SEEDS [KINDS [swarm|tune|longer]]]
//!
//! `swarm` runs the particle swarm on the same problems; `tune` runs it with several settings until 1e-8; `longer` compares with a search
//! of twenty times as many agreeing descents from other starts.

use std::time::Instant;

use softlimb_design::actuators::kinds::Kind;
use softlimb_design::actuators::{Budget, Problem, Progress, search, solve};
use softlimb_lab::design::{Faces, Swarm, swarm};

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
        let (problem, effort) = (kind.problem(seed), Budget { seed, ..Budget::default() });
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

/// Settings of the swarm: particles and inertia together, then velocities and faces with the best of those. Best are those that need the
/// fewest model solves to 1e-8 for a success, the solves of what failed included.
fn tune(kind: Kind, seeds: u64) {
    println!("kind {}, {seeds} seeds: solved to 1e-8, and model solves for each that was", kind.letter());
    let mut best = (f64::INFINITY, Swarm { evaluations: 15_000, ..Swarm::default() });
    let usual = best.1;
    let swarms = |particles| [0.55, 0.65, 0.7298].map(|inertia| Swarm { particles, inertia, ..usual });
    for settings in [12, 20, 30, 50].into_iter().flat_map(swarms) {
        try_settings(kind, seeds, settings, &mut best);
    }
    let chosen = best.1;
    let flights = [0.1, 0.2, 0.4].into_iter().flat_map(|fastest| {
        [Faces::Nearest, Faces::Reflective, Faces::Random].map(|faces| Swarm { fastest, faces, ..chosen })
    });
    for settings in flights.filter(|settings| *settings != chosen) {
        try_settings(kind, seeds, settings, &mut best);
    }
    println!("  best: {:?}", best.1);
}

fn try_settings(kind: Kind, seeds: u64, settings: Swarm, best: &mut (f64, Swarm)) {
    let run = |seed| {
        let mut last = None;
        let settings = Swarm { seed, enough: 1e-8, ..settings };
        let answer = swarm(&kind.problem(seed), &settings, |progress| last = Some(*progress));
        let last = last.filter(|_| answer.is_ok()).expect("an answer");
        (last.counts.solves, last.objective <= 1e-8)
    };
    let runs: Vec<(u64, bool)> = (0..seeds).map(run).collect();
    let solved = runs.iter().filter(|(_, solved)| *solved).count();
    let all: u64 = runs.iter().map(|(solves, _)| solves).sum();
    let each = if solved > 0 { all as f64 / solved as f64 } else { f64::INFINITY };
    let Swarm { particles, inertia, pull, fastest, faces, .. } = settings;
    println!(
        "  {particles:>3} particles, inertia {inertia}, pull {pull}, fastest {fastest}, {faces:?}: {solved} of {seeds}, {each:.0}"
    );
    if each < best.0 {
        *best = (each, settings);
    }
}

fn longer(kind: Kind, seeds: u64) {
    for seed in 0..seeds {
        let problem = kind.problem(seed);
        let usual = solve(&problem, &Budget { seed, ..Budget::default() }).expect("an answer");
        let effort = Budget { seed: seed + 1_000_000, starts: 100, agreeing: 100, evaluations: 30_000 };
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
