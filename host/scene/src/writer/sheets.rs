//! Threads written as the sheets that they are.

use std::collections::BTreeMap;

use fra_model::Fiber;

use super::draft::{Draft, Part, Wound, put};
use super::refit::{megapascals, millimetres};
use crate::data::Scene;
use crate::schema::winding;

/// Longest beginning of a module's name in that of a winding made for it.
const NAME_MAX: usize = 24;

/// The thread of a winding whose sheet is written.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Threads {
    /// It stays beside its sheet: the wall is that on which it is wound.
    Stay,
    /// It goes: sizes of the wall change.
    Go,
}

/// Writes the `modulus` and `thickness` that the thread of every winding has in this scene, so that they stay when sizes or
/// materials change. A line for each. Modules and segments that share a thread get a winding each. `None` where a winding cannot be written.
pub(super) fn freeze(draft: &mut Draft, scene: &Scene, threads: Threads) -> Option<Vec<String>> {
    let mut log = Vec::new();
    let mut users: BTreeMap<String, Vec<(Wound, Part, Fiber<f64>)>> = BTreeMap::new();
    for (index, module) in scene.modules().iter().enumerate() {
        for (number, wound) in module.parts().into_iter().enumerate() {
            let user = (index, (!module.segments.is_empty()).then_some(number));
            let first = (wound.thread.and(wound.fiber), Part::Winding);
            let second = (wound.second_thread.and(wound.second_fiber), Part::SecondWinding);
            for (fiber, part) in [first, second] {
                let Some(fiber) = fiber else { continue };
                users.entry(draft.part_name(user, part)?.to_owned()).or_default().push((user, part, *fiber));
            }
        }
    }
    for (name, users) in users {
        for (number, (user, part, fiber)) in users.iter().enumerate().rev() {
            let module = &scene.modules()[user.0];
            let own = if number == 0 {
                name.clone()
            } else {
                let base: String = module.name.chars().take(NAME_MAX).collect();
                let names = (1..100).map(|count| format!("{base}-sheet{count}"));
                let own = draft.copy(*part, &name, names)?;
                draft.put_part_name(*user, *part, &own)?;
                own
            };
            write(draft, &own, fiber, threads)?;
            log.push(format!("[windings.{own}]: the sheet of its thread"));
        }
    }
    Some(log)
}

fn write(draft: &mut Draft, name: &str, fiber: &Fiber<f64>, threads: Threads) -> Option<()> {
    let table = draft.part(Part::Winding, name)?;
    if threads == Threads::Go {
        table.remove(winding::THREAD.name);
    }
    put(table, winding::MODULUS.name, megapascals(fiber.modulus_pa));
    put(table, winding::THICKNESS.name, millimetres(fiber.thickness_m));
    Some(())
}
