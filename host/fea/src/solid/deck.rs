//! The text of a deck in the Abaqus dialect: mm, N, MPa.
//!
//! Mesh, ties, sets and isotropic materials read the same in CalculiX and in Abaqus and stand in a file of their own. Each program has a
//! main file with its card for fibers and the steps, so that either runs as it is.

use super::cards::{Program, Text, fibers, layer_name, materials, real, reals};
use super::mesh::{Element, Kind, Part};
use super::options::pressures;

use super::{FemError, Model};
use softlimb_files::{make_folder, write_whole};

/// Elements are numbered from here where they are trusses.
const TRUSSES_FROM: usize = 1_000_000;
/// Smallest increment of a step.
const SMALLEST_INCREMENT: f64 = 1e-5;
/// Most increments of a step: at least so many, and so many times as many as the largest that is allowed would need.
const INCREMENTS: f64 = 1000.0;
const SPARE: f64 = 4.0;

/// The three files of a deck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deck {
    name: String,
    steps: usize,
    /// Mesh, ties, sets, isotropic materials: for both programs.
    pub model: String,
    /// Input of CalculiX.
    pub calculix: String,
    /// Input of Abaqus.
    pub abaqus: String,
}

impl Deck {
    /// Writes the text of a model under rising gauge pressures, Pa: a step for each, which ends at it.
    ///
    /// # Errors
    /// [`FemError::Invalid`] with the first pressure that does not rise.
    pub fn new(model: &Model, name: &str, pressures_pa: &[f64]) -> Result<Self, FemError> {
        pressures(pressures_pa)?;
        let main = |program| main_file(model, name, pressures_pa, program);
        Ok(Self {
            name: name.to_owned(),
            steps: pressures_pa.len(),
            model: model_file(model),
            calculix: main(Program::Calculix),
            abaqus: main(Program::Abaqus),
        })
    }

    /// Its name: that of its files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of its steps: of its pressures.
    pub(super) fn steps(&self) -> usize {
        self.steps
    }

    /// Names of the files and their texts.
    pub fn files(&self) -> [(String, &str); 3] {
        let name = &self.name;
        [
            (format!("{name}-model.inc"), self.model.as_str()),
            (format!("{name}.inp"), self.calculix.as_str()),
            (format!("{name}-abaqus.inp"), self.abaqus.as_str()),
        ]
    }

    /// Writes the files to a folder, which is made if need be. A file is there whole or not at all.
    ///
    /// # Errors
    /// [`FemError::File`].
    pub fn write(&self, folder: &std::path::Path) -> Result<(), FemError> {
        make_folder(folder)?;
        Ok(self.files().iter().try_for_each(|(name, text)| write_whole(&folder.join(name), text))?)
    }
}

fn model_file(model: &Model) -> String {
    let mut text = Text::default();
    text.line("** Mesh, ties, sets and isotropic materials. mm, N, MPa. The axis is z.");
    text.line("*NODE, NSET=ALL");
    for (n, place) in model.mesh.nodes.iter().enumerate() {
        text.line(format_args!("{}, {}", n + 1, reals(place)));
    }
    solids(model, &mut text);
    for (n, trusses) in model.trusses.iter().enumerate().filter(|(_, trusses)| !trusses.pairs.is_empty()) {
        let first = TRUSSES_FROM * (n + 1);
        text.line(format_args!("*ELEMENT, TYPE=T3D2, ELSET={}", trusses.name));
        for (n, [a, b]) in trusses.pairs.iter().enumerate() {
            text.line(format_args!("{}, {}, {}", first + n, a + 1, b + 1));
        }
    }
    lumen(model, &mut text);
    text.set("NSET", "GAUGES", &model.printed().iter().map(|node| node + 1).collect::<Vec<_>>());
    ties(model, &mut text);
    for hold in model.holds.iter().filter(|hold| !hold.nodes.is_empty()) {
        text.line("*BOUNDARY");
        hold.nodes.iter().for_each(|node| text.line(format_args!("{}, {}, {}", node + 1, hold.from, hold.to)));
    }
    materials(model, &mut text);
    text.0
}

/// Elements of the solid, by shape and part; those of the layer by tube too, because each tube has its own axis.
fn solids(model: &Model, text: &mut Text) {
    let name = |index: usize, element: &Element| match element.part {
        Part::Wall => "WALL".to_owned(),
        Part::Cap => "CAP".to_owned(),
        Part::Plate => "PLATE".to_owned(),
        Part::Layer => layer_name(model.tubes.iter().position(|(range, _)| range.contains(&index)).unwrap_or(0)),
    };
    let mut groups = std::collections::BTreeMap::<(String, &str), Vec<usize>>::new();
    for (index, element) in model.mesh.elements.iter().enumerate() {
        let kind = match element.kind {
            Kind::Brick => "C3D20R",
            Kind::Wedge => "C3D15",
        };
        groups.entry((name(index, element), kind)).or_default().push(index);
    }
    for ((set, kind), elements) in &groups {
        text.line(format_args!("*ELEMENT, TYPE={kind}, ELSET={set}"));
        for &index in elements {
            let nodes = model.mesh.elements[index].nodes.iter().map(|node| node + 1);
            text.numbers(&std::iter::once(index + 1).chain(nodes).collect::<Vec<_>>(), true);
        }
    }
}

/// One set for each side by which elements face the air.
fn lumen(model: &Model, text: &mut Text) {
    for side in 1..=6 {
        let elements: Vec<_> = model.lumen.iter().filter(|(_, face)| *face == side).map(|(e, _)| e + 1).collect();
        if !elements.is_empty() {
            text.set("ELSET", &lumen_name(side), &elements);
        }
    }
}

fn lumen_name(side: u8) -> String {
    format!("LUMEN_{side}")
}

fn ties(model: &Model, text: &mut Text) {
    if model.ties.all.is_empty() {
        return;
    }
    text.line("*EQUATION");
    for tie in &model.ties.all {
        let dependent = (tie.dependent.0, tie.dependent.1, -1.0);
        let terms: Vec<_> = std::iter::once(dependent)
            .chain(tie.terms.iter().copied())
            .map(|(node, direction, factor)| format!("{}, {direction}, {}", node + 1, real(factor)))
            .collect();
        text.line(terms.len());
        terms.chunks(4).for_each(|line| text.line(line.join(", ")));
    }
}

fn main_file(model: &Model, name: &str, pressures_pa: &[f64], program: Program) -> String {
    let mut text = Text::default();
    let [title, start] = match program {
        Program::Calculix => ["CalculiX", &format!("ccx {name}")],
        Program::Abaqus => ["Abaqus", &format!("abaqus job={name}-abaqus")],
    };
    text.line(format_args!("** For {title}: {start}. mm, N, MPa; pressures are gauge."));
    text.line(format_args!("*INCLUDE, INPUT={name}-model.inc"));
    if model.plan.smeared.is_some() {
        fibers(model, program, &mut text);
    }
    let highest = pressures_pa.last().copied().unwrap_or(0.0);
    let mut before = 0.0;
    for &pressure in pressures_pa {
        let largest = (model.plan.increment * highest / (pressure - before)).min(1.0);
        step(model, pressure * 1e-6, largest, before == 0.0, program, &mut text);
        before = pressure;
    }
    text.0
}

fn step(model: &Model, pressure_mpa: f64, largest: f64, first: bool, program: Program, text: &mut Text) {
    let start = if first { 0.5 * largest } else { largest };
    // Ten digits are exact enough for a count, and keep 0.001 from asking for one more.
    let most = (SPARE / largest - 1e-6).ceil().max(INCREMENTS);
    text.line(format_args!("*STEP, NLGEOM, INC={most}"));
    text.line("*STATIC");
    text.line(reals(&[start, 1.0, SMALLEST_INCREMENT.min(0.1 * largest), largest]));
    text.line("*DLOAD");
    for side in (1..=6).filter(|side| model.lumen.iter().any(|(_, face)| face == side)) {
        text.line(format_args!("{}, P{side}, {}", lumen_name(side), real(pressure_mpa)));
    }
    text.line("*NODE PRINT, NSET=GAUGES, FREQUENCY=1, GLOBAL=YES");
    text.line("U");
    match program {
        Program::Calculix => text.line("*NODE FILE\nU"),
        Program::Abaqus => text.line("*OUTPUT, FIELD, VARIABLE=PRESELECT"),
    }
    text.line("*END STEP");
}
