//! What eq. (18) is asked for.

use fra_model::{ActuatorParameters, Fiber, Material, Motion};

use crate::actuators::{Bounds, Winding};

/// Lower and upper bounds of a bundle that holds wanted wrenches. Equal bounds give a value.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceProblem {
    /// Whether all actuators have one geometry and one distance from the center: the bounds of the first.
    pub shared: bool,
    /// The actuators.
    pub actuators: Vec<Attachment>,
    /// The wrenches.
    pub samples: Vec<Sample>,
    /// Weight of forces, 1/N.
    pub force_per_n: f64,
    /// Weight of moments, 1/(N m).
    pub torque_per_nm: f64,
    /// Weight of the mean of `(P/P_ref)^2` over actuators and samples, without unit; >= 0.
    pub effort: f64,
    /// `P_ref`, Pa, gauge; > 0. `None` for the highest pressure of each actuator.
    pub reference_pressure_pa: Option<f64>,
}

/// An actuator's tube.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// The elastomer.
    pub material: Material<f64>,
    /// The winding.
    pub winding: Winding,
    /// Whether it is wound to the other hand: at the opposite of the fiber angle.
    pub mirrored: bool,
    /// Inner radius at rest, m; > 0.
    pub inner_radius_m: Bounds,
    /// Wall at rest, m; > 0.
    pub wall_m: Bounds,
    /// Length at rest, m; > 0.
    pub length_m: Bounds,
    /// Fiber angle from the hoop, rad.
    pub angle_rad: Bounds,
    /// Highest gauge pressure, Pa; the lowest is 0.
    pub pressure_max_pa: f64,
}

/// A point of the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// By its distance from the center.
    Polar {
        /// Distance from the center, m; >= 0.
        radius_m: Bounds,
        /// Direction from the center, rad.
        azimuth_rad: Bounds,
    },
    /// By its coordinates.
    Cartesian {
        /// Along `x`, m.
        x_m: Bounds,
        /// Along `y`, m.
        y_m: Bounds,
    },
}

/// An actuator, where it may be attached, and along what.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its tube.
    pub tube: Tube,
    /// Its place.
    pub place: Place,
    /// Height over the reference point, m.
    pub height_m: Bounds,
    /// Slopes of the axis against `z` towards `x` and `y`: the axis is `(slope_x, slope_y, 1)` normalised.
    pub slopes: [Bounds; 2],
}

/// A wanted wrench.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Forces, N, and moments, N m, that the bundle is to exert on its far connector.
    pub wrench: [f64; 6],
    /// Length that the actuators are held at, m; `None` for that at rest. They do not twist.
    pub held_length_m: Option<f64>,
}

impl Tube {
    /// 1, or -1 for the other hand.
    pub(super) fn hand(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }

    /// The actuator of a geometry; the angle is that before mirroring.
    pub(super) fn parameters(&self, inner: f64, wall: f64, length: f64, angle: f64) -> ActuatorParameters<f64> {
        let outer = inner + wall;
        ActuatorParameters {
            motion: Motion::Extension,
            inner_radius_m: inner,
            outer_radius_m: outer,
            length_m: length,
            material: self.material,
            fiber: Some(Fiber {
                angle_rad: self.hand() * angle,
                families: self.winding.families,
                modulus_pa: self.winding.modulus_pa,
                placement: self.winding.placement,
                thickness_m: self.winding.thickness_m,
                radius_m: self.winding.radius_m(inner, outer),
            }),
        }
    }
}
