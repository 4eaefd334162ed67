//! Commands side by side, each one's output kept whole.

use std::io;
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, mpsc};
use std::thread;

/// A command under the name that its output is printed with.
pub(crate) struct Job {
    pub(crate) name: String,
    pub(crate) command: Command,
}

/// A job that has ended, or that could not start.
pub(crate) struct Done {
    pub(crate) name: String,
    pub(crate) output: io::Result<Output>,
}

/// Runs a job to its end.
pub(crate) fn run(mut job: Job) -> Done {
    let output = job.command.stdin(Stdio::null()).output();
    Done { name: job.name, output }
}

/// Runs jobs in their order, as many at once as there are cores, and hands over each as it ends.
pub(crate) fn all(jobs: Vec<Job>, ended: impl FnMut(Done)) {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    side_by_side(jobs, cores, ended);
}

fn side_by_side(jobs: Vec<Job>, at_once: usize, ended: impl FnMut(Done)) {
    let waiting = Mutex::new(jobs.into_iter());
    // A thread that panics holds no half-taken job.
    let next = || waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).next();
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..at_once {
            let sender = sender.clone();
            scope.spawn(move || {
                while let Some(job) = next() {
                    // The receiver lives until the last sender is gone.
                    let _ = sender.send(run(job));
                }
            });
        }
        drop(sender);
        receiver.into_iter().for_each(ended);
    });
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(name: &str, script: &str) -> Job {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        Job { name: name.to_owned(), command }
    }

    #[test]
    fn every_job_ends_once_whatever_becomes_of_the_others() {
        let absent = Job { name: "absent".to_owned(), command: Command::new("/nowhere/program") };
        let jobs = vec![shell("fails", "echo one; echo two >&2; exit 3"), absent, shell("lasts", "echo three")];
        let mut found = Vec::new();
        side_by_side(jobs, 2, |done| {
            let output = done.output.ok();
            let text = output.as_ref().map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
            found.push((done.name, output.and_then(|output| output.status.code()), text));
        });
        found.sort();
        let expected = [
            ("absent", None, None),
            ("fails", Some(3), Some("one\n".to_owned())),
            ("lasts", Some(0), Some("three\n".to_owned())),
        ];
        assert_eq!(found, expected.map(|(name, code, text)| (name.to_owned(), code, text)));
    }

    #[test]
    fn two_run_at_once_and_no_third() {
        // The first waits for what the second makes; a third that began with them would find it missing.
        let folder = std::env::temp_dir().join(format!("softlimb-pool-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mark = folder.join("mark");
        let mark = mark.display();
        let jobs = vec![
            shell("waits", &format!("until [ -e '{mark}' ]; do sleep 0.01; done")),
            shell("makes", &format!("sleep 0.05; : > '{mark}'")),
            shell("finds", &format!("[ -e '{mark}' ]")),
        ];
        let mut succeeded = 0;
        side_by_side(jobs, 2, |done| succeeded += usize::from(done.output.unwrap().status.success()));
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(succeeded, 3);
    }
}
