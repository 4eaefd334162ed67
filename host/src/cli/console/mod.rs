//! `softlimb console`: move and watch a limb in a browser.

mod hand;
mod view;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use clap::Args;

use super::by_hand::{Device, HandOptions, Latency};
use super::interrupt::interrupt;
use super::shared::limb;
use super::{Failure, Outcome, note, say, warn};
use crate::results::run_warnings;
use hand::Hand;
use softlimb_console::{Console as Page, Order, Site};
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_rig::report::{LIMB_SCRIPT, STYLE, summary};
use softlimb_rig::run::{JogOptions, RunError, RunFiles};
use softlimb_scene::Scene;
use view::View;

/// The limb of a console without a scene.
const EXAMPLE: &str = include_str!("../../../../scenes/steering.toml");

/// Time between two looks at the orders while no device is connected.
const LOOK: Duration = Duration::from_millis(20);

/// Watch and move a limb in a browser: live limb, pressures and faults, jog by sliders, keys and gamepad
#[derive(Args)]
#[command(
    after_help = "Prints the address of the page, for a browser on this computer; it has a random token. The first page commands, others look;\n\
                  every page can vent. A page that is closed or falls silent lets the limb hold; after 5 s without one that commands it vents.\n\
                  Each session writes run.mcap and run.html; those of an earlier session in the same folder are replaced.\n\n\
                  Examples:\n  softlimb console\n  softlimb console scenes/pick-and-place-a.toml\n  softlimb console scenes/steering.toml --port /dev/ttyACM0"
)]
pub(super) struct Console {
    /// The scene file [default: a limb of two steering modules]
    scene: Option<PathBuf>,
    /// Folder for run.mcap and run.html [default: out/<scene>-console]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    hand: HandOptions,
    /// TCP port of the page on the loopback address [default: any free one]
    #[arg(long, value_name = "NUMBER")]
    page_port: Option<u16>,
}

impl Console {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let device = self.hand.device()?;
        let (scene, limb) = match &self.scene {
            Some(file) => limb(file)?,
            None => {
                let scene = softlimb_scene::parse(EXAMPLE, "steering")?;
                let limb = Limb::new(&scene)?;
                (scene, limb)
            }
        };
        note("planning the task of the scene");
        let (task, refused) = match motion::plan(&scene, &limb) {
            Ok(plan) => (Some(Arc::new(plan)), None),
            Err(error) => (None, Some(error.to_string())),
        };
        // Without a plan the limb can still be moved by hand.
        let warnings = refused.iter().map(|reason| format!("the task cannot be run: {reason}"));
        let outcome = warn(&warnings.collect::<Vec<_>>());
        let told = view::told(
            (&scene, &limb),
            &device.name(),
            device.is_simulated(),
            refused.as_deref().and_then(|text| text.lines().next()),
        );
        let site = Site { style: STYLE, limb_script: LIMB_SCRIPT, scene: told };
        let page = Page::open(self.page_port.unwrap_or(0), site)
            .map_err(|error| Failure::new(format!("the page cannot be served on the loopback address: {error}")))?;
        let cancel = interrupt()?;
        say(page.url())?;
        note("Open this address in a browser on this computer. Ctrl-C vents the limb and ends the console.");
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}-console", scene.name())));
        let options = JogOptions { out, within_m: self.hand.within.si(), link_faults: None, task };
        let mut before = View::between("idle");
        while armed(&page, &before, &cancel) {
            page.set_report(None);
            page.show(&View::between("connecting"));
            let ended = session(&device, (&scene, &limb), &options, &page, &cancel);
            before = told_end(&page, ended, &scene, device.is_simulated());
        }
        Ok(outcome)
    }
}

/// Waits until a page arms the device; `false` where Ctrl-C comes first.
fn armed(page: &Page, view: &View, cancel: &AtomicBool) -> bool {
    while !cancel.load(Ordering::Relaxed) {
        if page.orders().iter().any(|(order, _)| *order == Order::Arm) {
            return true;
        }
        page.show(view);
        sleep(LOOK);
    }
    false
}

fn session(
    device: &Device,
    (scene, limb): (&Scene, &Limb),
    options: &JogOptions,
    page: &Page,
    cancel: &AtomicBool,
) -> Result<RunFiles, RunError> {
    let mut hand = Hand::new(page, (scene, limb));
    let ended = device.session(scene, options, &mut hand, cancel);
    let orders = hand.waits.len();
    if let Some(latency) = Latency::of(hand.waits) {
        note(&format!("order to setpoint on the wire: {latency}, {orders} orders"));
    }
    ended
}

/// Shows the report of a session, and returns what the pages see next: why it ended early, what becomes of the pressures, and its faults.
fn told_end(page: &Page, ended: Result<RunFiles, RunError>, scene: &Scene, simulated: bool) -> View {
    let (files, message, after) = match ended {
        Ok(files) => (Some(files), String::new(), String::new()),
        Err(RunError::Stopped { cause, files }) => {
            (Some(*files), cause.to_string(), view::after(&cause, scene, simulated))
        }
        // The console stays open: the next attempt may find the device.
        Err(error) => (None, error.to_string(), String::new()),
    };
    if !message.is_empty() {
        note(&format!("error: {message}"));
    }
    let faults = files.iter().flat_map(|files| &files.run.faults).map(view::worded).collect();
    let view = View::ended((message, after), files.is_some(), faults);
    if let Some(RunFiles { log, report, run }) = files {
        warn(&run_warnings(&summary(&run)));
        note(&format!("log:    {}\nreport: {}", log.display(), report.display()));
        page.set_report(Some(report));
    }
    view
}
