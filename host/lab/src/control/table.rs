//! The table: a line for each size of chamber and group of plants.

use std::fmt::Write;

use serde::Serialize;
use softlimb_numerics::statistics::percentile;

use super::{Group, Method, PLANTS, Trial};
use crate::faults::bench::{CHANNELS, VOLUMES_M3};

/// First line of the file.
pub const HEADING: &str = "loop\tvolume mL\tplants\tpercentile\tfaults\tsettle median\tsettle max\tovershoot kPa\tsteady kPa\tsine kPa\tsine ratio\ttrajectory kPa\ttrajectory max kPa\tswitchings 1/s\tair ratio\tleast pulse kPa\n";

/// Place of the table in its page.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab control -->", "<!-- end of what is written -->"];

/// Figures that are pressures, whose unit is 1 kPa in the table.
const PRESSURES: [bool; 11] = [false, false, true, true, true, false, true, true, false, false, true];

/// One line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Name of the loop.
    pub method: String,
    /// Volume of the chamber at rest, mL.
    pub volume_ml: u32,
    /// Name of the group.
    pub plants: String,
    /// Percentile of each figure over the plants of the group.
    pub percentile: usize,
    /// Runs that a fault ended, in which there was none.
    pub faults: usize,
    /// The figures, pressures in kPa; not a number where no run came to its end.
    pub figures: [f64; 11],
}

/// The lines of trials.
#[must_use]
pub fn lines(trials: &[Trial]) -> Vec<Line> {
    let mut lines = Vec::new();
    for (channel, volume_m3) in VOLUMES_M3.iter().enumerate().take(CHANNELS) {
        for of_group in trials.chunk_by(|a, b| (a.method, a.group) == (b.method, b.group)) {
            let (method, group) = (of_group[0].method, of_group[0].group);
            let percents: &[usize] = if group.is_many() { &[50, 95] } else { &[50] };
            let all: Vec<_> =
                of_group.iter().filter_map(|trial| Some(trial.figures.as_ref()?[channel].values())).collect();
            let faults = of_group.len() - all.len();
            lines.extend(percents.iter().map(|percent| {
                let figure = |index: usize| {
                    let scale = if PRESSURES[index] { 1e-3 } else { 1.0 };
                    let value = percentile(all.iter().map(|values| values[index] * scale), *percent);
                    rounded(value.unwrap_or(f64::NAN))
                };
                Line {
                    method: method.name().to_owned(),
                    volume_ml: (volume_m3 * 1e6).round() as u32,
                    plants: group.name().to_owned(),
                    percentile: *percent,
                    faults,
                    figures: std::array::from_fn(figure),
                }
            }));
        }
    }
    lines
}

fn rounded(value: f64) -> f64 {
    (value * 1e2).round() * 1e-2
}

impl Line {
    /// The line of the file.
    #[must_use]
    pub fn tsv(&self) -> String {
        let figures: Vec<String> = self.figures.iter().map(|figure| format!("{figure:.2}")).collect();
        let Self { method, volume_ml, plants, percentile, faults, .. } = self;
        format!("{method}\t{volume_ml}\t{plants}\t{percentile}\t{faults}\t{}\n", figures.join("\t"))
    }
}

/// The lines of a file; `None` where it is not one of this table.
#[must_use]
pub fn parse(text: &str) -> Option<Vec<Line>> {
    text.strip_prefix(HEADING)?.lines().map(parse_line).collect()
}

fn parse_line(text: &str) -> Option<Line> {
    let cells: Vec<&str> = text.split('\t').collect();
    let [method, volume, plants, percentile, faults, figures @ ..] = cells.as_slice() else { return None };
    let figures: Vec<f64> = figures.iter().map(|cell| cell.parse().ok()).collect::<Option<_>>()?;
    Some(Line {
        method: (*method).to_owned(),
        volume_ml: volume.parse().ok()?,
        plants: (*plants).to_owned(),
        percentile: percentile.parse().ok()?,
        faults: faults.parse().ok()?,
        figures: figures.try_into().ok()?,
    })
}

/// An aim of the predicted pulses: name, group, figure, and the greatest value for the nominal plant or that of 95 % of the plants.
struct Aim {
    name: &'static str,
    group: Group,
    figure: usize,
    most: f64,
}

impl Aim {
    const fn new(name: &'static str, group: Group, figure: usize, most: f64) -> Self {
        Self { name, group, figure, most }
    }
}

/// The aims, stated for 80 mL and a regulated supply.
const AIMS: [Aim; 11] = [
    Aim::new("settle / limit, median of the steps", Group::Nominal, 0, 1.1),
    Aim::new("settle / limit, greatest", Group::Nominal, 1, 4.0),
    Aim::new("overshoot, kPa", Group::Nominal, 2, 1.0),
    Aim::new("overshoot, kPa", Group::Spread, 2, 4.0),
    Aim::new("steady, kPa", Group::Nominal, 3, 0.15),
    Aim::new("steady, kPa", Group::Spread, 3, 0.35),
    Aim::new("trajectory, kPa", Group::Nominal, 6, 0.45),
    Aim::new("trajectory, kPa", Group::Spread, 6, 0.9),
    Aim::new("trajectory, kPa", Group::Untold, 6, 1.5),
    Aim::new("air / least", Group::Nominal, 9, 1.03),
    Aim::new("air / least", Group::Spread, 9, 1.03),
];

/// The aims beside the figures of the predicted pulses.
fn aims(lines: &[Line]) -> String {
    let volumes_ml = VOLUMES_M3.map(|volume_m3| (volume_m3 * 1e6).round() as u32);
    let mut text = "\n| figure | plants | at most |".to_owned();
    volumes_ml.iter().for_each(|volume_ml| text += &format!(" {volume_ml} mL |"));
    text += "\n| --- | --- | --: | --: | --: | --: |\n";
    for Aim { name, group, figure, most } in AIMS {
        let percentile = if group.is_many() { 95 } else { 50 };
        let plants = if group.is_many() { format!("{}, 95 %", group.name()) } else { group.name().to_owned() };
        let _ = write!(text, "| {name} | {plants} | {most:.2} |");
        for volume_ml in volumes_ml {
            let is_it = |line: &&Line| {
                line.method == Method::OURS.name()
                    && (line.volume_ml, line.percentile) == (volume_ml, percentile)
                    && line.plants == group.name()
            };
            let value = lines.iter().find(is_it).map_or(f64::NAN, |line| line.figures[figure]);
            let _ = write!(text, " {value:.2}{} |", if value <= most { "" } else { " (above)" });
        }
        text.push('\n');
    }
    text
}

/// The tables of the page.
#[must_use]
pub fn page(lines: &[Line]) -> String {
    let mut text = aims(lines)
        + "\n| chamber, mL | loop | plants | settle / limit: median | max | overshoot, kPa | steady, kPa | sine, kPa | / limit | trajectory, kPa | max | switchings, 1/s | air / least | least pulse, kPa |\n\
         | --: | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n";
    for line in lines {
        let cells: Vec<String> = line
            .figures
            .iter()
            .map(|figure| if figure.is_nan() { "-".into() } else { format!("{figure:.2}") })
            .collect();
        let plants = if Group::ALL.iter().any(|group| group.is_many() && group.name() == line.plants) {
            format!("{}, {} %", line.plants, line.percentile)
        } else {
            line.plants.clone()
        };
        let _ = writeln!(text, "| {} | {} | {plants} | {} |", line.volume_ml, line.method, cells.join(" | "));
    }
    // Each run has all chambers.
    let of_runs = |line: &&Line| line.method == Method::OURS.name() && line.volume_ml == lines[0].volume_ml;
    let is_first = |line: &&Line| line.percentile == 50;
    let faults: usize = lines.iter().filter(of_runs).filter(is_first).map(|line| line.faults).sum();
    let _ = writeln!(text, "\nFalse faults ended {faults} of {} runs by predicted pulses.", 2 * PLANTS + 3);
    text
}
