//! Limbs under load from several seeds: `cargo run --release -p softlimb-design --example loaded_seeds -- SCENE [FIRST] [LAST] [OUTPUT]`.
//!
//! Prints per seed whether the limb is confirmed, its margins, limbs judged, wall time and processor time. `OUTPUT` is a prefix: every
//! confirmed limb is written as a scene to `OUTPUT-SEED.toml`.

use std::time::Instant;

use softlimb_design::from_scene::{loaded_design, loaded_text};
use softlimb_design::loaded::{Effort, confirm, search};

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
    let (task, space) = (&design.task, &design.space);
    for seed in number(1, 1)..=number(2, 10) {
        let (started, used_s) = (Instant::now(), processor_s());
        let effort = Effort { seed, ..Effort::default() };
        let Some(found) = search(task, space, &space.first_guess(), &effort, &|| false) else {
            println!("seed {seed}: nothing stands");
            continue;
        };
        let searched = started.elapsed();
        let poses = confirm(task, space, &found);
        let lacks: Vec<_> = poses.iter().flat_map(|pose| pose.lacks.iter().map(|lack| lack.name())).collect();
        let worst_m = poses.iter().map(|pose| pose.tip_error_m).fold(0.0, f64::max);
        let limb = &found.evaluation;
        println!(
            "seed {seed}: reached {} confirmed {} reserve {:.2}, objective {:.1e}, {:.2} kg, {:.3} m, tip {:.3} mm, {} limbs in {:.1} s and {:.1} s ({:.1} s of processors); lacks {lacks:?}",
            found.reached,
            lacks.is_empty(),
            found.by.reserve,
            limb.objective(),
            limb.mass_kg,
            limb.length_m,
            1e3 * worst_m,
            found.evaluations,
            searched.as_secs_f64(),
            (started.elapsed() - searched).as_secs_f64(),
            processor_s() - used_s,
        );
        if !found.reached {
            let mut lacks: Vec<_> = limb.lacks.iter().filter(|lack| lack.value.abs() > 1e-2).collect();
            lacks.sort_by(|a, b| b.value.abs().total_cmp(&a.value.abs()));
            lacks.truncate(4);
            println!("  {lacks:?}");
        }
        for pose in poses.iter().filter(|pose| !pose.lacks.is_empty()) {
            println!("  {pose:?}");
        }
        println!("  {:?}", limb.sizes);
        if !found.reached {
            for pose in &limb.poses {
                println!("  shares {:.3?} missing {:.4?} spare {:?} {:?}", pose.shares, pose.missing_m.as_slice(), pose.spare_m, pose.loads);
            }
        }
        if let Some(output) = arguments.get(3).filter(|_| lacks.is_empty()) {
            let text = loaded_text(&scene, &design, &limb.sizes).unwrap_or_else(|error| panic!("{error}"));
            std::fs::write(format!("{output}-{seed}.toml"), text).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}
