//! Limbs designed under load: several seeds a scene, seeded tasks, and the search beside CMA-ES.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::judge::answer;
use serde::Serialize;
use softlimb::cli::{Failure, refused};
use softlimb::scene::Scene;
use softlimb_design::from_scene::{LoadedDesign, loaded_design};
use softlimb_design::loaded::{
    ActiveBound, ConfirmedPose, Effort, Evaluation, Found, Lack, active_bounds, search, search_to_run, seeded,
};

/// Time that a design may take, s.
const IN_TIME_S: f64 = 60.0;
/// The reserve of CMA-ES rises by this.
const RAISE: f64 = 0.05;

/// Processor time of all threads of this process, s; 0 where the system does not have it.
pub(super) fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    // Fields 14 and 15 of proc(5), in ticks of 10 ms; the name is field 2.
    after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// A scene with its search.
pub(super) struct Loaded {
    scene: Scene,
    pub(super) design: LoadedDesign,
}

impl Loaded {
    pub(super) fn read(file: &Path) -> Result<Self, Failure> {
        let scene = softlimb::scene::load(file)?;
        let design = loaded_design(&scene)?;
        Ok(Self { scene, design })
    }
}

/// A search.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Searched {
    scene: String,
    seed: u64,
    confirmed: bool,
    /// What `softlimb check` says of the scene with the limb; `None` where nothing, or where it is not asked.
    refused: Option<String>,
    /// Limbs before this one that it refused.
    refused_before: usize,
    reserve: f64,
    tip_error_mm: f64,
    spare_mm: Option<f64>,
    tilt_deg: f64,
    load_factor: f64,
    stiffness_n_per_m: f64,
    sag_share: f64,
    buckling_margin: f64,
    pressure_share: f64,
    mass_kg: f64,
    limbs: usize,
    processor_s: f64,
    wall_s: f64,
}

/// A search; `planned` where the planner has the last word.
fn searched(scene: &Loaded, seed: u64, effort: Effort, planned: bool) -> Option<(Searched, Found)> {
    let design = &scene.design;
    let (begin, used_s) = (Instant::now(), processor_s());
    let effort = Effort { seed, ..effort };
    let (task, space) = (&design.task, &design.space);
    let refusal = |limb: &Evaluation| if planned { refused(&scene.scene, design, limb) } else { None };
    let found = search_to_run(task, space, &space.first_guess(), &effort, &refusal, &|| false)?;
    let (wall_s, processor_s) = (begin.elapsed().as_secs_f64(), processor_s() - used_s);
    let poses = &found.confirmed;
    let most = |of: fn(&ConfirmedPose) -> f64| poses.iter().map(of).fold(0.0, f64::max);
    let least = |of: fn(&ConfirmedPose) -> f64| poses.iter().map(of).fold(f64::INFINITY, f64::min);
    let row = Searched {
        scene: scene.scene.name().to_owned(),
        seed,
        confirmed: found.reached,
        refused: found.refused.clone(),
        refused_before: found.refused_before,
        reserve: if found.reached { found.by.reserve } else { 0.0 },
        tip_error_mm: 1e3 * most(|pose| pose.tip_error_m),
        spare_mm: poses.iter().filter_map(|pose| pose.spare_m).reduce(f64::min).map(|spare_m| 1e3 * spare_m),
        tilt_deg: most(|pose| pose.tilt_rad).to_degrees(),
        load_factor: least(|pose| pose.load_factor),
        stiffness_n_per_m: least(|pose| pose.stiffness_n_per_m),
        sag_share: most(|pose| pose.sag_m) / found.evaluation.length_m,
        buckling_margin: least(|pose| pose.buckling_margin),
        pressure_share: most(|pose| pose.pressure_share),
        mass_kg: found.evaluation.mass_kg,
        limbs: found.evaluations,
        processor_s,
        wall_s,
    };
    Some((row, found))
}

/// Searches of several seeds.
pub(super) fn seeds(scenes: &[Loaded], seeds: impl Iterator<Item = u64> + Clone) -> Vec<Searched> {
    let of = |scene| seeds.clone().filter_map(move |seed| Some(searched(scene, seed, Effort::default(), true)?.0));
    scenes.iter().flat_map(of).collect()
}

/// The searches as Markdown. Writing to a string cannot fail.
pub(super) fn seeds_text(rows: &[Searched]) -> String {
    let mut text = String::from(
        "| scene | seed | confirmed | kept by the plan | reserve, % | tip error, mm | clearance beyond 5.2 mm, mm | tilt, deg | load factor | stiffness, N/m | sag, % | buckling | pressure, % | mass, kg | limbs | processor time, s | elapsed, s |\n\
         | --- | --: | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.1} | {:.3} | {} | {:.1} | {:.2} | {:.1} | {:.1} | {:.1} | {:.1} | {:.2} | {} | {:.1} | {:.1} |",
            row.scene,
            row.seed,
            if row.confirmed { "yes" } else { "no" },
            match (&row.refused, row.refused_before) {
                (Some(why), _) => format!("no: {why}"),
                (None, 0) => "yes".to_owned(),
                (None, before) => format!("yes, after {before} others"),
            },
            100.0 * row.reserve,
            row.tip_error_mm,
            row.spare_mm.map_or("-".to_owned(), |spare| format!("{spare:.1}")),
            row.tilt_deg,
            row.load_factor,
            row.stiffness_n_per_m,
            100.0 * row.sag_share,
            row.buckling_margin,
            100.0 * row.pressure_share,
            row.mass_kg,
            row.limbs,
            row.processor_s,
            row.wall_s
        );
    }
    let mut scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
    scenes.dedup();
    for scene in scenes {
        let rows: Vec<&Searched> = rows.iter().filter(|row| row.scene == scene).collect();
        let kept: Vec<_> = rows.iter().filter(|row| row.confirmed && row.refused.is_none()).collect();
        let in_time = kept.iter().filter(|row| row.wall_s <= IN_TIME_S).count();
        let most = |of: fn(&Searched) -> f64| rows.iter().map(|row| of(row)).fold(0.0, f64::max);
        let _ = writeln!(
            text,
            "\n{scene}: {} of {} confirmed and kept by the plan, {in_time} of them within {IN_TIME_S:.0} s; most {:.1} s of processor time, {:.1} s elapsed.",
            kept.len(),
            rows.len(),
            most(|row| row.processor_s),
            most(|row| row.wall_s)
        );
    }
    text
}

/// A seeded task.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Task {
    seed: u64,
    confirmed: bool,
    limbs: usize,
    processor_s: f64,
    /// What lacks most, and the bounds that forbid it, where it is not solved.
    lacks: Vec<Lack>,
    bounds: Vec<String>,
}

/// Seeded tasks of a scene's bounds.
pub(super) fn tasks(scene: &Loaded, seeds: impl Iterator<Item = u64>) -> Vec<Task> {
    let space = &scene.design.space;
    let of = |seed: u64| {
        let task = seeded(&scene.design.task, space, seed)?.task;
        let begin_s = processor_s();
        let effort = Effort { seed, raises: 0, ..Effort::default() };
        let found = search(&task, space, &space.first_guess(), &effort, &|| false);
        let processor_s = processor_s() - begin_s;
        let Some(found) = found else {
            return Some(Task {
                seed,
                confirmed: false,
                limbs: 0,
                processor_s,
                lacks: Vec::new(),
                bounds: vec!["nothing stands".to_owned()],
            });
        };
        let (mut lacks, mut bounds) = (Vec::new(), Vec::new());
        if !found.reached {
            lacks = worst(&found.evaluation);
            let of = |bound: ActiveBound| {
                let module = bound.module.map_or(String::new(), |module| format!("{module} "));
                format!(
                    "{module}{} {:.4} to {:.4}: {:.0} % left",
                    bound.name,
                    bound.bound,
                    bound.moved_to,
                    100.0 * bound.left
                )
            };
            bounds = active_bounds(&task, space, &found, &|| false).into_iter().map(of).collect();
        }
        Some(Task { seed, confirmed: found.reached, limbs: found.evaluations, processor_s, lacks, bounds })
    };
    seeds.filter_map(of).collect()
}

/// The tasks in words.
pub(super) fn tasks_text(tasks: &[Task]) -> String {
    let solved = tasks.iter().filter(|task| task.confirmed).count();
    let silent = tasks.iter().filter(|task| !task.confirmed && task.lacks.is_empty() && task.bounds.is_empty()).count();
    let mut times: Vec<f64> = tasks.iter().map(|task| task.processor_s).collect();
    times.sort_by(f64::total_cmp);
    let median_s = times.get(times.len() / 2).copied().unwrap_or(0.0);
    let most_s = times.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "{solved} of {} seeded tasks solved and confirmed, {} answered with what lacks, {silent} silently infeasible; processor time {median_s:.1} s (median), {most_s:.1} s (most).\n",
        tasks.len(),
        tasks.len() - solved - silent
    );
    for task in tasks.iter().filter(|task| !task.confirmed) {
        let lacks: Vec<_> = task
            .lacks
            .iter()
            .map(|lack| format!("{} of pose {} by {:.3}", lack.margin.name(), lack.pose + 1, lack.value))
            .collect();
        let _ = writeln!(text, "\nTask {}: {}. Bounds: {}.", task.seed, lacks.join(", "), task.bounds.join("; "));
    }
    text
}

/// The four margins that lack most.
fn worst(limb: &Evaluation) -> Vec<Lack> {
    let mut lacks: Vec<_> = limb.lacks.iter().copied().filter(|lack| lack.value.abs() > 1e-4).collect();
    lacks.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    lacks.truncate(4);
    lacks
}

/// Times of one method to a limb, s; `None` where it has none.
#[derive(Clone, Copy, Debug)]
struct Times {
    rods_s: Option<f64>,
    tubes_s: Option<f64>,
    reserve: Option<f64>,
}

/// Results of the search and of CMA-ES, a line of Markdown each, and their medians: by `python` with the package cma.
pub(super) fn beside_cma(
    files: &[PathBuf],
    scenes: &[Loaded],
    (python, script): (&Path, &Path),
    seeds: impl Iterator<Item = u64> + Clone,
    times: f64,
) -> Result<String, Failure> {
    let mut text = String::from(
        "| scene | seed | search: every margin by rods, s | confirmed by tubes, s | its reserve, %, after, s | CMA-ES: every margin by rods, s | confirmed by tubes, s | its reserve after the search's time, % |\n\
         | --- | --: | --: | --: | --: | --: | --: | --: |\n",
    );
    let own = std::env::current_exe().map_err(Failure::new)?;
    let mut medians = String::new();
    for (file, scene) in files.iter().zip(scenes) {
        let mut all: Vec<[Times; 2]> = Vec::new();
        for seed in seeds.clone() {
            let of = |raises, by_tubes| {
                let effort = Effort { raises, by_tubes, ..Effort::default() };
                let (row, found) = searched(scene, seed, effort, false)?;
                Some((row.processor_s, found.reached.then_some(found.by.reserve)))
            };
            let time = |found: &Option<(f64, Option<f64>)>| found.and_then(|(s, reserve)| reserve.map(|_| s));
            let [rods, tubes, raised] = [of(0, false), of(0, true), of(Effort::default().raises, true)];
            let seconds = |found: &Option<(f64, Option<f64>)>| found.map_or(0.0, |(s, _)| s);
            let (rods_s, raised_s) = (seconds(&rods), seconds(&raised));
            let search = Times { rods_s: time(&rods), tubes_s: time(&tubes), reserve: raised.and_then(|(_, by)| by) };
            let most_s = raised_s.max(times * rods_s);
            let numbers = [seed.to_string(), raised_s.to_string(), most_s.to_string(), RAISE.to_string()];
            let mut arguments: Vec<OsString> = vec![own.clone().into(), file.into()];
            arguments.extend(numbers.map(OsString::from));
            let answer = answer(python, script, &arguments)?;
            let mut numbers = answer.split_whitespace().map(|word| word.parse::<f64>().ok());
            let mut next = || numbers.next().flatten();
            let cma = Times { rods_s: next(), tubes_s: next(), reserve: next() };
            let or_more = |s: Option<f64>| s.map_or(format!("> {most_s:.0}"), |s| format!("{s:.1}"));
            let percent = |reserve: Option<f64>| reserve.map_or("none".to_owned(), |by| format!("{:.1}", 100.0 * by));
            let _ = writeln!(
                text,
                "| {} | {seed} | {} | {} | {}, {raised_s:.1} | {} | {} | {} |",
                scene.scene.name(),
                search.rods_s.map_or("none".to_owned(), |s| format!("{s:.1}")),
                search.tubes_s.map_or("none".to_owned(), |s| format!("{s:.1}")),
                percent(search.reserve),
                or_more(cma.rods_s),
                or_more(cma.tubes_s),
                percent(cma.reserve)
            );
            all.push([search, cma]);
        }
        let _ = writeln!(medians, "\n{}: {}", scene.scene.name(), compared(&all));
    }
    Ok(text + &medians)
}

/// Medians of both methods, and how often the search has the larger reserve. A time that was not found is longer than any.
fn compared(all: &[[Times; 2]]) -> String {
    let median = |of: &dyn Fn(&[Times; 2]) -> Option<f64>| {
        let mut values: Vec<f64> = all.iter().map(|both| of(both).unwrap_or(f64::INFINITY)).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::INFINITY)
    };
    let [own_s, cma_s] = [0, 1].map(|method: usize| median(&|both| both[method].rods_s));
    let [own_tubes_s, cma_tubes_s] = [0, 1].map(|method: usize| median(&|both| both[method].tubes_s));
    let larger = |both: &&[Times; 2]| both[0].reserve.unwrap_or(-1.0) > both[1].reserve.unwrap_or(-1.0);
    let shown = |s: f64| if s.is_finite() { format!("{s:.1} s") } else { "none in its time".to_owned() };
    format!(
        "every margin by rods {} (search, median) and {} (CMA-ES); confirmed by tubes {} and {}; the search has the larger reserve in {} of {}.",
        shown(own_s),
        shown(cma_s),
        shown(own_tubes_s),
        shown(cma_tubes_s),
        all.iter().filter(larger).count(),
        all.len()
    )
}
