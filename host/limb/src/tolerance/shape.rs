//! The centre line of a module whose actuators are not alike, and the tip behind it.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector4};

use crate::arc::Arc;
use crate::statics::{Bundle, Spring};
use crate::{Limb, LimbModule};

/// The centre line of a module with a shape: stretch, bends towards its `x` and `y` (rad/m), twist (rad/m); or a change of both.
pub(super) fn arc(module: &LimbModule, shape: &Vector4<f64>) -> Arc {
    let length_m = module.length_m();
    Arc { length_m: shape[0] * length_m, turn_rad: Vector3::new(-shape[2], shape[1], shape[3]) * length_m }
}

/// Stretch, bends towards the module's `x` and `y` (rad/m) and twist (rad/m) without load of tubes at their places; `None` where their energy has no
/// minimum, as where twisting tubes lean too far.
pub(super) fn shape(module: &LimbModule, tubes: Vec<([f64; 2], Spring)>) -> Option<Vector4<f64>> {
    let bundle = Bundle::of_springs(module.motion, tubes, module.bay_m())?;
    let [x, y] = bundle.free.bend_rad_per_m;
    Some(Vector4::new(bundle.free.stretch, x, y, bundle.free.twist_rad_per_m))
}

/// Rotation from the frame of a module's tubes to that of the limb.
pub(super) fn mount(module: &LimbModule) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::z() * module.mount_angle_rad())
}

/// Poses of the starts of the modules, and of the tip.
pub(super) fn chain<'a>(limb: &'a Limb, arcs: impl IntoIterator<Item = &'a Arc>) -> Vec<Isometry3<f64>> {
    let mut poses = vec![*limb.base()];
    for (module, arc) in limb.modules().iter().zip(arcs) {
        let mount = mount(module);
        let rigid = Translation3::new(0.0, 0.0, module.rigid_length_m());
        let start = poses[poses.len() - 1];
        poses.push(start * (mount * arc.pose() * mount.inverse()) * rigid);
    }
    poses
}

/// The tip, m.
pub(super) fn tip<'a>(limb: &'a Limb, arcs: impl IntoIterator<Item = &'a Arc>) -> Vector3<f64> {
    chain(limb, arcs).last().map_or_else(Vector3::zeros, |pose| pose.translation.vector)
}
