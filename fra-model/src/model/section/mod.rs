//! The section of a bending actuator: its restoring moment by quadrature, and the state that belongs to a bend.
//!
//! Everything here is computed in any [`Scalar`], so that the derivatives with respect to the parameters are those of the same code.

mod helical;
mod moment;
mod nodes;
#[cfg(test)]
mod tests;

use crate::number::arithmetic::Arithmetic;
use crate::number::dual::Dual;
use crate::number::lanes::{LANES, Lanes};
use crate::number::scalar::Scalar;
use crate::parameters::{ActuatorParameters, Material, shrinks_bends};
use crate::solution::State;

use helical::Circle;
use moment::{Bend, Eight, Four, Pair};
pub(crate) use nodes::{Digits, MOST_TABLED};
use nodes::{Wall, angles, equal_angles, tabled};

/// `R_i/R_o` above which the moment of a wall that does not soften rises throughout.
const THICK: f64 = 0.1;

/// Lever of the pressure, as a share of that of the straight tube, below which it does not bend.
const LEAST_LEVER: f64 = 1e-3;

/// Largest squared tangent of the winding's angle; pressure bends no tube of more than half of it.
const STEEPEST: f64 = 1.0;

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
    /// Squared tangent of the winding's angle from the hoop; zero for one that keeps its radius.
    slant: T,
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

/// A load on the end, in units of `mu1 R_o^3`: its moment about the inextensible line of the straight tube, and the part of it that the force has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndLoad<T> {
    pub(crate) moment: T,
    by_force: T,
}

impl<T: Scalar> EndLoad<T> {
    pub(crate) fn none() -> Self {
        Self { moment: T::zero(), by_force: T::zero() }
    }
}

/// The space within the winding: strain of the axis, `area` and its slope in `k` per undeformed length in units of `pi R_o^2`, and the
/// gained volume as a share of the lumen's.
struct Within<T> {
    strain: T,
    area: T,
    gained: T,
    rate: T,
}

fn cosines<T: Scalar>(angles: &[(T, T)]) -> impl Iterator<Item = T> + Clone {
    angles.iter().map(|&(cos, _)| cos)
}

/// Squared tangent of a winding's angle from the hoop; zero where the winding keeps its radius.
fn slant<T: Scalar>(parameters: &ActuatorParameters<T>) -> T {
    parameters.fiber.filter(shrinks_bends).map_or(T::zero(), |fiber| {
        let (sin, cos) = fiber.angle_rad.sin_cos();
        let tangent = sin / cos;
        Scalar::min(tangent * tangent, T::constant(STEEPEST))
    })
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
            slant: slant(parameters),
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

    /// `d(volume)/d(kappa)` of the straight tube per length, in units of `R_o^3`.
    pub(crate) fn lever(&self) -> T {
        T::constant(core::f64::consts::PI) * self.winding * self.winding * self.lever_share()
    }

    /// The lever as a share of that of a hoop, `1 - 2 t`: from 35.3 deg on, pressure does not bend the tube.
    fn lever_share(&self) -> T {
        if self.is_helical() {
            Scalar::max(T::one() - self.slant - self.slant, T::constant(LEAST_LEVER))
        } else {
            T::one()
        }
    }

    /// The external load, in units of `mu1 R_o^3` and about the inextensible line of the straight tube.
    pub(crate) fn end_load(&self, force_n: T, torque_nm: T) -> EndLoad<T> {
        let r = self.outer_radius_m;
        let moment = (torque_nm + force_n * r) / (self.shear_modulus_pa * r * r * r);
        EndLoad { moment, by_force: force_n / (self.shear_modulus_pa * r * r) }
    }

    /// `k` of a bend angle.
    pub(crate) fn curvature(&self, bend_angle_rad: T) -> T {
        bend_angle_rad * self.outer_radius_m / self.length_m
    }

    /// The gauge pressure that balances a bend under a load.
    pub(crate) fn pressure(&self, bent: &Bent<T>, load: &EndLoad<T>) -> T {
        (bent.moment - load.moment) / self.lever() * self.shear_modulus_pa
    }

    /// `dP/dk` under a constant load.
    pub(crate) fn pressure_slope(&self, bent: &Bent<T>) -> T {
        bent.slope / self.lever() * self.shear_modulus_pa
    }

    pub(crate) fn state(&self, bent: &Bent<T>, load: &EndLoad<T>) -> State<T> {
        let r = self.outer_radius_m;
        let Within { strain, area, gained, rate } = self.within(bent.k);
        let centre_stretch = T::one() + strain;
        // Areas per undeformed length in units of pi R_o^2; sections of mean area follow by dividing by the centre stretch.
        let lumen = area - (self.winding * self.winding - self.inner * self.inner);
        let section = lumen + T::one() - self.inner * self.inner;
        let volume_scale = T::constant(core::f64::consts::PI) * r * r * self.length_m;
        State {
            pressure_pa: self.pressure(bent, load),
            axial_stretch: centre_stretch,
            axial_strain: strain,
            inner_radius_m: r * (lumen / centre_stretch).sqrt(),
            outer_radius_m: r * (section / centre_stretch).sqrt(),
            twist_rad: T::zero(),
            bend_angle_rad: bent.k * self.length_m / r,
            volume_m3: volume_scale * lumen,
            volume_strain: gained,
            compliance_m3_per_pa: volume_scale * rate / self.pressure_slope(bent),
        }
    }

    /// The space within the winding at a bend.
    fn within(&self, k: T) -> Within<T> {
        let f2 = self.winding * self.winding;
        if self.is_helical() {
            let angles = &equal_angles::<T, 16>();
            if let Some(circle) = self.circle(k, angles) {
                let gained = circle.swell();
                let rate = Scalar::max(circle.twice(cosines(angles)).swell().value.slope, T::zero());
                let inner2 = self.inner * self.inner;
                return Within { strain: circle.axial_strain(), area: f2 + gained, gained: gained / inner2, rate };
            }
        }
        let share = self.winding / self.inner;
        Within { strain: k, area: f2 * (T::one() + k), gained: k * share * share, rate: f2 }
    }

    /// First and second derivative by `k` of the volume within the winding, per length in units of `pi R_o^2`; `None` where the winding does not
    /// allow the bend.
    pub(crate) fn growth(&self, k: T) -> Option<[T; 2]> {
        if !self.is_helical() {
            return Some([self.winding * self.winding, T::zero()]);
        }
        let angles = &equal_angles::<T, 16>();
        let swell = self.circle(k, angles)?.twice(cosines(angles)).swell();
        Some([swell.value.slope, swell.slope.slope])
    }

    pub(crate) fn size_m(&self) -> [T; 2] {
        [self.outer_radius_m, self.length_m]
    }

    /// Whether the winding shrinks as the tube bends.
    pub(crate) fn is_helical(&self) -> bool {
        self.slant > T::zero()
    }

    fn circle(&self, k: T, angles: &[(T, T)]) -> Option<Circle<T>> {
        Circle::new(k, self.slant, self.winding, cosines(angles))
    }

    /// Integrates the restoring moment over the section.
    pub(crate) fn bent(&self, k: T, load: &EndLoad<T>) -> Bent<T> {
        self.sampled(k, load, Digits::All)
    }

    /// The same to some digits.
    pub(crate) fn sampled(&self, k: T, load: &EndLoad<T>, digits: Digits) -> Bent<T> {
        if self.is_helical() {
            return self.sampled_helical(k, load, digits);
        }
        match angles(self.nearness(k), digits) {
            32 => self.integrated_apart(k, digits, &equal_angles::<T, 16>()),
            64 => self.integrated_apart(k, digits, &equal_angles::<T, 32>()),
            128 => self.integrated_apart(k, digits, &equal_angles::<T, 64>()),
            few => self.integrated_apart(k, digits, &tabled(k, few)[..usize::from(few / 2)]),
        }
    }

    /// [`integrated`](Self::integrated), compiled once for all numbers of angles.
    #[inline(never)]
    fn integrated_apart(&self, k: T, digits: Digits, angles: &[(T, T)]) -> Bent<T> {
        if k.is_single() || T::DERIVATIVES > 0 {
            self.integrated::<false>(k, digits, angles)
        } else {
            self.integrated::<true>(k, digits, angles)
        }
    }

    /// [`sampled`](Self::sampled) with a helical winding.
    fn sampled_helical(&self, k: T, load: &EndLoad<T>, digits: Digits) -> Bent<T> {
        // Where the thread lies along the axis, `t (lambda^2 - 1) = 1`.
        let closed = (T::one() + T::one() / self.slant).sqrt() - T::one();
        let near = if closed > k + k { k / (closed - k) } else { T::one() };
        match angles(Scalar::max(self.nearness(k), near), digits) {
            32 => self.integrated_helical(k, load, digits, &equal_angles::<T, 16>()),
            64 => self.integrated_helical(k, load, digits, &equal_angles::<T, 32>()),
            128 => self.integrated_helical(k, load, digits, &equal_angles::<T, 64>()),
            few => {
                let few = few.max(4);
                self.integrated_helical(k, load, digits, &tabled(k, few)[..usize::from(few / 2)])
            }
        }
    }

    /// The moment of a helical winding, scaled to the lever of a hoop: `(dU/dk - load) lever(0)/lever(k) + load`. Beyond the bend at
    /// which the lever vanishes, no pressure balances it, and the moment is not finite.
    fn integrated_helical(&self, k: T, load: &EndLoad<T>, digits: Digits, angles: &[(T, T)]) -> Bent<T> {
        let nowhere = Bent { k, moment: T::one() / T::zero(), slope: T::zero() };
        let Some(circle) = self.circle(k, angles) else { return nowhere };
        let twice = circle.twice(cosines(angles));
        let (swell, strain) = (twice.swell(), twice.axial_strain());
        let f2 = self.winding * self.winding * self.lever_share();
        let (lever, lever_slope) = (swell.value.slope / f2, swell.slope.slope / f2);
        // The straight tube is one whether or not pressure can bend it.
        let lever = if k == T::zero() { T::one() } else { lever };
        if lever <= T::constant(LEAST_LEVER) {
            return nowhere;
        }
        let (mut moment, mut slope, mut halves) = (T::zero(), T::zero(), T::zero());
        for &(cos, sin) in angles {
            halves += T::constant(2.0);
            for side in [cos, -cos] {
                let energy = circle.ray(&twice, (side, sin), [self.a, self.b], |each| {
                    self.wall.for_each(k, || self.fold(k), digits, each);
                });
                moment += energy.value.slope;
                slope += energy.slope.slope;
            }
        }
        let scale = T::constant(core::f64::consts::PI) / halves;
        // The force acts on the axis, whose strain is `k d`.
        let by_force = load.by_force * (strain.value.slope - T::one());
        let left = moment * scale - load.moment - by_force;
        let by_force_slope = load.by_force * strain.slope.slope;
        Bent {
            k,
            moment: left / lever + load.moment,
            slope: (slope * scale - by_force_slope - left * lever_slope / lever) / lever,
        }
    }

    fn fold(&self, k: T) -> T {
        Bend::new(k, self.winding, self.a, self.b).fold()
    }
}

impl<S: Arithmetic> Section<S> {
    /// Nearness of the nearest singularity of the deformed radius to the angles, 0 to about 1: at the inner face, where the radius
    /// would shrink to nothing, or beyond the outer one, where the map folds.
    fn nearness(&self, k: S) -> S {
        let f2 = self.winding * self.winding;
        let stretch = k.of(1.0) + k;
        let lumen = f2 - (f2 - self.wall.inner2) / stretch;
        let within = f2 * self.winding * k.of(2.0 / 3.0) / lumen;
        k / stretch * within.greatest(self.beyond)
    }

    /// Number of angles that the integral for a bend takes.
    pub(crate) fn angles(&self, k: S, digits: Digits) -> u8 {
        angles(self.nearness(k), digits)
    }

    /// Number of radii that it takes; `None` where they crowd towards the outer face.
    pub(crate) fn radii(&self, k: S, digits: Digits) -> Option<u16> {
        self.wall.radii(k, digits)
    }

    /// Sections side by side, for [`bent_hoop`](Self::bent_hoop) alone: fields that it does not read are zero.
    #[inline(always)]
    pub(crate) fn columns<T: Copy>(token: S, sections: [&Section<T>; LANES]) -> Self
    where
        S: Lanes<T>,
    {
        let column = |of: fn(&Section<T>) -> T| token.load(&sections.map(of));
        let zero = token.of(0.0);
        Self {
            outer_radius_m: zero,
            length_m: zero,
            shear_modulus_pa: zero,
            inner: zero,
            winding: column(|one| one.winding),
            a: column(|one| one.a),
            b: column(|one| one.b),
            wall: Wall { inner2: column(|one| one.wall.inner2), excess: column(|one| one.wall.excess) },
            slant: zero,
            beyond: zero,
        }
    }

    /// The moment of a winding that keeps its radius, by a number of angles that has a table.
    #[inline(always)]
    pub(crate) fn bent_hoop(&self, k: S, digits: Digits, count: u8) -> Bent<S> {
        self.integrated::<false>(k, digits, &tabled(k, count)[..usize::from(count / 2)])
    }

    /// `WIDE`: several angles at a time, since divisions and roots of one point depend on each other.
    #[inline(always)]
    fn integrated<const WIDE: bool>(&self, k: S, digits: Digits, angles: &[(S, S)]) -> Bent<S> {
        let bend = Bend::new(k, self.winding, self.a, self.b);
        let (mut moment, mut slope, mut halves) = (k.of(0.0), k.of(0.0), k.of(0.0));
        angles.iter().for_each(|_| halves = halves + k.of(2.0));
        // No `for_each`: its closure would not be compiled for the vector registers of the caller.
        let mut panels = self.wall.panels(k, || bend.fold(), digits);
        while let Some(panel) = panels.next() {
            for &(t, weight) in panels.rule() {
                let (square, weight) = panel.node(t, weight);
                let ring = bend.ring(square);
                let mut left = angles;
                while !left.is_empty() {
                    let (count, (density, curve)) = match left.len() {
                        4.. if WIDE => (4, bend.summed::<Eight<S>>(&ring, left)),
                        2.. if WIDE => (2, bend.summed::<Four<S>>(&ring, left)),
                        _ => (1, bend.summed::<Pair<S>>(&ring, left)),
                    };
                    left = &left[count..];
                    moment = moment + density * weight;
                    slope = slope + curve * weight;
                }
            }
        }
        // dA = d(rho^2)/2 dphi, both halves of the section.
        let scale = k.of(core::f64::consts::PI) / halves;
        Bent { k, moment: moment * scale, slope: slope * scale }
    }
}

impl<T: Scalar> Section<Dual<T>> {
    /// Whether the variable of the derivatives leaves the dimensionless section as it is.
    pub(crate) fn keeps_its_shape(&self) -> bool {
        let fixed = |dual: Dual<T>| dual.slope == T::zero();
        // With a helical winding the lever of a load depends on it.
        !self.is_helical() && fixed(self.inner) && fixed(self.winding) && fixed(self.a) && fixed(self.b)
    }
}
