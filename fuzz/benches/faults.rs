//! Any number of faults at the link, half each way: `cargo bench -p softlimb-fuzz --bench faults -- 100000000 1`, faults and seed.

use std::time::Instant;

use softlimb_fuzz::{Draw, device, host};

/// Faults of a line of progress, each way.
const STEP: u64 = 5_000_000;

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<u64>().ok());
    let (faults, seed) = (numbers.next().unwrap_or(1_000_000), numbers.next().unwrap_or(1));
    let (began, mut done) = (Instant::now(), 0);
    while done < faults / 2 {
        let step = STEP.min(faults / 2 - done);
        let place = done / STEP + (seed << 32);
        device::device(&mut Draw::random(2 * place), step);
        host::host(&mut Draw::random(2 * place + 1), step);
        done += step;
        println!("{} faults, {:.0} s", 2 * done, began.elapsed().as_secs_f64());
    }
    println!("{} faults: 0 wrong payloads applied, 0 panics; after any garbage at most one valid frame lost", 2 * done);
}
