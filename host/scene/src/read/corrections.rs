//! Corrections of the planned setpoints, in a CSV file.

use super::module::Draft;
use super::series::{Columns, series};
use crate::data::Corrections;
use crate::error::quoted;
use crate::reader::Reader;
use crate::schema;
use crate::schema::corrections as keys;
use crate::source::Located;

/// The corrections of a scene that has `[corrections]`, located at the name of their file; the inner `None` where it has none.
///
/// `scene_name` is the scene's path, in whose folder the file is looked for.
pub(super) fn corrections(
    root: &Reader<'_>,
    scene_name: &str,
    drafts: &[Draft<'_>],
) -> Option<Option<Located<Corrections>>> {
    let Some(value) = root.value(schema::scene::CORRECTIONS.name) else { return Some(None) };
    let reader = Reader::open(root.log(), value, &keys::SECTION, &quoted(schema::scene::CORRECTIONS.name))?;
    let modules: Vec<_> = drafts.iter().map(|draft| draft.module.as_ref()).collect::<Option<_>>()?;
    let names = modules.iter().map(|module| module.name.value.as_str()).collect();
    let counts = modules.iter().map(|module| usize::from(module.actuators)).collect();
    // Each is compared with the range of its module by who knows that.
    let columns = Columns { what: "corrections", names, counts, max: f64::MAX, unit: "" };
    let rows = series(&reader, &keys::FILE, scene_name, &columns)?;
    Some(Some(rows.map(|rows| {
        let (times_s, rows) = rows.into_iter().unzip();
        Corrections { times_s, rows }
    })))
}
