//! The first pressure at which the segments add up to a target.
//!
//! The pressure is raised in steps over which the total moves as its slopes at both ends say, so that neither the target nor a turning
//! point is stepped over; between two steps, Newton's method with the exact slope is kept inside its bracket.

use crate::number::real::{Real, epsilon, real};
use crate::parameters::InvalidParameter;
use crate::precision::Precision;
use crate::sensitivity::Parameter;
use crate::solution::{Load, State, Status};

use super::sum::Sum;
use super::{Series, SeriesLimit, SeriesSolution, SeriesState, SeriesTarget};

/// First step, as a share of the pressure that would double the volume of the softest bare segment.
const FIRST_STEP: f64 = 0.1;
/// A step may be off its slopes by this share of what it moves.
const STRAIGHT: f64 = 0.1;
/// Steps grow with the pressure, and by this factor at most.
const GROWTH: f64 = 2.0;
/// Largest pressure of the search, in units of the largest shear modulus.
const LARGEST_PRESSURE: f64 = 1e4;
/// Distance from a limit pressure at which the search evaluates the limit itself, as a share of that pressure.
const NEAR_LIMIT: f64 = 1e-9;
const MOST_STEPS: u32 = 2000;
const REFINE_STEPS: u32 = 100;

/// The total against its target at one pressure.
#[derive(Clone, Copy)]
struct At<T> {
    pressure: T,
    /// Total less target, and its slope; the slope is not finite at a limit point.
    excess: T,
    slope: T,
    solution: SeriesSolution<T>,
}

impl<T: Real> At<T> {
    /// Whether the target lies between two totals.
    fn encloses(&self, other: &Self) -> bool {
        (self.excess > T::zero()) != (other.excess > T::zero())
    }
}

struct Search<'s, 'a, T: Precision> {
    series: &'s Series<'a, T>,
    load: &'s Load<T>,
    target: SeriesTarget<T>,
    iterations: u32,
}

type Found<T> = Result<SeriesSolution<T>, InvalidParameter<T>>;

pub(super) fn search<T: Precision>(series: &Series<'_, T>, target: SeriesTarget<T>, load: &Load<T>) -> Found<T> {
    let mut search = Search { series, load, target, iterations: 0 };
    let found = search.raise()?;
    Ok(SeriesSolution { iterations: search.iterations, ..found })
}

impl<T: Precision> Search<'_, '_, T> {
    fn at(&mut self, pressure: T) -> Result<At<T>, InvalidParameter<T>> {
        let (mut slope, zero) = (T::zero(), T::zero());
        let (segments, load, target) = (self.series.segments(), self.load, self.target);
        let mut sum = Sum::new(pressure);
        for (index, actuator) in segments.iter().enumerate() {
            let solution = actuator.forward(pressure, load)?;
            sum.add(index, actuator, &solution);
            if solution.status == Status::Solved {
                // No finite slope at a limit point: the bracket then does without.
                let change = actuator.sensitivity(&solution.state, load, Parameter::Pressure).ok();
                let own = change.map(|change| moved(target, actuator.parameters().length_m, &change));
                slope += own.unwrap_or(T::one() / zero);
            }
        }
        let mut solution = sum.solution();
        if let Some(SeriesLimit { segment, pressure_pa: Some(limit) }) = solution.limit {
            solution = self.series.at_limit(segment, limit, load, sum)?;
        }
        self.iterations = self.iterations.saturating_add(solution.iterations);
        let excess = excess(target, &solution.state);
        Ok(At { pressure: solution.state.pressure_pa, excess, slope, solution })
    }

    fn raise(&mut self) -> Found<T> {
        let mut here = self.at(T::zero())?;
        let shortest = real::<T>(64.0) * epsilon::<T>();
        let mut step = self.first_step();
        let first_step = step;
        let mut limit: Option<At<T>> = None;
        for _ in 0..MOST_STEPS {
            if here.solution.status != Status::Solved || here.excess == T::zero() {
                return Ok(here.solution);
            }
            if let Some(end) = limit {
                let left = end.pressure - here.pressure;
                if left <= real::<T>(NEAR_LIMIT).max(shortest) * end.pressure {
                    return if here.encloses(&end) { self.refine(here, end) } else { Ok(end.solution) };
                }
                step = step.min(left * real::<T>(0.5));
            }
            let there = self.at(here.pressure + step)?;
            match there.solution.status {
                Status::Solved => {}
                Status::NoSolution
                    if limit.is_none() && there.solution.limit.is_some_and(|l| l.pressure_pa.is_some()) =>
                {
                    limit = Some(there);
                    continue;
                }
                Status::NoSolution => return Ok(there.solution),
                Status::NotConverged if step <= shortest * here.pressure.max(first_step) => return Ok(there.solution),
                Status::NotConverged => {
                    step *= real::<T>(0.25);
                    continue;
                }
            }
            if !self.is_straight(&here, &there) && step > shortest * there.pressure {
                step *= real::<T>(0.25);
                continue;
            }
            if here.encloses(&there) {
                return self.refine(here, there);
            }
            if let Some(turned) = self.turning_point(&here, &there)? {
                return self.refine(here, turned);
            }
            here = there;
            step = (step * real::<T>(GROWTH)).min(here.pressure.max(first_step));
            if here.pressure > self.largest_pressure() {
                break;
            }
        }
        // Nothing ends here: the target is simply not met.
        Ok(SeriesSolution { status: Status::NoSolution, limit: None, ..here.solution })
    }

    fn first_step(&self) -> T {
        let softest = |least: T, modulus: T| if modulus < least { modulus } else { least };
        let moduli = self.series.segments().iter().map(|actuator| {
            let p = actuator.parameters();
            let ratio = p.inner_radius_m / p.outer_radius_m;
            p.material.shear_modulus_pa() * (T::one() - ratio * ratio)
        });
        moduli.reduce(softest).unwrap_or(T::one()) * real::<T>(FIRST_STEP)
    }

    fn largest_pressure(&self) -> T {
        let moduli = self.series.segments().iter().map(|actuator| actuator.parameters().material.shear_modulus_pa());
        moduli.fold(T::zero(), |most, modulus| most.max(modulus)) * real::<T>(LARGEST_PRESSURE)
    }

    /// Whether the total moved as the slopes at both ends say.
    fn is_straight(&self, a: &At<T>, b: &At<T>) -> bool {
        let step = b.pressure - a.pressure;
        let off = (b.excess - a.excess - (a.slope + b.slope) * real::<T>(0.5) * step).abs();
        let rounding =
            real::<T>(64.0) * epsilon::<T>() * (a.excess.abs() + b.excess.abs() + target_value(self.target).abs());
        off <= real::<T>(STRAIGHT) * step * a.slope.abs().max(b.slope.abs()) + rounding
    }

    /// The pressure between two at which the total turns, where it reaches across the target there.
    fn turning_point(&mut self, a: &At<T>, b: &At<T>) -> Result<Option<At<T>>, InvalidParameter<T>> {
        let (mut low, mut high) = (*a, *b);
        let towards = |at: &At<T>| at.excess * at.slope < T::zero();
        if !towards(&low) || towards(&high) {
            return Ok(None);
        }
        for _ in 0..REFINE_STEPS {
            let middle = (low.pressure + high.pressure) * real::<T>(0.5);
            if middle <= low.pressure || middle >= high.pressure {
                break;
            }
            let next = self.at(middle)?;
            if next.encloses(a) {
                return Ok(Some(next));
            }
            if towards(&next) { low = next } else { high = next }
        }
        Ok(None)
    }

    /// The pressure between two that enclose the target: Newton's method where it stays inside, else halves.
    fn refine(&mut self, a: At<T>, b: At<T>) -> Found<T> {
        let (mut low, mut high) = (a, b);
        for round in 0..REFINE_STEPS {
            let nearest = if low.excess.abs() <= high.excess.abs() { low } else { high };
            let newton = nearest.pressure - nearest.excess / nearest.slope;
            let tolerance = epsilon::<T>() * nearest.pressure;
            let settled = (newton - nearest.pressure).abs() <= tolerance;
            let solved = nearest.solution.status == Status::Solved;
            if solved && (nearest.excess == T::zero() || settled || high.pressure - low.pressure <= tolerance) {
                return Ok(nearest.solution);
            }
            let middle = (low.pressure + high.pressure) * real::<T>(0.5);
            let inside = newton > low.pressure && newton < high.pressure;
            let pressure = if inside && round % 3 != 2 { newton } else { middle };
            if pressure <= low.pressure || pressure >= high.pressure {
                break;
            }
            let next = self.at(pressure)?;
            if next.solution.status != Status::Solved {
                return Ok(next.solution);
            }
            if next.encloses(&low) { high = next } else { low = next }
        }
        let solved = |at: &At<T>| at.solution.status == Status::Solved;
        let low_is_nearer = low.excess.abs() <= high.excess.abs() || !solved(&high);
        Ok(if low_is_nearer { low.solution } else { high.solution })
    }
}

/// Contribution of one segment's change to the target.
fn moved<T: Real>(target: SeriesTarget<T>, length_m: T, change: &State<T>) -> T {
    match target {
        SeriesTarget::Extension(_) => length_m * change.axial_strain,
        SeriesTarget::Twist(_) => change.twist_rad,
        SeriesTarget::BendAngle(_) => change.bend_angle_rad,
    }
}

fn excess<T: Real>(target: SeriesTarget<T>, state: &SeriesState<T>) -> T {
    match target {
        SeriesTarget::Extension(value) => state.extension_m - value,
        SeriesTarget::Twist(value) => state.twist_rad - value,
        SeriesTarget::BendAngle(value) => state.bend_angle_rad - value,
    }
}

fn target_value<T: Real>(target: SeriesTarget<T>) -> T {
    match target {
        SeriesTarget::Extension(value) | SeriesTarget::Twist(value) | SeriesTarget::BendAngle(value) => value,
    }
}
