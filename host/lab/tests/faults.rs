//! The fault matrix, `tests/golden/faults.tsv`: recorded, and run again in part.
//!
//! Made by `cargo xtask lab faults --tsv tests/golden/faults.tsv --page docs/evidence/faults.md`.

use softlimb_lab::faults::{EXCESS_PA, LIMIT_PA, Line, PHASES, PLACE, Verdict, cases, page, parse, rows, run};
use softlimb_lab::generated_section::replaced;

/// Cases of a line of which one is run where samples are small.
const SHARE: usize = 10;

/// How far a figure may be above the recorded one: the last bit of a pressure moves the pulses of valves.
const TIME_MS: f64 = 30.0;
const OVER_KPA: f64 = 0.5;

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))).expect(path)
}

fn recorded() -> Vec<Line> {
    parse(&read("tests/golden/faults.tsv")).expect("a matrix")
}

#[test]
fn no_chamber_gets_too_much_and_passed_lines_pass_again() {
    let is_full = std::env::var_os("SOFTLIMB_SAMPLES").is_some_and(|value| value == "full");
    let share = if is_full { 1 } else { SHARE };
    let cases: Vec<_> = cases().into_iter().step_by(share).collect();
    let recorded = recorded();
    let mut wrong = Vec::new();
    for (case, outcome) in run(&cases) {
        let is_same = |line: &&Line| line.fault == case.row.name && line.phase == case.phase_name();
        let line = recorded.iter().find(is_same).expect("a line of the record");
        let is_passed = line.cases[0] == line.cases[1];
        let over_kpa = (outcome.peak_pa - LIMIT_PA) * 1e-3;
        let is_late =
            outcome.told.zip(line.slowest_ms).is_some_and(|(told, slowest)| 1e3 * told.1 > slowest as f64 + TIME_MS);
        if outcome.peak_pa > LIMIT_PA + EXCESS_PA && case.row.faults.len() == 1
            || over_kpa > line.over_kpa + OVER_KPA
            || is_passed && (outcome.verdict != Verdict::Passed || is_late)
        {
            wrong.push(format!(
                "{} in {}, channel {}, seed {}: {outcome:?}, recorded {line:?}",
                case.row.name, line.phase, case.channel, case.seed
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn page_shows_the_record_and_no_single_fault_exceeds_the_limit() {
    let recorded = recorded();
    let document = read("docs/evidence/faults.md");
    assert_eq!(
        replaced(&document, PLACE, &page(&recorded)).as_deref(),
        Some(document.as_str()),
        "see the head of this test"
    );
    let all: usize = recorded.iter().map(|line| line.cases[0]).sum();
    assert_eq!(all, cases().len());
    // Of two faults at a time one may hide what the other does.
    let single = rows().into_iter().filter(|row| row.faults.len() == 1).map(|row| row.name);
    for name in single {
        let is_low = |line: &&Line| line.cases[2] == 0 && line.over_kpa <= EXCESS_PA * 1e-3;
        assert_eq!(recorded.iter().filter(|line| line.fault == name).filter(is_low).count(), PHASES.len(), "{name}");
    }
    let again: String = recorded.iter().map(Line::tsv).collect();
    assert!(read("tests/golden/faults.tsv").ends_with(&again));
}
