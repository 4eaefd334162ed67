//! The centre line of a module whose actuators are not alike, and the tip behind it.

use fra_model::Motion;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector4};

use crate::arc::Arc;
use crate::statics::{Bundle, Spring, Tangent};
use crate::{Limb, LimbModule};

/// An actuator without load, as its bundle has it.
#[derive(Clone, Debug)]
pub(super) enum Tube {
    /// By a solver of its model.
    Model(Box<Spring>),
    /// A bender by finite elements of its section.
    Section(Tangent),
}

impl Tube {
    /// Its springs about the shape without load.
    pub(super) fn tangent(&self) -> Tangent {
        match self {
            Self::Model(spring) => spring.tangent(),
            Self::Section(tangent) => *tangent,
        }
    }

    fn spring(&self) -> Option<&Spring> {
        match self {
            Self::Model(spring) => Some(spring),
            Self::Section(_) => None,
        }
    }
}

/// The centre line of a module with a shape: stretch, bends towards its `x` and `y` (rad/m), twist (rad/m); or a change of both.
pub(super) fn arc(module: &LimbModule, shape: &Vector4<f64>) -> Arc {
    let length_m = module.length_m();
    Arc { length_m: shape[0] * length_m, turn_rad: Vector3::new(-shape[2], shape[1], shape[3]) * length_m }
}

/// Stretch, bends towards the module's `x` and `y` (rad/m) and twist (rad/m) without load of tubes at their places; `None` where their energy has no
/// minimum, as where twisting tubes lean too far.
pub(super) fn shape(module: &LimbModule, tubes: &[([f64; 2], Tube)]) -> Option<Vector4<f64>> {
    let springs = tubes.iter().map(|(place, tube)| Some((*place, tube.spring()?.clone()))).collect::<Option<Vec<_>>>();
    let tangents = tubes.iter().map(|(place, tube)| (*place, tube.tangent()));
    let bundle = match springs {
        Some(springs) => Bundle::of_springs(module.motion, springs, module.bay_m()),
        None => Bundle::of_tubes(module.motion, tangents.collect(), module.bay_m()),
    }?;
    let [x, y] = bundle.free.bend_rad_per_m;
    let twist_rad_per_m = match tubes {
        // A bender between plates is held by others, and one alone twists if its windings do not mirror each other.
        [(_, tube)] if module.motion == Motion::Bending => tube.tangent().twist_rad_per_m,
        _ => bundle.free.twist_rad_per_m,
    };
    Some(Vector4::new(bundle.free.stretch, x, y, twist_rad_per_m))
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
