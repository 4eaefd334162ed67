//! The summary for a terminal.

use super::Summary;
use super::rows::{self, ErrorRow, ModuleRow};
use crate::record::Observer;
use softlimb_chart::labelled;
use std::fmt::Write;

/// Columns of a terminal that the text may take.
const WIDTH: usize = 100;
/// Names longer than this are cut, so that a line stays within the width.
const NAME_WIDTH: usize = 15;
const MOTION_WIDTH: usize = 10;
/// More faults than this are counted, not listed.
const FAULTS_LISTED: usize = 10;

impl Summary {
    /// The summary as text: aligned columns, units in the headings, at most 100
    /// columns wide, a newline at the end. Angles in deg, lengths in mm, pressures in
    /// kPa.
    pub fn table(&self) -> String {
        let mut text = format!("{}  ({})\n", cut(&self.scene, 48), origin(self));
        let _ = writeln!(text, "{}", rows::time(self));
        if let Some(reason) = &self.incomplete {
            let _ = writeln!(text, "incomplete log: {}", cut(reason, 80));
        }
        text.push('\n');
        text.push_str(&aligned(&module_cells(rows::module_value(self), &rows::modules(self)), &[4, 5, 6, 7]));
        text.push('\n');
        text.push_str(&aligned(&error_cells(&rows::errors(self)), &[1, 2]));
        text.push('\n');
        text.push_str(&link(self));
        text.push_str(&contacts(self));
        text.push_str(&injected(self));
        text.push_str(&faults(self));
        text
    }
}

/// Origin of the run's numbers.
pub(super) fn origin(summary: &Summary) -> String {
    let origin = match (summary.simulated, summary.seed) {
        (true, Some(seed)) => format!("simulated, seed {seed}"),
        (true, None) => "simulated".to_owned(),
        (false, _) => "on a device".to_owned(),
    };
    let words = summary.truth.as_deref().into_iter().chain(summary.corrections.then_some("corrected setpoints"));
    let words = words.chain(summary.observer.map(|observer| match observer {
        Observer::Camera => "feedback by camera",
        Observer::Imus => "feedback by IMUs",
    }));
    let origin = words.fold(origin, |origin, words| format!("{origin}, {words}"));
    labelled(&origin, summary.weightless)
}

/// The counters, on as many lines as they need.
fn link(summary: &Summary) -> String {
    let mut text = String::from("link  ");
    let mut used = text.len();
    for fact in rows::link(summary) {
        let entry = format!("  {} {}", fact.name, fact.value);
        if used + entry.len() > WIDTH {
            text.push_str("\n      ");
            used = 6;
        }
        used += entry.len();
        text.push_str(&entry);
    }
    text.push('\n');
    text
}

/// Obstacles that stopped the limb; nothing in a run without.
fn contacts(summary: &Summary) -> String {
    let contact = |contact| format!("contact  {}\n", cut(&rows::contact(contact), WIDTH - 9));
    summary.contacts.iter().map(contact).collect()
}

/// Faults met on purpose, and the pressure they came to; nothing in a run without.
fn injected(summary: &Summary) -> String {
    if summary.injected_faults.is_empty() {
        return String::new();
    }
    let mut text = format!("faults on purpose  {}\n", summary.injected_faults.len());
    for fault in &summary.injected_faults {
        let _ = writeln!(text, "  {}", cut(&rows::injected(fault), WIDTH - 2));
    }
    rows::peak(summary).into_iter().for_each(|peak| text.push_str(&format!("highest true pressure  {peak}\n")));
    text
}

fn faults(summary: &Summary) -> String {
    let mut text = match summary.faults.len() {
        0 => return "faults  none\n".to_owned(),
        count => format!("faults  {count}\n"),
    };
    for fault in summary.faults.iter().take(FAULTS_LISTED) {
        let _ = writeln!(text, "  {}", cut(&rows::fault(fault), WIDTH - 2));
    }
    if let Some(more @ 1..) = summary.faults.len().checked_sub(FAULTS_LISTED) {
        let _ = writeln!(text, "  and {more} more");
    }
    text
}

fn module_cells(value: &str, rows: &[ModuleRow]) -> Vec<Vec<String>> {
    let heading = ["module", "motion", "channels", "quantity", "setpoint", value, "RMSE", "max"];
    let mut cells = vec![heading.map(str::to_owned).to_vec()];
    cells.extend(rows.iter().map(|row| {
        vec![
            cut(&row.name, NAME_WIDTH),
            cut(&row.motion, MOTION_WIDTH),
            row.channels.clone(),
            row.quantity.clone(),
            row.setpoint.clone(),
            row.value.clone(),
            row.rmse.clone(),
            row.max.clone(),
        ]
    }));
    cells
}

fn error_cells(rows: &[ErrorRow]) -> Vec<Vec<String>> {
    let mut cells = vec![["error until venting", "RMSE", "max"].map(str::to_owned).to_vec()];
    cells.extend(rows.iter().map(|row| vec![row.name.to_owned(), row.rmse.clone(), row.max.clone()]));
    cells
}

/// Lines of equally wide columns; those in `right` hold numbers.
fn aligned(cells: &[Vec<String>], right: &[usize]) -> String {
    let columns = cells.first().map_or(0, Vec::len);
    let width = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in cells {
        let padded = row.iter().enumerate().map(|(column, cell)| match right.contains(&column) {
            true => format!("{cell:>0$}", widths[column]),
            false => format!("{cell:<0$}", widths[column]),
        });
        let line = padded.collect::<Vec<_>>().join("  ");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// At most `width` characters on one line.
fn cut(text: &str, width: usize) -> String {
    let line = text.replace(char::is_control, " ");
    match line.chars().count() <= width {
        true => line,
        false => line.chars().take(width.saturating_sub(1)).chain(['…']).collect(),
    }
}
