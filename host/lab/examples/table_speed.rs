//! Prints what tables cost and how far they are off, beside the model they replace.
//!
//! `cargo run --release -p softlimb-lab --example table_speed`
//!
//! Instructions of the device's lookups on this machine, each called 100 000 times:
//! `valgrind --tool=callgrind --toggle-collect='*counted_*' target/release/examples/table_speed counted`

use fra_model::StateQuantity;
use std::hint::black_box;
use std::time::Instant;

use fra_model::*;
use softlimb_limb::StateCurve;
use softlimb_motion::inverse_table::{DenseTable, DeviceTables, Subject, device_tables};

/// Largest error of a device's table, as a share of full scale.
const BUDGET: f64 = 1e-4;
const ATMOSPHERE_PA: f64 = 101_325.0;
const QUESTIONS: usize = 4096;
const ROUNDS: usize = 100;
const COUNTED: u32 = 100_000;

struct Case {
    name: &'static str,
    actuator: Actuator<f64>,
    kind: StateQuantity,
    pressure_max_pa: f64,
}

fn cases() -> Result<Vec<Case>, InvalidParameter<f64>> {
    let neutral_deg = 0.5_f64.sqrt().atan().to_degrees();
    let rows = [
        ("extension, 3 deg", Motion::Extension, 3.0, Families::Two, StateQuantity::AxialStretch, 97e3),
        ("contraction, 45 deg", Motion::Extension, 45.0, Families::Two, StateQuantity::AxialStretch, 60e3),
        ("neutral angle", Motion::Extension, neutral_deg, Families::Two, StateQuantity::AxialStretch, 97e3),
        ("expansion, 85 deg", Motion::Expansion, 85.0, Families::Two, StateQuantity::OuterRadius, 50e3),
        ("bending", Motion::Bending, 0.0, Families::Two, StateQuantity::BendAngle, 97e3),
        ("twisting, 28 deg", Motion::Twisting, 28.0, Families::One, StateQuantity::Twist, 97e3),
    ];
    let built = rows.into_iter().map(|(name, motion, angle_deg, families, kind, pressure_max_pa)| {
        let fiber = Fiber {
            angle_rad: f64::to_radians(angle_deg),
            families,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 14e-3,
        };
        let actuator = Actuator::new(&ActuatorParameters {
            motion,
            inner_radius_m: 10e-3,
            outer_radius_m: 14e-3,
            length_m: 0.24,
            material: Material::NeoHookean { shear_modulus_pa: 0.223e6 },
            fiber: Some(fiber),
        })?;
        Ok(Case { name, actuator, kind, pressure_max_pa })
    });
    built.collect()
}

/// Least time of a call over several rounds, ns; the questions are in no order.
fn nanoseconds<Q: Copy, A>(questions: &[Q], rounds: usize, mut ask: impl FnMut(Q) -> A) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..rounds {
        let started = Instant::now();
        for question in questions {
            black_box(ask(black_box(*question)));
        }
        least = least.min(started.elapsed().as_secs_f64());
    }
    least * 1e9 / questions.len() as f64
}

fn shares() -> impl Iterator<Item = f64> {
    (1..=QUESTIONS).map(|index| (index as f64 * 0.618_033_988_749_894_9).fract())
}

fn target(kind: StateQuantity, value: f64) -> Target<f64> {
    match kind {
        StateQuantity::AxialStretch => Target::AxialStretch(value),
        StateQuantity::OuterRadius => Target::OuterRadius(value),
        StateQuantity::InnerRadius => Target::InnerRadius(value),
        StateQuantity::Twist => Target::Twist(value),
        StateQuantity::BendAngle | StateQuantity::Pressure => Target::BendAngle(value),
    }
}

#[inline(never)]
fn counted_inverse(table: &InverseTable<f32>, target: f32) -> Result<Lookup<f32>, NotFinite> {
    table.lookup(target)
}

#[inline(never)]
fn counted_volume(table: &VolumeTable<f32>, pressure_pa: f32) -> Result<Volume<f32>, NotFinite> {
    table.lookup(pressure_pa)
}

fn tables(case: &Case) -> Result<(DeviceTables, DenseTable), Box<dyn std::error::Error>> {
    let curve = StateCurve::new(&case.actuator, case.pressure_max_pa);
    let subject = Subject::new(&case.actuator, case.kind, &curve);
    let tables = device_tables(&subject, BUDGET, ATMOSPHERE_PA).map_err(|reason| reason.to_string())?;
    let argument = tables.inverse.as_ref().map_or(Argument::Linear, |fit| fit.argument);
    let dense = DenseTable::new(&subject, argument, 1024).map_err(|reason| reason.to_string())?;
    Ok((tables, dense))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let counted = std::env::args().nth(1).is_some_and(|word| word == "counted");
    println!(
        "{:<20} {:>6} {:>8} {:>9} {:>8} {:>9} {:>8} {:>8} {:>10}",
        "actuator", "degree", "error", "lookup", "volume", "error", "dense", "error", "model"
    );
    for case in cases()? {
        let (tables, dense) = tables(&case)?;
        let Some(fit) = &tables.inverse else { continue };
        let table = fit.table().ok_or("the table is refused")?;
        let volume = VolumeTable::new(tables.volume.pressure_max_pa, &tables.volume.coefficients_m3)
            .map_err(|error| error.to_string())?;
        if counted {
            for index in 0..COUNTED {
                let share = index as f32 / COUNTED as f32;
                let _ = black_box(counted_inverse(&table, black_box(fit.from + share * (fit.to - fit.from))));
                let _ = black_box(counted_volume(&volume, black_box(share * fit.pressure_max_pa)));
            }
        }
        let (from, to) = dense.range();
        let values: Vec<f64> = shares().map(|share| from + share * (to - from)).collect();
        let singles: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        let pressures: Vec<f32> = shares().map(|share| share as f32 * fit.pressure_max_pa).collect();
        let curve = StateCurve::new(&case.actuator, case.pressure_max_pa);
        let few: Vec<f64> = values.iter().step_by(16).copied().collect();
        println!(
            "{:<20} {:>6} {:>8.1e} {:>6.1} ns {:>5.1} ns {:>9.1e} {:>5.1} ns {:>8.1e} {:>7.0} ns",
            case.name,
            fit.coefficients_pa.len() - 1,
            fit.error,
            nanoseconds(&singles, ROUNDS, |value| table.lookup(value)),
            nanoseconds(&pressures, ROUNDS, |value| volume.lookup(value)),
            tables.volume.error,
            nanoseconds(&values, ROUNDS, |value| dense.pressure_pa(value)),
            dense.error_pa() / case.pressure_max_pa,
            nanoseconds(&few, 3, |value| {
                let start = curve.at(0.5 * case.pressure_max_pa);
                case.actuator.inverse_from(&start, target(case.kind, value), &Load::none())
            }),
        );
    }
    Ok(())
}
