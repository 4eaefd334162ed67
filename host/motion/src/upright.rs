//! Tilt of what the gripper holds: it was upright as it was taken, and turns with the tip.

use nalgebra::{UnitQuaternion, Vector3};

use super::inverse_kinematics::angle;
use super::space::Space;
use softlimb_scene::Scene;

/// The axis of a held object, and its largest tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upright {
    /// Its axis in the frame of the tip.
    axis: Vector3<f64>,
    /// Largest angle of the axis from the vertical, rad.
    most_rad: f64,
}

impl Upright {
    /// An object that is upright while the tip is turned like this.
    pub(super) fn taken(tip: &UnitQuaternion<f64>, most_rad: f64) -> Self {
        Self { axis: tip.inverse() * Vector3::z(), most_rad }
    }

    /// Largest tilt, rad.
    pub(super) fn most_rad(&self) -> f64 {
        self.most_rad
    }

    /// The same with a share of its largest tilt.
    pub(super) fn within(self, share: f64) -> Self {
        Self { most_rad: share * self.most_rad, ..self }
    }

    /// The axis where the tip is turned like this.
    pub(super) fn axis_at(&self, tip: &UnitQuaternion<f64>) -> Vector3<f64> {
        tip * self.axis
    }

    /// Its angle from the vertical, rad.
    pub(super) fn tilt_rad(&self, tip: &UnitQuaternion<f64>) -> f64 {
        angle(&self.axis_at(tip), &Vector3::z())
    }
}

/// What the gripper holds, from phase to phase.
pub(super) struct Grip<'a> {
    scene: &'a Scene,
    object: Option<usize>,
    upright: Option<Upright>,
}

impl<'a> Grip<'a> {
    /// A gripper that holds nothing.
    pub(super) fn empty(scene: &'a Scene) -> Self {
        Self { scene, object: None, upright: None }
    }

    /// Holds an object: one that is new is upright at these setpoints, and the one that it holds already keeps its axis.
    pub(super) fn hold(&mut self, object: Option<usize>, space: &Space<'_>, values: &[f64]) -> Option<Upright> {
        if object != self.object {
            self.object = object;
            let most_rad = |index: usize| self.scene.objects()[index].tilt_max_rad;
            let taken = |index| Some(Upright::taken(&space.body(values)?.end().rotation, most_rad(index)));
            self.upright = object.and_then(taken);
        }
        self.upright
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilt_is_the_part_of_the_turn_that_moves_the_vertical() {
        let tip = UnitQuaternion::from_euler_angles(0.4, -0.7, 1.1);
        let upright = Upright::taken(&tip, 0.5);
        assert!(upright.tilt_rad(&tip) < 1e-12);
        // A turn about the vertical tilts nothing; one about a level axis tilts by its angle.
        let about = |axis: Vector3<f64>, by_rad: f64| UnitQuaternion::new(by_rad * axis.normalize()) * tip;
        assert!(upright.tilt_rad(&about(Vector3::z(), 2.0)) < 1e-12);
        for level in [Vector3::x(), Vector3::new(1.0, -3.0, 0.0)] {
            assert!((upright.tilt_rad(&about(level, 0.3)) - 0.3).abs() < 1e-12);
        }
        assert_eq!((upright.most_rad(), upright.within(0.5).most_rad()), (0.5, 0.25));
    }
}
