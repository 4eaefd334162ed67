//! What varies from limb to limb.

use crate::fabricate::Tolerances;

/// What of an actuator is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The wall; the chamber keeps its size, and the winding its relative place in the wall.
    Wall,
    /// The fiber angle.
    Angle,
    /// All elastic moduli of the elastomer together.
    Modulus,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Wall, Self::Angle, Self::Modulus];

    /// Its word in tables and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Angle => "angle",
            Self::Modulus => "modulus",
        }
    }

    pub(super) fn index(self) -> usize {
        match self {
            Self::Wall => 0,
            Self::Angle => 1,
            Self::Modulus => 2,
        }
    }

    /// The tolerance of this kind, as the fields of [`Tolerances`] have it.
    pub(super) fn of(self, tolerances: &Tolerances) -> f64 {
        match self {
            Self::Wall => tolerances.wall_m,
            Self::Angle => tolerances.angle_rad,
            Self::Modulus => tolerances.modulus,
        }
    }
}

/// What is off nominal in a limb, while all else is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varied {
    /// One kind, in all actuators.
    Kind(Kind),
    /// Everything, in the actuators of one module, by its index.
    Module(usize),
}

impl Varied {
    /// What shares are given of, in a limb of so many modules.
    pub fn all(modules: usize) -> Vec<Self> {
        Kind::ALL.map(Self::Kind).into_iter().chain((0..modules).map(Self::Module)).collect()
    }
}

/// Where an actuator lies within its tolerances, by kind: -1 to 1.
pub(super) type Place = [f64; 3];
