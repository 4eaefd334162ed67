//! Stiffness of the section under pressure and load.

use fra_model::{ActuatorParameters, Motion, Placement};
use softlimb_fea::cross_section::{EndLoad, Equilibrium, Limiter, Mesh, Options, SectionState, Stiffness, Symmetry};

use crate::section::cases::{DRAGON_SKIN, SOFT, curve, tube, wound};

fn options(limiter: Limiter) -> Options {
    let mesh = Mesh { radial: 2, around: 8 };
    Options { symmetry: Symmetry::Ignore, mesh, limiter: Some(limiter), ..Options::default() }
}

const STRIP: Limiter = Limiter::Strip { half_angle_rad: 0.6, stiffness_n_per_m: 2e4 };

/// One family and a strip: everything couples with everything.
fn coupled() -> ActuatorParameters<f64> {
    wound(tube(Motion::Twisting, 6.0, 8.0, DRAGON_SKIN), 25.0, Placement::Sheet, 300.0, 8.0)
}

fn solved(pressure_pa: f64, load: [f64; 4]) -> Equilibrium {
    let load = EndLoad { force_n: load[0], bending_moments_nm: [load[1], load[2]], torque_nm: load[3] };
    *curve(&coupled(), &options(STRIP), &[pressure_pa], &load).answers[0].equilibrium().expect("stable")
}

fn strains(state: &SectionState) -> [f64; 4] {
    let [first, second] = state.bend_rates_rad_per_m;
    [state.axial_strain, first, second, state.twist_rate_rad_per_m]
}

const PRESSURE: f64 = 20e3;
const LOAD: [f64; 4] = [0.5, 2e-3, 1e-3, 1e-3];

/// Loads of which each changes its strain by about a thousandth of the section's size.
const CHANGES: [f64; 4] = [0.01, 5e-5, 5e-5, 5e-5];

#[test]
fn the_stiffness_is_symmetric_and_positive() {
    let Stiffness { by_strain, .. } = solved(PRESSURE, LOAD).stiffness.expect("the whole section");
    for i in 0..4 {
        assert!(by_strain[i][i] > 0.0, "{by_strain:?}");
        for j in 0..4 {
            let scale = (by_strain[i][i] * by_strain[j][j]).sqrt();
            assert!((by_strain[i][j] - by_strain[j][i]).abs() < 1e-10 * scale, "{by_strain:?}");
        }
    }
}

/// Stiffness times the strains that a small load adds is that load.
#[test]
fn small_loads_deform_as_the_stiffness_says() {
    let Stiffness { by_strain, .. } = solved(PRESSURE, LOAD).stiffness.expect("the whole section");
    for component in 0..4 {
        let [more, less] = [1.0, -1.0].map(|sign| {
            let mut load = LOAD;
            load[component] += sign * CHANGES[component];
            strains(&solved(PRESSURE, load).state)
        });
        let change: [f64; 4] = std::array::from_fn(|i| 0.5 * (more[i] - less[i]));
        for row in 0..4 {
            let load: f64 = (0..4).map(|column| by_strain[row][column] * change[column]).sum();
            let expected = if row == component { CHANGES[row] } else { 0.0 };
            assert!((load - expected).abs() < 1e-3 * CHANGES[row], "{component} {row}: {load} {expected}");
        }
    }
}

/// What the pressure does to the strains at constant load, through stiffness and lever, and what it does to the volume.
#[test]
fn small_pressures_deform_as_the_lever_says() {
    let here = solved(PRESSURE, LOAD);
    let Stiffness { by_strain, lever } = here.stiffness.expect("the whole section");
    let rise = 20.0;
    let [more, less] = [rise, -rise].map(|change| solved(PRESSURE + change, LOAD).state);
    let slopes: [f64; 4] = std::array::from_fn(|i| (strains(&more)[i] - strains(&less)[i]) / (2.0 * rise));
    for row in 0..4 {
        let load: f64 = (0..4).map(|column| by_strain[row][column] * slopes[column]).sum();
        let scale: f64 = (0..4).map(|column| (by_strain[row][column] * slopes[column]).abs()).sum();
        assert!((load - lever[row]).abs() < 1e-5 * scale, "{row}: {load:e} {:e} {scale:e}", lever[row]);
    }
    let compliance = (more.volume_m2 - less.volume_m2) / (2.0 * rise);
    let share = here.state.compliance_m2_per_pa / compliance - 1.0;
    assert!(share.abs() < 1e-5, "{share:e}");
}

/// Maxwell: the volume changes by a load as the strain does by the pressure.
#[test]
fn volume_by_load_is_strain_by_pressure() {
    let rise = 20.0;
    let [more, less] = [rise, -rise].map(|change| strains(&solved(PRESSURE + change, LOAD).state));
    for component in 0..4 {
        let by_pressure = (more[component] - less[component]) / (2.0 * rise);
        let [high, low] = [1.0, -1.0].map(|sign| {
            let mut load = LOAD;
            load[component] += sign * CHANGES[component];
            solved(PRESSURE, load).state.volume_m2
        });
        let by_load = (high - low) / (2.0 * CHANGES[component]);
        assert!(
            (by_load - by_pressure).abs() < 2e-4 * by_pressure.abs() + 1e-12,
            "{component}: {by_load} {by_pressure}"
        );
    }
}

/// A bare tube at rest is a beam: `E A`, `E I`, `G J` with `E = 3 mu`; the mesh and nothing else is in between.
#[test]
fn a_bare_tube_at_rest_has_the_stiffness_of_a_beam() {
    let parameters = tube(Motion::Extension, 6.0, 8.0, SOFT);
    let fine = Options { mesh: Mesh { radial: 4, around: 16 }, ..options(Limiter::None) };
    let answer = curve(&parameters, &fine, &[0.0], &EndLoad::default()).answers[0];
    let Stiffness { by_strain, lever } = answer.equilibrium().expect("at rest").stiffness.expect("the whole section");
    let power = |n: i32| 8e-3f64.powi(n) - 6e-3f64.powi(n);
    let (modulus, shear) = (0.6e6, 0.2e6);
    let bending = modulus * std::f64::consts::FRAC_PI_4 * power(4);
    let torsion = shear * std::f64::consts::FRAC_PI_2 * power(4);
    let beam = [modulus * std::f64::consts::PI * power(2), bending, bending, torsion];
    for i in 0..4 {
        assert!((by_strain[i][i] / beam[i] - 1.0).abs() < 1e-4, "{i}: {} {}", by_strain[i][i], beam[i]);
        for j in (0..4).filter(|&j| j != i) {
            assert!(by_strain[i][j].abs() < 1e-6 * (beam[i] * beam[j]).sqrt(), "{by_strain:?}");
        }
    }
    // Stretched at no pressure the lumen keeps half of its growth: its area falls as the inverse of the stretch, and no volume is won.
    assert!(lever[0].abs() < 1e-4 * 36e-6, "{lever:?}");
}

#[test]
fn part_of_the_section_has_no_stiffness_to_offer() {
    let parameters = tube(Motion::Bending, 6.0, 8.0, SOFT);
    let answer = curve(&parameters, &Options::default(), &[20e3], &EndLoad::default()).answers[0];
    assert!(answer.equilibrium().expect("stable").stiffness.is_none());
}

/// What the pressure has done is in the wall: `dU/dP = P dV/dP`, the end being free.
#[test]
fn the_work_of_the_pressure_is_the_strain_energy() {
    let rise = 20.0;
    let [more, less] = [rise, -rise].map(|change| solved(PRESSURE + change, [0.0; 4]).state);
    let energy = (more.energy_j_per_m - less.energy_j_per_m) / (2.0 * rise);
    let work = PRESSURE * solved(PRESSURE, [0.0; 4]).state.compliance_m2_per_pa;
    // The mesh's lumen is a little less than the circle that the volume is given for.
    assert!((energy / work - 1.0).abs() < 2e-3, "{energy} {work}");
}
