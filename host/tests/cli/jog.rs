//! `jog` in a real terminal: keys in, screen and log out.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use softlimb::rig::record;
use softlimb::rig::record::RunLog;

use crate::cli::desk::Desk;

/// Longest wait for an expected text on the screen.
const PATIENCE: Duration = Duration::from_secs(60);

/// Whether there is a tmux. Continuous integration must have it: else the test would be skipped unnoticed.
fn tmux_is_installed() -> bool {
    let found = Command::new("tmux").arg("-V").stdout(Stdio::null()).status().is_ok();
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found || !ci, "CI is set and tmux is missing: apt-get install tmux");
    if !found {
        let _ =
            writeln!(std::io::stderr(), "skipped: jog in a terminal; tmux is missing (Debian: apt-get install tmux)");
    }
    found
}

/// A terminal with a shell in which the command runs, with a server of its own that ends with the test.
struct Terminal<'d> {
    desk: &'d Desk,
}

impl<'d> Terminal<'d> {
    /// Runs the command; its exit code is shown when it has ended.
    fn start(desk: &'d Desk, line: &str) -> Self {
        let terminal = Self { desk };
        let line = format!("'{}' {line}; echo EXIT $?; cat", env!("CARGO_BIN_EXE_softlimb"));
        let folder = desk.path("").display().to_string();
        terminal.tmux(&[
            "-f",
            "/dev/null",
            "new-session",
            "-d",
            "-x",
            "120",
            "-y",
            "40",
            "-s",
            "jog",
            "-c",
            &folder,
            &line,
        ]);
        terminal
    }

    fn tmux(&self, arguments: &[&str]) -> String {
        let socket = self.desk.path("tmux");
        let output = Command::new("tmux").arg("-S").arg(&socket).args(arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    fn keys(&self, keys: &[&str]) {
        self.tmux(&[&["send-keys", "-t", "jog"], keys].concat());
    }

    /// Waits until the screen has a text; the screen.
    #[track_caller]
    fn until(&self, text: &str) -> String {
        let began = Instant::now();
        loop {
            let screen = self.tmux(&["capture-pane", "-p", "-t", "jog"]);
            if screen.contains(text) {
                return screen;
            }
            assert!(began.elapsed() < PATIENCE, "no `{text}` on the screen:\n{screen}");
            sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Terminal<'_> {
    fn drop(&mut self) {
        // Where it never began there is none.
        let _ = Command::new("tmux").arg("-S").arg(self.desk.path("tmux")).arg("kill-server").output();
    }
}

fn log(desk: &Desk, folder: &str) -> RunLog {
    record::read(desk.path(&format!("{folder}/run.mcap"))).unwrap()
}

/// Setpoint of the finger in degrees, sample by sample.
fn bends(log: &RunLog) -> Vec<f64> {
    log.samples.iter().map(|sample| sample.modules[0].setpoint.to_degrees()).collect()
}

#[test]
fn keys_move_the_limb_and_the_screen_and_the_log_show_it() {
    if !tmux_is_installed() {
        return;
    }
    let desk = Desk::with_scene("seed = 1", "seed = 2");
    let terminal = Terminal::start(&desk, "jog scene.toml --out hand");
    let screen = terminal.until("running");
    assert!(screen.contains("target   `bend` (1 of 1)") && screen.contains("a key is a step of 5 mm"), "{screen}");
    // Across the plane of the limb.
    terminal.keys(&["d"]);
    terminal.until("refused: no module moves the tip this way from here");
    terminal.keys(&["1"]);
    terminal.until("move `finger`: a key is a step of 5 deg, at 20 deg/s");
    terminal.keys(&["s"]);
    terminal.until("refused: `finger` has no pressure left");
    // They arrive at once: one is under way, one waits, and the third is too many.
    terminal.keys(&["-N", "3", "w"]);
    terminal.until("refused: one step waits already");
    settle(&terminal);
    terminal.keys(&["g"]);
    terminal.until("gripper closed");
    settle(&terminal);
    terminal.keys(&["]"]);
    terminal.until("a step of 20 deg");
    terminal.keys(&["w"]);
    terminal.until("all are met");
    terminal.keys(&["Space"]);
    terminal.until("vented: Enter goes on from rest");
    terminal.keys(&["w"]);
    terminal.keys(&["Enter"]);
    terminal.until("running");
    terminal.keys(&["w"]);
    sleep(Duration::from_millis(1500));
    terminal.keys(&["q"]);
    let screen = terminal.until("EXIT");
    assert!(screen.contains("1 of 1 targets met, within 10.0 mm") && screen.contains("EXIT 0"), "{screen}");
    assert!(screen.contains("key to setpoint on the wire, at most: p50"), "{screen}");

    let log = log(&desk, "hand");
    assert!(log.incomplete.is_none() && log.faults.is_empty() && log.info.simulated, "{:?}", log.faults);
    let bends = bends(&log);
    let highest = bends.iter().copied().fold(0.0, f64::max);
    assert!((highest - 30.0).abs() < 0.01, "5, 5 and 20 deg: {highest}");
    // 20 deg/s, whatever the keys did.
    for pair in log.samples.windows(2) {
        let rate = (pair[1].modules[0].setpoint - pair[0].modules[0].setpoint).to_degrees()
            / (pair[1].time_s - pair[0].time_s);
        assert!(rate < 20.0 + 0.1, "{rate} deg/s at {} s", pair[1].time_s);
    }
    assert!(log.samples.iter().any(|sample| sample.outputs.bits == 1), "the gripper was told to close");
    let page = fs::read_to_string(desk.path("hand/run.html")).unwrap();
    assert!(page.contains("finger"));
    assert!(desk.softlimb("report hand/run.mcap").done().out.contains("small"));
}

/// Waits until two screens in a row have the same setpoint of the tip.
fn settle(terminal: &Terminal<'_>) {
    let line = || {
        let screen = terminal.until("setpoint");
        let line = screen.lines().find(|line| line.contains("setpoint")).unwrap_or_default();
        line.split("setpoint").nth(1).unwrap_or_default().to_owned()
    };
    let (began, mut last) = (Instant::now(), line());
    loop {
        sleep(Duration::from_millis(500));
        let now = line();
        if now == last {
            return;
        }
        assert!(began.elapsed() < PATIENCE, "the setpoint never rests: {last}, {now}");
        last = now;
    }
}

/// A served device, which is killed with the test.
struct Served(Child);

impl Served {
    fn start(desk: &Desk) -> (Self, String) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_softlimb"))
            .args(["device", "serve", "scene.toml"])
            .current_dir(desk.path(""))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut address).unwrap();
        (Self(child), address.trim_end().to_owned())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn limb_on_a_device_is_moved_too_and_a_lost_device_is_named() {
    if !tmux_is_installed() {
        return;
    }
    let desk = Desk::with_scene("seed = 1", "seed = 2");
    let (device, address) = Served::start(&desk);
    let terminal = Terminal::start(&desk, &format!("jog scene.toml --out hand --port {address}"));
    let screen = terminal.until("tip, by the model");
    assert!(screen.contains(&format!("small on {address}")), "{screen}");
    terminal.keys(&["1", "w"]);
    settle(&terminal);
    drop(device);
    let screen = terminal.until("EXIT");
    assert!(screen.contains("EXIT 1") && screen.contains("run.mcap"), "{screen}");
    assert!(screen.contains("is gone") || screen.contains("silent"), "{screen}");
    let log = log(&desk, "hand");
    assert!(!log.info.simulated && log.samples.iter().all(|sample| sample.tip_achieved_m.is_none()));
    let highest = bends(&log).into_iter().fold(0.0, f64::max);
    assert!((highest - 5.0).abs() < 0.01, "{highest}");
}

#[test]
fn without_a_terminal_it_says_so() {
    let desk = Desk::with_scene("seed = 1", "seed = 2");
    desk.softlimb("jog scene.toml").failed(1, &["jog needs a terminal"]);
}
