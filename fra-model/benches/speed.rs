//! Times of the solvers, one line per case: `name nanoseconds-per-answer`.
//!
//! `speed.py` writes the actuators to a file, names it in `SPEED_SAMPLE`, compares the answers left in `SPEED_ANSWERS` with its own
//! and prints ratios. Without them, a small sample of its own serves to see that it runs.

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use fra_model::*;

/// Runs of which the fastest counts.
const RUNS: u32 = 15;
/// Actuators that fit the caches, as the solvers this is compared with have it.
const PIECE: usize = 512;

struct Case {
    actuator: Actuator<f64>,
    pressure_pa: f64,
}

fn parameters(columns: &[f64], families: Families) -> ActuatorParameters<f64> {
    let &[inner_radius_m, outer_radius_m, angle_rad, thickness_m, mu1, mu2, _] = columns else {
        panic!("seven columns: {columns:?}")
    };
    ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m,
        outer_radius_m,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: mu1 },
        fiber: Some(Fiber {
            angle_rad,
            families,
            modulus_pa: mu2,
            placement: Placement::Sheet,
            thickness_m,
            radius_m: outer_radius_m,
        }),
    }
}

fn single(p: &ActuatorParameters<f64>) -> ActuatorParameters<f32> {
    p.map(|value| value as f32)
}

fn sample() -> Vec<Vec<f64>> {
    let own =
        || (1..40).map(|i| format!("6e-3,{},{},2e-4,2e5,2e7,2e4\n", 7e-3 + 1e-4 * f64::from(i), 0.03 * f64::from(i)));
    let text = match std::env::var("SPEED_SAMPLE") {
        Ok(path) => std::fs::read_to_string(path).expect("a readable sample"),
        Err(_) => own().collect(),
    };
    text.lines().map(|line| line.split(',').map(|n| n.trim().parse().expect("a number")).collect()).collect()
}

/// Prints the fastest time per item of some runs over each piece that fits the caches.
fn time_in_pieces<I>(name: &str, items: &[I], mut f: impl FnMut(&I)) {
    let mut total = 0.0;
    for piece in items.chunks(PIECE) {
        let mut best = f64::INFINITY;
        for _ in 0..RUNS {
            let start = Instant::now();
            piece.iter().for_each(&mut f);
            best = best.min(start.elapsed().as_secs_f64());
        }
        total += best;
    }
    println!("{name} {:.1}", total * 1e9 / items.len() as f64);
}

/// Prints the fastest time per item of some runs over all of them, from memory.
fn time<I>(name: &str, items: &[I], mut f: impl FnMut(&I)) {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        items.iter().for_each(&mut f);
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{name} {:.1}", best * 1e9 / items.len() as f64);
}

fn build(rows: &[Vec<f64>], families: Families) -> Vec<Case> {
    rows.iter()
        .map(|row| Case { actuator: Actuator::new(&parameters(row, families)).expect("valid"), pressure_pa: row[6] })
        .collect()
}

fn main() {
    bends();
    let rows = sample();
    let none = Load::none();
    for (name, families) in [("two", Families::Two), ("one", Families::One)] {
        let cases = build(&rows, families);
        let forward = |c: &Case| {
            black_box(c.actuator.forward(black_box(c.pressure_pa), &none)).expect("finite");
        };
        time_in_pieces(&format!("forward_cold_{name}"), &cases, forward);
        time(&format!("forward_from_memory_{name}"), &cases, forward);
        time(&format!("build_and_forward_{name}"), &rows, |row| {
            let actuator = Actuator::new(&parameters(row, families)).expect("valid");
            black_box(actuator.forward(black_box(row[6]), &none)).expect("finite");
        });
        let solved: Vec<_> = cases.iter().map(|c| c.actuator.forward(c.pressure_pa, &none).expect("finite")).collect();
        let evaluations: u32 = solved.iter().map(|s| s.iterations).sum();
        println!("evaluations_{name} {:.3}", f64::from(evaluations) / solved.len() as f64);
        let search: Vec<_> = cases.iter().map(|c| c.actuator.by_search()).collect();
        let few: Vec<_> = (0..rows.len().min(200)).collect();
        time(&format!("forward_search_{name}"), &few, |&i| {
            black_box(search[i].forward(cases[i].pressure_pa, &none)).expect("finite");
        });
        inverses(name, &cases, &solved);
        if let (Ok(path), "two") = (std::env::var("SPEED_ANSWERS"), name) {
            let mut text = String::new();
            for s in &solved {
                let solved = u8::from(s.status == Status::Solved);
                writeln!(text, "{:e},{:e},{solved}", s.state.axial_stretch, s.state.inner_radius_m).expect("text");
            }
            std::fs::write(path, text).expect("a place for the answers");
        }
    }
}

/// A tube of 6/8 mm and 100 mm that bends by a quarter turn: what each question to it takes.
fn bends() {
    let p = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: None,
    };
    let (none, target) = (Load::none(), Target::BendAngle(std::f64::consts::FRAC_PI_2));
    let actuator = Actuator::new(&p).expect("valid");
    let state = actuator.inverse(target, &none).expect("finite").state;
    let times = [(); 512];
    time("bend_build", &times, |()| {
        black_box(Actuator::new(black_box(&p))).expect("valid");
    });
    time("bend_inverse", &times, |()| {
        black_box(actuator.inverse(black_box(target), &none)).expect("finite");
    });
    time("bend_forward", &times, |()| {
        black_box(actuator.forward(black_box(state.pressure_pa), &none)).expect("finite");
    });
    time("bend_sensitivity", &times, |()| {
        black_box(actuator.sensitivity(black_box(&state), &none, Parameter::InnerRadius)).expect("a derivative");
    });
    time("bend_condition", &times, |()| {
        black_box(actuator.condition(black_box(&state), &none)).expect("derivatives");
    });
}

/// Inverse problems: what a pressure has done in the direction the winding is made for, the stretch below the neutral angle and the
/// outer radius above it.
fn inverses(name: &str, cases: &[Case], solved: &[Solution<f64>]) {
    let none = Load::none();
    let target = |actuator: &Actuator<f64>, s: &State<f64>| {
        let angle_rad = actuator.parameters().fiber.map_or(0.0, |fiber| fiber.angle_rad);
        let lengthens = angle_rad < 0.5_f64.sqrt().atan();
        if lengthens { Target::AxialStretch(s.axial_stretch) } else { Target::OuterRadius(s.outer_radius_m) }
    };
    let pairs: Vec<_> = cases.iter().zip(solved).map(|(c, s)| (c.actuator, target(&c.actuator, &s.state))).collect();
    time(&format!("inverse_cold_{name}"), &pairs, |(actuator, target)| {
        black_box(actuator.inverse(black_box(*target), &none)).expect("finite");
    });
    let near: Vec<_> = cases
        .iter()
        .zip(&pairs)
        .map(|(c, (actuator, target))| {
            let start = actuator.forward(c.pressure_pa * 0.99, &none).expect("finite").state;
            let actuator = Actuator::new(&single(actuator.parameters())).expect("valid");
            let target = match *target {
                Target::AxialStretch(v) => Target::AxialStretch(v as f32),
                Target::OuterRadius(v) => Target::OuterRadius(v as f32),
                _ => unreachable!("only these two are made"),
            };
            (actuator, target, State::combine([&start], |[v]: [f64; 1]| v as f32))
        })
        .collect();
    let load = Load::none();
    time(&format!("inverse_near_f32_{name}"), &near, |(actuator, target, start)| {
        black_box(actuator.inverse_near(start, black_box(*target), &load, 200)).expect("finite");
    });
    let forward: Vec<_> = near.iter().zip(cases).map(|((actuator, ..), c)| (*actuator, c.pressure_pa as f32)).collect();
    time(&format!("forward_cold_f32_{name}"), &forward, |(actuator, pressure)| {
        black_box(actuator.forward(black_box(*pressure), &load)).expect("finite");
    });
    let evaluations: u32 =
        near.iter().map(|(a, t, s)| a.inverse_near(s, *t, &load, 200).expect("finite").iterations).sum();
    println!("evaluations_inverse_near_f32_{name} {:.3}", f64::from(evaluations) / near.len() as f64);
}
