//! Places of a module's actuators: on a circle or in a row, side by side.

use std::f64::consts::PI;

use fra_model::{Arrangement, Motion};

use crate::error::Problem;
use crate::reader::Reader;
use crate::schema::{Quantity, Unit, module as keys};
use crate::source::Located;

/// The arrangements, in the order of the schema's words.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Circle,
    Row,
}

/// The places of a module's actuators, which must have room side by side.
pub(super) fn arrangement(
    reader: &Reader<'_>,
    motion: Option<Located<Motion>>,
    actuators: Option<Located<i64>>,
    outer: Option<Located<f64>>,
) -> Option<Arrangement<f64>> {
    let kind = reader.choice(&keys::ARRANGEMENT, &[Kind::Circle, Kind::Row])?;
    let (own, other) = match *kind {
        Kind::Circle => (&keys::CIRCLE_RADIUS, &keys::SPACING),
        Kind::Row => (&keys::SPACING, &keys::CIRCLE_RADIUS),
    };
    let is_own = other_is_absent(reader, *kind, own, other);
    let distance = distance(reader, *kind, own, actuators, outer);
    is_own?;
    if *kind == Kind::Row && motion.is_some_and(|motion| *motion == Motion::Twisting) && *actuators? > 1 {
        let title = "`twisting` actuators need `arrangement = \"circle\"`";
        let label = "in a row they would be helices of different radii and lengths";
        return reader
            .log()
            .note(Problem::at(kind.span, title, label).help("remove this key and give `circle_radius`"));
    }
    let distance = distance?;
    Some(match *kind {
        Kind::Circle => Arrangement::Circle { radius_m: distance },
        Kind::Row => Arrangement::Row { spacing_m: distance },
    })
}

/// Fewest actuators that bend a module in two directions.
const STEERING_MIN: i64 = 3;

/// Whether each actuator has its own setpoint. Notes an arrangement that cannot bend in two directions.
pub(super) fn steering(
    reader: &Reader<'_>,
    motion: Option<Located<Motion>>,
    actuators: Option<Located<i64>>,
    arrangement: Option<Arrangement<f64>>,
) -> Option<bool> {
    if !reader.flag(&keys::STEERING)? {
        return Some(false);
    }
    let span = reader.key_span(keys::STEERING.name).unwrap_or(reader.span());
    let (motion, actuators) = (motion?, actuators?);
    if *motion != Motion::Extension {
        let problem = Problem::at(span, "a `steering` module needs extending actuators", "each has its own setpoint");
        let help = "set `motion = \"extension\"` with a winding that extends, or leave out `steering`";
        return reader.log().note(problem.label(motion.span, "these do not extend").help(help));
    }
    if *actuators < STEERING_MIN {
        let title = format!("a `steering` module needs {STEERING_MIN} actuators or more");
        let label = format!("there {} {}", if *actuators == 1 { "is" } else { "are" }, *actuators);
        let problem = Problem::at(span, title, "fewer do not bend it in two directions");
        return reader.log().note(problem.label(actuators.span, label));
    }
    if matches!(arrangement?, Arrangement::Row { .. }) {
        let title = "a `steering` module needs `arrangement = \"circle\"`";
        let label = "a row bends it in one direction alone";
        return reader.log().note(Problem::at(span, title, label).help("give `circle_radius` in place of `spacing`"));
    }
    Some(true)
}

/// Notes the distance of the other arrangement.
fn other_is_absent(reader: &Reader<'_>, kind: Kind, own: &Quantity, other: &Quantity) -> Option<()> {
    let Some(span) = reader.key_span(other.name) else { return Some(()) };
    let (word, other_word) = if kind == Kind::Circle { ("circle", "row") } else { ("row", "circle") };
    let title = format!("`{}` has no meaning with `arrangement = \"{word}\"`", other.name);
    let label = format!("give `{}`, or `arrangement = \"{other_word}\"`", own.name);
    reader.log().note(Problem::at(span, title, label))
}

/// Radius of the circle or distance of neighbours in the row, m.
fn distance(
    reader: &Reader<'_>,
    kind: Kind,
    key: &Quantity,
    actuators: Option<Located<i64>>,
    outer: Option<Located<f64>>,
) -> Option<f64> {
    let distance = reader.maybe(key)?;
    let count = *actuators?;
    let Some(distance) = distance else {
        return if count == 1 { Some(0.0) } else { reader.missing(key.name, " for two or more actuators") };
    };
    let outer = outer?;
    // Axes on a circle are a chord of 2 r sin(pi/n) apart.
    let per_distance = if kind == Kind::Circle { 2.0 * (PI / count as f64).sin() } else { 1.0 };
    let apart = *distance * per_distance;
    // Actuators may touch, so rounding must not part them.
    if count == 1 || apart >= 2.0 * *outer * (1.0 - 1e-9) {
        return Some(*distance);
    }
    let label = format!("the axes are {} apart", Unit::MM.show_si(apart));
    let wide = format!("each is {} wide", Unit::MM.show_si(2.0 * *outer));
    let least = Unit::MM.show_si(2.0 * *outer / per_distance);
    let help = format!("{count} actuators need a `{}` of at least {least}", key.name);
    reader.log().note(Problem::at(distance.span, "the actuators overlap", label).label(outer.span, wide).help(help))
}
