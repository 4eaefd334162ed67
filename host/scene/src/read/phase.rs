//! Phases and their targets.

use std::collections::BTreeSet;

use fra_model::{Motion, StateQuantity};
use toml::de::DeValue;

use super::grip::note_grip;
use super::limb::unit;
use super::module::{Draft, note_duplicate};
use super::settings::microseconds;
use crate::data::{Aim, Goal, Gripper, Marker, Object, Phase, Region, Target, Weight};
use crate::error::{Problem, quoted};
use crate::reader::{Reader, Value};
use crate::schema;
use crate::schema::{Quantity, phase as keys, target as quantities};
use crate::source::{Located, Span};
use crate::suggest::closest;
use crate::value::wrong_type;

/// Most phases of a scene.
const PHASES_MAX: usize = 200;

/// The quantities a target may name.
const QUANTITIES: [(Quantity, StateQuantity); 6] = [
    (quantities::AXIAL_STRETCH, StateQuantity::AxialStretch),
    (quantities::OUTER_RADIUS, StateQuantity::OuterRadius),
    (quantities::INNER_RADIUS, StateQuantity::InnerRadius),
    (quantities::TWIST, StateQuantity::Twist),
    (quantities::BEND_ANGLE, StateQuantity::BendAngle),
    (quantities::PRESSURE, StateQuantity::Pressure),
];

/// Reads all phases, and tells every module the quantity its targets are given in.
///
/// A scene has phases or a marker series; the latter makes two. Of regions, markers and weight, `None` stands for a noted problem.
pub(super) fn phases(
    root: &Reader<'_>,
    drafts: &mut [Draft<'_>],
    (regions, objects): (Option<&[Region]>, Option<&[Object]>),
    markers: Option<&Option<Located<Vec<Marker>>>>,
    weight: Option<&Weight>,
) -> Option<Vec<Phase>> {
    if let (Some(first), Some(second)) =
        (root.key_span(schema::scene::PHASE.name), root.key_span(schema::scene::MARKERS.name))
    {
        let problem = Problem::at(second, "a scene has phases or `[markers]`", "the motion is given here");
        return root.log().note(problem.label(first, "and here"));
    }
    if root.value(schema::scene::MARKERS.name).is_some() {
        return markers?.as_ref().map(series);
    }
    let readers = root.tables(&schema::scene::PHASE, &keys::SECTION)?;
    if let Some(extra) = readers.get(PHASES_MAX) {
        let label = format!("a scene has at most {PHASES_MAX} phases");
        return root.log().note(Problem::at(extra.span(), "too many phases", label));
    }
    let mut kinds: Vec<Option<(StateQuantity, Span)>> = vec![None; drafts.len()];
    let mut names: Vec<Located<&str>> = Vec::new();
    let mut phases = Vec::new();
    for reader in &readers {
        let name = reader.text(&keys::NAME);
        note_duplicate(reader, "phase", name, names.iter().copied());
        names.extend(name);
        phases.push(phase(reader, name, drafts, &mut kinds, (regions, objects)));
    }
    for (draft, kind) in drafts.iter_mut().zip(kinds) {
        if let (Some(module), Some((kind, _))) = (&mut draft.module, kind) {
            module.setpoint_kind = kind;
        }
    }
    if weight.is_some_and(|weight| !weight.simulated) {
        note_payload(&readers, &phases);
    }
    let phases: Vec<Phase> = phases.into_iter().collect::<Option<_>>()?;
    note_grip(&readers, &phases, objects.unwrap_or_default());
    Some(phases)
}

/// A payload that nothing carries: the first is named, as one cure is good for all.
fn note_payload(readers: &[Reader<'_>], phases: &[Option<Phase>]) {
    let loaded = |phase: &Option<Phase>| phase.as_ref().is_some_and(|phase| phase.payload_kg > 0.0);
    let first = readers.iter().zip(phases).find(|(_, phase)| loaded(phase));
    let written = |reader: &Reader<'_>| -> Option<Span> {
        let values = [keys::PAYLOAD.name, keys::OBJECT.name].map(|key| reader.value(key));
        values.into_iter().flatten().next().map(|value| value.span().into())
    };
    let Some((reader, span)) = first.and_then(|(reader, _)| Some((reader, written(reader)?))) else { return };
    let label = "the limb is weightless: this mass would be ignored".to_owned();
    let problem = Problem::at(span, "a payload needs weight", label);
    let help = "leave out `simulated = false` of `[weight]` so that the limb carries itself and its load, or leave out \
                this key; `softlimb statics --payload KG` loads a scene without it";
    reader.log().note::<()>(problem.help(help));
}

fn phase(
    reader: &Reader<'_>,
    name: Option<Located<&str>>,
    drafts: &[Draft<'_>],
    kinds: &mut [Option<(StateQuantity, Span)>],
    (regions, objects): (Option<&[Region]>, Option<&[Object]>),
) -> Option<Phase> {
    let duration = reader.maybe(&keys::DURATION);
    let hold = reader.quantity(&keys::HOLD);
    let payload = reader.quantity(&keys::PAYLOAD);
    let object = object(reader, objects);
    let gripper = reader.maybe_choice(&keys::GRIPPER, &[Gripper::Open, Gripper::Close]);
    let (tip, inside) = (reader.vector(&keys::TIP), reader.maybe_text(&keys::INSIDE));
    let goal = match (reader.value(keys::TARGETS.name), tip?, inside?) {
        (Some(value), None, None) => {
            reader.forbid(&[keys::DIRECTION.name, keys::DIRECTION_TOLERANCE.name], "with `targets`")?;
            Goal::Targets(targets(reader, value, drafts, kinds)?)
        }
        (None, Some(tip), None) => Goal::Tip(tip),
        (None, None, Some(name)) => Goal::Inside(region_named(reader, name, regions?)?),
        (targets, tip, inside) => {
            return note_goals(reader, targets.is_some() || tip.is_some() || inside.is_some());
        }
    };
    Some(Phase {
        name: name?.map(str::to_owned),
        move_us: duration?.map(|duration| duration.map(microseconds)),
        hold_us: microseconds(*hold?),
        payload_kg: payload?.value + object?.map_or(0.0, |index| objects.map_or(0.0, |all| all[index].mass_kg)),
        object: object?,
        goal,
        aim: aim(reader)?,
        gripper: gripper?.map(|gripper| *gripper),
        span: reader.span(),
    })
}

/// The object that the tip carries; the inner `None` where there is none.
fn object(reader: &Reader<'_>, objects: Option<&[Object]>) -> Option<Option<usize>> {
    let Some(name) = reader.maybe_text(&keys::OBJECT)? else { return Some(None) };
    reader.forbid(&[keys::PAYLOAD.name], "with `object`, whose mass is carried")?;
    let objects = objects?;
    if let Some(index) = objects.iter().position(|object| object.name.value == name.value) {
        return Some(Some(index));
    }
    let help = match closest(name.value, objects.iter().map(|object| object.name.value.as_str())) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "define it as an `[[object]]`".to_owned(),
    };
    let title = format!("unknown object {}", quoted(name.value));
    reader.log().note(Problem::at(name.span, title, "no such object").help(help))
}

/// The direction of the end effector; the inner `None` where none is asked for.
fn aim(reader: &Reader<'_>) -> Option<Option<Aim>> {
    let tolerance = reader.quantity(&keys::DIRECTION_TOLERANCE)?;
    let Some(direction) = reader.vector(&keys::DIRECTION)? else {
        reader.forbid(&[keys::DIRECTION_TOLERANCE.name], "without `direction`")?;
        return Some(None);
    };
    let Some(along) = unit(*direction) else {
        let title = "`direction` has no direction";
        return reader.log().note(Problem::at(direction.span, title, "its length is zero"));
    };
    Some(Some(Aim { direction: direction.map(|_| along), tolerance_rad: *tolerance }))
}

pub(super) fn region_named(reader: &Reader<'_>, name: Located<&str>, regions: &[Region]) -> Option<Located<usize>> {
    if let Some(index) = regions.iter().position(|region| region.name.value == name.value) {
        return Some(name.map(|_| index));
    }
    let help = match closest(name.value, regions.iter().map(|region| region.name.value.as_str())) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "define it as a `[[region]]`".to_owned(),
    };
    let title = format!("unknown region {}", quoted(name.value));
    reader.log().note(Problem::at(name.span, title, "no such region").help(help))
}

/// The phases of a marker series: the way to its first position, and the series.
fn series(markers: &Located<Vec<Marker>>) -> Vec<Phase> {
    let span = markers.span;
    let phase = |name: &str, move_us, goal| Phase {
        name: Located { value: name.to_owned(), span },
        move_us,
        hold_us: 0,
        payload_kg: 0.0,
        object: None,
        goal,
        aim: None,
        gripper: None,
        span,
    };
    let first = markers.first().map_or([0.0; 3], |marker| marker.tip_m);
    let time_us = microseconds(markers.last().map_or(0.0, |marker| marker.time_s));
    vec![
        phase("approach", None, Goal::Tip(Located { value: first, span })),
        phase("markers", Some(Located { value: time_us, span }), Goal::Series(span)),
    ]
}

/// A phase has one goal, neither two nor none.
fn note_goals<T>(reader: &Reader<'_>, two: bool) -> Option<T> {
    if !two {
        let title = "the phase has no goal";
        return reader.log().note(Problem::at(reader.span(), title, "give it `targets`, `tip` or `inside`"));
    }
    let names = [keys::TARGETS.name, keys::TIP.name, keys::INSIDE.name];
    let mut written = names.into_iter().filter_map(|name| reader.key_span(name));
    let (first, second) = (written.next().unwrap_or(reader.span()), written.next().unwrap_or(reader.span()));
    let title = "a phase has one of `targets`, `tip` and `inside`";
    let problem = Problem::at(second, title, "this is the second goal");
    reader.log().note(problem.label(first, "this is the first"))
}

fn targets<'a>(
    reader: &Reader<'a>,
    value: &'a Value<'a>,
    drafts: &[Draft<'_>],
    kinds: &mut [Option<(StateQuantity, Span)>],
) -> Option<Vec<Target>> {
    let DeValue::Table(table) = value.get_ref() else {
        let shape = keys::TARGETS.shape;
        return reader.log().note(wrong_type(value.span().into(), "`targets`", &format!("a {shape}"), value.get_ref()));
    };
    let mut targets = Vec::new();
    for (key, value) in table.iter() {
        let module = module_named(reader, key.get_ref().as_ref(), key.span().into(), drafts);
        let entry = Reader::open(reader.log(), value, &quantities::SECTION, &quoted(key.get_ref()));
        targets.push(module.zip(entry).and_then(|(module, entry)| target(&entry, module, drafts.get(module)?, kinds)));
    }
    let mut targets = targets.into_iter().collect::<Option<Vec<_>>>()?;
    targets.sort_by_key(|target| target.module);
    Some(targets)
}

fn module_named(reader: &Reader<'_>, name: &str, span: Span, drafts: &[Draft<'_>]) -> Option<usize> {
    let known = || drafts.iter().filter_map(|draft| Some(draft.name?.value));
    let found = drafts.iter().position(|draft| draft.name.is_some_and(|known| known.value == name));
    // A module whose own name is wrong may be the one that is meant.
    if drafts.is_empty() || drafts.iter().any(|draft| draft.name.is_none()) {
        return found;
    }
    found.or_else(|| {
        let help = match closest(name, known()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => {
                let names: BTreeSet<_> = known().collect();
                format!("known modules: {}", Vec::from_iter(names).join(", "))
            }
        };
        let title = format!("target for the unknown module {}", quoted(name));
        reader.log().note(Problem::at(span, title, "no such module").help(help))
    })
}

fn target(
    entry: &Reader<'_>,
    module: usize,
    draft: &Draft<'_>,
    kinds: &mut [Option<(StateQuantity, Span)>],
) -> Option<Target> {
    let name = draft.name?.value;
    let mut written = QUANTITIES.iter().filter_map(|(key, kind)| Some((key, *kind, entry.key_span(key.name)?)));
    let Some((key, kind, span)) = written.next() else {
        let title = format!("the target of `{name}` names no quantity");
        return entry.log().note(Problem::at(entry.span(), title, "nothing to reach").help(help_for(draft.motion)));
    };
    if let Some((_, _, second)) = written.next() {
        let title = format!("the target of `{name}` names more than one quantity");
        return entry.log().note(Problem::at(second, title, "another one").label(span, "one quantity"));
    }
    let value = entry.maybe(key)??;
    check_fit(entry, name, draft.motion?, (key.name, kind, span))?;
    check_same(entry, name, kinds.get_mut(module)?, (key.name, kind, span))?;
    Some(Target { module, kind, value })
}

/// A quantity as a target names it: key, kind and place.
type Named = (&'static str, StateQuantity, Span);

fn check_fit(entry: &Reader<'_>, module: &str, motion: Located<Motion>, (name, kind, span): Named) -> Option<()> {
    if kind.fits(*motion) {
        return Some(());
    }
    let title = format!("`{name}` does not fit the module `{module}`");
    let problem = Problem::at(span, title, format!("`{module}` has no such target"));
    entry.log().note(problem.label(motion.span, "because of its motion").help(help_for(Some(motion))))
}

/// The device is configured with one quantity for each channel.
fn check_same(
    entry: &Reader<'_>,
    module: &str,
    first: &mut Option<(StateQuantity, Span)>,
    (name, kind, span): Named,
) -> Option<()> {
    match *first.get_or_insert((kind, span)) {
        (same, _) if same == kind => Some(()),
        (_, first_span) => {
            let title = format!("the targets of `{module}` are in different quantities");
            let problem = Problem::at(span, title, format!("`{name}` here"));
            entry.log().note(problem.label(first_span, "another quantity here").help("use the same one in all phases"))
        }
    }
}

fn help_for(motion: Option<Located<Motion>>) -> String {
    let fitting = QUANTITIES.iter().filter(|(_, kind)| motion.is_none_or(|motion| kind.fits(*motion)));
    let names: Vec<_> = fitting.map(|(key, _)| format!("`{}`", key.name)).collect();
    format!("use one of {}", names.join(", "))
}
