//! `softlimb-lab payload`: both methods on the same problems.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Value, json};

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

/// What both did on one problem.
struct Row {
    name: String,
    seed: u64,
    objectives: [f64; 2],
    evaluations: u64,
    jacobians: u64,
    differences: u64,
    seconds: [f64; 2],
}

impl Payload {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let rows = self.rows()?;
        if self.json {
            let rows: Vec<Value> = rows.iter().map(Row::json).collect();
            say(&json!({"comparison": rows}).to_string())?;
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
    let own = begin.elapsed().as_secs_f64();
    let begin = Instant::now();
    let other = barrier(problem, &Barrier::default()).map_err(Failure::new)?;
    Ok(Row {
        name: name.to_owned(),
        seed,
        objectives: [found.objective, other.objective],
        evaluations: found.evaluations,
        jacobians: found.jacobians,
        differences: other.evaluations,
        seconds: [own, begin.elapsed().as_secs_f64()],
    })
}

impl Row {
    fn json(&self) -> Value {
        json!({
            "problem": self.name,
            "seed": self.seed,
            "gauss_newton": {
                "objective": self.objectives[0],
                "evaluations": self.evaluations,
                "jacobians": self.jacobians,
                "seconds": self.seconds[0],
            },
            "bfgs": {"objective": self.objectives[1], "evaluations": self.differences, "seconds": self.seconds[1]},
        })
    }
}

/// Writing to a string cannot fail.
fn table(rows: &[Row]) -> String {
    let mut text =
        String::from("                  Gauss-Newton                                    BFGS with a barrier\n");
    text.push_str(
        "problem  seed     objective  evaluations + Jacobians  time, ms     objective  evaluations  time, ms\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{:<8} {:>4}  {:>12.4e}  {:>11} + {:<9}  {:>8.2}  {:>12.4e}  {:>11}  {:>8.0}",
            row.name,
            row.seed,
            row.objectives[0],
            row.evaluations,
            row.jacobians,
            row.seconds[0] * 1e3,
            row.objectives[1],
            row.differences,
            row.seconds[1] * 1e3
        );
    }
    text
}
