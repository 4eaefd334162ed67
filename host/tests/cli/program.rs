//! The command as a program that runs beside the test.

use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use crate::cli::desk::Desk;

/// Longest wait for a program's next line.
const PATIENCE: Duration = Duration::from_secs(20);

/// A program that runs beside the test, and is killed with it.
pub(crate) struct Program {
    child: Child,
    out: BufReader<ChildStdout>,
    /// Lines of standard error.
    told: Receiver<String>,
}

impl Program {
    pub(crate) fn start(desk: &Desk, line: &str) -> Self {
        Self::start_of(env!("CARGO_BIN_EXE_softlimb"), desk, line)
    }

    /// Starts another build of the command.
    pub(crate) fn start_of(file: &str, desk: &Desk, line: &str) -> Self {
        let mut child = Command::new(file)
            .args(line.split_whitespace())
            .current_dir(desk.path(""))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let out = BufReader::new(child.stdout.take().unwrap());
        let told = lines(child.stderr.take().unwrap());
        Self { child, out, told }
    }

    pub(crate) fn first_line(&mut self) -> String {
        let mut line = String::new();
        self.out.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    /// Waits for a line on standard error with this word; the time in front of it, s.
    #[track_caller]
    pub(crate) fn until(&self, word: &str) -> f64 {
        let mut lines = Vec::new();
        loop {
            match self.told.recv_timeout(PATIENCE) {
                Ok(line) if line.contains(word) => {
                    return line.split_whitespace().next().and_then(|time| time.parse().ok()).unwrap_or(f64::NAN);
                }
                Ok(line) => lines.push(line),
                Err(error) => panic!("no `{word}` ({error}): {lines:?}"),
            }
        }
    }

    /// As Ctrl-C does; the exit code.
    pub(crate) fn interrupt(self) -> Option<i32> {
        self.interrupted().0
    }

    /// As Ctrl-C does; the exit code, and the lines on standard error that nobody has waited for.
    pub(crate) fn interrupted(mut self) -> (Option<i32>, String) {
        let status = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap();
        assert!(status.success());
        let code = self.ended();
        (code, self.told.iter().map(|line| line + "\n").collect())
    }

    /// Waits for the end, a minute at most; the exit code.
    #[track_caller]
    pub(crate) fn ended(&mut self) -> Option<i32> {
        let began = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.code();
            }
            assert!(began.elapsed() < 3 * PATIENCE, "it does not end: {:?}", self.told.try_iter().collect::<Vec<_>>());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // Most have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn lines(from: ChildStderr) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(from).lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    receiver
}
