//! What a tip shall do as a task.

use std::f64::consts::PI;

use fra_model::Motion;

use super::error::BriefError;
use super::space::{Part, found_winding, parts, refuse_restrained, refuse_steering, segment, turned, written_segment};
use crate::synthesis::{Aim, Candidate, Direction, Obstacle, Space, Task, WayPoint};
use softlimb_limb::{Limb, base_pose};
use softlimb_scene::collision::Shape;
use softlimb_scene::{Goal, Phase, Redesign, Scene, SceneError};

/// Way-points that a marker series is designed for; the run follows all of it.
const MARKERS: usize = 12;
/// Kept beside the clearance that a scene asks for, m: what the sizes in its file are rounded by, and more.
pub(super) const SPARE_M: f64 = 2e-4;

/// A task and the modules it may be done with.
#[derive(Clone, Debug)]
pub struct Tasked {
    /// What the limb shall do.
    pub task: Task,
    /// What each module and segment may be, from the base outwards; where kinds and order are chosen, one for each kind.
    pub spaces: Vec<Space>,
    /// For each of them the module of the scene that it is made like.
    pub patterns: Vec<usize>,
}

/// The task of a scene: its way-points, regions and obstacles, with its modules within their bounds.
///
/// # Errors
/// A diagnostic at a phase whose goal is none for the tip, at a steering module, at a bender that twists, at a module whose actuators plates hold back, and
/// those of the bounds and of [`Limb::new`].
pub fn task(scene: &Scene) -> Result<Tasked, BriefError> {
    refuse_steering(scene)?;
    let limb = Limb::new(scene)?;
    limb.require_plane_benders(scene, "`design limb` for way-points")?;
    // A bundle that holds itself is refused before it is searched for.
    refuse_restrained(scene, &limb)?;
    refuse_chosen_series(scene)?;
    tasked(scene, |_| {
        let way_points = scene.phases().iter().map(|phase| way_points_of(scene, phase));
        Ok(way_points.collect::<Result<Vec<_>, _>>()?.concat())
    })
}

/// The task of a scene, with the way-points that `way_points` makes from its spaces.
pub(super) fn tasked(
    scene: &Scene,
    way_points: impl FnOnce(&[Space]) -> Result<Vec<WayPoint>, SceneError>,
) -> Result<Tasked, BriefError> {
    let parts: Vec<Part> = patterns(scene).into_iter().flat_map(|index| parts(scene, index)).collect();
    let spaces = parts.iter().map(|part| space(scene, part)).collect::<Result<Vec<_>, _>>()?;
    let way_points = way_points(&spaces)?;
    let limb = scene.limb();
    let tool = limb.end_effector.as_ref();
    // A plate covers its actuators.
    let plate_m = spaces.iter().map(|space| space.reach_m + widest(space)).fold(0.0, f64::max);
    let task = Task {
        base: base_pose(limb.base_position_m, limb.base_direction, limb.base_up),
        connector_m: [limb.connector_length_m, plate_m],
        tool_m: tool.map_or([0.0; 2], |tool| [tool.length_m, tool.radius_m]),
        rigid_mass_kg: [limb.connector_mass_kg, tool.map_or(0.0, |tool| tool.mass_kg)],
        way_points,
        obstacles: scene
            .obstacles()
            .iter()
            .map(|obstacle| Obstacle {
                name: obstacle.name.to_string(),
                shape: obstacle.shape.clone(),
                clearance_m: scene.limits().clearance_m + SPARE_M,
            })
            .collect(),
        moves: true,
        from_rest: true,
    };
    let patterns = parts.iter().map(|part| part.module).collect();
    Ok(Tasked { task, spaces, patterns })
}

/// Refuses segmented modules where kinds of modules are chosen.
fn refuse_chosen_series(scene: &Scene) -> Result<(), SceneError> {
    let choice = scene.design().and_then(|design| design.choice.as_ref());
    choice.map_or(Ok(()), |_| scene.require_no_segments("a choice of motions"))
}

/// The modules to design: those of the scene, or where kinds are chosen the first of each kind that is allowed.
fn patterns(scene: &Scene) -> Vec<usize> {
    let modules = scene.modules();
    let Some(choice) = scene.design().and_then(|design| design.choice.as_ref()) else {
        return (0..modules.len()).collect();
    };
    let first = |motion: &Motion| modules.iter().position(|module| *module.motion == *motion);
    choice.motions.iter().filter_map(first).collect()
}

fn space(scene: &Scene, part: &Part) -> Result<Space, SceneError> {
    let module = &part.wound;
    let free = scene.design().is_some_and(|design| design.mount_angle_free);
    let own = module.mount_angle_rad;
    Ok(Space {
        segment: segment(scene, part)?,
        actuators: module.actuators.into(),
        reach_m: module.reach_m(),
        mount_angle_rad: if free { [own - PI, own + PI] } else { [own; 2] },
        ends_m: part.ends_m,
        joined: part.joined,
        density_kg_per_m3: module.density_kg_per_m3,
    })
}

fn widest(space: &Space) -> f64 {
    let [inner, wall] = space.segment.bounds.sizes_m;
    inner[1] + wall[1]
}

fn way_points_of(scene: &Scene, phase: &Phase) -> Result<Vec<WayPoint>, SceneError> {
    let aims = match &phase.goal {
        Goal::Tip(tip) => vec![Aim::Point(tip.value.into())],
        Goal::Inside(region) => vec![inside(&scene.regions()[region.value].shape)],
        Goal::Series(_) => markers(scene),
        Goal::Targets(_) => {
            let title = "a design is either for the tip or for targets of the modules";
            let label = "this phase has targets; others lead the tip";
            return Err(scene.diagnostic(
                phase.span,
                title,
                label,
                Some("give all phases `tip` or `inside`, or all `targets`"),
            ));
        }
    };
    let direction =
        phase.aim.map(|aim| Direction { axis: aim.direction.value.into(), tolerance_rad: aim.tolerance_rad });
    Ok(aims.into_iter().map(|aim| WayPoint { aim: Some(aim), direction, ..WayPoint::with(Vec::new()) }).collect())
}

/// How far inside of a region a design puts the tip, m: a limb that only just touches it leaves nothing for inverse kinematics to find.
const INSIDE_M: f64 = 1e-3;

/// A region as an aim. Regions are boxes; of another solid its centre.
pub(super) fn inside(shape: &Shape) -> Aim {
    match shape {
        Shape::Box { center_m, half_m, rotation } => {
            let half_m = half_m.map(|half| half - INSIDE_M.min(0.2 * half));
            Aim::Inside { center_m: *center_m, half_m, rotation: *rotation }
        }
        Shape::Sphere { center_m, .. } => Aim::Point(*center_m),
        Shape::Capsule { from_m, to_m, .. } => Aim::Point((from_m + to_m) / 2.0),
    }
}

/// Some of the markers, evenly among all, with the first and the last.
fn markers(scene: &Scene) -> Vec<Aim> {
    let all = scene.markers().map_or(&[][..], |markers| markers.value.as_slice());
    let last = all.len().saturating_sub(1);
    let count = all.len().min(MARKERS);
    let at = |index: usize| index * last / (count - 1).max(1);
    (0..count).map(|index| Aim::Point(all[at(index)].tip_m.into())).collect()
}

/// The modules of a limb that was found, for its scene.
pub fn redesigned_limb(scene: &Scene, tasked: &Tasked, candidate: &Candidate) -> Vec<Redesign> {
    let chosen = scene.design().is_some_and(|design| design.choice.is_some());
    let modules = candidate.modules.iter().enumerate();
    let described = modules.map(|(index, found)| {
        let space = tasked.spaces.iter().position(|space| space.segment.name == found.name).unwrap_or(index);
        (index, found, &scene.modules()[tasked.patterns[space]], tasked.spaces[space].joined)
    });
    let mut redesigns: Vec<Redesign> = Vec::with_capacity(scene.modules().len());
    for (index, found, pattern, joined) in described {
        if let Some(redesign) = redesigns.last_mut().filter(|_| joined) {
            redesign.length_m += found.length_m;
            let segment = &pattern.segments[redesign.segments.len()];
            redesign.segments.push(written_segment(segment, found.length_m, found.fiber_angle_rad));
            continue;
        }
        let segment = pattern.segments.first();
        let segment = segment.map(|segment| written_segment(segment, found.length_m, found.fiber_angle_rad));
        redesigns.push(Redesign {
            name: if chosen { format!("{}-{}", pattern.motion.name(), index + 1) } else { pattern.name.to_string() },
            like: pattern.name.to_string(),
            motion: pattern.motion.name(),
            bundle: (pattern.actuators, pattern.arrangement),
            mount_angle_rad: turned(pattern, candidate.modules[index..].iter().map(|part| part.mount_angle_rad)),
            radii_m: [found.inner_radius_m, found.outer_radius_m],
            length_m: found.length_m,
            winding: found_winding(pattern, found.fiber_angle_rad),
            segments: segment.into_iter().collect(),
        });
    }
    redesigns
}
