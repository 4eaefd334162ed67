//! A scene with the parameters that a calibration found.

use std::collections::BTreeSet;

use fra_model::{ActuatorParameters, Fiber, Material};
use toml_edit::{Array, TableLike, Value};

use super::draft::{Draft, Part, put, rename};
use super::sheets::{Threads, freeze};
use super::{RewriteError, not_written};
use crate::data::{Module, Scene, WoundActuator};
use crate::schema::{material, module, winding};

/// Digits of a number that is written.
const DIGITS: usize = 9;
/// Relative difference below which two numbers are the same; what rounding to the digits above leaves is well below.
const SAME: f64 = 1e-8;
/// Longest beginning of a module's name in that of a part made for it.
const NAME_MAX: usize = 24;

/// A value that changes: its key before and after, and what is written.
type Change = (&'static str, &'static str, Value);

/// The scene's text with other actuators in its modules, one for each with its second winding, and what was changed, a line for each value.
///
/// Parts that several modules share stay shared where all of them get the same; a module that differs from the others gets a material or
/// winding of its own, a copy of the one it had.
///
/// # Errors
/// [`RewriteError`]. The text that is returned has been read again and says what was asked, to eight digits.
pub fn rewritten(scene: &Scene, wanted: &[WoundActuator]) -> Result<(String, Vec<String>), RewriteError> {
    scene.require_no_segments("a rewritten scene").map_err(RewriteError::Segments)?;
    let modules = scene.modules();
    if wanted.len() != modules.len() {
        return Err(RewriteError::Modules { found: wanted.len(), modules: modules.len() });
    }
    let mut draft = Draft::new(scene).ok_or_else(|| not_written(&modules[0], "text"))?;
    let mut log = Vec::new();
    // The sheet of a thread would follow the wall and the material that change.
    if modules.iter().zip(wanted).any(|(module, new)| !same_actuator(&module.wound_actuator(), new)) {
        log = freeze(&mut draft, scene, Threads::Stay).ok_or_else(|| not_written(&modules[0], "thread"))?;
    }
    let mut pen = Pen { modules, wanted, draft, log };
    for index in 0..modules.len() {
        pen.sizes(index)?;
    }
    pen.parts(Part::Material)?;
    pen.parts(Part::Winding)?;
    pen.parts(Part::SecondWinding)?;
    let (text, read) = pen.draft.read(scene.source_name())?;
    for (module, new) in read.modules().iter().zip(wanted) {
        if !same_actuator(&module.wound_actuator(), new) {
            return Err(not_written(module, "parameters"));
        }
    }
    Ok((text, pen.log))
}

/// The scene's text with other materials, one for each module. Unlike in [`rewritten`], the sheets of threads are computed anew from them.
///
/// # Errors
/// [`RewriteError`].
pub fn recast(scene: &Scene, wanted: &[Material<f64>]) -> Result<(String, Vec<String>), RewriteError> {
    scene.require_no_segments("a rewritten scene").map_err(RewriteError::Segments)?;
    let modules = scene.modules();
    if wanted.len() != modules.len() {
        return Err(RewriteError::Modules { found: wanted.len(), modules: modules.len() });
    }
    let draft = Draft::new(scene).ok_or_else(|| not_written(&modules[0], "text"))?;
    let of_module = |(module, material): (&Module, &Material<f64>)| {
        let (actuator, second) = module.wound_actuator();
        (ActuatorParameters { material: *material, ..actuator }, second)
    };
    let actuators: Vec<WoundActuator> = modules.iter().zip(wanted).map(of_module).collect();
    let mut pen = Pen { modules, wanted: &actuators, draft, log: Vec::new() };
    pen.parts(Part::Material)?;
    let (text, read) = pen.draft.read(scene.source_name())?;
    for (module, new) in read.modules().iter().zip(wanted) {
        if !same_material(&module.actuator().material, new) {
            return Err(not_written(module, "material"));
        }
    }
    Ok((text, pen.log))
}

impl Scene {
    /// The name of the material of a module, or of its winding, the first of two, as the scene has it; `None` where it names none.
    pub fn part_name(&self, module: usize, kind: &str) -> Option<String> {
        let part = [Part::Material, Part::Winding].into_iter().find(|part| part.key() == kind)?;
        Draft::new(self)?.part_name((module, None), part).map(str::to_owned)
    }

    /// The name of the second winding of a module; `None` where it has one or none.
    pub fn second_winding_name(&self, module: usize) -> Option<String> {
        Draft::new(self)?.part_name((module, None), Part::SecondWinding).map(str::to_owned)
    }
}

/// Writes what changes, and says so.
struct Pen<'a> {
    modules: &'a [Module],
    wanted: &'a [WoundActuator],
    draft: Draft,
    log: Vec<String>,
}

impl Pen<'_> {
    /// Radii and length of a module.
    fn sizes(&mut self, index: usize) -> Result<(), RewriteError> {
        let (module, (new, _)) = (&self.modules[index], &self.wanted[index]);
        let old = module.actuator();
        let sizes = [
            (module::INNER_RADIUS.name, old.inner_radius_m, new.inner_radius_m),
            (module::OUTER_RADIUS.name, old.outer_radius_m, new.outer_radius_m),
            (module::LENGTH.name, *module.length_m, new.length_m + 2.0 * module.end_length_m),
        ];
        let changed = sizes.into_iter().filter(|(_, old, new)| !same(*old, *new));
        let changes = changed.map(|(key, _, new)| (key, key, millimetres(new))).collect();
        let table = self.draft.module(index).ok_or_else(|| not_written(module, "sizes"))?;
        let place = format!("module `{}`", *module.name);
        write(table, &place, changes, &mut self.log).ok_or_else(|| not_written(module, "sizes"))
    }

    /// Materials or windings, each for all modules that use it.
    fn parts(&mut self, part: Part) -> Result<(), RewriteError> {
        let names: Vec<Option<String>> =
            (0..self.modules.len()).map(|index| self.draft.part_name((index, None), part).map(str::to_owned)).collect();
        for name in names.iter().flatten().collect::<BTreeSet<_>>() {
            let users: Vec<usize> = (0..names.len()).filter(|index| names[*index].as_ref() == Some(name)).collect();
            // A radius that is not stated is that of the actuator, and follows it.
            let stated = self.draft.part(part, name).is_some_and(|table| table.contains_key(winding::RADIUS.name));
            let changes = |user: &usize| changes(part, &self.modules[*user], &self.wanted[*user], stated);
            let differing: Vec<usize> = users.iter().filter(|user| !changes(user).is_empty()).copied().collect();
            let Some(first) = differing.first() else { continue };
            let alike = |user: &usize| same_part(part, &self.wanted[*user], &self.wanted[*first], stated);
            if part == Part::Material && self.draft.part(part, name).is_none() {
                self.castable(name, &differing)?;
                return self.parts(part);
            }
            if users.iter().all(alike) {
                self.part(part, name, *first, stated)?;
                continue;
            }
            for user in differing {
                let own = self.own_part(part, name, user)?;
                self.part(part, &own, user, stated)?;
            }
        }
        Ok(())
    }

    /// Writes the law of a castable elastomer under a name of the scene's own, and has its modules use that.
    fn castable(&mut self, name: &str, users: &[usize]) -> Result<(), RewriteError> {
        let module = &self.modules[users[0]];
        let (law, key, value) = material_words(&module.material);
        let base: String = name.to_lowercase().split_whitespace().collect::<Vec<_>>().join("-");
        let own = self.draft.add_material(&base, [(material::LAW.name, law.into()), (key, value)]);
        let own = own.ok_or_else(|| not_written(module, Part::Material.key()))?;
        for user in users {
            let table = self.draft.module(*user).ok_or_else(|| not_written(module, Part::Material.key()))?;
            let changes = vec![(module::MATERIAL.name, module::MATERIAL.name, own.as_str().into())];
            write(table, &format!("module `{}`", *self.modules[*user].name), changes, &mut self.log)
                .ok_or_else(|| not_written(module, Part::Material.key()))?;
        }
        Ok(())
    }

    /// Writes into a part what one of its modules gets.
    fn part(&mut self, part: Part, name: &str, user: usize, stated: bool) -> Result<(), RewriteError> {
        let module = &self.modules[user];
        let changes = changes(part, module, &self.wanted[user], stated);
        let place = format!("[{}.{name}]", part.tables());
        let table = self.draft.part(part, name).ok_or_else(|| not_written(module, part.key()))?;
        // The stretch of a test says nothing about a law from other measurements.
        let stretch_max = material::STRETCH_MAX.name;
        if part == Part::Material && !changes.is_empty() && table.remove(stretch_max).is_some() {
            self.log.push(format!("{place}: {stretch_max} removed"));
        }
        write(table, &place, changes, &mut self.log).ok_or_else(|| not_written(module, part.key()))
    }

    /// Gives a module a part of its own, and returns its name.
    fn own_part(&mut self, part: Part, name: &str, user: usize) -> Result<String, RewriteError> {
        let module = &self.modules[user];
        let base: String = module.name.chars().take(NAME_MAX).collect();
        let numbered = (2..100).map(|count| format!("{base}-fit{count}"));
        let names = std::iter::once(format!("{base}-fit")).chain(numbered);
        let own = self.draft.copy(part, name, names).ok_or_else(|| not_written(module, part.key()))?;
        self.draft.put_part_name((user, None), part, &own).ok_or_else(|| not_written(module, part.key()))?;
        self.log.push(format!("module `{}`: {} = \"{own}\"", *module.name, part.key()));
        Ok(own)
    }
}

/// Replaces values that are there; `None` where one is not.
fn write(table: &mut dyn TableLike, place: &str, changes: Vec<Change>, log: &mut Vec<String>) -> Option<()> {
    for (old, key, value) in changes {
        table.get(old)?.as_value()?;
        if key != old {
            rename(table, old, key);
        }
        log.push(format!("{place}: {key} = {value}"));
        put(table, key, value);
    }
    Some(())
}

/// Changes in the part of a module.
fn changes(part: Part, module: &Module, (new, new_second): &WoundActuator, stated: bool) -> Vec<Change> {
    let windings = match part {
        Part::Material => return material_changes(&module.material, &new.material),
        Part::Winding => module.fiber.zip(new.fiber),
        Part::SecondWinding => module.second_fiber.zip(*new_second),
    };
    windings.map_or_else(Vec::new, |(old, new)| winding_changes(&old, &new, stated))
}

fn material_changes(old: &Material<f64>, new: &Material<f64>) -> Vec<Change> {
    if same_material(old, new) {
        return Vec::new();
    }
    let ((old_law, old_key, _), (law, key, value)) = (material_words(old), material_words(new));
    let mut changes = vec![(old_key, key, value)];
    if law != old_law {
        changes.insert(0, (material::LAW.name, material::LAW.name, law.into()));
    }
    changes
}

/// The law, and key and value of its coefficients.
fn material_words(material: &Material<f64>) -> (&'static str, &'static str, Value) {
    match material {
        Material::NeoHookean { shear_modulus_pa } => {
            ("neo-hookean", material::SHEAR_MODULUS.name, megapascals(*shear_modulus_pa))
        }
        Material::Yeoh { c_pa } => {
            ("yeoh", material::C.name, c_pa.iter().map(|c_pa| megapascals(*c_pa)).collect::<Array>().into())
        }
    }
}

fn winding_changes(old: &Fiber<f64>, new: &Fiber<f64>, stated: bool) -> Vec<Change> {
    let values = [
        (winding::ANGLE.name, old.angle_rad, new.angle_rad, degrees(new.angle_rad)),
        (winding::MODULUS.name, old.modulus_pa, new.modulus_pa, megapascals(new.modulus_pa)),
        (winding::THICKNESS.name, old.thickness_m, new.thickness_m, millimetres(new.thickness_m)),
        (winding::RADIUS.name, old.radius_m, new.radius_m, millimetres(new.radius_m)),
    ];
    let changed =
        values.into_iter().filter(|(key, old, new, _)| (stated || *key != winding::RADIUS.name) && !same(*old, *new));
    changed.map(|(key, _, _, value)| (key, key, value)).collect()
}

/// Whether two modules get the same part.
fn same_part(part: Part, (a, a_second): &WoundActuator, (b, b_second): &WoundActuator, stated: bool) -> bool {
    let windings = match part {
        Part::Material => return same_material(&a.material, &b.material),
        Part::Winding => a.fiber.zip(b.fiber),
        Part::SecondWinding => a_second.zip(*b_second),
    };
    windings.is_some_and(|(a, b)| same_fiber(&a, &b, stated))
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

fn same_material(a: &Material<f64>, b: &Material<f64>) -> bool {
    match (a, b) {
        (Material::NeoHookean { shear_modulus_pa: a }, Material::NeoHookean { shear_modulus_pa: b }) => same(*a, *b),
        (Material::Yeoh { c_pa: a }, Material::Yeoh { c_pa: b }) => a.iter().zip(b).all(|(a, b)| same(*a, *b)),
        _ => false,
    }
}

fn same_fiber(a: &Fiber<f64>, b: &Fiber<f64>, radius: bool) -> bool {
    let radii = !radius || same(a.radius_m, b.radius_m);
    radii && same(a.angle_rad, b.angle_rad) && same(a.modulus_pa, b.modulus_pa) && same(a.thickness_m, b.thickness_m)
}

fn same_actuator((a, a_second): &WoundActuator, (b, b_second): &WoundActuator) -> bool {
    let sizes = same(a.inner_radius_m, b.inner_radius_m)
        && same(a.outer_radius_m, b.outer_radius_m)
        && same(a.length_m, b.length_m);
    let windings =
        same_winding(a.fiber.as_ref(), b.fiber.as_ref()) && same_winding(a_second.as_ref(), b_second.as_ref());
    windings && sizes && a.motion == b.motion && same_material(&a.material, &b.material)
}

fn same_winding(a: Option<&Fiber<f64>>, b: Option<&Fiber<f64>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => same_fiber(a, b, true) && a.families == b.families && a.placement == b.placement,
        (None, None) => true,
        _ => false,
    }
}

pub(super) fn megapascals(pa: f64) -> Value {
    format!("{} MPa", rounded(pa * 1e-6)).into()
}

pub(super) fn millimetres(m: f64) -> Value {
    format!("{} mm", rounded(m * 1e3)).into()
}

fn degrees(rad: f64) -> Value {
    format!("{} deg", rounded(rad.to_degrees())).into()
}

/// A number of few digits.
fn rounded(value: f64) -> f64 {
    // What was printed by the line before reads back.
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}
