//! Options of commands whose table is printed, kept in a file, drawn, and put into a page of the documentation.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;
use softlimb::cli::{Failure, read, say, write};

use crate::generated_section::{has_place, replaced};

/// Destinations of a table.
#[derive(Args)]
pub(crate) struct Published {
    /// Print the table as JSON
    #[arg(long)]
    json: bool,
    /// Write the table as tab-separated values
    #[arg(long, value_name = "FILE")]
    pub(crate) tsv: Option<PathBuf>,
    /// Write the picture
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Replace the table in the page of the documentation that has a place for it
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// A page with the two lines between which its table is.
pub(crate) struct Page<'a> {
    file: &'a Path,
    place: [&'a str; 2],
    text: String,
}

impl Published {
    /// The page, read before the work begins; it must have the place.
    pub(crate) fn page<'a>(&'a self, place: [&'a str; 2]) -> Result<Option<Page<'a>>, Failure> {
        let Some(file) = self.page.as_deref() else { return Ok(None) };
        let text = read(file)?;
        if has_place(&text, place) {
            return Ok(Some(Page { file, place, text }));
        }
        let ([begin, end], file) = (place, file.display());
        Err(Failure::new(format!("{file} has no place for the tables: a line `{begin}` and one `{end}`")))
    }

    /// Prints JSON or text.
    pub(crate) fn show<T: Serialize>(
        &self,
        json: impl FnOnce() -> T,
        table: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        if self.json { say(&serde_json::to_string(&json()).map_err(Failure::new)?) } else { say(&table()) }
    }

    /// Writes the tab-separated values, if requested.
    pub(crate) fn keep(&self, tsv: impl FnOnce() -> String) -> Result<(), Failure> {
        self.tsv.as_deref().map_or(Ok(()), |file| write(file, &tsv()))
    }

    /// Writes the picture, if requested.
    pub(crate) fn draw(&self, picture: impl FnOnce() -> String) -> Result<(), Failure> {
        self.svg.as_deref().map_or(Ok(()), |file| write(file, &picture()))
    }
}

impl Page<'_> {
    /// Replaces the generated section.
    pub(crate) fn write(&self, section: &str) -> Result<(), Failure> {
        replaced(&self.text, self.place, section).map_or(Ok(()), |text| write(self.file, &text))
    }
}
