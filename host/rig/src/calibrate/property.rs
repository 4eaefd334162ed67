//! Unknowns of a calibration, and their meaning for an actuator.

use std::fmt;

use fra_model::{Fiber, Material, Motion, Parameter, Placement};

use super::Body;
use super::estimate::Shown;

/// A property of an actuator or of its pressure sensor that data may determine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Property {
    /// Shear modulus at small strain, Pa. A Yeoh wall keeps the ratios of its coefficients.
    ShearModulus,
    /// `C1` of a Yeoh wall, Pa.
    YeohC1,
    /// `C2`, Pa.
    YeohC2,
    /// `C3`, Pa.
    YeohC3,
    /// Fiber modulus `mu2`, Pa.
    FiberModulus,
    /// Fiber angle from the hoop, rad.
    FiberAngle,
    /// Fiber modulus of the second winding, Pa.
    SecondFiberModulus,
    /// Fiber angle of the second winding, rad.
    SecondFiberAngle,
    /// Thickness of the wall, m. The inner radius stays, and the windings keep their relative places in the wall.
    Wall,
    /// Inner radius, m. The outer radius and that of the winding stay.
    InnerRadius,
    /// Length at rest, m.
    Length,
    /// Pressure that seats wall and thread before they deform, Pa: a dead band.
    SeatingPressure,
    /// Pressure on loading less that on unloading at one deformation, Pa: the width of a loop of friction.
    LoopWidth,
    /// Reading of the pressure sensor at no pressure, Pa.
    PressureOffset,
    /// Change of the reading of the pressure sensor by 1 Pa more.
    PressureGain,
}

impl Property {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::ShearModulus,
        Self::YeohC1,
        Self::YeohC2,
        Self::YeohC3,
        Self::FiberModulus,
        Self::FiberAngle,
        Self::SecondFiberModulus,
        Self::SecondFiberAngle,
        Self::Wall,
        Self::InnerRadius,
        Self::Length,
        Self::SeatingPressure,
        Self::LoopWidth,
        Self::PressureOffset,
        Self::PressureGain,
    ];

    /// Its word on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::ShearModulus => "shear_modulus",
            Self::YeohC1 => "yeoh_c1",
            Self::YeohC2 => "yeoh_c2",
            Self::YeohC3 => "yeoh_c3",
            Self::FiberModulus => "fiber_modulus",
            Self::FiberAngle => "fiber_angle",
            Self::SecondFiberModulus => "second_fiber_modulus",
            Self::SecondFiberAngle => "second_fiber_angle",
            Self::Wall => "wall",
            Self::InnerRadius => "inner_radius",
            Self::Length => "length",
            Self::SeatingPressure => "seating_pressure",
            Self::LoopWidth => "loop_width",
            Self::PressureOffset => "pressure_offset",
            Self::PressureGain => "pressure_gain",
        }
    }

    /// The property of a word; `None` where there is none.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|property| property.word() == word)
    }

    /// SI unit; "1" for a ratio.
    pub fn si_unit(self) -> &'static str {
        match self {
            Self::FiberAngle | Self::SecondFiberAngle => "rad",
            Self::Wall | Self::InnerRadius | Self::Length => "m",
            Self::PressureGain => "1",
            _ => "Pa",
        }
    }

    /// Whether it describes the elastomer, which all modules of a material share.
    pub fn is_of_material(self) -> bool {
        matches!(self, Self::ShearModulus | Self::YeohC1 | Self::YeohC2 | Self::YeohC3)
    }

    /// Whether it describes the winding, the first of two.
    pub fn is_of_winding(self) -> bool {
        matches!(self, Self::FiberModulus | Self::FiberAngle)
    }

    /// Whether it describes the second winding.
    pub fn is_of_second_winding(self) -> bool {
        matches!(self, Self::SecondFiberModulus | Self::SecondFiberAngle)
    }

    /// Its value in a body; `None` where the body has no such property.
    pub fn value(self, body: &Body) -> Option<f64> {
        let p = &body.parameters;
        // The ideal winding of a bending actuator is a hoop that keeps its length.
        let fiber = p.fiber.filter(|fiber| p.motion != Motion::Bending || fiber.modulus_pa > 0.0);
        match (self, p.material) {
            (Self::ShearModulus, material) => Some(material.shear_modulus_pa()),
            (Self::YeohC1, Material::Yeoh { c_pa }) => Some(c_pa[0]),
            (Self::YeohC2, Material::Yeoh { c_pa }) => Some(c_pa[1]),
            (Self::YeohC3, Material::Yeoh { c_pa }) => Some(c_pa[2]),
            (Self::YeohC1 | Self::YeohC2 | Self::YeohC3, _) => None,
            (Self::FiberModulus, _) => fiber.map(|fiber| fiber.modulus_pa),
            (Self::FiberAngle, _) => fiber.map(|fiber| fiber.angle_rad),
            (Self::SecondFiberModulus, _) => body.second_fiber.map(|fiber| fiber.modulus_pa),
            (Self::SecondFiberAngle, _) => body.second_fiber.map(|fiber| fiber.angle_rad),
            (Self::Wall, _) => Some(p.outer_radius_m - p.inner_radius_m),
            (Self::InnerRadius, _) => Some(p.inner_radius_m),
            (Self::Length, _) => Some(p.length_m),
            (Self::SeatingPressure, _) => Some(body.seating_pressure_pa),
            (Self::LoopWidth, _) => Some(body.loop_width_pa),
            (Self::PressureOffset, _) => Some(body.pressure_offset_pa),
            (Self::PressureGain, _) => Some(body.pressure_gain),
        }
    }

    /// Gives it another value in a body that has it.
    pub fn place(self, body: &mut Body, value: f64) {
        let p = &mut body.parameters;
        match self {
            Self::ShearModulus => {
                let ratio = value / p.material.shear_modulus_pa();
                p.material = match p.material {
                    Material::NeoHookean { .. } => Material::NeoHookean { shear_modulus_pa: value },
                    Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(|c| c * ratio) },
                };
            }
            Self::YeohC1 | Self::YeohC2 | Self::YeohC3 => {
                if let Material::Yeoh { c_pa } = &mut p.material {
                    c_pa[self as usize - Self::YeohC1 as usize] = value;
                }
            }
            Self::FiberModulus => p.fiber.iter_mut().for_each(|fiber| fiber.modulus_pa = value),
            Self::FiberAngle => p.fiber.iter_mut().for_each(|fiber| fiber.angle_rad = value),
            Self::SecondFiberModulus => body.second_fiber.iter_mut().for_each(|fiber| fiber.modulus_pa = value),
            Self::SecondFiberAngle => body.second_fiber.iter_mut().for_each(|fiber| fiber.angle_rad = value),
            Self::Wall => {
                let ratio = value / (p.outer_radius_m - p.inner_radius_m);
                let inner = p.inner_radius_m;
                p.outer_radius_m = inner + value;
                for fiber in p.fiber.iter_mut().chain(&mut body.second_fiber) {
                    fiber.radius_m = inner + (fiber.radius_m - inner) * ratio;
                }
            }
            Self::InnerRadius => p.inner_radius_m = value,
            Self::Length => p.length_m = value,
            Self::SeatingPressure => body.seating_pressure_pa = value,
            Self::LoopWidth => body.loop_width_pa = value,
            Self::PressureOffset => body.pressure_offset_pa = value,
            Self::PressureGain => body.pressure_gain = value,
        }
    }

    /// The inputs of the model that change with it, each with its derivative; empty for what changes its pressure.
    pub(super) fn inputs(self, body: &Body) -> Vec<(Parameter, f64)> {
        let p = &body.parameters;
        match (self, p.material) {
            (Self::ShearModulus, Material::NeoHookean { .. }) => vec![(Parameter::ShearModulus, 1.0)],
            (Self::ShearModulus, Material::Yeoh { c_pa: [c1, c2, c3] }) => {
                let modulus = 2.0 * c1;
                vec![(Parameter::YeohC1, 0.5), (Parameter::YeohC2, c2 / modulus), (Parameter::YeohC3, c3 / modulus)]
            }
            (Self::YeohC1, _) => vec![(Parameter::YeohC1, 1.0)],
            (Self::YeohC2, _) => vec![(Parameter::YeohC2, 1.0)],
            (Self::YeohC3, _) => vec![(Parameter::YeohC3, 1.0)],
            (Self::FiberModulus, _) => vec![(Parameter::FiberModulus, 1.0)],
            (Self::FiberAngle, _) => vec![(Parameter::FiberAngle, 1.0)],
            (Self::SecondFiberModulus, _) => vec![(Parameter::SecondFiberModulus, 1.0)],
            (Self::SecondFiberAngle, _) => vec![(Parameter::SecondFiberAngle, 1.0)],
            (Self::Wall, _) => {
                let wall = p.outer_radius_m - p.inner_radius_m;
                let moves = |fiber: &Fiber<f64>| p.motion == Motion::Bending || fiber.placement != Placement::Smeared;
                let moved = |fiber: Option<Fiber<f64>>, radius: Parameter| {
                    fiber.filter(moves).map(|fiber| (radius, (fiber.radius_m - p.inner_radius_m) / wall))
                };
                let windings = [
                    moved(p.fiber, Parameter::WindingRadius),
                    moved(body.second_fiber, Parameter::SecondWindingRadius),
                ];
                std::iter::once((Parameter::OuterRadius, 1.0)).chain(windings.into_iter().flatten()).collect()
            }
            (Self::InnerRadius, _) => vec![(Parameter::InnerRadius, 1.0)],
            (Self::Length, _) => vec![(Parameter::Length, 1.0)],
            (Self::SeatingPressure | Self::LoopWidth | Self::PressureOffset | Self::PressureGain, _) => Vec::new(),
        }
    }

    /// Form of its changes in a text.
    pub(super) fn shown(self) -> Shown {
        match self {
            Self::FiberAngle | Self::SecondFiberAngle => Shown::Degrees,
            Self::SeatingPressure | Self::LoopWidth | Self::PressureOffset | Self::YeohC2 | Self::YeohC3 => {
                Shown::Kilopascals
            }
            _ => Shown::Percent,
        }
    }

    /// Least useful accuracy: the half width of a confidence interval beyond which [`fit`](super::fit) refuses. In its unit.
    pub(super) fn tolerance(self, body: &Body, largest_pressure_pa: f64) -> f64 {
        let value = self.value(body).unwrap_or(0.0).abs();
        let c1 = 0.5 * body.parameters.material.shear_modulus_pa();
        match self {
            // Elastomers have C2 of a tenth of C1 and C3 of a hundredth.
            Self::YeohC2 => value.max(0.1 * c1),
            Self::YeohC3 => value.max(0.01 * c1),
            Self::FiberAngle | Self::SecondFiberAngle => 0.1,
            Self::SeatingPressure | Self::LoopWidth | Self::PressureOffset => 0.1 * largest_pressure_pa,
            Self::PressureGain => 0.25,
            Self::Wall | Self::InnerRadius | Self::Length => 0.25 * value,
            Self::ShearModulus | Self::YeohC1 | Self::FiberModulus | Self::SecondFiberModulus => 0.5 * value,
        }
    }
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
