//! Obstacles and regions.

use nalgebra::UnitQuaternion;

use super::module::note_duplicate;
use crate::collision::Shape;
use crate::data::{Object, Obstacle, Region};
use crate::error::Problem;
use crate::reader::Reader;
use crate::schema;
use crate::schema::{Unit, Vector, object, obstacle as keys, region};
use crate::source::{Located, Span};

/// Most obstacles, and most regions, of a scene.
const MOST: usize = 50;
/// Smallest edge of a box, m.
const EDGE_MIN_M: f64 = 1e-4;

pub(super) fn obstacles(root: &Reader<'_>) -> Option<Vec<Obstacle>> {
    let readers = root.maybe_tables(&schema::scene::OBSTACLE, &keys::SECTION, MOST)?;
    named(
        &readers,
        "obstacle",
        |reader| reader.text(&keys::NAME),
        shape,
        |name, shape, span| Obstacle { name, shape, span },
    )
}

pub(super) fn regions(root: &Reader<'_>) -> Option<Vec<Region>> {
    let readers = root.maybe_tables(&schema::scene::REGION, &region::SECTION, MOST)?;
    let shape = |reader: &Reader<'_>| cuboid(reader, &region::CENTER, &region::SIZE, &region::ROTATION);
    named(
        &readers,
        "region",
        |reader| reader.text(&region::NAME),
        shape,
        |name, shape, span| Region { name, shape, span },
    )
}

/// Things that the tip may carry.
pub(super) fn objects(root: &Reader<'_>) -> Option<Vec<Object>> {
    let readers = root.maybe_tables(&schema::scene::OBJECT, &object::SECTION, MOST)?;
    let mut names: Vec<Located<&str>> = Vec::new();
    let mut all = Vec::new();
    for reader in &readers {
        let name = reader.text(&object::NAME);
        note_duplicate(reader, "object", name, names.iter().copied());
        names.extend(name);
        all.push(name.and_then(|name| object(reader, name.map(str::to_owned))));
    }
    all.into_iter().collect()
}

fn object(reader: &Reader<'_>, name: Located<String>) -> Option<Object> {
    let [radius, height, grasp, mass, tilt_max] =
        [object::RADIUS, object::HEIGHT, object::GRASP, object::MASS, object::TILT_MAX]
            .map(|key| reader.quantity(&key));
    let (radius, height, grasp) = (radius?, height?, grasp?);
    if *grasp > *height {
        let title = "an object is grasped within its height";
        let label = format!("it is {} high", Unit::MM.show_si(*height));
        return reader.log().note(Problem::at(grasp.span, title, label));
    }
    Some(Object {
        name,
        radius_m: *radius,
        height_m: *height,
        grasp_m: *grasp,
        mass_kg: *mass?,
        tilt_max_rad: *tilt_max?,
        span: reader.span(),
    })
}

fn named<'a, T>(
    readers: &[Reader<'a>],
    kind: &str,
    name: impl Fn(&Reader<'a>) -> Option<Located<&'a str>>,
    shape: impl Fn(&Reader<'a>) -> Option<Shape>,
    make: impl Fn(Located<String>, Shape, Span) -> T,
) -> Option<Vec<T>> {
    let mut names: Vec<Located<&str>> = Vec::new();
    let mut all = Vec::new();
    for reader in readers {
        let (name, shape) = (name(reader), shape(reader));
        note_duplicate(reader, kind, name, names.iter().copied());
        names.extend(name);
        all.push(name.zip(shape).map(|(name, shape)| make(name.map(str::to_owned), shape, reader.span())));
    }
    all.into_iter().collect()
}

fn shape(reader: &Reader<'_>) -> Option<Shape> {
    use keys::{CENTER, FROM, RADIUS, ROTATION, SHAPE, SIZE, TO};
    let kind = reader.choice(&SHAPE, &[0, 1, 2])?;
    match *kind {
        0 => {
            reader.forbid(&[FROM.name, TO.name, SIZE.name, ROTATION.name], "for a `sphere`")?;
            let (center, radius) = (needed(reader, &CENTER), radius(reader));
            made(reader, Shape::sphere(*center?, radius?))
        }
        1 => {
            reader.forbid(&[CENTER.name, SIZE.name, ROTATION.name], "for a `capsule`")?;
            let (from, to, radius) = (needed(reader, &FROM), needed(reader, &TO), radius(reader));
            made(reader, Shape::capsule(*from?, *to?, radius?))
        }
        _ => {
            reader.forbid(&[FROM.name, TO.name, RADIUS.name], "for a `box`")?;
            cuboid(reader, &CENTER, &SIZE, &ROTATION)
        }
    }
}

fn radius(reader: &Reader<'_>) -> Option<f64> {
    match reader.maybe(&keys::RADIUS)? {
        Some(radius) => Some(*radius),
        None => reader.missing(keys::RADIUS.name, " for this shape"),
    }
}

fn needed(reader: &Reader<'_>, key: &Vector) -> Option<Located<[f64; 3]>> {
    reader.vector(key)?.or_else(|| reader.missing(key.name, " for this shape"))
}

fn cuboid(reader: &Reader<'_>, center: &Vector, size: &Vector, rotation: &Vector) -> Option<Shape> {
    let (center, size, turn) = (needed(reader, center), needed(reader, size), reader.vector(rotation));
    let size = size?;
    if let Some(short) = size.value.into_iter().find(|edge| *edge < EDGE_MIN_M) {
        let title = format!("every edge of a box must be at least {}", Unit::MM.show_si(EDGE_MIN_M));
        let label = format!("one is {}", Unit::MM.show_si(short));
        return reader.log().note(Problem::at(size.span, title, label));
    }
    let [x, y, z] = *turn??;
    made(reader, Shape::cuboid(*center?, size.value.map(|edge| 0.5 * edge), UnitQuaternion::from_euler_angles(x, y, z)))
}

/// The room of obstacles has the last word; it accepts what the schema lets through.
fn made(reader: &Reader<'_>, shape: Result<Shape, softlimb_files::range::OutOfRange>) -> Option<Shape> {
    shape.map_err(|error| reader.log().note::<()>(Problem::at(reader.span(), error.to_string(), "in this table"))).ok()
}
