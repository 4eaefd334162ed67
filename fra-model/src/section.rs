//! The section of a bending actuator: its restoring moment by quadrature, and the state that belongs to a bend.
//!
//! Everything here is computed in any [`Scalar`], so that the derivatives with respect to the parameters are those of the same code.

use crate::jet::Jet;
use crate::parameters::{ActuatorParameters, Material};
use crate::quadrature::WallRule;
use crate::scalar::Scalar;
use crate::solution::State;

/// Cosine and sine of the angles `pi (2j+1)/32`, j = 0..8: with their mirror images the midpoint rule of 16 angles on half a turn,
/// which converges faster than any power for the smooth periodic integrand.
const FINE_ANGLES: [(f64, f64); 8] = [
    (0.995_184_726_672_196_9, 0.098_017_140_329_560_6),
    (0.956_940_335_732_208_9, 0.290_284_677_254_462_33),
    (0.881_921_264_348_355, 0.471_396_736_825_997_64),
    (0.773_010_453_362_737, 0.634_393_284_163_645_5),
    (0.634_393_284_163_645_5, 0.773_010_453_362_737),
    (0.471_396_736_825_997_64, 0.881_921_264_348_355),
    (0.290_284_677_254_462_33, 0.956_940_335_732_208_9),
    (0.098_017_140_329_560_6, 0.995_184_726_672_196_9),
];

/// The same for 8 angles: enough for single precision.
const COARSE_ANGLES: [(f64, f64); 4] = [
    (0.980_785_280_403_230_4, 0.195_090_322_016_128_25),
    (0.831_469_612_302_545_2, 0.555_570_233_019_602_2),
    (0.555_570_233_019_602_2, 0.831_469_612_302_545_2),
    (0.195_090_322_016_128_25, 0.980_785_280_403_230_4),
];

/// Bends `k` up to which 16, 32 and 64 angles are enough for a double: the integrand's strip of analyticity narrows as `sqrt(2/k)`.
const ANGLES_UNTIL: [f64; 3] = [1.0, 4.0, 16.0];

/// Bends up to which equal panels are enough.
const UNGRADED_UNTIL: f64 = 0.4;

/// Most of Newton's steps to find where a point of the section goes.
const RADIUS_STEPS: u32 = 60;

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
    /// Rules over `rho^2` from `rho_i^2` to 1.
    fine: WallRule<T>,
    coarse: WallRule<T>,
    /// Bends up to which the coarse rules are as good as the scalar can tell.
    coarse_until: T,
}

/// Restoring moment `dU/dkappa / (mu1 R_o^3)` and its slope at one curvature.
#[derive(Clone, Copy)]
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
        let single = T::epsilon() > T::constant(1e-9);
        Self {
            outer_radius_m: outer,
            length_m: parameters.length_m,
            shear_modulus_pa: mu1,
            inner,
            winding: parameters.fiber.as_ref().map_or(one, |fiber| fiber.radius_m / outer),
            a,
            b,
            fine: WallRule::new(inner * inner, one),
            coarse: WallRule::coarse(inner * inner, one),
            coarse_until: if single { T::constant(0.5) } else { zero },
        }
    }

    pub(crate) fn shear_modulus_pa(&self) -> T {
        self.shear_modulus_pa
    }

    /// Whether the restoring moment can fall with the curvature.
    pub(crate) fn softens(&self) -> bool {
        self.a < T::zero() || self.b < T::zero()
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
        let [few, some, many] = ANGLES_UNTIL.map(T::constant);
        if k < self.coarse_until {
            self.integrated(k, COARSE_ANGLES.map(constants))
        } else if k < few {
            self.integrated(k, FINE_ANGLES.map(constants))
        } else if k < some {
            self.integrated(k, equal_angles::<T, 16>())
        } else if k < many {
            self.integrated(k, equal_angles::<T, 32>())
        } else {
            self.integrated(k, equal_angles::<T, 64>())
        }
    }

    fn integrated<const N: usize>(&self, k: T, angles: [(T, T); N]) -> Bent<T> {
        let mut sum = Jet::fixed(T::zero());
        self.for_each_radius(k, |rho_squared, weight| {
            let rho = rho_squared.sqrt();
            for (cos, sin) in angles {
                for cos in [cos, -cos] {
                    sum += Jet::fixed(weight) * self.moment_density(k, rho, cos, sin);
                }
            }
        });
        // dA = d(rho^2)/2 dphi; two mirror images of each angle, both halves of the section.
        let scale = T::constant(core::f64::consts::PI / (2 * N) as f64);
        Bent { k, moment: sum.value * scale, slope: sum.slope * scale }
    }

    /// Calls `f(rho^2, weight)` at the nodes over the wall that a bend takes.
    fn for_each_radius(&self, k: T, f: impl FnMut(T, T)) {
        if k < self.coarse_until {
            return self.coarse.for_each(T::zero(), f);
        }
        if k < T::constant(UNGRADED_UNTIL) {
            return self.fine.for_each(T::zero(), f);
        }
        // On the side of the inextensible line the map folds beyond the outer face, where d(rho^2)/d(r^2) = 1 + k h vanishes: at r = 1 + 1/k.
        let r = T::one() + T::one() / k;
        let fold = r * r - T::constant(2.0) * k * self.inward_shift(r, T::one());
        self.fine.for_each_towards_end(fold.ln(), f);
    }

    /// `psi'(J)/mu1 dJ/dk` at one point of the section, with its slope in `k`.
    fn moment_density(&self, k: T, rho: T, cos: T, sin: T) -> Jet<T> {
        let c = Jet::fixed;
        let (one, two, three) = (c(T::one()), c(T::constant(2.0)), c(T::constant(3.0)));
        let radius = self.deformed_radius(k, rho, cos);
        let g_value = self.inward_shift(radius, cos);
        let stretch_value = T::one() + k * (T::one() - radius * cos);
        let k = Jet::variable(k);
        let r = Jet::new(radius, g_value / (radius * stretch_value));
        let (rho, cos, sin, winding) = (c(rho), c(cos), c(sin), c(self.winding));

        let r2 = r * r;
        let reach = winding * winding * winding - r2 * r;
        let shift = (winding * winding - r2) / two - cos * reach / three;
        let h = one - r * cos;
        let stretch = one + k * h;
        let r_k = shift / (r * stretch);
        let stretch_k = h - k * cos * r_k;
        // Shear of the section: r_f = (1/R) dr/dphi_c times R.
        let lean = k * sin * reach / (three * r * stretch);
        let lean_k =
            sin * reach / (three * r * stretch) - k * sin * r * r_k / stretch - lean * (r_k / r + stretch_k / stretch);

        let eta = two * k * shift / (rho * rho);
        let eps = k * h * (two + k * h);
        let (p, q) = (one + eta, one + eps);
        let pq = p * q;
        let invariant = (eta * eta + eta * eps + eps * eps + eta * eps * (eta + eps)) / pq + lean * lean / (rho * rho);
        let by_radius = (eta * (two + eta) * q + eps) / pq * (r_k / r);
        let by_stretch = (eps * (two + eps) * p + eta) / pq * (stretch_k / stretch);
        let by_lean = lean * lean_k / (rho * rho);
        let invariant_k = two * (by_radius + by_stretch + by_lean);
        let stiffness = c(T::constant(0.5)) + invariant * (c(self.a) + c(self.b) * invariant);
        stiffness * invariant_k
    }

    /// `G = (rho_f^2 - r^2)/2 - cos (rho_f^3 - r^3)/3`, so that `r^2 = rho^2 + 2 k G(r)`.
    fn inward_shift(&self, r: T, cos: T) -> T {
        let f = self.winding;
        (f * f - r * r) * T::constant(0.5) - cos * (f * f * f - r * r * r) / T::constant(3.0)
    }

    /// Where the material radius `rho` goes: the root of the isochoric map, by Newton in `r^2`, in which it is nearly linear. Its
    /// slope `1 + k h` is at least one.
    fn deformed_radius(&self, k: T, rho: T, cos: T) -> T {
        let square = rho * rho;
        let (mut r2, mut r) = (square, rho);
        // A derivative settles one step after what it is the derivative of.
        let mut left = T::ORDER;
        for _ in 0..RADIUS_STEPS {
            let rest = square + T::constant(2.0) * k * self.inward_shift(r, cos) - r2;
            let step = rest / (T::one() + k * (T::one() - r * cos));
            // The root is positive; a step beyond zero is cut short.
            let next = (r2 + step).max(r2 * T::constant(0.25));
            let settled = (next - r2).abs() <= T::epsilon() * next;
            (r2, r) = (next, next.sqrt());
            if settled && left == 0 {
                break;
            }
            left -= u32::from(settled);
        }
        r
    }
}

/// Cosine and sine of the first half of `2 N` equal angles on half a turn, `pi (2j+1)/(4 N)`.
fn equal_angles<T: Scalar, const N: usize>() -> [(T, T); N] {
    let half_step = T::constant(core::f64::consts::PI / (4 * N) as f64);
    let mut odd = -T::one();
    core::array::from_fn(|_| {
        odd += T::constant(2.0);
        let angle = odd * half_step;
        (angle.cos(), angle.sin())
    })
}

/// One direction of a table in the scalar: converted while it is still a constant of the source.
fn constants<T: Scalar>((cos, sin): (f64, f64)) -> (T, T) {
    (T::constant(cos), T::constant(sin))
}
