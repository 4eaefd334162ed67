//! Names of the frames, and poses that stay.

use crate::record::drawn::Pose;
use crate::record::{SolidInfo, SolidShape};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Frame in the middle of a solid.
pub(super) fn solid_frame(solid: &SolidInfo) -> String {
    let kind = if solid.region { "region" } else { "obstacle" };
    format!("{kind}_{}", solid.name)
}

/// Frame at the place by which the tip holds an object.
pub(super) fn carried_frame(object: &str) -> String {
    format!("object_{object}")
}

/// Pose of a solid: its middle, with `z` along the line of a capsule, or the axes of a box. `None` for one without a shape.
pub(super) fn solid_pose(solid: &SolidInfo) -> Option<Pose> {
    let posed =
        |position_m: [f64; 3], rotation: UnitQuaternion<f64>| Pose { position_m, rotation: rotation.coords.into() };
    Some(match solid.shape.as_ref()? {
        SolidShape::Sphere { center_m, .. } => Pose::upright(*center_m),
        SolidShape::Capsule { from_m, to_m, .. } => {
            let line = difference(*to_m, *from_m);
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &line);
            // `None` where the line points down, or has no length.
            let turn =
                turn.unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            posed((Vector3::from(*from_m) + 0.5 * line).into(), turn)
        }
        SolidShape::Box { center_m, half_axes_m } => {
            let mut axes = half_axes_m.map(|axis| Vector3::from(axis).normalize());
            // A box looks the same with an axis turned round, and a rotation has no mirror in it.
            if axes[0].cross(&axes[1]).dot(&axes[2]) < 0.0 {
                axes[2] = -axes[2];
            }
            let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&axes));
            posed(*center_m, UnitQuaternion::from_rotation_matrix(&rotation))
        }
    })
}

pub(super) fn difference(to: [f64; 3], from: [f64; 3]) -> Vector3<f64> {
    Vector3::from(to) - Vector3::from(from)
}
