//! Diagnostics of a scene that the limb cannot follow: the words for what planning returns, at the line.
//!
//! A goal of the tip and a way to it get a search of their own, for the demand that cannot be met and the nearest that can.

use fra_model::StateQuantity;
use nalgebra::Vector3;

use super::air::Bottleneck;
use super::carrier::Carrier;
use super::corrections::check_corrections;
use super::goal::{pressures, shapes, tip_task, values};
use super::inverse_kinematics::{Obstruction, Reach, TipGoal, TipTask, angle, misses, solutions_of};
use super::payload::carried;
use super::plan::Plan;
use super::route::{approach, ranges, route};
use super::schedule::planning_space;
use super::sent::Sent;
use super::setpoint::NoState;
use super::space::{Hindrance, Space};
use super::timing::rate_max;
use super::unreachable::{Shortcoming, Unreachable};
use super::upright::Upright;
use super::weight::{self, Margins, PoseError, Swing, Vibrations};
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Corrections, Goal, Phase, Scene, SceneError, Shaping, Span};

/// Most points near a goal to which a way is searched.
const POINTS: usize = 3;
/// A point that is farther away by less than this, m, is as near.
const SAME_M: f64 = 1e-4;
/// Largest vertical component of the base direction of a hanging limb.
const HANGS: f64 = -0.9;
/// A pressure within this fraction of an end of its range is at that end.
const AT_END: f64 = 1e-6;

/// Plans all phases of a scene.
///
/// # Errors
/// A diagnostic at the target, way-point, duration or obstacle that the limb cannot follow or keep clear of, or cannot under its weight,
/// with the nearest that it can.
pub fn plan(scene: &Scene, limb: &Limb) -> Result<Plan, SceneError> {
    let words = Words { scene, limb };
    let (mut plan, shortcomings) = super::plan::plan(scene, limb).map_err(|why| words.diagnostic(&why))?;
    plan.warnings = shortcomings.iter().map(|one| words.warning(one)).collect();
    Ok(plan)
}

/// The statics of a scene's limb at rest; `None` where it is moved without load.
///
/// # Errors
/// A diagnostic of a limb that does not stand.
pub(super) fn tier_at_rest(scene: &Scene, limb: &Limb) -> Result<Option<Fidelity>, SceneError> {
    let Some(weight) = scene.weight().filter(|weight| weight.compensated) else { return Ok(None) };
    let judged = weight::Judged::at_rest(scene, limb, weight.error);
    judged.map(|judged| Some(judged.tier)).map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// Checks that a limb may be moved from rest.
///
/// # Errors
/// A diagnostic at the obstacle that is too near.
pub(super) fn jog_start(scene: &Scene, limb: &Limb, tier: Option<Fidelity>) -> Result<(), SceneError> {
    let rest: Vec<f64> = limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect();
    let clear = super::clear::start(scene, &planning_space(scene, limb, 0, tier), &rest);
    clear.map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// Margins at the end of each phase of a plan with its setpoints as they are sent; none of a limb without weight. Corrections count by the
/// mean of a module's actuators, and in its highest pressure.
///
/// # Errors
/// A diagnostic at the phase in which the limb falls or a tube buckles, empty or loaded.
pub fn margins(scene: &Scene, limb: &Limb, plan: &Plan, sent: &Sent) -> Result<Vec<Margins>, SceneError> {
    weight::margins(scene, limb, plan, sent).map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// Natural vibrations at the end of each phase of a plan, and the swing that its move leaves; none of a limb whose setpoints are not corrected for
/// weight.
///
/// # Errors
/// A diagnostic at the phase in which the limb falls.
pub fn swings(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Vec<Swing>, SceneError> {
    weight::swings(scene, limb, plan).map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// Natural vibrations in all poses at the ends of moves and, where a mass changes hands, of holds; none of a limb whose setpoints are not corrected for weight.
///
/// # Errors
/// A diagnostic at the phase in which the limb falls.
pub fn vibrations(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Vec<Vibrations>, SceneError> {
    weight::vibrations(scene, limb, plan).map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// The setpoints of a plan as they are sent: with the corrections of its scene.
///
/// # Errors
/// A diagnostic at the file of corrections that are larger than what a module has, or at the phase in which a corrected setpoint leaves what
/// the limb can reach.
pub fn sent(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Sent, SceneError> {
    let Some(corrections) = scene.corrections() else { return Ok(Sent::uncorrected(limb, plan)) };
    let corrections = corrections.over(&plan.phase_times());
    check_corrections(limb, &corrections).map_err(|why| Words { scene, limb }.diagnostic(&why))?;
    corrected(scene, limb, plan, &corrections)
}

/// The setpoints of a plan with corrections, which end where the range of a module ends.
///
/// # Errors
/// A diagnostic at the phase in which a corrected setpoint leaves what the limb can reach.
pub fn corrected(scene: &Scene, limb: &Limb, plan: &Plan, corrections: &Corrections) -> Result<Sent, SceneError> {
    Sent::corrected(limb, plan, corrections).map_err(|why| Words { scene, limb }.diagnostic(&why))
}

/// A setpoint with its unit.
pub(super) fn in_units(kind: StateQuantity, value: f64) -> String {
    let (unit, decimals) = (kind.display_unit(), kind.display_decimals());
    format!("{:.decimals$} {unit}", value * kind.display_scale()).trim_end().to_owned()
}

struct Words<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
}

impl Words<'_> {
    fn diagnostic(&self, why: &Unreachable) -> SceneError {
        match why {
            Unreachable::AtRest(by) => self.at_rest(by),
            Unreachable::Target { phase, target, cause } => self.target(*phase, *target, cause),
            Unreachable::TooNear { phase, by, fraction } => {
                let help = format!("on the straight way there the limb gets {:.0} % far", (fraction * 100.0).floor());
                let title = format!("at this goal the limb is too near `{}`", self.obstacle(by.obstacle));
                self.at(self.goal_span(*phase), &title, &self.too_near(by), Some(&help))
            }
            Unreachable::Tip { phase, before, upright, nearest } => self.tip(*phase, before, *upright, nearest),
            Unreachable::Marker { phase, position, nearest } => {
                let label = format!("position {} of the series: {}", position + 1, missed(nearest));
                let help = nearest_point(nearest);
                self.at(self.goal_span(*phase), "the limb cannot follow this series", &label, Some(&help))
            }
            Unreachable::NoWay { phase, from, to, upright } => self.no_way(*phase, from, to, *upright),
            Unreachable::NoSupply { phase } => {
                let title = "the supply does not suffice for this move, however slow";
                let label = "it needs more air at this pressure than reservoir and pump give";
                let help = "lower the pressures, or take a stronger supply";
                self.at(self.phase(*phase).span, title, label, Some(help))
            }
            Unreachable::MoveRate { phase, module, rate, limit, enough_s } => {
                let span = self.phase(*phase).move_us.as_ref().map_or(self.phase(*phase).span, |given| given.span);
                let help = format!("a duration of {:.2} s is enough", (enough_s * 100.0 - 1e-6).ceil() / 100.0);
                self.at(span, "this move is too fast", &self.rate(*module, *rate, *limit), Some(&help))
            }
            Unreachable::SeriesRate { phase, module, rate, limit, time_us } => {
                let label = format!("{:.2} s into the series {}", seconds(*time_us), self.rate(*module, *rate, *limit));
                self.at(self.goal_span(*phase), "this series is too fast", &label, None)
            }
            Unreachable::OnTheWay { phase, module, cause } => {
                let title = "on the way to its goal this phase leaves the reach of the limb";
                self.at(self.phase(*phase).span, title, &no_state(cause, self.module(*module)), None)
            }
            Unreachable::PassesTooNear { phase, time_us, by } => {
                let title = "on the way to its goal this phase comes too near an obstacle";
                let label = by.as_ref().map_or("the limb has no shape here".to_owned(), |by| self.too_near(by));
                let label = format!("{:.2} s into the run {label}", seconds(*time_us));
                self.at(self.phase(*phase).span, title, &label, None)
            }
            Unreachable::Tilts { phase, time_us, tilt_rad } => self.tilts(*phase, *time_us, *tilt_rad),
            Unreachable::NotCarried { phase, time_us, cause } => self.not_carried(*phase, Some(*time_us), *cause),
            Unreachable::Uncertain { phase, error } => self.uncertain(*phase, *error),
            Unreachable::UnderLoad { phase, nearest } => self.under_load(*phase, nearest),
            Unreachable::Swings { phase, worst_m, way_m, enough_s } => {
                self.swings(*phase, (*worst_m, *way_m), *enough_s)
            }
            Unreachable::Correction { time_s, module, value } => self.correction(*time_s, *module, *value),
        }
    }

    fn warning(&self, shortcoming: &Shortcoming) -> String {
        match shortcoming {
            Shortcoming::TooFast { phase, because, enough_s } => {
                let (because, name) = (self.bottleneck(*because), &self.phase(*phase).name.value);
                let enough = match enough_s {
                    Some(enough_s) => format!("{enough_s:.2} s would keep a reserve"),
                    None => "no duration is enough".to_owned(),
                };
                format!("phase `{name}` is faster than {because} can follow: {enough}")
            }
            Shortcoming::HandedTooFast { phase, because, enough_s } => {
                let (because, name) = (self.bottleneck(*because), &self.phase(*phase).name.value);
                let enough = match enough_s {
                    Some(enough_s) => format!("a `hold` of {enough_s:.2} s would keep a reserve"),
                    None => "no `hold` is enough".to_owned(),
                };
                format!(
                    "in the pause of phase `{name}` its load changes hands faster than {because} can follow: {enough}"
                )
            }
            Shortcoming::Off { phase, distance_m } => {
                let (name, off_mm) = (&self.phase(*phase).name.value, 1e3 * distance_m);
                format!(
                    "phase `{name}`: under load the tip stays {off_mm:.1} mm from where its targets have it without, because three modules hold a tip and the limb has fewer; `compensated = false` in [weight] keeps the targets"
                )
            }
            Shortcoming::Statics { error, allowed } => {
                let [error, most] = [error, allowed].map(|error| 100.0 * error);
                format!(
                    "the tip under weight is known to {error:.2} % of the limb's length only, by the finest model there is; `error` of [weight] is {most} %"
                )
            }
        }
    }

    /// What a move waits for.
    fn bottleneck(&self, because: Bottleneck) -> String {
        match because {
            Bottleneck::Rate(drive) => {
                let drive = self.limb.drive(drive);
                let limit = rate_max(self.scene.limits(), drive.kind).unwrap_or_default();
                format!("the rate of `{}`, {}/s at most", drive.name(), in_units(drive.kind, limit))
            }
            Bottleneck::Valve(drive) => format!("the valves of `{}`", self.limb.drive(drive).name()),
            Bottleneck::Supply => "the supply".to_owned(),
        }
    }

    fn at(&self, span: Span, title: &str, label: &str, help: Option<&str>) -> SceneError {
        self.scene.diagnostic(span, title, label, help)
    }

    fn phase(&self, index: usize) -> &Phase {
        &self.scene.phases()[index]
    }

    fn module(&self, index: usize) -> &LimbModule {
        &self.limb.modules()[index]
    }

    fn obstacle(&self, index: usize) -> &str {
        &self.scene.obstacles()[index].name.value
    }

    /// The place of a phase's goal.
    fn goal_span(&self, index: usize) -> Span {
        Self::goal_span_of(self.phase(index))
    }

    fn goal_span_of(phase: &Phase) -> Span {
        match &phase.goal {
            Goal::Targets(targets) => targets.first().map_or(phase.span, |target| target.value.span),
            Goal::Tip(tip) => tip.span,
            Goal::Inside(region) => region.span,
            Goal::Series(span) => *span,
        }
    }

    fn too_near(&self, by: &Obstruction) -> String {
        self.near(by.obstacle, by.clearance.distance_m)
    }

    /// The distance from an obstacle, and the allowed one.
    fn near(&self, obstacle: usize, distance_m: f64) -> String {
        let name = self.obstacle(obstacle);
        let allowed = format!("`clearance` is {:.1} mm", self.scene.limits().clearance_m * 1e3);
        if distance_m < 0.0 {
            format!("the limb would be {:.1} mm deep in `{name}`; {allowed}", -distance_m * 1e3)
        } else {
            format!("the limb would be {:.1} mm from `{name}`; {allowed}", distance_m * 1e3)
        }
    }

    fn rate(&self, module: usize, rate: f64, limit: f64) -> String {
        let module = self.module(module);
        let (rate, limit) = (in_units(module.kind, rate), in_units(module.kind, limit));
        format!("`{}` would move at up to {rate}/s; the limit is {limit}/s", module.name)
    }

    fn at_rest(&self, by: &Obstruction) -> SceneError {
        let [x, y, z] = <[f64; 3]>::from(by.clearance.point_m).map(|v| v * 1e3);
        let help = format!(
            "the nearest point of the limb's centre line is [\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]; the obstacle must be {:.1} mm farther away",
            (self.scene.limits().clearance_m - by.clearance.distance_m) * 1e3
        );
        let span = self.scene.obstacles()[by.obstacle].span;
        self.at(span, "the limb at rest is too near this obstacle", &self.too_near(by), Some(&help))
    }

    fn target(&self, phase: usize, target: usize, cause: &NoState) -> SceneError {
        let phase = self.phase(phase);
        let target = match &phase.goal {
            Goal::Targets(targets) => targets.get(target),
            _ => None,
        };
        let Some(target) = target else { return self.at(phase.span, "this target is out of reach", "", None) };
        let module = self.module(target.module);
        let (rest, most) = module.range();
        let help = format!(
            "between rest and {:.2} kPa it reaches {} to {}",
            module.curve.pressure_max_pa() * 1e-3,
            in_units(module.kind, rest),
            in_units(module.kind, most)
        );
        let title = "this target is out of the module's reach";
        self.at(target.value.span, title, &no_state(cause, module), Some(&help))
    }

    fn correction(&self, time_s: f64, module: usize, value: f64) -> SceneError {
        let module = self.module(module);
        let (rest, last) = module.range();
        let title = format!("the correction of `{}` at {time_s} s of the run is larger than its range", module.name);
        let [value, rest, last] = [value, rest, last].map(|value| in_units(module.kind, value));
        let label = format!("{value} here, and setpoints are from {rest} to {last}");
        let help = "corrections are in m, rad or Pa, as `softlimb learn --csv` writes them";
        let span = self.scene.corrections().map_or_else(|| self.phase(0).span, |corrections| corrections.span);
        self.at(span, &title, &label, Some(help))
    }

    /// The object that a phase carries or takes, its tilt, and the allowed one.
    fn tilt(&self, phase: usize, tilt_rad: f64) -> String {
        let object = self.phase(phase).object.map(|index| &self.scene.objects()[index]);
        let name = object.map_or("the object", |object| object.name.value.as_str());
        let most_rad = object.map_or(f64::INFINITY, |object| object.tilt_max_rad);
        let [tilt_deg, most_deg] = [tilt_rad, most_rad].map(f64::to_degrees);
        format!("`{name}` would tilt by {tilt_deg:.1} deg since it was grasped; its `tilt_max` is {most_deg:.1} deg")
    }

    /// A move that leaves too much swing; a duration, s, would be enough.
    fn swings(&self, phase: usize, (worst_m, way_m): (f64, f64), enough_s: Option<f64>) -> SceneError {
        let phase = self.phase(phase);
        let span = phase.move_us.as_ref().map_or_else(|| Self::goal_span_of(phase), |given| given.span);
        let limit_mm = self.scene.swing().residual_max_m.map_or(0.0, |limit| 1e3 * *limit);
        let percent =
            if way_m > 0.0 { format!(", {:.1} % of its way", 100.0 * worst_m / way_m) } else { String::new() };
        let label = format!(
            "afterwards the tip swings by {:.2} mm{percent}; `residual_max` is {limit_mm:.2} mm",
            1e3 * worst_m
        );
        let enough = enough_s.map(|time_s| format!("a duration of {time_s:.2} s is enough"));
        let is_series = matches!(phase.goal, Goal::Series(_));
        let shapes =
            (self.scene.swing().shaping == Shaping::None && !is_series).then(|| "`shaping = \"zvd\"` helps".to_owned());
        let stretches = enough_s.filter(|_| !is_series).map(|_| "`excess = \"stretch\"` takes it".to_owned());
        let help: Vec<String> = enough.into_iter().chain(stretches).chain(shapes).collect();
        let help = (!help.is_empty()).then(|| help.join("; "));
        self.at(span, "this move leaves too much swing", &label, help.as_deref())
    }

    /// A held object that tilts too much at a time of the run, or at the goal of a phase.
    fn tilts(&self, phase: usize, time_us: Option<u64>, tilt_rad: f64) -> SceneError {
        let tilt = self.tilt(phase, tilt_rad);
        let help = "grasp it with the end effector turned half the way (`direction` of the phase that closes the gripper), \
                    move the goal, or allow more `tilt_max`";
        match time_us {
            Some(time_us) => {
                let label = format!("{:.2} s into the run {tilt}", seconds(time_us));
                self.at(
                    self.phase(phase).span,
                    "on the way to its goal this phase tilts its object too much",
                    &label,
                    Some(help),
                )
            }
            None => {
                let title = "the tip gets there, but its object tilts too much";
                self.at(self.goal_span(phase), title, &format!("as far as was found {tilt}"), Some(help))
            }
        }
    }

    /// A limb that falls at a time of the run, or at the pressures of a goal.
    fn not_carried(&self, phase: usize, time_us: Option<u64>, cause: PoseError) -> SceneError {
        let when = match time_us {
            Some(time_us) => format!("{:.2} s into the run", seconds(time_us)),
            None => "at the pressures of this goal".to_owned(),
        };
        let label = match cause {
            PoseError::NoEquilibrium => format!("{when} an actuator has no equilibrium"),
            PoseError::EquilibriumError(lost) => format!("{when} {lost}"),
            PoseError::Buckles { module, ratio } => {
                let (name, percent) = (&self.module(module).name, 100.0 * ratio);
                format!(
                    "{when} a tube of `{name}` carries {percent:.0} % of the load that it buckles at between two plates"
                )
            }
        };
        let title = match time_us {
            Some(0) if carried(self.scene.phases()).first().is_some_and(|first| first.moved.payload_kg > 0.0) => {
                "the limb does not carry its load at rest"
            }
            Some(0) => "the limb does not carry its own weight at rest",
            _ => "the limb does not carry its load in this phase",
        };
        self.at(self.phase(phase).span, title, &label, Some(&self.stiffer()))
    }

    /// Advice for a larger load capacity.
    fn stiffer(&self) -> String {
        let hangs = self.scene.limb().base_direction[2] < HANGS;
        let plain = self.scene.modules().iter().any(|module| module.actuators > 1 && module.spacers == 0);
        let hang = if hangs { "" } else { "let it hang (`base_direction`), or " };
        let more = if plain { "" } else { "more " };
        format!(
            "{hang}give its modules {more}`spacers`, or make it lighter or stiffer; `softlimb design limb` sizes a limb for its load"
        )
    }

    fn uncertain(&self, phase: usize, error: f64) -> SceneError {
        let label = format!("the finest statics knows the tip to {:.1} % of the limb's length", 100.0 * error);
        let help = "take a smaller payload, or a stiffer limb; `softlimb payload capacity` tells the largest";
        self.at(self.phase(phase).span, "the limb deforms too far under its load in this phase", &label, Some(help))
    }

    fn under_load(&self, phase: usize, nearest: &Reach) -> SceneError {
        // Coarse rods may stand where fine ones fall.
        let falls = |tier: &Fidelity| {
            let space = planning_space(self.scene, self.limb, phase, Some(*tier));
            space.carrier().falls(&nearest.pressures_pa)
        };
        if !nearest.distance_m.is_finite()
            && let Some(cause) = Fidelity::CHOICE[1..].iter().find_map(falls)
        {
            return self.not_carried(phase, None, cause);
        }
        let span = self.goal_span(phase);
        let ends = self.limb.drives().zip(&nearest.pressures_pa);
        let ends = ends.map(|(drive, pressure)| (drive.name(), pressure / drive.single_valued_max_pa()));
        let ends: Vec<String> = ends
            .filter_map(|(name, fraction)| match fraction {
                low if low < AT_END => Some(format!("`{name}` is at its lowest pressure, 0")),
                high if high > 1.0 - AT_END => Some(format!("`{name}` is at its highest pressure")),
                _ => None,
            })
            .collect();
        let because =
            if ends.is_empty() { "no pressures of its modules move the tip there".to_owned() } else { ends.join(", ") };
        let sizes = "`softlimb payload capacity` prints the largest load, `softlimb design limb` sizes a limb for it";
        let (label, help) = if nearest.distance_m.is_finite() {
            (format!("under its load {}: {because}", missed(nearest)), format!("{}; {sizes}", nearest_point(nearest)))
        } else {
            (format!("under its load {}", missed(nearest)), sizes.to_owned())
        };
        self.at(span, "the limb cannot reach this goal under its load", &label, Some(&help))
    }

    /// The space that a phase is planned in, with the statics that nearly any limb needs.
    fn space(&self, phase: usize, upright: Option<Upright>) -> Space<'_> {
        let compensated = self.scene.weight().is_some_and(|weight| weight.compensated);
        planning_space(self.scene, self.limb, phase, compensated.then_some(Fidelity::Linear)).keeping(upright)
    }

    /// Finds the demand on the tip that cannot be met. `nearest` is the best with all of them.
    fn tip(&self, phase: usize, before: &[f64], upright: Option<Upright>, nearest: &Reach) -> SceneError {
        let shapes = shapes(self.scene);
        let span = self.goal_span(phase);
        let space = self.space(phase, upright);
        let Some(task) = tip_task(self.scene, self.phase(phase), &space, &shapes) else {
            return self.at(span, "the limb cannot reach this goal", &missed(nearest), None);
        };
        let start = pressures(self.limb, before);
        WhyNot { words: self, space: &space, task, phase, span, before, start: &start }.diagnostic(nearest)
    }

    /// The obstacle on the straight way to a goal, the greatest clearance with a way, and the nearest point with one.
    fn no_way(&self, phase: usize, from: &[f64], to: &[f64], upright: Option<Upright>) -> SceneError {
        let space = self.space(phase, upright);
        let label = space.blocked(from, to).map_or(String::new(), |blocked| {
            let why = match blocked.by {
                Hindrance::Obstacle(by) => self.too_near(&by),
                Hindrance::Tilt(tilt_rad) => self.tilt(phase, tilt_rad),
                Hindrance::NoShape => return String::new(),
            };
            format!("straight, {:.0} % of the way, {why}; no way around was found", blocked.share * 100.0)
        });
        let ranges = ranges(self.limb);
        let possible = |clearance_m: f64| {
            let other = self.space(phase, upright).requiring(clearance_m);
            route(&other, &ranges, from, to).is_some()
        };
        // Quarters of what is asked for: finer steps would take long and say little more.
        let required_m = self.scene.limits().clearance_m;
        let mut quarters = [0.75, 0.5, 0.25, 0.0].into_iter().map(|share| share * required_m);
        let widest = quarters.find(|m| *m < required_m && possible(*m));
        let smaller = widest.map(|m| format!("with a `clearance` of \"{:.2} mm\" there is a way", m * 1e3));
        let nearer = self.nearest_with_way(&space, phase, from);
        let helps: Vec<String> = smaller.into_iter().chain(nearer).collect();
        let help = (!helps.is_empty()).then(|| helps.join("; "));
        let title = "the limb finds no way to this goal that keeps clear";
        self.at(self.phase(phase).span, title, &label, help.as_deref())
    }

    /// The point nearest to the goal of a phase that has a way; `None` for a phase without a goal of the tip.
    fn nearest_with_way(&self, space: &Space<'_>, phase: usize, before: &[f64]) -> Option<String> {
        let shapes = shapes(self.scene);
        let task = tip_task(self.scene, self.phase(phase), space, &shapes)?;
        let (distance_m, tip_m) = approached(space, &task, before)?;
        Some(format!("the nearest point that a way was found to is {}", away(tip_m, distance_m)))
    }
}

fn seconds(time_us: u64) -> f64 {
    time_us as f64 * 1e-6
}

fn no_state(cause: &NoState, module: &LimbModule) -> String {
    let kpa = |pa: f64| format!("{:.2} kPa", pa * 1e-3);
    let allowed = kpa(module.reference_max_pa);
    let limit = kpa(module.pressure_max_pa);
    match cause {
        NoState::Invalid(message) => message.clone(),
        NoState::BeyondLimit(Some(limit)) => format!("beyond the limit point of `{}` at {}", module.name, kpa(*limit)),
        NoState::BeyondLimit(None) => format!("`{}` reaches this at no pressure", module.name),
        NoState::NotConverged => format!("the model finds no state of `{}` for this", module.name),
        NoState::Vacuum(pressure) => {
            format!("`{}` would need {}: a vacuum, which the valves cannot make", module.name, kpa(*pressure))
        }
        NoState::OverPressure(pressure) if kpa(*pressure) == allowed => format!(
            "`{}` would need more than {allowed}; the device follows up to this, a margin below `pressure_max` of {limit}",
            module.name
        ),
        NoState::OverPressure(pressure) => {
            format!(
                "`{}` would need {}; the device follows up to {allowed}, a margin below `pressure_max` of {limit}",
                module.name,
                kpa(*pressure)
            )
        }
    }
}

/// A goal of the tip that was not reached.
struct WhyNot<'a> {
    words: &'a Words<'a>,
    /// The planner's space.
    space: &'a Space<'a>,
    task: TipTask<'a>,
    phase: usize,
    span: Span,
    /// Setpoints at the start of the move, and their pressures, Pa.
    before: &'a [f64],
    start: &'a [f64],
}

impl WhyNot<'_> {
    /// Drops one demand after the other to find the one that cannot be met. `nearest` is the best with all of them.
    fn diagnostic(&self, nearest: &Reach) -> SceneError {
        let (words, carrier, start) = (self.words, self.space.carrier(), self.start);
        let place = TipTask { aim: None, upright: None, obstacles: &[], ..self.task };
        let free = solutions_of(carrier, &place, start);
        if !free[0].reached() && carrier.is_loaded() {
            return words.under_load(self.phase, &free[0]);
        }
        if !free[0].reached() {
            let title = match self.task.goal {
                TipGoal::Point(_) => "the limb cannot reach this way-point",
                TipGoal::Inside(_) => "the limb cannot reach into this region",
            };
            let help = self.offer(&free[0], "reachable point");
            return words.at(self.span, title, &missed(&free[0]), Some(&help));
        }
        if let Some(aim) = self.task.aim {
            let task = TipTask { upright: None, obstacles: &[], ..self.task };
            let pointed = solutions_of(carrier, &task, start).swap_remove(0);
            if !pointed.reached() {
                let off = |reach: &Reach| direction_off(carrier, reach, *aim.direction);
                let least = free.iter().map(off).fold(f64::INFINITY, f64::min).to_degrees();
                let enough =
                    format!("a `direction_tolerance` of \"{:.1} deg\" is enough", (least * 10.0).ceil() / 10.0);
                let (label, help) = if pointed.allowed() {
                    let offer = self.offer(&pointed, "reachable point");
                    (format!("in this direction {}", missed(&pointed)), format!("{offer}; or {enough}"))
                } else {
                    (format!("there the end effector points at least {least:.1} deg off, as far as was found"), enough)
                };
                let title = "the tip gets there, but not in this direction";
                return words.at(aim.direction.span, title, &label, Some(&help));
            }
        }
        if let Some(upright) = self.task.upright {
            let standing = solutions_of(carrier, &TipTask { obstacles: &[], ..self.task }, start).swap_remove(0);
            if !standing.reached() {
                let tilt_rad =
                    free.iter().map(|reach| tilt_rad(carrier, reach, &upright)).fold(f64::INFINITY, f64::min);
                return words.tilts(self.phase, None, tilt_rad);
            }
        }
        self.blocked(&free, nearest)
    }

    fn blocked(&self, free: &[Reach], nearest: &Reach) -> SceneError {
        let (words, carrier, task) = (self.words, self.space.carrier(), &self.task);
        let pointed = solutions_of(carrier, &TipTask { obstacles: &[], ..*task }, &free[0].pressures_pa);
        let widest = pointed
            .iter()
            .filter_map(|reach| self.space.nearest(&carrier.body(&reach.pressures_pa)?, f64::INFINITY))
            .max_by(|a, b| a.clearance.distance_m.total_cmp(&b.clearance.distance_m));
        let Some(widest) = widest else {
            return words.at(self.span, "the limb finds no way to be here", &missed(nearest), None);
        };
        // Clear of all obstacles by rods, but not at its place by tubes between plates.
        if carrier.is_loaded() && widest.clearance.distance_m >= task.clearance_m {
            return words.under_load(self.phase, nearest);
        }
        let name = words.obstacle(widest.obstacle);
        let label = words.too_near(&widest);
        let mut help = self.offer(nearest, "point that is clear");
        if widest.clearance.distance_m > 1e-4 {
            let enough = (widest.clearance.distance_m * 1e4).floor() / 10.0;
            help = format!("a `clearance` of \"{enough:.1} mm\" can be kept here; or {help}");
        }
        let title = format!("the limb cannot be here and clear of `{name}`");
        words.at(self.span, &title, &label, Some(&help))
    }

    /// The nearest to the goal that keeps direction and clearance, and whether there is a way. Without obstacles there is one, and `free` is
    /// that point.
    fn offer(&self, free: &Reach, what: &str) -> String {
        let asks_more = self.task.aim.is_some() || self.task.upright.is_some();
        if self.task.obstacles.is_empty() && free.allowed() && !asks_more {
            return nearest_point(free);
        }
        let carrier = self.space.carrier();
        let points = misses(carrier, &self.task, self.start);
        let Some(nearest) = points.first() else {
            return "nothing near it was found that is clear".to_owned();
        };
        let ranges = ranges(carrier.limb());
        let has_way =
            |point: &&Reach| route(self.space, &ranges, self.before, &values(carrier.limb(), point)).is_some();
        let found = points.iter().take(POINTS).find(has_way).map(|found| (found.distance_m, found.tip_m));
        let approached = approached(self.space, &self.task, self.before);
        let with_way = found.into_iter().chain(approached).min_by(|a, b| a.0.total_cmp(&b.0));
        let here = format!("the nearest {what} is {}", away(nearest.tip_m, nearest.distance_m));
        match with_way {
            Some((distance_m, tip_m)) if distance_m < nearest.distance_m + SAME_M => {
                format!("the nearest {what} is {}", away(tip_m, distance_m))
            }
            Some((distance_m, tip_m)) => {
                let there = away(tip_m, distance_m);
                format!("{here}, but no way there was found; the nearest with a way is {there}")
            }
            None => format!("{here}, but no way there was found"),
        }
    }
}

/// How near to its goal the tip gets on ways that are clear, m, and where that is; `None` where no end of a way keeps the direction.
fn approached(space: &Space<'_>, task: &TipTask<'_>, before: &[f64]) -> Option<(f64, [f64; 3])> {
    let off = |values: &[f64]| {
        let pose = *space.body(values)?.end();
        let axis = pose.rotation * Vector3::z();
        let turned = task.aim.map_or(0.0, |aim| angle(&axis, &Vector3::from(*aim.direction)) - aim.tolerance_rad);
        let tip_m = pose.translation.vector;
        (turned <= 0.0).then(|| (task.goal.distance_m(&tip_m), tip_m.into()))
    };
    off(&approach(space, &ranges(space.carrier().limb()), before, |values| Some(off(values)?.0)))
}

/// Tilt of a held object, rad.
fn tilt_rad(carrier: &Carrier<'_>, reach: &Reach, upright: &Upright) -> f64 {
    carrier.body(&reach.pressures_pa).map_or(f64::INFINITY, |body| upright.tilt_rad(&body.end().rotation))
}

/// A point, as a scene says it, and how far it is off.
fn away(tip_m: [f64; 3], distance_m: f64) -> String {
    format!("{}, {:.1} mm away", point(tip_m), distance_m * 1e3)
}

/// How far off the tip stays.
fn missed(reach: &Reach) -> String {
    if !reach.distance_m.is_finite() {
        return "no pressures were found at which the limb stands".to_owned();
    }
    format!("the nearest the tip gets is {:.1} mm away", reach.distance_m * 1e3)
}

/// The point itself.
fn nearest_point(reach: &Reach) -> String {
    format!("the nearest reachable point is {}", point(reach.tip_m))
}

/// Where the tip is, as a scene says it.
fn point(tip_m: [f64; 3]) -> String {
    // No zero has a sign.
    let [x, y, z] = tip_m.map(|v| (v * 1e4).round() * 0.1 + 0.0);
    format!("[\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]")
}

fn direction_off(carrier: &Carrier<'_>, reach: &Reach, direction: [f64; 3]) -> f64 {
    let body = carrier.body(&reach.pressures_pa);
    body.map_or(f64::INFINITY, |body| angle(&(body.end().rotation * Vector3::z()), &direction.into()))
}
