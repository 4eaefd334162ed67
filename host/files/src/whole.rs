//! Output files that are there whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An operation on a file that failed.
#[derive(Debug, thiserror::Error)]
#[error("cannot {doing} {}: {}", path.display(), explained(doing, source))]
pub struct FileError {
    /// `read`, `write`, `create the folder`.
    pub doing: &'static str,
    /// The file.
    pub path: PathBuf,
    /// Cause, from the operating system.
    pub source: io::Error,
}

impl FileError {
    /// Adds the operation and the path to an error of the operating system.
    pub fn at(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self { doing, path: path.to_owned(), source }
    }
}

/// Makes a folder and its parents.
///
/// # Errors
/// [`FileError`].
pub fn make_folder(folder: &Path) -> Result<(), FileError> {
    fs::create_dir_all(folder).map_err(FileError::at("create the folder", folder))
}

/// Writes a file under a temporary name beside its place, and moves it there when all of it is on the disk. A link stays a link: the
/// file behind it is replaced. A pipe or a terminal receives the content directly.
///
/// # Errors
/// [`FileError`]; an earlier file of the name is then untouched.
pub fn write_whole(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<(), FileError> {
    place(path).and_then(|place| replace(&place, content.as_ref())).map_err(FileError::at("write", path))
}

/// Destination of a text.
enum Place {
    /// A file, there or not yet, or a folder, which is refused when it is to be replaced.
    File(PathBuf),
    /// Anything else.
    Stream(PathBuf),
}

fn place(path: &Path) -> io::Result<Place> {
    // Names of open streams: the file behind one may have a name, but must not be replaced by another.
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
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // `File::create_new` gives the file the permissions of any other output; tempfile's own would hide it from the group.
    let mut part =
        tempfile::Builder::new().prefix(".softlimb-").suffix(".part").make_in(folder, |path| File::create_new(path))?;
    part.write_all(content)?;
    part.as_file().sync_all()?;
    part.persist(path).map(drop).map_err(|error| error.error)
}

/// The cause, with a remedy where there is an obvious one.
fn explained(doing: &str, error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            format!("{error}: free some space, or set TMPDIR to a folder on another disk")
        }
        io::ErrorKind::NotFound if doing == "write" => "its folder does not exist".to_owned(),
        io::ErrorKind::NotFound => "no such file or folder".to_owned(),
        io::ErrorKind::AlreadyExists => "a file has this name".to_owned(),
        io::ErrorKind::NotADirectory => "a part of the path is a file instead of a folder".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        _ => error.to_string(),
    }
}
