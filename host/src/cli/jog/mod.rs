//! `softlimb jog`: move a limb by hand.

mod gamepad;
mod keys;
mod screen;
mod terminal;

use std::io::{IsTerminal, stdin, stdout};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::by_hand::{HandOptions, Latency};
use super::interrupt::interrupt;
use super::shared::{limb, show};
use super::{Failure, Outcome, note, warn};
use crate::results::run_warnings;
use gamepad::Gamepad;
use screen::Head;
use softlimb_limb::Limb;
use softlimb_motion::jog::Attempt;
use softlimb_rig::link::LinkFaults;
use softlimb_rig::report;
use softlimb_rig::run;
use softlimb_rig::run::{JogOptions, JogView, Operator, Press, RunError, RunFiles};
use softlimb_scene::Scene;
use terminal::Terminal;

/// Move a limb by hand: tip or single modules by the keys of the terminal, recorded like a run
#[derive(Args)]
#[command(
    after_help = "Keys: w/s, a/d, r/f or the arrows move the tip along x, y and z; 1 to 9 select a module, 0 the tip; g closes and opens the\n\
                  gripper; space or v vents; q vents and ends. A step that would leave a limit is refused with the reason.\n\
                  Writes run.mcap and run.html; those of an earlier session in the same folder are replaced.\n\n\
                  Examples:\n  softlimb jog scenes/steering.toml\n  \
                  softlimb jog scenes/steering.toml --port /dev/ttyACM0 --gamepad /dev/input/js0"
)]
pub(super) struct Jog {
    /// The scene file
    scene: PathBuf,
    /// Folder for run.mcap and run.html [default: out/<scene>-jog]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    hand: HandOptions,
    /// Faults of the link, as shares of the frames each way; `softlimb run --help` names them
    #[arg(long, value_name = "NAME=SHARE,..")]
    link_fault: Option<LinkFaults>,
    /// Gamepad of Linux: its file of 8-byte records
    #[arg(long, value_name = "FILE")]
    gamepad: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// The result.
#[derive(Serialize)]
struct Printed {
    scene: String,
    /// Distance from a target at which the tip is there, m.
    within_m: f64,
    targets: Vec<Target>,
    /// Keys with a setpoint of their own.
    keys: usize,
    key_to_wire: Option<Latency>,
    warnings: Vec<String>,
}

/// One target.
#[derive(Serialize)]
struct Target {
    name: String,
    /// Time until it was met, s; absent where it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_s: Option<f64>,
    /// Least distance of the tip, m; absent where the tip was never seen on its way there.
    #[serde(skip_serializing_if = "Option::is_none")]
    least_m: Option<f64>,
    /// Time of the tip at the target, s.
    held_s: f64,
}

impl Jog {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let device = self.hand.device()?;
        let (scene, limb) = limb(&self.scene)?;
        if !stdin().is_terminal() || !stdout().is_terminal() {
            return Err(Failure::new("jog needs a terminal: its keys move the limb, its screen shows it"));
        }
        let options = JogOptions {
            out: self.out.clone().unwrap_or_else(|| run::jog_folder(&scene)),
            within_m: self.hand.within.si(),
            link_faults: self.link_fault,
            task: None,
        };
        let gamepad = self.gamepad.as_deref().map(Gamepad::open).transpose()?;
        let cancel = interrupt()?;
        let mut hand = Hand::new(&scene, &limb, device.name(), gamepad)?;
        let outcome = device.session(&scene, &options, &mut hand, &cancel);
        let waits = std::mem::take(&mut hand.waits);
        // The terminal is as it was before anything is printed.
        drop(hand);
        let (files, stopped) = match outcome {
            Ok(files) => (files, None),
            Err(RunError::Stopped { cause, files }) => (*files, Some(cause)),
            Err(error) => return Err(error.into()),
        };
        let printed = printed(&scene, &files, &options, waits)?;
        show(self.json, &printed, || text(&printed))?;
        note(&format!("log:    {}\nreport: {}", files.log.display(), files.report.display()));
        let outcome = warn(&printed.warnings);
        stopped.map_or(Ok(outcome), |cause| Err(Failure::new(cause)))
    }
}

/// The operator at the terminal.
struct Hand<'a> {
    terminal: Terminal,
    gamepad: Option<Gamepad>,
    head: (String, String),
    limb: &'a Limb,
    looked: Instant,
    pressed: Option<Instant>,
    waits: Vec<Duration>,
}

impl<'a> Hand<'a> {
    fn new(scene: &Scene, limb: &'a Limb, port: String, gamepad: Option<Gamepad>) -> Result<Self, Failure> {
        let head = (scene.name().to_owned(), port);
        let terminal = Terminal::open()?;
        Ok(Self { terminal, gamepad, head, limb, looked: Instant::now(), pressed: None, waits: Vec::new() })
    }
}

impl Operator for Hand<'_> {
    fn presses(&mut self, view: &JogView<'_, '_>) -> Vec<Press> {
        let before = std::mem::replace(&mut self.looked, Instant::now());
        let mut presses = self.terminal.presses();
        presses.extend(self.gamepad.iter_mut().flat_map(Gamepad::presses));
        if presses.iter().any(|press| matches!(press, Press::Order(_))) {
            self.pressed = Some(before);
        }
        let (scene, port) = (&self.head.0, &self.head.1);
        let head = Head { scene, port, limb: self.limb, tells_releases: self.terminal.tells_releases() };
        // A key is shown by the next drawing: the limb comes first.
        if presses.is_empty() {
            self.terminal.draw(|| screen::lines(&head, view));
        }
        presses
    }

    fn sent(&mut self, _waited_us: u64) {
        self.waits.extend(self.pressed.take().map(|pressed| pressed.elapsed()));
    }
}

fn printed(scene: &Scene, files: &RunFiles, options: &JogOptions, waits: Vec<Duration>) -> Result<Printed, Failure> {
    let target = |Attempt { name, time_s, least_m, held_s }: Attempt| Target {
        name,
        time_s,
        least_m: Some(least_m).filter(|least_m| least_m.is_finite()),
        held_s,
    };
    let attempts = run::attempts(scene, &files.run, options.within_m)?;
    Ok(Printed {
        scene: scene.name().to_owned(),
        within_m: options.within_m,
        targets: attempts.into_iter().map(target).collect(),
        keys: waits.len(),
        key_to_wire: Latency::of(waits),
        warnings: run_warnings(&report::summary(&files.run)),
    })
}

fn text(printed: &Printed) -> String {
    let width = printed.targets.iter().map(|target| target.name.len()).max().unwrap_or(0).max("target".len());
    let mut text = format!("{:width$}  time s  least mm  held s", "target");
    for Target { name, time_s, least_m, held_s } in &printed.targets {
        let time = time_s.map_or_else(|| "-".to_owned(), |time_s| format!("{time_s:.1}"));
        let least = least_m.map_or_else(|| "-".to_owned(), |least_m| format!("{:.1}", 1e3 * least_m));
        text.push_str(&format!("\n{name:width$}  {time:>6}  {least:>8}  {held_s:>6.1}"));
    }
    let met = printed.targets.iter().filter(|target| target.time_s.is_some()).count();
    text.push_str(&format!(
        "\n{met} of {} targets met, within {:.1} mm",
        printed.targets.len(),
        1e3 * printed.within_m
    ));
    if let Some(latency) = &printed.key_to_wire {
        text.push_str(&format!("\nkey to setpoint on the wire, at most: {latency}, {} keys", printed.keys));
    }
    text
}
