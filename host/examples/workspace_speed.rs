//! What the workspace of a scene costs, for `host/benches/workspace/compare.py`: one line of JSON.
//!
//!     cargo run --release -p softlimb --example workspace_speed scenes/pick-and-place-a.toml

use std::time::Instant;

use softlimb::design::Limb;
use softlimb::scene;
use softlimb::workspace::{Command, Points, Workspace, extents, sample};

const SAMPLES: usize = 200_000;
const ROUNDS: usize = 7;

/// Seconds of the fastest of several runs.
fn fastest(mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

fn main() {
    let file = std::env::args().nth(1).unwrap_or_else(|| "scenes/pick-and-place-a.toml".into());
    let scene = scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let build = fastest(|| drop(Workspace::new(&limb, Command::Actuators)));
    let search = fastest(|| drop(extents(&space)));
    let per_sample = |points, threads| fastest(|| drop(sample(&space, points, SAMPLES, 1, threads))) / SAMPLES as f64;
    println!(
        "{{\"build_s\": {build:e}, \"extents_s\": {search:e}, \"sample_s\": {:e}, \"sample_two_threads_s\": {:e}, \"random_s\": {:e}}}",
        per_sample(Points::Even, 1),
        per_sample(Points::Even, 2),
        per_sample(Points::Random, 1),
    );
}
