//! Files that are there whole or not at all, and a folder that goes away.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use super::FemError;
use super::error::at;

/// Makes a folder and those it lies in.
///
/// # Errors
/// [`FemError::File`].
pub fn make_folder(folder: &Path) -> Result<(), FemError> {
    fs::create_dir_all(folder).map_err(at("create", folder))
}

/// Writes a file under a temporary name next to its place, and moves it there when all of it is on the disk. A link stays one: the file it
/// leads to is replaced. What is there and is no file, such as a pipe or a terminal, gets the content as it is.
///
/// # Errors
/// [`FemError::File`]; an earlier file of the name is then untouched.
pub fn write_whole(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), FemError> {
    place(path).and_then(|place| replace(&place, content.as_ref())).map_err(at("write", path))
}

/// Where a text goes.
enum Place {
    /// A file, there or not yet, or a folder, which is refused when it is to be replaced.
    File(PathBuf),
    /// Anything else.
    Stream(PathBuf),
}

fn place(path: &Path) -> io::Result<Place> {
    // Names of what is open already: the file behind one may have a name, but is not to be replaced by another.
    let open = path.starts_with("/dev") || path.starts_with("/proc");
    match fs::metadata(path) {
        Ok(found) if open || !(found.is_file() || found.is_dir()) => Ok(Place::Stream(path.to_owned())),
        Ok(_) => path.canonicalize().map(Place::File),
        Err(error) if error.kind() == io::ErrorKind::NotFound => match fs::read_link(path) {
            // A link to a file that is not there yet.
            Ok(target) => place(&path.parent().unwrap_or(Path::new("")).join(target)),
            Err(_) => Ok(Place::File(path.to_owned())),
        },
        Err(error) => Err(error),
    }
}

fn replace(place: &Place, content: &[u8]) -> io::Result<()> {
    let path = match place {
        Place::File(path) => path,
        Place::Stream(path) => return OpenOptions::new().append(true).open(path)?.write_all(content),
    };
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", process::id()));
    let part = path.with_file_name(name);
    let written = File::create(&part).and_then(|mut file| {
        file.write_all(content)?;
        file.sync_all()
    });
    let done = written.and_then(|()| fs::rename(&part, path));
    if done.is_err() {
        // There may be nothing to remove.
        let _ = fs::remove_file(&part);
    }
    done
}

/// What all scratch folders begin with.
const PREFIX: &str = "softlimb-fem-";
/// The file in a scratch folder that its owner and the program that works in it hold locked.
const LOCK: &str = "lock";
/// A folder so much younger than a new one may belong to a process that has not locked it yet.
const YOUNG: Duration = Duration::from_secs(60);

/// A new folder among the system's temporary ones; removed with everything in it when this value goes.
#[derive(Debug)]
pub(crate) struct Scratch {
    folder: PathBuf,
    lock: File,
}

impl Scratch {
    /// Makes one, and removes those that processes left behind which ended without doing so.
    pub(crate) fn new() -> Result<Self, FemError> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let parent = std::env::temp_dir();
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let folder = parent.join(format!("{PREFIX}{}-{count}", process::id()));
            match fs::create_dir(&folder) {
                Ok(()) => {
                    let path = folder.join(LOCK);
                    let mut how = OpenOptions::new();
                    let lock = how.read(true).write(true).create_new(true).open(&path).map_err(at("create", &path))?;
                    // Where files cannot be locked nothing is ever removed.
                    let _ = lock.lock();
                    let scratch = Self { folder, lock };
                    scratch.sweep(&parent);
                    return Ok(scratch);
                }
                // Left over from a process of the same number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(at("create", &folder)(error)),
            }
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.folder
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

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed is left to the next run, or to the system's own cleaning.
        let _ = fs::remove_dir_all(&self.folder);
    }
}
