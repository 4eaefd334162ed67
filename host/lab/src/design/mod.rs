//! The search and the swarm on the same problems: the objective against evaluations, model solves and time.

mod command;
mod judge;
mod loaded;
mod picture;
mod swarm;
mod table;

pub(crate) use command::Design;
pub use picture::picture;
pub use swarm::{Faces, Swarm, swarm};
pub use table::{PLACE, Row};

use softlimb_design::actuators::{Budget, DesignError, Problem, Progress, solve_watched};

/// An objective as small counts as zero: a problem that has one can be reached.
const REACHABLE: f64 = 1e-12;
/// Where a reachable problem counts as solved.
const SOLVED: f64 = 1e-8;
/// As near to the least known objective, relatively, a problem that cannot be reached counts as solved.
const NEAR: f64 = 1e-6;

/// A problem to compare the methods on.
pub struct Query {
    /// Problems of one group share a chart and a line of the table.
    pub group: String,
    /// Seed of both methods.
    pub seed: u64,
    /// The problem.
    pub problem: Problem,
}

/// How the problem was solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`solve`](softlimb_design::actuators::solve).
    Projection,
    /// [`swarm`](swarm()).
    Swarm,
}

impl Method {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Projection, Self::Swarm];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Projection => "projection",
            Self::Swarm => "pso",
        }
    }
}

/// How far a method was after some work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Objectives and Jacobians so far.
    pub evaluations: u64,
    /// Equilibria solved for so far; those of the swarm for limit points are left out.
    pub solves: u64,
    /// Time so far, s.
    pub seconds: f64,
    /// The least objective so far.
    pub objective: f64,
}

/// One method on one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// As in the [`Query`].
    pub group: String,
    /// As in the [`Query`].
    pub seed: u64,
    /// The method.
    pub method: Method,
    /// Every improvement, then the end. That of the projection is the confirmed answer, with all that it has cost.
    pub points: Vec<Point>,
}

/// Both methods on some problems.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Both runs of each problem in turn.
    pub runs: Vec<Run>,
}

impl Comparison {
    /// Runs both methods on a problem; `clock` tells the time, s. The seed of `settings` is not used.
    ///
    /// # Errors
    /// As [`solve`](softlimb_design::actuators::solve).
    pub fn add(&mut self, question: &Query, settings: &Swarm, clock: &dyn Fn() -> f64) -> Result<(), DesignError> {
        for method in Method::ALL {
            let mut points = Vec::new();
            let begin = clock();
            let point = |progress: &Progress| Point {
                evaluations: progress.counts.evaluations,
                solves: progress.counts.solves,
                seconds: clock() - begin,
                objective: progress.objective,
            };
            let mut watch = |progress: &Progress| {
                if points.last().is_none_or(|last: &Point| progress.objective < last.objective) {
                    points.push(point(progress));
                }
            };
            match method {
                Method::Projection => {
                    let effort = Budget { seed: question.seed, ..Budget::default() };
                    let answer = solve_watched(&question.problem, &effort, &mut watch)?;
                    points.push(point(&Progress { objective: answer.objective, counts: answer.cost }));
                }
                Method::Swarm => {
                    let settings = Swarm { seed: question.seed, ..*settings };
                    let mut end = None;
                    let told = |progress: &Progress| {
                        watch(progress);
                        end = Some(*progress);
                    };
                    swarm(&question.problem, &settings, told)?;
                    points.extend(end.as_ref().map(point));
                }
            }
            let (group, seed) = (question.group.clone(), question.seed);
            self.runs.push(Run { group, seed, method, points });
        }
        Ok(())
    }

    /// Groups in their order.
    pub fn groups(&self) -> Vec<&str> {
        let mut groups: Vec<&str> = Vec::new();
        for run in &self.runs {
            if !groups.contains(&run.group.as_str()) {
                groups.push(&run.group);
            }
        }
        groups
    }

    /// The least objective that is known for the problem of a run.
    fn least(&self, run: &Run) -> f64 {
        let same = self.runs.iter().filter(|other| other.group == run.group && other.seed == run.seed);
        same.filter_map(|run| run.points.last()).map(|point| point.objective).fold(f64::INFINITY, f64::min)
    }

    /// Whether the problems of a group have objectives of zero.
    fn reachable(&self, group: &str) -> bool {
        self.runs.iter().filter(|run| run.group == group).all(|run| self.least(run) <= REACHABLE)
    }

    /// What is left of a run at a point: the objective where a problem can be reached, what it is above the least known one otherwise.
    fn left(&self, run: &Run, point: &Point) -> f64 {
        let least = self.least(run);
        if self.reachable(&run.group) { point.objective } else { (point.objective - least) / least }
    }

    /// What must be left at most for a problem of a group to count as solved.
    fn bar(&self, group: &str) -> f64 {
        if self.reachable(group) { SOLVED } else { NEAR }
    }
}
