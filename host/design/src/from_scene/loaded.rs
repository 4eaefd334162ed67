//! A scene with weight as a search for a limb under load, and its result as a scene.

use std::f64::consts::PI;

use fra_model::{Arrangement, Motion};

use super::error::BriefError;
use super::space::{Part, found_winding, length_m, parts, second, section, turned, wound, written_segment};
use super::task::{SPARE_M, inside};
use crate::loaded::{
    BaseSpace, CarriedBody, Evaluation, Laws, LimbSpace, LoadedPose, LoadedTask, ModuleSpace, StandingLimits,
};
use crate::synthesis::{Aim, Direction, Obstacle};
use softlimb_limb::Limb;
use softlimb_scene::collision::Shape;
use softlimb_scene::{
    Bounds, Goal, Gripper, Located, Module, Phase, Rebase, Redesign, RewriteError, Scene, SceneError, redesigned_at,
};

/// A limb under load to search for.
#[derive(Clone, Debug)]
pub struct LoadedDesign {
    /// What it shall do.
    pub task: LoadedTask,
    /// What it may be.
    pub space: LimbSpace,
}

/// The task of a scene with weight: its phases with what they carry, its obstacles, and its modules within their bounds.
///
/// # Errors
/// A diagnostic at a phase that does not lead the tip to a place, at a choice of kinds, at a winding within the wall, and those of [`Limb::new`].
pub fn loaded_design(scene: &Scene) -> Result<LoadedDesign, BriefError> {
    if let Some(choice) = scene.design().and_then(|design| design.choice.as_ref()) {
        let title = "kinds of modules are not chosen under weight";
        let help = Some("remove `modules` and `motions`, or search with `simulated = false` in `[weight]` first");
        return Err(scene.diagnostic(choice.span, title, "motions and their order are left open here", help).into());
    }
    // A bender that twists is refused there.
    Limb::new(scene)?;
    let parts = (0..scene.modules().len()).flat_map(|index| parts(scene, index));
    let modules = parts.map(|part| module_space(scene, &part)).collect::<Result<_, _>>()?;
    let limb = scene.limb();
    let tool = limb.end_effector.as_ref();
    let reserve = scene.design().map_or(0.0, |design| design.pressure_reserve.max(design.limit_margin));
    let standing = scene.limits().standing;
    let limits = StandingLimits {
        load_factor: standing.load_factor,
        stiffness_n_per_m: standing.stiffness_n_per_m,
        sag_share: standing.sag_share,
        buckling_margin: standing.buckling_margin,
        pressure_share: standing.pressure_share.min(1.0 - reserve),
    };
    let obstacle = |obstacle: &softlimb_scene::Obstacle| Obstacle {
        name: obstacle.name.to_string(),
        shape: obstacle.shape.clone(),
        clearance_m: scene.limits().clearance_m + SPARE_M,
    };
    let task = LoadedTask {
        connector_m: limb.connector_length_m,
        connector_kg: limb.connector_mass_kg,
        tool_m: tool.map_or([0.0; 2], |tool| [tool.length_m, tool.radius_m]),
        tool_kg: tool.map_or(0.0, |tool| tool.mass_kg),
        poses: poses(scene)?,
        obstacles: scene.obstacles().iter().map(obstacle).collect(),
        moves: true,
        mass_max_kg: scene.design().and_then(|design| design.mass_max_kg).map(|most| *most),
        limits,
    };
    Ok(LoadedDesign { task, space: LimbSpace { base: base(scene), modules } })
}

/// The scene with a limb. Where it grasps a body, the phase gets the `direction` of the end effector: the tilt of the body depends on it.
///
/// # Errors
/// [`RewriteError`].
pub fn loaded_text(scene: &Scene, design: &LoadedDesign, limb: &Evaluation) -> Result<String, RewriteError> {
    let sizes = &limb.sizes;
    let mut found = design.space.modules.iter().zip(&sizes.modules);
    let (mut redesigns, mut spacers) = (Vec::new(), Vec::new());
    for module in scene.modules() {
        let parts: Vec<_> = found.by_ref().take(module.segments.len().max(1)).collect();
        let [(space, first), ..] = parts[..] else { break };
        let segments = module.segments.iter().zip(&parts);
        redesigns.push(Redesign {
            name: module.name.to_string(),
            like: module.name.to_string(),
            motion: module.motion.name(),
            bundle: (module.actuators, space.arrangement(first)),
            mount_angle_rad: turned(module, parts.iter().map(|(_, sizes)| sizes.mount_angle_rad)),
            radii_m: first.radii_m,
            length_m: parts.iter().map(|(_, sizes)| sizes.length_m).sum(),
            winding: found_winding(module, first.angle_rad),
            segments: segments
                .map(|(segment, (_, sizes))| written_segment(segment, sizes.length_m, sizes.angle_rad))
                .collect(),
        });
        spacers.push(first.spacers);
    }
    let [direction, up] = design.space.directions(sizes.pitch_rad);
    let base = Rebase { position_m: sizes.position_m, direction, up };
    redesigned_at(scene, &redesigns, &spacers, &base, &limb.grasp_directions(&design.task))
}

fn base(scene: &Scene) -> BaseSpace {
    let limb = scene.limb();
    let design = scene.design();
    let region = design.and_then(|design| design.base_region.as_ref()).map(|index| &scene.regions()[index.value].shape);
    let position_m = match region {
        Some(Shape::Box { center_m, half_m, .. }) => {
            [0, 1, 2].map(|axis| [center_m[axis] - half_m[axis], center_m[axis] + half_m[axis]])
        }
        _ => limb.base_position_m.map(|at| [at; 2]),
    };
    let pitch_rad = design.and_then(|design| design.base_pitch_rad).map_or([0.0; 2], |pitch| *pitch);
    BaseSpace { position_m, direction: limb.base_direction, up: limb.base_up, pitch_rad }
}

fn module_space(scene: &Scene, part: &Part) -> Result<ModuleSpace, SceneError> {
    let Part { wound: module, bounds, .. } = part;
    let design = scene.design();
    let pair = |bounds: Option<Located<Bounds>>, own: f64| bounds.map_or([own; 2], |bounds| *bounds);
    let bender = *module.motion == Motion::Bending;
    let inner_m = *module.inner_radius_m;
    let section = section(scene, module)?;
    let winding = match &module.fiber {
        Some(fiber) if !bender || fiber.shrinks_bends() => Some(wound(scene, module, fiber)?),
        _ => section,
    };
    let (in_row, own_m, spread) = match module.arrangement {
        Arrangement::Circle { radius_m } => (false, radius_m, bounds.circle_radius_m),
        Arrangement::Row { spacing_m } => (true, spacing_m, bounds.spacing_m),
    };
    let of = &scene.modules()[part.module];
    let bends = of.parts().iter().any(|part| *part.motion == Motion::Bending);
    let turn = if bends && design.is_some_and(|design| design.mount_angle_free) { PI } else { 0.0 };
    let mut space = ModuleSpace {
        name: module.name.to_string(),
        motion: *module.motion,
        actuators: module.actuators,
        in_row,
        material: *module.material,
        density_kg_per_m3: module.density_kg_per_m3,
        winding,
        second: second(scene, module)?,
        laws: None,
        inner_radius_m: pair(bounds.inner_radius_m, inner_m),
        wall_m: pair(bounds.wall_m, *module.outer_radius_m - inner_m),
        length_m: length_m(scene, part)?,
        ends_m: part.ends_m,
        joined: part.joined,
        angle_rad: pair(bounds.fiber_angle_rad, module.fiber.as_ref().map_or(0.0, |fiber| fiber.angle_rad)),
        spread_m: pair(spread, own_m),
        spacer_kg: module.spacer_mass_kg,
        // Segments of one actuator have no plates between them.
        bay_m: design.filter(|_| of.segments.is_empty()).map_or(f64::INFINITY, |design| design.bay_m),
        steering: module.steering,
        mount_angle_rad: [module.mount_angle_rad - turn, module.mount_angle_rad + turn],
        pressure_max_pa: *module.pressure_max_pa,
    };
    if section.is_some() && space.bends_err() {
        space.laws = Some(Laws::default());
        let ends = [0, 1].map(|end: usize| space.inner_radius_m[end] + space.wall_m[end]);
        space.law([space.inner_radius_m[0], ends[0]]).map_err(|radii_m| no_law(scene, module, radii_m))?;
    }
    Ok(space)
}

fn no_law(scene: &Scene, module: &Module, radii_m: [f64; 2]) -> SceneError {
    let [inner_mm, outer_mm] = radii_m.map(|radius_m| 1e3 * radius_m);
    let title = format!("finite elements do not tell how a load bends `{}` everywhere within its bounds", *module.name);
    let label = format!("radii of {inner_mm:.3} mm and {outer_mm:.3} mm have too few equilibria");
    let help =
        "narrow the bounds, or take the analytic model, of one winding: `bending = \"analytic\"` in [controller]";
    scene.diagnostic(module.span, &title, &label, Some(help))
}

fn poses(scene: &Scene) -> Result<Vec<LoadedPose>, SceneError> {
    let mut before: (f64, Option<CarriedBody>) = (0.0, None);
    let mut all = Vec::with_capacity(scene.phases().len());
    for phase in scene.phases() {
        let body = phase.object.map(|index| {
            let object = &scene.objects()[index];
            CarriedBody {
                radius_m: object.radius_m,
                above_m: object.height_m - object.grasp_m,
                below_m: object.grasp_m,
                tilt_max_rad: object.tilt_max_rad,
            }
        });
        // The gripper takes up or puts down at the end of the move.
        let (moved, held) = match phase.gripper {
            Some(Gripper::Close) => (before, (phase.payload_kg, body)),
            Some(Gripper::Open) => ((phase.payload_kg, body), (0.0, None)),
            None => ((phase.payload_kg, body), (phase.payload_kg, body)),
        };
        before = held;
        all.push(LoadedPose {
            name: phase.name.to_string(),
            aim: aim(scene, phase)?,
            direction: phase
                .aim
                .map(|aim| Direction { axis: aim.direction.value.into(), tolerance_rad: aim.tolerance_rad }),
            move_kg: moved.0,
            hold_kg: held.0,
            carried: moved.1,
        });
    }
    Ok(all)
}

fn aim(scene: &Scene, phase: &Phase) -> Result<Aim, SceneError> {
    match &phase.goal {
        Goal::Tip(tip) => Ok(Aim::Point(tip.value.into())),
        Goal::Inside(region) => Ok(inside(&scene.regions()[region.value].shape)),
        Goal::Targets(_) | Goal::Series(_) => {
            let title = "a design under weight is for places of the tip";
            let help = Some("give all phases `tip` or `inside`");
            Err(scene.diagnostic(phase.span, title, "this phase has another goal", help))
        }
    }
}
