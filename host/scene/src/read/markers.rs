//! A motion as a series of tip positions in a CSV file.

use super::series::{Columns, TIME, series};
use crate::data::Marker;
use crate::error::quoted;
use crate::reader::Reader;
use crate::schema;
use crate::schema::markers as keys;
use crate::source::Located;

/// Farthest position, m, as in a scene.
const FAR_M: f64 = 100.0;

/// The series of a scene that has `[markers]`, located at the name of its file, with times from the first row on; the inner `None` where it has
/// none.
///
/// `scene_name` is the scene's path, in whose folder the file is looked for.
pub(super) fn markers(root: &Reader<'_>, scene_name: &str) -> Option<Option<Located<Vec<Marker>>>> {
    let Some(value) = root.value(schema::scene::MARKERS.name) else { return Some(None) };
    let reader = Reader::open(root.log(), value, &keys::SECTION, &quoted(schema::scene::MARKERS.name))?;
    let names = vec!["x_m", "y_m", "z_m"];
    let (lead, then, counts) = (&[TIME][..], Vec::new(), vec![1; 3]);
    let columns = Columns { what: "markers", lead, names, then, counts, max: FAR_M, unit: " m" };
    let rows = series(&reader, &keys::FILE, scene_name, &columns)?;
    let first_s = rows.value.first().map_or(0.0, |(time_s, _)| *time_s);
    Some(Some(rows.map(|rows| {
        let marker = |(time_s, tip_m): &(f64, Vec<f64>)| {
            Some(Marker { time_s: time_s - first_s, tip_m: tip_m.as_slice().try_into().ok()? })
        };
        rows.iter().filter_map(marker).collect()
    })))
}
