//! A finite element model of one actuator that takes nothing about its section for granted: the section is carried along a helix with
//! constant stretch, bends and twist of the axis, and its shape is unknown.
//!
//! Nine-node elements with linear pressures keep the volume of the wall; one potential gives residual and stiffness. All motions and
//! their combinations, fibers in the wall or on a surface, a strain-limiting line or strip, loads on the end. `docs/explanation/cross-section.md` derives it.
//!
//! ```
//! use fra_model::{ActuatorParameters, Material, Motion};
//! use softlimb_fea::cross_section::{EndLoad, Options, Section};
//! let parameters = ActuatorParameters {
//!     motion: Motion::Bending,
//!     inner_radius_m: 6e-3,
//!     outer_radius_m: 8e-3,
//!     length_m: 0.1,
//!     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
//!     fiber: None,
//! };
//! let section = Section::new(&parameters, &Options::default())?;
//! let curve = section.curve(&[10e3, 20e3, 30e3], &EndLoad::default())?;
//! let bent = curve.answers[2].equilibrium().expect("far from any limit");
//! let angle = bent.state.bend_rates_rad_per_m[0] * parameters.length_m;
//! assert!((angle.to_degrees() - 43.4).abs() < 0.1);
//! # Ok::<(), softlimb_fea::cross_section::SectionError>(())
//! ```

mod analytic_error;
mod answer;
mod bending;
mod build;
mod calibrate;
mod chain;
mod column;
mod error;
mod front;
mod grid;
mod interpolated;
mod limit;
mod load;
mod lumen;
mod model;
mod options;
mod path;
mod response;
mod spot;
mod spots;
#[cfg(test)]
mod tests;

use fra_model::{ActuatorParameters, Fiber};

pub use analytic_error::{BEND_TOLERANCE, analytic_bend_error, is_wound_bender, largest_bend_error};
pub use answer::{Answer, Budget, Equilibrium, ErrorEstimate, Outcome, SectionState, Stiffness};
pub use bending::{BendingLaw, BendingMoment};
pub use calibrate::{BendPolynomial, CALIBRATED_FROM, Calibration};
pub use error::SectionError;
pub use interpolated::Interpolated;
pub use options::{EndLoad, Limiter, Mesh, Options, Symmetry, Winding};

use build::{Build, Part};
use chain::Chain;
use grid::Grid;
use path::{Path, Point, Reached};

use softlimb_files::range::require;

/// Highest pressure, in units of the shear modulus.
const PRESSURE_MAX: f64 = 100.0;

/// An actuator as the section model sees it, ready to be asked.
#[derive(Clone, Debug)]
pub struct Section {
    build: Build,
    options: Options,
}

/// The answers to a set of pressures.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// One answer for each pressure, in the order asked.
    pub answers: Vec<Answer>,
    /// The work on the finer mesh, whose answers they are.
    pub effort: Budget,
    /// The work on the coarser one, for their errors.
    pub coarse_effort: Budget,
}

impl Section {
    /// Builds the section of an actuator.
    ///
    /// # Errors
    /// [`SectionError`] with field, value and allowed range for parameters or options that the model cannot accept.
    pub fn new(parameters: &ActuatorParameters<f64>, options: &Options) -> Result<Self, SectionError> {
        Ok(Self { build: Build::new(parameters, None, options)?, options: *options })
    }

    /// Builds the section of an actuator with a second winding: another angle, stiffness or place. Without a mirror image in the
    /// windings, a bending actuator twists, too.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`SectionError::SecondWinding`] for the second winding.
    pub fn with_two_windings(
        parameters: &ActuatorParameters<f64>,
        second_fiber: &Fiber<f64>,
        options: &Options,
    ) -> Result<Self, SectionError> {
        Ok(Self { build: Build::new(parameters, Some(second_fiber), options)?, options: *options })
    }

    /// Highest gauge pressure, Pa, that the model takes: 100 times the shear modulus.
    pub fn pressure_max_pa(&self) -> f64 {
        PRESSURE_MAX * self.build.modulus_pa
    }

    /// The equilibria at gauge pressures, Pa, each 0 to 100 times the shear modulus, under a constant load on the end.
    ///
    /// # Errors
    /// [`SectionError::Option`] for a pressure or a load out of range.
    pub fn curve(&self, pressures_pa: &[f64], load: &EndLoad) -> Result<Curve, SectionError> {
        load.check()?;
        for &pressure in pressures_pa {
            let allowed = (0.0..=self.pressure_max_pa()).contains(&pressure);
            require(allowed, "pressures_pa", pressure, "0 to 100 times the shear modulus")?;
        }
        let (coarse, coarse_effort) = self.on_mesh(1, pressures_pa, load);
        let (fine, effort) = self.on_mesh(2, pressures_pa, load);
        let answers = pressures_pa.iter().zip(fine).zip(coarse);
        let factor = self.build.error_factor();
        let answers = answers
            .map(|((&pressure_pa, fine), coarse)| Answer { pressure_pa, outcome: with_error(fine, &coarse, factor) });
        Ok(Curve { answers: answers.collect(), effort, coarse_effort })
    }

    /// The outcomes on one of the two meshes, without an estimate of the error.
    fn on_mesh(&self, refine: usize, pressures_pa: &[f64], load: &EndLoad) -> (Vec<Outcome>, Budget) {
        let part = if self.options.symmetry == Symmetry::Ignore { Part::Ring } else { self.build.part(load) };
        let Mesh { radial, around } = self.options.mesh;
        let grid = Grid::new(&self.build, part, radial / 2, around / 2, refine);
        let mut chain = Chain::new(&self.build, grid);
        let rest = chain.rest();
        let rest_volume = chain.potential(&rest.form).1;
        let unknowns =
            rest.form.places.len() + 3 * rest.form.pressures.len() + chain.grid.free().iter().filter(|f| **f).count();
        let units = self.build.load_units();
        let load = load.components();
        let mut path = Path::new(&mut chain, std::array::from_fn(|i| load[i] / units[i]));
        let mut order: Vec<usize> = (0..pressures_pa.len()).collect();
        order.sort_by(|&a, &b| pressures_pa[a].total_cmp(&pressures_pa[b]));
        let mut outcomes = vec![Outcome::LoadNotCarried; pressures_pa.len()];
        for index in order {
            outcomes[index] = match path.to(pressures_pa[index] / self.build.modulus_pa) {
                Reached::Equilibrium(point) => Outcome::Equilibrium(self.equilibrium(&point, rest_volume, part)),
                Reached::End { pressure } => {
                    Outcome::NoEquilibrium { limit_pressure_pa: pressure * self.build.modulus_pa }
                }
                Reached::EndOfLoad => Outcome::LoadNotCarried,
                Reached::Stuck { pressure } => {
                    Outcome::NotConverged { reached_pressure_pa: pressure * self.build.modulus_pa }
                }
            };
        }
        let effort = Budget::of(path.work, unknowns);
        (outcomes, effort)
    }

    fn equilibrium(&self, point: &Point, rest_volume: f64, part: Part) -> Equilibrium {
        Equilibrium {
            state: answer::state(&self.build, point, rest_volume),
            error: None,
            stiffness: (part == Part::Ring).then(|| answer::stiffness(&self.build, point)),
        }
    }
}

fn with_error(fine: Outcome, coarse: &Outcome, factor: f64) -> Outcome {
    match (fine, coarse) {
        (Outcome::Equilibrium(fine), Outcome::Equilibrium(coarse)) => {
            let error = Some(ErrorEstimate::between(&fine.state, &coarse.state, factor));
            Outcome::Equilibrium(Equilibrium { error, ..fine })
        }
        (fine, _) => fine,
    }
}
