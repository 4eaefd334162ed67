//! `softlimb-lab payload`: both methods on the same problems.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;

use super::{Barrier, KINDS, barrier, kind};
use clap::Args;
use softlimb::cli::{Failure, Outcome, read, say};
use softlimb_design::bundle::{Budget, ForceProblem, search};

/// Compare the search of eq. (18) with the paper's quasi-Newton method, on a problem or on problems by kind and seed
#[derive(Args)]
#[command(after_help = "Example: cargo xtask lab payload --kinds P1,P1u --seeds 3")]
pub(crate) struct Payload {
    /// The problem, a JSON file, in place of kinds
    #[arg(long, value_name = "FILE", conflicts_with = "kinds")]
    problem: Option<PathBuf>,
    /// Kinds of problems
    #[arg(long, value_name = "KINDS", value_delimiter = ',', default_value = "P1,P1u,P2")]
    kinds: Vec<String>,
    /// Seeds, from 0 on
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Table<'a> {
    comparison: &'a [Row],
}

/// Results of both methods on one problem.
#[derive(Serialize)]
struct Row {
    problem: String,
    seed: u64,
    gauss_newton: GaussNewton,
    bfgs: Bfgs,
}

#[derive(Serialize)]
struct GaussNewton {
    objective: f64,
    evaluations: u64,
    jacobians: u64,
    seconds: f64,
}

#[derive(Serialize)]
struct Bfgs {
    objective: f64,
    evaluations: u64,
    seconds: f64,
}

impl Payload {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let rows = self.rows()?;
        if self.json {
            say(&serde_json::to_string(&Table { comparison: &rows }).map_err(Failure::new)?)?;
        } else {
            say(&table(&rows))?;
        }
        Ok(Outcome::Done)
    }

    fn rows(&self) -> Result<Vec<Row>, Failure> {
        if let Some(file) = &self.problem {
            let complain = |error| Failure::new(format!("{}: {error}", file.display()));
            return Ok(vec![row("problem", 0, &ForceProblem::read(&read(file)?).map_err(complain)?)?]);
        }
        let pairs = self.kinds.iter().flat_map(|name| (0..self.seeds).map(move |seed| (name, seed)));
        let unknown =
            |name: &str| Failure::wrong_line(format!("--kinds: {name} is not allowed: some of {}", KINDS.join(", ")));
        pairs.map(|(name, seed)| row(name, seed, &kind(name, seed).ok_or_else(|| unknown(name))?)).collect()
    }
}

fn row(name: &str, seed: u64, problem: &ForceProblem) -> Result<Row, Failure> {
    let begin = Instant::now();
    let found = search(problem, &Budget::default()).map_err(Failure::new)?;
    let gauss_newton = GaussNewton {
        objective: found.objective,
        evaluations: found.evaluations,
        jacobians: found.jacobians,
        seconds: begin.elapsed().as_secs_f64(),
    };
    let begin = Instant::now();
    let found = barrier(problem, &Barrier::default()).map_err(Failure::new)?;
    let seconds = begin.elapsed().as_secs_f64();
    let bfgs = Bfgs { objective: found.objective, evaluations: found.evaluations, seconds };
    Ok(Row { problem: name.to_owned(), seed, gauss_newton, bfgs })
}

/// Writing to a string cannot fail.
fn table(rows: &[Row]) -> String {
    let mut text =
        String::from("                  Gauss-Newton                                    BFGS with a barrier\n");
    text.push_str(
        "problem  seed     objective  evaluations + Jacobians  time, ms     objective  evaluations  time, ms\n",
    );
    for Row { problem, seed, gauss_newton: own, bfgs } in rows {
        let _ = writeln!(
            text,
            "{problem:<8} {seed:>4}  {:>12.4e}  {:>11} + {:<9}  {:>8.2}  {:>12.4e}  {:>11}  {:>8.0}",
            own.objective,
            own.evaluations,
            own.jacobians,
            own.seconds * 1e3,
            bfgs.objective,
            bfgs.evaluations,
            bfgs.seconds * 1e3
        );
    }
    text
}
