//! A program that does not outlive the one that started it.

use std::io;
use std::process::{Child, ExitStatus};
#[cfg(unix)]
use std::process::{Command, Stdio};

/// A process that is ended when nobody waits for it any more, or when this one is ended.
pub(crate) struct Running {
    child: Child,
    guard: Option<Child>,
}

impl Running {
    pub(crate) fn new(child: Child) -> Self {
        let guard = guard(child.id());
        Self { child, guard }
    }

    /// Exit status, if it has ended.
    pub(crate) fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The guard first, so that it has no chance of ending another process of the same number. All may fail where there is
        // nothing left to end.
        for child in self.guard.iter_mut().chain([&mut self.child]) {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// A shell that waits for its input to end, which it does with this process, however that ends, and then ends the other. Where there is no
/// shell nobody guards.
#[cfg(unix)]
fn guard(id: u32) -> Option<Child> {
    let mut command = Command::new("/bin/sh");
    command.args(["-c", "read -r _; kill -9 \"$0\"", &id.to_string()]);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()
}

#[cfg(not(unix))]
fn guard(_: u32) -> Option<Child> {
    None
}
