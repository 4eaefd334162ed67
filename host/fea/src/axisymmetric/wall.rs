//! The strain energy at a point of the wall and its derivatives, without dimension.

use fra_model::{ActuatorParameters, Families, Fiber, Placement};

use crate::elastomer::Elastomer;

/// Parts of the deformation gradient in the directions (radial, hoop, axial) that an axisymmetric deformation with torsion has:
/// `F_rR, F_rZ, F_tR, F_tT, F_tZ, F_zR, F_zZ`.
pub(super) const PARTS: usize = 7;
pub(super) type Gradient = [f64; PARTS];
pub(super) const RR: usize = 0;
pub(super) const RZ: usize = 1;
pub(super) const TR: usize = 2;
pub(super) const TT: usize = 3;
pub(super) const TZ: usize = 4;
pub(super) const ZR: usize = 5;
pub(super) const ZZ: usize = 6;

/// An energy with its first and second derivatives by the parts of the deformation gradient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    pub(super) value: f64,
    pub(super) first: Gradient,
    pub(super) second: [Gradient; PARTS],
}

impl Energy {
    pub(super) const NONE: Self = Self { value: 0.0, first: [0.0; PARTS], second: [[0.0; PARTS]; PARTS] };

    /// Adds `f(g)` of a quadratic `g`: its value, slope and second derivative, and the gradient and the constant Hessian of `g`.
    fn add(&mut self, [f, f1, f2]: [f64; 3], g: &Gradient, h: &[Gradient; PARTS]) {
        self.value += f;
        for i in 0..PARTS {
            self.first[i] += f1 * g[i];
            for j in 0..PARTS {
                self.second[i][j] += f2 * g[i] * g[j] + f1 * h[i][j];
            }
        }
    }

    /// Adds `modulus/2 (I4 - 1)^2` of fibers with a hoop part `c` and an axial part `s`.
    pub(super) fn add_fibers(&mut self, modulus: f64, c: f64, s: f64, f: &Gradient) {
        // The deformed fiber is (s F_rZ, c F_tT + s F_tZ, s F_zZ).
        let along = c * f[TT] + s * f[TZ];
        let mut g = [0.0; PARTS];
        let mut h = [[0.0; PARTS]; PARTS];
        for part in [RZ, ZZ] {
            g[part] = 2.0 * s * s * f[part];
            h[part][part] = 2.0 * s * s;
        }
        for (part, a) in [(TT, c), (TZ, s)] {
            g[part] = 2.0 * a * along;
            for (other, b) in [(TT, c), (TZ, s)] {
                h[part][other] = 2.0 * a * b;
            }
        }
        let strain = along * along + s * s * (f[RZ] * f[RZ] + f[ZZ] * f[ZZ]) - 1.0;
        self.add([0.5 * modulus * strain * strain, modulus * strain, modulus], &g, &h);
    }

    /// Adds `-p (J - 1)`.
    pub(super) fn add_pressure(&mut self, p: f64, f: &Gradient) {
        let (j, first) = determinant(f);
        self.value -= p * (j - 1.0);
        (0..PARTS).for_each(|i| self.first[i] -= p * first[i]);
        let mut pair = |i: usize, k: usize, value: f64| {
            self.second[i][k] -= p * value;
            self.second[k][i] -= p * value;
        };
        for (i, value) in [(RR, f[ZZ]), (ZZ, f[RR]), (RZ, -f[ZR]), (ZR, -f[RZ])] {
            pair(TT, i, value);
        }
        pair(RR, ZZ, f[TT]);
        pair(RZ, ZR, -f[TT]);
    }
}

/// `J` and its gradient.
pub(super) fn determinant(f: &Gradient) -> (f64, Gradient) {
    let plane = f[RR] * f[ZZ] - f[RZ] * f[ZR];
    let mut first = [0.0; PARTS];
    (first[RR], first[ZZ]) = (f[TT] * f[ZZ], f[TT] * f[RR]);
    (first[RZ], first[ZR]) = (-f[TT] * f[ZR], -f[TT] * f[RZ]);
    first[TT] = plane;
    (f[TT] * plane, first)
}

/// Materials of a wall, moduli in units of the small-strain shear modulus, lengths of the inner radius.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    elastomer: Elastomer,
    /// Fibers within the wall from a radius on.
    layers: Vec<(f64, Winding)>,
    /// Fibers on a surface: its radius; the modulus is per area.
    pub(super) sheets: Vec<(f64, Winding)>,
}

/// Fibers of one or two families.
#[derive(Clone, Copy, Debug)]
pub(super) struct Winding {
    pub(super) modulus: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) families: Families,
}

impl Wall {
    /// `second` is a winding beside that of the parameters.
    pub(super) fn new(parameters: &ActuatorParameters<f64>, second: Option<&Fiber<f64>>) -> Self {
        let unit = parameters.material.shear_modulus_pa();
        let winding = |fiber: &Fiber<f64>, modulus: f64| {
            let (sin, cos) = fiber.angle_rad.sin_cos();
            Winding { modulus, cos, sin, families: fiber.families }
        };
        let mut wall = Self { elastomer: Elastomer::of(&parameters.material), layers: Vec::new(), sheets: Vec::new() };
        for fiber in parameters.fiber.iter().chain(second).filter(|fiber| fiber.modulus_pa > 0.0) {
            let (modulus, radius) = (fiber.modulus_pa / unit, fiber.radius_m / parameters.inner_radius_m);
            match fiber.placement {
                Placement::Smeared => wall.layers.push((0.0, winding(fiber, modulus))),
                Placement::Layer => wall.layers.push((radius, winding(fiber, modulus))),
                Placement::Sheet => {
                    let per_area = modulus * fiber.thickness_m / parameters.inner_radius_m;
                    wall.sheets.push((radius, winding(fiber, per_area)));
                }
            }
        }
        wall
    }

    /// Whether the wall may twist under pressure.
    pub(super) fn twists(&self) -> bool {
        let one = |winding: &Winding| winding.families == Families::One && winding.sin * winding.cos != 0.0;
        self.layers.iter().chain(&self.sheets).any(|(_, winding)| one(winding))
    }

    /// The radii where fibers lie or begin, in rising order.
    pub(super) fn edges(&self) -> Vec<f64> {
        let mut radii: Vec<f64> = self.layers.iter().chain(&self.sheets).map(|(radius, _)| *radius).collect();
        radii.sort_by(f64::total_cmp);
        radii
    }

    /// The energy per volume of the wall at a radius, the constraint left out.
    pub(super) fn energy(&self, radius: f64, f: &Gradient) -> Energy {
        let mut energy = Energy::NONE;
        let w = self.elastomer.at(f.iter().map(|part| part * part).sum::<f64>() - 3.0);
        let twice = f.map(|part| 2.0 * part);
        let mut identity = [[0.0; PARTS]; PARTS];
        (0..PARTS).for_each(|i| identity[i][i] = 2.0);
        energy.add(w, &twice, &identity);
        for (_, winding) in self.layers.iter().filter(|(inner, _)| radius > *inner) {
            winding.add_to(&mut energy, f);
        }
        energy
    }
}

impl Winding {
    pub(super) fn add_to(&self, energy: &mut Energy, f: &Gradient) {
        energy.add_fibers(self.modulus, self.cos, self.sin, f);
        if self.families == Families::Two {
            energy.add_fibers(self.modulus, self.cos, -self.sin, f);
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::hyper_dual::HyperDual;

    /// A wall and a sheet with everything there is.
    pub(crate) fn anything() -> (Wall, Winding) {
        let winding = Winding { modulus: 3.0, cos: 0.8, sin: 0.6, families: Families::One };
        (Wall { elastomer: Elastomer { c: [0.5, 0.07, -0.01] }, layers: vec![(0.0, winding)], sheets: vec![] }, winding)
    }

    /// Starts of the directions of tests.
    pub(crate) const DIRECTIONS: [f64; 3] = [0.3, 1.9, 4.4];

    /// Energy per volume with the constraint, written out again for any gradient, which is given as rows.
    pub(crate) fn second_energy(wall: &Wall, pressure: HyperDual, f: &[[HyperDual; 3]; 3]) -> HyperDual {
        let [c1, c2, c3] = wall.elastomer.c;
        let x = f.iter().flatten().map(|entry| entry.squared()).sum::<HyperDual>() - 3.0;
        let minor = |i: usize, j: usize| f[1][i] * f[2][j] - f[1][j] * f[2][i];
        let volume = f[0][0] * minor(1, 2) + f[0][1] * minor(2, 0) + f[0][2] * minor(0, 1);
        let fibers: HyperDual = wall.layers.iter().map(|(_, winding)| second_fibers(winding, f)).sum();
        x * c1 + x.squared() * c2 + x * x * x * c3 + fibers - pressure * (volume - 1.0)
    }

    /// `modulus/2 (I4 - 1)^2` for every family.
    pub(crate) fn second_fibers(winding: &Winding, f: &[[HyperDual; 3]; 3]) -> HyperDual {
        let Winding { modulus, cos, sin, families } = *winding;
        let signs: &[f64] = if families == Families::Two { &[1.0, -1.0] } else { &[1.0] };
        let strain = |sign: f64| {
            f.map(|row| (row[1] * cos + row[2] * (sign * sin)).squared()).into_iter().sum::<HyperDual>() - 1.0
        };
        signs.iter().map(|sign| strain(*sign).squared() * (0.5 * modulus)).sum()
    }

    /// Value, slopes and second derivatives by the seven parts, with one family and with two, at a state without symmetry.
    #[test]
    fn derivatives_are_those_of_the_value_by_hyper_dual_numbers() {
        let parts: Gradient = [1.1, 0.2, -0.3, 0.9, 0.25, -0.15, 1.2];
        for families in [Families::One, Families::Two] {
            let (mut wall, winding) = anything();
            wall.layers = vec![(0.0, Winding { families, ..winding })];
            let mut found = wall.energy(1.0, &parts);
            found.add_pressure(0.7, &parts);
            for i in 0..PARTS {
                for j in 0..PARTS {
                    let one = |at: usize, k: usize| f64::from(u8::from(at == k));
                    let part = |k: usize| HyperDual::moving(parts[k], [one(i, k), one(j, k)]);
                    let none = HyperDual::default();
                    let rows = [[part(RR), none, part(RZ)], [part(TR), part(TT), part(TZ)], [part(ZR), none, part(ZZ)]];
                    let exact = second_energy(&wall, HyperDual::from(0.7), &rows);
                    assert!((found.value - exact.value).abs() < 1e-14, "{} {exact:?}", found.value);
                    assert!((found.first[i] - exact.first[0]).abs() < 1e-13, "{i}: {} {exact:?}", found.first[i]);
                    let second = found.second[i][j];
                    assert!((second - exact.second).abs() < 1e-13, "{i} {j}: {second} {exact:?}");
                }
            }
        }
    }
}
