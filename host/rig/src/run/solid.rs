//! The limb as a solid among obstacles, for the log.

use crate::record;
use crate::record::{CarriedInfo, PhaseInfo, SolidInfo, SolidShape};
use nalgebra::Vector3;
use softlimb_limb::Limb;
use softlimb_motion::{Carried, carried};
use softlimb_scene::Scene;
use softlimb_scene::collision::{Body, Piece, Shape};

/// Intervals of a module's center line in the log.
const INTERVALS: usize = 12;

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

/// Points along the center line and the radius about each: as many for every shape of a limb.
fn drawn(limb: &Limb, body: &Body) -> (Vec<[f64; 3]>, Vec<f64>) {
    let rigid = |module: &softlimb_limb::LimbModule| module.rigid_parts_m().iter().filter(|part| **part > 0.0).count();
    let rigid_parts: usize = limb.modules().iter().map(rigid).sum();
    let pieces = body.pieces();
    let each = pieces.len().saturating_sub(rigid_parts) / limb.modules().len().max(1);
    let (mut rest, mut points) = (pieces, Vec::new());
    for module in limb.modules() {
        let (moving, others) = rest.split_at(each.min(rest.len()));
        points.extend(along(moving));
        let (behind, others) = others.split_at(rigid(module).min(others.len()));
        points.extend(behind.iter().flat_map(|piece| [0.0, 1.0].map(|share| at(piece, share))));
        rest = others;
    }
    points.into_iter().unzip()
}

/// Points at equal distances along pieces.
fn along(pieces: &[Piece]) -> Vec<([f64; 3], f64)> {
    let length_m: f64 = pieces.iter().map(Piece::length_m).sum();
    let point = |step: usize| {
        let mut left_m = length_m * step as f64 / INTERVALS as f64;
        let last = pieces.len().checked_sub(1)?;
        for (index, piece) in pieces.iter().enumerate() {
            if left_m <= piece.length_m() || index == last {
                return Some(at(piece, (left_m / piece.length_m()).min(1.0)));
            }
            left_m -= piece.length_m();
        }
        None
    };
    (0..=INTERVALS).filter_map(point).collect()
}

fn at(piece: &Piece, share: f64) -> ([f64; 3], f64) {
    (piece.point_m(share).into(), piece.radius_m())
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
        let heights: Vec<f64> = along(body.pieces()).into_iter().map(|(point, _)| point[2]).collect();
        assert_eq!(heights.len(), INTERVALS + 1);
        for (step, height) in heights.iter().enumerate() {
            assert!((height - 0.05 * step as f64).abs() < 1e-12, "{heights:?}");
        }
        assert_eq!(along(&[]), []);
    }
}
