//! The search and the particle swarm on the same problems, in numbers and as a picture.

use std::path::Path;
use std::time::Instant;

use indicatif::ProgressBar;
use serde_json::{Value, json};

use super::Design;
use crate::cli::kept::{Page, write};
use crate::cli::{Failure, Outcome};
use crate::design::fit::Problem;
use crate::design::fit::compare::{Comparison, PLACE, Point, Question, picture};
use crate::design::fit::kinds::Kind;
use crate::marked;

pub(super) fn run(command: &Design, problem: Option<Problem>) -> Result<Outcome, Failure> {
    let kept = &command.kept;
    let page = kept.page(PLACE)?;
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
    kept.show(|| table(&comparison), || text(&comparison))?;
    kept.tsv.as_deref().map_or(Ok(()), |file| write(file, &comparison.tsv()))?;
    kept.draw(|| picture(&comparison))?;
    let written = |page: Page| {
        let text = marked::replaced(&page.text, PLACE, &format!("\n{}\n", text(&comparison)));
        page.write(text)
    };
    page.map_or(Ok(()), written)?;
    Ok(Outcome::Done)
}

/// The problems: the one of the file with each seed, or those of the kinds.
fn questions(command: &Design, problem: Option<Problem>) -> Result<Vec<Question>, Failure> {
    let seeds = (0..u64::from(command.seeds)).map(|index| command.seed.wrapping_add(index));
    if let (Some(problem), Some(file)) = (problem, command.problem.as_deref()) {
        let name = Path::file_stem(file).map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        return Ok(seeds.map(|seed| Question { group: name.clone(), seed, problem: problem.clone() }).collect());
    }
    let all: String = Kind::ALL.map(Kind::letter).iter().collect();
    let letters = command.kinds.as_ref().unwrap_or(&all);
    let mut questions = Vec::new();
    for letter in letters.chars() {
        let kind = Kind::ALL.into_iter().find(|kind| kind.letter() == letter.to_ascii_uppercase());
        let unknown = || Failure::new(format!("--kinds: {letter} is not allowed: some of {all}"));
        let kind = kind.ok_or_else(unknown)?;
        let question = |seed| Question { group: kind.letter().to_string(), seed, problem: kind.problem(seed) };
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

fn table(comparison: &Comparison) -> Value {
    let at = |point: &Point| {
        json!({
            "evaluations": point.evaluations, "model_solves": point.solves, "seconds": point.seconds,
            "objective": point.objective,
        })
    };
    let rows = comparison.rows().into_iter().map(|row| {
        json!({
            "problems": row.group, "method": row.method.name(), "asked": row.problems, "solved": row.solved,
            "bar": row.bar, "relative": row.relative, "there": row.there.as_ref().map(at),
            "most_model_solves": row.most_solves, "end": at(&row.end), "most_model_solves_to_end": row.most_solves_to_end,
        })
    });
    json!({"rows": rows.collect::<Vec<_>>()})
}
