//! Limbs under load from several seeds: `cargo run --release -p softlimb-design --example loaded_seeds -- SCENE [FIRST] [LAST] [OUTPUT]`.
//!
//! Prints per seed whether the limb is confirmed, its margins, limbs judged, wall time and processor time. `OUTPUT` is a prefix: every
//! confirmed limb is written as a scene to `OUTPUT-SEED.toml`.
//!
//! `SCENE tasks FIRST LAST` does so for seeded tasks instead, which a hidden limb of the scene's bounds does, and prints for each that is not solved
//! which bound forbids it. `SCENE evaluate` answers the sum of squares of what a limb lacks and the largest lack for points of the unit box on the standard input,
//! each a line, in blocks that an empty line ends; two threads share a block.

use std::io::{BufRead, Write};
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use softlimb_design::from_scene::LoadedDesign;
use softlimb_design::from_scene::{loaded_design, loaded_text};
use softlimb_design::loaded::{
    Effort, Evaluation, Judgement, Lack, Seeded, active_bounds, evaluate, search, seeded,
};

/// Processor time of all threads of this process, s; 0 where the system does not tell.
fn processor_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    // Fields 14 and 15 of proc(5), in ticks of 10 ms; the name is field 2.
    after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, other: u64| arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(other);
    let Some(file) = arguments.first() else { return };
    let scene = softlimb_scene::load(file).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let design = loaded_design(&scene).unwrap_or_else(|error| panic!("{error}"));
    match arguments.get(1).map(String::as_str) {
        Some("tasks") => return tasks(&design, number(2, 1)..=number(3, 50)),
        Some("evaluate") => return answer(&design).unwrap_or_else(|error| panic!("{error}")),
        _ => {}
    }
    let (task, space) = (&design.task, &design.space);
    for seed in number(1, 1)..=number(2, 10) {
        let (started, used_s) = (Instant::now(), processor_s());
        let effort = Effort { seed, ..Effort::default() };
        let Some(found) = search(task, space, &space.first_guess(), &effort, &|| false) else {
            println!("seed {seed}: nothing stands");
            continue;
        };
        let searched = started.elapsed();
        let poses = &found.confirmed;
        let lacks: Vec<_> = poses.iter().flat_map(|pose| pose.lacks.iter().map(|lack| lack.name())).collect();
        let worst_m = poses.iter().map(|pose| pose.tip_error_m).fold(0.0, f64::max);
        let limb = &found.evaluation;
        let tilt_rad = poses.iter().map(|pose| pose.tilt_rad).fold(0.0, f64::max);
        let spare_m = poses.iter().filter_map(|pose| pose.spare_m).fold(f64::INFINITY, f64::min);
        println!(
            "seed {seed}: reached {} confirmed {} reserve {:.2}, objective {:.1e}, {:.2} kg, {:.3} m, tip {:.3} mm, spare {:.1} mm, tilt {:.0} deg, {} limbs in {:.1} s and {:.1} s ({:.1} s of processors); lacks {lacks:?}",
            found.reached,
            lacks.is_empty(),
            found.by.reserve,
            limb.objective(),
            limb.mass_kg,
            limb.length_m,
            1e3 * worst_m,
            1e3 * spare_m,
            tilt_rad.to_degrees(),
            found.evaluations,
            searched.as_secs_f64(),
            (started.elapsed() - searched).as_secs_f64(),
            processor_s() - used_s,
        );
        if !found.reached {
            println!("  {:?}", worst(limb));
        }
        for pose in poses.iter().filter(|pose| !pose.lacks.is_empty()) {
            println!("  {pose:?}");
        }
        println!("  {:?}", limb.sizes);
        if !found.reached {
            for pose in &limb.poses {
                println!(
                    "  shares {:.3?} missing {:.4?} spare {:?} {:?}",
                    pose.shares,
                    pose.missing_m.as_slice(),
                    pose.spare_m,
                    pose.loads
                );
            }
        }
        if let Some(output) = arguments.get(3).filter(|_| lacks.is_empty()) {
            let text = loaded_text(&scene, &design, &limb.sizes).unwrap_or_else(|error| panic!("{error}"));
            std::fs::write(format!("{output}-{seed}.toml"), text).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

/// Seeded tasks, and which bound forbids those that are not solved.
fn tasks(design: &LoadedDesign, seeds: RangeInclusive<u64>) {
    let space = &design.space;
    let (mut solved, mut asked) = (0, 0);
    for seed in seeds {
        let started = Instant::now();
        let Some(Seeded { task, .. }) = seeded(&design.task, space, seed) else {
            println!("task {seed}: none was drawn");
            continue;
        };
        let drawn = started.elapsed();
        asked += 1;
        let (effort, begin_s) = (Effort { seed, raises: 0, ..Effort::default() }, processor_s());
        let found = search(&task, space, &space.first_guess(), &effort, &|| false);
        let confirmed = found.as_ref().is_some_and(|found| found.reached);
        solved += u32::from(confirmed);
        let used_s = processor_s() - begin_s;
        let limbs = found.as_ref().map_or(0, |found| found.evaluations);
        println!(
            "task {seed}: confirmed {confirmed}, {limbs} limbs, {used_s:.1} s of processors; drawn in {:.1} s",
            drawn.as_secs_f64()
        );
        let Some(found) = found.filter(|_| !confirmed) else { continue };
        println!("  lacks {:?}", worst(&found.evaluation));
        for bound in active_bounds(&task, space, &found, &|| false) {
            println!("  {bound:?}");
        }
    }
    println!("{solved} of {asked} tasks solved");
}

/// The four margins that lack most.
fn worst(limb: &Evaluation) -> Vec<Lack> {
    let mut lacks: Vec<_> = limb.lacks.iter().copied().filter(|lack| lack.value.abs() > 1e-3).collect();
    lacks.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
    lacks.truncate(4);
    lacks
}

/// Answers objectives of points.
fn answer(design: &LoadedDesign) -> Result<(), Box<dyn std::error::Error>> {
    let (task, space) = (&design.task, &design.space);
    let objective = |point: &Vec<f64>| {
        let limb = evaluate(task, space, &space.sizes(point), &Judgement { moves: true, ..Judgement::default() });
        let largest = |limb: &Evaluation| limb.lacks.iter().map(|lack| lack.value.abs()).fold(0.0, f64::max);
        limb.map_or([f64::INFINITY; 2], |limb| [limb.objective(), largest(&limb)])
    };
    let mut out = std::io::stdout().lock();
    let guess: Vec<String> = space.first_guess().iter().map(f64::to_string).collect();
    writeln!(out, "{}", guess.join(" "))?;
    out.flush()?;
    let mut block: Vec<Vec<f64>> = Vec::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        if !line.is_empty() {
            block.push(line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?);
            continue;
        }
        let next = AtomicUsize::new(0);
        let values = Mutex::new(vec![[f64::INFINITY; 2]; block.len()]);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    while let Some((index, point)) =
                        Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, block.get(i)?)))
                    {
                        let value = objective(point);
                        if let Ok(mut values) = values.lock() {
                            values[index] = value;
                        }
                    }
                });
            }
        });
        for [objective, largest] in values.into_inner()? {
            writeln!(out, "{objective:e} {largest:e}")?;
        }
        out.flush()?;
        block.clear();
    }
    Ok(())
}
