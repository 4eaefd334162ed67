//! Why a goal of the tip cannot be had, and the nearest that can.

use nalgebra::Vector3;

use super::goal::{shapes, states, tip_task, too_near, values};
use super::inverse_kinematics::{Reach, TipGoal, TipTask, angle, misses, solutions, solve};
use super::route::{approach, ranges, route};
use super::space::Space;
use softlimb_limb::Limb;
use softlimb_scene::{Phase, Scene, SceneError, Span};

/// Most points near a goal to which a way is looked for.
const POINTS: usize = 3;
/// A point that is farther away by less than this, m, is as near.
const SAME_M: f64 = 1e-4;

/// A goal that was not reached.
pub(super) struct WhyNot<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limb: &'a Limb,
    /// What the planner moves in.
    pub(super) space: &'a Space<'a>,
    pub(super) task: TipTask<'a>,
    pub(super) span: Span,
    /// Setpoints that the move begins at, and their pressures, Pa.
    pub(super) before: &'a [f64],
    pub(super) start: &'a [f64],
}

impl WhyNot<'_> {
    /// Leaves one demand after the other away to find the one that cannot be met. `nearest` is the best that was found with all of them.
    pub(super) fn diagnostic(&self, nearest: &Reach) -> SceneError {
        let (scene, limb, start) = (self.scene, self.limb, self.start);
        let place = TipTask { aim: None, obstacles: &[], ..self.task };
        let free = solutions(limb, &place, start);
        if !free[0].reached() {
            let title = match self.task.goal {
                TipGoal::Point(_) => "the limb cannot reach this way-point",
                TipGoal::Inside(_) => "the limb cannot reach into this region",
            };
            let help = self.offer(&free[0], "reachable point");
            return scene.diagnostic(self.span, title, &missed(&free[0]), Some(&help));
        }
        if let Some(aim) = self.task.aim {
            let pointed = solve(limb, &TipTask { obstacles: &[], ..self.task }, start);
            if !pointed.reached() {
                let off = |reach: &Reach| direction_off(limb, reach, *aim.direction);
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
                return scene.diagnostic(aim.direction.span, title, &label, Some(&help));
            }
        }
        self.blocked(&free, nearest)
    }

    fn blocked(&self, free: &[Reach], nearest: &Reach) -> SceneError {
        let (scene, limb, task) = (self.scene, self.limb, &self.task);
        let pointed = solutions(limb, &TipTask { obstacles: &[], ..*task }, &free[0].pressures_pa);
        let widest = pointed
            .iter()
            .filter_map(|reach| self.space.nearest(&limb.body(&states(limb, reach)), f64::INFINITY))
            .max_by(|a, b| a.clearance.distance_m.total_cmp(&b.clearance.distance_m));
        let Some(widest) = widest else {
            return scene.diagnostic(self.span, "the limb finds no way to be here", &missed(nearest), None);
        };
        let name = &scene.obstacles()[widest.obstacle].name.value;
        let label = too_near(name, widest.clearance.distance_m, task.clearance_m);
        let mut help = self.offer(nearest, "point that is clear");
        if widest.clearance.distance_m > 1e-4 {
            let enough = (widest.clearance.distance_m * 1e4).floor() / 10.0;
            help = format!("a `clearance` of \"{enough:.1} mm\" can be kept here; or {help}");
        }
        let title = format!("the limb cannot be here and clear of `{name}`");
        scene.diagnostic(self.span, &title, &label, Some(&help))
    }

    /// The nearest to the goal that keeps direction and clearance, and whether there is a way. Without obstacles there is one, and `free` is
    /// that point.
    fn offer(&self, free: &Reach, what: &str) -> String {
        if self.task.obstacles.is_empty() && free.allowed() && self.task.aim.is_none() {
            return nearest_point(free);
        }
        let points = misses(self.limb, &self.task, self.start);
        let Some(nearest) = points.first() else {
            return "nothing near it was found that is clear".to_owned();
        };
        let ranges = ranges(self.limb);
        let has_way = |point: &&Reach| route(self.space, &ranges, self.before, &values(self.limb, point)).is_some();
        let found = points.iter().take(POINTS).find(has_way).map(|found| (found.distance_m, found.tip_m));
        let approached = approached(self.limb, self.space, &self.task, self.before);
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

/// The nearest to the goal of a phase that a way leads to, in words; `None` where the phase asks nothing of the tip.
pub(super) fn nearest_with_way(
    scene: &Scene,
    limb: &Limb,
    space: &Space<'_>,
    phase: &Phase,
    before: &[f64],
) -> Option<String> {
    let shapes = shapes(scene);
    let task = tip_task(scene, phase, &shapes)?;
    let (distance_m, tip_m) = approached(limb, space, &task, before)?;
    Some(format!("the nearest point that a way was found to is {}", away(tip_m, distance_m)))
}

/// How near to its goal the tip gets on ways that are clear, m, and where that is; `None` where no end of a way keeps the direction.
fn approached(limb: &Limb, space: &Space<'_>, task: &TipTask<'_>, before: &[f64]) -> Option<(f64, [f64; 3])> {
    let off = |values: &[f64]| {
        let pose = limb.tip_pose(&space.states(values)?);
        let axis = pose.rotation * Vector3::z();
        let turned = task.aim.map_or(0.0, |aim| angle(&axis, &Vector3::from(*aim.direction)) - aim.tolerance_rad);
        let tip_m = pose.translation.vector;
        (turned <= 0.0).then(|| (task.goal.distance_m(&tip_m), tip_m.into()))
    };
    off(&approach(space, &ranges(limb), before, |values| Some(off(values)?.0)))
}

/// A point, as a scene says it, and how far it is off.
fn away(tip_m: [f64; 3], distance_m: f64) -> String {
    format!("{}, {:.1} mm away", point(tip_m), distance_m * 1e3)
}

/// How far off the tip stays.
pub(super) fn missed(reach: &Reach) -> String {
    format!("the nearest the tip gets is {:.1} mm away", reach.distance_m * 1e3)
}

/// The point itself.
pub(super) fn nearest_point(reach: &Reach) -> String {
    format!("the nearest reachable point is {}", point(reach.tip_m))
}

/// Where the tip is, as a scene says it.
fn point(tip_m: [f64; 3]) -> String {
    // No zero has a sign.
    let [x, y, z] = tip_m.map(|v| (v * 1e4).round() * 0.1 + 0.0);
    format!("[\"{x:.1} mm\", \"{y:.1} mm\", \"{z:.1} mm\"]")
}

fn direction_off(limb: &Limb, reach: &Reach, direction: [f64; 3]) -> f64 {
    let axis = limb.tip_pose(&states(limb, reach)).rotation * Vector3::z();
    angle(&axis, &direction.into())
}
