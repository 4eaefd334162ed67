//! What a loaded pose costs, and how far each tier is from the finest: a hanging limb of a scene, its bend changed a little from pose to pose.
//!
//!     cargo run --release -p softlimb-lab --example statics_speed

use std::time::Instant;

use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb, by_fidelity};
use softlimb_scene as scene;

const ROUNDS: usize = 200;

/// Microseconds of the fastest of several runs.
fn fastest(mut run: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e6
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

fn main() {
    let text = std::fs::read_to_string("scenes/weightless-a.toml").expect("run from the root of the workspace");
    let text = text
        .replace("base_direction = [1, 0, 0]", "base_direction = [0, 0, -1]")
        .replace("base_up = [0, 0, 1]", "base_up = [1, 0, 0]");
    let scene = scene::parse(&text, "hanging").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).unwrap_or_else(|error| panic!("{error}"));
    let at = |pressure_pa: f64| {
        let pressures = vec![pressure_pa; limb.channels()];
        LoadedLimb::new(&scene, &limb, &pressures, &vec![6; limb.modules().len()], &Load::default()).expect("a limb")
    };
    let (here, near) = (at(40e3), at(40.4e3));
    let fine = by_fidelity(&here.rod, Fidelity::Fourfold, None).expect("stable").1.tip().translation.vector;
    println!("spring constants of nine tubes {:.1} us", fastest(|| drop(at(40e3))));
    for tier in [Fidelity::Constant, Fidelity::Linear, Fidelity::Double, Fidelity::Fourfold] {
        let (_, shape) = by_fidelity(&here.rod, tier, None).expect("stable");
        let off = (shape.tip().translation.vector - fine).norm() / scene.rest_length_m();
        let cold = fastest(|| drop(by_fidelity(&here.rod, tier, None)));
        let warm = fastest(|| drop(by_fidelity(&near.rod, tier, Some(&shape.q))));
        println!(
            "{:20} cold {cold:8.1} us ({} iterations), warm {warm:8.1} us, {:.4} % of the length from the finest",
            tier.name(),
            shape.iterations,
            100.0 * off
        );
    }
}
