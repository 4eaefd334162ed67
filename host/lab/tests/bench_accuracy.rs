//! Error against cost: the table is what the program finds, the page is what the table says, and the page's sentences hold.
//!
//! `tests/golden/accuracy.tsv` is the published table over the whole set; `cargo xtask lab accuracy --help` shows the command that writes it
//! with page and picture. `tests/golden/accuracy-check.tsv` is that over the beginning of the set, which the tests compute anew;
//! `SOFTLIMB_WRITE_ACCURACY=1 cargo test -p softlimb-lab bench_accuracy` writes it, and page and picture from the published table.

mod claims;
mod command;

use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use softlimb_lab::accuracy as bench;
use softlimb_lab::accuracy::{Report, Row, SEED, Settings};
use softlimb_lab::generated_section::replaced;

/// Actuators the tests ask about.
const FEW: usize = 100;
/// A largest error may rise by this factor before the table has to be written anew, and fall by the second.
const WORSE: f64 = 2.0;
const BETTER: f64 = 20.0;
/// Newton steps and instructions may change by this share.
const STEPS: f64 = 0.25;
const INSTRUCTIONS: f64 = 0.1;

fn repository(path: &str) -> String {
    format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(repository(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The published table.
fn published() -> Report {
    Report::from_tsv(&read("tests/golden/accuracy.tsv")).unwrap()
}

/// The compiler, whose name heads the table of the tests: instruction counts are its work too.
fn compiler() -> String {
    let output = Command::new("rustc").arg("--version").output().expect("the compiler that built the tests");
    let build = if cfg!(debug_assertions) { "with debug assertions" } else { "without debug assertions" };
    format!("{} {build}", String::from_utf8(output.stdout).expect("UTF-8").trim())
}

/// What is found now, with counts where there is an instrument.
fn found() -> &'static Report {
    static FOUND: OnceLock<Report> = OnceLock::new();
    FOUND.get_or_init(|| {
        let mut report = bench::accuracy(&Settings { seed: SEED, actuators: FEW }, None, |_| ());
        if !bench::missing_instruments().contains(&"valgrind") {
            let arguments = ["accuracy", "--workload"].map(str::to_owned);
            bench::count(&mut report, Path::new(env!("CARGO_BIN_EXE_softlimb-lab")), &arguments).expect("counts");
        }
        if std::env::var_os("SOFTLIMB_WRITE_ACCURACY").is_some() {
            let text = format!("# compiler\t{}\n{}", compiler(), report.tsv());
            std::fs::write(repository("tests/golden/accuracy-check.tsv"), text).unwrap();
        }
        report
    })
}

/// The table of the tests and the compiler that counted.
fn golden() -> (Report, String) {
    found();
    let text = read("tests/golden/accuracy-check.tsv");
    let (head, table) = text.split_once('\n').expect("lines");
    let compiler = head.strip_prefix("# compiler\t").expect("the compiler heads the table");
    (Report::from_tsv(table).unwrap(), compiler.to_owned())
}

/// Pairs of lines; the names and the numbers of questions must be the same.
fn pairs<'a>(golden: &'a Report, found: &'a Report) -> Vec<(&'a Row, &'a Row)> {
    let names = |report: &Report| report.rows.iter().map(|row| row.names.clone()).collect::<Vec<_>>();
    assert_eq!(names(golden), names(found), "other lines than in the table: see the head of this test");
    golden.rows.iter().zip(&found.rows).collect()
}

fn alike(golden: f64, found: f64) -> bool {
    found <= WORSE * golden && golden <= BETTER * found.max(f64::EPSILON / 8.0)
}

#[test]
fn errors_are_those_of_the_table() {
    let (golden, _) = golden();
    for (golden, found) in pairs(&golden, found()) {
        let (a, b) = (&golden.accuracy, &found.accuracy);
        let names = &golden.names;
        assert_eq!((a.asked, a.solved), (b.asked, b.solved), "{names:?}");
        assert!(
            alike(a.max_error, b.max_error),
            "{names:?}: largest error {:e}, in the table {:e}",
            b.max_error,
            a.max_error
        );
        assert!(alike(a.median_error, b.median_error), "{names:?}: {:e} against {:e}", b.median_error, a.median_error);
        assert!((a.steps - b.steps).abs() <= STEPS * a.steps + 0.01, "{names:?}: {} steps, {}", b.steps, a.steps);
    }
}

#[test]
fn drift_is_seen() {
    assert!(alike(1e-6, 1.9e-6) && alike(1e-6, 1e-7) && alike(1e-16, 0.0));
    assert!(!alike(1e-6, 2.1e-6) && !alike(1e-6, 1e-8) && !alike(1e-6, f64::NAN) && !alike(1e-12, 0.0));
}

#[test]
fn the_reference_knows_more_than_it_is_asked() {
    for report in [found(), &published()] {
        assert_eq!(report.answered, report.asked);
        let doubt = report.doubt;
        assert!(doubt.residual < 1e-24 && doubt.step < 1e-26 && doubt.quadrature < 1e-24, "{doubt:?}");
    }
}

/// Names a test that does not do its work here. Not by the macro, whose output a test that passes does not show.
fn skipped(test: &str, why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {test}; {why}");
}

/// Where nobody would notice that a test is skipped, it fails.
fn missing(test: &str, cure: &str) {
    let is_required = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(!is_required, "{test}: {cure}");
    skipped(test, cure);
}

#[test]
fn instructions_are_those_of_the_table() {
    let (golden, counted_by) = golden();
    if bench::missing_instruments().contains(&"valgrind") {
        missing("instructions_are_those_of_the_table", "valgrind is not installed: `apt-get install valgrind`");
        return;
    }
    if counted_by != compiler() {
        let other = format!("the table is of {counted_by}, this is {}", compiler());
        skipped("instructions_are_those_of_the_table", &other);
        return;
    }
    for (golden, found) in pairs(&golden, found()) {
        let (Some(a), Some(b)) = (golden.cost.counted().0, found.cost.counted().0) else {
            panic!("{:?} is not counted", golden.names);
        };
        assert!((a - b).abs() <= INSTRUCTIONS * a, "{:?}: {b} instructions, in the table {a}", golden.names);
    }
}

/// A polynomial of degree 8 takes 8 products and 8 sums.
#[test]
fn the_instrument_counts_what_is_known() {
    let missing = bench::missing_instruments();
    let Some(count) = found().polynomial.filter(|_| missing.is_empty()) else {
        let cure = format!("{missing:?} not installed: `apt-get install valgrind binutils`");
        self::missing("the_instrument_counts_what_is_known", &cure);
        return;
    };
    match count.flops {
        Some(flops) => assert_eq!(flops, 16.0),
        None => skipped("the_instrument_counts_what_is_known", "operations are told apart on x86-64 only"),
    }
    assert!(count.instructions >= 16.0);
}

/// A page with its tables replaced by those of a report.
fn refreshed(page: &str, report: &Report) -> Option<String> {
    replaced(page, bench::PLACE, &bench::page(report))
}

#[test]
fn page_and_picture_are_those_of_the_published_table() {
    let report = published();
    if std::env::var_os("SOFTLIMB_WRITE_ACCURACY").is_some() {
        let page = refreshed(&read("docs/evidence/accuracy.md"), &report).expect("a place for the tables");
        std::fs::write(repository("docs/evidence/accuracy.md"), page).unwrap();
        std::fs::write(repository("docs/evidence/accuracy.svg"), bench::picture(&report)).unwrap();
    }
    let page = read("docs/evidence/accuracy.md");
    assert_eq!(
        refreshed(&page, &report).as_deref(),
        Some(page.as_str()),
        "docs/evidence/accuracy.md is not of the table"
    );
    assert!(
        bench::picture(&report) == read("docs/evidence/accuracy.svg"),
        "docs/evidence/accuracy.svg is not of the table"
    );
    assert_eq!((report.seed, report.asked), (SEED, bench::ACTUATORS));
    assert_eq!(report.tsv(), read("tests/golden/accuracy.tsv"));
}
