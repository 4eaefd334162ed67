//! The comparison in numbers: a line for each group and method, and every point as tab-separated values.

use std::fmt::Write;

use super::{Comparison, Method, Point, Run};
use softlimb_numerics::statistics::percentile;

/// The lines a page's table stands between.
pub const PLACE: [&str; 2] = ["<!-- written by softlimb design --compare -->", "<!-- end -->"];

/// A method on the problems of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The group.
    pub group: String,
    /// The method.
    pub method: Method,
    /// Problems of the group.
    pub problems: usize,
    /// What counts as solved: at most this objective, or above the least known one by at most this share of it.
    pub bar: f64,
    /// Whether `bar` is a share.
    pub relative: bool,
    /// Problems that were solved.
    pub solved: usize,
    /// Where those were solved, each figure the median: the first point below the bar.
    pub there: Option<Point>,
    /// Most model solves to there.
    pub most_solves: Option<u64>,
    /// At the end, each figure the median.
    pub end: Point,
    /// Most model solves to the end.
    pub most_solves_to_end: u64,
}

/// The median; of an even number the lower of the two in the middle.
fn median<T: Copy + PartialOrd>(values: impl Iterator<Item = T>) -> Option<T> {
    percentile(values, 50)
}

fn medians(points: &[Point]) -> Option<Point> {
    Some(Point {
        evaluations: median(points.iter().map(|point| point.evaluations))?,
        solves: median(points.iter().map(|point| point.solves))?,
        seconds: median(points.iter().map(|point| point.seconds))?,
        objective: median(points.iter().map(|point| point.objective))?,
    })
}

impl Comparison {
    /// A line for each group and method.
    pub fn rows(&self) -> Vec<Row> {
        let of = |(group, method)| self.row(group, method);
        let pairs = self.groups().into_iter().flat_map(|group| Method::ALL.map(|method| (group, method)));
        pairs.filter_map(of).collect()
    }

    fn row(&self, group: &str, method: Method) -> Option<Row> {
        let runs: Vec<&Run> = self.runs.iter().filter(|run| run.group == group && run.method == method).collect();
        let bar = self.bar(group);
        let first = |run: &&Run| run.points.iter().find(|point| self.left(run, point) <= bar).copied();
        let there: Vec<Point> = runs.iter().filter_map(first).collect();
        let left = |run: &&Run| run.points.last().map(|point| Point { objective: self.left(run, point), ..*point });
        let ends: Vec<Point> = runs.iter().filter_map(left).collect();
        Some(Row {
            group: group.to_owned(),
            method,
            problems: runs.len(),
            bar,
            relative: !self.reachable(group),
            solved: there.len(),
            there: medians(&there),
            most_solves: there.iter().map(|point| point.solves).max(),
            end: medians(&ends)?,
            most_solves_to_end: ends.iter().map(|point| point.solves).max()?,
        })
    }

    /// The lines as Markdown. Writing to a string cannot fail.
    pub fn markdown(&self) -> String {
        let mut text = String::from(
            "| problems | method | solved | evaluations | model solves, median / most | time | at the end | evaluations | model solves, median / most | time |\n\
             | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: |\n",
        );
        for row in self.rows() {
            let solved = format!("{} of {}", row.solved, row.problems);
            let there = row.there.map_or_else(|| "- | - | -".to_owned(), |at| cells(&at, row.most_solves));
            let left = if row.relative {
                format!("least + {:.1e}", row.end.objective)
            } else {
                format!("{:.1e}", row.end.objective)
            };
            let end = cells(&row.end, Some(row.most_solves_to_end));
            let _ = writeln!(text, "| {} | {} | {solved} | {there} | {left} | {end} |", row.group, row.method.name());
        }
        text
    }

    /// How many times the model solves of the projection, to its confirmed answer and at worst, the swarm needs to solve what it solves, at
    /// best: for each group where it solves any.
    pub fn ratios(&self) -> Vec<(String, f64)> {
        let ratio = |group: &str| {
            let solves =
                |run: &Run| run.points.iter().find(|point| self.left(run, point) <= self.bar(group)).map(|p| p.solves);
            let of = |method: Method| self.runs.iter().filter(move |run| run.group == group && run.method == method);
            let swarm = of(Method::Swarm).filter_map(solves).min()?;
            let ours = of(Method::Projection).filter_map(|run| run.points.last()).map(|point| point.solves).max()?;
            Some((group.to_owned(), swarm as f64 / ours as f64))
        };
        self.groups().into_iter().filter_map(ratio).collect()
    }

    /// Every point as tab-separated values.
    pub fn tsv(&self) -> String {
        let mut text = String::from("problems\tseed\tmethod\tevaluations\tmodel solves\tseconds\tobjective\n");
        for run in &self.runs {
            for Point { evaluations, solves, seconds, objective } in &run.points {
                let (group, seed, method) = (&run.group, run.seed, run.method.name());
                let _ = writeln!(
                    text,
                    "{group}\t{seed}\t{method}\t{evaluations}\t{solves}\t{seconds:.3e}\t{objective:.6e}"
                );
            }
        }
        text
    }
}

fn cells(point: &Point, most: Option<u64>) -> String {
    let most = most.map_or_else(|| "-".to_owned(), |most| most.to_string());
    format!("{} | {} / {most} | {}", point.evaluations, point.solves, duration(point.seconds))
}

/// A time with three digits.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.3} ms", s * 1e3),
        s => format!("{s:.1} s"),
    }
}
