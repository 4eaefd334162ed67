//! Corrections of the planned setpoints, in a CSV file.

use super::module::Draft;
use super::series::{Cells, Columns, file};
use crate::data::{CorrectionRow, Phase, PhaseCorrections};
use crate::error::quoted;
use crate::reader::Reader;
use crate::schema;
use crate::schema::corrections as keys;
use crate::source::Located;

/// The first columns: name of the phase, share of its move, and time since the end of the move, s.
const LEAD: [&str; 3] = ["phase", "move", "hold_s"];
/// Longest time in a hold, s.
const HOLD_MAX_S: f64 = 3600.0;

/// The corrections of a scene that has `[corrections]`, located at the name of their file; the inner `None` where it has none.
///
/// `scene_name` is the scene's path, in whose folder the file is looked for.
pub(super) fn corrections(
    root: &Reader<'_>,
    scene_name: &str,
    drafts: &[Draft<'_>],
    phases: Option<&[Phase]>,
) -> Option<Option<Located<PhaseCorrections>>> {
    let Some(value) = root.value(schema::scene::CORRECTIONS.name) else { return Some(None) };
    let reader = Reader::open(root.log(), value, &keys::SECTION, &quoted(schema::scene::CORRECTIONS.name))?;
    let modules: Vec<_> = drafts.iter().map(|draft| draft.module.as_ref()).collect::<Option<_>>()?;
    let names: Vec<&str> = modules.iter().map(|module| module.name.value.as_str()).collect();
    let then = names.iter().map(|name| format!("{name}.planned")).collect();
    let counts: Vec<_> = modules.iter().map(|module| usize::from(module.actuators)).collect();
    let (channels, phases) = (counts.iter().sum(), phases?);
    // Each is compared with the range of its module by who knows that.
    let columns = Columns { what: "corrections", lead: &LEAD, names, then, counts, max: f64::MAX, unit: "" };
    let corrections = file(&reader, &keys::FILE, scene_name, &columns, |rows| by_phase(rows, phases, channels))?;
    Some(Some(corrections))
}

/// The rows of each phase. Those of phases that the scene does not have are left out.
fn by_phase(rows: Vec<Cells>, phases: &[Phase], channels: usize) -> Result<PhaseCorrections, String> {
    let mut corrections = PhaseCorrections { phases: vec![Vec::new(); phases.len()] };
    for mut cells in rows {
        let move_share = cells.number(1, LEAD[1], [0.0, 1.0])?;
        let hold_s = cells.number(2, LEAD[2], [0.0, HOLD_MAX_S])?;
        if move_share < 1.0 && hold_s > 0.0 {
            let [line, share, hold] = [&cells.line.to_string(), LEAD[1], LEAD[2]];
            return Err(format!(":{line}: `{hold}`: {hold_s} is not allowed: it is 0 while `{share}` is below 1"));
        }
        let Some(index) = phases.iter().position(|phase| phase.name.value == cells.lead[0]) else { continue };
        let own = &mut corrections.phases[index];
        if own.last().is_some_and(|last| (last.move_share, last.hold_s) >= (move_share, hold_s)) {
            return Err(format!(
                ":{}: `{}` and `{}` are not later than in the row before of {}",
                cells.line,
                LEAD[1],
                LEAD[2],
                quoted(&cells.lead[0])
            ));
        }
        let planned = cells.values.split_off(channels);
        own.push(CorrectionRow { move_share, hold_s, values: cells.values, planned });
    }
    match phases.iter().zip(&corrections.phases).find(|(_, rows)| rows.is_empty()) {
        Some((phase, _)) => Err(format!(": there is no row for the phase {}", quoted(&phase.name.value))),
        None => Ok(corrections),
    }
}
