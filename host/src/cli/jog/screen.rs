//! The screen of `softlimb jog`, as lines.

use std::fmt::Write;

use super::keys::HELP;
use softlimb_limb::{Drive, Limb};
use softlimb_motion::jog::unit_of;
use softlimb_rig::link::code_name;
use softlimb_rig::record::ChannelSample;
use softlimb_rig::run::JogView;
use softlimb_scene::Gripper;

/// Faults shown, the latest.
const FAULTS: usize = 3;

/// What the screen shows beside the view.
pub(super) struct Head<'a> {
    pub(super) scene: &'a str,
    pub(super) port: &'a str,
    pub(super) limb: &'a Limb,
    pub(super) tells_releases: bool,
}

/// The lines of the screen.
pub(super) fn lines(head: &Head<'_>, view: &JogView<'_, '_>) -> Vec<String> {
    let mut lines = vec![state(head, view), tip(view), target(view), keys(head, view), String::new()];
    lines.extend(pressures(head, view));
    lines.push(String::new());
    lines.push(match view.jog.refusal() {
        Some(refusal) => format!("refused: {refusal}"),
        None if view.is_vented => "vented: Enter goes on from rest".to_owned(),
        None => String::new(),
    });
    lines.extend(view.faults.iter().rev().take(FAULTS).map(|fault| format!("fault: {}", fault.text)));
    lines.push(String::new());
    lines.extend(HELP.map(str::to_owned));
    lines
}

fn state(head: &Head<'_>, view: &JogView<'_, '_>) -> String {
    let state = view.state.map_or_else(|| "connecting".to_owned(), |state| code_name(state.into()).to_lowercase());
    let sample = view.sample.map_or_else(String::new, |sample| {
        let valves = sample.valve_supply_v.map_or_else(String::new, |volts| format!("  valves {volts:.1} V"));
        format!("  {:.1} s  supply {:.1} kPa{valves}", sample.time_s, sample.supply_pa * 1e-3)
    });
    format!("{} on {}  {state}{sample}", head.scene, head.port)
}

fn tip(view: &JogView<'_, '_>) -> String {
    let Some(sample) = view.sample else { return String::new() };
    let (tip_m, seen) = match sample.tip_achieved_m {
        Some(tip_m) => (tip_m, "tip     "),
        None => (sample.tip_modelled_m, "tip, by the model"),
    };
    let [x, y, z] = tip_m;
    let [a, b, c] = sample.tip_setpoint_m;
    format!("{seen} x {x:.3}  y {y:.3}  z {z:.3} m   setpoint {a:.3}  {b:.3}  {c:.3} m")
}

fn target(view: &JogView<'_, '_>) -> String {
    let targets = view.jog.targets();
    let Some(target) = targets.next() else { return "target   all are met".to_owned() };
    let mut text = format!("target   `{}` ({} of {})", target.name, targets.met() + 1, targets.attempts().len());
    if let Some(way) = targets.missing_m() {
        let [x, y, z] = [way.x, way.y, way.z].map(|metres| 1e3 * metres);
        let _ = write!(text, ": {:.1} mm away, x {x:+.1}  y {y:+.1}  z {z:+.1} mm", 1e3 * way.norm());
    }
    text.push_str(match target.gripper {
        Some(Gripper::Close) => ", then close",
        Some(Gripper::Open) => ", then open",
        None => "",
    });
    text
}

fn keys(head: &Head<'_>, view: &JogView<'_, '_>) -> String {
    let settings = view.jog.settings();
    let (what, unit) = match settings.drive {
        None => ("the tip".to_owned(), "mm"),
        Some(index) => {
            let drive = head.limb.drive(index);
            (format!("`{}`", drive.name()), unit_of(drive.kind))
        }
    };
    let how = if head.tells_releases {
        "a key moves while it is held".to_owned()
    } else {
        format!("a key is a step of {} {unit}", settings.step())
    };
    let gripper = if view.jog.is_gripping() { "closed" } else { "open" };
    format!("keys     move {what}: {how}, at {} {unit}/s   gripper {gripper}", settings.speed())
}

fn pressures(head: &Head<'_>, view: &JogView<'_, '_>) -> Vec<String> {
    let Some(sample) = view.sample else { return Vec::new() };
    let width = head.limb.drives().map(|drive| drive.name().len()).max().unwrap_or(0);
    // One line a drive: the mean of its channels.
    let of_drive = |(index, drive): (usize, Drive<'_>)| {
        let own = sample.channels.get(drive.channels.clone()).unwrap_or_default();
        let kpa = |of: fn(&ChannelSample) -> f64| mean(own.iter().map(of)).unwrap_or(0.0) * 1e-3;
        let [pressure, reference] = [kpa(|channel| channel.pressure_pa), kpa(|channel| channel.reference_pa)];
        let mark = if view.jog.settings().drive == Some(index) { '>' } else { ' ' };
        format!("{mark} {} {:width$}  {pressure:7.2} of {reference:7.2} kPa", index + 1, drive.name())
    };
    head.limb.drives().enumerate().map(of_drive).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let count = values.len();
    (count > 0).then(|| values.sum::<f64>() / count as f64)
}
