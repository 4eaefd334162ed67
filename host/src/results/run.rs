//! A run, from its log.

use serde::Serialize;

use super::bend::{PrintedBend, of_limb};
use super::margins;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::record::RunLog;
use softlimb_rig::report::{Miss, Summary};
use softlimb_scene::{Scene, SceneError};

/// The summary of a run as `--json` prints it.
#[derive(Serialize)]
pub struct RunSummary<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    /// The models of its bends, one a module; absent where no scene of this version is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    bends: Option<Vec<Option<PrintedBend>>>,
    /// Faults, missed goals, and others.
    pub warnings: Vec<String>,
}

impl<'a> RunSummary<'a> {
    /// The summary with its own warnings between others, and the bends of the limb that ran.
    pub fn new(summary: &'a Summary, limb: Option<&Limb>, before: Vec<String>, after: Vec<String>) -> Self {
        Self { summary, bends: limb.map(of_limb), warnings: [before, warnings(summary), after].concat() }
    }
}

/// The limb of a recorded run; `None` where its log has no scene, or one of another version.
pub fn recorded_limb(log: &RunLog) -> Option<Limb> {
    let scene = softlimb_scene::parse(&log.info.scene_text, "scene.toml").ok()?;
    Limb::new(&scene).ok()
}

/// One line for the margins that `check` warns of, with the first of its warnings.
///
/// # Errors
/// As the margins themselves.
pub fn margin_warning(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Option<String>, SceneError> {
    let sent = motion::sent(scene, limb, plan)?;
    let margins = motion::margins(scene, limb, plan, &sent)?;
    let all = [margins::warnings(scene, limb, plan, &margins), limb.restraint_warnings()].concat();
    let rest = match all.len() {
        0 | 1 => String::new(),
        count => format!("; `softlimb check` has {} more such warnings", count - 1),
    };
    Ok(all.first().map(|first| format!("margins are too small: {first}{rest}")))
}

/// Faults of the device, and goals that the run missed.
pub(crate) fn warnings(summary: &Summary) -> Vec<String> {
    let mut warnings = Vec::new();
    for fault in &summary.faults {
        warnings.push(format!("{:.3} s into the run: {}", fault.time_s, fault.text));
    }
    for miss in &summary.misses {
        let Miss { module, phase, share_of_travel } = miss;
        let percent = 100.0 * share_of_travel;
        warnings.push(format!("the pressures had not brought `{module}` to its setpoint at the end of `{phase}`: {percent:.0} % of its travel off"));
    }
    for channel in &summary.limited_channels {
        warnings.push(format!("the device limited the reference of channel {channel}"));
    }
    warnings
}
