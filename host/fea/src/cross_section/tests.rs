//! The parts of the solver against what they are derivatives, factors or solutions of.

mod derivatives;
mod potential;

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use nalgebra::{DMatrix, DVector};

use super::build::{Build, Part};
use super::chain::Chain;
use super::front::Front;
use super::grid::Grid;
use super::model::{Border, Form, State, means};
use super::options::{Limiter, Options};

/// A seeded stream of numbers in `-1..1`.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn parameters(material: Material<f64>, placement: Option<Placement>) -> ActuatorParameters<f64> {
    let fiber = |placement| Fiber {
        angle_rad: 0.5,
        families: Families::One,
        modulus_pa: 2e6,
        placement,
        thickness_m: 1e-4,
        radius_m: 7.5e-3,
    };
    ActuatorParameters {
        motion: Motion::Twisting,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material,
        fiber: placement.map(fiber),
    }
}

const YEOH: Material<f64> = Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1_466.1] };
const SOFT: Material<f64> = Material::NeoHookean { shear_modulus_pa: 0.2e6 };

fn chain(parameters: &ActuatorParameters<f64>, limiter: Limiter, part: Part) -> Chain {
    let build = Build::new(parameters, None, &Options { limiter: Some(limiter), ..Options::default() }).expect("valid");
    Chain::new(&build, Grid::new(&build, part, 1, 3, 1))
}

/// All unknowns and multipliers in a row, with the matrix and the two right-hand sides of all columns added up without elimination.
struct Dense {
    matrix: DMatrix<f64>,
    /// Gradient of the potential and of the volume.
    gradient: DVector<f64>,
    by_volume: DVector<f64>,
    /// Energy less the work of the constraint, and enclosed volume.
    sums: [f64; 2],
    /// First pressure, strain and multiplier.
    pressures: usize,
    strains: usize,
    means: usize,
}

fn dense(chain: &Chain, state: &State) -> Dense {
    let grid = &chain.grid;
    let nodes = grid.radii.len() * grid.dofs();
    let pressures = grid.lines() * nodes;
    let strains = pressures + 3 * grid.rings() * grid.columns();
    let size = strains + 4 + means(grid.part).len();
    let mut sum = Dense {
        matrix: DMatrix::zeros(size, size),
        gradient: DVector::zeros(size),
        by_volume: DVector::zeros(size),
        sums: [0.0; 2],
        pressures,
        strains,
        means: strains + 4,
    };
    for (index, column) in chain.columns.iter().enumerate() {
        let start = column.border_start(grid);
        let mut front = Front::new(start + Border::len(grid), 0);
        let (energy, volume) = column.assemble(grid, index, state, chain.elastomer, &mut front);
        sum.sums = [sum.sums[0] + energy, sum.sums[1] + volume];
        let border = Border::of(grid, start);
        let place = |variable: usize| {
            if variable >= border.strain {
                return Some(strains + variable - border.strain);
            }
            if variable >= start {
                return (variable < border.springs).then(|| strains + 4 + variable - start);
            }
            let lines = (0..3).map(|line| (line, column.node_start(grid, line)));
            let mut holding = lines.filter(|(_, first)| (*first..first + nodes).contains(&variable));
            Some(match holding.next() {
                Some((line, first)) => ((2 * index + line) % grid.lines()) * nodes + variable - first,
                None => pressures + 3 * grid.rings() * index + variable - column.pressure_start(grid),
            })
        };
        for i in 0..border.residual {
            let Some(to) = place(i) else { continue };
            sum.gradient[to] -= front.get(border.residual, i);
            sum.by_volume[to] += front.get(border.by_pressure, i);
            for j in 0..border.residual {
                if let Some(at) = place(j) {
                    sum.matrix[(to, at)] += front.get(i, j);
                }
            }
        }
    }
    sum
}

/// The unknowns as one row, and back.
fn flat(form: &Form) -> Vec<f64> {
    form.places.iter().chain(form.pressures.iter().flatten()).chain(&form.strain).copied().collect()
}

fn moved(form: &Form, by: &[f64], times: f64) -> Form {
    let mut form = form.clone();
    let Form { places, pressures, strain } = &mut form;
    let all = places.iter_mut().chain(pressures.iter_mut().flatten()).chain(strain.iter_mut());
    all.zip(by).for_each(|(value, by)| *value += times * by);
    form
}

/// The tensions that belong to the fibers' strains.
fn tensions(chain: &Chain, form: &Form) -> Vec<[f64; 2]> {
    chain.tensions_after(form, &Form::none(&chain.grid))
}

/// Somewhere off equilibrium, at a pressure of a tenth.
fn somewhere(chain: &Chain, seed: u64) -> State {
    let mut numbers = Numbers(seed);
    let rest = chain.rest().form;
    let by: Vec<f64> = flat(&rest).iter().map(|_| numbers.next()).collect();
    let form = moved(&rest, &by, 0.02);
    State { tensions: tensions(chain, &form), form, pressure: 0.1 }
}

/// Every kind of wall, winding and limiting layer in two chains that warp.
fn all_kinds() -> [Chain; 3] {
    let strip = Limiter::Strip { half_angle_rad: 0.8, stiffness_n_per_m: 5e3 };
    [
        chain(&parameters(YEOH, Some(Placement::Sheet)), strip, Part::Ring),
        chain(&parameters(YEOH, Some(Placement::Layer)), Limiter::None, Part::Ring),
        chain(&parameters(SOFT, Some(Placement::Smeared)), strip, Part::Ring),
    ]
}

/// Displacements around at the plane of symmetry of half a section.
fn mirrored(chain: &Chain) -> Vec<usize> {
    let grid = &chain.grid;
    let of_line =
        |line: usize| (0..grid.radii.len()).map(move |node| (line * grid.radii.len() + node) * grid.dofs() + 1);
    if grid.part == Part::Half { of_line(0).chain(of_line(grid.lines() - 1)).collect() } else { Vec::new() }
}

/// Puts what does not move where it is, and what is not free as it is at rest.
fn hold_mirror(chain: &Chain, state: &mut State) {
    mirrored(chain).into_iter().for_each(|variable| state.form.places[variable] = 0.0);
    let rest = chain.rest().form.strain;
    (0..4).filter(|&strain| !chain.grid.free()[strain]).for_each(|strain| state.form.strain[strain] = rest[strain]);
    state.tensions = tensions(chain, &state.form);
}

/// The elimination around the section against one dense factorization of everything.
#[test]
fn the_chain_solves_the_system_that_the_columns_add_up_to() {
    for part in [Part::Ring, Part::Half] {
        let mut chain = chain(&parameters(YEOH, Some(Placement::Sheet)), Limiter::Line, part);
        let mut state = somewhere(&chain, 23);
        hold_mirror(&chain, &mut state);
        let load = [0.02, 0.01, -0.03, 0.04];
        let solved = chain.solve(&state, &load).expect("regular");
        let Dense { mut matrix, gradient, by_volume, strains, means, .. } = dense(&chain, &state);
        let free = chain.grid.free();
        let mut right = -gradient;
        right.rows_mut(means, right.len() - means).fill(0.0);
        let mut by_pressure = by_volume.clone();
        (0..4).for_each(|strain| right[strains + strain] += load[strain]);
        let held = (0..4).filter(|&strain| !free[strain]).map(|strain| strains + strain).chain(mirrored(&chain));
        for variable in held {
            matrix.row_mut(variable).fill(0.0);
            matrix.column_mut(variable).fill(0.0);
            matrix[(variable, variable)] = 1.0;
            (right[variable], by_pressure[variable]) = (0.0, 0.0);
        }
        let factors = matrix.clone().full_piv_lu();
        for (side, form) in [(&right, &solved.step), (&by_pressure, &solved.by_pressure)] {
            let expected = factors.solve(side).expect("regular");
            let found = DVector::from_vec(flat(form));
            let error = (expected.rows(0, found.len()) - &found).amax();
            assert!(error <= 1e-8 * expected.amax(), "{part:?}: {error:e} of {:e}", expected.amax());
        }
        let compliance = by_pressure.dot(&factors.solve(&by_pressure).expect("regular"));
        assert!((solved.compliance / compliance - 1.0).abs() < 1e-8, "{part:?}");
        let negative = matrix.symmetric_eigen().eigenvalues.iter().filter(|value| **value < 0.0).count();
        let expected = 3 * chain.grid.rings() * chain.grid.columns() + super::model::means(part).len();
        assert_eq!(solved.instabilities, negative.abs_diff(expected), "{part:?}");
    }
}

/// Elimination of all but the strains against the inverse of what is eliminated.
#[test]
fn stiffness_is_the_condensed_matrix() {
    let mut chain = chain(&parameters(YEOH, Some(Placement::Sheet)), Limiter::None, Part::Ring);
    let state = somewhere(&chain, 29);
    let solved = chain.solve(&state, &[0.0; 4]).expect("regular");
    let Dense { matrix, by_volume, strains, .. } = dense(&chain, &state);
    let rest = matrix.clone().remove_rows(strains, 4).remove_columns(strains, 4);
    let beside = matrix.columns(strains, 4).into_owned().remove_rows(strains, 4);
    let factors = rest.full_piv_lu();
    let own = matrix.view((strains, strains), (4, 4));
    let stiffness = own - beside.transpose() * factors.solve(&beside).expect("regular");
    let volume = by_volume.clone().remove_rows(strains, 4);
    let lever = by_volume.rows(strains, 4) - beside.transpose() * factors.solve(&volume).expect("regular");
    for i in 0..4 {
        assert!((solved.lever[i] - lever[i]).abs() < 1e-8 * lever.amax(), "{:?} {lever}", solved.lever);
        for j in 0..4 {
            let difference = (solved.stiffness[i][j] - stiffness[(i, j)]).abs();
            assert!(difference < 1e-8 * stiffness.amax(), "{:?} {stiffness}", solved.stiffness);
        }
    }
}

#[test]
fn volume_of_a_screwed_cylinder_is_its_area_times_the_stretch() {
    let chain = chain(&parameters(SOFT, None), Limiter::None, Part::Ring);
    let mut form = chain.rest().form;
    let area = chain.potential(&form).1;
    // Six parabolas around are not quite a circle: each lacks about x^5/960 of its area, x being its angle.
    let lacking = 6.0 * (std::f64::consts::PI / 3.0).powi(5) / 960.0;
    assert!((area - std::f64::consts::PI + lacking).abs() < 0.1 * lacking, "{area}");
    form.strain = [1.3, 0.2, -0.1, 0.4];
    // Bends and twist turn about the middle of the lumen and do not change its volume.
    let volume = chain.potential(&form).1;
    assert!((volume - 1.3 * area).abs() < 1e-12, "{volume} {area}");
}

/// Shear in the plane, along the axis, stretch: a constant deformation gradient of unit determinant is in equilibrium in the interior,
/// keeps the volume of every element and has the energy of its invariant, on the coarsest mesh.
#[test]
fn a_homogeneous_deformation_is_exact() {
    let chain = chain(&parameters(SOFT, None), Limiter::None, Part::Ring);
    let grid = &chain.grid;
    let stretch = 1.2;
    let plane = [[1.1, 0.3], [-0.2, (1.0 / stretch - 0.06) / 1.1]];
    let warp = [0.15, -0.25];
    let mut form = chain.rest().form;
    for line in 0..grid.lines() {
        let (sin, cos) = grid.angles[line].sin_cos();
        for (node, radius) in grid.radii.iter().enumerate() {
            let (x, y) = (radius * cos, radius * sin);
            let to = [plane[0][0] * x + plane[0][1] * y, plane[1][0] * x + plane[1][1] * y];
            let first = (line * grid.radii.len() + node) * 3;
            form.places[first] = cos * to[0] + sin * to[1];
            form.places[first + 1] = -sin * to[0] + cos * to[1];
            form.places[first + 2] = warp[0] * x + warp[1] * y;
        }
    }
    form.strain[0] = stretch;
    form.pressures.fill([0.7, 0.0, 0.0]);
    let state = State { tensions: tensions(&chain, &form), form: form.clone(), pressure: 0.0 };
    let sum = dense(&chain, &state);
    for line in 0..grid.lines() {
        for node in 1..grid.radii.len() - 1 {
            let first = (line * grid.radii.len() + node) * 3;
            let force = sum.gradient.rows(first, 3).amax();
            assert!(force < 1e-14, "line {line}, node {node}: {force:e}");
        }
    }
    let lost = sum.gradient.rows(sum.pressures, sum.strains - sum.pressures).amax();
    assert!(lost < 1e-15, "volume: {lost:e}");
    let squares: f64 = plane.iter().flatten().chain(&warp).map(|f| f * f).sum::<f64>() + stretch * stretch;
    let lumen = chain.potential(&chain.rest().form).1;
    let ratio = (8.0f64 / 6.0).powi(2);
    let energy = chain.potential(&form).0;
    assert!((energy - 0.5 * (squares - 3.0) * lumen * (ratio - 1.0)).abs() < 1e-12, "{energy}");
}

#[test]
fn fronts_count_negative_eigenvalues_and_solve() {
    let mut numbers = Numbers(31);
    for size in [1usize, 2, 5, 12] {
        for _ in 0..50 {
            // Half of the diagonals are zero, as those of pressures are.
            let mut matrix = DMatrix::from_fn(size, size, |_, _| numbers.next());
            matrix += matrix.transpose();
            (0..size).filter(|i| i % 2 == 1).for_each(|i| matrix[(i, i)] = 0.0);
            let right: Vec<f64> = (0..size).map(|_| numbers.next()).collect();
            let mut front = Front::new(size + 1, size);
            for i in 0..size {
                front.add(size, i, right[i]);
                (0..=i).for_each(|j| front.add(i, j, matrix[(i, j)]));
            }
            let Ok(negative) = front.factor() else { panic!("a random matrix is regular") };
            let expected = matrix.clone().symmetric_eigen().eigenvalues.iter().filter(|value| **value < 0.0).count();
            assert_eq!(negative, expected, "{matrix}");
            let found = DVector::from_vec(front.substitute(size, &[]));
            let residual = (matrix * &found - DVector::from_vec(right)).amax();
            assert!(residual < 1e-9 * (1.0 + found.amax()), "{residual:e}");
        }
    }
}

/// Which section of the helix is looked at does not matter: moving all places along the screw motion works on nothing.
#[test]
fn sliding_along_the_helix_changes_neither_energy_nor_volume() {
    for chain in &all_kinds() {
        let mut state = somewhere(chain, 41);
        state.form.strain = [1.1, 0.3, -0.2, 0.5];
        state.tensions = tensions(chain, &state.form);
        let [l0, k1, k2, tau] = state.form.strain;
        let grid = &chain.grid;
        let slide = state.form.places.chunks(3).enumerate().flat_map(|(node, place)| {
            let (sin, cos) = grid.angles[node / grid.radii.len()].sin_cos();
            let (x, y, z) = (cos * place[0] - sin * place[1], sin * place[0] + cos * place[1], place[2]);
            let along = [k1 * z - tau * y, tau * x + k2 * z, l0 - k1 * x - k2 * y];
            [cos * along[0] + sin * along[1], -sin * along[0] + cos * along[1], along[2]]
        });
        let sum = dense(chain, &state);
        let [mut energy, mut volume, mut size] = [0.0; 3];
        for (unknown, change) in slide.enumerate() {
            energy += sum.gradient[unknown] * change;
            volume += sum.by_volume[unknown] * change;
            size += (sum.gradient[unknown] * change).abs();
        }
        assert!(energy.abs() < 1e-13 * size && volume.abs() < 1e-13 * size, "{energy:e} {volume:e} {size:e}");
    }
}
