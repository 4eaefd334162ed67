//! The text of a scene while its values change.

use toml_edit::{DocumentMut, Item, Key, Table, TableLike, Value, value};

use super::RewriteError;
use crate::data::Scene;
use crate::schema::{module, scene};

/// Parts that modules name and may share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Material,
    Winding,
    /// The second name in the array of windings.
    SecondWinding,
}

impl Part {
    /// The key of a module.
    pub(super) fn key(self) -> &'static str {
        match self {
            Self::Material => module::MATERIAL.name,
            Self::Winding | Self::SecondWinding => module::WINDING.name,
        }
    }

    /// The table of all parts of the kind.
    pub(super) fn tables(self) -> &'static str {
        match self {
            Self::Material => scene::MATERIALS.name,
            Self::Winding | Self::SecondWinding => scene::WINDINGS.name,
        }
    }

    /// Its index in an array of names.
    fn position(self) -> usize {
        usize::from(self == Self::SecondWinding)
    }
}

/// A module, or a segment of it: their indices.
pub(super) type Wound = (usize, Option<usize>);

/// A scene's text that changes value by value.
pub(super) struct Draft {
    pub(super) document: DocumentMut,
}

impl Draft {
    /// Text of a scene; `None` is for a text that this parser reads differently from the reader's.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        Some(Self { document: scene.source_text().parse().ok()? })
    }

    /// Text, and the scene that is read from it.
    pub(super) fn read(&self, name: &str) -> Result<(String, Scene), RewriteError> {
        let text = self.document.to_string();
        let read = crate::parse(&text, name).map_err(RewriteError::Refused)?;
        Ok((text, read))
    }

    pub(super) fn module(&mut self, index: usize) -> Option<&mut dyn TableLike> {
        self.document.get_mut(scene::MODULE.name)?.get_mut(index)?.as_table_like_mut()
    }

    /// The name that a module, or a segment of it, has for its part.
    pub(super) fn part_name(&self, (index, segment): Wound, part: Part) -> Option<&str> {
        let module = self.document.get(scene::MODULE.name)?.get(index)?;
        let names = segment.map_or(Some(module), |segment| module.get(module::SEGMENTS.name)?.get(segment))?;
        let names = names.get(part.key())?;
        match names.as_array() {
            Some(names) => names.get(part.position())?.as_str(),
            None => names.as_str().filter(|_| part.position() == 0),
        }
    }

    /// Gives a module's or a segment's part another name.
    pub(super) fn put_part_name(&mut self, (index, segment): Wound, part: Part, name: &str) -> Option<()> {
        let mut table = self.module(index)?;
        if let Some(segment) = segment {
            table = table.get_mut(module::SEGMENTS.name)?.get_mut(segment)?.as_table_like_mut()?;
        }
        match table.get_mut(part.key())?.as_array_mut() {
            Some(names) => {
                names.replace(part.position(), name);
            }
            None => put(table, part.key(), name.into()),
        }
        Some(())
    }

    pub(super) fn part(&mut self, part: Part, name: &str) -> Option<&mut dyn TableLike> {
        self.document.get_mut(part.tables())?.as_table_like_mut()?.get_mut(name)?.as_table_like_mut()
    }

    /// Adds a material under a name that is free; `None` where the materials are on one line.
    pub(super) fn add_material(&mut self, base: &str, keys: [(&str, Value); 2]) -> Option<String> {
        let mut empty = Table::new();
        empty.set_implicit(true);
        let parts = self.document.entry(Part::Material.tables()).or_insert(Item::Table(empty)).as_table_mut()?;
        let mut names = std::iter::once(base.to_owned()).chain((2..100).map(|count| format!("{base}-{count}")));
        let free = names.find(|name| !parts.contains_key(name))?;
        let mut table = Table::new();
        for (key, new) in keys {
            table.insert(key, value(new));
        }
        parts.insert(&free, Item::Table(table));
        Some(free)
    }

    /// Copies a part under the first of `names` that is free, without the comments, which are about the other one. `None` where the parts of
    /// the kind are on one line.
    pub(super) fn copy(&mut self, part: Part, name: &str, mut names: impl Iterator<Item = String>) -> Option<String> {
        let parts = self.document.get_mut(part.tables())?.as_table_mut()?;
        let source = parts.get(name)?.as_table_like()?;
        let free = names.find(|name| !parts.contains_key(name))?;
        let mut copy = Table::new();
        for (key, old) in source.iter() {
            copy.insert(key, old.as_value().map_or_else(|| old.clone(), |old| value(old.clone().decorated(" ", ""))));
        }
        parts.insert(&free, Item::Table(copy));
        Some(free)
    }
}

/// Sets a key. One that is there keeps its place and its comments.
pub(super) fn put(table: &mut dyn TableLike, key: &str, mut new: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => {
            table.insert(key, value(new));
        }
    }
}

/// Gives a key that is there another name.
pub(super) fn rename(table: &mut dyn TableLike, old: &str, new: &str) {
    let names: Vec<String> = table.iter().map(|(name, _)| name.to_owned()).collect();
    let entries: Vec<(Key, Item)> = names
        .iter()
        .filter_map(|name| table.get_key_value(name))
        .map(|(key, item)| (key.clone(), item.clone()))
        .collect();
    table.clear();
    for (key, item) in entries {
        let key = if key.get() == old { Key::new(new).with_leaf_decor(key.leaf_decor().clone()) } else { key };
        table.entry_format(&key).or_insert(item);
    }
}
