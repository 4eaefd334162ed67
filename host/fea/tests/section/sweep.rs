//! Random actuators: every question has its answer, from thin walls to thick ones and from soft fibers to stiff ones.

use std::f64::consts::FRAC_PI_2;

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Status};
use softlimb_fea::cross_section::{EndLoad, Limiter, Options, Outcome, Section};
use softlimb_numerics::Random;

use crate::samples::samples;

/// Uniform and log-uniform numbers.
pub(crate) struct Numbers(Random);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Random::new(seed, 0))
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    pub(crate) fn over(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.index(choices.len())]
    }

    fn material(&mut self, mu: f64) -> Material<f64> {
        if self.one_of(&[true, false]) {
            return Material::NeoHookean { shear_modulus_pa: mu };
        }
        Material::Yeoh { c_pa: [0.5 * mu, mu * self.between(0.0, 0.1), mu * self.between(-0.001, 0.01)] }
    }

    pub(crate) fn tube(&mut self, motion: Motion) -> ActuatorParameters<f64> {
        let inner_radius_m = self.over(2e-3, 2e-2);
        let outer_radius_m = inner_radius_m * (1.0 + self.over(0.05, 1.0));
        let mu = self.over(2e4, 1e6);
        let material = self.material(mu);
        ActuatorParameters { motion, inner_radius_m, outer_radius_m, length_m: 0.1, material, fiber: None }
    }

    /// A winding of a straight tube: signed angle, every place and stiffness.
    pub(crate) fn fiber(&mut self, tube: &ActuatorParameters<f64>) -> Fiber<f64> {
        let wall = tube.outer_radius_m - tube.inner_radius_m;
        let placement = self.one_of(&[Placement::Sheet, Placement::Layer, Placement::Smeared]);
        let ratio = match placement {
            Placement::Sheet => self.over(1.0, 1e6) * wall / 1e-4,
            Placement::Layer => self.over(0.5, 100.0),
            Placement::Smeared => self.over(0.1, 20.0),
        };
        Fiber {
            angle_rad: self.between(-FRAC_PI_2, FRAC_PI_2),
            families: self.one_of(&[Families::One, Families::Two]),
            modulus_pa: ratio * tube.material.shear_modulus_pa(),
            placement,
            thickness_m: 1e-4,
            radius_m: tube.inner_radius_m + self.between(0.0, 0.98) * wall,
        }
    }
}

pub(crate) fn scale(parameters: &ActuatorParameters<f64>) -> f64 {
    parameters.material.shear_modulus_pa() * (parameters.outer_radius_m / parameters.inner_radius_m).ln()
}

fn straight(numbers: &mut Numbers) -> ActuatorParameters<f64> {
    let motion = numbers.one_of(&[Motion::Extension, Motion::Expansion, Motion::Twisting]);
    let tube = numbers.tube(motion);
    ActuatorParameters { fiber: Some(numbers.fiber(&tube)), ..tube }
}

#[test]
fn random_straight_actuators_have_the_answers_of_the_thick_wall_equations() {
    let mut numbers = Numbers::new(71);
    let (mut solved, mut limits, mut worst) = (0, 0, 0.0);
    let actuators = samples(600);
    for _ in 0..actuators {
        let parameters = straight(&mut numbers);
        let pressures: Vec<f64> = (0..4).map(|_| numbers.over(0.01, 1.0) * scale(&parameters)).collect();
        let section = Section::new(&parameters, &Options::default()).expect("valid");
        let actuator = Actuator::new(&parameters).expect("valid");
        for answer in section.curve(&pressures, &EndLoad::default()).expect("valid").answers {
            let exact = actuator.forward(answer.pressure_pa, &Load::none()).expect("valid");
            match (answer.outcome, exact.status) {
                (Outcome::Equilibrium(found), Status::Solved) => {
                    let found = found.state.over(parameters.length_m);
                    let volume = (found.volume_strain / exact.state.volume_strain - 1.0).abs();
                    let strain =
                        (found.axial_strain - exact.state.axial_strain).abs() / exact.state.volume_strain.abs();
                    assert!(volume.max(strain) < 1e-4, "{parameters:?} {}: {volume:e} {strain:e}", answer.pressure_pa);
                    worst = volume.max(strain).max(worst);
                    solved += 1;
                }
                (Outcome::NoEquilibrium { limit_pressure_pa }, Status::NoSolution) => {
                    let limit = exact.limit_pressure_pa.expect("the branch ends");
                    assert!(
                        (limit_pressure_pa / limit - 1.0).abs() < 1e-6,
                        "{parameters:?}: {limit_pressure_pa} {limit}"
                    );
                    limits += 1;
                }
                (outcome, status) => panic!("{parameters:?} {}: {outcome:?} {status:?}", answer.pressure_pa),
            }
        }
    }
    println!("{solved} equilibria, {worst:.1e} of the volume at most; {limits} beyond the limit");
    // Four pressures each, of which the first stay below the limit.
    assert!(600 * solved > 2300 * actuators && limits > 0, "{solved} {limits}");
}

/// An ideal winding with a line or a strip, two families with a strip, one family with a strip: the last one bends and twists.
fn bending(numbers: &mut Numbers) -> (ActuatorParameters<f64>, Options) {
    let kind = numbers.one_of(&[0, 1, 2, 3]);
    let tube = numbers.tube(if kind == 3 { Motion::Twisting } else { Motion::Bending });
    let (mu, wall) = (tube.material.shear_modulus_pa(), tube.outer_radius_m - tube.inner_radius_m);
    let half_angle_rad = numbers.over(0.05, 1.2);
    let strip = Limiter::Strip { half_angle_rad, stiffness_n_per_m: numbers.over(1.0, 1e3) * mu * tube.inner_radius_m };
    let fiber = Fiber {
        angle_rad: numbers.between(0.02, 0.45),
        families: if kind == 3 { Families::One } else { Families::Two },
        modulus_pa: numbers.over(10.0, 1e5) * mu * wall / 1e-4,
        placement: Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: numbers.between(tube.inner_radius_m + 0.5 * wall, tube.outer_radius_m),
    };
    let options = Options { limiter: Some(if kind == 0 { Limiter::Line } else { strip }), ..Options::default() };
    (ActuatorParameters { fiber: (kind > 1).then_some(fiber), ..tube }, options)
}

#[test]
fn random_bending_actuators_all_have_answers() {
    let mut numbers = Numbers::new(73);
    let (mut worst, mut steps) = (0.0, 0);
    for _ in 0..samples(150) {
        let (parameters, options) = bending(&mut numbers);
        let highest = numbers.over(0.05, 1.0) * scale(&parameters);
        let section = Section::new(&parameters, &options).expect("valid");
        let pressures = [highest / 3.0, highest / 1.5, highest];
        let curve = section.curve(&pressures, &EndLoad::default()).expect("valid");
        let mut before = 0.0;
        for answer in &curve.answers {
            let equilibrium = answer.equilibrium().unwrap_or_else(|| panic!("{parameters:?} {options:?}: {answer:?}"));
            let rate = equilibrium.state.bend_rates_rad_per_m[0];
            let error = equilibrium.error.expect("two meshes").bend_rates_rad_per_m[0] / rate;
            assert!(rate > before && error < 3e-3, "{parameters:?} {options:?}: {rate} {error}");
            worst = f64::max(worst, error);
            before = rate;
        }
        steps = steps.max(curve.effort.increments + curve.effort.rejected);
    }
    println!("largest estimate {worst:.1e}, at most {steps} steps");
    assert!(steps <= 20, "{steps}");
}
