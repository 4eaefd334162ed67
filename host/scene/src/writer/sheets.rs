//! Threads written as the sheets that they are.

use std::collections::BTreeMap;

use super::draft::{Draft, Part, put};
use super::refit::{megapascals, millimetres};
use crate::data::{Module, Scene};
use crate::schema::{module, winding};

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
/// materials change. A line for each. Modules that share a thread get a winding each. `None` where a winding cannot be written.
pub(super) fn freeze(draft: &mut Draft, scene: &Scene, threads: Threads) -> Option<Vec<String>> {
    let mut log = Vec::new();
    let mut users: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, _) in scene.modules().iter().enumerate().filter(|(_, module)| module.thread.is_some()) {
        users.entry(draft.part_name(index, Part::Winding)?.to_owned()).or_default().push(index);
    }
    for (name, users) in users {
        for (number, user) in users.iter().enumerate().rev() {
            let module = &scene.modules()[*user];
            let own = if number == 0 {
                name.clone()
            } else {
                let base: String = module.name.chars().take(NAME_MAX).collect();
                let names = (1..100).map(|count| format!("{base}-sheet{count}"));
                let own = draft.copy(Part::Winding, &name, names)?;
                put(draft.module(*user)?, module::WINDING.name, own.as_str().into());
                own
            };
            write(draft, &own, module, threads)?;
            log.push(format!("[windings.{own}]: the sheet of its thread"));
        }
    }
    Some(log)
}

fn write(draft: &mut Draft, name: &str, module: &Module, threads: Threads) -> Option<()> {
    let fiber = module.fiber.as_ref()?;
    let table = draft.part(Part::Winding, name)?;
    if threads == Threads::Go {
        table.remove(winding::THREAD.name);
    }
    put(table, winding::MODULUS.name, megapascals(fiber.modulus_pa));
    put(table, winding::THICKNESS.name, millimetres(fiber.thickness_m));
    Some(())
}
