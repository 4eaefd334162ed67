//! The elastic law of a tube under pressure, as data.
//!
//! Loads on a piece of tube are the derivatives of a potential per length at rest, a polynomial in strains and pressure. The main strain of
//! a tube, which pressure changes most, has that potential to itself; the other strains have springs that pressure stiffens.

use crate::curve::Curve;

/// The strain that pressure changes most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Main {
    /// Stretch of the axis: tubes that extend or expand.
    Stretch,
    /// Bend about the strip that keeps its length, which is the axis of the law.
    Bend,
    /// Twist with the stretch that comes with it.
    Twist,
}

/// A term of a potential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Powers of the two strains and of the pressure.
    pub powers: [u8; 3],
    /// Its factor, J/m.
    pub coefficient: f64,
}

/// A polynomial potential of two strains and the pressure, per length at rest.
///
/// Strains are stretch less one and twist rate (rad/m); of a bender the first is the bend rate (rad/m) and the second is nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Potential {
    /// Units that strains and pressure are counted in.
    pub units: [f64; 3],
    /// Strains, low and high, between which the polynomial holds; it goes on with straight loads behind them.
    pub range: [[f64; 2]; 2],
    /// The terms.
    pub terms: Vec<Term>,
}

/// Highest power, and one more.
const POWERS: usize = 8;

impl Potential {
    /// Loads that belong to the strains at a pressure: force or moment, N or N m, and torque, N m.
    pub fn loads(&self, strains: [f64; 2], pressure_pa: f64) -> [f64; 2] {
        let inside = [0, 1].map(|axis: usize| strains[axis].clamp(self.range[axis][0], self.range[axis][1]));
        let (loads, slopes) = self.loads_and_slopes(inside, pressure_pa);
        [0, 1].map(|axis: usize| {
            let row: [f64; 2] = slopes[axis];
            loads[axis] + row[0] * (strains[0] - inside[0]) + row[1] * (strains[1] - inside[1])
        })
    }

    /// Volume per length at rest that strains have let a pressure fill, m2: minus the derivative of the potential by the pressure. Straight behind the range.
    pub fn filled_m2(&self, strains: [f64; 2], pressure_pa: f64) -> f64 {
        let inside = [0, 1].map(|axis: usize| strains[axis].clamp(self.range[axis][0], self.range[axis][1]));
        let beyond = [0, 1].map(|axis: usize| (strains[axis] - inside[axis]) / self.units[axis]);
        let [x, y, p] = [inside[0] / self.units[0], inside[1] / self.units[1], pressure_pa / self.units[2]];
        let [x, y, p] = [powers(x), powers(y), powers(p)];
        let of_term = |Term { powers: [i, j, m], coefficient }: &Term| {
            let [i, j, m] = [usize::from(*i), usize::from(*j), usize::from(*m)];
            let ([by_x, _], [by_y, _], [by_p, _]) = (derivatives(&x, i), derivatives(&y, j), derivatives(&p, m));
            coefficient * by_p * (x[i] * y[j] + by_x * y[j] * beyond[0] + x[i] * by_y * beyond[1])
        };
        -self.terms.iter().map(of_term).sum::<f64>() / self.units[2]
    }

    fn loads_and_slopes(&self, strains: [f64; 2], pressure_pa: f64) -> ([f64; 2], [[f64; 2]; 2]) {
        let [x, y, p] = [strains[0] / self.units[0], strains[1] / self.units[1], pressure_pa / self.units[2]];
        let [x, y, p] = [powers(x), powers(y), powers(p)];
        let (mut loads, mut slopes) = ([0.0; 2], [[0.0; 2]; 2]);
        for Term { powers: [i, j, m], coefficient } in &self.terms {
            let ([i, j], pressed) = ([usize::from(*i), usize::from(*j)], coefficient * p[usize::from(*m)]);
            let ([dx, ddx], [dy, ddy]) = (derivatives(&x, i), derivatives(&y, j));
            loads[0] += pressed * dx * y[j];
            loads[1] += pressed * x[i] * dy;
            slopes[0][0] += pressed * ddx * y[j];
            slopes[0][1] += pressed * dx * dy;
            slopes[1][1] += pressed * x[i] * ddy;
        }
        let [first, second, _] = self.units;
        let mixed = slopes[0][1] / (first * second);
        (
            [loads[0] / first, loads[1] / second],
            [[slopes[0][0] / (first * first), mixed], [mixed, slopes[1][1] / (second * second)]],
        )
    }
}

fn powers(x: f64) -> [f64; POWERS] {
    let mut powers = [1.0; POWERS];
    for power in 1..POWERS {
        powers[power] = powers[power - 1] * x;
    }
    powers
}

/// First and second derivative of a power.
fn derivatives(powers: &[f64; POWERS], power: usize) -> [f64; 2] {
    let (n, below) = (power as f64, |down: usize| power.checked_sub(down).map_or(0.0, |power| powers[power]));
    [n * below(1), n * (n - 1.0) * below(2)]
}

/// Springs of the strains that are not the main one, as polynomials in the pressure, the constant first.
#[derive(Clone, Debug, PartialEq)]
pub struct Stiffness {
    /// Unit that the polynomials count the pressure in, Pa.
    pub unit_pa: f64,
    /// Bending stiffness towards `x` and `y` of the tube, N m2; that of a bender towards `x` counts where its bend changes along it.
    pub bending_nm2: [Vec<f64>; 2],
    /// Torsional stiffness, N m2; not used by a tube that twists.
    pub torsion_nm2: Vec<f64>,
    /// Axial stiffness of a bender's strip, N; not used by others.
    pub strip_n: f64,
    /// Shear stiffness, N.
    pub shear_n: f64,
}

/// The law of a tube.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Its main strain.
    pub main: Main,
    /// 1 where pressure makes the main strain greater, else -1.
    pub sign: f64,
    /// Loads of the main strain.
    pub potential: Potential,
    /// Other springs.
    pub stiffness: Stiffness,
    /// Pressure of the tube without load, Pa, over the magnitude of its main strain: stretch less one, or rate of bend or twist.
    pub elastic: Curve,
    /// Of a tube that twists, the magnitude of its main strain without load over the volume that the pressure has filled, m2.
    pub filled: Option<Curve>,
}

impl Law {
    /// The springs at a pressure: bending towards `x` and `y`, torsion.
    pub(crate) fn springs(&self, pressure_pa: f64) -> [f64; 3] {
        let p = pressure_pa / self.stiffness.unit_pa;
        let at = |polynomial: &[f64]| polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * p + coefficient);
        let [towards, across] = &self.stiffness.bending_nm2;
        [at(towards), at(across), at(&self.stiffness.torsion_nm2)]
    }

    /// Deformation that the memory remembers: the magnitude of the main strain, of a tube that twists that of the tube without load whose pressure has filled
    /// as much volume. Pressures do work on volumes: a memory of the twist alone would feed vibrations in which the tube stretches against its twist.
    pub(crate) fn deformation(&self, strains: [f64; 2], pressure_pa: f64) -> f64 {
        match &self.filled {
            Some(filled) => filled.at(self.potential.filled_m2(strains, pressure_pa)),
            None => self.sign * strains[usize::from(self.main == Main::Twist)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `2 x^2 y p + 3 x^3 + y^2`, in units of 2, 5 and 10.
    fn potential() -> Potential {
        let term = |powers, coefficient| Term { powers, coefficient };
        Potential {
            units: [2.0, 5.0, 10.0],
            range: [[-4.0, 4.0], [-10.0, 10.0]],
            terms: vec![term([2, 1, 1], 2.0), term([3, 0, 0], 3.0), term([0, 2, 0], 1.0)],
        }
    }

    #[test]
    fn loads_are_derivatives_of_the_polynomial() {
        // x = 1.5, y = -0.4, p = 2: dx = 4 x y p + 9 x^2, dy = 2 x^2 p + 2 y.
        let [first, second] = potential().loads([3.0, -2.0], 20.0);
        let (x, y, p) = (1.5, -0.4, 2.0);
        assert!((first - (4.0 * x * y * p + 9.0 * x * x) / 2.0).abs() < 1e-12);
        assert!((second - (2.0 * x * x * p + 2.0 * y) / 5.0).abs() < 1e-12);
    }

    #[test]
    fn volume_changes_by_strains_as_loads_do_by_the_pressure() {
        let (potential, h) = (potential(), 1e-4);
        let strains = [3.0, -2.0];
        for axis in 0..2 {
            let loads = |pressure_pa: f64| potential.loads(strains, pressure_pa)[axis];
            let filled = |by: f64| {
                let mut at = strains;
                at[axis] += by;
                potential.filled_m2(at, 20.0)
            };
            let expected = (loads(20.0 - h) - loads(20.0 + h)) / (2.0 * h);
            assert!(((filled(h) - filled(-h)) / (2.0 * h) - expected).abs() < 1e-6, "axis {axis}: {expected}");
        }
        let behind = |x: f64| potential.filled_m2([x, 3.0], 20.0);
        assert!((behind(5.0) - 2.0 * behind(4.5) + behind(4.0)).abs() < 1e-12);
    }

    #[test]
    fn loads_go_on_straight_behind_the_range() {
        let at = |x: f64| potential().loads([x, 3.0], 20.0)[0];
        let inside = (at(4.0) - at(4.0 - 1e-6)) / 1e-6;
        assert!(((at(5.0) - at(4.0)) / inside - 1.0).abs() < 1e-5);
        assert!(((at(9.0) - at(8.0)) / (at(5.0) - at(4.0)) - 1.0).abs() < 1e-12);
    }
}
