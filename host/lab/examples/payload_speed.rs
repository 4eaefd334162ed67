//! Allocation of pressures beside Clarabel on the same trajectories, and the largest load of a bundle, in one run:
//!
//!     cargo run --release -p softlimb-lab --example payload_speed
//!
//! Times are of this machine: read the ratios.

use std::hint::black_box;
use std::time::Instant;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT};
use fra_model::Allocation;
use softlimb_limb::payload::Program;

const REGULARISER: f64 = 1e-6;
const TICKS: usize = 2000;

/// A stream of numbers in -1 to 1 (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Median and 99th percentile, us.
fn percentiles(mut times: Vec<f64>) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [times[times.len() / 2], times[times.len() * 99 / 100]].map(|seconds| seconds * 1e6)
}

/// A wrench that moves through saturation, at 1 kHz.
fn wrench(tick: usize) -> [f64; 6] {
    let t = tick as f64 * 1e-3;
    std::array::from_fn(|row| 60.0 * (std::f64::consts::TAU * (0.5 + 0.3 * row as f64) * t + row as f64).sin())
}

fn allocation<const N: usize>() {
    let mut numbers = Numbers(N as u64);
    let columns: Vec<[f64; 6]> = (0..N).map(|_| [0; 6].map(|_| numbers.next() * 4e-4)).collect();
    let limits = [[0.0, 1e5]; N];
    let prepared = Allocation::<f64, 6, N>::new(&columns, &limits, &[1.0; 6], REGULARISER).expect("a bundle");
    let (mut pressures, mut warm, mut cold) = ([0.0; N], Vec::new(), Vec::new());
    let (mut steps, mut residual) = (0, 0.0_f64);
    for tick in 0..TICKS {
        let wanted = wrench(tick);
        let start = Instant::now();
        let found = black_box(&prepared).solve_from(black_box(&pressures), black_box(&wanted));
        warm.push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        black_box(black_box(&prepared).solve(black_box(&wanted)));
        cold.push(start.elapsed().as_secs_f64());
        pressures = found.pressures_pa;
        steps += found.iterations;
        residual = residual.max(found.residual);
    }
    let [conic, gap] = interior_point(&columns, &prepared);
    let ([warm, warm_99], [cold, cold_99]) = (percentiles(warm), percentiles(cold));
    let [conic, conic_99] = conic;
    println!(
        "{N:3} {warm:8.2} {warm_99:8.2} {cold:8.2} {cold_99:8.2} {conic:9.1} {conic_99:9.1} {:9.1} {:9.1} {:8.2} {residual:10.1e} {:10.1e}",
        conic / warm,
        conic_99 / warm_99,
        f64::from(steps) / TICKS as f64,
        gap[0],
    );
}

/// Clarabel with a new linear term each tick; its times, and by how much its objective is above ours at most.
fn interior_point<const N: usize>(columns: &[[f64; 6]], ours: &Allocation<f64, 6, N>) -> [[f64; 2]; 2] {
    let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scaled: Vec<[f64; 6]> = columns.iter().map(|c| c.map(|x| x * 1e5)).collect();
    let h = scaled.iter().map(|c| dot(c, c)).fold(0.0, f64::max);
    let entry = |i: usize, j: usize| dot(&scaled[i], &scaled[j]) / h + if i == j { REGULARISER } else { 0.0 };
    let upper: Vec<Vec<f64>> =
        (0..N).map(|i| (0..N).map(|j| if i <= j { entry(i, j) } else { 0.0 }).collect()).collect();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for sign in [-1.0, 1.0] {
        rows.extend((0..N).map(|i| (0..N).map(|j| if i == j { sign } else { 0.0 }).collect::<Vec<f64>>()));
    }
    let right: Vec<f64> = (0..2 * N).map(|i| if i < N { 0.0 } else { 1.0 }).collect();
    let settings = DefaultSettings { verbose: false, presolve_enable: false, ..DefaultSettings::default() };
    let linear = |wrench: &[f64; 6]| scaled.iter().map(|c| -dot(c, wrench) / h).collect::<Vec<f64>>();
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&rows));
    let cones = [NonnegativeConeT(2 * N)];
    let mut solver = DefaultSolver::new(&p, &linear(&wrench(0)), &a, &right, &cones, settings).expect("a program");
    let (mut times, mut gap) = (Vec::new(), 0.0_f64);
    for tick in (0..TICKS).step_by(4) {
        let wanted = wrench(tick);
        let q = linear(&wanted);
        let start = Instant::now();
        solver.update_q(&q).expect("as many numbers");
        solver.solve();
        times.push(start.elapsed().as_secs_f64());
        let value = |s: &[f64]| -> f64 {
            (0..N).map(|i| s[i] * (q[i] + 0.5 * (0..N).map(|j| entry(i, j) * s[j]).sum::<f64>())).sum()
        };
        let own: Vec<f64> = ours.solve(&wanted).pressures_pa.iter().map(|p| p / 1e5).collect();
        gap = gap.max((value(&own) - value(&solver.solution.x)) / (1.0 + value(&own).abs()));
    }
    [percentiles(times), [gap, 0.0]]
}

/// Largest loads of random bundles of actuators in balance of three components, as that of a limb of three modules.
fn capacity() {
    for (modules, actuators) in [(1, 3), (3, 3), (3, 9)] {
        let mut numbers = Numbers(actuators as u64);
        let (mut times, mut gap) = (Vec::new(), 0.0_f64);
        for _ in 0..300 {
            let mut column = |module: usize| {
                let own: Vec<f64> =
                    (0..3 * modules).map(|row| if row / 3 == module { numbers.next() * 4e-4 } else { 0.0 }).collect();
                own
            };
            let columns: Vec<Vec<f64>> = (0..modules * actuators).map(|i| column(i / actuators)).collect();
            let program = Program {
                columns,
                load: (0..3 * modules).map(|_| numbers.next()).collect(),
                constant: vec![0.0; 3 * modules],
                limits: vec![[0.0, 1e5]; modules * actuators],
                sides: Vec::new(),
                rows_scale: vec![40.0; 3 * modules],
            };
            let start = Instant::now();
            let found = black_box(&program).solve().expect("an answer");
            times.push(start.elapsed().as_secs_f64());
            gap = gap.max((found.bound - found.load) / (1.0 + found.load.abs()));
        }
        let [median, most] = percentiles(times);
        println!("{modules} x {actuators}: {median:7.0} us, p99 {most:7.0} us, certified to {gap:.1e}");
    }
}

fn main() {
    println!("allocation: us at 1 kHz through saturation; p50 and p99");
    println!(
        "  n     warm      p99     cold      p99  clarabel       p99 ratio p50 ratio p99    steps   residual  above it"
    );
    allocation::<9>();
    allocation::<18>();
    allocation::<27>();
    println!("largest load, linear program with certificate");
    capacity();
}
