//! Moment of a bender over its bend and its pressure, and its stiffness beside the plane of its bend.
//!
//! Without a moment the bend `k` has the pressure `p_0(k)`. At another pressure the moment is `M(k, p) = (p_0(k) - p) A(k, p)`, where `A` is the mean of
//! `dV/dk` over the pressures between. Threads hardly stretch, so `A` varies little, and a polynomial of low degree fits it. The fit is to a few
//! curves of finite elements; no equation of the analytic model is in it.

use fra_model::{ActuatorParameters, Fiber};
use nalgebra::{DMatrix, DVector};

use super::{EndLoad, Equilibrium, Interpolated, Mesh, Options, Section, SectionError, Symmetry};

/// Elements through the wall and around half of it. Bends are within 1e-4 of those of the default mesh.
const MESH: Mesh = Mesh { radial: 4, around: 8 };
/// Moments of the curves, as shares of the wall's bending stiffness at rest over the outer radius. Without pressure a tube carries little more.
const MOMENTS: [f64; 5] = [-0.06, -0.04, -0.02, 0.01, 0.02];
/// Pressures of a curve, from zero on.
const PRESSURES: usize = 13;
/// Least distance of a point from the curve without load, as a share of the highest pressure. Nearer points determine `A` poorly.
const APART: f64 = 0.02;
/// Degrees of `p_0` in the bend, and of `A` in the bend and the pressure.
const FREE_DEGREE: usize = 11;
const DEGREES: [usize; 2] = [6, 3];
/// Intervals between the points of the fit of `p_0`.
const FREE_POINTS: usize = 80;

/// A bender by finite elements of its section, up to a pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct BendingLaw {
    pressure_max_pa: f64,
    bend_max_rad_per_m: f64,
    /// `p_0` as a share of the highest pressure, by powers of `2 k/k_max - 1`.
    free: Vec<f64>,
    /// `A`, m3, by powers of `2 k/k_max - 1` and of `p/p_max`.
    arm_m3: Vec<[f64; DEGREES[1] + 1]>,
    /// Stiffness across the plane of the bend and torsional stiffness, N m2, by powers of the pressure over the highest.
    beside_nm2: [[f64; 4]; 2],
}

/// The moment that holds a bender, positive in the sense of its bend, and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingMoment {
    /// Moment, N m.
    pub moment_nm: f64,
    /// Its derivative by the bend per length at constant pressure, the bending stiffness, N m2.
    pub by_bend_nm2: f64,
    /// Its derivative by the pressure at constant bend, m3: less than zero.
    pub by_pressure_m3: f64,
}

impl BendingLaw {
    /// The law of a bending actuator with one or two windings up to a gauge pressure, Pa, or to just below the end of its branch; `None` where its
    /// section has too few equilibria.
    ///
    /// # Errors
    /// [`SectionError`] for an actuator that has no section model, or a pressure out of range.
    pub fn new(
        parameters: &ActuatorParameters<f64>,
        second_fiber: Option<&Fiber<f64>>,
        pressure_max_pa: f64,
    ) -> Result<Option<Self>, SectionError> {
        let section = |symmetry| {
            let options = Options { mesh: MESH, symmetry, ..Options::default() };
            match second_fiber {
                None => Section::new(parameters, &options),
                Some(second) => Section::with_two_windings(parameters, second, &options),
            }
        };
        let half = section(Symmetry::Exploit)?;
        let Some(curve) = half.interpolated(1.0, pressure_max_pa)? else { return Ok(None) };
        let Some(free) = Free::new(&curve) else { return Ok(None) };
        let pressures_pa: [f64; PRESSURES] =
            std::array::from_fn(|k| curve.pressure_max_pa() * k as f64 / (PRESSURES - 1) as f64);
        let unit_nm = unit_nm(parameters);
        let mut points = Vec::new();
        for share in MOMENTS {
            let moment_nm = share * unit_nm;
            let load = EndLoad { bending_moments_nm: [moment_nm, 0.0], ..EndLoad::default() };
            let curve = half.curve(&pressures_pa, &load)?;
            let states = curve.answers.iter().filter_map(|answer| Some(answer.equilibrium()?.state));
            points.extend(states.filter_map(|state| free.point(&state, moment_nm)));
        }
        let whole = section(Symmetry::Ignore)?.curve(&pressures_pa, &EndLoad::default())?;
        let whole: Vec<&Equilibrium> = whole.answers.iter().filter_map(|answer| answer.equilibrium()).collect();
        points.extend(whole.iter().filter_map(|found| free.lever(found)));
        let arm_m3 = surface(&points);
        let beside_nm2 = [2, 3].map(|strain: usize| {
            let of = |found: &&Equilibrium| {
                Some((found.state.pressure_pa / free.pressure_max_pa, found.stiffness?.by_strain[strain][strain]))
            };
            cubic(&whole.iter().filter_map(of).collect::<Vec<_>>())
        });
        let [Some(across), Some(torsion)] = beside_nm2 else { return Ok(None) };
        let Free { pressure_max_pa, bend_max_rad_per_m, powers } = free;
        Ok(arm_m3.map(|arm_m3| Self {
            pressure_max_pa,
            bend_max_rad_per_m,
            free: powers,
            arm_m3,
            beside_nm2: [across, torsion],
        }))
    }

    /// A law between others: their sum with weights that sum to 1, as an interpolation over sizes of the section has them; `None` without any.
    pub fn between<'a>(laws: impl IntoIterator<Item = (f64, &'a Self)>) -> Option<Self> {
        let mut sum: Option<Self> = None;
        for (weight, law) in laws {
            let mut scaled = law.clone();
            scaled.numbers_mut().for_each(|number| *number *= weight);
            match &mut sum {
                None => sum = Some(scaled),
                Some(sum) => sum.numbers_mut().zip(scaled.numbers_mut()).for_each(|(sum, number)| *sum += *number),
            }
        }
        sum
    }

    /// The law of a section that is larger by a factor, at the same pressures.
    #[must_use]
    pub fn enlarged(&self, factor: f64) -> Self {
        let mut law = self.clone();
        law.bend_max_rad_per_m /= factor;
        law.arm_m3.iter_mut().flatten().for_each(|arm| *arm *= factor.powi(3));
        law.beside_nm2.iter_mut().flatten().for_each(|spring| *spring *= factor.powi(4));
        law
    }

    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let [across, torsion] = &mut self.beside_nm2;
        let ends = [&mut self.pressure_max_pa, &mut self.bend_max_rad_per_m].into_iter();
        ends.chain(&mut self.free).chain(self.arm_m3.iter_mut().flatten()).chain(across).chain(torsion)
    }

    /// The highest pressure, gauge Pa.
    pub fn pressure_max_pa(&self) -> f64 {
        self.pressure_max_pa
    }

    /// The moment at a bend per length, rad/m, and a gauge pressure, Pa; `None` outside the bends and the pressures of the curve without load.
    pub fn moment(&self, bend_rad_per_m: f64, pressure_pa: f64) -> Option<BendingMoment> {
        let is_known = (0.0..=self.bend_max_rad_per_m).contains(&bend_rad_per_m)
            && (0.0..=self.pressure_max_pa).contains(&pressure_pa);
        is_known.then_some(())?;
        let (at, share) = (centred(bend_rad_per_m / self.bend_max_rad_per_m), pressure_pa / self.pressure_max_pa);
        let by_bend = 2.0 / self.bend_max_rad_per_m;
        let [free, free_slope] = polynomial(&self.free, at);
        let rows = || self.arm_m3.iter().map(|by_pressure| polynomial(by_pressure, share));
        let (arms, slopes): (Vec<f64>, Vec<f64>) = rows().map(|[arm, slope]| (arm, slope)).unzip();
        let [arm_m3, arm_by_bend] = polynomial(&arms, at);
        let missing_pa = self.pressure_max_pa * (free - share);
        Some(BendingMoment {
            moment_nm: missing_pa * arm_m3,
            by_bend_nm2: by_bend * (self.pressure_max_pa * free_slope * arm_m3 + missing_pa * arm_by_bend),
            by_pressure_m3: missing_pa / self.pressure_max_pa * polynomial(&slopes, at)[0] - arm_m3,
        })
    }

    /// Bend per length without a moment, rad/m, at a gauge pressure, Pa; `None` beyond the range.
    pub fn bend_rad_per_m(&self, pressure_pa: f64) -> Option<f64> {
        (0.0..=self.pressure_max_pa).contains(&pressure_pa).then_some(())?;
        // The pressure rises with the bend. At both ends the fit is off by a rounding, so the search stays within the bends.
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > 1e-15 {
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                break;
            }
            let is_below = polynomial(&self.free, centred(middle))[0] * self.pressure_max_pa < pressure_pa;
            *(if is_below { &mut low } else { &mut high }) = middle;
        }
        Some(0.5 * (low + high) * self.bend_max_rad_per_m)
    }

    /// Bending stiffness across the plane of its bend and torsional stiffness, N m2, at a gauge pressure, Pa, clamped to the range.
    pub fn beside_nm2(&self, pressure_pa: f64) -> [f64; 2] {
        let share = (pressure_pa / self.pressure_max_pa).clamp(0.0, 1.0);
        self.beside_nm2.map(|powers| polynomial(&powers, share)[0])
    }
}

/// The curve without load.
struct Free {
    pressure_max_pa: f64,
    bend_max_rad_per_m: f64,
    powers: Vec<f64>,
}

/// A point of `A`: bend and pressure over the largest ones, and the value, m3.
type Arm = ([f64; 2], f64);

impl Free {
    fn new(curve: &Interpolated) -> Option<Self> {
        let pressure_max_pa = curve.pressure_max_pa();
        let states: Vec<(f64, f64)> = (0..=FREE_POINTS)
            .map(|k| {
                // Close together at both ends.
                let share = (0.5 * std::f64::consts::PI * k as f64 / FREE_POINTS as f64).sin().powi(2);
                (curve.at(share * pressure_max_pa).bend_angle_rad, share)
            })
            .collect();
        let bend_max_rad_per_m = states.last()?.0;
        (bend_max_rad_per_m > 0.0).then_some(())?;
        let row = |bend: f64| (0..=FREE_DEGREE).map(move |n| centred(bend / bend_max_rad_per_m).powi(n as i32));
        let rows: Vec<(Vec<f64>, f64)> = states.iter().map(|(bend, share)| (row(*bend).collect(), *share)).collect();
        Some(Self { pressure_max_pa, bend_max_rad_per_m, powers: least_squares(&rows)? })
    }

    /// `A` of a state under a moment; `None` near this curve and beyond its bends.
    fn point(&self, state: &super::SectionState, moment_nm: f64) -> Option<Arm> {
        let at = [state.bend_rates_rad_per_m[0] / self.bend_max_rad_per_m, state.pressure_pa / self.pressure_max_pa];
        (0.0..=1.0).contains(&at[0]).then_some(())?;
        let missing = polynomial(&self.powers, centred(at[0]))[0] - at[1];
        (missing.abs() >= APART).then(|| (at, moment_nm / (missing * self.pressure_max_pa)))
    }

    /// `A` on this curve: `dV/dk` at constant pressure, as the axis stretches without an axial force.
    fn lever(&self, found: &Equilibrium) -> Option<Arm> {
        let (stiffness, state) = (found.stiffness?, &found.state);
        let yields = stiffness.by_strain[0][1] / stiffness.by_strain[0][0];
        let at = [state.bend_rates_rad_per_m[0] / self.bend_max_rad_per_m, state.pressure_pa / self.pressure_max_pa];
        Some((at, stiffness.lever[1] - yields * stiffness.lever[0]))
    }
}

fn centred(share: f64) -> f64 {
    2.0 * share - 1.0
}

/// A polynomial and its derivative, the constant first.
fn polynomial(powers: &[f64], at: f64) -> [f64; 2] {
    powers.iter().rev().fold([0.0; 2], |[value, slope], power| [value * at + power, slope * at + value])
}

/// Coefficients of least squares, of rows with their values.
fn least_squares(rows: &[(Vec<f64>, f64)]) -> Option<Vec<f64>> {
    let columns = rows.first()?.0.len();
    (rows.len() > columns).then_some(())?;
    let matrix = DMatrix::from_fn(rows.len(), columns, |row, column| rows[row].0[column]);
    let right = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let found = matrix.svd(true, true).solve(&right, 1e-14).ok()?;
    Some(found.iter().copied().collect())
}

/// `A` by powers of bend and pressure.
fn surface(points: &[Arm]) -> Option<Vec<[f64; DEGREES[1] + 1]>> {
    let row = |[bend, pressure]: [f64; 2]| {
        (0..=DEGREES[0])
            .flat_map(move |i| (0..=DEGREES[1]).map(move |j| centred(bend).powi(i as i32) * pressure.powi(j as i32)))
    };
    let rows: Vec<(Vec<f64>, f64)> = points.iter().map(|(at, arm)| (row(*at).collect(), *arm)).collect();
    let found = least_squares(&rows)?;
    Some(found.chunks_exact(DEGREES[1] + 1).map(|by_pressure| std::array::from_fn(|j| by_pressure[j])).collect())
}

/// A cubic in the pressure through springs.
fn cubic(springs: &[(f64, f64)]) -> Option<[f64; 4]> {
    let rows: Vec<(Vec<f64>, f64)> =
        springs.iter().map(|(share, spring)| ((0..4).map(|n| share.powi(n)).collect(), *spring)).collect();
    least_squares(&rows)?.try_into().ok()
}

/// Scale of moments: a wall's bending stiffness about its strip at rest, over its outer radius, N m.
fn unit_nm(parameters: &ActuatorParameters<f64>) -> f64 {
    let (inner, outer) = (parameters.inner_radius_m, parameters.outer_radius_m);
    let area_m2 = std::f64::consts::PI * (outer - inner) * (outer + inner);
    let square_m2 = 0.25 * (inner * inner + outer * outer) + outer * outer;
    4.0 * parameters.material.shear_modulus_pa() * area_m2 * square_m2 / outer
}

#[cfg(test)]
mod tests {
    use fra_model::{Families, Material, Motion, Placement};

    use super::*;

    fn bender(degrees: f64, modulus_pa: f64) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion: Motion::Bending,
            inner_radius_m: 10e-3,
            outer_radius_m: 14e-3,
            length_m: 0.24,
            material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
            fiber: Some(Fiber {
                angle_rad: degrees.to_radians(),
                families: Families::Two,
                modulus_pa,
                placement: Placement::Sheet,
                thickness_m: 0.18e-3,
                radius_m: 14e-3,
            }),
        }
    }

    fn bends(section: &Section, pressures_pa: &[f64], moment_nm: f64) -> Vec<Option<f64>> {
        let load = EndLoad { bending_moments_nm: [moment_nm, 0.0], ..EndLoad::default() };
        let curve = section.curve(pressures_pa, &load).unwrap();
        curve.answers.iter().map(|answer| Some(answer.equilibrium()?.state.bend_rates_rad_per_m[0])).collect()
    }

    /// Between and beyond the curves, beside the default mesh; the stiffness by differences of bends.
    #[test]
    fn moment_and_stiffness_are_those_of_the_section() {
        const PRESSURES_PA: [f64; 5] = [1e3, 13e3, 31e3, 52e3, 60e3];
        let helix = Fiber { angle_rad: 0.5, modulus_pa: 2e6, ..bender(0.0, 1.0).fiber.unwrap() };
        for (degrees, modulus_pa, second) in
            [(3.0, 361e6, None), (15.0, 361e6, None), (25.0, 361e6, None), (3.0, 4e6, None), (3.0, 361e6, Some(helix))]
        {
            let parameters = bender(degrees, modulus_pa);
            let law = BendingLaw::new(&parameters, second.as_ref(), 80e3).unwrap().expect("a law");
            let section = match &second {
                None => Section::new(&parameters, &Options::default()),
                Some(second) => Section::with_two_windings(&parameters, second, &Options::default()),
            };
            let (section, unit_nm) = (section.unwrap(), unit_nm(&parameters));
            let (mut seen, mut most, mut most_beyond) = (0, [0.0_f64; 2], [0.0_f64; 2]);
            for share in [-0.07, -0.045, -0.012, 0.0, 0.012, 0.025] {
                let is_beyond = !(MOMENTS[0]..=MOMENTS[MOMENTS.len() - 1]).contains(&share);
                // Without much pressure the largest moments make the tube collapse.
                let pressures = &PRESSURES_PA[if is_beyond { 2 } else { 0 }..];
                let [less, here, more] =
                    [-1e-3, 0.0, 1e-3].map(|change| bends(&section, pressures, (share + change) * unit_nm));
                for (row, pressure_pa) in pressures.iter().enumerate() {
                    let (Some(less), Some(bent), Some(more)) = (less[row], here[row], more[row]) else { continue };
                    let Some(found) = law.moment(bent, *pressure_pa) else { continue };
                    let off = [
                        (found.moment_nm / unit_nm - share) / 0.07,
                        found.by_bend_nm2 * (more - less) / (2e-3 * unit_nm) - 1.0,
                    ];
                    let most = if is_beyond { &mut most_beyond } else { &mut most };
                    (0..2).for_each(|n| most[n] = most[n].max(off[n].abs()));
                    seen += 1;
                }
            }
            println!("{degrees} {modulus_pa}: {seen} states, {most:?}, beyond {most_beyond:?}");
            assert!(seen >= 15 && most[0] < 3e-4 && most[1] < 1.5e-3, "{degrees} {modulus_pa}: {seen} {most:?}");
            assert!(most_beyond[0] < 1.2e-3 && most_beyond[1] < 1.5e-2, "{degrees} {modulus_pa}: {most_beyond:?}");
        }
    }

    #[test]
    fn moment_by_pressure_is_a_difference() {
        let law = BendingLaw::new(&bender(15.0, 361e6), None, 80e3).unwrap().expect("a law");
        for (bend, pressure_pa) in [(2.0, 10e3), (5.0, 60e3), (8.0, 30e3)] {
            let [more, less] = [1.0, -1.0].map(|step| law.moment(bend, pressure_pa + step).unwrap().moment_nm);
            let found = law.moment(bend, pressure_pa).unwrap().by_pressure_m3;
            assert!((0.5 * (more - less) / found - 1.0).abs() < 1e-7 && found < 0.0, "{bend} {pressure_pa}: {found}");
        }
    }

    #[test]
    fn springs_beside_the_plane_are_those_of_the_section() {
        let parameters = bender(15.0, 361e6);
        let law = BendingLaw::new(&parameters, None, 80e3).unwrap().expect("a law");
        let whole = Section::new(&parameters, &Options { symmetry: Symmetry::Ignore, ..Options::default() }).unwrap();
        for pressure_pa in [0.0, 17e3, 44e3, 71e3] {
            let answer = whole.curve(&[pressure_pa], &EndLoad::default()).unwrap().answers[0];
            let stiffness = answer.equilibrium().unwrap().stiffness.unwrap().by_strain;
            let found = law.beside_nm2(pressure_pa);
            for (found, expected) in found.iter().zip([stiffness[2][2], stiffness[3][3]]) {
                println!("{pressure_pa}: off by {:.1e}", found / expected - 1.0);
                assert!((found / expected - 1.0).abs() < 4e-4, "{pressure_pa}: {found} {expected}");
            }
        }
    }

    #[test]
    fn bends_and_pressures_beyond_the_curve_have_no_moment() {
        let law = BendingLaw::new(&bender(15.0, 361e6), None, 40e3).unwrap().expect("a law");
        assert!(law.moment(0.0, 40e3).is_some() && law.moment(law.bend_max_rad_per_m, 0.0).is_some());
        for (bend, pressure_pa) in [(-0.1, 10e3), (1.01 * law.bend_max_rad_per_m, 10e3), (1.0, 41e3), (1.0, -1.0)] {
            assert_eq!(law.moment(bend, pressure_pa), None, "{bend} {pressure_pa}");
        }
        assert!(BendingLaw::new(&bender(15.0, 361e6), None, 1e9).is_err());
    }
}
