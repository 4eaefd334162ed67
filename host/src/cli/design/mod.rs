//! `softlimb design`: from target deformations to geometry and pressures.

mod compare;
mod limbs;
mod problem;
mod scene;

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args, ValueEnum};

use super::kept::{Kept, read};
use super::{Failure, Outcome};
use crate::design::fit::{Answer, Effort, Problem, Swarm, solve, swarm};

/// Find geometry and pressures for given deformations, eq. (14) of the paper
#[derive(Args)]
#[command(
    group = ArgGroup::new("question").required(true).multiple(true).args(["scene", "problem", "compare"]),
    after_help = "Examples:\n  softlimb design scenes/open/group-a.toml --out group-a.toml\n  softlimb design --problem reach.json --json\n  softlimb design --compare --kinds AB --svg comparison.svg\n\n\
                  What a scene may leave open: docs/guide/design-a-limb.md. The format of problems and answers: docs/reference/actuator-problem.md"
)]
pub(super) struct Design {
    /// The scene; with targets by eq. (14), with way-points of the tip by a search for the whole limb
    #[arg(conflicts_with_all = ["problem", "compare"])]
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
    /// How to search
    #[arg(long, value_enum, default_value_t = Method::Projection)]
    method: Method,
    /// Objectives that the particle swarm evaluates
    #[arg(long, value_name = "N", default_value_t = Swarm::default().evaluations as u32, value_parser = clap::value_parser!(u32).range(50..=100_000_000))]
    evaluations: u32,
    /// Answer points of the unit box on standard input, one JSON array a line, instead: see docs/reference/actuator-problem.md
    #[arg(long, requires = "problem", conflicts_with_all = ["compare", "json", "starts", "method", "evaluations", "seed"])]
    evaluate: bool,
    /// Compare the search with the particle swarm: on the problem with several seeds, or on problems by kind and seed
    #[arg(long, conflicts_with_all = ["starts", "method"])]
    compare: bool,
    /// Kinds of problems to compare on, of ABCDFG
    #[arg(long, value_name = "LETTERS", requires = "compare", conflicts_with = "problem")]
    kinds: Option<String>,
    /// Seeds to compare with, from that of --seed on
    #[arg(long, value_name = "N", requires = "compare", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    #[command(flatten)]
    kept: Kept,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Pressures as explicit inverses, geometry by least squares with exact derivatives
    Projection,
    /// The particle swarm of the paper, over geometry and pressures
    Pso,
}

impl Design {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let kept = &self.kept;
        if !self.compare && (kept.tsv.is_some() || kept.svg.is_some() || kept.page.is_some()) {
            return Err(Failure::new(
                "--tsv, --svg and --page are files of --compare: there is nothing to write without it",
            ));
        }
        if let Some(file) = &self.scene {
            return self.order(file).run(|problem| self.answer(problem));
        }
        let problem = self.problem.as_ref().map(|file| {
            let complain = |error| Failure::new(format!("{}: {error}", file.display()));
            Problem::read(&read(file)?).map_err(complain)
        });
        match problem.transpose()? {
            problem if self.compare => compare::run(self, problem),
            Some(problem) if self.evaluate => problem::evaluate(&problem),
            Some(problem) => problem::show(&self.answer(&problem)?, kept.json),
            None => Err(Failure::new("give a scene, --problem FILE or --compare")),
        }
    }

    fn order<'a>(&'a self, file: &'a Path) -> scene::Order<'a> {
        scene::Order {
            file,
            out: self.out.as_deref(),
            json: self.kept.json,
            seed: self.seed,
            pick: self.pick as usize,
            resume: self.resume.as_deref(),
            threads: self.threads.map(|threads| threads as usize),
        }
    }

    fn answer(&self, problem: &Problem) -> Result<Answer, Failure> {
        let answer = match self.method {
            Method::Projection => solve(problem, &self.effort()),
            Method::Pso => swarm(problem, &self.swarm(), |_| {}),
        };
        answer.map_err(Failure::new)
    }

    fn swarm(&self) -> Swarm {
        Swarm { seed: self.seed, evaluations: self.evaluations as usize, ..Swarm::default() }
    }

    fn effort(&self) -> Effort {
        let default = Effort::default();
        let starts = self.starts as usize;
        // More starts than usual are a wish for more search: no bound but theirs then.
        let evaluations = if starts > default.starts { u64::MAX } else { default.evaluations };
        Effort { seed: self.seed, starts, agreeing: default.agreeing.max(starts / 8), evaluations }
    }
}
