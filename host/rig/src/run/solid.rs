//! The limb as a solid among obstacles, for the log.

use crate::record;
use crate::record::{CarriedInfo, DrawnLimb, DrawnLink, PhaseInfo, Pose, Posture, SolidInfo, SolidShape};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use softlimb_limb::{Limb, LimbModule};
use softlimb_motion::{Carried, carried};
use softlimb_scene::Scene;
use softlimb_scene::collision::{Body, Piece, Shape};

/// Intervals of a module's center line in the log.
const INTERVALS: usize = 12;
/// Cylinders of a module for viewers.
const LINKS: usize = 8;

/// The solid of the limb in the log, with its distance from the obstacles of a scene. The index is that of a carried object.
pub(super) fn seen(
    (scene, limb): (&Scene, &Limb),
    mut body: Body,
    object: Option<usize>,
    (time_s, tip_unloaded_m): (f64, Option<[f64; 3]>),
) -> record::Body {
    let (line_m, radius_m) = drawn(limb, &body);
    if let Some(object) = object.and_then(|index| scene.objects().get(index)) {
        body.hanging(object.height_m - object.grasp_m, object.grasp_m, object.radius_m);
    }
    let distances = scene.obstacles().iter().filter_map(|obstacle| {
        let distance_m = body.clearance(&obstacle.shape)?.distance_m;
        distance_m.is_finite().then(|| (distance_m, obstacle.name.value.clone()))
    });
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
    record::Body { time_s, line_m, radius_m, nearest, tip_unloaded_m }
}

/// What the limb of a scene keeps clear of, and the limb without pressure or weight.
pub fn at_rest(scene: &Scene, limb: &Limb) -> (Vec<SolidInfo>, record::Body) {
    let states: Vec<_> = limb.drives().map(|drive| drive.actuator.rest()).collect();
    (solids(scene), seen((scene, limb), limb.body(&states), None, (0.0, None)))
}

/// A cross-section of the limb.
#[derive(Clone, Copy, Debug)]
struct Section {
    /// Its pose; `z` is the tangent of the center line.
    pose: Isometry3<f64>,
    radius_m: f64,
}

impl Section {
    fn of(piece: &Piece, share: f64) -> Self {
        Self { pose: piece.pose(share), radius_m: piece.radius_m() }
    }

    fn place_m(&self) -> Vector3<f64> {
        self.pose.translation.vector
    }
}

/// Points along the center line and the radius about each: as many for every shape of a limb.
fn drawn(limb: &Limb, body: &Body) -> (Vec<[f64; 3]>, Vec<f64>) {
    let of_part = |(moving, behind): (&[Piece], &[Piece])| along(moving, INTERVALS).into_iter().chain(ends(behind));
    let sections = parts(limb, body).into_iter().flat_map(of_part);
    sections.map(|section| (<[f64; 3]>::from(section.place_m()), section.radius_m)).unzip()
}

/// The pieces of a module: those that move, and the rigid ones behind them.
pub(super) type Part<'a> = (&'a [Piece], &'a [Piece]);

/// The pieces of each module.
pub(super) fn parts<'a>(limb: &Limb, body: &'a Body) -> Vec<Part<'a>> {
    let rigid = |module: &LimbModule| module.rigid_parts_m().iter().filter(|part| **part > 0.0).count();
    let rigid_parts: usize = limb.modules().iter().map(rigid).sum();
    let mut rest = body.pieces();
    // A series has as many links as segments.
    let links = |module: &LimbModule| module.segments().len().max(1);
    let all: usize = limb.modules().iter().map(links).sum();
    let each = rest.len().saturating_sub(rigid_parts) / all.max(1);
    let mut parts = Vec::with_capacity(limb.modules().len());
    for module in limb.modules() {
        let (moving, others) = rest.split_at((each * links(module)).min(rest.len()));
        let (behind, others) = others.split_at(rigid(module).min(others.len()));
        parts.push((moving, behind));
        rest = others;
    }
    parts
}

/// Cross-sections at equal distances along pieces.
fn along(pieces: &[Piece], intervals: usize) -> Vec<Section> {
    let length_m: f64 = pieces.iter().map(Piece::length_m).sum();
    let section = |step: usize| {
        let mut left_m = length_m * step as f64 / intervals as f64;
        let last = pieces.len().checked_sub(1)?;
        for (index, piece) in pieces.iter().enumerate() {
            if left_m <= piece.length_m() || index == last {
                return Some(Section::of(piece, (left_m / piece.length_m()).min(1.0)));
            }
            left_m -= piece.length_m();
        }
        None
    };
    (0..=intervals).filter_map(section).collect()
}

/// Both ends of each piece.
fn ends(pieces: &[Piece]) -> Vec<Section> {
    pieces.iter().flat_map(|piece| [0.0, 1.0].map(|share| Section::of(piece, share))).collect()
}

/// A straight cylinder in place of a part of the limb.
struct Cylinder {
    start: Section,
    end: Section,
    rigid: bool,
}

impl Cylinder {
    /// Length along the outside of the bend, m.
    fn outer_length_m(&self) -> f64 {
        let [from, to] = [&self.start, &self.end].map(|section| section.pose.rotation * Vector3::z());
        (self.end.place_m() - self.start.place_m()).norm() + self.start.radius_m * from.angle(&to)
    }

    /// Pose of its middle, with `z` along it.
    fn pose(&self) -> Pose {
        let chord = self.end.place_m() - self.start.place_m();
        let rotation = self.start.pose.rotation;
        let halfway = rotation.try_slerp(&self.end.pose.rotation, 0.5, 1e-9).unwrap_or(rotation);
        // Along an arc the halfway cross-section is across the chord already.
        let aligned = UnitQuaternion::rotation_between(&(halfway * Vector3::z()), &chord).unwrap_or_default() * halfway;
        logged(&Isometry3::from_parts((0.5 * (self.start.place_m() + self.end.place_m())).into(), aligned))
    }
}

/// The cylinders of a body: as many for every shape of a limb.
fn cylinders(limb: &Limb, body: &Body) -> Vec<Cylinder> {
    let mut cylinders = Vec::new();
    for (moving, behind) in parts(limb, body) {
        let sections = along(moving, LINKS);
        let bent = sections.windows(2).map(|ends| Cylinder { start: ends[0], end: ends[1], rigid: false });
        let straight = |piece| Cylinder { start: Section::of(piece, 0.0), end: Section::of(piece, 1.0), rigid: true };
        cylinders.extend(bent.chain(behind.iter().map(straight)));
    }
    cylinders
}

/// The limb as viewers draw it.
pub(super) fn drawn_limb(limb: &Limb) -> DrawnLimb {
    let at = |share: f64| {
        let states: Vec<_> = limb.drives().map(|drive| drive.curve.at(share * drive.reference_max_pa)).collect();
        cylinders(limb, &limb.body(&states))
    };
    let link = |(rest, full): (Cylinder, Cylinder)| DrawnLink {
        length_m: rest.outer_length_m().max(full.outer_length_m()),
        radius_m: rest.start.radius_m,
        rigid: rest.rigid,
    };
    DrawnLimb {
        base: logged(limb.base()),
        links: at(0.0).into_iter().zip(at(1.0)).map(link).collect(),
        modules: limb.modules().iter().map(|module| module.name.clone()).collect(),
    }
}

/// Poses of the modules' end plates.
pub(super) fn connectors(limb: &Limb, body: &Body) -> Vec<Isometry3<f64>> {
    let end = |(moving, _): Part<'_>| moving.last().map(|piece| piece.pose(1.0));
    parts(limb, body).into_iter().filter_map(end).collect()
}

/// The limb for viewers at a time of the run, s.
pub(super) fn posture(limb: &Limb, body: &Body, time_s: f64) -> Posture {
    Posture {
        time_s,
        links: cylinders(limb, body).iter().map(Cylinder::pose).collect(),
        connectors: connectors(limb, body).iter().map(logged).collect(),
        tip: logged(body.end()),
    }
}

fn logged(pose: &Isometry3<f64>) -> Pose {
    Pose { position_m: pose.translation.vector.into(), rotation: pose.rotation.coords.into() }
}

/// Obstacles and regions as they are drawn.
pub(super) fn solids(scene: &Scene) -> Vec<SolidInfo> {
    let solid = |name: &str, region, shape: &Shape| SolidInfo {
        name: name.to_owned(),
        region,
        lines_m: shape.outlines(),
        shape: Some(solid_shape(shape)),
    };
    let obstacles = scene.obstacles().iter().map(|obstacle| solid(&obstacle.name.value, false, &obstacle.shape));
    obstacles.chain(scene.regions().iter().map(|region| solid(&region.name.value, true, &region.shape))).collect()
}

fn solid_shape(shape: &Shape) -> SolidShape {
    match shape {
        Shape::Sphere { center_m, radius_m } => {
            SolidShape::Sphere { center_m: (*center_m).into(), radius_m: *radius_m }
        }
        Shape::Capsule { from_m, to_m, radius_m } => {
            SolidShape::Capsule { from_m: (*from_m).into(), to_m: (*to_m).into(), radius_m: *radius_m }
        }
        Shape::Box { center_m, half_m, rotation } => {
            let half_axis = |axis: usize| (rotation * (Vector3::ith(axis, half_m[axis]))).into();
            SolidShape::Box { center_m: (*center_m).into(), half_axes_m: std::array::from_fn(half_axis) }
        }
    }
}

/// The objects that the tip carries in the phases of a plan.
pub(super) fn carried_infos(scene: &Scene, phases: &[PhaseInfo]) -> Vec<CarriedInfo> {
    let mut infos: Vec<CarriedInfo> = Vec::new();
    let mut held = None;
    let mut change = |object: Option<usize>, time_s: f64| {
        if object == held {
            return;
        }
        if let (Some(_), Some(info)) = (held, infos.last_mut()) {
            info.to_s = Some(time_s);
        }
        infos.extend(object.and_then(|index| scene.objects().get(index)).map(|object| CarriedInfo {
            name: object.name.value.clone(),
            radius_m: object.radius_m,
            above_m: object.height_m - object.grasp_m,
            below_m: object.grasp_m,
            start_m: None,
            from_s: time_s,
            to_s: None,
        }));
        held = object;
    };
    for (phase, Carried { moved, held }) in phases.iter().zip(carried(scene.phases())) {
        change(moved.object, phase.start_s);
        change(held.object, phase.hold_start_s());
    }
    infos
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Isometry3;

    #[test]
    fn points_of_a_chain_of_pieces_are_at_equal_distances() {
        let mut body = Body::new(&Isometry3::identity());
        body.rigid(0.1, 0.02);
        body.rigid(0.5, 0.02);
        let heights: Vec<f64> = along(body.pieces(), INTERVALS).iter().map(|section| section.place_m().z).collect();
        assert_eq!(heights.len(), INTERVALS + 1);
        for (step, height) in heights.iter().enumerate() {
            assert!((height - 0.05 * step as f64).abs() < 1e-12, "{heights:?}");
        }
        assert!(along(&[], INTERVALS).is_empty());
    }
}
