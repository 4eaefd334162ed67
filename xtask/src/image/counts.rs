//! Instruction counts: from the timer, against those recorded, into the record.

use std::fs;

use super::Counts;
use crate::cargo::root;
use crate::emulator::{counts, instructions};
use crate::table::Row;

/// The record, from the root of the workspace.
const RECORD: &str = "firmware/boards/mps2-an386/counts.tsv";
const HEADER: &str = "question\tactuator\tinstructions\titerations\tstatus";

/// A question may cost this much more or less than recorded, in per cent: what a change elsewhere does to the layout of the code.
const MARGIN: i64 = 5;

/// Questions whose cost is known beforehand: nothing, and loops of two instructions a round.
const NOTHING: &str = "nothing";
const LOOPS: [(&str, i64); 2] = [("1000 rounds", 2000), ("51000 rounds", 102_000)];

/// The rows with instructions in place of counts, without those that calibrate.
///
/// # Errors
/// A loop of known length does not cost what it must.
pub(super) fn converted(rows: Vec<Row>) -> Result<Vec<Row>, String> {
    let cost = |question: &str| {
        let row = rows.iter().find(|row| row.question == question).and_then(|row| row.cost);
        row.ok_or_else(|| format!("the image does not count `{question}`"))
    };
    let nothing = cost(NOTHING)?;
    let [(short, few), (long, many)] = LOOPS;
    let (found, expected) = (cost(long)? - cost(short)?, counts(many - few));
    if found != expected {
        return Err(format!("{} instructions take {found} counts of the timer, not {expected}", many - few));
    }
    let calibrates = |question: &str| question == NOTHING || LOOPS.iter().any(|(name, _)| *name == question);
    let rows = rows.into_iter().filter(|row| !calibrates(&row.question));
    Ok(rows.map(|row| Row { cost: row.cost.map(|counted| instructions(counted - nothing)), ..row }).collect())
}

/// Prints the table; compares it with the record, or records it.
///
/// # Errors
/// A question costs more or less than recorded with the same compiler, or the record is not of these questions.
pub(super) fn report(rows: &[Row], compiler: &str, what: Counts) -> Result<(), String> {
    print(rows);
    if what == Counts::Record {
        let path = root().join(RECORD);
        println!("xtask: recorded in {RECORD}");
        return fs::write(&path, record(rows, compiler)).map_err(|error| format!("{}: {error}", path.display()));
    }
    let recorded = fs::read_to_string(root().join(RECORD)).map_err(|error| format!("{RECORD}: {error}"))?;
    let again = "`cargo xtask model-image --record` records them anew";
    match verdict(rows, compiler, &recorded) {
        Verdict::Same => println!("xtask: every question costs what is recorded in {RECORD}, within {MARGIN} %"),
        Verdict::OtherCompiler => println!("xtask: not compared with {RECORD}, which another compiler made"),
        Verdict::OtherQuestions => return Err(format!("{RECORD} is not of these questions; {again}")),
        Verdict::Costs(other) => {
            return Err(format!("other instruction counts than in {RECORD}:\n  {}\n{again}", other.join("\n  ")));
        }
    }
    Ok(())
}

fn print(rows: &[Row]) {
    println!("{:>12}  {:>10}  question, actuator", "instructions", "iterations");
    for row in rows {
        let cost = row.cost.map_or_else(|| "-".to_owned(), |cost| cost.to_string());
        println!("{cost:>12}  {:>10}  {}, {}", row.iterations, row.question, row.actuator);
    }
}

fn record(rows: &[Row], compiler: &str) -> String {
    let mut text = format!("# Cortex-M4F, f32; {compiler}; made by `cargo xtask model-image --record`\n{HEADER}\n");
    for row in rows {
        let cost = row.cost.unwrap_or_default();
        text += &format!("{}\t{}\t{cost}\t{}\t{}\n", row.question, row.actuator, row.iterations, row.status);
    }
    text
}

#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    Same,
    OtherCompiler,
    OtherQuestions,
    /// The questions whose cost is another.
    Costs(Vec<String>),
}

fn verdict(rows: &[Row], compiler: &str, recorded: &str) -> Verdict {
    let recorded_rows: Vec<Vec<&str>> =
        recorded.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split('\t').collect()).collect();
    let same = |row: &Row, fields: &[&str]| matches!(fields, [one, other, ..] if row.name() == (*one, *other));
    if rows.len() != recorded_rows.len() || !rows.iter().zip(&recorded_rows).all(|(row, fields)| same(row, fields)) {
        return Verdict::OtherQuestions;
    }
    if !recorded.lines().next().is_some_and(|line| line.contains(compiler)) {
        return Verdict::OtherCompiler;
    }
    let mut other = Vec::new();
    for (row, fields) in rows.iter().zip(&recorded_rows) {
        let before = fields.get(2).and_then(|cost| cost.parse::<i64>().ok());
        let (Some(before), Some(now)) = (before, row.cost) else { return Verdict::OtherQuestions };
        if (now - before).abs() * 100 > before * MARGIN {
            other.push(format!("{}, {}: {now}, recorded {before}", row.question, row.actuator));
        }
    }
    if other.is_empty() { Verdict::Same } else { Verdict::Costs(other) }
}

#[cfg(test)]
mod tests {
    use super::{Verdict, converted, record, verdict};
    use crate::table::read;

    /// Lines of an image whose timer counts 6.4 an instruction, 7 of them for nothing.
    fn image(long: i64, held: i64) -> String {
        format!(
            "nothing\t-\t7\t0\t-\t0\t0\n1000 rounds\t-\t12807\t0\t-\t0\t0\n51000 rounds\t-\t{long}\t0\t-\t0\t0\n\
             held\tbending\t{held}\t3\tsolved\t1\t2\n"
        )
    }

    #[test]
    fn counts_become_instructions_if_the_loop_is_as_long_as_it_is() {
        let rows = converted(read(&image(652_807, 647)).unwrap()).unwrap();
        assert_eq!(
            rows.iter().map(|row| (row.name(), row.cost)).collect::<Vec<_>>(),
            [(("held", "bending"), Some(100))]
        );
        assert!(converted(read(&image(652_808, 647)).unwrap()).is_err());
        assert!(converted(read("held\tbending\t647\t3\tsolved\t1\t2\n").unwrap()).is_err());
    }

    #[test]
    fn other_costs_than_recorded_are_refused() {
        let rows = |held| converted(read(&image(652_807, held)).unwrap()).unwrap();
        let recorded = record(&rows(6407), "rustc 1.96.0");
        assert_eq!(verdict(&rows(6407), "rustc 1.96.0", &recorded), Verdict::Same);
        assert_eq!(verdict(&rows(6663), "rustc 1.96.0", &recorded), Verdict::Same);
        assert_eq!(verdict(&rows(6407), "rustc 1.97.0", &recorded), Verdict::OtherCompiler);
        assert_eq!(verdict(&[], "rustc 1.96.0", &recorded), Verdict::OtherQuestions);
        for (counts, cost) in [(6791, 1060), (6023, 940)] {
            let costs = Verdict::Costs(vec![format!("held, bending: {cost}, recorded 1000")]);
            assert_eq!(verdict(&rows(counts), "rustc 1.96.0", &recorded), costs);
        }
    }
}
