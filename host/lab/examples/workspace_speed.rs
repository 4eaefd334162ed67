//! What the workspace of a scene costs, for `host/lab/benches/workspace/compare.py`: one line of JSON.
//!
//!     cargo run --release -p softlimb-lab --example workspace_speed scenes/weightless-a.toml

use std::time::Instant;

use softlimb_limb::Limb;
use softlimb_limb::workspace::{Command, Points, Workspace, extents, sample, sample_single};
use softlimb_scene as scene;

const SAMPLES: usize = 50_000;
const ROUNDS: usize = 101;

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
    let file = std::env::args().nth(1).unwrap_or_else(|| "scenes/weightless-a.toml".into());
    let scene = scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    let space = &Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let build = fastest(|| drop(Workspace::new(&limb, Command::Actuators)));
    let search = fastest(|| drop(extents(space)));
    let each = |mut run: Box<dyn FnMut() + '_>| fastest(&mut run) / SAMPLES as f64;
    let double = |threads| each(Box::new(move || drop(sample(space, Points::Even, SAMPLES, 1, threads))));
    let single = |points, threads| each(Box::new(move || drop(sample_single(space, points, SAMPLES, 1, threads))));
    println!(
        "{{\"build_s\": {build:e}, \"extents_s\": {search:e}, \"double_s\": {:e}, \"double_two_threads_s\": {:e}, \
         \"sample_s\": {:e}, \"sample_two_threads_s\": {:e}, \"random_s\": {:e}}}",
        double(1),
        double(2),
        single(Points::Even, 1),
        single(Points::Even, 2),
        single(Points::Random, 1),
    );
}
