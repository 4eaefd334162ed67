//! Values, gradients and tangents against the second potential, whose derivatives are those of hyper-dual numbers.

use fra_model::{ActuatorParameters, Families, Fiber, Placement};
use nalgebra::{DMatrix, DVector};

use super::super::build::{Build, Part};
use super::super::chain::Chain;
use super::super::grid::Grid;
use super::super::model::State;
use super::super::options::{Limiter, Options, Winding};
use super::potential::Second;
use super::{Dense, Numbers, SOFT, YEOH, dense, flat, hold_mirror, mirrored, parameters, somewhere, tensions};
use crate::hyper_dual::HyperDual;

/// A section that has something the others have not.
struct Case {
    parameters: ActuatorParameters<f64>,
    second: Option<Fiber<f64>>,
    options: Options,
    part: Part,
    /// Elements across the wall, and around half a turn.
    mesh: [usize; 2],
}

/// Every material, placement and limiting layer, in the parts of a section that may have them.
fn cases() -> Vec<Case> {
    let fibers = |placement, radius_m, families| {
        let mut parameters = parameters(YEOH, Some(placement));
        let fiber = parameters.fiber.expect("wound");
        parameters.fiber = Some(Fiber { families, radius_m, ..fiber });
        parameters
    };
    let strip = Limiter::Strip { half_angle_rad: 0.8, stiffness_n_per_m: 5e3 };
    let (line, none) = (Limiter::Line, Limiter::None);
    let case = |parameters, limiter, part| {
        let options = Options { limiter: Some(limiter), ..Options::default() };
        Case { parameters, second: None, options, part, mesh: [1, 3] }
    };
    let ideal = |part| {
        let mut case = case(parameters(SOFT, None), line, part);
        case.options.winding = Winding::Ideal;
        case
    };
    // Beside a helix of one family: an axial thread in another place, or an opposite helix.
    let twice = |case: Case, placement, radius_m, angle_rad| {
        let fiber = case.parameters.fiber.expect("wound");
        let modulus_pa = 3.0 * fiber.modulus_pa;
        Case { second: Some(Fiber { angle_rad, placement, radius_m, modulus_pa, ..fiber }), ..case }
    };
    let helix = |limiter, part| case(fibers(Placement::Sheet, 7.5e-3, Families::One), limiter, part);
    let axial = std::f64::consts::FRAC_PI_2;
    let layer = case(fibers(Placement::Layer, 7e-3, Families::One), strip, Part::Ring);
    vec![
        twice(helix(none, Part::Wedge), Placement::Sheet, 6.5e-3, axial),
        twice(helix(line, Part::Ring), Placement::Layer, 7e-3, -0.2),
        twice(layer, Placement::Smeared, 7e-3, axial),
        twice(helix(strip, Part::Half), Placement::Sheet, 7.5e-3, -0.5),
        case(parameters(SOFT, None), none, Part::Wedge),
        case(fibers(Placement::Sheet, 7.5e-3, Families::One), none, Part::Wedge),
        Case { mesh: [2, 3], ..case(fibers(Placement::Layer, 7e-3, Families::Two), line, Part::Half) },
        case(fibers(Placement::Sheet, 6e-3, Families::Two), strip, Part::Half),
        case(fibers(Placement::Sheet, 7.5e-3, Families::One), strip, Part::Ring),
        case(fibers(Placement::Sheet, 8e-3, Families::Two), line, Part::Ring),
        case(fibers(Placement::Layer, 7e-3, Families::One), none, Part::Ring),
        case(
            ActuatorParameters { material: SOFT, ..fibers(Placement::Smeared, 7e-3, Families::One) },
            strip,
            Part::Ring,
        ),
        ideal(Part::Half),
        ideal(Part::Ring),
    ]
}

/// A case far from rest, with the second potential along two directions.
struct Probe {
    case: Case,
    chain: Chain,
    state: State,
    /// Unknowns that the part does not have: those of its symmetry.
    held: Vec<usize>,
}

impl Probe {
    fn new(case: Case, seed: u64) -> Self {
        let build = Build::new(&case.parameters, case.second.as_ref(), &case.options).expect("valid");
        let chain = Chain::new(&build, Grid::new(&build, case.part, case.mesh[0], case.mesh[1], 1));
        let mut state = somewhere(&chain, seed);
        state.form.strain = [1.2, 0.3, -0.2, 0.5];
        hold_mirror(&chain, &mut state);
        state.tensions = tensions(&chain, &state.form);
        let strains = flat(&state.form).len() - 4;
        let fixed = (0..4).filter(|&strain| !chain.grid.free()[strain]).map(|strain| strains + strain);
        let held = mirrored(&chain).into_iter().chain(fixed).collect();
        Self { case, chain, state, held }
    }

    fn free(&self) -> Vec<usize> {
        (0..flat(&self.state.form).len()).filter(|unknown| !self.held.contains(unknown)).collect()
    }

    /// Energy less the pressure's work, and the volume, along two directions.
    fn second(&self, along: [&[f64]; 2]) -> [HyperDual; 2] {
        let values = flat(&self.state.form);
        let unknowns: Vec<HyperDual> =
            (0..values.len()).map(|i| HyperDual::moving(values[i], [along[0][i], along[1][i]])).collect();
        let Case { parameters, second, options, .. } = &self.case;
        let second_fiber = *second;
        let [energy, volume] =
            Second { parameters, second_fiber, options, grid: &self.chain.grid, unknowns: &unknowns }.sums();
        [energy - volume * self.state.pressure, volume]
    }

    fn direction(&self, numbers: &mut Numbers) -> Vec<f64> {
        let mut direction: Vec<f64> = flat(&self.state.form).iter().map(|_| numbers.next()).collect();
        self.held.iter().for_each(|&unknown| direction[unknown] = 0.0);
        direction
    }
}

#[track_caller]
fn close(what: &str, case: usize, found: f64, expected: f64, bar: f64) {
    assert!((found - expected).abs() <= bar * expected.abs(), "{what} of case {case}: {found:e}, not {expected:e}");
}

/// Values, slopes and second derivatives along random directions at random states far from rest.
#[test]
fn value_gradient_and_tangent_are_those_of_the_potential_by_hyper_dual_numbers() {
    let mut numbers = Numbers(43);
    for (index, case) in cases().into_iter().enumerate() {
        let probe = Probe::new(case, 47 + index as u64);
        let Dense { matrix, gradient, by_volume, sums, .. } = dense(&probe.chain, &probe.state);
        let (energy, volume) = probe.chain.potential(&probe.state.form);
        for _ in 0..4 {
            let (u, v) = (probe.direction(&mut numbers), probe.direction(&mut numbers));
            let [potential, lumen] = probe.second([&u, &v]);
            for [energy, volume] in [[energy, volume], sums] {
                close("potential", index, energy - probe.state.pressure * volume, potential.value, 1e-12);
                close("volume", index, volume, lumen.value, 1e-12);
            }
            let dot = |g: &DVector<f64>| g.iter().zip(&u).map(|(g, u)| g * u).sum::<f64>();
            close("slope", index, dot(&gradient), potential.first[0], 1e-11);
            close("slope of the volume", index, dot(&by_volume), lumen.first[0], 1e-11);
            let second = bilinear(&matrix, &u, &v);
            close("tangent", index, second, potential.second, 1e-11);
        }
    }
}

fn bilinear(matrix: &DMatrix<f64>, u: &[f64], v: &[f64]) -> f64 {
    let row = |(i, u): (usize, &f64)| u * (0..v.len()).map(|j| matrix[(i, j)] * v[j]).sum::<f64>();
    u.iter().enumerate().map(row).sum()
}

/// Every entry by itself: among stiff fibers a random direction would not see a soft one.
#[test]
fn every_entry_of_the_tangent_is_that_of_the_potential() {
    for (index, case) in cases().into_iter().enumerate() {
        let probe = Probe::new(case, 59 + index as u64);
        let Dense { matrix, gradient, .. } = dense(&probe.chain, &probe.state);
        let size = flat(&probe.state.form).len();
        let unit = |at: usize| (0..size).map(|i| f64::from(u8::from(i == at))).collect::<Vec<_>>();
        let rows: Vec<f64> = (0..size).map(|i| matrix.row(i).amax()).collect();
        for &i in &probe.free() {
            for &j in probe.free().iter().filter(|j| **j <= i) {
                let [exact, _] = probe.second([&unit(i), &unit(j)]);
                // Rounding of what was added up on the way.
                let noise = 1e-13 * rows[i].min(rows[j]);
                let error = (matrix[(i, j)] - exact.second).abs().max((matrix[(j, i)] - exact.second).abs());
                assert!(error <= 1e-11 * exact.second.abs() + noise, "case {index}, {i} {j}: {error:e} of {exact:?}");
                let error = (gradient[i] - exact.first[0]).abs();
                assert!(error <= 1e-11 * exact.first[0].abs() + 1e-13 * rows[i], "case {index}, {i}: {error:e}");
            }
        }
    }
}
