//! How far finished parts may be off.

use softlimb_files::range::{OutOfRange, require};

/// How far finished parts may be off, either way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Wall, m; 0 to 5 mm. The chamber keeps its size, and the winding its relative place in the wall.
    pub wall_m: f64,
    /// Fiber angle, rad; 0 to 10 degrees.
    pub angle_rad: f64,
    /// All elastic moduli of the elastomer together, as a share; 0 to 0.5.
    pub modulus: f64,
}

impl Default for Tolerances {
    /// 0.1 mm, 1 degree, 10 %.
    fn default() -> Self {
        Self { wall_m: 1e-4, angle_rad: 1_f64.to_radians(), modulus: 0.1 }
    }
}

impl Tolerances {
    /// Checks every field.
    ///
    /// # Errors
    /// [`OutOfRange`] with field, value and allowed range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let up_to = |field, value: f64, most: f64, allowed: &'static str| {
            require((0.0..=most).contains(&value), field, value, allowed)
        };
        up_to("wall_m", self.wall_m, 5e-3, "0 to 0.005")?;
        up_to("angle_rad", self.angle_rad, 10_f64.to_radians() * (1.0 + 1e-12), "0 to 0.1745, 10 degrees")?;
        up_to("modulus", self.modulus, 0.5, "0 to 0.5")
    }
}
