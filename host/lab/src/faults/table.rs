//! The table of the matrix: a line for each row and phase.

use std::fmt::Write;

use serde::Serialize;

use super::{Case, Deadline, LIMIT_PA, Outcome, PHASES, Verdict, rows};

/// First line of the file.
pub const HEADING: &str = "fault\tphase\tcases\tpassed\tpeak\tfalse\tmisnamed\tunnoticed\tlate\tnot due\tfrom the fault\ttold\tafter fault ms\tafter effect ms\tdeadline ms\tpeak kPa over limit\n";

/// Place of the table in its page.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab faults -->", "<!-- end of what is written -->"];

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Name of the row.
    pub fault: String,
    /// Name of the phase.
    pub phase: String,
    /// Cases by verdict: all, passed, and the others from the worst on.
    pub cases: [usize; 7],
    /// Cases without a report that was due.
    pub not_due: usize,
    /// Cases that pass where the deadline counts from the fault itself.
    pub prompt: usize,
    /// Codes that were told first.
    pub told: String,
    /// Longest time from the fault until then, ms.
    pub slowest_ms: Option<i64>,
    /// Longest time from the first effect on a true pressure, ms; negative where the report came first.
    pub effect_ms: Option<i64>,
    /// Deadline, ms; `zero` where the report is due when zeros are compared, `-` where none is.
    pub deadline: String,
    /// Highest true pressure of all cases above the limit, kPa.
    pub over_kpa: f64,
}

/// The lines of cases, which are in the order of [`super::cases`].
#[must_use]
pub fn lines(outcomes: &[(Case, Outcome)]) -> Vec<Line> {
    let same = |a: &(Case, Outcome), b: &(Case, Outcome)| a.0.row.name == b.0.row.name && a.0.phase == b.0.phase;
    outcomes.chunk_by(same).map(line).collect()
}

fn line(outcomes: &[(Case, Outcome)]) -> Line {
    let case = outcomes[0].0;
    let count = |verdict| outcomes.iter().filter(|(_, outcome)| outcome.verdict == verdict).count();
    let others = [Verdict::Peak, Verdict::False, Verdict::Misnamed, Verdict::Unnoticed, Verdict::Late].map(count);
    let [peak, wrong, misnamed, unnoticed, late] = others;
    let mut told: Vec<String> =
        outcomes.iter().filter_map(|(_, outcome)| Some(format!("{:?}", outcome.told?.0))).collect();
    told.sort();
    told.dedup();
    let times = outcomes.iter().filter_map(|(_, outcome)| Some((1e3 * outcome.told?.1).round() as i64));
    let of_effect = |(_, outcome): &(Case, Outcome)| Some(1e3 * (outcome.told?.1 - outcome.effect_s?));
    let effects = outcomes.iter().filter_map(of_effect).map(|time_ms| time_ms.round() as i64);
    let highest_pa = outcomes.iter().map(|(_, outcome)| outcome.peak_pa).fold(0.0, f64::max);
    Line {
        fault: case.row.name.to_owned(),
        phase: PHASES[case.phase].0.to_owned(),
        cases: [outcomes.len(), count(Verdict::Passed), peak, wrong, misnamed, unnoticed, late],
        not_due: outcomes.iter().filter(|(_, outcome)| !outcome.due).count(),
        prompt: outcomes.iter().filter(|(_, outcome)| outcome.prompt).count(),
        told: if told.is_empty() { "-".to_owned() } else { told.join(",") },
        slowest_ms: times.max(),
        effect_ms: effects.max(),
        deadline: match case.row.deadline {
            Deadline::Fault(ms) => format!("{ms} from the fault"),
            Deadline::Effect(ms) => ms.to_string(),
            Deadline::Zero => "zero".to_owned(),
            Deadline::Never => "-".to_owned(),
        },
        over_kpa: ((highest_pa - LIMIT_PA) * 1e-2).round() / 10.0,
    }
}

impl Line {
    /// The line of the file.
    #[must_use]
    pub fn tsv(&self) -> String {
        let cases: Vec<String> = self.cases.iter().map(ToString::to_string).collect();
        let [slowest, effect] = [self.slowest_ms, self.effect_ms].map(or_dash);
        let Self { fault, phase, not_due, prompt, told, deadline, over_kpa, .. } = self;
        let cases = cases.join("\t");
        format!(
            "{fault}\t{phase}\t{cases}\t{not_due}\t{prompt}\t{told}\t{slowest}\t{effect}\t{deadline}\t{over_kpa:.1}\n"
        )
    }
}

fn or_dash(value: Option<i64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| value.to_string())
}

/// The lines of a file; `None` where it is not one of the matrix.
#[must_use]
pub fn parse(text: &str) -> Option<Vec<Line>> {
    text.strip_prefix(HEADING)?.lines().map(parse_line).collect()
}

fn parse_line(text: &str) -> Option<Line> {
    let cells: Vec<&str> = text.split('\t').collect();
    let mut cases = [0; 7];
    for (place, cell) in cases.iter_mut().zip(cells.get(2..9)?) {
        *place = cell.parse().ok()?;
    }
    let [not_due, prompt, told, slowest, effect, deadline, over] = cells.get(9..)?.try_into().ok()?;
    Some(Line {
        fault: cells[0].to_owned(),
        phase: cells[1].to_owned(),
        cases,
        not_due: not_due.parse().ok()?,
        prompt: prompt.parse().ok()?,
        told: told.to_owned(),
        slowest_ms: slowest.parse().ok(),
        effect_ms: effect.parse().ok(),
        deadline: deadline.to_owned(),
        over_kpa: over.parse().ok()?,
    })
}

/// The table of the page: a line for each fault, with passed and all cases by phase.
#[must_use]
pub fn page(lines: &[Line]) -> String {
    let phases = PHASES.map(|(name, _)| name).join(" | ");
    let mut text = format!(
        "\n| fault | {phases} | told | after the fault, ms | after its effect, ms | deadline, ms | peak over limit, kPa | why not all |\n| --- |{} --- | --: | --: | --: | --: | --- |\n",
        " --: |".repeat(PHASES.len())
    );
    for of_fault in lines.chunk_by(|a, b| a.fault == b.fault) {
        let cells: Vec<String> = of_fault.iter().map(|line| format!("{}/{}", line.cases[1], line.cases[0])).collect();
        let mut told: Vec<&str> =
            of_fault.iter().flat_map(|line| line.told.split(',')).filter(|it| *it != "-").collect();
        told.sort_unstable();
        told.dedup();
        let slowest = or_dash(of_fault.iter().filter_map(|line| line.slowest_ms).max());
        let effect = or_dash(of_fault.iter().filter_map(|line| line.effect_ms).max());
        let deadline = &of_fault[0].deadline;
        let over_kpa = of_fault.iter().map(|line| line.over_kpa).fold(f64::MIN, f64::max);
        let is_whole = of_fault.iter().all(|line| line.cases[0] == line.cases[1]);
        let fault = &of_fault[0].fault;
        let reason = rows().iter().find(|row| row.name == *fault).map_or("", |row| row.reason);
        let (cells, told, why) = (cells.join(" | "), told.join(", "), if is_whole { "" } else { reason });
        let _ = writeln!(
            text,
            "| {fault} | {cells} | {told} | {slowest} | {effect} | {deadline} | {over_kpa:.1} | {why} |"
        );
    }
    let sum = |index: usize| lines.iter().map(|line| line.cases[index]).sum::<usize>();
    let [all, passed, peak, wrong] = [sum(0), sum(1), sum(2), sum(3)];
    let [misnamed, unnoticed, late] = [sum(4), sum(5), sum(6)];
    let [not_due, prompt] =
        [|line: &Line| line.not_due, |line: &Line| line.prompt].map(|of| lines.iter().map(of).sum::<usize>());
    let _ = writeln!(
        text,
        "\n{passed} of {all} cases pass. {peak} exceed the limit by more than 12 kPa, {wrong} have a false fault, {misnamed} another name, {unnoticed} no report, \
         {late} one after the deadline. In {not_due} no report was due.\n\nCounted from the fault itself, {prompt} of {all} have their report in time."
    );
    text
}
