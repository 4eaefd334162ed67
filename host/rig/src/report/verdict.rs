//! The answers that a reader looks for first: did the tip arrive, why not, how near was an obstacle, what failed.

use super::causes::{Causes, GoalCheck, Outcome, TOLERANCE, outcomes};
use super::{Miss, Summary, rows};
use crate::record::{NearestInfo, RunLog};

/// The answers in sentences.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Verdict {
    pub(super) sentences: Vec<String>,
    /// Whether a goal was missed, a fault reported, or an obstacle touched.
    pub(super) alarming: bool,
}

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Card {
    pub(super) title: &'static str,
    pub(super) value: String,
    pub(super) detail: String,
    /// Whether it is a warning.
    pub(super) alarming: bool,
}

/// One phase as the page lists it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PhaseRow {
    pub(super) name: String,
    pub(super) start: String,
    pub(super) motion: String,
    pub(super) hold: String,
    pub(super) gripper: String,
    /// Whether the goal was hit.
    pub(super) goal: &'static str,
    pub(super) error: String,
    pub(super) pressure: String,
    pub(super) model: String,
    pub(super) sag: String,
    pub(super) planned: String,
    pub(super) achieved: String,
}

/// The answers of a run in sentences: did it hit, why not, how close was an obstacle, what failed.
pub(super) fn verdict(log: &RunLog, summary: &Summary) -> Verdict {
    let outcomes = outcomes(log);
    let unfinished = outcomes.iter().find(|outcome| outcome.tip.is_none());
    let off_goal: Vec<_> = outcomes.iter().filter(|outcome| outcome.goal.is_some_and(|goal| !goal.is_hit())).collect();
    let worst = worst(&outcomes);
    let least = least(&outcomes);
    let arrival = match (unfinished, &summary.misses[..], worst) {
        (Some(outcome), ..) => {
            format!("The run ended at {:.2} s, before the end of its phase {}.", summary.duration_s, outcome.phase.name)
        }
        (None, [first, rest @ ..], _) => missed(first, rest.len()),
        (None, [], Some(_)) if !off_goal.is_empty() => off(&off_goal, outcomes.len()),
        (None, [], Some((_, _, total_m))) => hit(&outcomes, total_m),
        (None, [], None) => "The pressures brought every module to its setpoint. No observer measured the limb.".into(),
    };
    let reason = worst.map(|(outcome, causes, total_m)| {
        let mut parts = causes.parts();
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        let parts: Vec<_> = parts.into_iter().map(|(name, part_m)| format!("{name} {}", mm(part_m))).collect();
        let name = &outcome.phase.name;
        format!(
            "Largest tip error: {} at the end of {name}. Its causes, the largest first: {}.",
            mm(total_m),
            parts.join(", ")
        )
    });
    let clearance = clearance_of(&outcomes);
    let clearance = clearance.map(|card| match card.alarming {
        true => format!("The limb touched an obstacle: {}.", card.detail),
        false => format!("Clearance: {}, {}.", card.value, card.detail),
    });
    let first = summary.faults.first().map(rows::fault);
    let faults = first.map(|first| match summary.faults.len() {
        1 => format!("One fault: {first}."),
        count => format!("{count} faults, the first at {first}."),
    });
    let touches = least.is_some_and(|nearest| nearest.distance_m <= 0.0);
    let is_off = !off_goal.is_empty() || !summary.misses.is_empty();
    let alarming = touches || is_off || unfinished.is_some() || !summary.faults.is_empty();
    Verdict { sentences: [Some(arrival), reason, clearance, faults].into_iter().flatten().collect(), alarming }
}

/// Every phase ended at its goal, as far as one bounds the error.
fn hit(outcomes: &[Outcome<'_>], total_m: f64) -> String {
    let count = if outcomes.len() == 1 { "its phase".into() } else { format!("each of {} phases", outcomes.len()) };
    let within = format!("the tip was within {} of its setpoint at the end of {count}", mm(total_m));
    let tolerance = outcomes.iter().find_map(|outcome| match outcome.goal? {
        GoalCheck::Point { tolerance_m, .. } => Some(tolerance(tolerance_m)),
        GoalCheck::Region { .. } => None,
    });
    let has_goals = outcomes.iter().any(|outcome| outcome.goal.is_some());
    let judged = if has_goals { "Hit: " } else { "Without a tolerance: " };
    format!("{judged}{within}{}.", tolerance.map_or(String::new(), |text| format!("; {text}")))
}

/// Phases that ended off their goal.
fn off(off_goal: &[&Outcome<'_>], phases: usize) -> String {
    let beyond_m = |goal: GoalCheck<'_>| match goal {
        GoalCheck::Point { error_m, tolerance_m } => error_m - tolerance_m,
        GoalCheck::Region { outside_m, .. } => outside_m,
    };
    let known = off_goal.iter().filter_map(|outcome| Some((&outcome.phase.name, outcome.goal?)));
    let farthest = known.max_by(|a, b| beyond_m(a.1).total_cmp(&beyond_m(b.1)));
    let most = farthest.map_or(String::new(), |(phase, goal)| match goal {
        GoalCheck::Point { error_m, tolerance_m } => {
            format!("at the end of {phase} the tip was {} from its setpoint; {}", mm(error_m), tolerance(tolerance_m))
        }
        GoalCheck::Region { name, outside_m } => {
            format!("at the end of {phase} the tip was {} outside of region {name}", mm(outside_m))
        }
    });
    format!("Missed in {} of {phases} phases: {most}.", off_goal.len())
}

fn tolerance(tolerance_m: f64) -> String {
    format!("the tolerance is {}, {:.0} % of the limb's length", mm(tolerance_m), 1e2 * TOLERANCE)
}

fn missed(first: &Miss, others: usize) -> String {
    let Miss { module, phase, share_of_travel } = first;
    let more = match others {
        0 => String::new(),
        count => format!(" Misses besides: {count}."),
    };
    format!(
        "Module {module} missed its setpoint at the end of {phase} by {:.0} % of its travel.{more}",
        1e2 * share_of_travel
    )
}

/// The answers of a run.
pub(super) fn cards(log: &RunLog, summary: &Summary) -> Vec<Card> {
    let outcomes = outcomes(log);
    [tip(&outcomes, summary), clearance_of(&outcomes), pressure(summary), faults(summary)]
        .into_iter()
        .flatten()
        .collect()
}

fn tip(outcomes: &[Outcome<'_>], summary: &Summary) -> Option<Card> {
    let title = "Tip error";
    let Some(error) = summary.tip.error_m else {
        let error = summary.tip.tracking_error_m?;
        let detail = "RMSE by pressure tracking alone; no observer measured the limb".to_owned();
        return Some(Card { title, value: mm(error.rmse), detail, alarming: false });
    };
    let Some((outcome, causes, total_m)) = worst(outcomes) else {
        return Some(Card { title, value: mm(error.rmse), detail: "RMSE over the run".to_owned(), alarming: false });
    };
    let because = causes.largest().map_or(String::new(), |(name, part_m)| format!("; most by {name}: {}", mm(part_m)));
    let detail = format!("largest at the end of a phase: {}{because}", outcome.phase.name);
    let alarming = outcomes.iter().any(|outcome| outcome.goal.is_some_and(|goal| !goal.is_hit()));
    Some(Card { title, value: mm(total_m), detail, alarming })
}

/// The phase with the largest error at its end.
fn worst<'a, 'b>(outcomes: &'a [Outcome<'b>]) -> Option<(&'a Outcome<'b>, Causes, f64)> {
    let ends = outcomes.iter().filter_map(|outcome| Some((outcome, outcome.tip?, outcome.tip?.total_m?)));
    ends.filter(|(_, _, total_m)| total_m.is_finite()).max_by(|a, b| a.2.total_cmp(&b.2))
}

/// The least observed clearance.
fn least<'a>(outcomes: &'a [Outcome<'_>]) -> Option<&'a NearestInfo> {
    let seen = outcomes.iter().filter_map(|outcome| outcome.nearest.as_ref());
    seen.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

fn clearance_of(outcomes: &[Outcome<'_>]) -> Option<Card> {
    let title = "Clearance";
    let planned = outcomes.iter().filter_map(|outcome| outcome.phase.nearest.as_ref());
    let planned = planned.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let Some(seen) = least(outcomes) else {
        let planned = planned?;
        let detail = format!("planned, from {} at {:.2} s; not observed", planned.obstacle, planned.time_s);
        return Some(Card { title, value: mm(planned.distance_m), detail, alarming: false });
    };
    let plan = planned.map_or(String::new(), |planned| format!("; planned {}", mm(planned.distance_m)));
    let place = format!("{} at {:.2} s", seen.obstacle, seen.time_s);
    let touches = seen.distance_m <= 0.0;
    let (value, detail) = match touches {
        true => ("contact".to_owned(), format!("{} deep in {place}{plan}", mm(-seen.distance_m))),
        false => (mm(seen.distance_m), format!("least, from {place}{plan}")),
    };
    Some(Card { title, value, detail, alarming: touches })
}

fn pressure(summary: &Summary) -> Option<Card> {
    let error = summary.pressure.measured_error_pa?;
    let detail = format!("RMSE of all channels, sensor from reference; largest {:.2} kPa", error.max * 1e-3);
    Some(Card { title: "Pressure error", value: format!("{:.2} kPa", error.rmse * 1e-3), detail, alarming: false })
}

fn faults(summary: &Summary) -> Option<Card> {
    let value = match summary.faults.len() {
        0 => "none".to_owned(),
        count => count.to_string(),
    };
    let first = summary.faults.first().map(rows::fault);
    let on_purpose = match summary.injected_faults.len() {
        0 => String::new(),
        count => format!("{count} on purpose; "),
    };
    let detail = format!("{on_purpose}{}", first.unwrap_or_else(|| "reported by device or limb".to_owned()));
    Some(Card { title: "Faults", value, detail, alarming: !summary.faults.is_empty() })
}

/// The phases with their outcome.
pub(super) fn phases(log: &RunLog) -> Vec<PhaseRow> {
    let row = |outcome: &Outcome<'_>| {
        let (phase, tip) = (outcome.phase, outcome.tip);
        let part = |part: Option<f64>| part.filter(|part| part.is_finite()).map_or(String::new(), number_mm);
        let near = |near: &Option<NearestInfo>| {
            near.as_ref().map_or(String::new(), |near| {
                format!("{} from {} at {:.2} s", mm(near.distance_m), near.obstacle, near.time_s)
            })
        };
        PhaseRow {
            name: phase.name.clone(),
            start: format!("{:.2}", phase.start_s),
            motion: format!("{:.2}", phase.move_s),
            hold: format!("{:.2}", phase.hold_s),
            gripper: phase.gripper.clone().unwrap_or_default(),
            goal: outcome.goal.map_or("", |goal| if goal.is_hit() { "hit" } else { "missed" }),
            error: part(tip.and_then(|tip| tip.total_m)),
            pressure: part(tip.map(|tip| tip.pressure_m)),
            model: part(tip.and_then(|tip| tip.model_m)),
            sag: part(tip.and_then(|tip| tip.sag_m)),
            planned: near(&phase.nearest),
            achieved: near(&outcome.nearest),
        }
    };
    outcomes(log).iter().map(row).collect()
}

fn mm(length_m: f64) -> String {
    format!("{} mm", number_mm(length_m))
}

/// A length in mm to a tenth; adding zero turns -0.0 into 0.0.
fn number_mm(length_m: f64) -> String {
    format!("{:.1}", (length_m * 1e4).round() / 10.0 + 0.0)
}
