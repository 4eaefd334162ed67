//! From strains to lengths, angles and volumes of a straight tube.

use crate::number::arithmetic::Arithmetic;
use crate::number::lanes::{LANES, Lanes};
use crate::number::real::Real;
use crate::parameters::ActuatorParameters;
use crate::solution::State;

/// Dimensions that convert strains: of one tube, or of several side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size<S> {
    pub(crate) inner_radius_m: S,
    pub(crate) outer_radius_m: S,
    /// `(R_o/R_i)^2`.
    pub(crate) x_outer: S,
    /// Twist, rad, for a twist rate of one: `L/R_i`.
    pub(crate) twist_rad: S,
    /// Volume of the lumen at rest.
    pub(crate) volume_m3: S,
    /// `1/mu1`, 1/Pa.
    pub(crate) per_shear_modulus: S,
}

impl<S: Arithmetic> Size<S> {
    /// Stretch, inner and outer radius, m, twist, rad, volume, m3, and compliance, m3/Pa, of a state `(e, w, g)` with `dw/d(P/mu1)`.
    #[inline(always)]
    pub(crate) fn of_state(&self, e: S, w: S, g: S, volume_rate: S) -> [S; 6] {
        let one = e.of(1.0);
        let (stretch, widened) = (one + e, one + w);
        [
            stretch,
            self.inner_radius_m * (widened / stretch).root(),
            self.outer_radius_m * ((self.x_outer + w) / (stretch * self.x_outer)).root(),
            g * self.twist_rad,
            self.volume_m3 * widened,
            self.volume_m3 * volume_rate * self.per_shear_modulus,
        ]
    }
}

impl<T: Real> Size<T> {
    /// That of a tube with `(R_o/R_i)^2`.
    pub(crate) fn of_tube(parameters: &ActuatorParameters<T>, x_outer: T) -> Self {
        let (radius, length) = (parameters.inner_radius_m, parameters.length_m);
        Self {
            inner_radius_m: radius,
            outer_radius_m: parameters.outer_radius_m,
            x_outer,
            twist_rad: length / radius,
            volume_m3: T::pi() * radius * radius * length,
            per_shear_modulus: T::one() / parameters.material.shear_modulus_pa(),
        }
    }

    /// The state at `(e, w, g)` with `dw/d(P/mu1)`.
    #[inline(always)]
    pub(crate) fn state(&self, e: T, w: T, g: T, volume_rate: T, pressure_pa: T) -> State<T> {
        let [axial_stretch, inner_radius_m, outer_radius_m, twist_rad, volume_m3, compliance_m3_per_pa] =
            self.of_state(e, w, g, volume_rate);
        State {
            pressure_pa,
            axial_stretch,
            axial_strain: e,
            inner_radius_m,
            outer_radius_m,
            twist_rad,
            bend_angle_rad: T::zero(),
            volume_m3,
            volume_strain: w,
            compliance_m3_per_pa,
        }
    }
}

impl<T: Copy> Size<[T; LANES]> {
    /// The same tube in every lane.
    pub(crate) fn columns(tube: &Size<T>) -> Self {
        Self {
            inner_radius_m: [tube.inner_radius_m; LANES],
            outer_radius_m: [tube.outer_radius_m; LANES],
            x_outer: [tube.x_outer; LANES],
            twist_rad: [tube.twist_rad; LANES],
            volume_m3: [tube.volume_m3; LANES],
            per_shear_modulus: [tube.per_shear_modulus; LANES],
        }
    }

    /// Puts a tube in a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, tube: &Size<T>) {
        self.inner_radius_m[lane] = tube.inner_radius_m;
        self.outer_radius_m[lane] = tube.outer_radius_m;
        self.x_outer[lane] = tube.x_outer;
        self.twist_rad[lane] = tube.twist_rad;
        self.volume_m3[lane] = tube.volume_m3;
        self.per_shear_modulus[lane] = tube.per_shear_modulus;
    }

    /// The tube of a lane.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> Size<T> {
        Size {
            inner_radius_m: self.inner_radius_m[lane],
            outer_radius_m: self.outer_radius_m[lane],
            x_outer: self.x_outer[lane],
            twist_rad: self.twist_rad[lane],
            volume_m3: self.volume_m3[lane],
            per_shear_modulus: self.per_shear_modulus[lane],
        }
    }

    /// The same as vectors.
    #[inline(always)]
    pub(crate) fn vectors<V: Lanes<T>>(&self, token: V) -> Size<V> {
        Size {
            inner_radius_m: token.load(&self.inner_radius_m),
            outer_radius_m: token.load(&self.outer_radius_m),
            x_outer: token.load(&self.x_outer),
            twist_rad: token.load(&self.twist_rad),
            volume_m3: token.load(&self.volume_m3),
            per_shear_modulus: token.load(&self.per_shear_modulus),
        }
    }
}
