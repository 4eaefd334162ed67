//! Rates that a line carries without a drop.

use super::{Case, Outcome};
use softlimb_rig::link::LinkFaults;

fn without_a_drop(case: &Case) -> Outcome {
    let outcome = case.run().unwrap_or_else(|error| panic!("{case:?}: {error}"));
    let (samples, missing) = outcome.samples();
    let expected = (case.seconds * 1e6) as u64 / u64::from(case.sample_us);
    println!(
        "{} Bd, {} channels, set points every {} us, samples every {} us: efficiency {:.1} %, lines busy {:.0?} %",
        case.baud,
        case.channels,
        case.knot_us,
        case.sample_us,
        100.0 * outcome.efficiency(),
        outcome.load(case.baud).map(|load| 100.0 * load)
    );
    assert!(samples >= expected && missing == 0, "{case:?}: {samples} samples of {expected}, {missing} missing");
    assert_eq!(outcome.samples.last().map(|message| message.left_out), Some(0), "{case:?}");
    assert!(!outcome.starved, "{case:?}");
    assert_eq!(outcome.setpoints as usize, case.knots().len() + 1, "{case:?}");
    assert_eq!((outcome.counts.late, outcome.counts.wrong), (0, 0), "{case:?}");
    outcome
}

#[test]
fn lines_carry_their_rates_without_a_drop() {
    let case = |baud, channels, knot_us, sample_us| Case {
        baud,
        channels,
        knot_us,
        sample_us,
        faults: LinkFaults::NONE,
        seed: 1,
        seconds: 10.0,
    };
    let cases = [case(115_200, 9, 10_000, 5_000), case(1_000_000, 27, 5_000, 2_000), case(1_000_000, 9, 1_000, 1_000)];
    for case in cases {
        let efficiency = without_a_drop(&case).efficiency();
        assert!(efficiency >= 0.65, "{case:?}: {efficiency}");
    }
}
