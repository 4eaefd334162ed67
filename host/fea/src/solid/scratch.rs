//! A scratch folder that goes away.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::Path;
use std::time::Duration;

use softlimb_files::FileError;
use tempfile::TempDir;

use super::FemError;

/// Prefix of the names of scratch folders.
const PREFIX: &str = "softlimb-fem-";
/// The file in a scratch folder that its owner and the program that works in it hold locked.
const LOCK: &str = "lock";
/// A folder so much younger than a new one may belong to a process that has not locked it yet.
const YOUNG: Duration = Duration::from_secs(60);

/// A new folder among the system's temporary ones; removed with everything in it when this value goes.
#[derive(Debug)]
pub(crate) struct Scratch {
    folder: TempDir,
    lock: File,
}

impl Scratch {
    /// Makes one, and removes those that processes left behind which ended without doing so.
    pub(crate) fn new() -> Result<Self, FemError> {
        let parent = std::env::temp_dir();
        let folder = TempDir::with_prefix_in(PREFIX, &parent).map_err(FileError::at("create a folder in", &parent))?;
        let path = folder.path().join(LOCK);
        let mut how = OpenOptions::new();
        let lock = how.read(true).write(true).create_new(true).open(&path).map_err(FileError::at("create", &path))?;
        // Where files cannot be locked nothing is ever removed.
        let _ = lock.lock();
        let scratch = Self { folder, lock };
        scratch.sweep(&parent);
        Ok(scratch)
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The lock once more, for whoever works in the folder: it is free when nobody has it open any longer.
    pub(crate) fn lock(&self) -> io::Result<File> {
        self.lock.try_clone()
    }

    /// Removes the folders that nobody holds. What cannot be looked at or removed, such as other users', stays.
    fn sweep(&self, parent: &Path) {
        let Ok(now) = self.lock.metadata().and_then(|lock| lock.modified()) else { return };
        let is_old = |lock: &File| {
            let begun = lock.metadata().and_then(|lock| lock.modified());
            begun.is_ok_and(|begun| now.duration_since(begun).is_ok_and(|age| age > YOUNG))
        };
        for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
            let is_scratch = entry.file_name().to_string_lossy().starts_with(PREFIX);
            if !is_scratch || !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                continue;
            }
            let left = File::open(entry.path().join(LOCK));
            if left.is_ok_and(|lock| is_old(&lock) && lock.try_lock().is_ok()) {
                let _ = fs::remove_dir_all(entry.path());
            }
        }
    }
}
