//! What eq. (18) is asked for.

use fra_model::Material;

use crate::actuators::{Bounds, Winding};

/// Lower and upper bounds of a bundle that holds wanted wrenches. Equal bounds give a value.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceProblem {
    /// Whether all actuators have one geometry and one distance from the center.
    pub shared: bool,
    /// The elastomer.
    pub material: Material<f64>,
    /// The winding; a sheet is at the outer radius, a layer from its thickness below that.
    pub winding: Winding,
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
    /// `P_ref`, Pa, gauge; > 0.
    pub reference_pressure_pa: f64,
}

/// Where an actuator may be attached, and along what.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Distance from the center, m; >= 0.
    pub radius_m: Bounds,
    /// Direction from the center, rad.
    pub azimuth_rad: Bounds,
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
