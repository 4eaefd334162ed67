//! The time of a batch of forward problems, one line per case: `name nanoseconds-per-answer`.
//!
//! `fra-model/benches/speed.py` writes the actuators to a file and names it in `SPEED_SAMPLE`.

use std::hint::black_box;
use std::time::Instant;

use fra_model::{
    Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, PressureRange, Target,
};
use softlimb::batch;
use softlimb::batch::ActuatorBatch;

/// Runs of which the fastest counts.
const RUNS: u32 = 40;
const LENGTH_M: f64 = 0.1;
/// Actuators at once: the number that suits the caches best counts, as it does for the solvers this is compared with.
const PIECES: [usize; 3] = [4096, 8192, 16384];

fn actuator(columns: &[f64], families: Families) -> Actuator<f64> {
    let &[inner_radius_m, outer_radius_m, angle_rad, thickness_m, mu1, modulus_pa, _] = columns else {
        panic!("seven columns: {columns:?}")
    };
    let placement = Placement::Sheet;
    let fiber = Fiber { angle_rad, families, modulus_pa, placement, thickness_m, radius_m: outer_radius_m };
    Actuator::new(&ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m,
        outer_radius_m,
        length_m: LENGTH_M,
        material: Material::NeoHookean { shear_modulus_pa: mu1 },
        fiber: Some(fiber),
    })
    .expect("valid")
}

fn bender(columns: &[f64]) -> Actuator<f64> {
    Actuator::new(&ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: columns[0],
        outer_radius_m: columns[1],
        length_m: LENGTH_M,
        material: Material::NeoHookean { shear_modulus_pa: columns[4] },
        fiber: None,
    })
    .expect("valid")
}

fn main() {
    let text = match std::env::var("SPEED_SAMPLE") {
        Ok(path) => std::fs::read_to_string(path).expect("a readable sample"),
        Err(_) => "6e-3,8e-3,0.1,2e-4,2e5,2e7,2e4\n".repeat(100),
    };
    let rows: Vec<Vec<f64>> =
        text.lines().map(|line| line.split(',').map(|n| n.trim().parse().expect("a number")).collect()).collect();
    let pressures_pa: Vec<f64> = rows.iter().map(|row| row[6]).collect();
    for (name, families) in [("two", Families::Two), ("one", Families::One)] {
        let actuators: Vec<_> = rows.iter().map(|row| actuator(row, families)).collect();
        let mut solutions = vec![actuators[0].forward(0.0, &Load::none()).expect("finite"); rows.len()];
        let (mut prepared, mut as_they_come) = (f64::INFINITY, f64::INFINITY);
        for piece in PIECES.map(|piece| piece.min(rows.len())) {
            let (actuators, pressures_pa, solutions) =
                (&actuators[..piece], &pressures_pa[..piece], &mut solutions[..piece]);
            let many = ActuatorBatch::new(actuators);
            prepared = prepared.min(fastest(piece, || {
                many.forward(pressures_pa, solutions).expect("finite");
                black_box(&solutions);
            }));
            as_they_come = as_they_come.min(fastest(piece, || {
                batch::forward(actuators, pressures_pa, solutions).expect("finite");
                black_box(&solutions);
            }));
        }
        println!("forward_batch_{name} {prepared:.1}\nforward_batch_as_they_come_{name} {as_they_come:.1}");
    }
    bends(&rows);
}

/// Benders of the sample's walls, each at `kappa R_o` from 0.02 to 0.35.
fn bends(rows: &[Vec<f64>]) {
    let bend = |i: usize| 0.02 + 0.33 * (i as f64 * 0.618_033_988_749_895).fract();
    let benders: Vec<_> = rows.iter().map(|row| bender(row)).collect();
    let targets: Vec<_> =
        rows.iter().enumerate().map(|(i, row)| Target::BendAngle(bend(i) * LENGTH_M / row[1])).collect();
    let mut solutions = vec![benders[0].forward(0.0, &Load::none()).expect("finite"); rows.len()];
    let inverse = fastest(rows.len(), || {
        batch::inverse(&benders, &targets, &PressureRange::physical(), &mut solutions).expect("finite");
        black_box(&solutions);
    });
    let pressures_pa: Vec<_> = solutions.iter().map(|solution| solution.state.pressure_pa).collect();
    let forward = fastest(rows.len(), || {
        batch::forward(&benders, &pressures_pa, &mut solutions).expect("finite");
        black_box(&solutions);
    });
    println!("bend_inverse_batch {inverse:.1}\nbend_forward_batch {forward:.1}");
}

/// The fastest time per answer of some runs, ns.
fn fastest(answers: usize, mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        run();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / answers as f64
}
