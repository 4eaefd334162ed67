//! The answers that a reader looks for first: did the tip arrive, why not, how near was an obstacle, what failed.

use std::cmp::Ordering;

use super::causes::{Cause, Causes, GoalCheck, Outcome, TOLERANCE, outcomes};
use super::stats::distance;
use super::summary::scheduled;
use super::{Miss, Summary, rows};
use crate::record::{CarriedInfo, FaultRecord, NearestInfo, RunLog};

/// Largest depth in a surface, m, that counts as its compliance.
const GIVES_M: f64 = 0.1e-3;

/// The answers in sentences.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Verdict {
    pub(super) sentences: Vec<String>,
    /// Whether a goal was missed, a fault reported, or an obstacle touched.
    pub(super) alarming: bool,
    /// Whether a sentence says that a simulated gripper takes its object anywhere.
    pub(super) has_grasp: bool,
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
    pub(super) swing: String,
    pub(super) swing_planned: String,
    pub(super) planned: String,
    pub(super) achieved: String,
    /// Whether its goal was missed, or its clearance is below the required one.
    pub(super) alarming: bool,
}

/// The answers of a run in sentences: did it hit, why not, how close was an obstacle, what failed.
pub(super) fn verdict(log: &RunLog, summary: &Summary) -> Verdict {
    let outcomes = outcomes(log);
    let unfinished = outcomes.iter().find(|outcome| outcome.tip.is_none());
    let off_goal: Vec<_> = outcomes.iter().filter(|outcome| outcome.goal.is_some_and(|goal| !goal.is_hit())).collect();
    let worst = worst(&outcomes);
    let arrival = match (unfinished, &summary.misses[..], worst) {
        (Some(outcome), ..) => stopped(&outcomes, outcome, summary),
        (None, [first, rest @ ..], _) => missed(first, rest.len()),
        (None, [], Some(_)) if !off_goal.is_empty() => {
            off(off_goal.clone(), outcomes.iter().filter(|outcome| outcome.goal.is_some()).count())
        }
        (None, [], Some((_, _, total_m))) => hit(&outcomes, total_m),
        (None, [], None) if log.info.is_corrected() => {
            "The setpoints were corrected. No observer measured the limb: its error is unknown.".into()
        }
        (None, [], None) => "The pressures brought every module to its setpoint. No observer measured the limb.".into(),
    };
    let reason = worst.map(|(outcome, causes, total_m)| {
        let parts: Vec<_> = causes.sorted().into_iter().map(|(cause, part_m)| because(cause, part_m, log)).collect();
        let vectors = if parts.len() > 1 { "; they add as vectors" } else { "" };
        let name = quoted(&outcome.phase.name);
        let causes: String = parts.iter().map(|part| format!(", {part}")).collect();
        format!("Farthest from its setpoint at the end of a phase: {} at {name}{causes}{vectors}.", mm(total_m))
    });
    let until = if summary.faults.is_empty() { "then" } else { "the first fault" };
    let before = largest_before(log, summary).filter(|_| unfinished.is_some());
    let last = summary.tip.final_error_m.filter(|_| !summary.faults.is_empty());
    let last = last.map_or(String::new(), |last_m| format!(", at the end {}", mm(last_m)));
    let before =
        before.map(|most_m| format!("Until {until} the tip was at most {} off its setpoint{last}.", mm(most_m)));
    let clearance = clearance_of(log, &outcomes);
    let is_close = clearance.as_ref().is_some_and(|card| card.alarming);
    let is_deep = least(&outcomes).is_some_and(|nearest| is_deep(log, nearest));
    let is_carried = log.contacts.iter().all(|contact| contact.carried);
    let clearance = clearance.map(|card| match (is_carried, is_deep, is_close) {
        (false, ..) => format!("The limb touched an obstacle: contact {}.", card.detail),
        (true, true, _) => format!("The limb touched an obstacle: {}.", card.detail),
        (true, false, true) => format!("Clearance {} {}.", card.value, card.detail),
        (true, false, false) => format!("Least clearance of the run: {} {}.", card.value, card.detail),
    });
    // A violated clearance belongs to the headline.
    let (headline, clearance) = match clearance {
        Some(violation) if is_close => (format!("{arrival} {violation}"), None),
        clearance => (arrival, clearance),
    };
    let grasp = grasped_off_goal(log, &outcomes);
    let first = summary.faults.first().map(rows::fault);
    let faults = first.map(|first| match summary.faults.len() {
        1 => format!("One fault: {first}."),
        count => format!("{count} faults, the first at {first}."),
    });
    let weightless = summary
        .weightless
        .then(|| "The run is weightless: the simulated limb carries neither its own weight nor a payload.".to_owned());
    let is_off = !off_goal.is_empty() || !summary.misses.is_empty();
    let alarming = is_close || is_off || unfinished.is_some() || !summary.faults.is_empty();
    let has_grasp = grasp.is_some();
    let sentences = [Some(headline), grasp, before, reason, clearance, faults, weightless];
    Verdict { sentences: sentences.into_iter().flatten().map(|text| unbroken(&text)).collect(), alarming, has_grasp }
}

/// Picks whose goal was missed and whose object was carried on.
fn grasped_off_goal(log: &RunLog, outcomes: &[Outcome<'_>]) -> Option<String> {
    if !log.info.simulated {
        return None;
    }
    let is_left = |object: &CarriedInfo| {
        let carried_s = object.from_s - 1e-6..=object.to_s.unwrap_or(f64::INFINITY) + 1e-6;
        let left = |fault: &FaultRecord| fault.code == FaultRecord::LEFT_BEHIND && carried_s.contains(&fault.time_s);
        log.faults.iter().any(left)
    };
    let off_goal = outcomes.iter().filter(|outcome| outcome.goal.is_some_and(|goal| !goal.is_hit()));
    let picks = off_goal.filter_map(|outcome| {
        let within_s = outcome.phase.start_s - 1e-6..=outcome.phase.end_s() + 1e-6;
        let mut taken = log.info.carried.iter().filter(|object| within_s.contains(&object.from_s));
        taken.find(|object| !is_left(object)).map(|object| (&outcome.phase.name, &object.name))
    });
    let picks: Vec<_> = picks.collect();
    let (phase, object) = picks.first()?;
    let phase = quoted(phase);
    let missed = match picks.len() {
        1 => format!("The limb missed its goal in {phase}"),
        count => format!("The limb missed its goal in {count} picks, first in {phase}"),
    };
    Some(format!(
        "{missed}, but {} was still carried: a simulated gripper takes its object wherever it closes.",
        quoted(object)
    ))
}

fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// A name of a scene file, set apart from the words of a sentence.
fn quoted(name: &str) -> String {
    format!("\u{201c}{name}\u{201d}")
}

/// The text with non-breaking spaces between numbers and their units.
fn unbroken(text: &str) -> String {
    const UNITS: [&str; 5] = ["mm", "%", "s", "N", "kPa"];
    let mut words = text.split(' ');
    let mut whole = words.next().unwrap_or_default().to_owned();
    for word in words {
        let unit = word.trim_end_matches(|letter: char| letter != '%' && !letter.is_alphanumeric());
        let is_unit = UNITS.contains(&unit) && whole.ends_with(|letter: char| letter.is_ascii_digit());
        whole.push(if is_unit { '\u{a0}' } else { ' ' });
        whole.push_str(word);
    }
    whole
}

/// A cause of the tip's error in words.
fn because(cause: Cause, part_m: f64, log: &RunLog) -> String {
    let words = match cause {
        Cause::Pressure => "by pressure tracking",
        Cause::Model if log.info.simulated => "because the simulated limb differs from the model",
        Cause::Model => "because the limb differs from its model",
        Cause::Sag => "by sag under weight",
    };
    format!("{} {words}", mm(part_m))
}

/// The run ended before its phases.
fn stopped(outcomes: &[Outcome<'_>], within: &Outcome<'_>, summary: &Summary) -> String {
    let finished = outcomes.iter().filter(|outcome| outcome.tip.is_some()).count();
    let hits = outcomes.iter().filter(|outcome| outcome.goal.is_some_and(|goal| goal.is_hit())).count();
    let judged = if hits > 0 { format!(", {hits} at their goals") } else { String::new() };
    let after = if summary.faults.is_empty() { "" } else { ", after a fault" };
    let (count, name, end_s) = (outcomes.len(), quoted(&within.phase.name), summary.duration_s);
    format!("The run ended at {end_s:.2} s in phase {name}{after}: {finished} of {count} phases finished{judged}.")
}

/// The largest error of the tip up to the first fault, or to the end.
fn largest_before(log: &RunLog, summary: &Summary) -> Option<f64> {
    let fault_s = summary.faults.first().map(|fault| fault.time_s);
    let scheduled = scheduled(log);
    let before = scheduled.iter().filter(|sample| fault_s.is_none_or(|fault_s| sample.time_s < fault_s));
    let errors = before.filter_map(|sample| Some(distance(sample.tip_achieved_m?, sample.tip_setpoint_m)));
    errors.filter(|error_m| error_m.is_finite()).reduce(f64::max)
}

/// Every phase ended at its goal, as far as one bounds the error.
fn hit(outcomes: &[Outcome<'_>], total_m: f64) -> String {
    let goals = match outcomes.iter().filter(|outcome| outcome.goal.is_some()).count() {
        0 => "No tolerance bounds the error".to_owned(),
        1 => "Hit the goal".to_owned(),
        count => format!("Hit all {count} goals"),
    };
    // The tip may be far from its setpoint in a region.
    let points = outcomes.iter().filter_map(|outcome| match outcome.goal? {
        GoalCheck::Point { error_m, .. } => Some((error_m, outcome.goal?.allowed()?)),
        GoalCheck::Region { .. } => None,
    });
    let (most_m, allowed) = points.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((total_m, String::new()));
    format!("{goals}: the tip ended at most {} off{allowed}.", mm(most_m))
}

/// Phases that ended off their goal, the farthest first. Those of one name and one kind of goal are one entry.
fn off(mut off_goal: Vec<&Outcome<'_>>, goals: usize) -> String {
    const NAMED: usize = 4;
    let beyond_m = |outcome: &Outcome<'_>| outcome.goal.map_or(0.0, |goal| goal.beyond_m());
    let is_alike = |one: &Outcome<'_>, other: &Outcome<'_>| {
        let regions = [one, other].map(|outcome| outcome.goal.and_then(|goal| goal.region()));
        one.phase.name == other.phase.name && regions[0] == regions[1]
    };
    off_goal.sort_by(|a, b| beyond_m(b).total_cmp(&beyond_m(a)));
    let mut groups: Vec<(&Outcome<'_>, usize)> = Vec::new();
    for outcome in &off_goal {
        match groups.iter_mut().find(|(first, _)| is_alike(first, outcome)) {
            Some((_, count)) => *count += 1,
            None => groups.push((outcome, 1)),
        }
    }
    // The tolerance, which all points share, follows the last of them.
    let (points, regions): (Vec<_>, Vec<_>) =
        groups.iter().take(NAMED).partition(|(first, _)| first.goal.is_some_and(|goal| goal.region().is_none()));
    let mut named: Vec<_> = points.iter().map(|group| off_in_words(group)).collect();
    if let Some(last) = named.last_mut() {
        *last += &points.iter().find_map(|(first, _)| first.goal?.allowed()).unwrap_or_default();
    }
    named.extend(regions.iter().map(|group| off_in_words(group)));
    let more: usize = groups.iter().skip(NAMED).map(|(_, count)| count).sum();
    named.extend((more > 0).then(|| format!("{more} more")));
    format!("Missed {} of {}: {}.", off_goal.len(), counted(goals, "goal"), named.join("; "))
}

/// The farthest of a group of phases, and the size of the group.
fn off_in_words((first, count): &(&Outcome<'_>, usize)) -> String {
    let distance = match first.goal {
        Some(GoalCheck::Region { name, outside_m }) => {
            format!("{} outside of region {}", mm(outside_m), quoted(name))
        }
        Some(GoalCheck::Point { error_m, .. }) => format!("{} off", mm(error_m)),
        None => String::new(),
    };
    let phase = quoted(&first.phase.name);
    match count {
        1 => format!("{phase}, {distance}"),
        count => format!("{phase} {count} times, at most {distance}"),
    }
}

impl<'a> GoalCheck<'a> {
    fn region(self) -> Option<&'a str> {
        match self {
            Self::Region { name, .. } => Some(name),
            Self::Point { .. } => None,
        }
    }

    /// By how much the tip has missed its goal, m; negative where it has not.
    fn beyond_m(self) -> f64 {
        match self {
            Self::Point { error_m, tolerance_m } => error_m - tolerance_m,
            Self::Region { outside_m, .. } => outside_m,
        }
    }

    /// The tolerance of a point, behind its error.
    fn allowed(self) -> Option<String> {
        let Self::Point { tolerance_m, .. } = self else { return None };
        Some(format!(" (allowed {}, {:.0} % of the limb's length)", mm(tolerance_m), 1e2 * TOLERANCE))
    }
}

fn missed(first: &Miss, others: usize) -> String {
    let Miss { module, phase, share_of_travel } = first;
    let more = match others {
        0 => String::new(),
        count => format!(" Misses besides: {count}."),
    };
    format!(
        "Module {module} missed its setpoint at the end of {} by {:.0} % of its travel.{more}",
        quoted(phase),
        1e2 * share_of_travel
    )
}

/// The answers of a run.
pub(super) fn cards(log: &RunLog, summary: &Summary) -> Vec<Card> {
    let outcomes = outcomes(log);
    let cards = [tip(log, &outcomes, summary), clearance_card(log, &outcomes), pressure(summary), faults(summary)];
    let whole = |card: Card| Card { value: unbroken(&card.value), detail: unbroken(&card.detail), ..card };
    cards.into_iter().flatten().map(whole).collect()
}

fn tip(log: &RunLog, outcomes: &[Outcome<'_>], summary: &Summary) -> Option<Card> {
    let title = "Tip error";
    let Some(error) = summary.tip.error_m else {
        let error = summary.tip.tracking_error_m?;
        let detail = "RMSE by pressure tracking alone; no observer measured the limb".to_owned();
        return Some(Card { title, value: mm(error.rmse), detail, alarming: false });
    };
    let Some((outcome, causes, total_m)) = worst(outcomes) else {
        let before = largest_before(log, summary).filter(|_| outcomes.iter().any(|outcome| outcome.tip.is_none()));
        let (value_m, detail) = match (before, summary.tip.final_error_m.filter(|_| !summary.faults.is_empty())) {
            (Some(most_m), Some(last_m)) => {
                (last_m, format!("at the end, at most {} until the first fault; no phase finished", mm(most_m)))
            }
            (Some(most_m), None) => (most_m, "largest; no phase finished".to_owned()),
            (None, _) => (error.rmse, "RMSE over the run".to_owned()),
        };
        return Some(Card { title, value: mm(value_m), detail, alarming: before.is_some() });
    };
    let most =
        causes.sorted().first().map_or(String::new(), |&(cause, part_m)| format!("; {}", because(cause, part_m, log)));
    let detail = format!("largest at the end of a phase: {}{most}", quoted(&outcome.phase.name));
    let alarming = outcomes.iter().any(|outcome| outcome.goal.is_some_and(|goal| !goal.is_hit()));
    Some(Card { title, value: mm(total_m), detail, alarming })
}

/// The phase with the largest error at its end.
fn worst<'a, 'b>(outcomes: &'a [Outcome<'b>]) -> Option<(&'a Outcome<'b>, Causes, f64)> {
    let ends = outcomes.iter().filter_map(|outcome| Some((outcome, outcome.tip?, outcome.tip?.total_m?)));
    ends.filter(|(_, _, total_m)| total_m.is_finite()).max_by(|a, b| a.2.total_cmp(&b.2))
}

/// Time that a reader looks at first, s: the end of the phase with the largest error, or the first fault.
pub(super) fn telling_s(log: &RunLog) -> Option<f64> {
    let end_s = worst(&outcomes(log)).map(|(outcome, ..)| outcome.phase.end_s());
    end_s.or_else(|| log.faults.first().map(|fault| fault.time_s)).filter(|time_s| time_s.is_finite())
}

/// The least observed clearance.
fn least<'a>(outcomes: &'a [Outcome<'_>]) -> Option<&'a NearestInfo> {
    let seen = outcomes.iter().filter_map(|outcome| outcome.nearest.as_ref());
    seen.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
}

/// The least clearance beside that of the plan, where there are obstacles.
fn clearance_of(log: &RunLog, outcomes: &[Outcome<'_>]) -> Option<Card> {
    let title = "Clearance";
    // The planned clearance counts only as far as the run came.
    let end_s = log.samples.last().map_or(f64::INFINITY, |sample| sample.time_s);
    let planned = outcomes.iter().filter_map(|outcome| outcome.phase.nearest.as_ref());
    let planned = planned.filter(|nearest| nearest.time_s <= end_s);
    let planned = planned.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    let required = log.info.clearance_m.map_or(String::new(), |required_m| format!(", required {}", mm(required_m)));
    let Some(seen) = least(outcomes) else {
        let planned = planned?;
        let detail = format!("planned, from {} at {:.2} s{required}; not observed", planned.obstacle, planned.time_s);
        return Some(Card { title, value: mm(planned.distance_m), detail, alarming: false });
    };
    let plan = planned.map_or(String::new(), |planned| format!("planned {}", mm(planned.distance_m)));
    let beside_required = log.info.clearance_m.map(|required_m| to_required(seen.distance_m, required_m));
    let is_below = log.info.clearance_m.is_some_and(|required_m| seen.distance_m < required_m);
    // A carried object may touch its support when it is picked up and put down. Contact of the limb itself raises the alarm.
    let limb = log.contacts.iter().filter(|contact| !contact.carried);
    let pressed = limb.max_by(|a, b| a.force_n.total_cmp(&b.force_n));
    // Without contact, the place of the least clearance names the required one already.
    let is_named = pressed.is_none() && !is_deep(log, seen);
    let required = if is_named { "" } else { required.trim_start_matches(", ") };
    let beside = [plan, required.to_owned()];
    let beside = beside.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(", ");
    let beside = if beside.is_empty() { beside } else { format!("; {beside}") };
    let place = format!("{} at {:.2} s", seen.obstacle, seen.time_s);
    let (value, detail) = match (pressed, is_deep(log, seen)) {
        (Some(pressed), false) => ("contact".to_owned(), format!("{}{beside}", rows::contact(pressed))),
        (Some(pressed), true) => {
            let deep = format!("{} deep in {place}", mm(-seen.distance_m));
            ("contact".to_owned(), format!("{}; {deep}{beside}", rows::contact(pressed)))
        }
        (None, true) => ("contact".to_owned(), format!("{} deep in {place}{beside}", mm(-seen.distance_m))),
        (None, false) => {
            let required = beside_required.map_or(String::new(), |required| format!(", {required}"));
            (mm(seen.distance_m), format!("from {place}{required}{beside}"))
        }
    };
    let alarming = pressed.is_some() || seen.distance_m <= 0.0 || is_below;
    Some(Card { title, value, detail, alarming })
}

/// A distance beside the required clearance in words, with as many digits as tell the two apart.
fn to_required(distance_m: f64, required_m: f64) -> String {
    let digits = if distance_m != required_m && number_mm(distance_m) == number_mm(required_m) { 3 } else { 1 };
    let side = match distance_m.total_cmp(&required_m) {
        Ordering::Less => "below",
        Ordering::Equal => "equal to",
        Ordering::Greater => "above",
    };
    format!("{side} the required {:.digits$} mm", 1e3 * required_m)
}

/// Whether the limb is in an obstacle. A surface that stops it gives a little; between two places with contact it may be deeper.
fn is_deep(log: &RunLog, nearest: &NearestInfo) -> bool {
    nearest.distance_m <= if log.contacts.is_empty() { 0.0 } else { -GIVES_M }
}

fn clearance_card(log: &RunLog, outcomes: &[Outcome<'_>]) -> Option<Card> {
    let is_free = !log.info.solids.iter().any(|solid| !solid.region);
    let free = || Card {
        title: "Clearance",
        value: "no obstacles".to_owned(),
        detail: "in the scene".to_owned(),
        alarming: false,
    };
    // A log without a scene says nothing of obstacles.
    clearance_of(log, outcomes).or_else(|| (is_free && log.info.limb.is_some()).then(free))
}

fn pressure(summary: &Summary) -> Option<Card> {
    let kpa = |pressure_pa: f64| format!("{:.2} kPa", pressure_pa * 1e-3);
    let sensor = summary.pressure.measured_error_pa?;
    let (value, detail) = match summary.pressure.true_error_pa {
        Some(chamber) => (
            kpa(chamber.rmse),
            format!(
                "RMSE of all chambers from their references until venting; largest {}. Of their sensors, which flowing air disturbs: {}, largest {}",
                kpa(chamber.max),
                kpa(sensor.rmse),
                kpa(sensor.max)
            ),
        ),
        None => (kpa(sensor.rmse), format!("RMSE of all channels, sensor from reference; largest {}", kpa(sensor.max))),
    };
    Some(Card { title: "Pressure error", value, detail, alarming: false })
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
    let end_s = log.samples.last().map_or(0.0, |sample| sample.time_s);
    let row = |outcome: &Outcome<'_>| {
        let (phase, tip) = (outcome.phase, outcome.tip);
        let part = |part: Option<f64>| part.filter(|part| part.is_finite()).map_or(String::new(), number_mm);
        let near = |near: &Option<NearestInfo>| {
            near.as_ref().map_or(String::new(), |near| {
                unbroken(&format!("{} from {} at {:.2} s", mm(near.distance_m), near.obstacle, near.time_s))
            })
        };
        let is_missed = outcome.goal.is_some_and(|goal| !goal.is_hit());
        let is_below = log.info.clearance_m.zip(outcome.nearest.as_ref());
        let is_below = is_below.is_some_and(|(required_m, nearest)| nearest.distance_m < required_m);
        PhaseRow {
            name: phase.name.clone(),
            start: format!("{:.2}", phase.start_s),
            motion: format!("{:.2}", phase.move_s),
            hold: format!("{:.2}", phase.hold_s),
            gripper: phase.gripper.clone().unwrap_or_default(),
            goal: match (outcome.goal, tip) {
                (Some(goal), _) => {
                    if goal.is_hit() {
                        "hit"
                    } else {
                        "missed"
                    }
                }
                (None, None) if phase.start_s > end_s => "not begun",
                (None, None) => "not finished",
                (None, Some(_)) => "",
            },
            error: part(tip.and_then(|tip| tip.total_m)),
            pressure: part(tip.and_then(|tip| tip.pressure_m)),
            model: part(tip.and_then(|tip| tip.model_m)),
            sag: part(tip.and_then(|tip| tip.sag_m)),
            swing: part(outcome.swing_m),
            swing_planned: part(phase.swing.map(|swing| swing.residual_m)),
            planned: near(&phase.nearest),
            achieved: near(&outcome.nearest) + if is_below { ", below required" } else { "" },
            alarming: is_missed || is_below,
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
