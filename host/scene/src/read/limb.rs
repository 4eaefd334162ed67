//! Base, connectors and end effector.

use crate::data::{EndEffector, Limb};
use crate::error::{Problem, quoted};
use crate::reader::Reader;
use crate::schema;
use crate::schema::{connector, end_effector};
use crate::source::Located;

pub(super) fn limb(root: &Reader<'_>) -> Option<Limb> {
    use schema::limb::{BASE_DIRECTION, BASE_POSITION, BASE_UP, CONNECTOR, END_EFFECTOR, SECTION};
    let name = schema::scene::LIMB.name;
    let Some(value) = root.value(name) else {
        return root.no_table(name, SECTION.header, "add it, with a `connector`");
    };
    let reader = Reader::open(root.log(), value, &SECTION, &quoted(name))?;
    let position = reader.vector(&BASE_POSITION);
    let direction = reader.vector(&BASE_DIRECTION);
    let up = reader.vector(&BASE_UP);
    let connector = match reader.value(CONNECTOR.name) {
        Some(value) => {
            let parts = Reader::open(reader.log(), value, &connector::SECTION, &quoted(CONNECTOR.name));
            parts.and_then(|it| both(it.quantity(&connector::LENGTH), it.quantity(&connector::MASS)))
        }
        None => reader.missing(CONNECTOR.name, ""),
    };
    let end_effector = match reader.value(END_EFFECTOR.name) {
        Some(value) => Reader::open(reader.log(), value, &end_effector::SECTION, &quoted(END_EFFECTOR.name))
            .and_then(|reader| tool(&reader))
            .map(Some),
        None => Some(None),
    };
    let (base_direction, base_up) = frame(&reader, direction??, up??)?;
    let (length, mass) = connector?;
    Some(Limb {
        base_position_m: *position??,
        base_direction,
        base_up,
        connector_length_m: *length,
        connector_mass_kg: *mass,
        end_effector: end_effector?,
    })
}

fn tool(reader: &Reader<'_>) -> Option<EndEffector> {
    use end_effector::{GRIPPER_TIME, LENGTH, MASS, NAME, RADIUS};
    let name = reader.text(&NAME);
    let (radius, gripper_time) = (reader.quantity(&RADIUS), reader.quantity(&GRIPPER_TIME));
    let (length, mass) = both(reader.quantity(&LENGTH), reader.quantity(&MASS))?;
    Some(EndEffector {
        name: name?.value.to_owned(),
        length_m: *length,
        radius_m: *radius?,
        mass_kg: *mass,
        gripper_time_s: *gripper_time?,
    })
}

fn both<T>(a: Option<T>, b: Option<T>) -> Option<(T, T)> {
    a.zip(b)
}

/// The two unit vectors of the base, `up` made normal to `direction`.
fn frame(reader: &Reader<'_>, direction: Located<[f64; 3]>, up: Located<[f64; 3]>) -> Option<([f64; 3], [f64; 3])> {
    // Below this share of its length the part of `up` normal to `direction` is rounding.
    const NORMAL_MIN: f64 = 1e-6;
    let Some(axis) = unit(*direction) else {
        return reader.log().note(Problem::at(
            direction.span,
            "`base_direction` has no direction",
            "its length is zero",
        ));
    };
    let Some(up_unit) = unit(*up) else {
        return reader.log().note(Problem::at(up.span, "`base_up` has no direction", "its length is zero"));
    };
    let along = dot(axis, up_unit);
    let normal: [f64; 3] = std::array::from_fn(|i| up_unit[i] - along * axis[i]);
    let normal = if dot(normal, normal).sqrt() > NORMAL_MIN { unit(normal) } else { None };
    if let Some(normal) = normal {
        return Some((axis, normal));
    }
    let problem = Problem::at(up.span, "`base_up` is parallel to `base_direction`", "no part is normal to the limb");
    let (up_default, axis_default) = (up.span == reader.span(), direction.span == reader.span());
    reader.log().note(match (up_default, axis_default) {
        (false, false) => problem.label(direction.span, "the limb starts in this direction"),
        (true, _) => problem.help("the default of `base_up` is [0, 0, 1]; write another"),
        (_, true) => problem.help("the default of `base_direction` is [1, 0, 0]; write another"),
    })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The vector scaled to length one. It is scaled by its largest component first, so that no square under- or overflows.
pub(super) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest < f64::MIN_POSITIVE {
        return None;
    }
    let scaled = vector.map(|x| x / largest);
    let length = dot(scaled, scaled).sqrt();
    Some(scaled.map(|x| x / length))
}
