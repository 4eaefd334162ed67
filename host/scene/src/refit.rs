//! A scene with other actuators: the text as its author wrote it, comments and all, with the values that differ replaced.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Range;

use fra_model::{ActuatorParameters, Families, Fiber, Material, Placement};
use toml::de::{DeTable, DeValue};

use super::data::{Module, Scene};
use super::error::SceneError;

/// Digits of a number that is written.
const DIGITS: usize = 9;
/// Relative difference below which two numbers are the same; what rounding to the digits above leaves is well below.
const SAME: f64 = 1e-8;
/// Longest beginning of a module's name in that of a part made for it.
const NAME_MAX: usize = 24;

/// Why a scene cannot be written anew.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RewriteError {
    /// The scene has another number of modules.
    #[error("{found} actuators for the {modules} modules of the scene")]
    Modules {
        /// Actuators given.
        found: usize,
        /// Modules of the scene.
        modules: usize,
    },
    /// A parameter that a scene has no key for, or that is written in a way that is not touched.
    #[error("cannot write the {what} of module `{module}` into this scene: change it by hand")]
    NotWritten {
        /// The module.
        module: String,
        /// What should change.
        what: &'static str,
    },
    /// The new values are not what a scene may say.
    #[error("the scene does not take the new values: {0}")]
    Refused(SceneError),
}

/// The scene's text with other actuators in its modules, one for each, and what was changed, a line for each value.
///
/// What several modules share stays shared where all of them get the same; a module that differs from the others gets a material or
/// winding of its own, at the end of the text.
///
/// # Errors
/// [`RewriteError`]. The text that is returned has been read again and says what was asked, to eight digits.
pub fn rewritten(scene: &Scene, wanted: &[ActuatorParameters<f64>]) -> Result<(String, Vec<String>), RewriteError> {
    let modules = scene.modules();
    if wanted.len() != modules.len() {
        return Err(RewriteError::Modules { found: wanted.len(), modules: modules.len() });
    }
    let text = scene.source_text();
    let Ok(root) = DeTable::parse(text) else { return Err(not_written(&modules[0], "text")) };
    let mut pen = Pen { root: root.get_ref(), edits: Vec::new(), added: String::new(), log: Vec::new() };
    for (index, (module, new)) in modules.iter().zip(wanted).enumerate() {
        pen.sizes(index, module, new)?;
    }
    for name in scene_names(scene, "material") {
        pen.material(scene, wanted, &name)?;
    }
    for name in scene_names(scene, "winding") {
        pen.winding(scene, wanted, &name)?;
    }
    let (written, log) = pen.finish(text);
    let read = super::parse(&written, scene.source_name()).map_err(RewriteError::Refused)?;
    for (module, new) in read.modules().iter().zip(wanted) {
        if !same_actuator(&module.actuator(), new) {
            return Err(not_written(module, "parameters"));
        }
    }
    Ok((written, log))
}

impl Scene {
    /// The name of the material of a module, or of its winding, as the scene has it; `None` where it names none.
    pub fn part_name(&self, module: usize, kind: &str) -> Option<String> {
        let root = DeTable::parse(self.source_text()).ok()?;
        Some(named_part(root.get_ref(), module, kind)?.0)
    }
}

/// The names of parts of a kind that modules use.
fn scene_names(scene: &Scene, kind: &str) -> BTreeSet<String> {
    (0..scene.modules().len()).filter_map(|module| scene.part_name(module, kind)).collect()
}

/// The name of a part that a module uses, and where it is written.
fn named_part(root: &DeTable<'_>, module: usize, kind: &str) -> Option<(String, Range<usize>)> {
    let value = module_table(root, module)?.get(kind)?;
    Some((value.get_ref().as_str()?.to_owned(), value.span()))
}

fn module_table<'t, 'a>(root: &'t DeTable<'a>, module: usize) -> Option<&'t DeTable<'a>> {
    match root.get("module")?.get_ref() {
        DeValue::Array(modules) => modules.get(module)?.get_ref().as_table(),
        _ => None,
    }
}

fn part_table<'t, 'a>(root: &'t DeTable<'a>, kind: &str, name: &str) -> Option<&'t DeTable<'a>> {
    root.get(kind)?.get_ref().as_table()?.get(name)?.get_ref().as_table()
}

/// Collects what changes.
struct Pen<'t, 'a> {
    root: &'t DeTable<'a>,
    edits: Vec<(Range<usize>, String)>,
    added: String,
    log: Vec<String>,
}

impl Pen<'_, '_> {
    /// Radii and length of a module.
    fn sizes(&mut self, index: usize, module: &Module, new: &ActuatorParameters<f64>) -> Result<(), RewriteError> {
        let old = module.actuator();
        for (key, old, new) in [
            ("inner_radius", old.inner_radius_m, new.inner_radius_m),
            ("outer_radius", old.outer_radius_m, new.outer_radius_m),
            ("length", old.length_m, new.length_m),
        ] {
            if same(old, new) {
                continue;
            }
            let span = module_table(self.root, index).and_then(|table| Some(table.get(key)?.span()));
            let span = span.ok_or_else(|| not_written(module, "sizes"))?;
            self.replace(span, &format!("module `{}`", *module.name), key, millimetres(new));
        }
        Ok(())
    }

    fn replace(&mut self, span: Range<usize>, place: &str, key: &str, value: String) {
        self.log.push(format!("{place}: {key} = {value}"));
        self.edits.push((span, value));
    }

    /// A material, for all modules that use it.
    fn material(&mut self, scene: &Scene, wanted: &[ActuatorParameters<f64>], name: &str) -> Result<(), RewriteError> {
        let users = users(scene, "material", name);
        let first = wanted[users[0]].material;
        if users.iter().all(|user| same_material(&wanted[*user].material, &first)) {
            let module = &scene.modules()[users[0]];
            return if same_material(&module.material, &first) { Ok(()) } else { self.law(name, module, &first) };
        }
        for user in users {
            let module = &scene.modules()[user];
            if !same_material(&module.material, &wanted[user].material) {
                let new = self.rename(user, module, "material")?;
                let [law, coefficients] = material_lines(&wanted[user].material);
                let density = module.density_kg_per_m3;
                let _ = write!(
                    self.added,
                    "\n[materials.{new}]\nlaw = {}\n{} = {}\ndensity = \"{density} kg/m3\"\n",
                    law.1, coefficients.0, coefficients.1
                );
                self.log.push(format!("[materials.{new}]: {} = {}", coefficients.0, coefficients.1));
            }
        }
        Ok(())
    }

    /// Another law in the table of a material.
    fn law(&mut self, name: &str, module: &Module, new: &Material<f64>) -> Result<(), RewriteError> {
        let table = part_table(self.root, "materials", name);
        let old_key = material_lines(&module.material)[1].0;
        let found = table.and_then(|table| {
            let (key, value) = table.get_key_value(old_key)?;
            Some((table.get("law")?.span(), key.span().start..value.span().end))
        });
        let (law_span, span) = found.ok_or_else(|| not_written(module, "material"))?;
        let [law, coefficients] = material_lines(new);
        let place = format!("[materials.{name}]");
        if coefficients.0 != old_key {
            self.replace(law_span, &place, "law", law.1);
        }
        self.log.push(format!("{place}: {} = {}", coefficients.0, coefficients.1));
        self.edits.push((span, format!("{} = {}", coefficients.0, coefficients.1)));
        Ok(())
    }

    /// A winding, for all modules that use it.
    fn winding(&mut self, scene: &Scene, wanted: &[ActuatorParameters<f64>], name: &str) -> Result<(), RewriteError> {
        let users = users(scene, "winding", name);
        // A radius that is not stated is that of the actuator, and follows it.
        let stated = part_table(self.root, "windings", name).is_some_and(|table| table.get("radius").is_some());
        let differs = |user: usize| match (scene.modules()[user].fiber, wanted[user].fiber) {
            (Some(old), Some(new)) => !same_fiber(&old, &new, stated),
            _ => false,
        };
        let Some(first) = users.iter().copied().find(|user| differs(*user)) else { return Ok(()) };
        let (module, new) = (&scene.modules()[first], wanted[first].fiber);
        let Some(new) = new else { return Ok(()) };
        let shared = users.iter().all(|user| wanted[*user].fiber.is_some_and(|fiber| same_fiber(&fiber, &new, stated)));
        if shared {
            return self.winding_values(name, module, &new, stated);
        }
        for user in users.into_iter().filter(|user| differs(*user)) {
            let Some(fiber) = wanted[user].fiber else { continue };
            let module = &scene.modules()[user];
            let part = self.rename(user, module, "winding")?;
            let lines = winding_lines(&fiber, stated);
            let _ = write!(self.added, "\n[windings.{part}]\n{lines}");
            self.log.extend(lines.lines().map(|line| format!("[windings.{part}]: {line}")));
        }
        Ok(())
    }

    fn winding_values(
        &mut self,
        name: &str,
        module: &Module,
        new: &Fiber<f64>,
        stated: bool,
    ) -> Result<(), RewriteError> {
        let Some(old) = module.fiber else { return Ok(()) };
        let mut values = vec![
            ("angle", old.angle_rad, new.angle_rad, degrees(new.angle_rad)),
            ("modulus", old.modulus_pa, new.modulus_pa, megapascals(new.modulus_pa)),
            ("thickness", old.thickness_m, new.thickness_m, millimetres(new.thickness_m)),
        ];
        if stated {
            values.push(("radius", old.radius_m, new.radius_m, millimetres(new.radius_m)));
        }
        for (key, old, new, text) in values {
            if same(old, new) {
                continue;
            }
            let span = part_table(self.root, "windings", name).and_then(|table| Some(table.get(key)?.span()));
            self.replace(span.ok_or_else(|| not_written(module, "winding"))?, &format!("[windings.{name}]"), key, text);
        }
        Ok(())
    }

    /// Gives a module a part of its own, and returns its name.
    fn rename(&mut self, index: usize, module: &Module, kind: &'static str) -> Result<String, RewriteError> {
        let (_, span) = named_part(self.root, index, kind).ok_or_else(|| not_written(module, kind))?;
        let base: String = module.name.chars().take(NAME_MAX).collect();
        let taken = |name: &str| part_table(self.root, &format!("{kind}s"), name).is_some();
        let mut name = format!("{base}-fit");
        for count in 2..100 {
            let begun = self.added.contains(&format!("[{kind}s.{name}]"));
            if !taken(&name) && !begun {
                break;
            }
            name = format!("{base}-fit{count}");
        }
        self.replace(span, &format!("module `{}`", *module.name), kind, format!("\"{name}\""));
        Ok(name)
    }

    fn finish(mut self, text: &str) -> (String, Vec<String>) {
        self.edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
        let mut written = text.to_owned();
        for (span, value) in self.edits {
            written.replace_range(span, &value);
        }
        if !self.added.is_empty() && !written.ends_with('\n') {
            written.push('\n');
        }
        (written + &self.added, self.log)
    }
}

fn users(scene: &Scene, kind: &str, name: &str) -> Vec<usize> {
    (0..scene.modules().len()).filter(|module| scene.part_name(*module, kind).as_deref() == Some(name)).collect()
}

fn not_written(module: &Module, what: &'static str) -> RewriteError {
    RewriteError::NotWritten { module: module.name.to_string(), what }
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

fn same_actuator(a: &ActuatorParameters<f64>, b: &ActuatorParameters<f64>) -> bool {
    let fibers = match (&a.fiber, &b.fiber) {
        (Some(a), Some(b)) => same_fiber(a, b, true) && a.families == b.families && a.placement == b.placement,
        (None, None) => true,
        _ => false,
    };
    let sizes = same(a.inner_radius_m, b.inner_radius_m)
        && same(a.outer_radius_m, b.outer_radius_m)
        && same(a.length_m, b.length_m);
    fibers && sizes && a.motion == b.motion && same_material(&a.material, &b.material)
}

/// The law in quotes, and key and value of its coefficients.
fn material_lines(material: &Material<f64>) -> [(&'static str, String); 2] {
    match material {
        Material::NeoHookean { shear_modulus_pa } => {
            [("law", "\"neo-hookean\"".into()), ("shear_modulus", megapascals(*shear_modulus_pa))]
        }
        Material::Yeoh { c_pa } => {
            let [c1, c2, c3] = c_pa.map(megapascals);
            [("law", "\"yeoh\"".into()), ("c", format!("[{c1}, {c2}, {c3}]"))]
        }
    }
}

fn winding_lines(fiber: &Fiber<f64>, radius: bool) -> String {
    let families = if fiber.families == Families::One { 1 } else { 2 };
    let (angle, modulus) = (degrees(fiber.angle_rad), megapascals(fiber.modulus_pa));
    let mut lines = format!("angle = {angle}\nfamilies = {families}\nmodulus = {modulus}\n");
    let placement = match fiber.placement {
        Placement::Sheet => {
            let _ = writeln!(lines, "thickness = {}", millimetres(fiber.thickness_m));
            "sheet"
        }
        Placement::Layer => "layer",
        Placement::Smeared => "smeared",
    };
    let _ = writeln!(lines, "placement = \"{placement}\"");
    if radius {
        let _ = writeln!(lines, "radius = {}", millimetres(fiber.radius_m));
    }
    lines
}

fn megapascals(pa: f64) -> String {
    format!("\"{} MPa\"", rounded(pa * 1e-6))
}

fn millimetres(m: f64) -> String {
    format!("\"{} mm\"", rounded(m * 1e3))
}

fn degrees(rad: f64) -> String {
    format!("\"{} deg\"", rounded(rad.to_degrees()))
}

/// A number of few digits.
fn rounded(value: f64) -> f64 {
    // What was printed by the line before reads back.
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}
