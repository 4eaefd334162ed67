//! Shared parts of the verbs: reading, writing, printing, progress, and options with units.

use std::fmt::Display;
use std::fs;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::{Failure, note, say, waiting};
use crate::results::bend::rows;
use crate::results::with_bends;
use softlimb_files::write_whole;
use softlimb_limb::Limb;
use softlimb_scene::{CorrectionRow, PhaseCorrections, Quantity, Scene};

/// Destinations of a table.
#[derive(Args)]
pub(super) struct Kept {
    /// Print the table as JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Write the table as tab-separated values
    #[arg(long, value_name = "FILE")]
    pub(super) tsv: Option<PathBuf>,
    /// Write the picture
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<PathBuf>,
}

/// Prints a result as one line of JSON or as text.
pub(super) fn show<T: Serialize>(as_json: bool, result: &T, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if as_json { say(&serde_json::to_string(result).map_err(Failure::new)?) } else { say(&text()) }
}

/// Prints a result about a limb as [`show`], with the models of its bends and what 2 deg of winding do to them.
pub(super) fn show_of<T: Serialize>(
    as_json: bool,
    limb: &Limb,
    result: &T,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    if as_json {
        return show(true, &with_bends(limb, result), String::new);
    }
    show(false, result, || with_rows(text(), &rows(limb)))
}

/// A text with lines behind it, if there are some.
pub(super) fn with_rows(text: String, rows: &[String]) -> String {
    if rows.is_empty() { text } else { format!("{}\n\n{}", text.trim_end(), rows.join("\n")) }
}

/// A scene and its limb.
pub(super) fn limb(file: &Path) -> Result<(Scene, Limb), Failure> {
    let scene = softlimb_scene::load(file)?;
    let limb = Limb::new(&scene)?;
    Ok((scene, limb))
}

/// A failure about a file.
pub(super) fn about(file: &Path) -> impl Fn(&dyn Display) -> Failure {
    move |error| Failure::new(format!("{}: {error}", file.display()))
}

/// The text of a file.
///
/// # Errors
/// [`Failure`] that names the file.
pub fn read(file: &Path) -> Result<String, Failure> {
    fs::read_to_string(file).map_err(|error| Failure::file("read", file, &error))
}

/// Writes a file, whole or not at all, and says so.
///
/// # Errors
/// [`Failure`] that names the file.
pub fn write(file: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), Failure> {
    write_whole(file, content).map_err(Failure::new)?;
    note(&format!("wrote {}", file.display()));
    Ok(())
}

/// Writes a file if its name is given.
pub(super) fn write_if(file: Option<&PathBuf>, content: impl FnOnce() -> String) -> Result<(), Failure> {
    file.map_or(Ok(()), |file| write(file, &content()))
}

/// Progress on a terminal; nothing elsewhere.
pub(super) fn bar(length: u64, message: &'static str) -> ProgressBar {
    waiting::displays();
    let style = ProgressStyle::with_template("{prefix} [{bar:40}] {percent:>3} %  {elapsed_precise}  {msg}");
    let style = style.map_or_else(|_| ProgressStyle::default_bar(), |style| style.progress_chars("=> "));
    ProgressBar::new(length).with_style(style).with_prefix(message)
}

/// Number of threads: as given, or one for each processor.
pub(super) fn threads(given: Option<u16>) -> usize {
    given.map_or_else(|| available_parallelism().map_or(1, NonZero::get), usize::from)
}

/// Parser of an option from `low` to `high`, both in `unit`, which is also the unit of a plain number.
pub(super) fn quantity(
    unit: &'static str,
    low: f64,
    high: f64,
) -> impl Fn(&str) -> Result<Quantity, String> + Clone + Send + Sync + 'static {
    move |text| {
        let found = softlimb_scene::quantity(text, unit)?;
        let [low, high] = ends(unit, [low, high])?;
        if (low..=high).contains(&found.si()) {
            return Ok(found);
        }
        Err(format!("the range is {} to {}", found.shown(low), found.shown(high)))
    }
}

/// Parser of an option above 0 and up to `high` in `unit`, which is also the unit of a plain number.
pub(super) fn above_zero(
    unit: &'static str,
    high: f64,
) -> impl Fn(&str) -> Result<Quantity, String> + Clone + Send + Sync + 'static {
    move |text| {
        let found = softlimb_scene::quantity(text, unit)?;
        let [zero, high] = ends(unit, [0.0, high])?;
        if found.si() > zero && found.si() <= high {
            return Ok(found);
        }
        let bound = if high.is_finite() { format!(", at most {}", found.shown(high)) } else { String::new() };
        Err(format!("the range is > {}{bound}", found.shown(zero)))
    }
}

/// Values of an option with several parts, such as `772,3mm,0.2`, each above 0 and up to a bound in its unit.
pub(super) fn parts<const N: usize>(
    flag: &str,
    text: &str,
    rules: [(&'static str, f64); N],
) -> Result<[f64; N], Failure> {
    let texts: Vec<&str> = text.split(',').collect();
    let texts = <[&str; N]>::try_from(texts).map_err(|texts| {
        let units = rules.map(|(unit, _)| unit).join(", ");
        Failure::wrong_line(format!("{flag} has {} values: {N} are required, in {units}", texts.len()))
    })?;
    let mut values = [0.0; N];
    for ((value, text), (unit, high)) in values.iter_mut().zip(texts).zip(rules) {
        let read = above_zero(unit, high)(text);
        *value = read.map_err(|rule| Failure::wrong_line(format!("{flag}: {text} is not allowed: {rule}")))?.si();
    }
    Ok(values)
}

/// Ends of a range in SI units; an infinite one stays so.
fn ends(unit: &str, range: [f64; 2]) -> Result<[f64; 2], String> {
    let one = softlimb_scene::quantity(&format!("1 {unit}"), unit)?.si();
    let end = |end: f64| match end.is_finite() {
        true => softlimb_scene::quantity(&end.to_string(), unit).map(|found| found.si()),
        false => Ok(end * one),
    };
    Ok([end(range[0])?, end(range[1])?])
}

/// Corrections as a CSV file: one row per instant of a phase; one column per module, or per actuator where those of a module differ, and again
/// for the planned setpoints.
pub(super) fn corrections_csv(scene: &Scene, corrections: &PhaseCorrections) -> String {
    let (mut header, mut columns) = (["phase", "move", "hold_s"].map(str::to_owned).to_vec(), Vec::new());
    type Values = fn(&CorrectionRow) -> &Vec<f64>;
    let sets: [(&str, Values); 2] = [("", |row| &row.values), (".planned", |row| &row.planned)];
    for (suffix, set) in sets {
        let mut first = 0;
        for module in scene.modules() {
            let (name, channels) = (&module.name.value, first..first + usize::from(module.actuators));
            first = channels.end;
            let are_equal = |row: &CorrectionRow| {
                let own = &set(row)[channels.clone()];
                own.iter().all(|value| *value == own[0])
            };
            if corrections.phases.iter().flatten().all(are_equal) {
                header.push(format!("{name}{suffix}"));
                columns.push((set, channels.start));
            } else {
                header.extend((1..=channels.len()).map(|number| format!("{name}{suffix}.{number}")));
                columns.extend(channels.map(|channel| (set, channel)));
            }
        }
    }
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let phases = scene.phases().iter().zip(&corrections.phases);
    let rows = phases.flat_map(|(phase, rows)| rows.iter().map(|row| (&phase.name.value, row)));
    let cells = rows.map(|(phase, row)| {
        let when = [phase.clone(), format!("{:.9}", row.move_share), format!("{:.6}", row.hold_s)];
        when.into_iter().chain(columns.iter().map(|(set, column)| format!("{:.9}", set(row)[*column])))
    });
    softlimb_files::table::written(&header, cells)
}
