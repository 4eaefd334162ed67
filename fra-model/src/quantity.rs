//! The quantities of a state, by name.

use crate::number::real::Real;
use crate::{ActuatorParameters, Motion, State, Target};

/// A quantity of a [`State`]: the kind of a setpoint, of a measured value, of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StateQuantity {
    /// Gauge pressure, Pa.
    Pressure,
    /// Deformed over undeformed length.
    AxialStretch,
    /// Deformed outer radius, m.
    OuterRadius,
    /// Deformed inner radius, m.
    InnerRadius,
    /// Twist of one end against the other, rad.
    Twist,
    /// Angle between the end tangents, rad.
    BendAngle,
}

impl StateQuantity {
    /// All quantities.
    pub const ALL: [Self; 6] =
        [Self::Pressure, Self::AxialStretch, Self::OuterRadius, Self::InnerRadius, Self::Twist, Self::BendAngle];

    /// The deformation that a motion is named after.
    #[must_use]
    pub const fn natural(motion: Motion) -> Self {
        match motion {
            Motion::Extension => Self::AxialStretch,
            Motion::Expansion => Self::OuterRadius,
            Motion::Bending => Self::BendAngle,
            Motion::Twisting => Self::Twist,
        }
    }

    /// Whether an actuator of this motion takes setpoints of this quantity.
    #[must_use]
    pub fn fits(self, motion: Motion) -> bool {
        self == Self::Pressure
            || self == Self::natural(motion)
            || (self == Self::InnerRadius && motion == Motion::Expansion)
    }

    /// Its value in a state, SI units; in the derivative of a state, its derivative.
    #[must_use]
    pub const fn of<T: Copy>(self, state: &State<T>) -> T {
        match self {
            Self::Pressure => state.pressure_pa,
            Self::AxialStretch => state.axial_stretch,
            Self::OuterRadius => state.outer_radius_m,
            Self::InnerRadius => state.inner_radius_m,
            Self::Twist => state.twist_rad,
            Self::BendAngle => state.bend_angle_rad,
        }
    }

    /// Its value of an actuator without pressure and load, SI units.
    #[must_use]
    pub fn at_rest<T: Real>(self, parameters: &ActuatorParameters<T>) -> T {
        match self {
            Self::AxialStretch => T::one(),
            Self::OuterRadius => parameters.outer_radius_m,
            Self::InnerRadius => parameters.inner_radius_m,
            Self::Pressure | Self::Twist | Self::BendAngle => T::zero(),
        }
    }

    /// A value as target of the inverse model; `None` for a pressure, which needs no inverse.
    #[must_use]
    pub fn target<T>(self, value: T) -> Option<Target<T>> {
        match self {
            Self::Pressure => None,
            Self::AxialStretch => Some(Target::AxialStretch(value)),
            Self::OuterRadius => Some(Target::OuterRadius(value)),
            Self::InnerRadius => Some(Target::InnerRadius(value)),
            Self::Twist => Some(Target::Twist(value)),
            Self::BendAngle => Some(Target::BendAngle(value)),
        }
    }

    /// Name in files: words joined by underscores.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pressure => "pressure",
            Self::AxialStretch => "axial_stretch",
            Self::OuterRadius => "outer_radius",
            Self::InnerRadius => "inner_radius",
            Self::Twist => "twist",
            Self::BendAngle => "bend_angle",
        }
    }

    /// Name for tables and axes.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Pressure => "gauge pressure",
            Self::AxialStretch => "axial stretch",
            Self::OuterRadius => "outer radius",
            Self::InnerRadius => "inner radius",
            Self::Twist => "twist",
            Self::BendAngle => "bend angle",
        }
    }

    /// SI unit of the values; "1" for a ratio.
    #[must_use]
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Pressure => "Pa",
            Self::AxialStretch => "1",
            Self::OuterRadius | Self::InnerRadius => "m",
            Self::Twist | Self::BendAngle => "rad",
        }
    }

    /// Unit in which people read the quantity; empty for a ratio.
    #[must_use]
    pub const fn display_unit(self) -> &'static str {
        match self {
            Self::Pressure => "kPa",
            Self::AxialStretch => "",
            Self::OuterRadius | Self::InnerRadius => "mm",
            Self::Twist | Self::BendAngle => "deg",
        }
    }

    /// Factor from the SI value to [`display_unit`](Self::display_unit).
    #[must_use]
    pub const fn display_scale(self) -> f64 {
        match self {
            Self::Pressure => 1e-3,
            Self::AxialStretch => 1.0,
            Self::OuterRadius | Self::InnerRadius => 1e3,
            Self::Twist | Self::BendAngle => 180.0 / core::f64::consts::PI,
        }
    }

    /// Digits after the point that a reader of a table can use.
    #[must_use]
    pub const fn display_decimals(self) -> usize {
        match self {
            Self::AxialStretch => 4,
            Self::OuterRadius | Self::InnerRadius => 3,
            Self::Twist | Self::BendAngle | Self::Pressure => 2,
        }
    }
}
