//! The time of a curve of six pressures, one line a case: `name milliseconds increments iterations unknowns`. All of it is of both meshes
//! but the unknowns, which are the finer one's.
//!
//! `cargo bench -p softlimb --bench section`

use std::hint::black_box;
use std::time::Instant;

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Limiter, Options, Section, Symmetry};

/// Runs of which the fastest counts.
const RUNS: u32 = 7;

const PRESSURES_PA: [f64; 6] = [5e3, 10e3, 20e3, 30e3, 40e3, 50e3];

fn wound(motion: Motion, angle_deg: f64, families: Families) -> ActuatorParameters<f64> {
    let (placement, angle_rad) = (Placement::Sheet, angle_deg.to_radians());
    let fiber = Fiber { angle_rad, families, modulus_pa: 640e6, placement, thickness_m: 1e-4, radius_m: 8e-3 };
    ActuatorParameters {
        motion,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: Some(fiber),
    }
}

fn main() {
    let usual = Options::default();
    let strip = Options { limiter: Some(Limiter::Strip { half_angle_rad: 0.26, stiffness_n_per_m: 1e5 }), ..usual };
    let line = Options { limiter: Some(Limiter::Line), ..usual };
    let ring = Options { symmetry: Symmetry::Ignore, ..usual };
    for (name, parameters, options) in [
        ("extension", wound(Motion::Extension, 5.0, Families::Two), usual),
        ("expansion", wound(Motion::Expansion, 70.0, Families::Two), usual),
        ("twisting", wound(Motion::Twisting, 30.0, Families::One), usual),
        ("bending-line", ActuatorParameters { fiber: None, ..wound(Motion::Bending, 0.0, Families::Two) }, usual),
        ("bending-strip", wound(Motion::Bending, 5.0, Families::Two), strip),
        ("bending-whole-section", wound(Motion::Bending, 5.0, Families::Two), ring),
        ("bending-and-twisting", wound(Motion::Twisting, 20.0, Families::One), line),
    ] {
        let section = Section::new(&parameters, &options).expect("valid");
        let mut fastest = f64::INFINITY;
        let mut effort = None;
        for _ in 0..RUNS {
            let start = Instant::now();
            let curve = black_box(section.curve(black_box(&PRESSURES_PA), &EndLoad::default()).expect("valid"));
            fastest = fastest.min(start.elapsed().as_secs_f64());
            assert!(curve.answers.iter().all(|answer| answer.equilibrium().is_some()), "{name}: {curve:?}");
            effort = Some([curve.effort, curve.coarse_effort]);
        }
        let [fine, coarse] = effort.expect("at least one run");
        let increments = fine.increments + coarse.increments;
        let iterations = fine.newton_iterations + coarse.newton_iterations;
        println!("{name} {:.2} {increments} {iterations} {}", 1e3 * fastest, fine.unknowns);
    }
}
