//! `softlimb design limb`: the scene with a limb that meets its targets.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::actuators::{Search, short, table};
use super::candidates::{deformed, limb, pareto};
use crate::cli::shared::{about, bar, read, show, threads, with_rows};
use crate::cli::{Failure, Outcome, note, say};
use crate::results::bend::{PrintedBend, of_limb, rows};
use softlimb_chart::labelled;
use softlimb_design::from_scene::{
    BriefError, Tasked, design_to_run, leads_the_tip, redesigned_limb, redesigned_targets, redesigned_totals, targets,
    task, totals, with_ends,
};
use softlimb_design::synthesis as path;
use softlimb_design::synthesis::{Budget, Candidate, Choice, Choosing};
use softlimb_files::write_whole;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::{Redesign, RedesignedTarget, Scene, SceneError};

/// Output with `--json`.
#[derive(Serialize)]
struct Printed<'a, T> {
    /// Whether the simulated limb of the scene carries neither its own weight nor a payload.
    weightless: bool,
    /// The design file.
    file: &'a Path,
    /// Result.
    answer: &'a T,
    /// The limbs it was chosen from, best first; empty where there was no choice.
    list: Vec<&'a Candidate>,
    /// Effects on this limb that the models leave out.
    warnings: Vec<String>,
    /// The models of the bends of the limb found, one a module; empty where it is no scene.
    bends: Vec<Option<PrintedBend>>,
}

/// Design the limb of a scene: with target deformations by eq. (14), with way-points of the tip by limb synthesis
#[derive(Args)]
#[command(after_help = "What a scene may leave open: docs/guide/design-a-limb.md\n\n\
                        Example: softlimb design limb scenes/open/group-a.toml --out group-a.toml")]
pub(super) struct LimbDesign {
    /// The scene file
    scene: PathBuf,
    /// The scene with the limb found [default: beside the scene, NAME-designed.toml]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The limb of the list to write, from 1, if the motions and their order are free
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pick: u32,
    /// Keep the search of motions and their order in this file, and resume the one it holds
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Threads of the search of motions and their order; the answer does not depend on it [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=64))]
    threads: Option<u16>,
    #[command(flatten)]
    search: Search,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl LimbDesign {
    /// Designs the limb of a scene and writes the scene with it.
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        if !leads_the_tip(&scene) && scene.modules().iter().any(|module| !module.segments.is_empty()) {
            return self.by_totals(&scene);
        }
        if !leads_the_tip(&scene) {
            let answer = self.search.solve(&targets(&scene)?)?;
            let (modules, targets) = redesigned_targets(&scene, &answer);
            let file = self.write(&scene, &modules, Some(&targets))?;
            let printed = with_ends(&scene, &answer);
            let designed = Designed::new(&file, short(&answer));
            self.say(&scene, &file, &printed, (Vec::new(), &designed), || table(&printed))?;
            return self.judge(
                &file,
                designed,
                answer.status == "reached",
                "not every target is reached: see the differences above",
            );
        }
        if !scene.weightless() {
            return super::loaded::design(&scene, &self.file_out(), self.search.seed, self.json);
        }
        let tasked = task(&scene)?;
        match scene.design().and_then(|design| design.choice.as_ref()) {
            None => {
                let effort = Budget { seed: self.search.seed, ..Budget::default() };
                let plan = |limb: &Candidate| self.via_points(&scene, &tasked, limb);
                let found = design_to_run(&tasked.task, &tasked.spaces, &effort, plan).map_err(Failure::new)?;
                let outcome = self.finish(&scene, &tasked, &found.limb, Vec::new());
                if let Some(count) = found.via_points.filter(|count| *count > 0) {
                    note(&format!(
                        "moves: not all of them are straight; the planner leads them through {count} via points"
                    ));
                }
                if found.refused > 0 {
                    note(&format!(
                        "beside it {} limbs that reach the way-points were found, for which the planner found no way",
                        found.refused
                    ));
                }
                outcome
            }
            Some(choice) => {
                let choice = self.choose(&tasked, [choice.modules_min, choice.modules_max])?;
                let list = choice.pareto();
                let picked = list.get(self.pick as usize - 1).ok_or_else(|| {
                    Failure::new(format!("--pick {} is not allowed: the list has {} limbs", self.pick, list.len()))
                })?;
                self.finish(&scene, &tasked, picked, list.clone())
            }
        }
    }

    /// Designs a limb with modules of several segments for targets.
    fn by_totals(&self, scene: &Scene) -> Result<Outcome, Failure> {
        let tasked = totals(scene)?;
        let effort = Budget { seed: self.search.seed, ..Budget::default() };
        let found = path::design(&tasked.task, &tasked.spaces, &effort).map_err(Failure::new)?;
        let targets = redesigned_totals(scene, &tasked, &found);
        let file = self.write(scene, &redesigned_limb(scene, &tasked, &found), Some(&targets))?;
        let designed = Designed::new(&file, Vec::new());
        self.say(scene, &file, &found, (Vec::new(), &designed), || deformed(scene, &tasked, &found))?;
        self.judge(&file, designed, found.does_it(), "not every target is reached: see the differences above")
    }

    /// Searches every order of motions, from where an earlier search ended.
    fn choose(&self, tasked: &Tasked, modules: [usize; 2]) -> Result<Choice, Failure> {
        let threads = threads(self.threads);
        let choosing = Choosing { modules, seed: self.search.seed, threads, ..Choosing::default() };
        let so_far = match self.resume.as_deref().filter(|file| file.exists()) {
            None => Choice::default(),
            Some(file) => serde_json::from_str(&read(file)?)
                .map_err(|error| about(file)(&format!("the file holds no search to resume: {error}")))?,
        };
        let bar = bar(1, "orders searched");
        let observe = |choice: &Choice| {
            bar.set_length(choice.total as u64);
            bar.set_position(choice.searched.len() as u64);
            self.keep(choice).is_ok()
        };
        let choice = path::choose(&tasked.task, &tasked.spaces, &choosing, so_far, &observe).map_err(Failure::new)?;
        bar.finish_and_clear();
        // What cannot be kept was not to be searched in vain: it ended after the first order.
        self.keep(&choice)?;
        Ok(choice)
    }

    /// Keeps a choice where that is wanted.
    fn keep(&self, choice: &Choice) -> Result<(), Failure> {
        let Some(file) = &self.resume else { return Ok(()) };
        write_whole(file, &serde_json::to_string(choice).map_err(Failure::new)?).map_err(Failure::new)
    }

    fn finish(
        &self,
        scene: &Scene,
        tasked: &Tasked,
        found: &Candidate,
        list: Vec<&Candidate>,
    ) -> Result<Outcome, Failure> {
        let file = self.write(scene, &redesigned_limb(scene, tasked, found), None)?;
        let text = || pareto(&list) + &limb(found);
        let designed = Designed::new(&file, Vec::new());
        self.say(scene, &file, found, (list.clone(), &designed), text)?;
        let why = found.shortfall.as_ref().map(ToString::to_string).unwrap_or_default();
        self.judge(&file, designed, found.does_it(), &why)
    }

    /// Number of via points that the planner needs for a limb; `None` where it refuses it.
    fn via_points(&self, scene: &Scene, tasked: &Tasked, limb: &Candidate) -> Option<usize> {
        let text = scene::redesigned(scene, &redesigned_limb(scene, tasked, limb), None).ok()?;
        // Named as the file will be: what a scene reads beside itself is looked for there.
        let designed = scene::parse(&text, &self.file_out().display().to_string()).ok()?;
        let plan = motion::plan(&designed, &Limb::new(&designed).ok()?).ok()?;
        Some(plan.phases.iter().map(|phase| phase.via_points).sum())
    }

    fn file_out(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| beside(&self.scene))
    }

    /// Writes the scene with other modules.
    fn write(
        &self,
        scene: &Scene,
        modules: &[Redesign],
        targets: Option<&[Vec<RedesignedTarget>]>,
    ) -> Result<PathBuf, Failure> {
        let file = self.file_out();
        let text = scene::redesigned(scene, modules, targets).map_err(Failure::new)?;
        write_whole(&file, &text).map_err(Failure::new)?;
        Ok(file)
    }

    fn say<T: Serialize>(
        &self,
        scene: &Scene,
        file: &Path,
        answer: &T,
        (list, designed): (Vec<&Candidate>, &Result<Designed, SceneError>),
        text: impl Fn() -> String,
    ) -> Result<(), Failure> {
        if self.json {
            // A design that is no scene is refused where it is judged.
            let designed = designed.as_ref().ok();
            let warnings = designed.map_or_else(Vec::new, |designed| designed.warnings.clone());
            let bends = designed.map_or_else(Vec::new, |designed| of_limb(&designed.limb));
            let printed = Printed { weightless: scene.weightless(), file, answer, list, warnings, bends };
            return show(true, &printed, String::new);
        }
        let bends = designed.as_ref().map_or_else(|_| Vec::new(), |designed| rows(&designed.limb));
        say(&with_rows(format!("{}\n{}", labelled(scene.name(), scene.weightless()), text()), &bends))
    }

    /// Whether the design does what was asked, and whether its file can be run: the planner of `run` has the last word.
    fn judge(
        &self,
        file: &Path,
        designed: Result<Designed, SceneError>,
        reached: bool,
        why: &str,
    ) -> Result<Outcome, Failure> {
        note(&format!("design: {}", file.display()));
        if !reached {
            note(&format!("warning: {why}"));
        }
        let Designed { scene, plan, warnings, .. } = designed?;
        if !scene.weightless() {
            note("the targets are designed without weight: the plan judges the limb under its load");
        }
        let outcome = super::windings(&scene, &warnings);
        match plan {
            Ok(()) if reached => Ok(outcome),
            Err(error) if reached => Err(error.into()),
            _ => Ok(Outcome::DoneWithWarnings),
        }
    }
}

/// A designed scene with its warnings, and whether it has a plan.
struct Designed {
    scene: Scene,
    limb: Limb,
    plan: Result<(), SceneError>,
    warnings: Vec<String>,
}

impl Designed {
    /// Of a file; `warnings` are those of the search.
    fn new(file: &Path, mut warnings: Vec<String>) -> Result<Self, SceneError> {
        let scene = scene::load(file)?;
        let limb = Limb::new(&scene)?;
        let plan = motion::plan(&scene, &limb).map(drop);
        warnings.extend(limb.winding_warnings(&scene));
        Ok(Self { scene, limb, plan, warnings })
    }
}

/// `elbow.toml` becomes `elbow-designed.toml`.
fn beside(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    scene.with_file_name(format!("{stem}-designed.toml"))
}

impl From<BriefError> for Failure {
    fn from(error: BriefError) -> Self {
        match error {
            BriefError::Scene(error) => error.into(),
            BriefError::Task(error) => Self::new(error),
        }
    }
}
