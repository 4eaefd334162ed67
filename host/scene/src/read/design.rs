//! Bounds of a design.

use fra_model::Motion;
use toml::de::DeValue;

use super::module::{Draft, MOTIONS};
use super::phase::region_named;
use crate::collision::Shape;
use crate::data::{Choice, Design, ModuleBounds, Region};
use crate::error::{Problem, quoted};
use crate::reader::Reader;
use crate::schema;
use crate::schema::{Pair, bounds, design as keys, segment_bounds as of_segment};
use crate::source::Located;
use crate::value::wrong_type;

/// The `[design]` of a scene; the inner `None` where it has none.
pub(super) fn design(root: &Reader<'_>, drafts: &[Draft<'_>], regions: Option<&[Region]>) -> Option<Option<Design>> {
    let Some(value) = root.value(schema::scene::DESIGN.name) else { return Some(None) };
    let reader = Reader::open(root.log(), value, &keys::SECTION, &quoted(schema::scene::DESIGN.name))?;
    let common = pairs(
        &reader,
        [keys::INNER_RADIUS, keys::WALL, keys::LENGTH, keys::FIBER_ANGLE, keys::CIRCLE_RADIUS, keys::SPACING],
    );
    let (bay, base_pitch) = (reader.quantity(&keys::BAY), reader.pair(&keys::BASE_PITCH));
    let base_region = base_region(&reader, regions);
    let limit_margin = reader.quantity(&keys::LIMIT_MARGIN);
    let shared_supply_line = reader.flag(&keys::SHARED_SUPPLY_LINE);
    let pressure_reserve = reader.quantity(&keys::PRESSURE_RESERVE);
    let mass_max = reader.maybe(&keys::MASS_MAX);
    let mount_angle_free = reader.choice(&keys::MOUNT_ANGLE, &[false, true]);
    let choice = choice(&reader);
    let common = common?;
    Some(Some(Design {
        common,
        modules: drafts.iter().map(|draft| draft.bounds.or(&common)).collect(),
        mass_max_kg: mass_max?,
        bay_m: *bay?,
        base_pitch_rad: base_pitch?,
        base_region: base_region?,
        limit_margin: *limit_margin?,
        shared_supply_line: shared_supply_line?,
        pressure_reserve: *pressure_reserve?,
        mount_angle_free: *mount_angle_free?,
        choice: choice?,
    }))
}

/// The bounds of one module, from the table inside its own.
pub(super) fn module_bounds(module: &Reader<'_>) -> Option<ModuleBounds> {
    let name = schema::module::BOUNDS.name;
    let Some(value) = module.value(name) else { return Some(ModuleBounds::default()) };
    let reader = Reader::open(module.log(), value, &bounds::SECTION, &quoted(name))?;
    use bounds::{CIRCLE_RADIUS, FIBER_ANGLE, INNER_RADIUS, LENGTH, SPACING, WALL};
    if module.key_span(schema::module::SEGMENTS.name).is_some() {
        let own = [LENGTH.name, FIBER_ANGLE.name];
        let each = reader
            .forbid(&own, "for a module with `segments`, each of which has its own in `[module.segments.bounds]`");
        reader.forbid(&[CIRCLE_RADIUS.name, SPACING.name], "for a module with `segments`, which has one actuator")?;
        each?;
    }
    pairs(&reader, [INNER_RADIUS, WALL, LENGTH, FIBER_ANGLE, CIRCLE_RADIUS, SPACING])
}

/// The bounds of one segment, from the table inside its own.
pub(super) fn segment_bounds(segment: &Reader<'_>, motion: Option<Located<Motion>>) -> Option<ModuleBounds> {
    let name = schema::segment::BOUNDS.name;
    let Some(value) = segment.value(name) else { return Some(ModuleBounds::default()) };
    let reader = Reader::open(segment.log(), value, &of_segment::SECTION, &quoted(name))?;
    let (length, angle) = (reader.pair(&of_segment::LENGTH), reader.pair(&of_segment::FIBER_ANGLE));
    if motion.is_some_and(|motion| *motion == Motion::Bending) {
        reader.forbid(&[of_segment::FIBER_ANGLE.name], "in a bending segment, which keeps the angle of its winding")?;
    }
    Some(ModuleBounds { length_m: length?, fiber_angle_rad: angle?, ..ModuleBounds::default() })
}

fn pairs(reader: &Reader<'_>, keys: [Pair; 6]) -> Option<ModuleBounds> {
    let [inner, wall, length, angle, circle, spacing] = keys.map(|key| reader.pair(&key));
    Some(ModuleBounds {
        inner_radius_m: inner?,
        wall_m: wall?,
        length_m: length?,
        fiber_angle_rad: angle?,
        circle_radius_m: circle?,
        spacing_m: spacing?,
    })
}

/// The box that the base may be in.
fn base_region(reader: &Reader<'_>, regions: Option<&[Region]>) -> Option<Option<Located<usize>>> {
    let Some(name) = reader.maybe_text(&keys::BASE_REGION)? else { return Some(None) };
    let regions = regions?;
    let found = region_named(reader, name, regions)?;
    if let Shape::Box { rotation, .. } = &regions[found.value].shape
        && rotation.angle() > 1e-9
    {
        let title = "the base needs a region without `rotation`";
        let label = "this box is turned".to_owned();
        return reader.log().note(Problem::at(found.span, title, label));
    }
    Some(Some(found))
}

fn choice(reader: &Reader<'_>) -> Option<Option<Located<Choice>>> {
    let Some(modules) = reader.pair(&keys::MODULES)? else {
        reader.forbid(&[keys::MOTIONS.name], "without `modules`")?;
        return Some(None);
    };
    let [least, most] = *modules;
    if least.fract() != 0.0 || most.fract() != 0.0 {
        let title = format!("`{}` needs whole numbers", keys::MODULES.name);
        return reader.log().note(Problem::at(modules.span, title, "not whole"));
    }
    let motions = motions(reader)?;
    Some(Some(modules.map(|_| Choice { modules_min: least as usize, modules_max: most as usize, motions })))
}

fn motions(reader: &Reader<'_>) -> Option<Vec<Motion>> {
    let name = keys::MOTIONS.name;
    let Some(value) = reader.value(name) else { return Some(MOTIONS.to_vec()) };
    let DeValue::Array(items) = value.get_ref() else {
        return reader.log().note(wrong_type(
            value.span().into(),
            &quoted(name),
            "an array of motions",
            value.get_ref(),
        ));
    };
    let words = schema::module::MOTION.words;
    let mut motions = Vec::new();
    for item in items.iter() {
        let span = item.span().into();
        let word = item.get_ref().as_str().unwrap_or("");
        let Some((_, motion)) = words.iter().zip(MOTIONS).find(|(known, _)| **known == word) else {
            let help = format!("choose from `{}`", words.join("`, `"));
            return reader.log().note(Problem::at(span, "this is no motion", "unknown").help(help));
        };
        if motions.contains(&motion) {
            return reader.log().note(Problem::at(span, format!("{} is there twice", quoted(word)), "again here"));
        }
        motions.push(motion);
    }
    if motions.is_empty() {
        return reader.log().note(Problem::at(value.span().into(), "there is no motion to choose from", "empty"));
    }
    Some(motions)
}
