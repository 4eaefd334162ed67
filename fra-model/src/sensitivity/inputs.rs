//! Inputs of an equilibrium, one number at a time.

use crate::actuator::Actuator;
use crate::number::dual::Dual;
use crate::number::real::Real;
use crate::number::scalar::Scalar;
#[cfg(not(target_os = "none"))]
use crate::parameters::Fiber;
use crate::parameters::{ActuatorParameters, Families, Material, Motion, Placement, shrinks_bends};
use crate::solution::Load;
use crate::solve::energy::Wall;

/// One of the numbers that an equilibrium depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// `R_i`, m.
    InnerRadius,
    /// `R_o`, m. A stated winding radius stays the same; a bending actuator without one is wound at `R_o`.
    OuterRadius,
    /// `L`, m.
    Length,
    /// `mu`, Pa, of a neo-Hookean wall.
    ShearModulus,
    /// `C1`, Pa, of a Yeoh wall.
    YeohC1,
    /// `C2`, Pa.
    YeohC2,
    /// `C3`, Pa.
    YeohC3,
    /// Fiber angle, rad, of a straight actuator, and of a bending one that follows it ([`Fiber::shrinks_bends`](crate::Fiber::shrinks_bends)).
    FiberAngle,
    /// Fiber modulus `mu2`, Pa, of a straight actuator.
    FiberModulus,
    /// Thickness of a sheet, m.
    SheetThickness,
    /// `R_f`, m, of a sheet or a layer, or of a bending actuator with a stated winding.
    WindingRadius,
    /// Fiber angle of the second winding, rad ([`Actuator::second_fiber`](crate::Actuator::second_fiber)).
    SecondFiberAngle,
    /// Its fiber modulus `mu2`, Pa.
    SecondFiberModulus,
    /// Its thickness, m, where it is a sheet.
    SecondSheetThickness,
    /// Its `R_f`, m, where it is a sheet or a layer.
    SecondWindingRadius,
    /// Gauge pressure, Pa.
    Pressure,
    /// Axial force `N_ext`, N.
    Force,
    /// Torque `M_ext`, N m; on a bending actuator the bending moment.
    Torque,
}

impl Parameter {
    /// All of them; [`Actuator::inputs`](crate::Actuator::inputs) are those of one actuator.
    pub const ALL: [Self; 18] = [
        Self::InnerRadius,
        Self::OuterRadius,
        Self::Length,
        Self::ShearModulus,
        Self::YeohC1,
        Self::YeohC2,
        Self::YeohC3,
        Self::FiberAngle,
        Self::FiberModulus,
        Self::SheetThickness,
        Self::WindingRadius,
        Self::SecondFiberAngle,
        Self::SecondFiberModulus,
        Self::SecondSheetThickness,
        Self::SecondWindingRadius,
        Self::Pressure,
        Self::Force,
        Self::Torque,
    ];

    fn is_of_second_winding(self) -> bool {
        matches!(
            self,
            Self::SecondFiberAngle | Self::SecondFiberModulus | Self::SecondSheetThickness | Self::SecondWindingRadius
        )
    }

    /// Name of its field in [`ActuatorParameters`], [`Material`], [`Fiber`](crate::Fiber), [`State`](crate::State) or in the messages about a
    /// [`Load`].
    pub fn name(self) -> &'static str {
        match self {
            Self::InnerRadius => "inner_radius_m",
            Self::OuterRadius => "outer_radius_m",
            Self::Length => "length_m",
            Self::ShearModulus => "shear_modulus_pa",
            Self::YeohC1 => "c_pa[0]",
            Self::YeohC2 => "c_pa[1]",
            Self::YeohC3 => "c_pa[2]",
            Self::FiberAngle => "angle_rad",
            Self::FiberModulus => "modulus_pa",
            Self::SheetThickness => "thickness_m",
            Self::WindingRadius => "radius_m",
            Self::SecondFiberAngle => "second_fiber.angle_rad",
            Self::SecondFiberModulus => "second_fiber.modulus_pa",
            Self::SecondSheetThickness => "second_fiber.thickness_m",
            Self::SecondWindingRadius => "second_fiber.radius_m",
            Self::Pressure => "pressure_pa",
            Self::Force => "external_force_n",
            Self::Torque => "external_torque_nm",
        }
    }
}

/// Everything an equilibrium depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs<T> {
    pub(super) parameters: ActuatorParameters<T>,
    /// A device has one winding.
    #[cfg(not(target_os = "none"))]
    second_fiber: Option<Fiber<T>>,
    pub(super) pressure_pa: T,
    pub(super) force_n: T,
    pub(super) torque_nm: T,
}

impl<T: Real> Inputs<T> {
    pub(super) fn new(actuator: &Actuator<T>, pressure_pa: T, load: &Load<T>) -> Self {
        Self {
            parameters: *actuator.parameters(),
            #[cfg(not(target_os = "none"))]
            second_fiber: actuator.second_fiber().copied(),
            pressure_pa,
            force_n: load.force_n,
            torque_nm: load.torque_nm,
        }
    }
}

impl<T: Copy> Inputs<T> {
    /// The same inputs in another scalar.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U) -> Inputs<U> {
        Inputs {
            parameters: self.parameters.map(&f),
            #[cfg(not(target_os = "none"))]
            second_fiber: self.second_fiber.map(|fiber| fiber.map(&f)),
            pressure_pa: f(self.pressure_pa),
            force_n: f(self.force_n),
            torque_nm: f(self.torque_nm),
        }
    }
}

impl<T: Scalar> Inputs<T> {
    /// The straight wall that they describe.
    pub(super) fn wall(&self) -> Wall<T> {
        let wall = Wall::new(&self.parameters);
        #[cfg(not(target_os = "none"))]
        if let Some(second) = &self.second_fiber {
            return wall.with_second(second);
        }
        wall
    }

    /// Whether the tube twists without a torque.
    pub(super) fn twists_by_itself(&self) -> bool {
        #[cfg(not(target_os = "none"))]
        if self.second_fiber.as_ref().is_some_and(|fiber| fiber.families == Families::One) {
            return true;
        }
        self.parameters.fiber.as_ref().is_some_and(|fiber| fiber.families == Families::One)
    }

    /// A field of the second winding.
    #[cfg(not(target_os = "none"))]
    fn second(&mut self, parameter: Parameter) -> Option<&mut T> {
        let fiber = self.second_fiber.as_mut()?;
        match (parameter, fiber.placement) {
            (Parameter::SecondFiberAngle, _) => Some(&mut fiber.angle_rad),
            (Parameter::SecondFiberModulus, _) => Some(&mut fiber.modulus_pa),
            (Parameter::SecondSheetThickness, Placement::Sheet) => Some(&mut fiber.thickness_m),
            (Parameter::SecondWindingRadius, Placement::Sheet | Placement::Layer) => Some(&mut fiber.radius_m),
            _ => None,
        }
    }

    #[cfg(target_os = "none")]
    #[inline(always)]
    fn second(&mut self, _: Parameter) -> Option<&mut T> {
        None
    }

    /// The value of one input; `None` where the equilibria do not depend on it.
    pub(super) fn get(&self, parameter: Parameter) -> Option<T> {
        let mut copy = *self;
        copy.place(parameter).map(|place| *place)
    }

    fn place(&mut self, parameter: Parameter) -> Option<&mut T> {
        if parameter.is_of_second_winding() {
            return self.second(parameter);
        }
        let p = &mut self.parameters;
        let bends = p.motion == Motion::Bending;
        let placement = p.fiber.as_ref().map(|fiber| fiber.placement);
        let fiber = p.fiber.as_mut();
        match (parameter, &mut p.material) {
            (Parameter::InnerRadius, _) => Some(&mut p.inner_radius_m),
            (Parameter::OuterRadius, _) => Some(&mut p.outer_radius_m),
            (Parameter::Length, _) => Some(&mut p.length_m),
            (Parameter::ShearModulus, Material::NeoHookean { shear_modulus_pa }) => Some(shear_modulus_pa),
            (Parameter::YeohC1, Material::Yeoh { c_pa }) => Some(&mut c_pa[0]),
            (Parameter::YeohC2, Material::Yeoh { c_pa }) => Some(&mut c_pa[1]),
            (Parameter::YeohC3, Material::Yeoh { c_pa }) => Some(&mut c_pa[2]),
            (Parameter::FiberAngle, _) => {
                fiber.filter(|fiber| !bends || shrinks_bends(fiber)).map(|fiber| &mut fiber.angle_rad)
            }
            (Parameter::FiberModulus, _) => fiber.filter(|_| !bends).map(|fiber| &mut fiber.modulus_pa),
            (Parameter::SheetThickness, _) => {
                fiber.filter(|_| !bends && placement == Some(Placement::Sheet)).map(|fiber| &mut fiber.thickness_m)
            }
            (Parameter::WindingRadius, _) => {
                fiber.filter(|_| bends || placement != Some(Placement::Smeared)).map(|fiber| &mut fiber.radius_m)
            }
            (Parameter::Pressure, _) => Some(&mut self.pressure_pa),
            (Parameter::Force, _) => Some(&mut self.force_n),
            (Parameter::Torque, _) => Some(&mut self.torque_nm),
            _ => None,
        }
    }

    /// The inputs as dual numbers whose variable is one of them; `None` where the equilibria do not depend on it.
    pub(super) fn varied(&self, parameter: Parameter) -> Option<Inputs<Dual<T>>> {
        let mut duals = self.map(Dual::fixed);
        duals.place(parameter)?.slope = T::one();
        Some(duals)
    }
}
