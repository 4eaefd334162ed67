//! Cards of a deck: text, numbers, materials. The cards for fibers are all that the programs disagree on.

use std::fmt::{Display, Write};

use super::Model;
use super::mesh::Part;
use super::parts::Elastomer;

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

/// The layer: energy `mu2/2 (I4-1)^2` of each family where it is stretched, none where it is shortened.
pub(crate) fn fibers(model: &Model, program: Program, text: &mut Text) {
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
