//! The record to choose a model by: what the models say, what page and picture show, and how the models compare.
//!
//! `cargo xtask lab choice --help` has the command that writes `tests/golden/choice.tsv` with page and picture.
//! `SOFTLIMB_WRITE_CHOICE=1 cargo test -p softlimb-lab --test main choice` writes page and picture from the record.

use std::process::Command;

use softlimb::comparison::Comparison;
use softlimb_lab::accuracy::choice::{BENDERS, Choice, Model, PLACE, SEED, Summary, measure, page, picture};
use softlimb_lab::generated_section::replaced;

/// Benders that the test computes anew.
const FEW: usize = 2;

fn file(path: &str) -> String {
    format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(file(path)).expect(path)
}

fn recorded() -> Choice {
    Choice::from_tsv(&read("tests/golden/choice.tsv")).expect("a record")
}

fn validation() -> Comparison {
    Comparison::from_tsv(&read("tests/golden/validation.tsv")).expect("a comparison")
}

#[test]
fn record_is_what_the_models_say() {
    let (now, recorded) = (measure(SEED, FEW, None, |_| ()).expect("references"), recorded());
    assert_eq!((recorded.seed, recorded.rows.len(), now.rows.len()), (SEED, BENDERS, FEW));
    for (now, before) in now.rows.iter().zip(&recorded.rows) {
        assert_eq!(now.bender, before.bender);
        for (now, before) in now.errors.iter().zip(before.errors) {
            let (now, before) = (now.expect("an answer"), before.expect("an answer"));
            assert!((now - before).abs() <= 0.02 * before + 1e-7, "{now:e}, in the record {before:e}");
        }
    }
}

#[test]
fn page_and_picture_show_the_record() {
    let (choice, validation) = (recorded(), validation());
    let table = page(&choice, &validation);
    if std::env::var_os("SOFTLIMB_WRITE_CHOICE").is_some() {
        let written = replaced(&read("docs/evidence/accuracy.md"), PLACE, &table).expect("a place for the table");
        std::fs::write(file("docs/evidence/accuracy.md"), written).expect("written");
        std::fs::write(file("docs/evidence/choice.svg"), picture(&choice, &validation)).expect("written");
    }
    let document = read("docs/evidence/accuracy.md");
    assert_eq!(replaced(&document, PLACE, &table).as_deref(), Some(document.as_str()), "see the head of this test");
    assert!(picture(&choice, &validation) == read("docs/evidence/choice.svg"), "docs/evidence/choice.svg");
    assert_eq!(choice.tsv(), read("tests/golden/choice.tsv"));
}

/// Every model has a mark: errors and a time. The reference is known far better than the best model.
#[test]
fn models_trade_error_for_cost() {
    let choice = recorded();
    let summaries = choice.summaries(&validation());
    let figures = |model: Model| -> (usize, [f64; 2], f64) {
        let Summary { count, errors, seconds, .. } = summaries[model as usize];
        (count, errors.expect("errors"), seconds.answer.expect("a time"))
    };
    let [analytic, cubic, table, section, calculix] = Model::ALL.map(figures);
    assert_eq!([analytic.0, cubic.0, section.0, calculix.0], [BENDERS, BENDERS, BENDERS, 4]);
    // Not every bender has a table that keeps its budget.
    assert!(table.0 + 1 >= BENDERS, "{}", table.0);
    let doubt = choice.rows.iter().map(|row| row.reference).fold(0.0, f64::max);
    assert!(doubt < 0.2 * section.1[1], "{doubt:e} beside {:e}", section.1[1]);
    let less = |one: [f64; 2], other: [f64; 2], factor: f64| (0..2).all(|i| factor * one[i] < other[i]);
    assert!(
        less(section.1, table.1, 3.0) && less(table.1, cubic.1, 10.0) && less(cubic.1, analytic.1, 1.5),
        "{summaries:?}"
    );
    // Costs a factor of ten apart or more.
    assert!(10.0 * cubic.2 < analytic.2 && 10.0 * table.2 < analytic.2, "{summaries:?}");
    assert!(10.0 * analytic.2 < section.2 && 10.0 * section.2 < calculix.2, "{summaries:?}");
}

/// Without CalculiX the file keeps its time.
#[test]
fn record_is_written_and_keeps_the_time_of_calculix() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    std::fs::write(place("record.tsv"), "# CalculiX\t-\t1.25e2\n").expect("written");
    std::fs::write(place("page.md"), format!("# Before\n{}\nold\n{}\nAfter\n", PLACE[0], PLACE[1])).expect("written");
    let words = "choice --benders 1 --seed 3 --tsv record.tsv --svg picture.svg --page page.md";
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb-lab"));
    let output = command.args(words.split(' ')).current_dir(folder.path()).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = |name: &str| std::fs::read_to_string(place(name)).expect(name);
    let choice = Choice::from_tsv(&text("record.tsv")).expect("a record");
    assert_eq!((choice.seed, choice.rows.len()), (3, 1));
    assert_eq!(choice.seconds[Model::Calculix as usize].answer, Some(125.0));
    assert!(choice.seconds[..4].iter().all(|seconds| seconds.answer.is_some_and(|answer| answer > 0.0)), "{choice:?}");
    let page = text("page.md");
    assert!(page.starts_with("# Before\n") && page.contains("| CalculiX | 4 |") && page.ends_with("After\n"), "{page}");
    assert!(text("picture.svg").starts_with("<svg xmlns="));
}
