//! Sine and cosine in the scalar's own precision.
//!
//! Single-precision libraries compute them in double, which a microcontroller without a double-precision unit does in software, at
//! about a thousand instructions a call. These take some sixty and give host and microcontroller the same bits.

use crate::number::real::{Real, epsilon, real};

/// Largest angle that needs no reduction, rad: a little more than an eighth of a turn, so that one reduction is enough.
const REDUCED: f64 = 0.8;

/// `(sin, cos)` of an angle, rad, with at most one unit in the last place of error up to 4096 quarter turns in `f32` and 2^26 in `f64`.
///
/// Beyond, the result is that of an angle whose relative distance from the given one is below the square of the machine epsilon.
/// Not a number where the angle is not finite.
pub(crate) fn sin_cos<T: Real>(angle: T) -> (T, T) {
    if !angle.is_finite() {
        let nan = angle * T::zero();
        return (nan, nan);
    }
    let Reduced { high, low, quadrant } = reduce(angle);
    let (sin, cos) = series(high, low);
    match quadrant % 4 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// An angle as `high + low` plus a count of quarter turns, of which only the last two bits mean anything.
struct Reduced<T> {
    high: T,
    low: T,
    quadrant: u32,
}

fn reduce<T: Real>(angle: T) -> Reduced<T> {
    // The next digits of a quarter turn behind those of its float; the first part times 4096 (2^26 in double) has no rounding.
    let digits = if is_single::<T>() {
        (real::<T>(-4.371_395_334_601_402e-8), real::<T>(2.563_344_151_594_519e-12))
    } else {
        (real::<T>(6.123_233_932_053_594e-17), real::<T>(6.368_317_163_510_95e-25))
    };
    let mut reduced = Reduced { high: angle, low: T::zero(), quadrant: 0 };
    // Once, but for angles so large that the missing digits of a quarter turn add up to more than a quarter turn.
    while reduced.high.abs() > real::<T>(REDUCED) {
        let negative = reduced.high < T::zero();
        let (rest, turns, quadrant) = quarter_turns(reduced.high.abs());
        let (rest, turns) = if negative { (-rest, -turns) } else { (rest, turns) };
        let shift = turns * digits.0;
        let high = rest - shift;
        // What the subtraction rounded away.
        let part = high - rest;
        let lost = (rest - (high - part)) - (shift + part);
        let low = reduced.low + (lost - turns * digits.1);
        reduced.high = high + low;
        reduced.low = low - (reduced.high - high);
        reduced.quadrant = reduced.quadrant.wrapping_add(if negative { quadrant.wrapping_neg() } else { quadrant });
    }
    reduced
}

/// Long division of a positive angle by the float nearest to a quarter turn: the remainder of least size, without rounding, and the
/// quotient, as a float and modulo 2^32.
///
/// The quotient is put together from constants, so that a dual number's derivative stays with the remainder.
fn quarter_turns<T: Real>(angle: T) -> (T, T, u32) {
    let (quarter, half) = (T::frac_pi_2(), real::<T>(0.5));
    let (mut step, mut weight) = (quarter, T::one());
    while step <= angle - step {
        step += step;
        weight += weight;
    }
    let (mut rest, mut turns, mut quadrant) = (angle, T::zero(), 0_u32);
    loop {
        quadrant = quadrant.wrapping_shl(1);
        // Each difference is exact: the remainder is between one and two steps.
        if rest >= step {
            rest -= step;
            turns += weight;
            quadrant = quadrant.wrapping_add(1);
        }
        if weight <= T::one() {
            break;
        }
        step *= half;
        weight *= half;
    }
    if rest > quarter * half {
        (rest - quarter, turns + T::one(), quadrant.wrapping_add(1))
    } else {
        (rest, turns, quadrant)
    }
}

/// Taylor series about zero for `|high| <= REDUCED`: what is left out is below a twentieth of the rounding of the result.
fn series<T: Real>(high: T, low: T) -> (T, T) {
    let z = high * high;
    let (odd, even) = if is_single::<T>() {
        let odd = four(z, [2.755_731_922_398_589e-6, -1.984_126_984_126_984e-4, 1.0 / 120.0, -1.0 / 6.0]);
        let even = four(z, [-2.755_731_922_398_589e-7, 2.480_158_730_158_73e-5, -1.0 / 720.0, 1.0 / 24.0]);
        (odd, even)
    } else {
        let odd = horner(
            z,
            [
                2.811_457_254_345_521e-15,
                -7.647_163_731_819_816e-13,
                1.605_904_383_682_161_3e-10,
                -2.505_210_838_544_172e-8,
                2.755_731_922_398_589e-6,
                -1.984_126_984_126_984e-4,
                1.0 / 120.0,
                -1.0 / 6.0,
            ],
        );
        let even = horner(
            z,
            [
                4.779_477_332_387_385e-14,
                -1.147_074_559_772_972_5e-11,
                2.087_675_698_786_81e-9,
                -2.755_731_922_398_589e-7,
                2.480_158_730_158_73e-5,
                -1.0 / 720.0,
                1.0 / 24.0,
            ],
        );
        (odd, even)
    };
    let (one, half) = (T::one(), z * real::<T>(0.5));
    let sin = high + (high * z * odd + low * (one - half));
    // 1 - z/2 rounds; what it loses goes in with the rest.
    let near = one - half;
    let cos = near + (((one - near) - half) + (z * z * even - high * low));
    (sin, cos)
}

/// A polynomial with constant coefficients, the highest first.
#[inline(always)]
fn horner<T: Real, const N: usize>(z: T, coefficients: [f64; N]) -> T {
    coefficients.map(real::<T>).into_iter().fold(T::zero(), |sum, coefficient| sum * z + coefficient)
}

/// The same of four coefficients without a loop: in a small program the constants of one would be converted while it runs.
#[inline(always)]
fn four<T: Real>(z: T, [a, b, c, d]: [f64; 4]) -> T {
    ((real::<T>(a) * z + real(b)) * z + real(c)) * z + real(d)
}

fn is_single<T: Real>() -> bool {
    epsilon::<T>() > real::<T>(1e-9)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::sin_cos;

    /// Distance in units in the last place of the expected value.
    fn ulps_32(found: f32, exact: f64) -> f64 {
        let place = f64::from((exact as f32).abs().max(f32::MIN_POSITIVE));
        let ulp = 2f64.powi(place.log2().floor() as i32 - 23);
        (f64::from(found) - exact).abs() / ulp
    }

    fn ulps_64(found: f64, exact: f64) -> f64 {
        let ulp = 2f64.powi(exact.abs().log2().floor() as i32 - 52);
        (found - exact).abs() / ulp
    }

    /// Angles over `0..=largest`, and the floats around each quarter turn.
    fn angles_32(largest: f32) -> Vec<f32> {
        let mut angles: Vec<f32> = (0..400_000).map(|i| largest * (i as f32 / 400_000.0)).collect();
        let near = (1..=4096).map(|n| (f64::from(n) * core::f64::consts::FRAC_PI_2) as f32);
        angles.extend(near.flat_map(|x| [x.next_down(), x, x.next_up()]));
        angles.extend((0..120).map(|n| 2f32.powi(-n)));
        angles
    }

    #[test]
    fn single_precision_agrees_with_double_to_one_unit_in_the_last_place() {
        let mut worst = 0.0_f64;
        for largest in [0.9, 10.0, 6433.0] {
            for angle in angles_32(largest) {
                for angle in [angle, -angle] {
                    let (sin, cos) = sin_cos(angle);
                    let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
                    worst = worst.max(ulps_32(sin, exact_sin)).max(ulps_32(cos, exact_cos));
                }
            }
        }
        assert!(worst < 1.0, "{worst} ulp");
    }

    #[test]
    fn double_precision_agrees_with_the_platform_and_with_tabulated_values() {
        let mut worst = 0.0_f64;
        for largest in [0.9, 10.0, 6433.0, 1e7] {
            for i in 1..200_000 {
                let angle = largest * f64::from(i) / 200_000.0;
                let (sin, cos) = sin_cos(-angle);
                worst = worst.max(ulps_64(sin, -angle.sin())).max(ulps_64(cos, angle.cos()));
            }
        }
        // From 120 digits of a multiple-precision library.
        for (angle, exact_sin, exact_cos) in [
            (core::f64::consts::FRAC_PI_2, 1.0, 6.123233995736766e-17),
            (core::f64::consts::PI, 1.2246467991473532e-16, -1.0),
            (22.0, -0.008851309290403876, -0.9999608263946371),
            (355.0, -3.014435335948845e-05, -0.999999999545659),
            (710.0, 6.0288706691585265e-05, 0.999999998182636),
            (6433.98, -0.0017545509967716632, 0.9999984607742153),
            (1e5, 0.03574879797201651, -0.9993608074382124),
            (5e7 + 0.125, 0.8895446899521516, 0.45684816359259933),
        ] {
            let (sin, cos) = sin_cos(angle);
            worst = worst.max(ulps_64(sin, exact_sin)).max(ulps_64(cos, exact_cos));
        }
        // The platform's own rounding is in the comparison too.
        assert!(worst < 1.5, "{worst} ulp");
    }

    #[test]
    fn huge_angles_lose_no_more_than_the_square_of_the_epsilon() {
        for angle in [1e6_f32, 2.5e7, 3.3e9, 4.1e12, -7.7e10] {
            let (sin, cos) = sin_cos(angle);
            let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
            let allowed = f64::from(f32::EPSILON) + f64::from(angle.abs()) * f64::from(f32::EPSILON).powi(2);
            assert!((f64::from(sin) - exact_sin).abs() <= allowed, "{angle}: {sin}, not {exact_sin}");
            assert!((f64::from(cos) - exact_cos).abs() <= allowed, "{angle}: {cos}, not {exact_cos}");
        }
        let (sin, cos) = sin_cos(6381956970095103.0_f64);
        assert!((sin + 0.5818037467964668).abs() < 1e-15 && (cos - 0.813329207771117).abs() < 1e-15);
        for angle in [f32::MAX, -f32::MAX] {
            let (sin, cos) = sin_cos(angle);
            assert!((sin * sin + cos * cos - 1.0).abs() < 1e-6, "{angle}: {sin} {cos}");
        }
    }

    #[test]
    fn zero_is_exact_and_what_is_not_finite_gives_not_a_number() {
        assert_eq!((sin_cos(0.0_f32), sin_cos(-0.0_f64)), ((0.0, 1.0), (0.0, 1.0)));
        for angle in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let (sin, cos) = sin_cos(angle);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
