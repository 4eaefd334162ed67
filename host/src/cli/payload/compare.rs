//! Both methods on the same problems.

use std::fmt::Write;
use std::time::Instant;

use serde_json::{Value, json};

use super::Payload;
use crate::cli::{Failure, Outcome, say};
use crate::payload::fit::{Barrier, ForceProblem, KINDS, barrier, kind, search};

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

pub(super) fn run(command: &Payload, problem: Option<ForceProblem>) -> Result<Outcome, Failure> {
    let mut rows = Vec::new();
    match problem {
        Some(problem) => rows.push(row(command, "problem", command.seed.unwrap_or(0), &problem)?),
        None => {
            for name in &command.kinds {
                for seed in 0..command.seeds {
                    let unknown =
                        || Failure::wrong_line(format!("--kinds: {name} is not allowed: some of {}", KINDS.join(", ")));
                    rows.push(row(command, name, seed, &kind(name, seed).ok_or_else(unknown)?)?);
                }
            }
        }
    }
    if command.json {
        let rows: Vec<Value> = rows.iter().map(Row::json).collect();
        say(&json!({"comparison": rows}).to_string())?;
    } else {
        say(&table(&rows))?;
    }
    Ok(Outcome::Done)
}

fn row(command: &Payload, name: &str, seed: u64, problem: &ForceProblem) -> Result<Row, Failure> {
    let begin = Instant::now();
    let found = search(problem, &command.effort()).map_err(Failure::new)?;
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
