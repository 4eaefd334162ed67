//! The gauge pressure for a deformation.

use core::fmt;

use super::chebyshev::Chebyshev;
use crate::number::real::{Real, epsilon, real};
use crate::parameters::{InvalidParameter, require};

/// Fewest and most steps of a table.
const STEPS: core::ops::RangeInclusive<u16> = 256..=32_768;

/// Largest pressure a table may end at, Pa: beyond any actuator, and no sum of coefficients overflows below it.
const PRESSURE_MAX_PA: f64 = 1e9;

/// A series of a function between zero and `P` has no coefficient beyond `4/pi P`.
const LARGEST_COEFFICIENT: f64 = 2.0;

/// The variable in which the pressure is a polynomial, from the share `t` of the way from the table's first target to its last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Argument {
    /// `t` itself.
    Linear,
    /// `sqrt(t)`: where the deformation starts with the square of the pressure, as next to the neutral angle.
    Root,
}

/// Parameters of an inverse table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableParameters<'a, T> {
    /// Target at zero gauge pressure, in the unit of the target.
    pub from: T,
    /// Target at the highest pressure; above or below `from`.
    pub to: T,
    /// Argument of the polynomial.
    pub argument: Argument,
    /// Steps of the grid that the argument is rounded to, `256..=32768`.
    pub steps: u16,
    /// Highest pressure the table gives, gauge Pa, > 0 and at most 1e9.
    pub pressure_max_pa: T,
    /// Chebyshev coefficients on the range of the argument, Pa, from `c_0`; 1 to 17, none beyond `2 pressure_max_pa`.
    pub coefficients: &'a [T],
}

/// A total function from targets to gauge pressures: any finite target gives a finite pressure between zero and the highest one,
/// and the target's distance from the table's range.
///
/// ```
/// use fra_model::*;
/// // P = 50 kPa at a bend of 1 rad, in proportion: c_0 + c_1 (2t - 1).
/// let table = InverseTable::new(&TableParameters {
///     from: 0.0_f32,
///     to: 1.0,
///     argument: Argument::Linear,
///     steps: 1024,
///     pressure_max_pa: 50e3,
///     coefficients: &[25e3, 25e3],
/// })?;
/// assert_eq!(table.lookup(0.5), Ok(Lookup { pressure_pa: 25e3, beyond: 0.0 }));
/// assert_eq!(table.lookup(1.25), Ok(Lookup { pressure_pa: 50e3, beyond: 0.25 }));
/// assert_eq!(table.lookup(f32::NAN), Err(NotFinite));
/// # Ok::<(), InvalidParameter<f32>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseTable<T> {
    from: T,
    scale: T,
    argument: Argument,
    steps: T,
    step: T,
    pressure_max_pa: T,
    polynomial: Chebyshev<T>,
}

/// Result of a lookup.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup<T> {
    /// Gauge pressure, Pa, between zero and the table's highest.
    pub pressure_pa: T,
    /// Distance of the target from the table, as a fraction of its range; zero inside. Outside, the pressure is that of the nearer end.
    pub beyond: T,
}

/// The argument of a table is no finite number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite;

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the argument of a table is not a finite number")
    }
}

impl core::error::Error for NotFinite {}

impl<T: Real> InverseTable<T> {
    /// Checks the parameters. That the table rises, and how well it fits an actuator, is for its builder to verify.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the first field that is not accepted.
    pub fn new(parameters: &TableParameters<'_, T>) -> Result<Self, InvalidParameter<T>> {
        let TableParameters { from, to, argument, steps, pressure_max_pa, coefficients } = *parameters;
        require(from.is_finite(), "from", from, "finite")?;
        let scale = T::one() / (to - from);
        let ranged = to.is_finite() && scale.is_finite() && scale != T::zero();
        require(ranged, "to", to, "finite and apart from the first target")?;
        let count = T::from_u16(steps).unwrap_or(T::zero());
        require(STEPS.contains(&steps), "steps", count, "256 to 32768")?;
        let positive = pressure_max_pa.is_finite() && pressure_max_pa > T::zero();
        let bounded = positive && pressure_max_pa <= real(PRESSURE_MAX_PA);
        require(bounded, "pressure_max_pa", pressure_max_pa, "> 0 and at most 1e9")?;
        let polynomial = Chebyshev::new(coefficients, real::<T>(LARGEST_COEFFICIENT) * pressure_max_pa)?;
        Ok(Self { from, scale, argument, steps: count, step: T::one() / count, pressure_max_pa, polynomial })
    }

    /// The pressure for a target. Outside of its range the table has the value of the nearer end.
    ///
    /// # Errors
    /// [`NotFinite`] for NaN and infinities.
    #[inline]
    pub fn lookup(&self, target: T) -> Result<Lookup<T>, NotFinite> {
        if !target.is_finite() {
            return Err(NotFinite);
        }
        let share = (target - self.from) * self.scale;
        let inside = share.clamp(T::zero(), T::one());
        let argument = match self.argument {
            Argument::Linear => inside,
            Argument::Root => inside.sqrt(),
        };
        // Adding the number from which on the scalar has no fractions rounds to a whole number of steps.
        let whole = T::one() / epsilon::<T>();
        let nearest = (argument * self.steps + whole) - whole;
        Ok(Lookup { pressure_pa: self.at_whole(nearest), beyond: (share - inside).abs() })
    }

    /// The pressure, Pa, at a step of the grid, from zero to the number of steps: together these are all values that
    /// [`lookup`](Self::lookup) has.
    pub fn at_step(&self, step: u16) -> T {
        self.at_whole(T::from_u16(step).unwrap_or(self.steps).min(self.steps))
    }

    #[inline]
    fn at_whole(&self, step: T) -> T {
        self.polynomial.at(step * self.step).clamp(T::zero(), self.pressure_max_pa)
    }

    /// Highest pressure the table gives, gauge Pa.
    pub fn pressure_max_pa(&self) -> T {
        self.pressure_max_pa
    }
}
