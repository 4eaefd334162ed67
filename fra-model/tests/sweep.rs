//! A seeded sweep over the whole domain of the model, five pressures for each actuator, in both scalars, against the independent
//! solver in `oracle/`: every state on its branch, every refusal confirmed, every error within ten roundings of the condition number.
//!
//! The oracle follows every actuator's branch in its arclength: no answer goes without a check. Prints its table with `--nocapture`.

use crate::common::samples;
use crate::oracle::bent::sweep_bending;
use crate::oracle::sample::Random;
use crate::oracle::scalar::Scalar;
use crate::oracle::straight::sweep_straight;
use crate::oracle::tally::{Rules, Tally};
use crate::oracle::wall::Rule;

/// Actuators: nine of ten are straight.
const ACTUATORS: u32 = 20_000;
const BENDING_EVERY: u64 = 10;
const SEED: u64 = 0x00f1_be12;

fn sweep<T: Scalar>() -> Tally {
    let rules = Rules { rough: Rule::new(6), fine: Rule::new(11), exact: Rule::new(14) };
    let actuators = u64::from(samples(ACTUATORS));
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let part = &|thread: u64| {
        let mut tally = Tally::default();
        for i in (thread..actuators).step_by(threads as usize) {
            let mut random = Random::new(SEED.wrapping_add(i << 20));
            let name = format!("actuator {i}");
            if i % BENDING_EVERY == 0 {
                sweep_bending::<T>(&mut random, &rules, &mut tally, &name);
            } else {
                sweep_straight::<T>(&mut random, &rules, &mut tally, &name);
            }
        }
        tally
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|thread| scope.spawn(move || part(thread))).collect();
        workers.into_iter().map(|worker| worker.join().expect("no panic")).fold(Tally::default(), Tally::join)
    })
}

#[test]
fn every_answer_in_double_precision_is_on_its_branch() {
    sweep::<f64>().check(f64::NAME, samples(ACTUATORS));
}

#[test]
fn every_answer_in_single_precision_is_on_its_branch() {
    sweep::<f32>().check(f32::NAME, samples(ACTUATORS));
}
