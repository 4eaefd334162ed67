//! Table of a sweep. Each row is appended to a file when its run ends; the finished table is sorted.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::iter;
use std::path::{Path, PathBuf};

use softlimb_files::table::written;
use softlimb_files::{FileError, write_whole};
use softlimb_scene::Study;

use super::{Row, Shard, headings};

/// Extension of the file of an unfinished sweep.
const UNFINISHED: &str = "part";

/// Error of a table.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The operating system refused.
    #[error("cannot {what} {}: {cause}", path.display())]
    File {
        /// The verb.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// The cause.
        cause: std::io::Error,
    },
    /// The file belongs to another study, other scenes or another version of softlimb.
    #[error(
        "{} is not a table of this study, its scenes and this version of softlimb: remove it, or give another --out",
        .0.display()
    )]
    Other(PathBuf),
    /// A line is not a row of the study or of the shard.
    #[error("{}:{line}: this is not a row of {what}", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// The study or the shard.
        what: &'static str,
    },
    /// Two tables have different rows of one index.
    #[error("{} has another row {row} than the tables before it", path.display())]
    Contradiction {
        /// The later file.
        path: PathBuf,
        /// The index of the row.
        row: u64,
    },
    /// Rows are missing.
    #[error("{missing} of {all} rows are missing, the first is row {first}: run the other shards, then merge again")]
    Gaps {
        /// Number of missing rows.
        missing: u64,
        /// Number of rows of the study.
        all: u64,
        /// Index of the first missing row.
        first: u64,
    },
    /// The table cannot be written.
    #[error(transparent)]
    NotWritten(#[from] FileError),
}

/// The rows of a study or of a shard of it, in a file.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    head: String,
    all: u64,
    shard: Shard,
    /// Number of consecutive rows that belong to one shard: the limbs of a design, which is planned once, if there are enough designs.
    together: u64,
    rows: BTreeMap<u64, String>,
    file: Option<File>,
}

impl Table {
    /// Opens the table of a sweep, and reads the rows of an interrupted or a complete one.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn open(study: &Study, shard: Shard, path: &Path) -> Result<Self, SweepError> {
        let mut table = Self::new(study, shard, path);
        let part = table.part();
        if path.exists() {
            table.take(path, false)?;
            if table.missing().next().is_some() {
                return Err(SweepError::Other(path.to_owned()));
            }
            // A sweep that is killed after it wrote the table leaves the other file too.
            if part.exists() && table.take(&part, true).is_ok() {
                table.remove_part()?;
            }
            return Ok(table);
        }
        if part.exists() {
            table.take(&part, true)?;
        }
        // The file may end within a line, which must not be continued.
        let file = |cause| SweepError::File { what: "write", path: part.clone(), cause };
        write_whole(&part, &table.text())?;
        table.file = Some(OpenOptions::new().append(true).open(&part).map_err(file)?);
        Ok(table)
    }

    /// Joins tables of shards.
    ///
    /// # Errors
    /// [`SweepError`]; above all contradicting or missing rows.
    pub fn merged(study: &Study, tables: &[PathBuf], path: &Path) -> Result<Self, SweepError> {
        let mut table = Self::new(study, Shard::WHOLE, path);
        tables.iter().try_for_each(|found| table.take(found, false))?;
        let first = table.missing().next();
        first.map_or(Ok(table.rows.len()), |first| {
            let missing = table.all - table.rows.len() as u64;
            Err(SweepError::Gaps { missing, all: table.all, first })
        })?;
        Ok(table)
    }

    fn new(study: &Study, shard: Shard, path: &Path) -> Self {
        let (version, hash, all) = (env!("CARGO_PKG_VERSION"), study.hash(), study.rows());
        let head = format!("# softlimb {version} sweep, study {hash:016x}, {all} rows\n{}\n", line(&headings(study)));
        let together = if study.designs() >= shard.count { u64::from(study.limbs()) } else { 1 };
        Self { path: path.to_owned(), head, all, shard, together, rows: BTreeMap::new(), file: None }
    }

    /// File of the unfinished sweep.
    pub fn part(&self) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        name.push(".");
        name.push(UNFINISHED);
        name.into()
    }

    /// Indices of the missing rows, in rising order.
    pub fn missing(&self) -> impl Iterator<Item = u64> {
        let groups = (self.shard.index - 1..self.all / self.together).step_by(self.shard.count as usize);
        let rows = groups.flat_map(|group| group * self.together..(group + 1) * self.together);
        rows.filter(|row| !self.rows.contains_key(row))
    }

    /// Numbers of finished rows and of all rows of the shard.
    pub fn progress(&self) -> [u64; 2] {
        let groups = (self.all / self.together).saturating_sub(self.shard.index - 1).div_ceil(self.shard.count);
        [self.rows.len() as u64, groups * self.together]
    }

    /// Adds a row, and appends it to the file.
    ///
    /// # Errors
    /// [`SweepError::File`].
    pub fn add(&mut self, row: Row) -> Result<(), SweepError> {
        if let Some(file) = &mut self.file {
            let written = file.write_all(format!("{}\n", row.line).as_bytes());
            written.map_err(|cause| SweepError::File { what: "write", path: self.part(), cause })?;
        }
        self.rows.insert(row.index, row.line);
        Ok(())
    }

    /// Writes the sorted table, and removes the file of the unfinished sweep.
    ///
    /// # Errors
    /// [`SweepError`].
    pub fn finish(mut self) -> Result<(), SweepError> {
        write_whole(&self.path, &self.text())?;
        if self.file.take().is_some() { self.remove_part() } else { Ok(()) }
    }

    fn remove_part(&self) -> Result<(), SweepError> {
        let part = self.part();
        fs::remove_file(&part).map_err(|cause| SweepError::File { what: "remove", path: part, cause })
    }

    /// Number of rows without figures of merit.
    pub fn without_result(&self) -> usize {
        self.rows.values().filter(|line| !line.ends_with(",ok")).count()
    }

    fn text(&self) -> String {
        let mut text = self.head.clone();
        for line in self.rows.values() {
            text.push_str(line);
            text.push('\n');
        }
        text
    }

    /// Reads the rows of a file. If `may_be_cut_off`, an unfinished last line is dropped.
    fn take(&mut self, path: &Path, may_be_cut_off: bool) -> Result<(), SweepError> {
        let text = fs::read_to_string(path).map_err(|cause| match cause.kind() {
            ErrorKind::InvalidData => SweepError::Other(path.to_owned()),
            _ => SweepError::File { what: "read", path: path.to_owned(), cause },
        })?;
        let Some(rows) = text.strip_prefix(&self.head) else { return Err(SweepError::Other(path.to_owned())) };
        for (number, line) in rows.split_inclusive('\n').enumerate() {
            let row = |what| SweepError::Row { path: path.to_owned(), line: number + 3, what };
            let Some(line) = line.strip_suffix('\n') else {
                if may_be_cut_off {
                    break;
                }
                return Err(row("this study"));
            };
            let index = line.split(',').next().and_then(|index| index.parse::<u64>().ok());
            let index = index.filter(|index| *index < self.all).ok_or_else(|| row("this study"))?;
            if !self.shard.has(index / self.together) {
                return Err(row("this shard"));
            }
            if self.rows.get(&index).is_some_and(|before| before != line) {
                return Err(SweepError::Contradiction { path: path.to_owned(), row: index });
            }
            self.rows.insert(index, line.to_owned());
        }
        Ok(())
    }
}

/// One line of CSV, without a line break.
pub(super) fn line(cells: &[String]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace(['\n', '\r'], " ")).collect();
    let cells: Vec<&str> = cells.iter().map(String::as_str).collect();
    written(&cells, iter::empty::<[&str; 0]>()).trim_end_matches('\n').to_owned()
}
