//! Cards of a deck: text, numbers, materials. The cards for fibers are all that the programs disagree on.

use std::fmt::{Display, Write};

use super::Model;
use super::mesh::Part;
use super::parts::Elastomer;
use super::plan::Fibers;

/// Exponent of the fiber law, small enough that `k1/(2 k2) (exp(k2 (I4-1)^2) - 1)` is `k1/2 (I4-1)^2` to all digits.
const K2: f64 = 1e-6;
/// A program that reads decks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Program {
    Calculix,
    Abaqus,
}

/// A text that grows by cards and lines.
#[derive(Default)]
pub(crate) struct Text(pub(crate) String);

impl Text {
    pub(crate) fn line(&mut self, line: impl Display) {
        // Writing to a text cannot fail.
        let _ = writeln!(self.0, "{line}");
    }

    /// Numbers, 16 to a line at most; a line that is not the last ends with a comma where they are one record.
    pub(crate) fn numbers(&mut self, numbers: &[usize], record: bool) {
        let lines = numbers.chunks(if record { 14 } else { 16 });
        let last = lines.len().saturating_sub(1);
        for (n, line) in lines.enumerate() {
            let words: Vec<_> = line.iter().map(usize::to_string).collect();
            let comma = if record && n < last { "," } else { "" };
            self.line(format_args!("{}{comma}", words.join(", ")));
        }
    }

    pub(crate) fn set(&mut self, kind: &str, name: &str, members: &[usize]) {
        self.line(format_args!("*{kind}, {kind}={name}"));
        self.numbers(members, false);
    }
}

/// A number in at most 20 characters, as CalculiX reads it.
pub(crate) fn real(value: f64) -> String {
    format!("{value:.10e}")
}

pub(crate) fn reals(values: &[f64]) -> String {
    values.iter().map(|value| real(*value)).collect::<Vec<_>>().join(", ")
}

pub(crate) fn layer_name(tube: usize) -> String {
    format!("LAYER_{}", tube + 1)
}

pub(crate) fn materials(model: &Model, text: &mut Text) {
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

/// Share of the elastomer's stiffness in elements that carry the fibers of a second winding alone.
const BARE: f64 = 1e-3;
/// Abaqus numbers the elements of a second winding from here, below the trusses.
const SECOND_FROM: usize = 500_000;

impl Fibers {
    /// Hoop and axial part of each family's direction. A fiber and its opposite are one; the axial part is taken as positive.
    fn directions(&self) -> Vec<[f64; 2]> {
        let (sin, cos) = self.angle.sin_cos();
        let hoop = if sin < 0.0 { -cos } else { cos };
        let sides: &[f64] = if self.two_families { &[1.0, -1.0] } else { &[1.0] };
        sides.iter().map(|side| [side * hoop, sin.abs()]).collect()
    }
}

/// The layer: energy `mu2/2 (I4-1)^2` of each family where it is stretched, none where it is shortened.
pub(crate) fn fibers(model: &Model, program: Program, text: &mut Text) {
    let matrix = [model.elastomers.layer.c[0], 2.0 / model.elastomers.layer.bulk];
    match program {
        Program::Calculix => {
            text.line("*MATERIAL, NAME=ELASTIC_FIBER_LAYER");
            let mut constants = matrix.to_vec();
            for fibers in &model.plan.fibers {
                let families = fibers.directions();
                families.iter().for_each(|[hoop, _]| constants.extend([0.0, *hoop, fibers.modulus, K2]));
            }
            text.line(format_args!("*USER MATERIAL, CONSTANTS={}", constants.len()));
            constants.chunks(8).for_each(|line| text.line(reals(line)));
            for (tube, (_, [x, y])) in model.tubes.iter().enumerate() {
                text.line(format_args!("*ORIENTATION, NAME=AXIS_{}, SYSTEM=CYLINDRICAL", tube + 1));
                text.line(reals(&[*x, *y, 0.0, *x, *y, 1.0]));
                section(&layer_name(tube), "LAYER", &format!("AXIS_{}", tube + 1), text);
            }
        }
        // One card has one stiffness: a second set of elements overlays the first.
        Program::Abaqus => {
            let bare = [BARE * matrix[0], matrix[1] / BARE];
            let parts = [("LAYER", "AXIS", matrix), ("SECOND", "SECOND_AXIS", bare)];
            for (fibers, (part, axis, matrix)) in model.plan.fibers.iter().zip(parts) {
                let families = fibers.directions();
                text.line(format_args!("*MATERIAL, NAME=ELASTIC_FIBER_{part}"));
                text.line(format_args!("*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS={}", families.len()));
                text.line(format_args!("{}, 0.", reals(&[matrix[0], matrix[1], fibers.modulus, K2])));
                for (tube, (_, [x, y])) in model.tubes.iter().enumerate() {
                    let set = if part == "LAYER" { layer_name(tube) } else { format!("{part}_{}", tube + 1) };
                    if part != "LAYER" {
                        let old = layer_name(tube);
                        text.line(format_args!(
                            "*ELCOPY, ELEMENT SHIFT={SECOND_FROM}, OLD SET={old}, SHIFT NODES=0, NEW SET={set}"
                        ));
                    }
                    let name = format!("{axis}_{}", tube + 1);
                    let count = families.len();
                    text.line(format_args!("*ORIENTATION, NAME={name}, SYSTEM=CYLINDRICAL, LOCAL DIRECTIONS={count}"));
                    text.line(reals(&[*x, *y, 0.0, *x, *y, 1.0]));
                    text.line("3, 0.");
                    families.iter().for_each(|[hoop, axial]| text.line(reals(&[0.0, *hoop, *axial])));
                    section(&set, part, &name, text);
                }
            }
        }
    }
}

fn section(set: &str, part: &str, axis: &str, text: &mut Text) {
    text.line(format_args!("*SOLID SECTION, ELSET={set}, MATERIAL=ELASTIC_FIBER_{part}, ORIENTATION={axis}"));
}
