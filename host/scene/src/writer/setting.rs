//! Setting one value of a scene.

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::draft::put;

/// Sets the value at a place: names of tables, then a key. The tables of an array are named by their key `name`. The error is the index of the
/// first name without a table.
pub(crate) fn set(document: &mut DocumentMut, place: &[String], value: &Value) -> Result<(), usize> {
    let Some((key, tables)) = place.split_last() else { return Err(0) };
    let mut table: &mut dyn TableLike = document.as_table_mut();
    let mut names = tables.iter().enumerate();
    while let Some((depth, name)) = names.next() {
        if !table.contains_key(name) {
            // The table has defaults only. The reader refuses a wrong name.
            table.insert(name, Item::Table(Table::new()));
        }
        let entry = table.get_mut(name).ok_or(depth)?;
        table = if entry.is_array_of_tables() {
            let (_, wanted) = names.next().ok_or(depth + 1)?;
            let mut members = entry.as_array_of_tables_mut().ok_or(depth)?.iter_mut();
            let is_wanted = |member: &&mut Table| member.get("name").and_then(Item::as_str) == Some(wanted.as_str());
            members.find(is_wanted).ok_or(depth + 1)?
        } else {
            entry.as_table_like_mut().ok_or(depth)?
        };
    }
    match table.get(key) {
        Some(found) if !found.is_value() => Err(tables.len()),
        _ => {
            put(table, key, value.clone());
            Ok(())
        }
    }
}
