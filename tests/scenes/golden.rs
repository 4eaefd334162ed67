//! The figures of merit of every scene as a table that a review can read.
//!
//! `SOFTLIMB_WRITE_GOLDEN=1 cargo test -p softlimb-tests --test scenes golden` writes it anew; the change then says why.

use std::fmt::Write;
use std::path::Path;

use softlimb_rig::report::Summary;

use crate::AS_IT_IS;

/// How far a figure may drift, either way, before the table has to be written anew. Valve pulses fall otherwise after the last bit of a
/// pressure changed, so figures are only equal in the statistical sense.
const DRIFT: f64 = 0.25;

const HEADING: &str = "scene\tpart\tquantity\terror RMSE\ttracking error RMSE\tunit\n";

/// One line per module, tip and pressures, tab-separated.
fn rows(summary: &Summary) -> String {
    let mut text = String::new();
    let mut row = |part: &str, quantity: &str, error: f64, tracking: Option<f64>, unit: &str| {
        let tracking = tracking.map_or_else(|| "-".to_owned(), |tracking| format!("{tracking:.3}"));
        let _ = writeln!(text, "{}\t{part}\t{quantity}\t{error:.3}\t{tracking}\t{unit}", summary.scene);
    };
    for module in &summary.modules {
        let (error, tracking) = (module.error.unwrap().rmse, module.tracking_error.unwrap().rmse);
        let (scale, unit) = if module.unit == "rad" { (1f64.to_degrees(), "deg") } else { (1e3, "1e-3") };
        row(&module.name, module.quantity.label(), scale * error, Some(scale * tracking), unit);
    }
    let tip = &summary.tip;
    row("tip", "position", 1e3 * tip.error_m.unwrap().rmse, Some(1e3 * tip.tracking_error_m.unwrap().rmse), "mm");
    let pressure = summary.pressure.true_error_pa.unwrap().rmse * 1e-3;
    row("channels", "gauge pressure", pressure, None, "kPa");
    text
}

/// Words and figures of a table.
fn cells(text: &str) -> Vec<Vec<&str>> {
    text.lines().map(|line| line.split('\t').collect()).collect()
}

/// Same words, and figures within [`DRIFT`] or the last digit.
fn alike(golden: &str, found: &str) -> bool {
    match (golden.parse::<f64>(), found.parse::<f64>()) {
        (Ok(golden), Ok(found)) => (golden - found).abs() <= (DRIFT * golden).max(2e-3),
        _ => golden == found,
    }
}

#[test]
fn figures_of_merit_are_those_of_the_table() {
    let found: String = AS_IT_IS.iter().map(|(_, _, ran)| rows(&ran.summary)).collect();
    let found = HEADING.to_owned() + &found;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/scenes.tsv");
    if std::env::var_os("SOFTLIMB_WRITE_GOLDEN").is_some() {
        std::fs::write(&path, &found).unwrap();
    }
    let golden = std::fs::read_to_string(&path).unwrap();
    let (golden, found) = (cells(&golden), cells(&found));
    assert_eq!(golden.len(), found.len(), "other scenes or modules than in {}", path.display());
    for (golden, found) in golden.iter().zip(&found) {
        let same = golden.len() == found.len() && golden.iter().zip(found).all(|(a, b)| alike(a, b));
        assert!(same, "the table has\n{golden:?}, the run\n{found:?}\nin {}", path.display());
    }
}

#[test]
fn drift_is_seen() {
    assert!(alike("0.400", "0.480") && alike("elbow", "elbow") && alike("0.001", "0.002"));
    assert!(!alike("0.400", "0.510") && !alike("0.400", "0.290") && !alike("elbow", "wrist") && !alike("0.4", "NaN"));
}
