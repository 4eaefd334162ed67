//! What the page shows, as JSON.

use serde::Serialize;

use softlimb_limb::Limb;
use softlimb_motion::TipGoal;
use softlimb_motion::jog::{SPEEDS, STEPS, TaskProgress};
use softlimb_rig::link::{LinkError, VentOutcome, code_name};
use softlimb_rig::record::{ChannelSample, FaultRecord, SolidInfo};
use softlimb_rig::run;
use softlimb_rig::run::{JogView, SeenFault, TimedFault};
use softlimb_scene::{LinkLoss, Scene};

/// The scene: it does not change during a session.
#[derive(Serialize)]
struct Told<'a> {
    name: &'a str,
    port: &'a str,
    simulated: bool,
    weightless: bool,
    drives: Vec<Drive>,
    channels: usize,
    steps: [f64; 3],
    speeds: [f64; 3],
    faults: Vec<Fault>,
    solids: Vec<SolidInfo>,
    line_m: Vec<[f64; 3]>,
    radius_m: Vec<f64>,
    reach_m: f64,
    task: bool,
    task_refused: Option<&'a str>,
}

#[derive(Serialize)]
struct Drive {
    name: String,
    channels: Vec<usize>,
    pressure_max_pa: f64,
}

#[derive(Serialize)]
struct Fault {
    name: &'static str,
    of_channel: bool,
}

/// The description of a scene that a page receives first.
pub(super) fn told((scene, limb): (&Scene, &Limb), port: &str, simulated: bool, task_refused: Option<&str>) -> String {
    let drive = |drive: softlimb_limb::Drive<'_>| Drive {
        name: drive.name(),
        channels: drive.channels.clone().collect(),
        pressure_max_pa: drive.pressure_max_pa,
    };
    let drives: Vec<Drive> = limb.drives().map(drive).collect();
    let faults = TimedFault::kinds().map(|(name, of_channel)| Fault { name, of_channel }).collect();
    let (solids, body) = run::at_rest(scene, limb);
    let ways = body.line_m.windows(2).map(|pair| {
        let squares = pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    });
    let told = Told {
        name: scene.name(),
        port,
        simulated,
        weightless: scene.weightless(),
        channels: drives.iter().map(|drive| drive.channels.len()).sum(),
        drives,
        steps: STEPS,
        speeds: SPEEDS,
        faults: if simulated { faults } else { Vec::new() },
        solids,
        reach_m: ways.sum(),
        line_m: body.line_m,
        radius_m: body.radius_m,
        task: task_refused.is_none(),
        task_refused,
    };
    serde_json::to_string(&told).expect("numbers and text become JSON")
}

/// The state of device and limb.
#[derive(Default, Serialize)]
pub(super) struct View {
    session: &'static str,
    message: String,
    /// What becomes of the pressures after a stop, and how to go on.
    after: String,
    report: bool,
    device: Option<String>,
    time_s: Option<f64>,
    supply_pa: Option<f64>,
    /// Voltage of the valves' supply, V; none if the board does not sense it.
    valve_supply_v: Option<f64>,
    tip_m: Option<[f64; 3]>,
    setpoint_m: Option<[f64; 3]>,
    /// Pressure and setpoint, Pa, and duty of the valves, -1 to 1.
    channels: Option<Vec<[f64; 3]>>,
    line_m: Option<Vec<[f64; 3]>>,
    radius_m: Option<Vec<f64>>,
    /// Distance from the nearest obstacle, m, and its name.
    nearest: Option<(f64, String)>,
    carried: Option<Carried>,
    faults: Vec<Reported>,
    refusal: Option<String>,
    gripping: bool,
    moving: bool,
    task: Option<Task>,
    target: Option<String>,
    next: Option<NextTarget>,
}

/// A fault, and the channel that the device has named.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Reported {
    text: String,
    channel: Option<u8>,
}

/// The next target of the scene in space.
#[derive(Serialize)]
struct NextTarget {
    name: String,
    at_m: [f64; 3],
}

#[derive(Serialize)]
struct Carried {
    radius_m: f64,
    above_m: f64,
    below_m: f64,
}

#[derive(Serialize)]
struct Task {
    time_s: f64,
    duration_s: f64,
    phase: String,
    is_held: bool,
}

impl View {
    /// No device is connected.
    pub(super) fn between(session: &'static str) -> Self {
        Self { session, ..Self::default() }
    }

    /// The session has ended; its faults stay until the next one.
    pub(super) fn ended((message, after): (String, String), report: bool, faults: Vec<Reported>) -> Self {
        Self { message, after, report, faults, ..Self::between("idle") }
    }

    /// A device under orders.
    pub(super) fn live(scene: &Scene, view: &JogView<'_, '_>) -> Self {
        let sample = view.sample;
        let object = view.jog.carrying().object.and_then(|index| scene.objects().get(index));
        let task = view.jog.task().map(|TaskProgress { time_s, duration_s, phase, is_held }| Task {
            time_s,
            duration_s,
            phase,
            is_held,
        });
        Self {
            session: if view.is_vented { "vented" } else { "live" },
            device: view.state.map(|state| code_name(state.into()).to_lowercase()),
            time_s: sample.map(|sample| sample.time_s),
            supply_pa: sample.map(|sample| sample.supply_pa),
            valve_supply_v: sample.and_then(|sample| sample.valve_supply_v),
            tip_m: sample.map(|sample| rounded(sample.tip_achieved_m.unwrap_or(sample.tip_modelled_m))),
            setpoint_m: sample.map(|sample| rounded(sample.tip_setpoint_m)),
            channels: sample.map(|sample| sample.channels.iter().map(channel).collect()),
            line_m: view.body.map(|body| body.line_m.iter().copied().map(rounded).collect()),
            radius_m: view.body.map(|body| body.radius_m.iter().map(|radius| places(*radius, 1e4)).collect()),
            nearest: view.body.and_then(|body| body.nearest.clone()),
            carried: object.map(|object| Carried {
                radius_m: object.radius_m,
                above_m: object.height_m - object.grasp_m,
                below_m: object.grasp_m,
            }),
            faults: view.faults.iter().map(reported).collect(),
            refusal: view.jog.refusal().map(ToString::to_string),
            gripping: view.jog.is_gripping(),
            moving: view.jog.is_moving(),
            task,
            target: target(view),
            next: next(view),
            ..Self::default()
        }
    }
}

fn reported(fault: &SeenFault) -> Reported {
    Reported { text: fault.text.clone(), channel: fault.channel }
}

/// A recorded fault in the words of a session, with its channel.
pub(super) fn worded(fault: &FaultRecord) -> Reported {
    let FaultRecord { text, channel, .. } = fault;
    let is_known = *channel == u8::MAX || text.contains("on channel");
    let text = if is_known { text.clone() } else { format!("{text}, on channel {channel}") };
    Reported { text, channel: fault.reported_channel() }
}

/// The pressures after a stop, and the next step of the operator.
pub(super) fn after(cause: &LinkError, scene: &Scene, simulated: bool) -> String {
    let LinkError::Run { vent, .. } = cause else {
        return "Arm starts a new session.".into();
    };
    let controller = scene.controller();
    let pressures = match vent {
        VentOutcome::Venting => "The device vents all chambers.".to_owned(),
        VentOutcome::ByDevice if controller.link_loss == LinkLoss::Hold => {
            "The device keeps the pressures, as the scene states; an emergency stop vents all chambers at once."
                .to_owned()
        }
        VentOutcome::ByDevice => format!(
            "The device holds the pressures for {} s, then vents all chambers; an emergency stop vents them at once.",
            f64::from(controller.hold_time_us) * 1e-6
        ),
        VentOutcome::Unconfirmed => "No answer confirms that the device vents.".to_owned(),
    };
    let next = match vent {
        VentOutcome::ByDevice if !simulated => {
            "Find the cause of the fault and clear it with `softlimb device clear`; then Arm starts a new session."
        }
        _ => "Arm starts a new session.",
    };
    format!("{pressures} The plots end with the session. {next}")
}

/// The place of the next target; a region is drawn as such.
fn next(view: &JogView<'_, '_>) -> Option<NextTarget> {
    let target = view.jog.targets().next()?;
    let TipGoal::Point(at_m) = target.goal else { return None };
    Some(NextTarget { name: target.name.to_owned(), at_m: rounded(at_m) })
}

fn target(view: &JogView<'_, '_>) -> Option<String> {
    let targets = view.jog.targets();
    let next = targets.next()?;
    let (place, of) = (targets.met() + 1, targets.attempts().len());
    let away = targets.missing_m().map_or_else(String::new, |way| format!(", {:.0} mm away", 1e3 * way.norm()));
    Some(format!("Next target: {} ({place} of {of}){away}", next.name))
}

fn channel(sample: &ChannelSample) -> [f64; 3] {
    [places(sample.pressure_pa, 1.0), places(sample.reference_pa, 1.0), places(sample.duty, 1e2)]
}

fn rounded(place_m: [f64; 3]) -> [f64; 3] {
    place_m.map(|part| places(part, 1e4))
}

fn places(value: f64, unit: f64) -> f64 {
    (value * unit).round() / unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_an_ended_session_are_shown_with_their_channels() {
        let fault =
            |channel, code, text: &str| FaultRecord { time_s: 1.0, channel, code, value: 0, text: text.to_owned() };
        // The code of a part broken on purpose: no device has reported it.
        let faults = [
            fault(2, 1, "over-pressure on channel 2"),
            fault(3, 245, "leak, on purpose"),
            fault(0xFF, 1, "supply low"),
        ];
        let view =
            View::ended(("the device stopped".into(), "Arm starts".into()), true, faults.iter().map(worded).collect());
        let shown = serde_json::to_value(view).expect("JSON");
        let expected = serde_json::json!([
            { "text": "over-pressure on channel 2", "channel": 2 },
            { "text": "leak, on purpose, on channel 3", "channel": null },
            { "text": "supply low", "channel": null },
        ]);
        assert_eq!(shown["faults"], expected);
        assert_eq!((&shown["session"], &shown["message"]), (&"idle".into(), &"the device stopped".into()));
        assert_eq!(shown["after"], "Arm starts");
    }

    #[test]
    fn pressures_after_a_stop_are_those_of_the_policy() {
        let text = include_str!("../../../../scenes/steering.toml");
        let scene = |text: &str| softlimb_scene::parse(text, "steering").expect("a scene");
        let stop = |vent| LinkError::Run { at_us: Some(1), vent, cause: Box::new(LinkError::Canceled) };
        let ramped = after(&stop(VentOutcome::ByDevice), &scene(text), true);
        assert!(ramped.starts_with("The device holds the pressures for "), "{ramped}");
        assert!(ramped.ends_with("session. Arm starts a new session."), "{ramped}");
        let cleared = after(&stop(VentOutcome::ByDevice), &scene(text), false);
        assert!(cleared.contains("`softlimb device clear`"), "{cleared}");
        let vented = after(&stop(VentOutcome::Venting), &scene(text), false);
        assert!(vented.starts_with("The device vents all chambers. "), "{vented}");
    }
}
