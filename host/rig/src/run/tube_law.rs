//! From finite elements of a section to the law of a tube of the true body.
//!
//! The section is solved over pressures and end loads, and a polynomial potential is fitted to the strains that it has: a surface, not a
//! model of a wall. No equation of the analytic model is in it.

use fra_model::{ActuatorParameters, Fiber, Motion};
use nalgebra::{DMatrix, DVector};
use softlimb_body::{Curve, Law, Main, Potential, Stiffness, Term};
use softlimb_fea::cross_section::{Answer, EndLoad, Mesh, Options, Section, SectionError, Symmetry};

/// Elements through the wall and around half of it. The error of the mesh is below that of the fit.
const MESH: Mesh = Mesh { radial: 4, around: 8 };
/// Pressures of the fit, from zero on.
const PRESSURES: usize = 13;
/// Axial loads of the fit, of the wall's axial stiffness at rest.
const FORCES: [f64; 6] = [-0.2, -0.1, -0.04, 0.0, 0.04, 0.1];
/// Bend rates of the fit's moments at rest, over the outer radius: more is not carried without pressure.
const BENDS: [f64; 6] = [-0.12, -0.06, -0.025, 0.0, 0.025, 0.06];
/// Twists of the fit's torques at rest, rad over the length of the tube.
const TWISTS_RAD: [f64; 5] = [-0.6, -0.3, 0.0, 0.3, 0.6];
/// Weight of the states without load in the fit.
const FREE_WEIGHT: f64 = 4.0;
/// Stiffness of a bender's line over that of its wall: assumed, for a cloth strip beside an elastomer.
const LINE: f64 = 100.0;

/// An actuator with its second winding.
pub(super) type Wound = (ActuatorParameters<f64>, Option<Fiber<f64>>);

/// A state of the section: its pressure, Pa, the two strains of the potential, and the loads that belong to them.
#[derive(Clone, Copy, Debug)]
struct Point {
    pressure_pa: f64,
    strains: [f64; 2],
    loads: [f64; 2],
}

impl Point {
    fn is_free(&self) -> bool {
        self.loads == [0.0; 2]
    }
}

/// The law of an actuator up to a gauge pressure, Pa, or to the end of its branch, with the springs of another one like it; `None` where its section
/// has too few equilibria. The pressure unit of its potential is the highest pressure that it holds for.
///
/// # Errors
/// [`SectionError`] for an actuator that has no section model.
pub(super) fn law(wound: &Wound, stiffness: &Stiffness, pressure_max_pa: f64) -> Result<Option<Law>, SectionError> {
    let parameters = &wound.0;
    let section = section(wound, Symmetry::Exploit)?;
    let Some(highest_pa) = end_pa(&section, pressure_max_pa)? else { return Ok(None) };
    let pressures = pressures(highest_pa);
    let mut points = Vec::new();
    for loads in loads(parameters) {
        let curve = section.curve(&pressures, &end_load(parameters.motion, loads))?;
        points.extend(curve.answers.iter().filter_map(|answer| point(parameters.motion, answer, loads)));
    }
    let main = main(parameters.motion);
    let stiffness = stiffness.clone();
    Ok(fitted(main, &points, highest_pa).map(|fit| Law {
        main,
        sign: fit.sign,
        potential: fit.potential,
        stiffness,
        elastic: fit.elastic,
        filled: fit.filled,
    }))
}

/// The springs beside the main strain, from the whole section without load; `None` where it has too few equilibria.
///
/// # Errors
/// As [`law`].
pub(super) fn stiffness(wound: &Wound, pressure_max_pa: f64) -> Result<Option<Stiffness>, SectionError> {
    let parameters = &wound.0;
    let whole = section(wound, Symmetry::Ignore)?;
    let Some(highest_pa) = end_pa(&section(wound, Symmetry::Exploit)?, pressure_max_pa)? else {
        return Ok(None);
    };
    let curve = whole.curve(&pressures(highest_pa), &EndLoad::default())?;
    let found = curve.answers.iter().filter_map(|answer| {
        let stiffness = answer.equilibrium()?.stiffness?.by_strain;
        // Bending with the axial force that it has without load, and the twist that comes with it.
        let bending = |axis: usize| {
            let softer = if stiffness[0][axis] == 0.0 { 0.0 } else { stiffness[0][axis].powi(2) / stiffness[0][0] };
            stiffness[axis][axis] - softer
        };
        Some((answer.pressure_pa / highest_pa, [bending(1), bending(2), stiffness[3][3]]))
    });
    let found: Vec<(f64, [f64; 3])> = found.collect();
    let [Some(towards), Some(across), Some(torsion)] = [0, 1, 2].map(|spring| cubic(&found, spring)) else {
        return Ok(None);
    };
    let shear_modulus_pa = parameters.material.shear_modulus_pa();
    let area_m2 = area_m2(parameters);
    Ok(Some(Stiffness {
        unit_pa: highest_pa,
        bending_nm2: [towards, across],
        torsion_nm2: torsion,
        strip_n: LINE * axial_n(parameters),
        // Of a thin round tube in shear.
        shear_n: 0.5 * shear_modulus_pa * area_m2,
    }))
}

fn section((parameters, second): &Wound, symmetry: Symmetry) -> Result<Section, SectionError> {
    let options = Options { mesh: MESH, symmetry, ..Options::default() };
    match second {
        None => Section::new(parameters, &options),
        Some(second) => Section::with_two_windings(parameters, second, &options),
    }
}

fn pressures(pressure_max_pa: f64) -> Vec<f64> {
    (0..PRESSURES).map(|k| pressure_max_pa * k as f64 / (PRESSURES - 1) as f64).collect()
}

/// The highest of the pressures up to `pressure_max_pa` at which the section has an equilibrium without load, Pa; `None` below half of it.
fn end_pa(section: &Section, pressure_max_pa: f64) -> Result<Option<f64>, SectionError> {
    let curve = section.curve(&pressures(pressure_max_pa), &EndLoad::default())?;
    let solved = curve.answers.iter().take_while(|answer| answer.equilibrium().is_some());
    Ok(solved.last().map(|answer| answer.pressure_pa).filter(|highest_pa| *highest_pa > 0.5 * pressure_max_pa))
}

fn main(motion: Motion) -> Main {
    match motion {
        Motion::Extension | Motion::Expansion => Main::Stretch,
        Motion::Bending => Main::Bend,
        Motion::Twisting => Main::Twist,
    }
}

fn area_m2(parameters: &ActuatorParameters<f64>) -> f64 {
    let (inner, outer) = (parameters.inner_radius_m, parameters.outer_radius_m);
    std::f64::consts::PI * (outer - inner) * (outer + inner)
}

/// Scale of a wall's axial stiffness at rest under hoops, N.
fn axial_n(parameters: &ActuatorParameters<f64>) -> f64 {
    4.0 * parameters.material.shear_modulus_pa() * area_m2(parameters)
}

/// Loads of the fit, as the potential has them.
fn loads(parameters: &ActuatorParameters<f64>) -> Vec<[f64; 2]> {
    let (inner, outer) = (parameters.inner_radius_m, parameters.outer_radius_m);
    let axial_n = axial_n(parameters);
    let square_m2 = 0.25 * (inner * inner + outer * outer);
    match parameters.motion {
        Motion::Extension | Motion::Expansion => FORCES.map(|share| [share * axial_n, 0.0]).to_vec(),
        Motion::Bending => {
            let bending_nm2 = axial_n * (square_m2 + outer * outer);
            BENDS.map(|bend| [bend / outer * bending_nm2, 0.0]).to_vec()
        }
        Motion::Twisting => {
            let torsion_nm2 = 0.5 * axial_n * square_m2;
            let torques = TWISTS_RAD.map(|twist_rad| twist_rad / parameters.length_m * torsion_nm2);
            let both = |torque: f64| [-0.05, 0.0, 0.05].map(|share| [share * axial_n, torque]);
            torques.into_iter().flat_map(both).collect()
        }
    }
}

fn end_load(motion: Motion, [first, second]: [f64; 2]) -> EndLoad {
    match motion {
        Motion::Extension | Motion::Expansion => EndLoad { force_n: first, ..EndLoad::default() },
        Motion::Bending => EndLoad { bending_moments_nm: [first, 0.0], ..EndLoad::default() },
        Motion::Twisting => EndLoad { force_n: first, torque_nm: second, ..EndLoad::default() },
    }
}

fn point(motion: Motion, answer: &Answer, loads: [f64; 2]) -> Option<Point> {
    let state = &answer.equilibrium()?.state;
    let strains = match motion {
        Motion::Extension | Motion::Expansion => [state.axial_stretch - 1.0, 0.0],
        Motion::Bending => [state.bend_rates_rad_per_m[0], 0.0],
        Motion::Twisting => [state.axial_stretch - 1.0, state.twist_rate_rad_per_m],
    };
    Some(Point { pressure_pa: answer.pressure_pa, strains, loads })
}

/// Loads, curves without load, and the sign of the main strain, as [`Law`] has them.
struct Fit {
    potential: Potential,
    elastic: Curve,
    filled: Option<Curve>,
    sign: f64,
}

/// `None` with too few points, or where no pressure leads on.
fn fitted(main: Main, points: &[Point], pressure_max_pa: f64) -> Option<Fit> {
    let two = main == Main::Twist;
    let axis = usize::from(two);
    let largest = |axis: usize| points.iter().map(|point| point.strains[axis].abs()).fold(0.0, f64::max);
    let units = [largest(0), if two { largest(1) } else { 1.0 }, pressure_max_pa];
    let powers: Vec<[u8; 3]> = (0..=7_u8)
        .flat_map(|i| (0..=4_u8).flat_map(move |j| (0..=2_u8).map(move |m| [i, j, m])))
        .filter(|[i, j, _]| {
            let (degree, is_used) = (i + j, two || *j == 0);
            is_used && (1..=if two { 4 } else { 7 }).contains(&degree)
        })
        .collect();
    let scale = |axis: usize| points.iter().map(|point| point.loads[axis].abs()).fold(0.0, f64::max);
    let scales = [scale(0), scale(1)];
    let power = |x: f64, n: u8| x.powi(i32::from(n));
    let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
    for point in points {
        let at = [point.strains[0] / units[0], point.strains[1] / units[1], point.pressure_pa / units[2]];
        let weight = if point.is_free() { FREE_WEIGHT } else { 1.0 };
        for load in 0..=axis {
            let weight = weight / scales[load];
            let slope = |[i, j, m]: &[u8; 3]| {
                let own = [*i, *j][load];
                let Some(less) = own.checked_sub(1) else { return 0.0 };
                let mut product = f64::from(own) * power(at[load], less) * power(at[2], *m) / units[load];
                if two {
                    product *= power(at[1 - load], [*i, *j][1 - load]);
                }
                weight * product
            };
            rows.push((powers.iter().map(slope).collect(), weight * point.loads[load]));
        }
    }
    if 2 * rows.len() < 3 * powers.len() {
        return None;
    }
    let matrix = DMatrix::from_fn(rows.len(), powers.len(), |row, column| rows[row].0[column]);
    let right = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let found = matrix.svd(true, true).solve(&right, 1e-12).ok()?;
    let terms = powers
        .iter()
        .zip(found.iter())
        .map(|(powers, coefficient)| Term { powers: *powers, coefficient: *coefficient });
    let bounds = |axis: usize| {
        let strains = points.iter().map(|point| point.strains[axis]);
        strains.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], strain| [low.min(strain), high.max(strain)])
    };
    let range = [bounds(0), bounds(1)];
    let free: Vec<&Point> = points.iter().filter(|point| point.is_free()).collect();
    let sign = free.last()?.strains[axis].signum();
    let potential = Potential { units, range, terms: terms.collect() };
    let (mut elastic, mut filled) = (vec![[0.0; 2]], vec![[0.0; 2]]);
    for point in free.iter().skip(1) {
        let deformation = sign * point.strains[axis];
        if deformation <= elastic[elastic.len() - 1][0] {
            break;
        }
        elastic.push([deformation, point.pressure_pa]);
        filled.push([potential.filled_m2(point.strains, point.pressure_pa), deformation]);
    }
    let filled = if two { Some(Curve::rising(&filled)?) } else { None };
    Some(Fit { elastic: Curve::rising(&elastic)?, potential, filled, sign })
}

/// Least-squares cubic of a spring over the pressure, of the highest; the constant first.
fn cubic(found: &[(f64, [f64; 3])], spring: usize) -> Option<Vec<f64>> {
    if found.len() < 5 {
        return None;
    }
    let matrix = DMatrix::from_fn(found.len(), 4, |row, power| found[row].0.powi(power as i32));
    let right = DVector::from_iterator(found.len(), found.iter().map(|(_, springs)| springs[spring]));
    let solution = matrix.svd(true, true).solve(&right, 1e-12).ok()?;
    Some(solution.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fra_model::{Families, Material, Placement};
    use softlimb_limb::Limb;

    /// Largest error of the fit between its points, as a share of the highest pressure: of all states, and of those without load.
    fn worst(wound: &Wound, pressure_max_pa: f64) -> (f64, f64) {
        let parameters = &wound.0;
        let stiffness = stiffness(wound, pressure_max_pa).unwrap().expect("springs");
        let law = law(wound, &stiffness, pressure_max_pa).unwrap().expect("a law");
        let section = section(wound, Symmetry::Exploit).unwrap();
        let between: Vec<f64> = (1..11).map(|k| pressure_max_pa * (f64::from(k) - 0.5) / 12.0).collect();
        let axis = usize::from(law.main == Main::Twist);
        let (mut far, mut free_far) = (0.0_f64, 0.0_f64);
        for loads in loads(parameters) {
            let loads = loads.map(|load| 0.7 * load);
            let curve = section.curve(&between, &end_load(parameters.motion, loads)).unwrap();
            for point in curve.answers.iter().filter_map(|answer| point(parameters.motion, answer, loads)) {
                let found = law.potential.loads(point.strains, point.pressure_pa);
                // Change of the load by the pressure.
                let less = law.potential.loads(point.strains, point.pressure_pa - 1e3);
                let lever = (found[axis] - less[axis]) / 1e3;
                let error = ((found[axis] - point.loads[axis]) / lever / pressure_max_pa).abs();
                far = far.max(error);
                if point.is_free() {
                    free_far = free_far.max(error);
                }
            }
        }
        (far, free_far)
    }

    /// A helix and a soft axial thread, and a mirrored pair and hoops.
    #[test]
    fn law_of_two_windings_has_the_loads_of_the_section_between_its_points() {
        let fiber = |degrees: f64, families, modulus_pa| Fiber {
            angle_rad: degrees.to_radians(),
            families,
            modulus_pa,
            placement: Placement::Sheet,
            thickness_m: 1e-4,
            radius_m: 14e-3,
        };
        let parameters = |motion, first| ActuatorParameters {
            motion,
            inner_radius_m: 10e-3,
            outer_radius_m: 14e-3,
            length_m: 0.24,
            material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
            fiber: Some(first),
        };
        // The soft bender is fitted less well where moments bend it: 2.5 % of the highest pressure.
        for (motion, first, second, most) in [
            (Motion::Twisting, fiber(30.0, Families::One, 2e8), fiber(90.0, Families::One, 2e6), 0.015),
            (Motion::Twisting, fiber(30.0, Families::One, 2e8), fiber(90.0, Families::One, 2e8), 0.015),
            (Motion::Extension, fiber(10.0, Families::Two, 2e8), fiber(0.0, Families::One, 2e8), 0.015),
            (Motion::Bending, fiber(3.0, Families::Two, 2e8), fiber(30.0, Families::Two, 2e6), 0.03),
        ] {
            let (far, free) = worst(&(parameters(motion, first), Some(second)), 60e3);
            println!("{motion:?}: {far} {free} of the highest pressure");
            assert!(far < most && free < 0.0005, "{motion:?}: {far} {free} of the highest pressure");
        }
    }

    #[test]
    fn law_has_the_loads_of_the_section_between_its_points() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        for name in ["weightless-b", "pick-and-place-a", "weightless-c"] {
            let scene = softlimb_scene::load(root.join(format!("{name}.toml"))).unwrap();
            let limb = Limb::new(&scene).unwrap();
            for module in limb.modules() {
                let (far, free) = worst(&(*module.actuator.parameters(), None), module.pressure_max_pa);
                assert!(far < 0.015 && free < 0.0005, "{name} {}: {far} {free} of the highest pressure", module.name);
            }
        }
    }
}
