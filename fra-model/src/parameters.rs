//! Parameters of one actuator: plain values in SI units, checked when an [`Actuator`](crate::Actuator) is built.

use core::fmt;

use crate::number::real::{Real, real};
use crate::number::scalar::Scalar;

/// The motion an actuator is wound for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Lengthens: fibers close to the hoop direction.
    Extension,
    /// Widens: fibers close to the axis.
    Expansion,
    /// Bends: hoop fibers and a strain-limiting layer along one side.
    Bending,
    /// Twists: one family of helical fibers.
    Twisting,
}

impl Motion {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Extension, Self::Expansion, Self::Bending, Self::Twisting];

    /// Its name in scenes, tables and logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Extension => "extension",
            Self::Expansion => "expansion",
            Self::Bending => "bending",
            Self::Twisting => "twisting",
        }
    }
}

/// Parameters of an isotropic, incompressible elastomer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material<T> {
    /// `W = mu/2 (I1 - 3)`, eq. (2) of the paper.
    NeoHookean {
        /// Shear modulus `mu`, Pa; > 0.
        shear_modulus_pa: T,
    },
    /// `W = C1 (I1-3) + C2 (I1-3)^2 + C3 (I1-3)^3`.
    Yeoh {
        /// Coefficients `C1, C2, C3`, Pa; `C1 > 0`.
        c_pa: [T; 3],
    },
}

impl<T: Copy + core::ops::Add<Output = T>> Material<T> {
    /// The shear modulus at small strain, Pa.
    pub fn shear_modulus_pa(&self) -> T {
        match *self {
            Self::NeoHookean { shear_modulus_pa } => shear_modulus_pa,
            Self::Yeoh { c_pa } => c_pa[0] + c_pa[0],
        }
    }
}

/// Number of fiber families.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Families {
    /// One helix: the tube twists.
    One,
    /// Two mirrored helices at plus and minus the fiber angle.
    Two,
}

/// Location of the fiber energy in the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Placement {
    /// A sheet at the winding radius: energy per reference area `thickness mu2/2 (I4-1)^2`. The default of the model.
    Sheet,
    /// From the winding radius to the outer surface, energy per reference volume `mu2/2 (I4-1)^2`.
    Layer,
    /// Through the whole wall, energy per reference volume `mu2/2 (I4-1)^2`, as in eqs. (7)-(8) of the paper.
    Smeared,
}

/// Parameters of the winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fiber<T> {
    /// Fiber angle from the hoop direction, rad; `-pi/2..=pi/2`. A negative angle mirrors the twist. Bending: see [`shrinks_bends`](Self::shrinks_bends).
    pub angle_rad: T,
    /// One or two families.
    pub families: Families,
    /// Fiber modulus `mu2` of each family, Pa; >= 0. The stiffness along the fiber is `4 mu2`.
    pub modulus_pa: T,
    /// Location of the fiber energy.
    pub placement: Placement,
    /// Thickness of the sheet, m; > 0. Only the sheet uses it.
    pub thickness_m: T,
    /// Winding radius, m; within the wall. Sheet: its radius. Layer: its inner radius. Bending: the radius that a hoop keeps.
    pub radius_m: T,
}

/// All parameters of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorParameters<T> {
    /// Motion of the winding.
    pub motion: Motion,
    /// Inner radius `R_i`, m; > 0.
    pub inner_radius_m: T,
    /// Outer radius `R_o`, m; > `R_i`.
    pub outer_radius_m: T,
    /// Length `L`, m; > 0.
    pub length_m: T,
    /// The elastomer of the wall.
    pub material: Material<T>,
    /// The winding; `None` for a bare tube. A bending actuator without a stated winding is wound at its outer radius.
    pub fiber: Option<Fiber<T>>,
}

/// A parameter the model cannot accept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidParameter<T> {
    /// Name of the field, as in [`ActuatorParameters`], [`Material`], [`Fiber`], [`Load`](crate::Load) or [`Target`](crate::Target).
    pub field: &'static str,
    /// The value found.
    pub value: T,
    /// Accepted values.
    pub allowed: &'static str,
}

impl<T: fmt::Display> fmt::Display for InvalidParameter<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {} is not allowed: {}", self.field, self.value, self.allowed)
    }
}

impl<T: fmt::Display + fmt::Debug> core::error::Error for InvalidParameter<T> {}

/// `Err` that names the field unless `accepted`.
pub(crate) fn require<T>(
    accepted: bool,
    field: &'static str,
    value: T,
    allowed: &'static str,
) -> Result<(), InvalidParameter<T>> {
    if accepted { Ok(()) } else { Err(InvalidParameter { field, value, allowed }) }
}

impl<T: Real> Material<T> {
    fn check(&self) -> Result<(), InvalidParameter<T>> {
        let zero = T::zero();
        match *self {
            Self::NeoHookean { shear_modulus_pa: mu } => {
                require(mu.is_finite() && mu > zero, "shear_modulus_pa", mu, "finite and > 0")
            }
            Self::Yeoh { c_pa } => {
                require(c_pa[0].is_finite() && c_pa[0] > zero, "c_pa[0]", c_pa[0], "finite and > 0")?;
                require(c_pa[1].is_finite(), "c_pa[1]", c_pa[1], "finite")?;
                require(c_pa[2].is_finite(), "c_pa[2]", c_pa[2], "finite")
            }
        }
    }
}

impl<T: Copy> ActuatorParameters<T> {
    /// The same parameters in another scalar, each value carried over by `f`. They are not checked again.
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> ActuatorParameters<U> {
        ActuatorParameters {
            motion: self.motion,
            inner_radius_m: f(self.inner_radius_m),
            outer_radius_m: f(self.outer_radius_m),
            length_m: f(self.length_m),
            material: match self.material {
                Material::NeoHookean { shear_modulus_pa } => {
                    Material::NeoHookean { shear_modulus_pa: f(shear_modulus_pa) }
                }
                Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(&f) },
            },
            fiber: self.fiber.map(|fiber| fiber.map(f)),
        }
    }
}

impl<T> Fiber<T> {
    /// The same winding in another scalar.
    pub(crate) fn map<U>(self, f: impl Fn(T) -> U) -> Fiber<U> {
        Fiber {
            angle_rad: f(self.angle_rad),
            families: self.families,
            modulus_pa: f(self.modulus_pa),
            placement: self.placement,
            thickness_m: f(self.thickness_m),
            radius_m: f(self.radius_m),
        }
    }
}

/// [`Fiber::shrinks_bends`] in any arithmetic.
pub(crate) fn shrinks_bends<T: Scalar>(fiber: &Fiber<T>) -> bool {
    fiber.families == Families::Two
        && fiber.placement == Placement::Sheet
        && fiber.modulus_pa > T::zero()
        && fiber.angle_rad != T::zero()
}

impl<T: Real> Fiber<T> {
    /// Whether a bending actuator follows the angle of this winding: of two equal families as a sheet with a modulus. It takes
    /// any other winding as a hoop that keeps its radius.
    pub fn shrinks_bends(&self) -> bool {
        shrinks_bends(self)
    }
}

impl<T: Real> ActuatorParameters<T> {
    /// Checks every field; the first that is not accepted is named.
    ///
    /// # Errors
    /// [`InvalidParameter`] with field, value and allowed range.
    pub fn check(&self) -> Result<(), InvalidParameter<T>> {
        let zero = T::zero();
        let positive = |field, v: T| require(v.is_finite() && v > zero, field, v, "finite and > 0");
        positive("inner_radius_m", self.inner_radius_m)?;
        require(
            self.outer_radius_m.is_finite() && self.outer_radius_m > self.inner_radius_m,
            "outer_radius_m",
            self.outer_radius_m,
            "finite and > inner_radius_m",
        )?;
        positive("length_m", self.length_m)?;
        self.material.check()?;
        let Some(fiber) = self.fiber else { return Ok(()) };
        let right_angle: T = T::frac_pi_2() * (T::one() + real::<T>(4.0) * T::default_epsilon());
        require(
            fiber.angle_rad.is_finite() && fiber.angle_rad.abs() <= right_angle,
            "angle_rad",
            fiber.angle_rad,
            "-pi/2 to pi/2, from the hoop",
        )?;
        let mu2 = fiber.modulus_pa;
        require(mu2.is_finite() && mu2 >= zero, "modulus_pa", mu2, "finite and >= 0")?;
        let tolerance = self.outer_radius_m * (real::<T>(4.0) * T::default_epsilon());
        let r = fiber.radius_m;
        require(
            r.is_finite() && r >= self.inner_radius_m - tolerance && r <= self.outer_radius_m + tolerance,
            "radius_m",
            r,
            "inner_radius_m to outer_radius_m",
        )?;
        if self.motion == Motion::Bending {
            return Ok(());
        }
        match fiber.placement {
            Placement::Sheet => positive("thickness_m", fiber.thickness_m),
            Placement::Layer => {
                require(r < self.outer_radius_m, "radius_m", r, "less than outer_radius_m: a layer needs thickness")
            }
            Placement::Smeared => Ok(()),
        }
    }
}
