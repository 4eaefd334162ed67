//! Options of commands whose table is printed, kept in a file, and drawn.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::{Failure, note, say};
use softlimb_files::write_whole;

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
}

impl Kept {
    /// Prints the one or the other.
    pub(super) fn show(&self, json: impl FnOnce() -> Value, table: impl FnOnce() -> String) -> Result<(), Failure> {
        if self.json { say(&json().to_string()) } else { say(&table()) }
    }

    /// Writes the picture where one is wanted.
    pub(super) fn draw(&self, picture: impl FnOnce() -> String) -> Result<(), Failure> {
        self.svg.as_deref().map_or(Ok(()), |file| write(file, &picture()))
    }
}

/// The text of a file.
///
/// # Errors
/// [`Failure`] that names the file.
pub fn read(file: &Path) -> Result<String, Failure> {
    fs::read_to_string(file).map_err(|error| Failure::file("read", file, &error))
}

/// Writes a file, whole or not at all, and says so.
///
/// # Errors
/// [`Failure`] that names the file.
pub fn write(file: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), Failure> {
    write_whole(file, content).map_err(Failure::new)?;
    note(&format!("wrote {}", file.display()));
    Ok(())
}
