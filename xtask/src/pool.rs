//! Commands side by side, each one's output kept whole.

use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks whether a command has ended.
const PAUSE: Duration = Duration::from_millis(20);

/// A command under the name that its output is printed with.
pub(crate) struct Job {
    pub(crate) name: String,
    pub(crate) command: Command,
    /// The time after which the command counts as hung, and is ended.
    pub(crate) limit: Option<Duration>,
}

/// A job that has ended, or that could not start.
pub(crate) struct Done {
    pub(crate) name: String,
    pub(crate) output: io::Result<Output>,
    pub(crate) took: Duration,
}

/// Runs a job to its end, or to its limit of time: the output is what it had printed by then.
pub(crate) fn run(mut job: Job) -> Done {
    let started = Instant::now();
    let output = output(&mut job.command, job.limit);
    Done { name: job.name, output, took: started.elapsed() }
}

fn output(command: &mut Command, limit: Option<Duration>) -> io::Result<Output> {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
    let stdout = child.stdout.take().map(Pipe::read);
    let stderr = child.stderr.take().map(Pipe::read);
    let (status, hung) = match limit {
        Some(limit) => wait(&mut child, limit)?,
        None => (child.wait()?, false),
    };
    let [stdout, mut stderr] = [stdout, stderr].map(|pipe| pipe.map(|pipe| pipe.end(hung)).unwrap_or_default());
    if let (true, Some(limit)) = (hung, limit) {
        stderr.extend_from_slice(format!("xtask: ended at its limit of {} s\n", limit.as_secs_f64()).as_bytes());
    }
    Ok(Output { status, stdout, stderr })
}

/// Waits for the end of a child, and ends it at the limit with all that it has started; whether the limit was reached.
fn wait(child: &mut Child, limit: Duration) -> io::Result<(ExitStatus, bool)> {
    let mut waited = Duration::ZERO;
    while waited < limit {
        if let Some(status) = child.try_wait()? {
            return Ok((status, false));
        }
        thread::sleep(PAUSE);
        waited += PAUSE;
    }
    let started = descendants(child.id());
    // The child first: it neither notices the end of the others nor starts more.
    child.kill()?;
    end_all(&started);
    Ok((child.wait()?, true))
}

/// Descendants of a process; none where `ps` is missing.
///
/// A process group would also contain them. But Ctrl-C at the terminal reaches only the group of this program.
fn descendants(of: u32) -> Vec<u32> {
    let Ok(listed) = Command::new("ps").args(["-A", "-o", "pid=", "-o", "ppid="]).stderr(Stdio::null()).output() else {
        return Vec::new();
    };
    let text = String::from_utf8_lossy(&listed.stdout);
    let pair = |line: &str| {
        let mut numbers = line.split_whitespace().map(str::parse);
        Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
    };
    let pairs: Vec<(u32, u32)> = text.lines().filter_map(pair).collect();
    let mut found = vec![of];
    let mut next = 0;
    while let Some(&parent) = found.get(next) {
        found.extend(pairs.iter().filter(|pair| pair.1 == parent).map(|pair| pair.0));
        next += 1;
    }
    found.split_off(1)
}

/// Ends processes. Those that have ended already are no error.
fn end_all(processes: &[u32]) {
    if !processes.is_empty() {
        let mut kill = Command::new("kill");
        kill.arg("-KILL").args(processes.iter().map(u32::to_string));
        let _ = kill.stdout(Stdio::null()).stderr(Stdio::null()).status();
    }
}

/// A pipe that is read beside the wait for the program that writes it.
struct Pipe {
    bytes: Arc<Mutex<Vec<u8>>>,
    reader: thread::JoinHandle<()>,
}

impl Pipe {
    fn read(mut pipe: impl Read + Send + 'static) -> Self {
        let bytes = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&bytes);
        let reader = thread::spawn(move || {
            let mut chunk = [0; 4096];
            // An error ends the output as its end does.
            while let Ok(length @ 1..) = pipe.read(&mut chunk) {
                kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).extend_from_slice(&chunk[..length]);
            }
        });
        Self { bytes, reader }
    }

    /// The bytes read so far. After a hang, descendants that were not found may keep the pipe open: nobody waits for them.
    fn end(self, hung: bool) -> Vec<u8> {
        if !hung {
            // A reader does not panic.
            let _ = self.reader.join();
        }
        std::mem::take(&mut self.bytes.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
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
        Job { name: name.to_owned(), command, limit: None }
    }

    #[test]
    fn every_job_ends_once_whatever_becomes_of_the_others() {
        let absent = Job { name: "absent".to_owned(), command: Command::new("/nowhere/program"), limit: None };
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
    fn job_that_hangs_is_ended_and_what_it_printed_is_kept() {
        // A busy computer takes time to start a shell.
        let limit = Some(Duration::from_secs(3));
        let hangs = run(Job { limit, ..shell("hangs", "echo before; sleep 20; echo after") });
        let output = hangs.output.unwrap();
        assert_eq!((output.status.code(), output.stdout.as_slice()), (None, &b"before\n"[..]));
        assert_eq!(output.stderr, b"xtask: ended at its limit of 3 s\n");
        let ends = run(Job { limit: Some(Duration::from_secs(60)), ..shell("ends", "echo all; exit 3") });
        let output = ends.output.unwrap();
        assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(3), &b"all\n"[..]));
    }

    #[test]
    fn descendants_of_a_job_that_hangs_are_ended_with_it() {
        let limit = Some(Duration::from_secs(3));
        let hangs = run(Job { limit, ..shell("hangs", "sh -c 'sleep 600 & echo $!; wait' & wait") });
        let id = String::from_utf8(hangs.output.unwrap().stdout).unwrap();
        let runs = || {
            let state = Command::new("ps").args(["-o", "stat=", "-p", id.trim()]).output().unwrap().stdout;
            // A zombie has ended, though nobody has reaped it.
            !state.trim_ascii().is_empty() && !state.starts_with(b"Z")
        };
        assert!(!id.is_empty());
        assert!((0..1_000).any(|_| !runs() || (thread::sleep(PAUSE), false).1), "{id} still runs");
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
