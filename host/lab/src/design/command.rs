//! `softlimb-lab design`: the search and the particle swarm on the same problems, in numbers and as a picture.

use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::ProgressBar;
use serde::Serialize;

use clap::Args;
use softlimb::cli::{Failure, Outcome, read, say};
use softlimb_design::actuators::Problem;
use softlimb_design::actuators::kinds::Kind;

use super::judge::judge;
use super::loaded::{self, Loaded};
use super::{Comparison, PLACE, Point, Query, Swarm, picture};
use crate::published::Published;

/// Compare the search of eq. (14) with the particle swarm: on a problem with several seeds, or on problems by kind and seed
#[derive(Args)]
#[command(after_help = "Example: cargo xtask lab design --kinds AB --svg comparison.svg")]
pub(crate) struct Design {
    /// The problem, a JSON file
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// Kinds of problems, of ABCDFG
    #[arg(long, value_name = "LETTERS", conflicts_with = "problem")]
    kinds: Option<String>,
    /// First seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of seeds
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    seeds: u32,
    /// Objectives that the particle swarm evaluates
    #[arg(long, value_name = "N", default_value_t = Swarm::default().evaluations as u32, value_parser = clap::value_parser!(u32).range(50..=100_000_000))]
    evaluations: u32,
    /// Scenes whose limbs are designed under load, with several seeds
    #[arg(long, value_name = "SCENE", num_args = 1.., conflicts_with_all = ["problem", "kinds"])]
    loaded: Vec<PathBuf>,
    /// Seeded tasks under load within the bounds of the scene, not the scene's task
    #[arg(long, requires = "loaded")]
    tasks: bool,
    /// The searches under load beside CMA-ES, by this Python with the package cma
    #[arg(long, value_name = "PYTHON", requires = "loaded", conflicts_with = "tasks")]
    cma: Option<PathBuf>,
    /// Processor time of CMA-ES at most, over that of the search to its limb of rods
    #[arg(long, value_name = "TIMES", default_value_t = 10.0, requires = "cma")]
    times: f64,
    /// Judge limbs of a scene for a search in another program, by lines on the standard input
    #[arg(long, requires = "loaded", conflicts_with_all = ["tasks", "cma"])]
    judge: bool,
    #[command(flatten)]
    published: Published,
}

impl Design {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        if !self.loaded.is_empty() {
            return self.under_load();
        }
        let problem = self.problem.as_ref().map(|file| {
            let complain = |error| Failure::new(format!("{}: {error}", file.display()));
            Problem::read(&read(file)?).map_err(complain)
        });
        let problem = problem.transpose()?;
        run(self, problem)
    }

    /// Designs under load.
    fn under_load(&self) -> Result<Outcome, Failure> {
        let scenes = self.loaded.iter().map(|file| Loaded::read(file)).collect::<Result<Vec<_>, _>>()?;
        if self.judge {
            return judge(&scenes[0]).map(|()| Outcome::Done);
        }
        let seeds = (0..u64::from(self.seeds)).map(|index| self.seed.wrapping_add(index));
        if let Some(python) = &self.cma {
            let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/design_path/loaded_against_cma.py");
            let text = loaded::beside_cma(&self.loaded, &scenes, (python, &script), seeds, self.times)?;
            return say(&text).map(|()| Outcome::Done);
        }
        if self.tasks {
            let tasks = loaded::tasks(&scenes[0], seeds);
            self.published.show(|| &tasks, || loaded::tasks_text(&tasks))?;
            return Ok(Outcome::Done);
        }
        let rows = loaded::seeds(&scenes, seeds);
        self.published.show(|| &rows, || loaded::seeds_text(&rows))?;
        Ok(Outcome::Done)
    }

    fn swarm(&self) -> Swarm {
        Swarm { seed: self.seed, evaluations: self.evaluations as usize, ..Swarm::default() }
    }
}

fn run(command: &Design, problem: Option<Problem>) -> Result<Outcome, Failure> {
    let published = &command.published;
    let page = published.page(PLACE)?;
    let questions = questions(command, problem)?;
    let begin = Instant::now();
    let clock = || begin.elapsed().as_secs_f64();
    let bar = ProgressBar::new(questions.len() as u64);
    let mut comparison = Comparison::default();
    for question in &questions {
        comparison.add(question, &command.swarm(), &clock).map_err(Failure::new)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    published.show(|| table(&comparison), || text(&comparison))?;
    published.keep(|| comparison.tsv())?;
    published.draw(|| picture(&comparison))?;
    page.map_or(Ok(()), |page| page.write(&format!("\n{}\n", text(&comparison))))?;
    Ok(Outcome::Done)
}

/// The problems: the one of the file with each seed, or those of the kinds.
fn questions(command: &Design, problem: Option<Problem>) -> Result<Vec<Query>, Failure> {
    let seeds = (0..u64::from(command.seeds)).map(|index| command.seed.wrapping_add(index));
    if let (Some(problem), Some(file)) = (problem, command.problem.as_deref()) {
        let name = Path::file_stem(file).map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        return Ok(seeds.map(|seed| Query { group: name.clone(), seed, problem: problem.clone() }).collect());
    }
    let all: String = Kind::ALL.map(Kind::letter).iter().collect();
    let letters = command.kinds.as_ref().unwrap_or(&all);
    let mut questions = Vec::new();
    for letter in letters.chars() {
        let kind = Kind::ALL.into_iter().find(|kind| kind.letter() == letter.to_ascii_uppercase());
        let unknown = || Failure::new(format!("--kinds: {letter} is not allowed: some of {all}"));
        let kind = kind.ok_or_else(unknown)?;
        let question = |seed| Query { group: kind.letter().to_string(), seed, problem: kind.problem(seed) };
        questions.extend(seeds.clone().map(question));
    }
    Ok(questions)
}

/// Table and ratios.
fn text(comparison: &Comparison) -> String {
    let ratio = |(group, ratio): (String, f64)| format!("{group} {ratio:.0}");
    let ratios: Vec<String> = comparison.ratios().into_iter().map(ratio).collect();
    let mut text = comparison.markdown();
    if !ratios.is_empty() {
        text += "\nModel solves of the fastest swarm to there, over those of the slowest projection to its end: ";
        text += &(ratios.join(", ") + ".\n");
    }
    text
}

#[derive(Serialize)]
struct Table {
    rows: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    problems: String,
    method: &'static str,
    asked: usize,
    solved: usize,
    bar: f64,
    relative: bool,
    there: Option<At>,
    most_model_solves: Option<u64>,
    end: At,
    most_model_solves_to_end: u64,
}

#[derive(Serialize)]
struct At {
    evaluations: u64,
    model_solves: u64,
    seconds: f64,
    objective: f64,
}

fn table(comparison: &Comparison) -> Table {
    let at = |Point { evaluations, solves, seconds, objective }| At {
        evaluations,
        model_solves: solves,
        seconds,
        objective,
    };
    let rows = comparison.rows().into_iter().map(|row| Line {
        problems: row.group,
        method: row.method.name(),
        asked: row.problems,
        solved: row.solved,
        bar: row.bar,
        relative: row.relative,
        there: row.there.map(at),
        most_model_solves: row.most_solves,
        end: at(row.end),
        most_model_solves_to_end: row.most_solves_to_end,
    });
    Table { rows: rows.collect() }
}
