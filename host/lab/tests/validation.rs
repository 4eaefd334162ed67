//! The published comparison of the analytic model with finite elements, `tests/golden/validation.tsv`: what it says today, and what it must say.
//!
//! Made by `cargo xtask lab validation --calculix --tsv tests/golden/validation.tsv --svg docs/evidence/validation.svg --page docs/evidence/validation.md`.
//! `SOFTLIMB_WRITE_VALIDATION=1 cargo test -p softlimb-lab --test main page_and_picture_show_the_record` draws the picture again from the record.
//! Here everything but CalculiX is computed again; `tests/calculix.rs` runs CalculiX itself.

use fra_model::Motion;
use softlimb::comparison::{Comparison, Row, compare, picture, section_curve};
use softlimb_lab::generated_section::replaced;
use softlimb_lab::validation::{PLACE, cases, page as table};

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))).expect(path)
}

fn recorded() -> Comparison {
    Comparison::from_tsv(&read("tests/golden/validation.tsv")).expect("a comparison")
}

fn largest(rows: &[Row], value: impl Fn(&Row) -> Option<f64>) -> f64 {
    rows.iter().filter_map(|row| row.difference(value(row))).map(f64::abs).fold(0.0, f64::max)
}

#[test]
fn the_record_is_what_the_models_say() {
    let mut now = Comparison::default();
    for case in cases() {
        let curve = section_curve(&case).expect("an actuator");
        now.rows.extend(compare(&case, &curve, &Vec::new()).expect("an actuator"));
    }
    let recorded = recorded();
    let now = now.onto(&recorded);
    assert_eq!(now.rows.len(), recorded.rows.len());
    let close = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * b.abs(),
        (a, b) => a == b,
    };
    for (a, b) in now.rows.iter().zip(&recorded.rows) {
        assert_eq!((&a.case, a.pressure_kpa, a.solid), (&b.case, b.pressure_kpa, b.solid));
        assert!(close(a.analytic, b.analytic) && close(a.calibrated, b.calibrated), "{a:?}\n{b:?}");
        assert!(close(a.section, b.section), "{a:?}\n{b:?}");
        // The errors of straight tubes are near rounding.
        let errors = a.section_error.zip(b.section_error);
        assert!(errors.is_some_and(|(a, b)| (a - b).abs() <= 0.2 * b + 1e-7), "{a:?}\n{b:?}");
    }
}

#[test]
fn page_and_picture_show_the_record() {
    let recorded = recorded();
    if std::env::var_os("SOFTLIMB_WRITE_VALIDATION").is_some() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/evidence/validation.svg");
        std::fs::write(file, picture(&recorded)).expect(file);
    }
    let page = read("docs/evidence/validation.md");
    assert_eq!(replaced(&page, PLACE, &table(&recorded)).as_deref(), Some(page.as_str()), "see the head of this test");
    assert!(
        picture(&recorded) == read("docs/evidence/validation.svg"),
        "docs/evidence/validation.svg is not of the record"
    );
}

/// Four motions, two sizes, two materials, six pressures each, every one answered by every model.
#[test]
fn record_is_whole() {
    let recorded = recorded();
    assert_eq!(recorded.rows.len(), 4 * 2 * 2 * 6);
    for row in &recorded.rows {
        assert!(row.analytic.is_some() && row.section.is_some() && row.solid.is_some(), "{row:?}");
        assert_eq!(row.calibrated.is_some(), row.motion == Motion::Bending, "{row:?}");
    }
}

#[test]
fn the_models_agree_within_what_is_claimed() {
    let rows = recorded().rows;
    let (bends, straight): (Vec<_>, Vec<_>) = rows.into_iter().partition(|row| row.motion == Motion::Bending);
    // The thick-walled equations are exact for a uniform tube; bending has a trial field, or a cubic in its place.
    assert!(largest(&straight, |row| row.analytic) < 1e-5);
    assert!(largest(&bends, |row| row.analytic) < 0.03);
    assert!(largest(&bends, |row| row.calibrated) < 0.005);
    // CalculiX: slightly compressible, a layer of some thickness in place of the sheet.
    assert!(largest(&straight, |row| row.solid) < 0.01);
    assert!(largest(&bends, |row| row.solid) < 0.01);
    for row in straight.iter().chain(&bends) {
        let (value, error) = row.section.zip(row.section_error).expect("answered");
        assert!(error < 3e-3 * (value - row.rest).abs(), "{row:?}");
    }
}
