//! The text of a deck in the Abaqus dialect: mm, N, MPa.
//!
//! Mesh, ties, sets and isotropic materials read the same in CalculiX and in Abaqus and stand in a file of their own. Each program has a
//! main file with its card for fibers and the steps, so that either runs as it is.

use std::fmt::{Display, Write};

use super::mesh::{Element, Kind, Part};
use super::options::pressures;
use super::parts::Elastomer;
use super::{FemError, Model, files};

/// Elements are numbered from here where they are trusses.
const TRUSSES_FROM: usize = 1_000_000;
/// Exponent of the fiber law, small enough that `k1/(2 k2) (exp(k2 (I4-1)^2) - 1)` is `k1/2 (I4-1)^2` to all digits.
const K2: f64 = 1e-6;
/// Smallest increment of a step, and most increments.
const SMALLEST_INCREMENT: f64 = 1e-5;
const INCREMENTS_MAX: usize = 1000;

/// The three files of a deck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deck {
    name: String,
    /// Mesh, ties, sets, isotropic materials: for both programs.
    pub model: String,
    /// What CalculiX is started with.
    pub calculix: String,
    /// What Abaqus is started with.
    pub abaqus: String,
}

/// A program that reads decks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Program {
    Calculix,
    Abaqus,
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
            model: model_file(model),
            calculix: main(Program::Calculix),
            abaqus: main(Program::Abaqus),
        })
    }

    /// Its name: that of its files.
    pub fn name(&self) -> &str {
        &self.name
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
        files::make_folder(folder)?;
        self.files().iter().try_for_each(|(name, text)| files::write_whole(&folder.join(name), text))
    }
}

/// A text that grows by cards and lines.
#[derive(Default)]
struct Text(String);

impl Text {
    fn line(&mut self, line: impl Display) {
        // Writing to a text cannot fail.
        let _ = writeln!(self.0, "{line}");
    }

    /// Numbers, 16 to a line at most; a line that is not the last ends with a comma where they are one record.
    fn numbers(&mut self, numbers: &[usize], record: bool) {
        let lines = numbers.chunks(if record { 14 } else { 16 });
        let last = lines.len().saturating_sub(1);
        for (n, line) in lines.enumerate() {
            let words: Vec<_> = line.iter().map(usize::to_string).collect();
            let comma = if record && n < last { "," } else { "" };
            self.line(format_args!("{}{comma}", words.join(", ")));
        }
    }

    fn set(&mut self, kind: &str, name: &str, members: &[usize]) {
        self.line(format_args!("*{kind}, {kind}={name}"));
        self.numbers(members, false);
    }
}

/// A number in at most 20 characters, as CalculiX reads it.
fn real(value: f64) -> String {
    format!("{value:.10e}")
}

fn reals(values: &[f64]) -> String {
    values.iter().map(|value| real(*value)).collect::<Vec<_>>().join(", ")
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

fn layer_name(tube: usize) -> String {
    format!("LAYER_{}", tube + 1)
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

fn materials(model: &Model, text: &mut Text) {
    let all = &model.elastomers;
    let has = |part: Part| model.mesh.elements.iter().any(|element| element.part == part);
    for (part, name, elastomer) in
        [(Part::Wall, "WALL", all.wall), (Part::Cap, "CAP", all.cap), (Part::Plate, "PLATE", all.cap)]
    {
        if has(part) {
            hyperelastic(name, &elastomer, text);
            text.line(format_args!("*SOLID SECTION, ELSET={name}, MATERIAL={name}"));
        }
    }
    for trusses in model.trusses.iter().filter(|trusses| !trusses.pairs.is_empty()) {
        text.line(format_args!("*MATERIAL, NAME={}", trusses.name));
        text.line("*ELASTIC");
        text.line(format_args!("{}, 0.", real(trusses.modulus)));
        text.line(format_args!("*SOLID SECTION, ELSET={0}, MATERIAL={0}", trusses.name));
        text.line(real(trusses.area));
    }
}

fn hyperelastic(name: &str, elastomer: &Elastomer, text: &mut Text) {
    text.line(format_args!("*MATERIAL, NAME={name}"));
    let d1 = 2.0 / elastomer.bulk;
    if elastomer.c[1..] == [0.0, 0.0] {
        text.line("*HYPERELASTIC, NEO HOOKE");
        text.line(reals(&[elastomer.c[0], d1]));
    } else {
        text.line("*HYPERELASTIC, YEOH");
        text.line(format_args!("{}, 0., 0.", reals(&[elastomer.c[0], elastomer.c[1], elastomer.c[2], d1])));
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
    text.line(format_args!("*STEP, NLGEOM, INC={INCREMENTS_MAX}"));
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

/// The layer: energy `mu2/2 (I4-1)^2` of each family where it is stretched, none where it is shortened.
fn fibers(model: &Model, program: Program, text: &mut Text) {
    let Some(smeared) = model.plan.smeared else { return };
    let (sin, cos) = model.plan.angle.sin_cos();
    // A fiber and its opposite are one; the axial part is taken as positive.
    let hoop = if sin < 0.0 { -cos } else { cos };
    let families: &[f64] = if model.plan.two_families { &[1.0, -1.0] } else { &[1.0] };
    let matrix = [model.elastomers.layer.c[0], 2.0 / model.elastomers.layer.bulk];
    match program {
        Program::Calculix => {
            text.line("*MATERIAL, NAME=ELASTIC_FIBER_LAYER");
            let mut constants = matrix.to_vec();
            families.iter().for_each(|side| constants.extend([0.0, side * hoop, smeared.modulus, K2]));
            text.line(format_args!("*USER MATERIAL, CONSTANTS={}", constants.len()));
            constants.chunks(8).for_each(|line| text.line(reals(line)));
        }
        Program::Abaqus => {
            text.line("*MATERIAL, NAME=ELASTIC_FIBER_LAYER");
            text.line(format_args!("*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS={}", families.len()));
            text.line(format_args!("{}, 0.", reals(&[matrix[0], matrix[1], smeared.modulus, K2])));
        }
    }
    for (tube, (_, [x, y])) in model.tubes.iter().enumerate() {
        let local = match program {
            Program::Calculix => String::new(),
            Program::Abaqus => format!(", LOCAL DIRECTIONS={}", families.len()),
        };
        text.line(format_args!("*ORIENTATION, NAME=AXIS_{}, SYSTEM=CYLINDRICAL{local}", tube + 1));
        text.line(reals(&[*x, *y, 0.0, *x, *y, 1.0]));
        if program == Program::Abaqus {
            text.line("3, 0.");
            families.iter().for_each(|side| text.line(reals(&[0.0, side * hoop, sin.abs()])));
        }
        let set = layer_name(tube);
        text.line(format_args!(
            "*SOLID SECTION, ELSET={set}, MATERIAL=ELASTIC_FIBER_LAYER, ORIENTATION=AXIS_{}",
            tube + 1
        ));
    }
}
