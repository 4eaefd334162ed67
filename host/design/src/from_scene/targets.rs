//! Targets of modules as eq. (14).

use fra_model::{Motion, StateQuantity};

use super::space::{refuse_restrained, refuse_steering, segment};
use crate::actuators as fit;
use crate::actuators::{Problem, SegmentAnswer};
use softlimb_limb::Limb;
use softlimb_scene::{Goal, ModuleBounds, Phase, Redesign, RedesignedTarget, Scene, SceneError};

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
    let open = ModuleBounds::default();
    let bounds = |index: usize| scene.design().and_then(|design| design.modules.get(index)).unwrap_or(&open);
    let mut segments = Vec::with_capacity(scene.modules().len());
    for (index, module) in scene.modules().iter().enumerate() {
        let mut segment = segment(scene, module, bounds(index))?;
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
