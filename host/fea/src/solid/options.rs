//! Settings of a deck: actuators, fibers, mesh.

use fra_model::{ActuatorParameters, Arrangement, Fiber, InvalidParameter, Motion, Placement};

use super::FemError;
use softlimb_files::range::{OutOfRange, positive, require};

/// Subject of a model: one actuator, or a bundle of equal ones between two connectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// The actuator.
    pub parameters: ActuatorParameters<f64>,
    /// A winding beside that of the parameters, in the same place of the wall.
    pub second_fiber: Option<Fiber<f64>>,
    /// Number of actuators side by side, 1 to 9.
    pub actuators: u8,
    /// Their places, far enough apart for them to lie side by side; they bend towards `x`.
    pub arrangement: Arrangement<f64>,
}

impl Subject {
    /// One actuator.
    pub fn single(parameters: ActuatorParameters<f64>) -> Self {
        Self { parameters, second_fiber: None, actuators: 1, arrangement: Arrangement::Circle { radius_m: 0.0 } }
    }

    /// The same with a second winding.
    #[must_use]
    pub fn with_second_fiber(self, second_fiber: Option<Fiber<f64>>) -> Self {
        Self { second_fiber, ..self }
    }

    /// Checks the parameters, the second winding and the place of the actuators.
    ///
    /// # Errors
    /// [`FemError::Parameters`] or [`FemError::Invalid`] with field, value and range.
    pub fn check(&self) -> Result<(), FemError> {
        self.parameters.check()?;
        let sheet = |fiber: &Fiber<f64>| fiber.placement == Placement::Sheet && fiber.modulus_pa > 0.0;
        if let Some(fiber) = self.parameters.fiber.filter(sheet) {
            let thickness = fiber.thickness_m;
            require(thickness.is_finite() && thickness > 0.0, "thickness_m", thickness, "finite and > 0")?;
        }
        self.check_second()?;
        let slenderness = self.parameters.length_m / self.parameters.outer_radius_m;
        require((2.0..=200.0).contains(&slenderness), "length_m / outer_radius_m", slenderness, "2 to 200")?;
        let wall = self.parameters.outer_radius_m / self.parameters.inner_radius_m - 1.0;
        require((0.02..=5.0).contains(&wall), "wall / inner_radius_m", wall, "0.02 to 5")?;
        let count = f64::from(self.actuators);
        require((1..=9).contains(&self.actuators), "actuators", count, "1 to 9")?;
        // How far neighbouring axes are apart, per length that is given.
        let (field, given, per_length) = match self.arrangement {
            Arrangement::Circle { radius_m } => {
                ("circle_radius_m", radius_m, 2.0 * (std::f64::consts::PI / count).sin())
            }
            Arrangement::Row { spacing_m } => ("spacing_m", spacing_m, 1.0),
        };
        require(given.is_finite() && given >= 0.0, field, given, "finite and >= 0")?;
        let least = 2.0 * self.parameters.outer_radius_m / per_length;
        let apart = self.actuators == 1 || given >= least * (1.0 - 1e-9);
        require(apart, field, given, format!("at least {least:.6} m for {count} actuators side by side"))?;
        Ok(())
    }

    /// Both windings share the elements that carry fibers.
    fn check_second(&self) -> Result<(), FemError> {
        let Some(second) = &self.second_fiber else { return Ok(()) };
        let p = &self.parameters;
        // A bending actuator is not checked for what its analytic model leaves out.
        let alone = ActuatorParameters { motion: Motion::Extension, fiber: Some(*second), ..*p };
        alone.check().map_err(FemError::SecondWinding)?;
        let refused = |field, value, allowed| FemError::SecondWinding(InvalidParameter { field, value, allowed });
        let Some(first) = p.fiber.filter(|fiber| fiber.modulus_pa > 0.0 && second.modulus_pa > 0.0) else {
            return Err(refused("modulus_pa", second.modulus_pa, "> 0, of both windings"));
        };
        if first.placement != second.placement {
            return Err(refused(
                "radius_m",
                second.radius_m,
                "placed as the first winding: a sheet, a layer or smeared",
            ));
        }
        if first.placement != Placement::Smeared && first.radius_m != second.radius_m {
            return Err(refused("radius_m", second.radius_m, "the radius of the first winding"));
        }
        Ok(())
    }
}

/// Model of the winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FiberModel {
    /// As a material with fiber directions. A sheet becomes a layer of `layer_m` thickness centred on its radius.
    Smeared {
        /// Thickness of that layer, m; > 0 and at most half the wall. Default: a fiftieth of the wall, at most 0.05 mm.
        layer_m: Option<f64>,
    },
    /// As threads: trusses on the winding radius that follow the wall at every mesh line. Wants a sheet.
    Threads {
        /// Distance between neighbouring threads of one family, across them, m; > 0. Default: three quarters of the wall. The nearest
        /// spacing that a whole number of threads permits is taken.
        spacing_m: Option<f64>,
    },
}

/// Whether symmetry is used to shrink the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymmetryUse {
    /// As far as the actuator allows: a sector of a straight one, half the section of a bending one, half the length where the
    /// winding is its own mirror image.
    Auto,
    /// The whole actuator, for eyes and for other loads.
    Whole,
}

/// Settings of a deck. The default is that of the comparisons of `docs/explanation/solid-elements.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Smeared or threads.
    pub fibers: FiberModel,
    /// Whether symmetry is used.
    pub symmetry: SymmetryUse,
    /// Elements through the wall without the fiber layer, 1 to 12; default 2.
    pub radial: Option<u32>,
    /// Elements around the whole circle, 8 to 96; default 24, more where threads need them.
    pub around: Option<u32>,
    /// Elements along the whole length, 4 to 800, even; default by the radius, or by the threads.
    pub along: Option<u32>,
    /// Bulk modulus over shear modulus, 100 to 10000; 1000 to 5000 is close to incompressible and still converges.
    pub bulk_ratio: f64,
    /// Largest share of the whole load in one increment, 0.001 to 0.5; default by the motion.
    pub increment: Option<f64>,
    /// Refuse meshes of more nodes than this; 100 to 400000.
    pub nodes_max: u32,
    /// Print the displacements of all nodes, for pictures, and not only of the gauges.
    pub all_nodes: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            fibers: FiberModel::Smeared { layer_m: None },
            symmetry: SymmetryUse::Auto,
            radial: None,
            around: None,
            along: None,
            bulk_ratio: 2000.0,
            increment: None,
            nodes_max: 40_000,
            all_nodes: false,
        }
    }
}

impl Options {
    /// Checks every field that stands by itself.
    ///
    /// # Errors
    /// [`FemError::Invalid`] with field, value and range.
    pub fn check(&self) -> Result<(), FemError> {
        count("radial", self.radial, 1, 12)?;
        count("around", self.around, 8, 96)?;
        count("along", self.along, 4, 800)?;
        let even = |field, value: Option<u32>| {
            let n = value.unwrap_or(0);
            require(n.is_multiple_of(2), field, f64::from(n), "an even number")
        };
        even("around", self.around)?;
        even("along", self.along)?;
        count("nodes_max", Some(self.nodes_max), 100, 400_000)?;
        range("bulk_ratio", self.bulk_ratio, 100.0, 10_000.0)?;
        range("increment", self.increment.unwrap_or(0.1), 0.001, 0.5)?;
        let (field, length) = match self.fibers {
            FiberModel::Smeared { layer_m } => ("layer_mm", layer_m),
            FiberModel::Threads { spacing_m } => ("spacing_mm", spacing_m),
        };
        Ok(length.map_or(Ok(()), |m| positive(field, 1e3 * m))?)
    }
}

fn count(field: &'static str, value: Option<u32>, least: u32, most: u32) -> Result<(), OutOfRange> {
    range(field, f64::from(value.unwrap_or(least)), f64::from(least), f64::from(most))
}

/// `Err` unless `least <= value <= most`.
pub(super) fn range(field: &'static str, value: f64, least: f64, most: f64) -> Result<(), OutOfRange> {
    require((least..=most).contains(&value), field, value, format!("{least} to {most}"))
}

/// Checks the pressures of a deck or run, gauge Pa: at least one, each above the one before, the first above zero.
///
/// # Errors
/// [`FemError::Invalid`] with the first pressure that is not.
pub(super) fn pressures(pressures_pa: &[f64]) -> Result<(), FemError> {
    require((1..=200).contains(&pressures_pa.len()), "pressures", pressures_pa.len() as f64, "1 to 200 of them")?;
    let mut before = 0.0;
    for &pressure in pressures_pa {
        let rises = pressure.is_finite() && pressure > before && pressure <= 1e8;
        require(rises, "pressure_pa", pressure, format!("above {before} and at most 1e8: pressures rise from zero"))?;
        before = pressure;
    }
    Ok(())
}
