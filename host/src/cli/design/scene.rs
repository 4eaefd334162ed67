//! `softlimb design SCENE`: the scene with a limb that does what it asks.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

use indicatif::ProgressBar;
use serde::Serialize;

use super::problem::table;
use crate::cli::kept::read;
use crate::cli::{Failure, Outcome, note, say};
use crate::design::Limb;
use crate::design::brief::{BriefError, Tasked, leads_the_tip, redesigned_limb, redesigned_targets, targets, task};
use crate::design::fit::{Answer, Problem};
use crate::design::path::{self, Candidate, Choice, Choosing, Effort};
use crate::fem::write_whole;
use crate::motion;
use crate::scene::{self, Redesign, RedesignedTarget, Scene};

/// What is printed with `--json`.
#[derive(Serialize)]
struct Printed<'a, T> {
    /// The design file.
    file: &'a Path,
    /// What was found.
    answer: &'a T,
    /// The limbs it was chosen from, best first; empty where there was no choice.
    list: Vec<&'a Candidate>,
}

/// Where the design goes, and how.
pub(super) struct Order<'a> {
    pub(super) file: &'a Path,
    pub(super) out: Option<&'a Path>,
    pub(super) json: bool,
    pub(super) seed: u64,
    pub(super) pick: usize,
    pub(super) resume: Option<&'a Path>,
    pub(super) threads: Option<usize>,
}

impl Order<'_> {
    /// Designs the limb of a scene and writes the scene with it.
    pub(super) fn run(&self, solve: impl Fn(&Problem) -> Result<Answer, Failure>) -> Result<Outcome, Failure> {
        let scene = scene::load(self.file)?;
        if !leads_the_tip(&scene) {
            let answer = solve(&targets(&scene)?)?;
            let (modules, targets) = redesigned_targets(&scene, &answer);
            let file = self.write(&scene, &modules, Some(&targets))?;
            self.say(&file, &answer, Vec::new(), || table(&answer))?;
            return self.judge(
                &file,
                answer.status == "reached",
                "not every target is reached: see the differences above",
            );
        }
        let tasked = task(&scene)?;
        match scene.design().and_then(|design| design.choice.as_ref()) {
            None => {
                let effort = Effort { seed: self.seed, ..Effort::default() };
                let found = path::design(&tasked.task, &tasked.spaces, &effort).map_err(Failure::new)?;
                self.finish(&scene, &tasked, &found, Vec::new())
            }
            Some(choice) => {
                let choice = self.choose(&tasked, [choice.modules_min, choice.modules_max])?;
                let list = choice.pareto();
                let picked = list.get(self.pick - 1).ok_or_else(|| {
                    Failure::new(format!("--pick {} is not allowed: the list has {} limbs", self.pick, list.len()))
                })?;
                self.finish(&scene, &tasked, picked, list.clone())
            }
        }
    }

    /// Searches every order of motions, from where an earlier search ended.
    fn choose(&self, tasked: &Tasked, modules: [usize; 2]) -> Result<Choice, Failure> {
        let threads = self.threads.or_else(|| available_parallelism().ok().map(usize::from)).unwrap_or(1);
        let choosing = Choosing { modules, seed: self.seed, threads, ..Choosing::default() };
        let so_far = match self.resume.filter(|file| file.exists()) {
            None => Choice::default(),
            Some(file) => serde_json::from_str(&read(file)?)
                .map_err(|error| Failure::new(format!("{}: this is no search to resume: {error}", file.display())))?,
        };
        let bar = ProgressBar::new(1).with_message("orders searched");
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
        let Some(file) = self.resume else { return Ok(()) };
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
        self.say(&file, found, list.clone(), text)?;
        let why = found.shortfall.as_ref().map(ToString::to_string).unwrap_or_default();
        self.judge(&file, found.does_it(), &why)
    }

    /// Writes the scene with other modules.
    fn write(
        &self,
        scene: &Scene,
        modules: &[Redesign],
        targets: Option<&[Vec<RedesignedTarget>]>,
    ) -> Result<PathBuf, Failure> {
        let file = self.out.map_or_else(|| beside(self.file), Path::to_owned);
        let text = scene::redesigned(scene, modules, targets).map_err(Failure::new)?;
        write_whole(&file, &text).map_err(Failure::new)?;
        Ok(file)
    }

    fn say<T: Serialize>(
        &self,
        file: &Path,
        answer: &T,
        list: Vec<&Candidate>,
        text: impl Fn() -> String,
    ) -> Result<(), Failure> {
        if self.json {
            let printed = Printed { file, answer, list };
            return say(&serde_json::to_string(&printed).map_err(Failure::new)?);
        }
        say(&text())
    }

    /// Whether the design does what was asked, and whether its file can be run: the planner of `run` has the last word.
    fn judge(&self, file: &Path, reached: bool, why: &str) -> Result<Outcome, Failure> {
        note(&format!("design: {}", file.display()));
        if !reached {
            note(&format!("warning: {why}"));
        }
        let designed = scene::load(file)?;
        let limb = Limb::new(&designed)?;
        match motion::plan(&designed, &limb) {
            Ok(_) if reached => Ok(Outcome::Done),
            Err(error) if reached => Err(error.into()),
            _ => Ok(Outcome::DoneWithWarnings),
        }
    }
}

/// The limbs to pick from.
fn pareto(list: &[&Candidate]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "{:>4}  {:<34} {:>10} {:>8} {:>8} {:>13} {:>7}\n",
        "pick", "modules", "error, mm", "kPa", "kg", "clearance, mm", "air, L"
    );
    for (index, limb) in list.iter().enumerate() {
        let figures = &limb.figures;
        let names: Vec<_> = limb.modules.iter().map(|module| module.name.as_str()).collect();
        let spare = figures.spare_clearance_m.map_or("-".into(), |spare| format!("{:.2}", spare * 1e3));
        let _ = writeln!(
            text,
            "{:>4}  {:<34} {:>10.4} {:>8.1} {:>8.2} {spare:>13} {:>7.2}",
            index + 1,
            names.join(", "),
            figures.tip_error_rms_m * 1e3,
            figures.pressure_max_pa * 1e-3,
            figures.mass_kg,
            figures.air_m3 * 1e3
        );
    }
    text + "\n"
}

/// `elbow.toml` becomes `elbow-designed.toml`.
fn beside(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    scene.with_file_name(format!("{stem}-designed.toml"))
}

/// A limb as text. Writing to a string cannot fail.
fn limb(found: &Candidate) -> String {
    let mut text = String::new();
    let figures = &found.figures;
    let _ = writeln!(
        text,
        "{}: tip error {:.4} mm RMS, {:.4} mm at most; highest pressure {:.1} kPa; mass {:.2} kg; air {:.2} L",
        if found.does_it() { "reached" } else { "nearest found" },
        figures.tip_error_rms_m * 1e3,
        figures.tip_error_max_m * 1e3,
        figures.pressure_max_pa * 1e-3,
        figures.mass_kg,
        figures.air_m3 * 1e3
    );
    if let Some(spare) = figures.spare_clearance_m {
        let _ = writeln!(text, "least clearance beyond what is asked: {:.2} mm", spare * 1e3);
    }
    for module in &found.modules {
        let _ = writeln!(
            text,
            "\n{}: inner radius {:.4} mm, outer radius {:.4} mm, length {:.3} mm, fiber angle {:.3} deg, mount angle {:.2} deg, up to {:.1} kPa",
            module.name,
            module.inner_radius_m * 1e3,
            module.outer_radius_m * 1e3,
            module.length_m * 1e3,
            module.fiber_angle_rad.to_degrees(),
            module.mount_angle_rad.to_degrees(),
            module.pressure_cap_pa * 1e-3
        );
    }
    let _ = writeln!(
        text,
        "\n{:>9} {:>12} {:>14} {:>14}  kPa",
        "way-point", "error, mm", "clearance, mm", "on the way, mm"
    );
    for (index, point) in found.way_points.iter().enumerate() {
        let millimetres = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.2}", value * 1e3));
        let pressures: Vec<_> = point.pressure_pa.iter().map(|pressure| format!("{:.2}", pressure * 1e-3)).collect();
        let _ = writeln!(
            text,
            "{:>9} {:>12.4} {:>14} {:>14}  {}",
            index + 1,
            point.tip_error_m * 1e3,
            millimetres(point.clearance_m),
            millimetres(point.move_clearance_m),
            pressures.join(", ")
        );
    }
    text
}

impl From<BriefError> for Failure {
    fn from(error: BriefError) -> Self {
        match error {
            BriefError::Scene(error) => error.into(),
            BriefError::Task(error) => Self::new(error),
        }
    }
}
