//! How far the end effector is from where it shall be, with derivatives.

use nalgebra::Vector3;

use super::chain::{Chain, On};
use super::rows::Rows;
use super::task::{Aim, WayPoint};

/// Millimetres in a metre: residuals are in mm.
pub(super) const MM: f64 = 1e3;
/// What a radian of the end effector's direction counts, mm: the lever of a grasped thing.
pub(super) const DIRECTION_MM: f64 = 100.0;

/// The difference of a tip and its aim, m.
pub(super) fn missed(tip: &Vector3<f64>, aim: &Aim) -> Vector3<f64> {
    match aim {
        Aim::Point(point) => tip - point,
        Aim::Inside { center_m, half_m, rotation } => {
            let local = rotation.inverse_transform_vector(&(tip - center_m));
            rotation * local.zip_map(half_m, |x, half| x - x.clamp(-half, half))
        }
    }
}

/// The rows of a way-point.
pub(super) fn aim(chain: &Chain, way_point: &WayPoint, rows: &mut Rows) {
    let last = chain.joints.len() - 1;
    let scale = way_point.weight.sqrt() * MM;
    let axes = if way_point.aim.is_some() { 0..3 } else { 0..0 };
    let away = way_point.aim.as_ref().map_or_else(Vector3::zeros, |aim| missed(&chain.tip, aim));
    for axis in axes {
        let mut normal = Vector3::ith(axis, 1.0);
        let mut residual = away[axis];
        if let Some(Aim::Inside { rotation, .. }) = &way_point.aim {
            // Along the box's own axes: inside of it nothing is asked along that axis.
            normal = rotation * normal;
            residual = away.dot(&normal);
            if residual == 0.0 {
                continue;
            }
        }
        rows.add(residual * scale, scale, |row| chain.row(last, On::Rigid, &chain.tip, &normal, row));
    }
    let Some(direction) = &way_point.direction else { return };
    let scale = way_point.weight.sqrt() * DIRECTION_MM;
    let turned = chain.tip_axis - direction.axis;
    // Chord of the tolerance.
    let allowed = 2.0 * (0.5 * direction.tolerance_rad).sin();
    if allowed == 0.0 {
        for axis in 0..3 {
            rows.add(turned[axis] * scale, scale, |row| chain.axis_row(&Vector3::ith(axis, 1.0), row));
        }
    } else if turned.norm() > allowed {
        let normal = turned.normalize();
        rows.add((turned.norm() - allowed) * scale, scale, |row| chain.axis_row(&normal, row));
    }
}
