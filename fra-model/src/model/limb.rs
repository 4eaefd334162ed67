//! Kinematics: from the deformations of the modules to the pose of the tip.
//!
//! A module is a bundle of equal actuators between two connectors and deforms with constant strain along its centre line
//! (piecewise constant strain): it adds the exponential of one screw to the pose.

use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::arrangement::Arrangement;
use crate::number::real::{Real, real};
use crate::number::sin_cos;
use crate::parameters::Motion;
use crate::solution::State;

/// The centre line of one module: constant bend and twist over a length.
///
/// At its start the centre line runs along `z`; it bends towards `x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<T> {
    /// Length of the centre line, m; > 0.
    pub length_m: T,
    /// Angle between the tangents at its ends, rad.
    pub bend_angle_rad: T,
    /// Rotation of its end about its axis, rad.
    pub twist_rad: T,
}

impl<T: Real> Segment<T> {
    /// The centre line of a bundle whose actuators are all in `state`, the farthest `reach_m` off its axis.
    ///
    /// The inextensible lines of a bending bundle are at one height, as in [`Arrangement::Row`], so that
    /// it bends as each of its actuators does; `state.axial_stretch` is that of their axes, `R_o` outside of the lines. The actuators of a twisting bundle become helices around its axis: of their
    /// length `l` the bundle keeps `sqrt(l^2 - (d Phi)^2)`. `None` when the twist is too large for that.
    pub fn of_bundle(motion: Motion, length_m: T, reach_m: T, state: &State<T>) -> Option<Self> {
        let length = length_m * state.axial_stretch;
        match motion {
            Motion::Extension | Motion::Expansion => {
                Some(Self { length_m: length, bend_angle_rad: T::zero(), twist_rad: T::zero() })
            }
            Motion::Bending => {
                Some(Self { length_m: length, bend_angle_rad: state.bend_angle_rad, twist_rad: T::zero() })
            }
            Motion::Twisting => {
                let around = reach_m * state.twist_rad;
                let square = length * length - around * around;
                (square > T::zero()).then(|| Self {
                    length_m: square.sqrt(),
                    bend_angle_rad: T::zero(),
                    twist_rad: state.twist_rad,
                })
            }
        }
    }

    /// The centre line of a steering bundle, and the direction it bends towards, rad from the first actuator: of extending actuators evenly on a
    /// circle, each with its own stretch.
    ///
    /// On a bend `u` per length at rest the actuator at `r_i` has the stretch `lambda - u . r_i`. Three stretches are met exactly; more by least
    /// squares, which is the equilibrium of equal linear actuators with hinged ends. The bending stiffness of the actuators is left out: of `n` on
    /// a circle of radius `r`, each of axial stiffness `k` and bending stiffness `b`, the bend is smaller by the factor `1 + 2b/(k r^2)`.
    /// `None` for fewer than three actuators, and where radius or mean stretch are not positive.
    pub fn of_stretches(length_m: T, radius_m: T, stretches: &[T]) -> Option<(Self, T)> {
        let count = u8::try_from(stretches.len()).ok().filter(|count| *count >= 3)?;
        let number = real::<T>(f64::from(count));
        let unit = Arrangement::Circle { radius_m: T::one() };
        let moments = |[sum, x, y]: [T; 3], ([cos, sin], stretch): ([T; 2], &T)| {
            [sum + *stretch, x - *stretch * cos, y - *stretch * sin]
        };
        let [sum, x, y] = unit.positions_m(count).zip(stretches).fold([T::zero(); 3], moments);
        if radius_m <= T::zero() || sum <= T::zero() {
            return None;
        }
        let per_radius = length_m * real::<T>(2.0) / (number * radius_m);
        let segment = Self {
            length_m: length_m * sum / number,
            bend_angle_rad: per_radius * (x * x + y * y).sqrt(),
            twist_rad: T::zero(),
        };
        Some((segment, y.atan2(x)))
    }

    /// Pose of the point at a share of the length, 0 to 1, seen from the start.
    pub fn pose_at(&self, share: T) -> Isometry3<T> {
        let turn = Vector3::new(T::zero(), self.bend_angle_rad * share, self.twist_rad * share);
        let Screw { first, second, half_sine, half_cosine } = Screw::new(turn.norm_squared());
        let cross = turn.cross_matrix();
        let carry: Matrix3<T> = Matrix3::identity() + cross * first + cross * cross * second;
        let along = Vector3::new(T::zero(), T::zero(), self.length_m * share);
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from_parts(half_cosine, turn * half_sine));
        Isometry3::from_parts(Translation3::from(carry * along), rotation)
    }

    /// Pose of the end seen from the start.
    pub fn pose(&self) -> Isometry3<T> {
        self.pose_at(T::one())
    }
}

/// Coefficients of the exponential of a screw of angle `t`.
struct Screw<T> {
    /// `(1 - cos t)/t^2`.
    first: T,
    /// `(t - sin t)/t^3`.
    second: T,
    /// `sin(t/2)/t` and `cos(t/2)`, of the rotation's quaternion.
    half_sine: T,
    half_cosine: T,
}

impl<T: Real> Screw<T> {
    /// From the square of the angle, by the series where the quotients cancel.
    fn new(square: T) -> Self {
        let (one, half) = (T::one(), real::<T>(0.5));
        if square < real::<T>(0.01) {
            let series = |a: f64, b: f64, c: f64, d: f64| {
                real::<T>(a) + square * (real::<T>(b) + square * (real::<T>(c) + square * real::<T>(d)))
            };
            return Self {
                first: series(0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0),
                second: series(1.0 / 6.0, -1.0 / 120.0, 1.0 / 5040.0, -1.0 / 362_880.0),
                half_sine: series(0.5, -1.0 / 48.0, 1.0 / 3840.0, -1.0 / 645_120.0),
                half_cosine: one + square * series(-1.0 / 8.0, 1.0 / 384.0, -1.0 / 46_080.0, 1.0 / 10_321_920.0),
            };
        }
        let angle = square.sqrt();
        let (sin, cos) = sin_cos(angle * half);
        let half_sine = sin / angle;
        let second = (angle - (sin + sin) * cos) / (square * angle);
        Self { first: (half_sine + half_sine) * half_sine, second, half_sine, half_cosine: cos }
    }
}

/// One module of a limb in its present shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<T> {
    /// Its centre line.
    pub segment: Segment<T>,
    /// Direction it bends towards: rotation of its `x` about the limb's axis, rad.
    pub mount_angle_rad: T,
    /// Length of the rigid part behind it, m: connector, and for the last one the end effector.
    pub rigid_length_m: T,
}

impl<T: Real> Link<T> {
    /// Pose at a share of the module's length, seen from its start.
    pub fn pose_at(&self, share: T) -> Isometry3<T> {
        let (sin, cos) = sin_cos(self.mount_angle_rad * real::<T>(0.5));
        let mount = UnitQuaternion::new_unchecked(Quaternion::new(cos, T::zero(), T::zero(), sin));
        // Turned back behind the module, so that mount angles of different modules do not add up.
        mount * self.segment.pose_at(share) * mount.inverse()
    }

    /// Pose of the start of the next module.
    pub fn pose(&self) -> Isometry3<T> {
        self.pose_at(T::one()) * Translation3::new(T::zero(), T::zero(), self.rigid_length_m)
    }
}

/// Pose of the tip of a limb that starts at `base` and runs along the base's `z`.
pub fn tip_pose<T: Real>(base: &Isometry3<T>, links: impl IntoIterator<Item = Link<T>>) -> Isometry3<T> {
    links.into_iter().fold(*base, |pose, link| pose * link.pose())
}
