//! Margins that a limb under load keeps.

use serde::Serialize;

/// Least margins of a limb under load, in every pose, without its load, with half and with all of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StandingLimits {
    /// Least load factor; >= 1.
    pub load_factor: f64,
    /// Least vertical stiffness of the tip, N/m; >= 0.
    pub stiffness_n_per_m: f64,
    /// Largest sag over the length at rest; > 0.
    pub sag_share: f64,
    /// Least buckling margin of a tube; >= 1.
    pub buckling_margin: f64,
    /// Highest pressure over the lower of the scene's limit and the limit point; 0..1.
    pub pressure_share: f64,
}

/// What a design keeps a distance from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Margin {
    /// The tip is where it shall be.
    Reach,
    /// The end effector points where it shall.
    Direction,
    /// The axis of the carried body is nearly upright.
    Tilt,
    /// The limb carries the load at all.
    Carries,
    /// Load factor to the first instability.
    LoadFactor,
    /// Vertical stiffness of the tip.
    Stiffness,
    /// Sag of the tip.
    Sag,
    /// Buckling of a tube between two plates.
    Buckling,
    /// Pressure below its limit and the limit point.
    Pressure,
    /// The limb is not too heavy.
    Mass,
    /// A bending module is not bent backwards.
    BentBack,
    /// Distance from obstacles.
    Clearance,
}

impl Margin {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reach => "reach",
            Self::Direction => "direction",
            Self::Tilt => "tilt",
            Self::Carries => "carrying",
            Self::LoadFactor => "load factor",
            Self::Stiffness => "stiffness",
            Self::Sag => "sag",
            Self::Buckling => "buckling",
            Self::Pressure => "pressure",
            Self::Mass => "mass",
            Self::BentBack => "bending backwards",
            Self::Clearance => "clearance",
        }
    }
}
