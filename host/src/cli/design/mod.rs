//! `softlimb design`: from target deformations to geometry and pressures.

mod limbs;
mod problem;
mod scene;

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};

use super::kept::read;
use super::{Failure, Outcome};
use softlimb_design::actuators::{Answer, Effort, Problem, solve};

/// Find geometry and pressures for given deformations, eq. (14) of the paper
#[derive(Args)]
#[command(
    group = ArgGroup::new("question").required(true).multiple(true).args(["scene", "problem"]),
    after_help = "Examples:\n  softlimb design scenes/open/group-a.toml --out group-a.toml\n  softlimb design --problem reach.json --json\n\n\
                  What a scene may leave open: docs/guide/design-a-limb.md. The format of problems and answers: docs/reference/actuator-problem.md"
)]
pub(super) struct Design {
    /// The scene; with targets by eq. (14), with way-points of the tip by a search for the whole limb
    #[arg(conflicts_with = "problem")]
    scene: Option<PathBuf>,
    /// Where the scene with the limb found goes [default: beside the scene, NAME-designed.toml]
    #[arg(long, value_name = "FILE", requires = "scene")]
    out: Option<PathBuf>,
    /// Which limb of the list to write, from 1, where motions and their order are chosen
    #[arg(long, value_name = "N", requires = "scene", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pick: u32,
    /// Keep the choice of motions and their order in this file, and go on with what it holds
    #[arg(long, value_name = "FILE", requires = "scene")]
    resume: Option<PathBuf>,
    /// Threads of the choice of motions and their order; the answer does not depend on it [default: as many as there are processors]
    #[arg(long, value_name = "N", requires = "scene", value_parser = clap::value_parser!(u32).range(1..=64))]
    threads: Option<u32>,
    /// The problem, a JSON file
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// Seed of the starts of the search
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Most descents of the search
    #[arg(long, value_name = "N", default_value_t = Effort::default().starts as u32, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    starts: u32,
    /// Answer points of the unit box on standard input, one JSON array a line, instead: see docs/reference/actuator-problem.md
    #[arg(long, requires = "problem", conflicts_with_all = ["json", "starts", "seed"])]
    evaluate: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Design {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        if let Some(file) = &self.scene {
            return self.order(file).run(|problem| self.answer(problem));
        }
        let problem = self.problem.as_ref().map(|file| {
            let complain = |error| Failure::new(format!("{}: {error}", file.display()));
            Problem::read(&read(file)?).map_err(complain)
        });
        match problem.transpose()? {
            Some(problem) if self.evaluate => problem::evaluate(&problem),
            Some(problem) => problem::show(&self.answer(&problem)?, self.json),
            None => Err(Failure::new("give a scene or --problem FILE")),
        }
    }

    fn order<'a>(&'a self, file: &'a Path) -> scene::Order<'a> {
        scene::Order {
            file,
            out: self.out.as_deref(),
            json: self.json,
            seed: self.seed,
            pick: self.pick as usize,
            resume: self.resume.as_deref(),
            threads: self.threads.map(|threads| threads as usize),
        }
    }

    fn answer(&self, problem: &Problem) -> Result<Answer, Failure> {
        solve(problem, &self.effort()).map_err(Failure::new)
    }

    fn effort(&self) -> Effort {
        let default = Effort::default();
        let starts = self.starts as usize;
        // More starts than usual are a wish for more search: no bound but theirs then.
        let evaluations = if starts > default.starts { u64::MAX } else { default.evaluations };
        Effort { seed: self.seed, starts, agreeing: default.agreeing.max(starts / 8), evaluations }
    }
}
