//! Modules: geometry, and the parts they name.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement, StateQuantity};

use super::arrangement::{arrangement, steering};
use super::design::module_bounds;
use super::parts::{Elastomer, Parts, Winding};
use super::segments::{ends_fit, segments};
use crate::data::{Limits, Module, ModuleBounds, Thread, WoundActuator, WoundWall};
use crate::elastomers::castable_elastomer;
use crate::error::{Problem, quoted};
use crate::reader::Reader;
use crate::schema;
use crate::schema::{Unit, module as keys};
use crate::source::Located;

/// A module as far as it could be read. Phases need its name and motion even if the rest is wrong.
pub(super) struct Draft<'a> {
    pub(super) name: Option<Located<&'a str>>,
    pub(super) motion: Option<Located<Motion>>,
    pub(super) actuators: Option<Located<i64>>,
    /// Bounds of a design of it.
    pub(super) bounds: ModuleBounds,
    pub(super) module: Option<Module>,
}

/// The motions, in the order of the schema's words.
pub(super) const MOTIONS: [Motion; 4] = [Motion::Extension, Motion::Expansion, Motion::Bending, Motion::Twisting];

pub(super) fn modules<'a>(
    root: &Reader<'a>,
    materials: &Parts<'a, Elastomer>,
    windings: &Parts<'a, Winding>,
    limits: Option<&Limits>,
) -> Vec<Draft<'a>> {
    let mut drafts: Vec<Draft<'a>> = Vec::new();
    for reader in root.tables(&schema::scene::MODULE, &keys::SECTION).unwrap_or_default() {
        let draft = draft(&reader, materials, windings, limits);
        let earlier = drafts.iter().filter_map(|earlier| earlier.name);
        note_duplicate(&reader, "module", draft.name, earlier);
        drafts.push(draft);
    }
    drafts
}

/// Notes a name that an earlier table of the same kind has.
pub(super) fn note_duplicate<'a>(
    reader: &Reader<'_>,
    kind: &str,
    name: Option<Located<&'a str>>,
    mut earlier: impl Iterator<Item = Located<&'a str>>,
) {
    let Some(name) = name else { return };
    if let Some(first) = earlier.find(|first| first.value == name.value) {
        let title = format!("there are two {kind}s named {}", quoted(name.value));
        let problem = Problem::at(name.span, title, "the second one");
        reader.log().note::<()>(problem.label(first.span, "the first one"));
    }
}

fn draft<'a>(
    reader: &Reader<'a>,
    materials: &Parts<'a, Elastomer>,
    windings: &Parts<'a, Winding>,
    limits: Option<&Limits>,
) -> Draft<'a> {
    let name = reader.text(&keys::NAME);
    let motion = reader.choice(&keys::MOTION, &MOTIONS);
    let actuators = reader.integer(&keys::ACTUATORS);
    let inner = reader.quantity(&keys::INNER_RADIUS);
    let outer = reader.quantity(&keys::OUTER_RADIUS);
    let wall = inner.zip(outer).and_then(|(inner, outer)| wall(reader, inner, outer));
    let arrangement = arrangement(reader, motion, actuators, outer);
    let steering = steering(reader, motion, actuators, arrangement);
    let material = reader.text(&keys::MATERIAL).and_then(|name| Some((name, elastomer(reader, materials, name)?)));
    let law = material.as_ref().map(|(_, elastomer)| elastomer.law);
    let segments = segments(reader, (motion, actuators), windings, wall, law);
    let length = match segments.as_deref() {
        None => None,
        Some([]) => reader.maybe(&keys::LENGTH).and_then(|length| length.or_else(|| reader.missing("length", ""))),
        Some(several) => Some(Located { value: several.iter().map(|one| *one.length_m).sum(), span: reader.span() }),
    };
    let end_length = length.zip(reader.quantity(&keys::END_LENGTH)).and_then(|(length, end)| ends(reader, length, end));
    let mount_angle = reader.quantity(&keys::MOUNT_ANGLE);
    let spacers = reader.integer(&keys::SPACERS);
    let spacer_mass = reader.quantity(&keys::SPACER_MASS);
    let end_length = end_length.filter(|end| ends_fit(reader, segments.as_deref().unwrap_or_default(), *end));
    let bounds = module_bounds(reader).unwrap_or_default();
    let wound = match segments.as_deref() {
        Some([]) => motion.and_then(|motion| wound(reader, (motion, actuators), windings, wall, law)),
        // That of the first segment with the module's motion stands for the module.
        several => several.zip(motion).and_then(|(several, motion)| {
            let first = several.iter().find(|one| *one.motion == *motion)?;
            Some([first.fiber.zip(Some(first.thread)), first.second_fiber.zip(Some(first.second_thread))])
        }),
    };
    let pressure_max = match reader.maybe(&keys::PRESSURE_MAX) {
        Some(None) => limits.map(|limits| limits.pressure_max_pa),
        found => found.flatten(),
    };
    let module = || {
        let (inner, outer) = wall?;
        let (material_name, material) = material?;
        let [first, second] = wound?;
        Some(Module {
            name: name?.map(str::to_owned),
            motion: motion?,
            actuators: u8::try_from(*actuators?).ok()?,
            arrangement: arrangement?,
            steering: steering?,
            mount_angle_rad: *mount_angle?,
            spacers: u8::try_from(*spacers?).ok()?,
            spacer_mass_kg: *spacer_mass?,
            inner_radius_m: inner,
            outer_radius_m: outer,
            length_m: length?,
            segments: segments?,
            end_length_m: end_length?,
            material: material_name.map(|_| material.law),
            stretch_max: material.stretch_max,
            density_kg_per_m3: material.density_kg_per_m3,
            fiber: first.map(|(fiber, _)| fiber),
            thread: first.and_then(|(_, thread)| thread),
            second_fiber: second.map(|(fiber, _)| fiber),
            second_thread: second.and_then(|(_, thread)| thread),
            pressure_max_pa: pressure_max?,
            setpoint_kind: StateQuantity::natural(*motion?),
            span: reader.span(),
        })
    };
    let module = module().filter(|module| model_accepts(reader, module));
    Draft { name, motion, actuators, bounds, module }
}

/// The scene's material of a name, or the castable elastomer of a trade name.
fn elastomer(reader: &Reader<'_>, materials: &Parts<'_, Elastomer>, name: Located<&str>) -> Option<Elastomer> {
    if materials.has(name.value) {
        return materials.find(reader.log(), name).copied();
    }
    match castable_elastomer(name.value) {
        Ok(castable) => Some(castable.into()),
        // A trade name has blanks or digits that a name of the scene's own rarely has.
        Err(help) if name.value.contains(' ') => {
            let title = format!("unknown elastomer {}", quoted(name.value));
            reader.log().note(Problem::at(name.span, title, "no such material").help(help))
        }
        Err(_) => materials.find(reader.log(), name).copied(),
    }
}

fn wall(reader: &Reader<'_>, inner: Located<f64>, outer: Located<f64>) -> Option<(Located<f64>, Located<f64>)> {
    if *inner < *outer {
        return Some((inner, outer));
    }
    let problem = Problem::at(
        inner.span,
        "`inner_radius` must be below `outer_radius`",
        format!("the inner radius is {}", Unit::MM.show_si(*inner)),
    );
    let outer_label = format!("the outer radius is {}", Unit::MM.show_si(*outer));
    reader.log().note(problem.label(outer.span, outer_label))
}

/// The length that the cap at one end takes out of the motion, m, if both ends leave some of the length.
fn ends(reader: &Reader<'_>, length: Located<f64>, end: Located<f64>) -> Option<f64> {
    if 2.0 * *end < *length {
        return Some(*end);
    }
    let title = "`end_length` at both ends must be less than `length`";
    let problem = Problem::at(end.span, title, format!("two ends are {}", Unit::MM.show_si(2.0 * *end)));
    reader.log().note(problem.label(length.span, format!("the length is {}", Unit::MM.show_si(*length))))
}

/// A winding at its place in a module, and its thread where the scene states one.
pub(super) type Wound = (Located<Fiber<f64>>, Option<Thread>);

pub(super) type Wall = Option<(Located<f64>, Located<f64>)>;

/// The windings a module names, at their radii in this wall; none for a bending module that names none.
pub(super) fn wound(
    reader: &Reader<'_>,
    (motion, actuators): (Located<Motion>, Option<Located<i64>>),
    windings: &Parts<'_, Winding>,
    wall: Wall,
    law: Option<Material<f64>>,
) -> Option<[Option<Wound>; 2]> {
    let Some(names) = reader.one_or_two_names(&keys::WINDING)? else {
        return match *motion {
            Motion::Bending => Some([None; 2]),
            _ => reader.missing(keys::WINDING.name, " for this motion"),
        };
    };
    let found: Vec<_> = names.iter().map(|name| Some((*name, windings.find(reader.log(), *name)?))).collect();
    let found: Vec<(Located<&str>, &Winding)> = found.into_iter().collect::<Option<_>>()?;
    match (*motion, found.as_slice()) {
        (Motion::Twisting, [(name, winding)]) if *winding.families == Families::Two => {
            let title = "a `twisting` module needs a winding of one family";
            let problem = Problem::at(name.span, title, "two mirrored families do not twist");
            return reader.log().note(problem.label(winding.families.span, "two families"));
        }
        (Motion::Twisting, [(name, _), second]) if !found.iter().any(|(_, winding)| twists(winding)) => {
            let title = "a `twisting` module needs a helix of one family";
            let problem = Problem::at(name.span, title, "neither this winding twists");
            return reader.log().note(problem.label(second.0.span, "nor this one"));
        }
        (Motion::Extension | Motion::Expansion, [_, _]) => {
            if let Some((name, winding)) = found.iter().find(|(_, winding)| twists(winding)) {
                let title = format!(
                    "winding {} twists, and a module that does not twist takes two that do not",
                    quoted(name.value)
                );
                let problem = Problem::at(name.span, title, "a helix of one family");
                let help = "two mirrored families, hoops and axial threads do not twist";
                return reader.log().note(problem.label(winding.families.span, "one family").help(help));
            }
        }
        (Motion::Bending, [_, _]) => {
            let twisting = found.iter().find(|(_, winding)| twists(winding));
            let several = actuators.filter(|actuators| **actuators > 1);
            if let Some(((name, winding), actuators)) = twisting.zip(several) {
                let title =
                    format!("winding {} twists, and plates hold the twist of several benders back", quoted(name.value));
                let problem = Problem::at(name.span, title, "a helix of one family");
                let problem = problem.label(winding.families.span, "one family").label(actuators.span, "several");
                return reader.log().note(problem.help("`actuators = 1`, or two families of each helix"));
            }
        }
        _ => {}
    }
    let mut wound = found.into_iter().map(|(name, winding)| fiber(reader, name, winding, wall, law));
    match (wound.next()?, wound.next()) {
        (first, None) => Some([Some(first?), None]),
        (first, Some(second)) => Some([Some(first?), Some(second?)]),
    }
}

/// Whether a winding is a helix without its mirror image.
fn twists(winding: &Winding) -> bool {
    let (sin, cos) = winding.angle_rad.sin_cos();
    *winding.families == Families::One && sin.abs().min(cos.abs()) > 1e-9
}

/// A winding at its radius in this wall.
fn fiber(
    reader: &Reader<'_>,
    name: Located<&str>,
    winding: &Winding,
    wall: Wall,
    law: Option<Material<f64>>,
) -> Option<Wound> {
    let (inner, outer) = wall?;
    let radius_m = winding.radius_m.map_or(*outer, |radius| *radius);
    let outermost = if *winding.placement == Placement::Layer { outer.next_down() } else { *outer };
    if !(*inner..=outermost).contains(&radius_m) {
        let (inner, outer) = (Unit::MM.show_si(*inner), Unit::MM.show_si(*outer));
        let title = format!("winding {} does not lie in the wall", quoted(name.value));
        let problem = Problem::at(name.span, title, format!("the wall is from {inner} to {outer}"));
        let radius = format!("its radius is {}", Unit::MM.show_si(radius_m));
        return reader.log().note(problem.label(winding.radius_m.map_or(winding.span, |radius| radius.span), radius));
    }
    let mut fiber = Fiber {
        angle_rad: winding.angle_rad,
        families: *winding.families,
        modulus_pa: winding.modulus_pa,
        placement: *winding.placement,
        thickness_m: winding.thickness_m,
        radius_m,
    };
    if let Some(thread) = winding.thread {
        let wall = WoundWall {
            inner_radius_m: *inner,
            outer_radius_m: *outer,
            winding_radius_m: radius_m,
            angle_rad: winding.angle_rad,
            shear_modulus_pa: law?.shear_modulus_pa(),
        };
        has_room(reader, name, winding, &thread, &wall)?;
        // A calibrated winding states the sheet of its thread itself.
        if fiber.thickness_m == 0.0 {
            fiber.thickness_m = thread.diameter_m;
            fiber.modulus_pa = thread.sheet_n_per_m(&wall) / thread.diameter_m;
        }
    }
    Some((name.map(|_| fiber), winding.thread))
}

/// Notes threads that would lie on each other.
fn has_room(
    reader: &Reader<'_>,
    name: Located<&str>,
    winding: &Winding,
    thread: &Thread,
    wall: &WoundWall,
) -> Option<()> {
    let spacing_m = thread.spacing_m(wall);
    if spacing_m > thread.diameter_m {
        return Some(());
    }
    let most = Thread { starts: 1, ..*thread }.spacing_m(wall) / thread.diameter_m;
    let [spacing, diameter] = [spacing_m, thread.diameter_m].map(|length_m| Unit::MM.show_si(length_m));
    let title = format!("the threads of winding {} do not fit side by side", quoted(name.value));
    let label = format!("on this module they are {spacing} apart, and {diameter} thick");
    let help = if most > 1.0 {
        format!("at this angle up to {} `starts` fit", most.ceil() - 1.0)
    } else {
        "a steeper `angle` or a thinner thread fits".to_owned()
    };
    reader.log().note(Problem::at(name.span, title, label).label(winding.span, "this winding").help(help))
}

/// The last word is the model's own. It accepts what the checks above let through; if ever not, the module is named.
fn model_accepts(reader: &Reader<'_>, module: &Module) -> bool {
    let mut all = module.segment_actuators();
    all.push(module.wound_actuator());
    let second =
        |(first, fiber): &WoundActuator| fiber.map(|fiber| ActuatorParameters { fiber: Some(fiber), ..*first });
    let verdict = all.iter().try_for_each(|one| {
        one.0.check()?;
        second(one).map_or(Ok(()), |second| second.check())
    });
    if let Err(error) = verdict {
        reader.log().note::<()>(Problem::at(reader.span(), error.to_string(), "in this module"));
    }
    verdict.is_ok()
}
