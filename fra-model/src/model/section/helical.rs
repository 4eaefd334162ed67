//! A bent section with a helical winding: two equal families of a thread that does not stretch, on a surface of the wall.
//!
//! Where the wall is stretched along the axis by `lambda`, such a winding shrinks around it: `lambda_c^2 = 1 - t (lambda^2 - 1)` with
//! `t = tan^2` of its angle. The surface of the winding stays a circle, of radius `rho = rho_f/(1+s)`, at `d = rho + 1 - rho_f` from the
//! inextensible line, and its points move around it: `phi'(phi_c) = (1+s) lambda_c`, where `s` closes the circle. The wall inside
//! keeps its volume, and the points of a ray stay on one ray:
//! `((1+kd)(rho^2 - r^2)/2 - k cos(phi) (rho^3 - r^3)/3) phi' = (rho_f^2 - rho_0^2)/2`, `lambda = 1 + k (d - r cos(phi))`.
//! With `t = 0` all of this is the map of a hoop. The moment is the derivative of the energy, by dual numbers.

#[cfg(test)]
mod tests;

use crate::number::dual::Dual;
use crate::number::scalar::Scalar;

const ROUNDS: u32 = 60;

/// Largest `t (lambda^2 - 1)`: at 1 the thread lies along the axis.
const CLOSED: f64 = 0.98;

/// A number with its first two derivatives by `k`.
type Twice<T> = Dual<Dual<T>>;

/// The circle of the winding at a bend, in units of `R_o`.
#[derive(Clone, Copy)]
pub(super) struct Circle<S> {
    k: S,
    slant: S,
    /// `rho_f`, `s`, `rho` and `d`.
    winding: S,
    shrinkage: S,
    radius: S,
    line: S,
}

/// The winding at an angle around the circle.
struct Turn<S> {
    /// `phi'`, `phi' - 1`, the slope of `phi'` in `phi_c`, `t (lambda^2 - 1)`, and `rho_f lambda_c`.
    rate: S,
    gain: S,
    rate_slope: S,
    lost: S,
    reach: S,
    cos: S,
    sin: S,
}

impl<S: Scalar> Circle<S> {
    fn with(k: S, slant: S, winding: S, shrinkage: S) -> Self {
        let radius = winding / (S::one() + shrinkage);
        Self { k, slant, winding, shrinkage, radius, line: radius + S::one() - winding }
    }

    /// Strain along the axis at the winding, and `t (lambda^2 - 1)` there.
    fn strain(&self, cos: S) -> (S, S) {
        let strain = self.k * (self.line - self.radius * cos);
        (strain, self.slant * strain * (strain + S::constant(2.0)))
    }

    /// Newton step for `s`, the mean of `1/lambda_c - 1` over the cosines.
    fn step(&self, cosines: impl Iterator<Item = S>) -> S {
        let one = S::one();
        let (mut sum, mut slope, mut count) = (S::zero(), S::zero(), S::zero());
        for half in cosines {
            for cos in [half, -half] {
                let (strain, lost) = self.strain(cos);
                let square = one - lost;
                let root = square.sqrt();
                sum += lost / (root * (one + root));
                let by_shrinkage = -(self.k * self.radius * (one - cos) / (one + self.shrinkage));
                slope += self.slant * (one + strain) * by_shrinkage / (square * root);
                count += one;
            }
        }
        (sum / count - self.shrinkage) / (one - slope / count)
    }

    /// Volume gained within the winding, per length and divided by `pi`: `rho^2 (1 + k d) - rho_f^2`.
    pub(super) fn swell(&self) -> S {
        let closer = S::one() + self.shrinkage;
        let lost = self.shrinkage * (S::constant(2.0) + self.shrinkage);
        self.winding * self.winding * (self.k * self.line - lost) / (closer * closer)
    }

    /// Strain of the axis, `k d`.
    pub(super) fn axial_strain(&self) -> S {
        self.k * self.line
    }

    fn turn(&self, cos: S, sin: S) -> Turn<S> {
        let one = S::one();
        let (strain, lost) = self.strain(cos);
        let root = (one - lost).sqrt();
        let closer = one + self.shrinkage;
        Turn {
            rate: closer * root,
            gain: self.shrinkage * root - lost / (one + root),
            rate_slope: -(closer * self.slant * (one + strain) * self.k * self.radius * sin / root),
            lost,
            reach: self.winding * root,
            cos,
            sin,
        }
    }

    /// `r phi'` at a ring of squared radius `square`, by Newton's method from a guess, and the strains there: `lambda^2 - 1` around the axis
    /// and along it, and the squared lean.
    fn strains(&self, turn: &Turn<S>, square: S, guess: S, rounds: u32) -> (S, [S; 3]) {
        let (one, two, three) = (S::one(), S::constant(2.0), S::constant(3.0));
        let stretch = one + self.axial_strain();
        let missing = self.winding * self.winding - square;
        // u^2 - rho_0^2 = near - bow (reach^3 - u^3) for u = r phi'.
        let near = missing * (self.axial_strain() - turn.gain) / stretch - self.winding * self.winding * turn.lost;
        let bow = two * self.k * turn.cos / (three * turn.rate * stretch);
        let outer = turn.reach * turn.reach * turn.reach;
        let mut u = guess;
        let mut left = S::ORDER;
        for _ in 0..rounds {
            let off = u * u - square - near + bow * (outer - u * u * u);
            let step = off / (two * u - three * bow * u * u);
            u = (u - step).max(u * S::constant(0.5));
            if step.abs() <= S::epsilon() * u {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
        }
        let depth = outer - u * u * u;
        let around = (near - bow * depth) / square;
        let strain = self.k * (self.line - u / turn.rate * turn.cos);
        let lean =
            (self.k * turn.sin * depth / (three * turn.rate) + missing * turn.rate_slope / two) / (u * (one + strain));
        (u, [around, strain * (strain + two), lean * lean / square])
    }
}

fn lifted<T: Scalar>(value: T) -> Twice<T> {
    Dual::fixed(Dual::fixed(value))
}

impl<T: Scalar> Circle<T> {
    /// The circle that closes around a bend; `None` where the thread would lie along the axis.
    pub(super) fn new(k: T, slant: T, winding: T, cosines: impl Iterator<Item = T> + Clone) -> Option<Self> {
        let mut circle = Self::with(k, slant, winding, T::zero());
        let is_open = circle.strain(-T::one()).1 < T::constant(CLOSED);
        if !is_open {
            return None;
        }
        let mut left = T::ORDER;
        for _ in 0..ROUNDS {
            let step = circle.step(cosines.clone());
            circle = Self::with(k, slant, winding, circle.shrinkage + step);
            if step.abs() <= T::epsilon() {
                if left == 0 {
                    break;
                }
                left -= 1;
            }
        }
        Some(circle)
    }

    /// The same circle with its first two derivatives by `k`.
    pub(super) fn twice(&self, cosines: impl Iterator<Item = T> + Clone) -> Circle<Twice<T>> {
        let k = Dual::variable(Dual::variable(self.k));
        let (slant, winding) = (lifted(self.slant), lifted(self.winding));
        let mut circle = Circle::with(k, slant, winding, lifted(self.shrinkage));
        // Each step of Newton's method settles one more derivative.
        for _ in 0..2 {
            let step = circle.step(cosines.clone().map(lifted));
            circle = Circle::with(k, slant, winding, circle.shrinkage + step);
        }
        circle
    }

    /// Strain energy of the ray at an angle, in units of `mu1`, integrated over the squared radius. `law` has the coefficients `a` and `b`; `nodes`
    /// passes the nodes of the wall to a function.
    pub(super) fn ray(
        &self,
        twice: &Circle<Twice<T>>,
        (cos, sin): (T, T),
        law: [T; 2],
        nodes: impl FnOnce(&mut dyn FnMut(T, T)),
    ) -> Twice<T> {
        let (turn, turning) = (self.turn(cos, sin), twice.turn(lifted(cos), lifted(sin)));
        let [a, b] = law.map(lifted);
        let (one, half, third) = (Twice::<T>::one(), Twice::<T>::constant(0.5), Twice::<T>::constant(1.0 / 3.0));
        let mut sum = Twice::<T>::zero();
        nodes(&mut |square, weight| {
            let missing = self.winding * self.winding - square;
            let guess = turn.reach * turn.reach - turn.rate * missing / (T::one() + self.axial_strain());
            let guess = Scalar::max(guess, square * T::constant(0.05)).sqrt();
            let (u, _) = self.strains(&turn, square, guess, ROUNDS);
            let (_, [around, along, lean]) = twice.strains(&turning, lifted(square), lifted(u), 2);
            let crossed = around * along;
            let strain = around * around + crossed + along * along + crossed * (around + along);
            let invariant = strain / ((one + around) * (one + along)) + lean;
            sum += invariant * (half + invariant * (a * half + invariant * b * third)) * lifted(weight);
        });
        sum / turning.rate
    }
}
