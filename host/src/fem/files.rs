//! Files that are there whole or not at all, and a folder that goes away.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use super::FemError;
use super::error::at;

/// Makes a folder and those it lies in.
///
/// # Errors
/// [`FemError::File`].
pub fn make_folder(folder: &Path) -> Result<(), FemError> {
    fs::create_dir_all(folder).map_err(at("create", folder))
}

/// Writes a text under a temporary name next to its place, and moves it there when all of it is on the disk.
///
/// # Errors
/// [`FemError::File`]; an earlier file of the name is then untouched.
pub fn write_whole(path: &Path, text: &str) -> Result<(), FemError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", process::id()));
    let part = path.with_file_name(name);
    let written = fs::File::create(&part).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    let done = written.and_then(|()| fs::rename(&part, path));
    if done.is_err() {
        // There may be nothing to remove.
        let _ = fs::remove_file(&part);
    }
    done.map_err(at("write", path))
}

/// A new folder among the system's temporary ones; removed with everything in it when this value goes.
#[derive(Debug)]
pub(crate) struct Scratch {
    folder: PathBuf,
}

impl Scratch {
    pub(crate) fn new() -> Result<Self, FemError> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let parent = std::env::temp_dir();
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let folder = parent.join(format!("softlimb-fem-{}-{count}", process::id()));
            match fs::create_dir(&folder) {
                Ok(()) => return Ok(Self { folder }),
                // Left over from a process of the same number.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(at("create", &folder)(error)),
            }
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.folder
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed is left to the system's own cleaning.
        let _ = fs::remove_dir_all(&self.folder);
    }
}
