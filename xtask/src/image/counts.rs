//! Instruction counts: from the timer, against those recorded, into the record.

use std::fs;

use super::Counts;
use super::trace::Stretch;
use crate::cargo::root;
use crate::emulator::{counts, instructions};
use crate::table::Row;

/// The record, from the root of the workspace.
const RECORD: &str = "firmware/boards/mps2-an386/counts.tsv";
const HEADER: &str = "question\tactuator\tinstructions\tcycles\titerations\tstatus";

/// A question may cost this much more or less than recorded, in per cent: what a change elsewhere does to the layout of the code.
const MARGIN: i64 = 5;

/// Questions whose cost is known beforehand: nothing, and loops of two instructions a round.
const NOTHING: &str = "nothing";
const LOOPS: [(&str, i64); 2] = [("1000 rounds", 2000), ("51000 rounds", 102_000)];
/// The compiler may put this many instructions between where the timer is read and where a stretch begins or ends.
const BETWEEN: i64 = 8;
/// A subtraction, and a branch back.
const CYCLES_OF_TWO: i64 = 1 + 3;

/// The rows with the cycles of their stretches.
///
/// # Errors
/// The stretches are not of these rows: there are more or fewer, or one has another number of instructions than the timer says.
pub(super) fn with_stretches(mut rows: Vec<Row>, stretches: &[Stretch]) -> Result<Vec<Row>, String> {
    let (Some(first), Some(nothing)) = (rows.first().and_then(|row| row.cost), stretches.first()) else {
        return Err("the image counts nothing".to_owned());
    };
    if rows.len() != stretches.len() {
        return Err(format!("{} answers, but {} stretches of the program", rows.len(), stretches.len()));
    }
    for (row, stretch) in rows.iter_mut().zip(stretches) {
        let timed = row.cost.map(|cost| instructions(cost - first));
        let traced = stretch.instructions - nothing.instructions;
        if timed.is_none_or(|timed| (timed - traced).abs() > BETWEEN) {
            let name = row.name();
            return Err(format!("{name:?}: {timed:?} instructions by the timer, {traced} by the emulator's account"));
        }
        row.cycles = Some(stretch.cycles);
    }
    Ok(rows)
}

/// The rows with instructions in place of counts, without those that calibrate. Without cycles where nothing was traced.
///
/// # Errors
/// A loop of known length does not cost what it must.
pub(super) fn converted(rows: Vec<Row>) -> Result<Vec<Row>, String> {
    let of = |question: &str| {
        let row = rows.iter().find(|row| row.question == question);
        let costs = row.and_then(|row| Some((row.cost?, row.cycles)));
        costs.ok_or_else(|| format!("the image does not count `{question}`"))
    };
    let less = |cycles: Option<i64>, by: Option<i64>| Some(cycles? - by?);
    let nothing = of(NOTHING)?;
    let [(short, few), (long, many)] = LOOPS;
    let (short, long) = (of(short)?, of(long)?);
    let found = (long.0 - short.0, less(long.1, short.1));
    let expected = (counts(many - few), found.1.map(|_| CYCLES_OF_TWO * (many - few) / 2));
    if found != expected {
        return Err(format!(
            "{} instructions take {found:?} counts of the timer and cycles, not {expected:?}",
            many - few
        ));
    }
    let calibrates = |question: &str| question == NOTHING || LOOPS.iter().any(|(name, _)| *name == question);
    let cost = |row: &Row| Some(instructions(row.cost? - nothing.0));
    let rows = rows.iter().filter(|row| !calibrates(&row.question));
    Ok(rows.map(|row| Row { cost: cost(row), cycles: less(row.cycles, nothing.1), ..row.clone() }).collect())
}

/// The rows with the cycles of the record, if the same compiler made it and every question takes the recorded number of instructions, which
/// are then taken for the recorded ones.
///
/// # Errors
/// The record cannot be read.
pub(super) fn with_recorded_cycles(rows: &[Row], compiler: &str) -> Result<Option<Vec<Row>>, String> {
    Ok(cycles_of(rows, compiler, &recorded()?))
}

fn cycles_of(rows: &[Row], compiler: &str, recorded: &str) -> Option<Vec<Row>> {
    let (found_by, lines) = lines(recorded);
    if !found_by.contains(compiler) || lines.len() != rows.len() {
        return None;
    }
    let with_cycles = |(row, fields): (&Row, &Vec<&str>)| {
        let [question, actuator, cost, cycles, ..] = fields[..] else { return None };
        let is_same = row.name() == (question, actuator) && cost.parse().ok() == row.cost;
        is_same.then_some(Row { cycles: Some(cycles.parse().ok()?), ..row.clone() })
    };
    rows.iter().zip(&lines).map(with_cycles).collect()
}

/// The record as it is.
fn recorded() -> Result<String, String> {
    fs::read_to_string(root().join(RECORD)).map_err(|error| format!("{RECORD}: {error}"))
}

/// The head of a record, which names the compiler, and the fields of its lines.
fn lines(recorded: &str) -> (&str, Vec<Vec<&str>>) {
    let lines = recorded.lines().filter(|line| !line.starts_with('#')).skip(1);
    (recorded.lines().next().unwrap_or_default(), lines.map(|line| line.split('\t').collect()).collect())
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
    let recorded = recorded()?;
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
    println!("{:>12}  {:>9}  {:>10}  question, actuator", "instructions", "cycles", "iterations");
    for row in rows {
        let [cost, cycles] =
            [row.cost, row.cycles].map(|cost| cost.map_or_else(|| "-".to_owned(), |cost| cost.to_string()));
        println!("{cost:>12}  {cycles:>9}  {:>10}  {}, {}", row.iterations, row.question, row.actuator);
    }
}

fn record(rows: &[Row], compiler: &str) -> String {
    let mut text = format!(
        "# Cortex-M4F, f32; cycles by an estimate, memory without waits; {compiler}; made by `cargo xtask model-image --record`\n{HEADER}\n"
    );
    for row in rows {
        let [cost, cycles] = [row.cost, row.cycles].map(Option::unwrap_or_default);
        text += &format!("{}\t{}\t{cost}\t{cycles}\t{}\t{}\n", row.question, row.actuator, row.iterations, row.status);
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
    let (found_by, recorded_rows) = lines(recorded);
    let same = |row: &Row, fields: &[&str]| matches!(fields, [one, other, ..] if row.name() == (*one, *other));
    if rows.len() != recorded_rows.len() || !rows.iter().zip(&recorded_rows).all(|(row, fields)| same(row, fields)) {
        return Verdict::OtherQuestions;
    }
    if !found_by.contains(compiler) {
        return Verdict::OtherCompiler;
    }
    let mut other = Vec::new();
    for (row, fields) in rows.iter().zip(&recorded_rows) {
        for (what, now, field) in [("instructions", row.cost, 2), ("cycles", row.cycles, 3)] {
            let before = fields.get(field).and_then(|cost| cost.parse::<i64>().ok());
            let (Some(before), Some(now)) = (before, now) else { return Verdict::OtherQuestions };
            if (now - before).abs() * 100 > before * MARGIN {
                other.push(format!("{}, {}: {now} {what}, recorded {before}", row.question, row.actuator));
            }
        }
    }
    if other.is_empty() { Verdict::Same } else { Verdict::Costs(other) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::read;

    /// Lines of an image whose timer counts 6.4 an instruction, 7 of them for nothing.
    fn image(long: i64, held: i64) -> Vec<Row> {
        let text = format!(
            "nothing\t-\t7\t0\t-\t0\t0\n1000 rounds\t-\t12807\t0\t-\t0\t0\n51000 rounds\t-\t{long}\t0\t-\t0\t0\n\
             held\tbending\t{held}\t3\tsolved\t1\t2\n"
        );
        read(&text).unwrap()
    }

    /// Stretches of the same, two cycles an instruction, four instructions and five cycles for nothing.
    fn stretches(held: i64) -> [Stretch; 4] {
        let stretch = |instructions| Stretch { instructions: instructions + 4, cycles: 2 * instructions + 5 };
        [0, 2000, 102_000, held].map(stretch)
    }

    fn rows(long: i64, held: i64) -> Result<Vec<Row>, String> {
        converted(with_stretches(image(long, 7 + held * 64 / 10), &stretches(held))?)
    }

    #[test]
    fn counts_become_instructions_if_the_loop_is_as_long_as_it_is() {
        let found = rows(652_807, 100).unwrap();
        let told: Vec<_> = found.iter().map(|row| (row.name(), row.cost, row.cycles)).collect();
        assert_eq!(told, [(("held", "bending"), Some(100), Some(200))]);
        let timed = converted(image(652_807, 647)).unwrap();
        assert_eq!((timed[0].cost, timed[0].cycles), (Some(100), None), "nothing was traced");
        assert!(rows(652_817, 100).is_err(), "a longer loop");
    }

    #[test]
    fn timer_and_account_have_to_agree() {
        assert!(with_stretches(image(652_807, 647), &stretches(108)).is_ok());
        assert!(with_stretches(image(652_807, 647), &stretches(109)).is_err());
        assert!(with_stretches(image(652_807, 647), &stretches(100)[..3]).is_err());
        assert!(with_stretches(Vec::new(), &[]).is_err());
    }

    #[test]
    fn cycles_of_the_record_are_those_of_the_same_instructions_by_the_same_compiler() {
        let timed = |held: i64| converted(image(652_807, 7 + held * 64 / 10)).unwrap();
        let recorded = record(&rows(652_807, 1000).unwrap(), "rustc 1.96.0");
        let known = cycles_of(&timed(1000), "rustc 1.96.0", &recorded).unwrap();
        assert_eq!((known[0].cost, known[0].cycles), (Some(1000), Some(2000)));
        assert_eq!(cycles_of(&timed(1005), "rustc 1.96.0", &recorded), None, "other instructions");
        assert_eq!(cycles_of(&timed(1000), "rustc 1.97.0", &recorded), None);
        assert_eq!(cycles_of(&[], "rustc 1.96.0", &recorded), None);
    }

    #[test]
    fn other_costs_than_recorded_are_refused() {
        let rows = |held| rows(652_807, held).unwrap();
        let recorded = record(&rows(1000), "rustc 1.96.0");
        assert_eq!(verdict(&rows(1000), "rustc 1.96.0", &recorded), Verdict::Same);
        assert_eq!(verdict(&rows(1050), "rustc 1.96.0", &recorded), Verdict::Same);
        assert_eq!(verdict(&rows(1000), "rustc 1.97.0", &recorded), Verdict::OtherCompiler);
        assert_eq!(verdict(&[], "rustc 1.96.0", &recorded), Verdict::OtherQuestions);
        for cost in [1060, 940] {
            let told = [format!("{cost} instructions, recorded 1000"), format!("{} cycles, recorded 2000", 2 * cost)];
            let costs = Verdict::Costs(told.map(|told| format!("held, bending: {told}")).to_vec());
            assert_eq!(verdict(&rows(cost), "rustc 1.96.0", &recorded), costs);
        }
    }
}
