//! The emulator as a child process that does not outlive its owner.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::EmulatorError;

const PROGRAM: &str = "qemu-system-arm";

/// A board with an STM32F405.
const MACHINE: &str = "netduinoplus2";

/// Whether the emulator is installed.
#[must_use]
pub fn is_installed() -> bool {
    let probe = Command::new(PROGRAM).arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).status();
    probe.is_ok_and(|status| status.success())
}

/// Reads an image.
pub(super) fn image(path: &Path) -> Result<Vec<u8>, EmulatorError> {
    std::fs::read(path).map_err(|source| EmulatorError::NoImage { path: path.to_owned(), source })
}

/// A running emulator, and a folder of its own for sockets.
#[derive(Debug)]
pub(super) struct Qemu {
    child: Child,
    folder: PathBuf,
}

impl Qemu {
    /// Starts it with an image and further arguments, which may need the folder.
    pub(super) fn start(
        image: &Path,
        arguments: impl FnOnce(&Path) -> Vec<String>,
        streams: (Stdio, Stdio),
    ) -> Result<Self, EmulatorError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("softlimb-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder)?;
        let started = Command::new(PROGRAM)
            .args(["-machine", MACHINE, "-display", "none", "-monitor", "none", "-kernel"])
            .arg(image)
            .args(arguments(&folder))
            .stdin(streams.0)
            .stdout(streams.1)
            .stderr(Stdio::null())
            .spawn();
        match started {
            Ok(child) => Ok(Self { child, folder }),
            Err(error) => {
                // Nothing is in it; where it cannot be removed, it is only untidy.
                let _ = std::fs::remove_dir_all(&folder);
                let missing = error.kind() == io::ErrorKind::NotFound;
                Err(if missing { EmulatorError::NotInstalled } else { error.into() })
            }
        }
    }

    #[cfg(unix)]
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Its standard input and output, once.
    pub(super) fn take_streams(&mut self) -> Result<(ChildStdin, ChildStdout), EmulatorError> {
        let streams = self.child.stdin.take().zip(self.child.stdout.take());
        streams.ok_or_else(|| io::Error::other("it has no streams").into())
    }

    pub(super) fn kill(&mut self) {
        // Either may fail when it has just ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        self.kill();
        // Sockets that nobody listens to; where they cannot be removed, they are only untidy.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
