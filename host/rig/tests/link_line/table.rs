//! Faults of a line against its speed: rates, latencies and set points, as a table that a review can read.
//!
//! `SOFTLIMB_WRITE_GOLDEN=1 cargo test -p softlimb-rig --test main link_line::table` writes table and page anew.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Case, Outcome};
use softlimb_rig::link::LinkFaults;

const BAUDS: [u32; 3] = [115_200, 921_600, 1_000_000];

/// Faults of both directions, by the words of `--link-fault`.
const FAULTS: [&str; 7] =
    ["loss=0", "loss=0.01", "loss=0.05", "loss=0.1", "loss=0.2", "flip=0.01", "loss=0.05,flip=0.01,stall=0.0005:600ms"];

/// Set points a second that are tried for the highest rate; the first is that of the latencies.
const RATES: [u64; 6] = [50, 100, 200, 250, 500, 1000];

const HEADING: &str =
    "baud\tfaults\tset points/s\tp50, ms\tp99, ms\tleast buffer, s\trepeated\tsamples, %\tlate\twrong";

/// Where the page holds the table.
const PLACE: [&str; 2] = ["<!-- printed: link_line::table -->\n", "<!-- end: link_line::table -->"];

/// Nine channels for 20 s, with 100 samples a second.
fn run(baud: u32, faults: &str, rate: u64) -> Option<Outcome> {
    let case = Case {
        baud,
        channels: 9,
        knot_us: 1_000_000 / rate,
        sample_us: 10_000,
        faults: faults.parse::<LinkFaults>().expect("words of link faults"),
        seed: 1,
        seconds: 20.0,
    };
    case.run().ok().filter(|outcome| !outcome.starved)
}

fn row(baud: u32, faults: &str) -> String {
    let outcome = run(baud, faults, RATES[0]).unwrap_or_else(|| panic!("{baud} Bd, {faults}: without set points"));
    let carried = RATES[1..].iter().take_while(|rate| run(baud, faults, **rate).is_some()).last().unwrap_or(&RATES[0]);
    let (samples, missing) = outcome.samples();
    let counts = &outcome.counts;
    assert_eq!((counts.late, counts.wrong), (0, 0), "{baud} Bd, {faults}");
    [
        baud.to_string(),
        faults.to_owned(),
        carried.to_string(),
        format!("{:.1}", outcome.latency_ms(50)),
        format!("{:.1}", outcome.latency_ms(99)),
        outcome.buffered_min_us.map_or_else(|| "-".to_owned(), |us| format!("{:.2}", us as f64 * 1e-6)),
        outcome.repeated.to_string(),
        format!("{:.1}", 100.0 * samples as f64 / (samples + missing) as f64),
        counts.late.to_string(),
        counts.wrong.to_string(),
    ]
    .join("\t")
}

/// The table as a page shows it.
fn markdown(table: &str) -> String {
    let mut lines = table.lines().map(|line| format!("| {} |\n", line.replace('\t', " | ")));
    let heading = lines.next().unwrap_or_default();
    let ruler = "| ---: | --- |".to_owned() + &" ---: |".repeat(8) + "\n";
    [heading, ruler].into_iter().chain(lines).collect()
}

fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn read(path: &str) -> String {
    fs::read_to_string(file(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn rates_and_latencies_over_bad_lines_are_those_of_the_table() {
    let rows = BAUDS.iter().flat_map(|&baud| FAULTS.iter().map(move |faults| row(baud, faults)));
    let found: String = [HEADING.to_owned()].into_iter().chain(rows).map(|row| row + "\n").collect();
    let (golden, document) = ("tests/golden/link.tsv", "docs/evidence/link.md");
    let page = read(document);
    let (before, rest) = page.split_once(PLACE[0]).expect("the page has a place for it");
    let (_, after) = rest.split_once(PLACE[1]).expect("and an end of it");
    let wanted = format!("{before}{}{}{}{after}", PLACE[0], markdown(&found), PLACE[1]);
    if std::env::var_os("SOFTLIMB_WRITE_GOLDEN").is_some() {
        fs::write(file(golden), &found).unwrap();
        fs::write(file(document), &wanted).unwrap();
    }
    assert_eq!(read(golden), found, "see the head of this test");
    assert_eq!(read(document), wanted, "see the head of this test");
}
