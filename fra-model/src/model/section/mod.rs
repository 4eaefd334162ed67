//! The section of a bending actuator: its restoring moment by quadrature, and the state that belongs to a bend.
//!
//! Everything here is computed in any [`Scalar`], so that the derivatives with respect to the parameters are those of the same code.

mod moment;
mod nodes;
#[cfg(test)]
mod tests;

use crate::number::dual::Dual;
use crate::number::scalar::Scalar;
use crate::parameters::{ActuatorParameters, Material};
use crate::solution::State;

use moment::Bend;
use nodes::{
    ANGLES_2, ANGLES_4, ANGLES_6, ANGLES_8, ANGLES_10, ANGLES_12, ANGLES_16, Digits, Wall, angles, constants,
    equal_angles,
};

/// `R_i/R_o` above which the moment of a wall that does not soften rises throughout.
const THICK: f64 = 0.1;

/// A bending actuator with its section in units of `R_o`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section<T> {
    outer_radius_m: T,
    length_m: T,
    shear_modulus_pa: T,
    /// `rho_i = R_i/R_o` and `rho_f = R_f/R_o`.
    inner: T,
    winding: T,
    /// `psi'(J)/mu1 = 1/2 + a J + b J^2`.
    a: T,
    b: T,
    wall: Wall<T>,
    /// A singularity beyond the outer face, as the inverse of the `x` of `nodes.rs`.
    beyond: T,
}

/// Restoring moment `dU/dkappa / (mu1 R_o^3)` and its slope at one curvature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bent<T> {
    /// `k = kappa R_o`.
    pub(crate) k: T,
    pub(crate) moment: T,
    pub(crate) slope: T,
}

impl<T: Scalar> Section<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        let (zero, one) = (T::zero(), T::one());
        let outer = parameters.outer_radius_m;
        let mu1 = parameters.material.shear_modulus_pa();
        let (a, b) = match parameters.material {
            Material::NeoHookean { .. } => (zero, zero),
            Material::Yeoh { c_pa } => (T::constant(2.0) * c_pa[1] / mu1, T::constant(3.0) * c_pa[2] / mu1),
        };
        let inner = parameters.inner_radius_m / outer;
        let winding = parameters.fiber.as_ref().map_or(one, |fiber| fiber.radius_m / outer);
        // No root of zero, which has no derivative.
        let missing = one - winding * winding * winding;
        let wound_within = missing > T::constant(1e-6);
        Self {
            outer_radius_m: outer,
            length_m: parameters.length_m,
            shear_modulus_pa: mu1,
            inner,
            winding,
            a,
            b,
            wall: Wall::new(parameters.inner_radius_m, outer),
            beyond: if wound_within { one + (missing * T::constant(2.0 / 3.0)).sqrt() } else { one },
        }
    }

    pub(crate) fn shear_modulus_pa(&self) -> T {
        self.shear_modulus_pa
    }

    /// Whether the restoring moment could fall with the curvature: in a wall that softens, or in a very thick one.
    pub(crate) fn may_turn(&self) -> bool {
        self.a < T::zero() || self.b < T::zero() || self.inner < T::constant(THICK)
    }

    /// `d(volume)/d(kappa)` per length, in units of `R_o^3`.
    pub(crate) fn lever(&self) -> T {
        T::constant(core::f64::consts::PI) * self.winding * self.winding
    }

    /// Moment of the external load about the inextensible line, in units of `mu1 R_o^3`.
    pub(crate) fn load_moment(&self, force_n: T, torque_nm: T) -> T {
        let r = self.outer_radius_m;
        (torque_nm + force_n * r) / (self.shear_modulus_pa * r * r * r)
    }

    /// `k` of a bend angle.
    pub(crate) fn curvature(&self, bend_angle_rad: T) -> T {
        bend_angle_rad * self.outer_radius_m / self.length_m
    }

    /// The gauge pressure that balances a bend under a load.
    pub(crate) fn pressure(&self, bent: &Bent<T>, load_moment: T) -> T {
        (bent.moment - load_moment) / self.lever() * self.shear_modulus_pa
    }

    /// `dP/dk` under a constant load.
    pub(crate) fn pressure_slope(&self, bent: &Bent<T>) -> T {
        bent.slope / self.lever() * self.shear_modulus_pa
    }

    pub(crate) fn state(&self, bent: &Bent<T>, load_moment: T) -> State<T> {
        let one = T::one();
        let r = self.outer_radius_m;
        let centre_stretch = one + bent.k;
        // Areas per undeformed length in units of pi R_o^2; sections of mean area follow by dividing by the centre stretch.
        let within_winding = self.winding * self.winding * centre_stretch;
        let lumen = within_winding - (self.winding * self.winding - self.inner * self.inner);
        let section = lumen + one - self.inner * self.inner;
        let volume_scale = T::constant(core::f64::consts::PI) * r * r * self.length_m;
        State {
            pressure_pa: self.pressure(bent, load_moment),
            axial_stretch: centre_stretch,
            axial_strain: bent.k,
            inner_radius_m: r * (lumen / centre_stretch).sqrt(),
            outer_radius_m: r * (section / centre_stretch).sqrt(),
            twist_rad: T::zero(),
            bend_angle_rad: bent.k * self.length_m / r,
            volume_m3: volume_scale * lumen,
            volume_strain: bent.k * (self.winding / self.inner) * (self.winding / self.inner),
            compliance_m3_per_pa: volume_scale * self.winding * self.winding / self.pressure_slope(bent),
        }
    }

    /// Integrates the restoring moment over the section.
    pub(crate) fn bent(&self, k: T) -> Bent<T> {
        self.sampled(k, Digits::All)
    }

    /// The same to some digits, for a first guess.
    pub(crate) fn roughly_bent(&self, k: T) -> Bent<T> {
        self.sampled(k, Digits::Few)
    }

    fn sampled(&self, k: T, digits: Digits) -> Bent<T> {
        match angles(self.nearness(k), digits) {
            2 => self.integrated(k, digits, &ANGLES_2.map(constants)),
            4 => self.integrated(k, digits, &ANGLES_4.map(constants)),
            6 => self.integrated(k, digits, &ANGLES_6.map(constants)),
            8 => self.integrated(k, digits, &ANGLES_8.map(constants)),
            10 => self.integrated(k, digits, &ANGLES_10.map(constants)),
            12 => self.integrated(k, digits, &ANGLES_12.map(constants)),
            16 => self.integrated(k, digits, &ANGLES_16.map(constants)),
            32 => self.integrated(k, digits, &equal_angles::<T, 16>()),
            64 => self.integrated(k, digits, &equal_angles::<T, 32>()),
            _ => self.integrated(k, digits, &equal_angles::<T, 64>()),
        }
    }

    /// Nearness of the nearest singularity of the deformed radius to the angles, 0 to about 1: at the inner face, where the radius
    /// would shrink to nothing, or beyond the outer one, where the map folds.
    fn nearness(&self, k: T) -> T {
        let f2 = self.winding * self.winding;
        let stretch = T::one() + k;
        let lumen = f2 - (f2 - self.wall.inner2()) / stretch;
        let within = f2 * self.winding * T::constant(2.0 / 3.0) / lumen;
        k / stretch * Scalar::max(within, self.beyond)
    }

    fn integrated(&self, k: T, digits: Digits, angles: &[(T, T)]) -> Bent<T> {
        let bend = Bend::new(k, self.winding, self.a, self.b);
        let (mut moment, mut slope, mut halves) = (T::zero(), T::zero(), T::zero());
        angles.iter().for_each(|_| halves += T::constant(2.0));
        self.wall.for_each(
            k,
            || bend.fold(),
            digits,
            |square, weight| {
                let ring = bend.ring(square);
                for &(cos, sin) in angles {
                    let (density, curve) = bend.density(&ring, cos, sin);
                    moment += density.sum() * weight;
                    slope += curve.sum() * weight;
                }
            },
        );
        // dA = d(rho^2)/2 dphi, both halves of the section.
        let scale = T::constant(core::f64::consts::PI) / halves;
        Bent { k, moment: moment * scale, slope: slope * scale }
    }
}

impl<T: Scalar> Section<Dual<T>> {
    /// Whether the variable of the derivatives leaves the dimensionless section as it is.
    pub(crate) fn keeps_its_shape(&self) -> bool {
        let fixed = |dual: Dual<T>| dual.slope == T::zero();
        fixed(self.inner) && fixed(self.winding) && fixed(self.a) && fixed(self.b)
    }
}
