//! Segments of different winding along the actuator of a module.

use fra_model::{Material, Motion};

use super::design::segment_bounds;
use super::module::{MOTIONS, Wall, wound};
use super::parts::{Parts, Winding};
use crate::data::ModuleSegment;
use crate::error::Problem;
use crate::reader::Reader;
use crate::schema::{Unit, module, segment as keys};
use crate::source::Located;

/// Numbers of segments of a module.
const SEGMENTS: std::ops::RangeInclusive<usize> = 2..=8;

/// The segments of a module from the base to the tip; empty where it has none.
pub(super) fn segments(
    reader: &Reader<'_>,
    (motion, actuators): (Option<Located<Motion>>, Option<Located<i64>>),
    windings: &Parts<'_, Winding>,
    wall: Wall,
    law: Option<Material<f64>>,
) -> Option<Vec<ModuleSegment>> {
    let Some(span) = reader.key_span(module::SEGMENTS.name) else { return Some(Vec::new()) };
    let tables = reader.tables(&module::SEGMENTS, &keys::SECTION)?;
    if !SEGMENTS.contains(&tables.len()) {
        let (least, most) = (SEGMENTS.start(), SEGMENTS.end());
        let title = format!("`segments` needs {least} to {most} tables `{}`", keys::SECTION.header);
        let problem = Problem::at(span, title, format!("the number here is {}", tables.len()));
        return reader.log().note(problem.help("a module of one segment has `length` and `winding` itself"));
    }
    let own = reader.forbid(&[module::LENGTH.name, module::WINDING.name], "with `segments`, which have their own");
    let plates = reader.forbid(
        &[module::SPACERS.name, module::SPACER_MASS.name],
        "with `segments`, which have nothing rigid between them",
    );
    let places = match actuators {
        Some(count) if *count != 1 => {
            let problem = Problem::at(count.span, "a module with `segments` has one actuator", "several here");
            reader.log().note(problem.help("write `actuators = 1`"))
        }
        _ => reader.forbid(
            &[module::CIRCLE_RADIUS.name, module::SPACING.name],
            "with `segments`, whose actuator is in the middle",
        ),
    };
    let read: Vec<_> = tables.iter().map(|table| segment(table, windings, wall, law)).collect();
    let segments: Vec<ModuleSegment> = read.into_iter().collect::<Option<_>>()?;
    own.and(places).and(plates)?;
    actuators?;
    let motion = motion?;
    if *motion == Motion::Expansion {
        let problem = Problem::at(motion.span, "a module with `segments` has no radius as its setpoint", "expands");
        return reader.log().note(problem.help("choose `extension`, `bending` or `twisting`"));
    }
    if !segments.iter().any(|segment| *segment.motion == *motion) {
        let title = format!("no segment of this module is for `{}`", motion.name());
        let problem = Problem::at(motion.span, title, "the setpoint is the total of this motion");
        return reader.log().note(problem.label(segments[0].motion.span, "the first segment has another"));
    }
    Some(segments)
}

/// Whether the end caps leave some of the first and of the last segment. Notes the one that they do not.
pub(super) fn ends_fit(reader: &Reader<'_>, segments: &[ModuleSegment], end_m: f64) -> bool {
    let mut ends = segments.first().into_iter().chain(segments.last());
    let Some(short) = ends.find(|segment| *segment.length_m <= end_m) else { return true };
    let title = "`end_length` must be less than the `length` of the first and of the last segment";
    let problem = Problem::at(short.length_m.span, title, format!("the end is {}", Unit::MM.show_si(end_m)));
    reader.log().note::<()>(problem);
    false
}

fn segment(
    reader: &Reader<'_>,
    windings: &Parts<'_, Winding>,
    wall: Wall,
    law: Option<Material<f64>>,
) -> Option<ModuleSegment> {
    let motion = reader.choice(&keys::MOTION, &MOTIONS);
    let length = reader.quantity(&keys::LENGTH);
    let direction = reader.quantity(&keys::BEND_DIRECTION);
    let wound = motion.and_then(|motion| wound(reader, (motion, None), windings, wall, law));
    let bounds = segment_bounds(reader, motion);
    let motion = motion?;
    if *motion != Motion::Bending {
        reader.forbid(&[keys::BEND_DIRECTION.name], "in a segment that does not bend")?;
    }
    let [first, second] = wound?;
    Some(ModuleSegment {
        motion,
        length_m: length?,
        bend_direction_rad: *direction?,
        fiber: first.map(|(fiber, _)| fiber),
        thread: first.and_then(|(_, thread)| thread),
        second_fiber: second.map(|(fiber, _)| fiber),
        second_thread: second.and_then(|(_, thread)| thread),
        bounds: bounds?,
        span: reader.span(),
    })
}
