//! How well limbs are found for tasks of tip way-points among obstacles.
//!
//!     cargo run --release -p softlimb-lab --example design_path SEEDS [KINDS] [EVALUATIONS] [moves]
//!
//! prints objective and time for each seed, and how many of them are below some bounds; with `moves` the moves from rest and
//! from each way-point to the next keep clear too, which not every task allows. With `evaluate KIND SEED` it answers the objective
//! for places of the unit box instead, one a line on the standard input: so that other searches can be set against this one. With
//! `choose KIND SEED` it chooses the motions and their order, of up to three modules, on two threads, and prints the limbs that nothing
//! is better than.

use std::io::{BufRead, Write};
use std::time::Instant;

use fra_model::Motion;
use softlimb_design::synthesis::kinds::{Kind, space};
use softlimb_design::synthesis::{Budget, Choice, Choosing, Evaluator, Outcome, choose, design};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == "evaluate") {
        return evaluate(kind(&arguments[1]), arguments[2].parse()?);
    }
    if arguments.first().is_some_and(|first| first == "choose") {
        return choice(kind(&arguments[1]), arguments[2].parse()?);
    }
    let seeds: u64 = arguments.first().map_or(Ok(20), |text| text.parse())?;
    let kinds = arguments.get(1).map_or("ABCEH", String::as_str);
    let evaluations = arguments.get(2).map_or(Ok(Budget::default().evaluations), |text| text.parse())?;
    let moves = arguments.get(3).is_some_and(|word| word == "moves");
    for letter in kinds.chars() {
        table(kind(&letter.to_string()), seeds, evaluations, moves)?;
    }
    Ok(())
}

fn kind(letter: &str) -> Kind {
    let found = Kind::ALL.into_iter().find(|kind| letter.starts_with(kind.letter()));
    found.unwrap_or_else(|| panic!("a kind of task: A, B, C, E or H, not {letter}"))
}

fn table(kind: Kind, seeds: u64, evaluations: usize, moves: bool) -> Result<(), Box<dyn std::error::Error>> {
    let mut objectives = Vec::new();
    let mut times = Vec::new();
    for seed in 0..seeds {
        let mut posed = kind.pose(seed)?;
        (posed.task.moves, posed.task.from_rest) = (moves, moves);
        let begin = Instant::now();
        let found = design(&posed.task, &posed.spaces, &Budget { seed, evaluations })?;
        let seconds = begin.elapsed().as_secs_f64();
        let spare = found.figures.spare_clearance_m.unwrap_or(f64::NAN);
        println!(
            "{} {seed} J {:.3e} mm2, tip {:.2e} mm, spare clearance {:.3} mm, {} evaluations, {seconds:.3} s{}",
            kind.letter(),
            found.objective_mm2,
            found.figures.tip_error_max_m * 1e3,
            spare * 1e3,
            found.evaluations,
            found.shortfall.map_or(String::new(), |shortfall| format!("; {shortfall}"))
        );
        objectives.push(found.objective_mm2);
        times.push(seconds);
    }
    let below = |bound: f64| objectives.iter().filter(|objective| **objective <= bound).count();
    let (one, fifth, none) = (below(1.0), below(0.2), below(1e-9));
    println!(
        "{}: J <= 1 mm2 {one}, <= 0.2 {fifth}, <= 1e-9 {none} of {seeds}; median {:.3e} mm2; time median {:.2} s, most {:.2} s",
        kind.letter(),
        median(&mut objectives),
        median(&mut times),
        times.last().copied().unwrap_or(0.0)
    );
    Ok(())
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn evaluate(kind: Kind, seed: u64) -> Result<(), Box<dyn std::error::Error>> {
    let posed = kind.pose(seed)?;
    let evaluator = Evaluator::new(&posed.task, &posed.spaces)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", evaluator.width())?;
    out.flush()?;
    for line in std::io::stdin().lock().lines() {
        let place = line?.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        writeln!(out, "{:e}", evaluator.objective(&place))?;
        out.flush()?;
    }
    Ok(())
}

fn choice(kind: Kind, seed: u64) -> Result<(), Box<dyn std::error::Error>> {
    let mut task = kind.pose(seed)?.task;
    (task.moves, task.from_rest) = (true, true);
    let kinds = [Motion::Extension, Motion::Expansion, Motion::Bending, Motion::Twisting].map(space);
    let begin = Instant::now();
    let observe = |choice: &Choice| {
        eprint!("\r{} of {} orders, {:.0} s", choice.searched.len(), choice.total, begin.elapsed().as_secs_f64());
        true
    };
    let choice = choose(&task, &kinds, &Choosing::default(), Choice::default(), &observe)?;
    eprintln!();
    let left_out = choice.searched.iter().filter(|searched| matches!(searched.outcome, Outcome::LeftOut(_))).count();
    println!(
        "{} {seed}: {} orders, {left_out} left out, {:.1} s on two threads",
        kind.letter(),
        choice.total,
        begin.elapsed().as_secs_f64()
    );
    println!("tip error mm  pressure kPa  mass kg  spare clearance mm  air l  modules");
    for limb in choice.pareto() {
        let figures = &limb.figures;
        let modules: Vec<String> =
            limb.modules.iter().map(|module| format!("{:?}", module.motion).to_lowercase()).collect();
        println!(
            "{:12.3e}  {:12.1}  {:7.3}  {:18.2}  {:5.2}  {}",
            figures.tip_error_rms_m * 1e3,
            figures.pressure_max_pa * 1e-3,
            figures.mass_kg,
            figures.spare_clearance_m.unwrap_or(f64::NAN) * 1e3,
            figures.air_m3 * 1e3,
            modules.join(", ")
        );
    }
    Ok(())
}
