//! What may be chosen of one module.

use std::f64::consts::TAU;

use fra_model::{Arrangement, Fiber, Motion, Placement};

use crate::actuators::{Bounds, GeometryBounds, Segment, Sizes, Winding};
use softlimb_limb::{Limb, reference_max_pa};
use softlimb_scene::{BendingModel, Located, Module, ModuleBounds, ModuleSegment, Scene, SceneError};

/// Refuses modules whose plates hold their actuators back: these searches size an actuator alone, and the bundle does not do as one of them.
///
/// # Errors
/// A diagnostic at the first such module, with the share of the twist that it reaches as it is.
pub(super) fn refuse_restrained(scene: &Scene, limb: &Limb) -> Result<(), SceneError> {
    let mut modules = scene.modules().iter().zip(limb.modules());
    let Some((module, built)) = modules.find(|(_, built)| built.is_restrained()) else { return Ok(()) };
    let title = format!("the twisting actuators of `{}` hold each other back", *module.name);
    let reaches = built.twist_share().map_or(String::new(), |(pressure_pa, share)| {
        format!(
            "; as written this bundle has {:.0} % of the twist of one alone at {:.2} kPa",
            100.0 * share,
            1e-3 * pressure_pa
        )
    });
    let label = format!("this design sizes one actuator alone{reaches}");
    Err(scene.diagnostic(module.span, &title, &label, Some("`actuators = 1`: one on the axis twists freely")))
}

/// A design without weight, and one for targets, has one deformation for a whole module.
pub(super) fn refuse_steering(scene: &Scene) -> Result<(), SceneError> {
    let Some(module) = scene.modules().iter().find(|module| module.steering) else { return Ok(()) };
    let title = "a steering module is designed under weight, for places of the tip";
    let label =
        format!("`{}` has a pressure for each actuator; this design has one deformation a module", *module.name);
    let help = "give all phases `tip` or `inside`, and leave out `simulated = false` in `[weight]`";
    Err(scene.diagnostic(module.span, title, &label, Some(help)))
}

/// What has one winding along its length: a module, or a segment of one.
pub(super) struct Part {
    /// Index of its module in the scene.
    pub(super) module: usize,
    /// The part described as a module.
    pub(super) wound: Module,
    /// Its bounds.
    pub(super) bounds: ModuleBounds,
    /// Lengths at the base and at the tip that its caps take out of the motion, m.
    pub(super) ends_m: [f64; 2],
    /// Whether it is the next segment of the same actuator.
    pub(super) joined: bool,
}

/// The parts of a module from the base to the tip. Radii are bounded by the module, lengths and fiber angles of segments by the segments.
pub(super) fn parts(scene: &Scene, index: usize) -> Vec<Part> {
    let module = &scene.modules()[index];
    let own = scene.design().and_then(|design| design.modules.get(index)).copied().unwrap_or_default();
    let last = module.segments.len().saturating_sub(1);
    let part = |(number, mut wound): (usize, Module)| {
        let Some(segment) = module.segments.get(number) else {
            return Part { module: index, wound, bounds: own, ends_m: [module.end_length_m; 2], joined: false };
        };
        wound.name.value = format!("{} segment {}", *module.name, number + 1);
        let mut bounds = own;
        (bounds.length_m, bounds.fiber_angle_rad) = (segment.bounds.length_m, segment.bounds.fiber_angle_rad);
        let capped = [number == 0, number == last];
        let ends_m = capped.map(|capped| if capped { module.end_length_m } else { 0.0 });
        Part { module: index, wound, bounds, ends_m, joined: number > 0 }
    };
    module.parts().into_iter().enumerate().map(part).collect()
}

/// A module's motion, material, winding and bounds of what moves of it, without goals. `bounds` are those of `[design]`; what has none keeps its value.
///
/// # Errors
/// A diagnostic at bounds whose actuators would overlap, and at a winding that has another place than the outer face.
pub(super) fn segment(scene: &Scene, part: &Part) -> Result<Segment, SceneError> {
    let Part { wound: module, bounds, ends_m, .. } = part;
    let (inner, outer) = (*module.inner_radius_m, *module.outer_radius_m);
    let inner_radius_m = pair(bounds.inner_radius_m, inner);
    let wall_m = pair(bounds.wall_m, outer - inner);
    overlap(scene, module, bounds, inner_radius_m[1] + wall_m[1])?;
    let winding = match &module.fiber {
        Some(fiber) if *module.motion != Motion::Bending || fiber.shrinks_bends() => Some(wound(scene, module, fiber)?),
        _ => None,
    };
    let angle_rad = module.fiber.as_ref().map_or(0.0, |fiber| fiber.angle_rad);
    Ok(Segment {
        name: module.name.to_string(),
        motion: *module.motion,
        material: *module.material,
        winding,
        section: section(scene, module)?,
        second: second(scene, module)?,
        bounds: GeometryBounds {
            sizes: Sizes::InnerAndWall,
            sizes_m: [inner_radius_m, wall_m],
            length_m: length_m(scene, part)?.map(|length_m| length_m - ends_m.iter().sum::<f64>()),
            angle_rad: if *module.motion == Motion::Bending {
                [angle_rad; 2]
            } else {
                pair(bounds.fiber_angle_rad, angle_rad)
            },
        },
        // What a device follows a setpoint to, so that what is found can be run.
        pressure_max_pa: (1.0 - scene.design().map_or(0.0, |design| design.pressure_reserve))
            * reference_max_pa(*module.pressure_max_pa),
        limit_margin: scene.design().map_or(LIMIT_MARGIN, |design| design.limit_margin),
        goals: Vec::new(),
        effort_per_pa2: 0.0,
    })
}

/// The winding of a bender by finite elements, where `check` may bend it by them.
pub(super) fn section(scene: &Scene, module: &Module) -> Result<Option<Winding>, SceneError> {
    let wound_bender = |fiber: &&Located<Fiber<f64>>| *module.motion == Motion::Bending && fiber.modulus_pa > 0.0;
    let Some(first) = module.fiber.as_ref().filter(wound_bender) else { return Ok(None) };
    if module.second_fiber.is_none() && scene.controller().bending == BendingModel::Analytic {
        return Ok(None);
    }
    wound(scene, module, first).map(Some)
}

/// The second winding, which keeps its angle.
pub(super) fn second(scene: &Scene, module: &Module) -> Result<Option<(Winding, f64)>, SceneError> {
    let second = module.second_fiber.as_ref();
    second.map(|fiber| Ok((wound(scene, module, fiber)?, fiber.angle_rad))).transpose()
}

/// Bounds of the length of a module or a segment with its ends, m.
///
/// # Errors
/// A diagnostic at bounds that leave nothing between the ends.
pub(super) fn length_m(scene: &Scene, part: &Part) -> Result<Bounds, SceneError> {
    let Part { wound: module, bounds, ends_m, .. } = part;
    let length_m = pair(bounds.length_m, *module.length_m);
    let place = if ends_m.iter().all(|end_m| *end_m > 0.0) { "at both ends" } else { "at its end" };
    let ends_m = ends_m.iter().sum::<f64>();
    if length_m[0] > ends_m {
        return Ok(length_m);
    }
    let span = bounds.length_m.map_or(module.span, |bounds| bounds.span);
    let title = format!("the least `length` of `{}` must be more than `end_length` {place}", *module.name);
    let label = format!("a length of {:.3} mm is allowed", 1e3 * length_m[0]);
    let help = format!("ends take {:.3} mm of it, which do not move", 1e3 * ends_m);
    Err(scene.diagnostic(span, &title, &label, Some(&help)))
}

/// Share of the limit pressure that stays unused where a scene says nothing.
const LIMIT_MARGIN: f64 = 0.05;

fn pair(bounds: Option<Located<Bounds>>, own: f64) -> Bounds {
    bounds.map_or([own; 2], |bounds| *bounds)
}

/// Actuators of the largest size must still have room side by side.
fn overlap(scene: &Scene, module: &Module, bounds: &ModuleBounds, outer_m: f64) -> Result<(), SceneError> {
    let Some(apart_m) = module.arrangement.nearest_m(module.actuators) else { return Ok(()) };
    let room = 0.5 * apart_m;
    if outer_m <= room * (1.0 + 1e-9) {
        return Ok(());
    }
    let span = bounds.wall_m.or(bounds.inner_radius_m).map_or(module.span, |bounds| bounds.span);
    let label = format!("an outer radius of up to {:.3} mm", outer_m * 1e3);
    let places = match module.arrangement {
        Arrangement::Circle { radius_m } => format!("on a circle of {:.3} mm", radius_m * 1e3),
        Arrangement::Row { spacing_m } => format!("in a row of a spacing of {:.3} mm", spacing_m * 1e3),
    };
    let help = format!("{places} {} actuators have room up to {:.3} mm each", module.actuators, room * 1e3);
    let title = format!("within these bounds the actuators of `{}` may overlap", *module.name);
    Err(scene.diagnostic(span, &title, &label, Some(&help)))
}

pub(super) fn wound(scene: &Scene, module: &Module, fiber: &Located<Fiber<f64>>) -> Result<Winding, SceneError> {
    let outside = fiber.radius_m == *module.outer_radius_m;
    if fiber.placement == Placement::Layer || (fiber.placement == Placement::Sheet && !outside) {
        let label = "this one lies within the wall";
        let title = "a design winds actuators on their outer face or through the whole wall";
        return Err(scene.diagnostic(fiber.span, title, label, Some("give the module a winding without `radius`")));
    }
    Ok(Winding {
        families: fiber.families,
        modulus_pa: fiber.modulus_pa,
        placement: fiber.placement,
        thickness_m: fiber.thickness_m,
        wall_share: 1.0,
    })
}

/// Fiber angle that is written for a module, rad; `None` of one without a winding and of one of segments.
pub(super) fn found_winding(module: &Module, found_rad: f64) -> Option<f64> {
    let fiber = module.fiber.as_ref().filter(|_| module.segments.is_empty())?;
    Some(if *module.motion == Motion::Bending { fiber.angle_rad } else { found_rad })
}

/// Length, m, and fiber angle, rad, that are written for a segment.
pub(super) fn written_segment(segment: &ModuleSegment, length_m: f64, found_rad: f64) -> (f64, Option<f64>) {
    let bends = *segment.motion == Motion::Bending;
    (length_m, segment.fiber.as_ref().map(|fiber| if bends { fiber.angle_rad } else { found_rad }))
}

/// Mount angle written for a module, rad: that of its first bending part, less the direction of this part. A module without one keeps its own.
/// `found_rad` are the angles of its parts.
pub(super) fn turned(module: &Module, found_rad: impl Iterator<Item = f64>) -> f64 {
    let parts = module.parts();
    let bends = parts.iter().zip(found_rad).find(|(part, _)| *part.motion == Motion::Bending);
    bends.map_or(module.mount_angle_rad, |(part, found_rad)| {
        let angle_rad = found_rad - (part.mount_angle_rad - module.mount_angle_rad);
        // A scene allows one turn either way.
        if angle_rad.abs() > TAU { angle_rad - TAU * (angle_rad / TAU).round() } else { angle_rad }
    })
}
