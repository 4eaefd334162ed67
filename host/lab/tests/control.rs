//! The control table, `tests/golden/control.tsv`: recorded, and the nominal plants run again.
//!
//! Made by `cargo xtask lab control --tsv tests/golden/control.tsv --svg docs/evidence/control.svg --page docs/evidence/control.md`.

use softlimb_lab::control::{Group, Line, PLACE, limits_s, lines, page, parse, run};
use softlimb_lab::generated_section::replaced;

/// How far a figure may be from the recorded one, and as a share of it. A supply that differs by 1e-13 changes no figure of the table; another mathematical
/// library may move the pulse of a valve by a microsecond.
const NEAR: f64 = 0.02;
const SHARE: f64 = 0.02;

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))).expect(path)
}

fn recorded() -> Vec<Line> {
    parse(&read("tests/golden/control.tsv")).expect("a table")
}

#[test]
fn nominal_plants_have_the_recorded_figures() {
    let recorded = recorded();
    for line in lines(&run(&[Group::Nominal, Group::Moved, Group::Pump])) {
        let is_same = |other: &&Line| {
            (&other.method, other.volume_ml, &other.plants) == (&line.method, line.volume_ml, &line.plants)
        };
        let before = recorded.iter().find(is_same).expect("a line of the record");
        assert_eq!(line.faults, before.faults, "{line:?}");
        for (now, then) in line.figures.iter().zip(before.figures) {
            let is_near = (now - then).abs() <= NEAR + SHARE * then.abs();
            assert!(is_near || now.is_nan() && then.is_nan(), "{line:?}, recorded {before:?}");
        }
    }
}

#[test]
fn page_shows_the_record() {
    let (recorded, document) = (recorded(), read("docs/evidence/control.md"));
    assert_eq!(
        replaced(&document, PLACE, &page(&recorded)).as_deref(),
        Some(document.as_str()),
        "see the head of this test"
    );
    let again: String = recorded.iter().map(Line::tsv).collect();
    assert!(read("tests/golden/control.tsv").ends_with(&again));
}

/// From 5 to 100 kPa a valve of 1.44e-9 m3/(s Pa) behind a supply of 301 kPa passes at most 0.514 g/s of air, which is choked flow, by ISO 6358 with
/// 1.185 kg/m3. Rigid chambers of 30, 80 and 150 mL take at least 95 kPa V/(R T) of it. Real ones widen, and the flow is choked below 100 kPa only in part.
#[test]
fn open_valve_takes_a_little_longer_than_choked_flow_into_a_rigid_chamber() {
    let limits_s = limits_s(&Group::Nominal.plant(1))[0];
    for (limit_s, volume_m3) in limits_s.iter().zip([30e-6, 80e-6, 150e-6]) {
        let choked_s = 94e3 * volume_m3 / (287.05 * 293.15) / (1.44e-9 * 1.185 * 301.3e3);
        println!("{:.0} mL: {:.0} ms, {:.0} ms at least", volume_m3 * 1e6, limit_s * 1e3, choked_s * 1e3);
        assert!((choked_s..2.5 * choked_s + 0.03).contains(limit_s), "{limit_s} s, {choked_s} s");
    }
}
