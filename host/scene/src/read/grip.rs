//! Checks payloads against the gripper: only closed jaws carry a payload, and they keep it until they open.

use crate::data::{Gripper, Object, Phase};
use crate::error::Problem;
use crate::reader::{Log, Reader};
use crate::schema::phase as keys;
use crate::source::Span;

/// What the jaws do while a phase moves.
#[derive(Clone, Copy)]
enum Jaws<'p> {
    /// Open since this phase; `None` from the start on.
    Open(Option<usize>),
    /// Closed, with what this phase had; `None` before the first phase.
    Closed(Option<&'p Phase>),
}

/// Notes the first payload that open jaws would carry, and the first that changes in closed ones. A scene without a gripper's command has its
/// payloads fixed to the tip.
pub(super) fn note_grip(readers: &[Reader<'_>], phases: &[Phase], objects: &[Object]) {
    let mut jaws = match phases.iter().find_map(|phase| phase.gripper) {
        None => return,
        Some(Gripper::Close) => Jaws::Open(None),
        Some(Gripper::Open) => Jaws::Closed(None),
    };
    for (index, (reader, phase)) in readers.iter().zip(phases).enumerate() {
        let noted = match jaws {
            Jaws::Open(since) => {
                phase.gripper != Some(Gripper::Close)
                    && note_open(reader, phase, since.and_then(|since| gripper_span(readers.get(since)?)))
            }
            Jaws::Closed(before) => before.is_some_and(|before| note_change(reader, (before, phase), objects)),
        };
        if noted {
            return;
        }
        jaws = match (phase.gripper, jaws) {
            (Some(Gripper::Open), _) => Jaws::Open(Some(index)),
            (Some(Gripper::Close), _) | (None, Jaws::Closed(_)) => Jaws::Closed(Some(phase)),
            (None, open @ Jaws::Open(_)) => open,
        };
    }
}

fn note_open(reader: &Reader<'_>, phase: &Phase, opened: Option<Span>) -> bool {
    if phase.payload_kg == 0.0 && phase.object.is_none() {
        return false;
    }
    let label = "the gripper is open on the way here: nothing holds this";
    let problem = Problem::at(carried_span(reader), "a payload needs closed jaws", label);
    let problem = match opened {
        Some(opened) => problem.label(opened, "it opens here"),
        None => problem,
    };
    let help = "close the gripper in this phase or before it (`gripper = \"close\"`), or leave out this key";
    note(reader.log(), problem.help(help))
}

fn note_change(reader: &Reader<'_>, (before, phase): (&Phase, &Phase), objects: &[Object]) -> bool {
    if (before.payload_kg, before.object) == (phase.payload_kg, phase.object) {
        return false;
    }
    let words = |phase: &Phase| match phase.object.and_then(|index| objects.get(index)) {
        Some(object) => format!("`{}`", object.name.value),
        None => format!("{} kg", phase.payload_kg),
    };
    let label = format!("{} here, {} in `{}`", words(phase), words(before), before.name.value);
    let problem = Problem::at(carried_span(reader), "a payload changes in closed jaws", label);
    let help =
        "the gripper keeps what it holds until it opens: give the same `payload` or `object` in all phases until then";
    note(reader.log(), problem.help(help))
}

fn note(log: &Log, problem: Problem) -> bool {
    log.note::<()>(problem);
    true
}

/// The place of the payload or object, else of the phase.
fn carried_span(reader: &Reader<'_>) -> Span {
    let values = [keys::PAYLOAD.name, keys::OBJECT.name].map(|key| reader.value(key));
    values.into_iter().flatten().next().map_or(reader.span(), |value| value.span().into())
}

fn gripper_span(reader: &Reader<'_>) -> Option<Span> {
    reader.value(keys::GRIPPER.name).map(|value| value.span().into())
}
