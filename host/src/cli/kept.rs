//! What commands share whose table is shown, kept in a file, drawn, and put into a page.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::{Failure, note, say};
use crate::fem::write_whole;
use crate::marked;

/// Where the table goes.
#[derive(Args)]
pub(super) struct Kept {
    /// Print the table as JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Write the table as tab-separated values
    #[arg(long, value_name = "FILE")]
    pub(super) tsv: Option<PathBuf>,
    /// Write the picture
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<PathBuf>,
    /// Replace the table in the page of the documentation that has a place for it
    #[arg(long, value_name = "FILE")]
    pub(super) page: Option<PathBuf>,
}

/// A page and the two lines between which its table is.
pub(super) struct Page<'a> {
    file: &'a Path,
    /// What it says now.
    pub(super) text: String,
}

impl Kept {
    /// The page, read before the work begins; it must have the place.
    pub(super) fn page(&self, place: [&str; 2]) -> Result<Option<Page<'_>>, Failure> {
        let Some(file) = self.page.as_deref() else { return Ok(None) };
        let text = read(file)?;
        if marked::has_place(&text, place) {
            return Ok(Some(Page { file, text }));
        }
        let [begin, end] = place;
        let file = file.display();
        Err(Failure::new(format!("{file} has no place for the tables: a line `{begin}` and one `{end}`")))
    }

    /// Prints the one or the other.
    pub(super) fn show(&self, json: impl FnOnce() -> Value, table: impl FnOnce() -> String) -> Result<(), Failure> {
        if self.json { say(&json().to_string()) } else { say(&table()) }
    }

    /// Writes the picture where one is wanted.
    pub(super) fn draw(&self, picture: impl FnOnce() -> String) -> Result<(), Failure> {
        self.svg.as_deref().map_or(Ok(()), |file| write(file, &picture()))
    }
}

impl Page<'_> {
    /// Writes the page anew.
    pub(super) fn write(&self, text: Option<String>) -> Result<(), Failure> {
        text.map_or(Ok(()), |text| write(self.file, &text))
    }
}

/// The text of a file.
pub(super) fn read(file: &Path) -> Result<String, Failure> {
    fs::read_to_string(file).map_err(|error| Failure::file("read", file, &error))
}

/// Writes a file, whole or not at all, and says so.
pub(super) fn write(file: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), Failure> {
    write_whole(file, content).map_err(Failure::new)?;
    note(&format!("wrote {}", file.display()));
    Ok(())
}
