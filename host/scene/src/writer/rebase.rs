//! A scene whose limb starts elsewhere and has other spacers.

use toml_edit::{Array, Value};

use super::RewriteError;
use super::draft::{Draft, put};
use super::redesign::{Redesign, redesigned};
use crate::data::Scene;
use crate::schema::{limb, module, phase, scene};

/// Base of a redesigned limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebase {
    /// Start of the first module, m.
    pub position_m: [f64; 3],
    /// Unit vector along it.
    pub direction: [f64; 3],
    /// Unit vector, normal to `direction`, towards which a bending module with mount angle 0 bends.
    pub up: [f64; 3],
}

/// Digits of positions and directions: a nanometre.
const SCALE: f64 = 1e9;
/// Digits of a phase's `direction`, which its tolerance covers.
const POINTING: f64 = 1e4;

/// The text of a scene with these modules, `spacers` of each, and this base; goals stay, and get a `direction` of the end effector where they have
/// none and one is given for their phase. Comments and everything else stay.
///
/// # Errors
/// [`RewriteError`]. The text that is returned has been read again.
pub fn redesigned_at(
    scene: &Scene,
    modules: &[Redesign],
    spacers: &[u8],
    base: &Rebase,
    directions: &[Option<[f64; 3]>],
) -> Result<String, RewriteError> {
    let text = redesigned(scene, modules, None)?;
    let read = crate::parse(&text, scene.source_name()).map_err(RewriteError::Refused)?;
    let unwritten = |what| RewriteError::NotWritten { module: modules[0].name.clone(), what };
    let mut draft = Draft::new(&read).ok_or_else(|| unwritten("text"))?;
    // Segments of one actuator have no plates between them.
    let plated = spacers.iter().enumerate().filter(|(index, _)| modules[*index].segments.is_empty());
    for (index, count) in plated {
        put(draft.module(index).ok_or_else(|| unwritten("spacers"))?, module::SPACERS.name, i64::from(*count).into());
    }
    let table = draft.document.get_mut(scene::LIMB.name).and_then(|item| item.as_table_like_mut());
    let table = table.ok_or_else(|| unwritten("base"))?;
    put(table, limb::BASE_POSITION.name, vector(base.position_m, SCALE));
    put(table, limb::BASE_DIRECTION.name, vector(base.direction, SCALE));
    put(table, limb::BASE_UP.name, vector(base.up, SCALE));
    let open = scene.phases().iter().zip(directions).enumerate().filter(|(_, (phase, _))| phase.aim.is_none());
    for (index, (_, direction)) in open {
        let Some(direction) = direction else { continue };
        let table =
            draft.document.get_mut(scene::PHASE.name).and_then(|phases| phases.get_mut(index)?.as_table_like_mut());
        put(table.ok_or_else(|| unwritten("direction"))?, phase::DIRECTION.name, vector(*direction, POINTING));
    }
    let (text, read) = draft.read(scene.source_name())?;
    let kept = read.modules().iter().zip(spacers).all(|(module, count)| module.spacers == *count);
    if !kept {
        return Err(unwritten("spacers"));
    }
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 4.0 / SCALE);
    let own = read.limb();
    if !(near(own.base_position_m, base.position_m) && near(own.base_direction, base.direction)) {
        return Err(unwritten("base"));
    }
    Ok(text)
}

fn vector(values: [f64; 3], scale: f64) -> Value {
    let round = |value: f64| if value.abs() < 0.5 / scale { 0.0 } else { (value * scale).round() / scale };
    Value::Array(values.into_iter().map(round).collect::<Array>())
}
