//! Bending: a hoop-wound tube with an inextensible line along its outer face.
//!
//! The wall follows an isochoric map of the section (lengths in units of `R_o`, `k = kappa R_o`, `phi_c` from the
//! inextensible side, winding at `rho_f` which keeps its radius):
//! `(1+k)(rho_f^2 - r^2)/2 - k cos(phi_c)(rho_f^3 - r^3)/3 = (rho_f^2 - rho^2)/2`, stretch `lambda = 1 + k h`, `h = 1 - r cos(phi_c)`.
//! Work balance per length: `P pi R_f^2 R_o + M_ext + N_ext R_o = dU/dkappa`; the pressure's share is the derivative of the
//! volume inside a winding that keeps its radius. This replaces eqs. (10)-(13) of the paper, whose stretch (12) does not vary
//! around the section and whose balance leaves out the pressure carried through the wall.

use crate::jet::Jet;
use crate::parameters::{ActuatorParameters, InvalidParameter, Material, require};
use crate::quadrature::WallRule;
use crate::real::{Real, epsilon, real};
use crate::solution::{Load, Solution, State, Status, Target};

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

/// Longest step of `k` relative to `k + 0.1`, and the largest `k` looked at.
const LONGEST_STEP: f64 = 0.5;
const LARGEST_CURVATURE: f64 = 50.0;
const MARCH_STEPS: u32 = 400;
const REFINE_STEPS: u32 = 100;

/// A bending actuator, ready to solve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bender<T: Real> {
    outer_radius_m: T,
    length_m: T,
    shear_modulus_pa: T,
    /// `rho_i = R_i/R_o` and `rho_f = R_f/R_o`.
    inner: T,
    winding: T,
    /// `psi'(J)/mu1 = 1/2 + a J + b J^2`.
    a: T,
    b: T,
    /// Whether the restoring moment can fall with the curvature.
    softens: bool,
    /// Rules over `rho^2` from `rho_i^2` to 1.
    fine: WallRule<T>,
    coarse: WallRule<T>,
    /// Bends up to which the coarse rules are as good as the scalar can tell.
    coarse_until: T,
}

/// Restoring moment `dU/dkappa / (mu1 R_o^3)` and its slope at one curvature.
#[derive(Clone, Copy)]
struct Bent<T> {
    k: T,
    moment: T,
    slope: T,
}

impl<T: Real> Bender<T> {
    pub(crate) fn new(parameters: &ActuatorParameters<T>) -> Self {
        let outer = parameters.outer_radius_m;
        let mu1 = parameters.material.shear_modulus_pa();
        let (a, b) = match parameters.material {
            Material::NeoHookean { .. } => (T::zero(), T::zero()),
            Material::Yeoh { c_pa } => (real::<T>(2.0) * c_pa[1] / mu1, real::<T>(3.0) * c_pa[2] / mu1),
        };
        let inner = parameters.inner_radius_m / outer;
        let single = epsilon::<T>() > real::<T>(1e-9);
        Self {
            outer_radius_m: outer,
            length_m: parameters.length_m,
            shear_modulus_pa: mu1,
            inner,
            winding: parameters.fiber.map_or(T::one(), |fiber| (fiber.radius_m / outer).min(T::one())),
            a,
            b,
            softens: a < T::zero() || b < T::zero(),
            fine: WallRule::new(inner * inner, T::one()),
            coarse: WallRule::coarse(inner * inner, T::one()),
            coarse_until: if single { real(0.5) } else { T::zero() },
        }
    }

    /// The bend at a gauge pressure.
    pub(crate) fn forward(&self, start: Option<&State<T>>, pressure_pa: T, load: &Load<T>) -> Solution<T> {
        let wanted = pressure_pa / self.shear_modulus_pa * self.lever() + self.load_moment(load);
        let mut iterations = 0;
        // A line that cannot shorten and a winding that cannot push do not bend backwards.
        if wanted < T::zero() {
            let straight = self.bent(T::zero(), &mut iterations);
            return self.solution(Status::NoSolution, straight, load, Some(straight), iterations);
        }
        let from = start.map_or(T::zero(), |state| self.curvature(state.bend_angle_rad));
        // Only a stiffening wall has one bend for every moment, so that any start leads to it.
        let begin = self.bent(if self.softens { T::zero() } else { from.max(T::zero()) }, &mut iterations);
        let mut solution = self.reach(begin, wanted, load, &mut iterations);
        solution.iterations = iterations;
        if solution.status == Status::Solved {
            solution.residual = (solution.state.pressure_pa - pressure_pa).abs() / self.shear_modulus_pa;
            solution.state.pressure_pa = pressure_pa;
        }
        solution
    }

    /// The pressure for a bend angle: explicit, since the balance is linear in the pressure.
    pub(crate) fn inverse(&self, target: Target<T>, load: &Load<T>) -> Result<Solution<T>, InvalidParameter<T>> {
        let Target::BendAngle(angle) = target else { return Err(not_a_bend(target)) };
        require(angle.is_finite() && angle >= T::zero(), "bend_angle_rad", angle, "finite and >= 0")?;
        let k = self.curvature(angle);
        let mut iterations = 0;
        let bent = self.bent(k, &mut iterations);
        if !bent.moment.is_finite() || !bent.slope.is_finite() || k > real::<T>(LARGEST_CURVATURE) {
            let straight = self.bent(T::zero(), &mut iterations);
            return Ok(self.solution(Status::NoSolution, straight, load, None, iterations));
        }
        if self.softens {
            let straight = self.bent(T::zero(), &mut iterations);
            if let Some(limit) = self.limit_before(straight, k, &mut iterations) {
                return Ok(self.solution(Status::NoSolution, limit, load, Some(limit), iterations));
            }
        }
        Ok(self.solution(Status::Solved, bent, load, None, iterations))
    }

    /// Straight, without pressure.
    pub(crate) fn rest(&self) -> State<T> {
        let mut iterations = 0;
        self.state(self.bent(T::zero(), &mut iterations), &Load::none())
    }

    /// `d(volume)/d(kappa)` per length, in units of `R_o^3`.
    fn lever(&self) -> T {
        T::pi() * self.winding * self.winding
    }

    fn load_moment(&self, load: &Load<T>) -> T {
        let r = self.outer_radius_m;
        (load.torque_nm + load.force_n * r) / (self.shear_modulus_pa * r * r * r)
    }

    fn curvature(&self, bend_angle_rad: T) -> T {
        bend_angle_rad * self.outer_radius_m / self.length_m
    }

    /// Raises the curvature from `begin` until the moment is `wanted`, or to the limit point before it.
    fn reach(&self, begin: Bent<T>, wanted: T, load: &Load<T>, iterations: &mut u32) -> Solution<T> {
        let mut here = begin;
        for _ in 0..MARCH_STEPS {
            let newton = (wanted - here.moment) / here.slope;
            if newton.abs() <= epsilon::<T>() * here.k {
                return self.solution(Status::Solved, here, load, None, 0);
            }
            let longest = real::<T>(LONGEST_STEP) * (here.k + real::<T>(0.1));
            let there = self.bent((here.k + newton.min(longest)).max(T::zero()), iterations);
            if !there.moment.is_finite() || !there.slope.is_finite() {
                break;
            }
            if there.slope <= T::zero() {
                let limit = self.refine(here, there, |b| b.slope, iterations);
                let found = wanted <= limit.moment;
                let bent = if found { self.refine(here, limit, |b| b.moment - wanted, iterations) } else { limit };
                let status = if found { Status::Solved } else { Status::NoSolution };
                return self.solution(status, bent, load, (!found).then_some(limit), 0);
            }
            if there.k > real::<T>(LARGEST_CURVATURE) {
                return self.solution(Status::NoSolution, there, load, None, 0);
            }
            // The moment rises here: a change of sign brackets the answer.
            if (there.moment - wanted > T::zero()) != (here.moment - wanted > T::zero()) {
                let bent = self.refine(here, there, |b| b.moment - wanted, iterations);
                return self.solution(Status::Solved, bent, load, None, 0);
            }
            here = there;
        }
        self.solution(Status::NotConverged, here, load, None, 0)
    }

    /// The first limit point below `k`, where the moment stops rising.
    fn limit_before(&self, straight: Bent<T>, k: T, iterations: &mut u32) -> Option<Bent<T>> {
        let mut here = straight;
        while here.k < k {
            let step = real::<T>(0.2 * LONGEST_STEP) * (here.k + real::<T>(0.1));
            let there = self.bent((here.k + step).min(k), iterations);
            if there.slope <= T::zero() {
                return Some(self.refine(here, there, |b| b.slope, iterations));
            }
            here = there;
        }
        None
    }

    /// The zero of `measure` between two bends at which it has opposite signs: secant and bisection in turn.
    fn refine(&self, a: Bent<T>, b: Bent<T>, measure: impl Fn(&Bent<T>) -> T, iterations: &mut u32) -> Bent<T> {
        let (mut low, mut high) = (a, b);
        for round in 0..REFINE_STEPS {
            let (at_low, at_high) = (measure(&low), measure(&high));
            let nearest = if at_low.abs() <= at_high.abs() { low } else { high };
            let width = (high.k - low.k).abs();
            if at_low == T::zero() || at_high == T::zero() || width <= epsilon::<T>() * nearest.k {
                return nearest;
            }
            let secant = low.k - at_low * (high.k - low.k) / (at_high - at_low);
            let inside = (secant - low.k) * (secant - high.k) < T::zero();
            let k = if inside && round % 3 != 2 { secant } else { (low.k + high.k) * real::<T>(0.5) };
            if (k - low.k) * (k - high.k) >= T::zero() {
                return nearest;
            }
            let next = self.bent(k, iterations);
            if (measure(&next) > T::zero()) == (at_low > T::zero()) { low = next } else { high = next }
        }
        low
    }

    fn solution(
        &self,
        status: Status,
        bent: Bent<T>,
        load: &Load<T>,
        limit: Option<Bent<T>>,
        iterations: u32,
    ) -> Solution<T> {
        let limit_pressure_pa = limit.map(|limit| self.pressure(limit, load));
        Solution { status, state: self.state(bent, load), limit_pressure_pa, residual: T::zero(), iterations }
    }

    fn pressure(&self, bent: Bent<T>, load: &Load<T>) -> T {
        (bent.moment - self.load_moment(load)) / self.lever() * self.shear_modulus_pa
    }

    fn state(&self, bent: Bent<T>, load: &Load<T>) -> State<T> {
        let one = T::one();
        let r = self.outer_radius_m;
        let centre_stretch = one + bent.k;
        // Areas per undeformed length in units of pi R_o^2; sections of mean area follow by dividing by the centre stretch.
        let within_winding = self.winding * self.winding * centre_stretch;
        let lumen = within_winding - (self.winding * self.winding - self.inner * self.inner);
        let section = lumen + one - self.inner * self.inner;
        let pressure_slope = bent.slope / self.lever() * self.shear_modulus_pa;
        let volume_scale = T::pi() * r * r * self.length_m;
        State {
            pressure_pa: self.pressure(bent, load),
            axial_stretch: centre_stretch,
            axial_strain: bent.k,
            inner_radius_m: r * (lumen / centre_stretch).sqrt(),
            outer_radius_m: r * (section / centre_stretch).sqrt(),
            twist_rad: T::zero(),
            bend_angle_rad: bent.k * self.length_m / r,
            volume_m3: volume_scale * lumen,
            volume_strain: bent.k * (self.winding / self.inner) * (self.winding / self.inner),
            compliance_m3_per_pa: volume_scale * self.winding * self.winding / pressure_slope,
        }
    }

    /// Integrates the restoring moment over the section.
    fn bent(&self, k: T, iterations: &mut u32) -> Bent<T> {
        *iterations += 1;
        let mut sum = Jet::constant(T::zero());
        let (coarse, fine) = (COARSE_ANGLES.map(constants::<T>), FINE_ANGLES.map(constants::<T>));
        let (radial, angles): (_, &[_]) =
            if k < self.coarse_until { (&self.coarse, &coarse) } else { (&self.fine, &fine) };
        radial.for_each(T::zero(), |rho_squared, weight| {
            let rho = rho_squared.sqrt();
            for &(cos, sin) in angles {
                for cos in [cos, -cos] {
                    sum = sum + Jet::constant(weight) * self.moment_density(k, rho, cos, sin);
                }
            }
        });
        // dA = d(rho^2)/2 dphi; two mirror images of each angle, both halves of the section.
        let scale =
            T::pi() * if angles.len() == FINE_ANGLES.len() { real::<T>(1.0 / 16.0) } else { real::<T>(1.0 / 8.0) };
        Bent { k, moment: sum.value * scale, slope: sum.slope * scale }
    }

    /// `psi'(J)/mu1 dJ/dk` at one point of the section, with its slope in `k`.
    fn moment_density(&self, k: T, rho: T, cos: T, sin: T) -> Jet<T> {
        let c = Jet::constant;
        let (one, two, three) = (c(T::one()), c(real::<T>(2.0)), c(real::<T>(3.0)));
        let radius = self.deformed_radius(k, rho, cos);
        let g_value = self.inward_shift(radius, cos);
        let stretch_value = T::one() + k * (T::one() - radius * cos);
        let k = Jet::new(k, T::one());
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
        let stiffness = c(real::<T>(0.5)) + invariant * (c(self.a) + c(self.b) * invariant);
        stiffness * invariant_k
    }

    /// `G = (rho_f^2 - r^2)/2 - cos (rho_f^3 - r^3)/3`, so that `r^2 = rho^2 + 2 k G(r)`.
    fn inward_shift(&self, r: T, cos: T) -> T {
        let f = self.winding;
        (f * f - r * r) * real::<T>(0.5) - cos * (f * f * f - r * r * r) / real::<T>(3.0)
    }

    /// Where the material radius `rho` goes: the root of the isochoric map, by Newton in `r^2`, in which it is nearly linear. Its
    /// slope `1 + k h` is at least one.
    fn deformed_radius(&self, k: T, rho: T, cos: T) -> T {
        let square = rho * rho;
        let (mut r2, mut r) = (square, rho);
        for _ in 0..60 {
            let rest = square + real::<T>(2.0) * k * self.inward_shift(r, cos) - r2;
            let step = rest / (T::one() + k * (T::one() - r * cos));
            // The root is positive; a step beyond zero is cut short.
            let next = (r2 + step).max(r2 * real::<T>(0.25));
            let settled = (next - r2).abs() <= epsilon::<T>() * next;
            (r2, r) = (next, next.sqrt());
            if settled {
                break;
            }
        }
        r
    }
}

/// A cosine and sine in the scalar: converted while they are still constants of the source.
fn constants<T: Real>((cos, sin): (f64, f64)) -> (T, T) {
    (real(cos), real(sin))
}

fn not_a_bend<T: Real>(target: Target<T>) -> InvalidParameter<T> {
    let (field, value) = match target {
        Target::AxialStretch(value) => ("axial_stretch", value),
        Target::OuterRadius(value) => ("outer_radius_m", value),
        Target::InnerRadius(value) => ("inner_radius_m", value),
        Target::Twist(value) => ("twist_rad", value),
        Target::BendAngle(value) => ("bend_angle_rad", value),
    };
    InvalidParameter { field, value, allowed: "not a target of bending actuators: give bend_angle_rad" }
}
