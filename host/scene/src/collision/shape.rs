//! Convex solids and the signed distance to their surfaces.

use nalgebra::{UnitQuaternion, Vector3};

use softlimb_files::range::{OutOfRange, require};

/// A convex solid in the scene's frame. Lengths are in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its centre.
        center_m: Vector3<f64>,
        /// Its radius; > 0.
        radius_m: f64,
    },
    /// All points within a radius of a line; a ball where its ends coincide.
    Capsule {
        /// One end of the line.
        from_m: Vector3<f64>,
        /// The other end.
        to_m: Vector3<f64>,
        /// Distance of the surface from the line; > 0.
        radius_m: f64,
    },
    /// A rectangular box.
    Box {
        /// Its centre.
        center_m: Vector3<f64>,
        /// Half of its edges along its own axes; each > 0.
        half_m: Vector3<f64>,
        /// From its own axes to the scene's.
        rotation: UnitQuaternion<f64>,
    },
}

/// A signed distance and the direction in which it grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Distance from the surface, m; negative inside.
    pub distance_m: f64,
    /// Unit vector along which it grows fastest; one of several where that is not unique, as in the middle of a ball.
    pub gradient: Vector3<f64>,
}

impl Shape {
    /// A ball.
    ///
    /// # Errors
    /// [`OutOfRange`] unless the radius is finite and > 0 and the centre is finite.
    pub fn sphere(center_m: [f64; 3], radius_m: f64) -> Result<Self, OutOfRange> {
        finite("center_m", center_m)?;
        softlimb_files::range::positive("radius_m", radius_m)?;
        Ok(Self::Sphere { center_m: center_m.into(), radius_m })
    }

    /// All points within `radius_m` of the line between two points.
    ///
    /// # Errors
    /// [`OutOfRange`] unless the radius is finite and > 0 and the ends are finite.
    pub fn capsule(from_m: [f64; 3], to_m: [f64; 3], radius_m: f64) -> Result<Self, OutOfRange> {
        finite("from_m", from_m)?;
        finite("to_m", to_m)?;
        softlimb_files::range::positive("radius_m", radius_m)?;
        Ok(Self::Capsule { from_m: from_m.into(), to_m: to_m.into(), radius_m })
    }

    /// A box about a centre, with half the length of its edges, turned from the scene's axes by `rotation`.
    ///
    /// # Errors
    /// [`OutOfRange`] unless every half edge is finite and > 0 and the centre is finite.
    pub fn cuboid(center_m: [f64; 3], half_m: [f64; 3], rotation: UnitQuaternion<f64>) -> Result<Self, OutOfRange> {
        finite("center_m", center_m)?;
        for half in half_m {
            softlimb_files::range::positive("half_m", half)?;
        }
        Ok(Self::Box { center_m: center_m.into(), half_m: half_m.into(), rotation })
    }

    /// Distance of a point from the surface, negative inside, with its gradient. It is convex in the point.
    pub fn distance(&self, point_m: &Vector3<f64>) -> Distance {
        match self {
            Self::Sphere { center_m, radius_m } => from_core(point_m - center_m, *radius_m, Vector3::z),
            Self::Capsule { from_m, to_m, radius_m } => {
                let axis = to_m - from_m;
                let square = axis.norm_squared();
                let share = if square > 0.0 { ((point_m - from_m).dot(&axis) / square).clamp(0.0, 1.0) } else { 0.0 };
                from_core(point_m - (from_m + axis * share), *radius_m, || across(&axis))
            }
            Self::Box { center_m, half_m, rotation } => {
                let Distance { distance_m, gradient } =
                    box_distance(&rotation.inverse_transform_vector(&(point_m - center_m)), half_m);
                Distance { distance_m, gradient: rotation * gradient }
            }
        }
    }
}

/// Distance from a solid whose points are those within a radius of a core; `away` leads from the core to the point.
fn from_core(away: Vector3<f64>, radius_m: f64, within: impl FnOnce() -> Vector3<f64>) -> Distance {
    let norm = away.norm();
    let gradient = if norm > 0.0 { away / norm } else { within() };
    Distance { distance_m: norm - radius_m, gradient }
}

/// A unit vector across an axis.
fn across(axis: &Vector3<f64>) -> Vector3<f64> {
    let least = Vector3::ith(axis.iamin(), 1.0);
    axis.cross(&least).try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// In the frame of the box.
fn box_distance(point: &Vector3<f64>, half_m: &Vector3<f64>) -> Distance {
    let beyond = point.abs() - half_m;
    let side = |axis: usize| if point[axis] < 0.0 { -1.0 } else { 1.0 };
    let outside = beyond.map(|value| value.max(0.0));
    let norm = outside.norm();
    if norm > 0.0 {
        let gradient = Vector3::from_fn(|axis, _| side(axis) * outside[axis] / norm);
        return Distance { distance_m: norm, gradient };
    }
    let axis = beyond.imax();
    Distance { distance_m: beyond[axis], gradient: Vector3::ith(axis, side(axis)) }
}

fn finite(field: &'static str, point: [f64; 3]) -> Result<(), OutOfRange> {
    point.into_iter().try_for_each(|value| require(value.is_finite(), field, value, "finite"))
}
