//! A scene with other modules: the text of its author, with the sizes that a design found.

use fra_model::{Arrangement, StateQuantity};
use toml_edit::{ArrayOfTables, InlineTable, Item, Table, Value};

use super::RewriteError;
use super::draft::{Draft, Part, put};
use super::sheets::{Threads, freeze};
use crate::data::{Goal, ModuleSegment, Scene};
use crate::schema::{module, phase, scene, segment, target, winding};

/// Design of one module.
#[derive(Clone, Debug, PartialEq)]
pub struct Redesign {
    /// Name of the module.
    pub name: String,
    /// Name of the scene's module that it is made like: what is not said here is as there.
    pub like: String,
    /// Word of the motion, as in a scene.
    pub motion: &'static str,
    /// Number of actuators and their places.
    pub bundle: (u8, Arrangement<f64>),
    /// Rotation about the limb's axis, rad.
    pub mount_angle_rad: f64,
    /// Inner and outer radius at rest, m.
    pub radii_m: [f64; 2],
    /// Length at rest, m.
    pub length_m: f64,
    /// Angle of the winding, rad from the hoop, where the module has a winding; `None` of a module of segments.
    pub winding: Option<f64>,
    /// Length at rest, m, and angle of the winding, rad, of each of its segments, where it has some; empty of a module without.
    pub segments: Vec<(f64, Option<f64>)>,
}

/// A setpoint of a phase: index of the module, the quantity, and its value in SI units.
pub type RedesignedTarget = (usize, StateQuantity, f64);

/// Digits behind the point of millimetres, degrees and kilopascals: a nanometre, and less than a device resolves.
const DIGITS: usize = 6;

/// The text of a scene with these modules, and with these targets in place of the goals of its phases, if there are any: one list for
/// each phase. Comments and everything else stay.
///
/// # Errors
/// [`RewriteError`]. The text that is returned has been read again and says what was asked, to a nanometre and half a millionth of a degree.
pub fn redesigned(
    scene: &Scene,
    modules: &[Redesign],
    targets: Option<&[Vec<RedesignedTarget>]>,
) -> Result<String, RewriteError> {
    let unwritten = |index: usize, what| RewriteError::NotWritten { module: modules[index].name.clone(), what };
    let mut draft = Draft::new(scene).ok_or_else(|| unwritten(0, "text"))?;
    freeze(&mut draft, scene, Threads::Go).ok_or_else(|| unwritten(0, "thread"))?;
    let before = draft.document.get(scene::MODULE.name).and_then(Item::as_array_of_tables).cloned().unwrap_or_default();
    let mut after = ArrayOfTables::new();
    for (index, redesign) in modules.iter().enumerate() {
        let mut table = before.iter().find(|table| named(table, &redesign.like)).cloned().unwrap_or_default();
        resize(&mut table, redesign);
        if let Some(angle_rad) = redesign.winding {
            rewind(&mut draft, &mut table, angle_rad, index);
        }
        let segments = table.get_mut(module::SEGMENTS.name).and_then(Item::as_array_of_tables_mut);
        let segments = segments.into_iter().flat_map(ArrayOfTables::iter_mut).zip(&redesign.segments);
        for (segment_table, (length_m, angle_rad)) in segments {
            put(segment_table, segment::LENGTH.name, millimetres(*length_m));
            if let Some(angle_rad) = angle_rad {
                rewind(&mut draft, segment_table, *angle_rad, index);
            }
        }
        after.push(table);
    }
    draft.document.insert(scene::MODULE.name, Item::ArrayOfTables(after));
    if let Some(targets) = targets {
        let names: Vec<&str> = modules.iter().map(|module| module.name.as_str()).collect();
        retarget(&mut draft, &names, targets);
    }
    let (text, read) = draft.read(scene.source_name())?;
    if read.modules().len() != modules.len() {
        return Err(RewriteError::Modules { found: modules.len(), modules: read.modules().len() });
    }
    for (index, module) in modules.iter().enumerate() {
        differs(&read, index, module).map_or(Ok(()), |what| Err(unwritten(index, what)))?;
    }
    let wrong = targets
        .and_then(|targets| targets.iter().zip(read.phases()).find_map(|(wanted, phase)| missed(wanted, &phase.goal)));
    wrong.map_or(Ok(text), |index| Err(unwritten(index, "targets")))
}

/// First part of a module that differs from the design.
fn differs(scene: &Scene, index: usize, wanted: &Redesign) -> Option<&'static str> {
    let module = &scene.modules()[index];
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9;
    // Half a millionth of a degree, which rounding takes.
    let along = |a: f64, b: f64| (a - b).abs() <= 1e-8;
    let [inner_m, outer_m] = wanted.radii_m;
    let sizes =
        [(*module.inner_radius_m, inner_m), (*module.outer_radius_m, outer_m), (*module.length_m, wanted.length_m)];
    // Each segment is written to a nanometre.
    let rounded = 1e-9 * wanted.segments.len().max(1) as f64;
    if !sizes.iter().all(|(a, b)| (a - b).abs() <= rounded) {
        return Some("sizes");
    }
    let apart = match (module.arrangement, wanted.bundle.1) {
        (Arrangement::Circle { radius_m: a }, Arrangement::Circle { radius_m: b })
        | (Arrangement::Row { spacing_m: a }, Arrangement::Row { spacing_m: b }) => near(a, b),
        _ => false,
    };
    if module.actuators != wanted.bundle.0 || !apart {
        return Some("arrangement");
    }
    let written = |segment: &ModuleSegment, (length_m, angle_rad): &(f64, Option<f64>)| {
        let own_rad = segment.fiber.as_ref().map(|fiber| fiber.angle_rad);
        let wound = angle_rad.is_none_or(|wanted| own_rad.is_some_and(|own| along(own, wanted)));
        near(*segment.length_m, *length_m) && wound
    };
    let segments = || module.segments.iter().zip(&wanted.segments);
    if module.segments.len() != wanted.segments.len() || !segments().all(|(found, wanted)| written(found, wanted)) {
        return Some("segments");
    }
    let angle_rad = module.fiber.as_ref().map(|fiber| fiber.angle_rad);
    if wanted.winding.is_some() && !wanted.winding.zip(angle_rad).is_some_and(|(a, b)| along(a, b)) {
        return Some("fiber angle");
    }
    (!along(module.mount_angle_rad, wanted.mount_angle_rad)).then_some("mount angle")
}

/// The module whose target a goal says otherwise than was asked.
fn missed(wanted: &[RedesignedTarget], goal: &Goal) -> Option<usize> {
    let found = |index: usize, kind: StateQuantity| match goal {
        Goal::Targets(targets) => targets.iter().find(|target| (target.module, target.kind) == (index, kind)),
        _ => None,
    };
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-3_f64.max(b.abs()) * 1e-6;
    let kept = |(index, kind, value): &RedesignedTarget| {
        found(*index, *kind).is_some_and(|target| near(target.value.value, *value))
    };
    wanted.iter().find(|target| !kept(target)).map(|(index, _, _)| *index)
}

fn named(table: &Table, name: &str) -> bool {
    table.get(module::NAME.name).and_then(Item::as_str) == Some(name)
}

fn resize(table: &mut Table, redesign: &Redesign) {
    let (actuators, arrangement) = redesign.bundle;
    put(table, module::NAME.name, redesign.name.as_str().into());
    put(table, module::MOTION.name, redesign.motion.into());
    put(table, module::ACTUATORS.name, i64::from(actuators).into());
    if redesign.segments.is_empty() {
        arrange(table, &arrangement);
        put(table, module::LENGTH.name, millimetres(redesign.length_m));
    }
    put(table, module::MOUNT_ANGLE.name, degrees(redesign.mount_angle_rad));
    put(table, module::INNER_RADIUS.name, millimetres(redesign.radii_m[0]));
    put(table, module::OUTER_RADIUS.name, millimetres(redesign.radii_m[1]));
}

/// Writes the places of the actuators; the keys of the other arrangement go.
fn arrange(table: &mut Table, arrangement: &Arrangement<f64>) {
    match arrangement {
        Arrangement::Circle { radius_m } => {
            table.remove(module::ARRANGEMENT.name);
            table.remove(module::SPACING.name);
            put(table, module::CIRCLE_RADIUS.name, millimetres(*radius_m));
        }
        Arrangement::Row { spacing_m } => {
            table.remove(module::CIRCLE_RADIUS.name);
            put(table, module::ARRANGEMENT.name, "row".into());
            put(table, module::SPACING.name, millimetres(*spacing_m));
        }
    }
}

/// Gives a module windings of its own: copies of others, the first with its own angle.
fn rewind(draft: &mut Draft, table: &mut Table, angle_rad: f64, index: usize) {
    let Some(item) = table.get_mut(module::WINDING.name) else { return };
    let Some(names) = item.as_array_mut() else {
        let name = item.as_str().and_then(|template| rewound(draft, template, Some(angle_rad), index));
        if let Some(name) = name {
            put(table, module::WINDING.name, name.into());
        }
        return;
    };
    for (place, angle_rad) in [Some(angle_rad), None].into_iter().enumerate() {
        let template = names.get(place).and_then(Value::as_str);
        if let Some(name) = template.and_then(|template| rewound(draft, template, angle_rad, index)) {
            names.replace(place, name);
        }
    }
}

/// Name of a copy of a winding with another angle, if one is given, on the outer face of other sizes.
fn rewound(draft: &mut Draft, template: &str, angle_rad: Option<f64>, index: usize) -> Option<String> {
    let names = (index + 1..).map(|number| format!("designed-{number}"));
    let name = draft.copy(Part::Winding, template, names)?;
    let copy = draft.part(Part::Winding, &name)?;
    if let Some(angle_rad) = angle_rad {
        put(copy, winding::ANGLE.name, degrees(angle_rad));
    }
    let smeared = copy.get(winding::PLACEMENT.name).and_then(Item::as_str).is_some_and(|word| word != "sheet");
    if !smeared {
        copy.remove(winding::RADIUS.name);
    }
    Some(name)
}

fn retarget(draft: &mut Draft, modules: &[&str], targets: &[Vec<RedesignedTarget>]) {
    let phases = draft.document.get_mut(scene::PHASE.name).and_then(Item::as_array_of_tables_mut);
    let Some(phases) = phases else { return };
    for (table, targets) in phases.iter_mut().zip(targets) {
        let mut goals = InlineTable::new();
        for (index, kind, value) in targets {
            let (key, value) = setpoint(*kind, *value);
            let mut goal = InlineTable::new();
            goal.insert(key, value);
            goals.insert(modules[*index], Value::InlineTable(goal));
        }
        table.remove(phase::TIP.name);
        put(table, phase::TARGETS.name, Value::InlineTable(goals));
    }
}

/// Key and value of a setpoint as a scene writes it.
fn setpoint(kind: StateQuantity, value: f64) -> (&'static str, Value) {
    match kind {
        StateQuantity::Pressure => (target::PRESSURE.name, format!("{} kPa", short(value * 1e-3)).into()),
        StateQuantity::AxialStretch => (target::AXIAL_STRETCH.name, ((value * 1e9).round() / 1e9).into()),
        StateQuantity::OuterRadius => (target::OUTER_RADIUS.name, millimetres(value)),
        StateQuantity::InnerRadius => (target::INNER_RADIUS.name, millimetres(value)),
        StateQuantity::Twist => (target::TWIST.name, degrees(value)),
        StateQuantity::BendAngle => (target::BEND_ANGLE.name, degrees(value)),
    }
}

fn millimetres(metres: f64) -> Value {
    format!("{} mm", short(metres * 1e3)).into()
}

fn degrees(radians: f64) -> Value {
    format!("{} deg", short(radians.to_degrees())).into()
}

/// A number with as many digits as are of use.
fn short(number: f64) -> String {
    let text = format!("{number:.DIGITS$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
