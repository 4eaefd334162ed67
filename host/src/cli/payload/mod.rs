//! `softlimb payload`: what a limb pushes and carries, and bundles designed for forces.

mod estimate;
mod problem;
mod report;
mod scene;
mod track;

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::kept::read;
use super::{Failure, Outcome};
use softlimb_design::bundle::{Effort, ForceProblem};

/// What a limb can push and carry in its poses, and bundles designed for wanted forces, eq. (18) of the paper
#[derive(Args)]
#[command(
    group = ArgGroup::new("question").required(true).multiple(true).args(["scene", "problem"]),
    after_help = "Examples:\n  softlimb payload scenes/pick-and-place-a.toml --svg push.svg\n  softlimb payload scenes/loaded/carry-hanging.toml --track 5,10,15,20\n  softlimb payload scenes/loaded/carry-hanging.toml --estimate tips.csv\n  softlimb payload --problem forces.json --json\n\n\
                  Terms, limits and the format of problems: docs/payload.md"
)]
pub(super) struct Payload {
    /// The scene
    #[arg(conflicts_with = "problem")]
    scene: Option<PathBuf>,
    /// Direction of the load at the tip, in the scene's frame
    #[arg(
        long,
        value_name = "X,Y,Z",
        requires = "scene",
        value_delimiter = ',',
        num_args = 1,
        default_value = "0,0,-1",
        allow_hyphen_values = true
    )]
    direction: Vec<f64>,
    /// Rings in each module that keep its actuators together
    #[arg(long, value_name = "N", requires = "scene", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100))]
    spacers: u32,
    /// Share of the load that a bay buckles at which the push of an actuator may reach
    #[arg(long, value_name = "SHARE", requires = "scene", default_value_t = 0.5)]
    buckling_share: f64,
    /// Draw the push of four designs against pressure
    #[arg(long, value_name = "FILE", requires = "scene")]
    svg: Option<PathBuf>,
    /// Run the scene with these loads at the tip, N: how far the tip is off its goals
    #[arg(long, value_name = "N,N,...", requires = "scene", value_delimiter = ',', num_args = 1)]
    track: Vec<f64>,
    /// Runs of each kind that are counted
    #[arg(long, value_name = "N", requires = "track", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// Rehearsals that are looked at before the taught runs
    #[arg(long, value_name = "N", requires = "track", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100))]
    rehearsals: u32,
    /// With --track of one load: write where a camera sees the tip at the ends of the phases without and with it, for --estimate
    #[arg(long, value_name = "FILE", requires = "track")]
    tips: Option<PathBuf>,
    /// Standard deviation of a coordinate that the camera adds, mm
    #[arg(long, value_name = "MM", requires = "tips", default_value_t = 0.2)]
    camera: f64,
    /// Find the mass on the tip from where the tip was seen without and with it, a CSV file
    #[arg(long, value_name = "FILE", requires = "scene", conflicts_with_all = ["track", "svg"])]
    estimate: Option<PathBuf>,
    /// What the stiffness of the limb may be off by, %, as far as the interval of the estimate goes
    #[arg(long, value_name = "PERCENT", requires = "estimate", default_value_t = 10.0)]
    stiffness_error: f64,
    /// The problem, a JSON file
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// Seed of the starts after the first, which is the middle of the bounds. With --track, of
    /// what the limb is [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Payload {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        if let Some(file) = &self.scene {
            return match (&self.estimate, &self.track[..]) {
                (Some(table), _) => estimate::run(self, file, table),
                (None, []) => scene::run(self, file),
                (None, loads_n) => track::run(self, file, loads_n),
            };
        }
        let problem = self.problem.as_ref().map(|file| {
            let complain = |error| Failure::new(format!("{}: {error}", file.display()));
            ForceProblem::read(&read(file)?).map_err(complain)
        });
        match problem.transpose()? {
            Some(problem) => problem::run(self, &problem),
            None => Err(Failure::new("give a scene or --problem FILE")),
        }
    }

    fn effort(&self) -> Effort {
        Effort { seed: self.seed.unwrap_or(Effort::default().seed), ..Effort::default() }
    }
}
