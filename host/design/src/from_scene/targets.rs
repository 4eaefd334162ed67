//! Targets of modules as eq. (14).

use fra_model::{Motion, StateQuantity};

use super::error::BriefError;
use super::space::{parts, refuse_restrained, refuse_steering, segment};
use super::task::{Tasked, tasked};
use crate::actuators as fit;
use crate::actuators::{Problem, SegmentAnswer};
use crate::synthesis::{Candidate, Task, Total, WayPoint};
use softlimb_limb::Limb;
use softlimb_scene::{Goal, Phase, Redesign, RedesignedTarget, Scene, SceneError};

/// Weights of eq. (14): a millimetre counts as much as a hundredth of a radian, which moves a tip at 100 mm by as much.
const PER_M2: f64 = 1e6;
const PER_RAD2: f64 = 1e4;

/// Eq. (14) of a scene: each phase's targets, those of modules that it leaves out carried on from the phase before. A module that has none
/// yet may do as it likes.
///
/// # Errors
/// A diagnostic at a target that eq. (14) has no term for, at a steering module, at a module whose actuators plates hold back, and those of the bounds and of [`Limb::new`].
pub fn targets(scene: &Scene) -> Result<Problem, SceneError> {
    refuse_steering(scene)?;
    // A bundle that holds itself is refused before it is searched for.
    refuse_restrained(scene, &Limb::new(scene)?)?;
    scene.require_no_segments("eq. (14)")?;
    let mut segments = Vec::with_capacity(scene.modules().len());
    for part in (0..scene.modules().len()).flat_map(|index| parts(scene, index)) {
        let (index, module) = (part.module, &part.wound);
        let mut segment = segment(scene, &part)?;
        let mut held = None;
        for phase in scene.phases() {
            held = goal(scene, phase, index, module.moving_length_m())?.or(held);
            segment.goals.push(held);
        }
        segments.push(segment);
    }
    let shared = scene.design().is_some_and(|design| design.shared_supply_line);
    Ok(Problem::new(segments, shared))
}

/// Targets of a scene with segmented modules, as a task: each way-point has the targets of one phase.
///
/// # Errors
/// As [`targets`], and at the second segment where one supply line has several modules.
pub fn totals(scene: &Scene) -> Result<Tasked, BriefError> {
    refuse_steering(scene)?;
    let limb = Limb::new(scene)?;
    limb.require_plane_benders(scene, "`design limb` for targets")?;
    refuse_restrained(scene, &limb)?;
    if scene.design().is_some_and(|design| design.shared_supply_line) {
        scene.require_no_segments("one supply line of all modules")?;
    }
    let tasked = tasked(scene, |spaces| {
        let firsts: Vec<usize> = (0..spaces.len()).filter(|index| !spaces[*index].joined).collect();
        let mut held = vec![None; firsts.len()];
        let mut way_points = Vec::new();
        for phase in scene.phases() {
            for ((index, module), (first, held)) in scene.modules().iter().enumerate().zip(firsts.iter().zip(&mut held))
            {
                let goal = goal(scene, phase, index, module.moving_length_m())?;
                *held = goal.map(|goal| Total { first: *first, motion: *module.motion, value: goal.value }).or(*held);
            }
            way_points.push(WayPoint::with(held.iter().flatten().copied().collect()));
        }
        Ok(way_points)
    })?;
    // Eq. (14) has neither paths nor obstacles; the planner checks both.
    Ok(Tasked { task: Task { obstacles: Vec::new(), moves: false, ..tasked.task }, ..tasked })
}

/// Targets of a limb found for [`totals`]. A module has none before its first phase with a target.
pub fn redesigned_totals(scene: &Scene, tasked: &Tasked, limb: &Candidate) -> Vec<Vec<RedesignedTarget>> {
    let length_m = |index: usize| {
        let own = limb.modules.iter().zip(&tasked.patterns).filter(|(_, pattern)| **pattern == index);
        own.map(|(part, _)| part.length_m).sum::<f64>() - 2.0 * scene.modules()[index].end_length_m
    };
    let target = |(total, found): (&Total, &f64)| {
        let index = tasked.patterns[total.first];
        match total.motion {
            Motion::Extension => (index, StateQuantity::AxialStretch, found / length_m(index)),
            Motion::Expansion => (index, StateQuantity::OuterRadius, *found),
            Motion::Bending => (index, StateQuantity::BendAngle, *found),
            Motion::Twisting => (index, StateQuantity::Twist, *found),
        }
    };
    let phases = tasked.task.way_points.iter().zip(&limb.way_points);
    phases.map(|(asked, answer)| asked.totals.iter().zip(&answer.totals).map(target).collect()).collect()
}

/// The term of one module in one phase.
fn goal(scene: &Scene, phase: &Phase, module: usize, length_m: f64) -> Result<Option<fit::Goal>, SceneError> {
    let Goal::Targets(targets) = &phase.goal else { return Ok(None) };
    let Some(target) = targets.iter().find(|target| target.module == module) else { return Ok(None) };
    let (value, weight) = match target.kind {
        StateQuantity::AxialStretch => (target.value.value * length_m, PER_M2),
        StateQuantity::OuterRadius => (target.value.value, PER_M2),
        StateQuantity::BendAngle | StateQuantity::Twist => (target.value.value, PER_RAD2),
        StateQuantity::Pressure | StateQuantity::InnerRadius => {
            let title = "a design is for lengths, outer radii, bend angles and twists";
            let label = "eq. (14) has no term for this";
            return Err(scene.diagnostic(target.value.span, title, label, None));
        }
    };
    Ok(Some(fit::Goal { value, weight }))
}

/// An answer whose lengths are those of the modules with both ends, for printing; its targets stay those of what moves.
#[must_use]
pub fn with_ends(scene: &Scene, answer: &fit::Answer) -> fit::Answer {
    let mut whole = answer.clone();
    let segments = whole.segments.iter_mut().zip(scene.modules());
    segments.for_each(|(segment, module)| segment.length_m += 2.0 * module.end_length_m);
    whole
}

/// The modules and targets of an answer. What was asked as a stretch is the same length with the length found; what could not be reached is
/// what was found.
pub fn redesigned_targets(scene: &Scene, answer: &fit::Answer) -> (Vec<Redesign>, Vec<Vec<RedesignedTarget>>) {
    let modules = scene.modules().iter().zip(&answer.segments);
    let redesigns = modules
        .map(|(module, segment)| Redesign {
            name: module.name.to_string(),
            like: module.name.to_string(),
            motion: module.motion.name(),
            bundle: (module.actuators, module.arrangement),
            mount_angle_rad: module.mount_angle_rad,
            radii_m: [segment.inner_radius_m, segment.outer_radius_m],
            length_m: segment.length_m + 2.0 * module.end_length_m,
            winding: module.fiber.as_ref().map(|fiber| angle(*module.motion, segment, fiber.angle_rad)),
            segments: Vec::new(),
        })
        .collect();
    let values = |phase: usize| {
        let modules = scene.modules().iter().zip(&answer.segments).enumerate();
        modules
            .map(|(index, (module, segment))| {
                let found = segment.phases[phase].found;
                match *module.motion {
                    Motion::Extension => (index, StateQuantity::AxialStretch, found / segment.length_m),
                    Motion::Expansion => (index, StateQuantity::OuterRadius, found),
                    Motion::Bending => (index, StateQuantity::BendAngle, found),
                    Motion::Twisting => (index, StateQuantity::Twist, found),
                }
            })
            .collect()
    };
    (redesigns, (0..scene.phases().len()).map(values).collect())
}

fn angle(motion: Motion, segment: &SegmentAnswer, own_rad: f64) -> f64 {
    if motion == Motion::Bending { own_rad } else { segment.angle_deg.to_radians() }
}
