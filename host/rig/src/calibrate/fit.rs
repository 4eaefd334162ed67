//! Parameters of actuators from pressure and deformation.

use fra_model::StateQuantity;
use nalgebra::DVector;

use super::descent::descend;
use super::error::advice;
use super::estimate::{Column, Estimate, Noise, enough, judge};
use super::free::{Free, check, check_branches};
use super::problem::{Model, Problem};
use super::{Body, BodyModel, CalibrationError, Property};

/// A fit that changes an unknown by more than this factor follows a slope that no value ends.
const RUN_AWAY: f64 = 1e3;

/// Branch of a loop of pressure and deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Branch {
    /// The pressure has risen to the reading.
    #[default]
    Loading,
    /// The pressure has fallen to the reading.
    Unloading,
}

impl Branch {
    /// 1 on loading, -1 on unloading.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Loading => 1.0,
            Self::Unloading => -1.0,
        }
    }
}

/// A pressure and the deformation it went with, at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Which of the bodies.
    pub body: usize,
    /// Reading of the pressure sensor, Pa gauge.
    pub reading_pa: f64,
    /// The way to it.
    pub branch: Branch,
    /// Measured quantity; any but the pressure.
    pub quantity: StateQuantity,
    /// Its value, in the SI unit of the quantity.
    pub value: f64,
    /// Standard deviation of the measurement, in the same unit; > 0.
    pub accuracy: f64,
}

/// A property to be found, one value for all the bodies named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// The property.
    pub property: Property,
    /// The bodies, at least one.
    pub bodies: Vec<usize>,
}

impl Unknown {
    /// One value for a body alone.
    pub fn of(property: Property, body: usize) -> Self {
        Self { property, bodies: vec![body] }
    }

    /// Gives it a value in its bodies.
    pub(super) fn place(&self, bodies: &mut [Body], value: f64) {
        self.bodies.iter().for_each(|body| self.property.place(&mut bodies[*body], value));
    }

    /// How well it must be known ([`Property::tolerance`]).
    fn tolerance(&self, bodies: &[Body], most_pa: f64) -> f64 {
        self.property.tolerance(&bodies[self.bodies[0]], most_pa.max(1.0))
    }

    /// The same as a unit: a fiber without stiffness or a tube without wall has no scale of its own.
    pub(super) fn scale(&self, bodies: &[Body], most_pa: f64) -> f64 {
        let tolerance = self.tolerance(bodies, most_pa);
        if tolerance > 0.0 { tolerance } else { 1.0 }
    }
}

/// Settings of the intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Assumed size of the errors of the data.
    pub noise: Noise,
    /// Share of confidence intervals that hold the true value, between 0.5 and 0.9999.
    pub confidence: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { noise: Noise::FromResiduals, confidence: 0.95 }
    }
}

impl Settings {
    /// Refuses a confidence that is none.
    pub(super) fn check(&self) -> Result<(), CalibrationError> {
        let (field, value, allowed) = ("confidence", self.confidence, "0.5 to 0.9999");
        let accepted = (0.5..=0.9999).contains(&value);
        accepted.then_some(()).ok_or(CalibrationError::Invalid { field, value, place: "the settings".into(), allowed })
    }
}

/// Result of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The unknowns, in the order they were asked for.
    pub estimates: Vec<Estimate>,
    /// The bodies with what was found.
    pub bodies: Vec<Body>,
    /// The deformation of each observation with the parameters at the start; `None` beyond a limit point.
    pub before: Vec<Option<f64>>,
    /// The same with what was found.
    pub after: Vec<f64>,
    /// Half width of the confidence interval of that.
    pub half_widths: Vec<f64>,
    /// Leverage of each observation, 0 to 1.
    pub leverage: Vec<f64>,
    /// Root mean square of the residuals in units of the stated accuracies; 1 where these are right.
    pub scatter: f64,
    /// Observations less unknowns.
    pub freedom: usize,
    /// Correlation of the estimates, row by row.
    pub correlation: Vec<Vec<f64>>,
    /// Condition number of the Jacobian, its columns made equally long.
    pub condition: f64,
    /// Evaluations of the residuals and their Jacobian.
    pub steps: usize,
    /// The model of each body.
    pub models: Vec<BodyModel>,
}

/// Finds the unknowns by least squares of the deformations, each divided by its accuracy.
///
/// Finite elements of the cross-section answer for a bending actuator where the analytic bend does not serve ([`BodyModel`]). Its derivatives are then differences.
///
/// `bodies` are where it starts. Intervals are those of the linearised model: `t sqrt((J'J)^-1)`, times the scatter of the residuals unless
/// the accuracies are to be taken as stated.
///
/// ```
/// use fra_model::*;
/// use softlimb_rig::calibrate::{Body, Branch, Observation, Property, Settings, Unknown, fit};
/// let finger = ActuatorParameters {
///     motion: Motion::Bending,
///     inner_radius_m: 6e-3,
///     outer_radius_m: 8e-3,
///     length_m: 0.1,
///     material: Material::NeoHookean { shear_modulus_pa: 0.25e6 },
///     fiber: None,
/// };
/// // The angles of docs/explanation/model.md for a modulus of 0.2 MPa.
/// let seen = [(10e3, 12.9_f64), (30e3, 43.0), (60e3, 101.8)].map(|(reading_pa, degrees)| Observation {
///     body: 0,
///     reading_pa,
///     branch: Branch::Loading,
///     quantity: StateQuantity::BendAngle,
///     value: degrees.to_radians(),
///     accuracy: 0.005,
/// });
/// let unknown = [Unknown::of(Property::ShearModulus, 0)];
/// let found = fit(&[Body::new("finger", finger)], &seen, &unknown, &Settings::default())?;
/// assert!((found.estimates[0].value - 0.2e6).abs() < 1e3);
/// # Ok::<(), softlimb_rig::calibrate::CalibrationError>(())
/// ```
///
/// # Errors
/// [`CalibrationError`], as its variants say; above all where the data cannot tell what is asked.
pub fn fit(
    bodies: &[Body],
    observations: &[Observation],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Fit, CalibrationError> {
    check(bodies, observations)?;
    check_branches(bodies, observations, unknowns)?;
    let most_pa = observations.iter().map(|seen| seen.reading_pa.abs()).fold(0.0, f64::max);
    let readings_pa = |index: usize| {
        let own = observations.iter().filter(|seen| seen.body == index);
        own.map(|seen| (seen.reading_pa, seen.branch)).collect()
    };
    fit_settled(
        bodies,
        |bodies| BodyModel::of_all(bodies, unknowns, readings_pa),
        |models| {
            let free = Free { observations, models, most_pa };
            fit_model(&free, bodies, unknowns, (settings, most_pa)).map_err(|error| free.explained(bodies, error))
        },
    )
}

/// Fits until the models of the bodies at the answer are those of the fit. The analytic bend may serve at the start and not at the answer; what finite elements
/// have answered stays.
pub(super) fn fit_settled(
    bodies: &[Body],
    models_of: impl Fn(&[Body]) -> Vec<BodyModel>,
    fit: impl Fn(&[BodyModel]) -> Result<Fit, CalibrationError>,
) -> Result<Fit, CalibrationError> {
    let mut models = models_of(bodies);
    loop {
        let found = fit(&models)?;
        let at_answer = models_of(&found.bodies);
        let pairs = || models.iter().zip(&at_answer);
        let is_settled = pairs().all(|(model, there)| model.is_by_section() || !there.is_by_section());
        let kept = |(model, there): (&BodyModel, &BodyModel)| {
            if model.is_by_section() && !there.is_by_section() { *model } else { *there }
        };
        let kept: Vec<BodyModel> = pairs().map(kept).collect();
        if is_settled {
            return Ok(Fit { models: kept, ..found });
        }
        models = kept;
    }
}

/// Fits a model whose largest pressure is `most_pa`; the caller adds the models of the bodies.
pub(super) fn fit_model(
    model: &impl Model,
    bodies: &[Body],
    unknowns: &[Unknown],
    (settings, most_pa): (&Settings, f64),
) -> Result<Fit, CalibrationError> {
    settings.check()?;
    let measured = model.measured();
    let starts = unknowns.iter().map(|unknown| start(bodies, unknown)).collect::<Result<Vec<f64>, _>>()?;
    enough(measured.len(), unknowns.len().max(1), settings.noise)?;
    let tolerances: Vec<f64> = unknowns.iter().map(|unknown| unknown.scale(bodies, most_pa)).collect();
    let problem = Problem { model, measured: &measured, bodies, unknowns, tolerances: &tolerances };
    let scaled = DVector::from_iterator(starts.len(), starts.iter().zip(&tolerances).map(|(value, unit)| value / unit));
    let end = descend(problem.solvable(scaled)?, |place| problem.local(place)).map_err(|refused| refused.error)?;
    let fitted = problem.placed(&end.place);
    let columns: Vec<Column> = unknowns
        .iter()
        .enumerate()
        .map(|(k, unknown)| {
            let value = end.place[k] * tolerances[k];
            // Tolerances are those of the answer, not of a start that may be far from it.
            let tolerance = unknown.tolerance(&fitted, most_pa);
            Column { name: name(bodies, unknown), shown: unknown.property.shown(), value, tolerance }
        })
        .collect();
    let mut jacobian = end.local.jacobian.clone();
    for (k, mut column) in jacobian.column_iter_mut().enumerate() {
        column *= columns[k].tolerance / tolerances[k];
    }
    let advise = |named: &[usize]| advice(&named.iter().map(|k| unknowns[*k].property).collect::<Vec<_>>());
    let residuals = &end.local.residuals;
    let judged = judge(&columns, residuals, &jacobian, settings, advise);
    let judged = judged.map_err(|error| run_away(&columns, &starts, residuals).unwrap_or(error))?;
    if !end.settled {
        return Err(CalibrationError::NotSettled { steps: end.steps });
    }
    let estimates = columns
        .into_iter()
        .zip(unknowns)
        .enumerate()
        .map(|(k, (column, unknown))| Estimate {
            property: unknown.property,
            bodies: unknown.bodies.clone(),
            name: column.name,
            start: starts[k],
            value: column.value,
            standard_deviation: judged.deviations[k],
            interval: [-1.0, 1.0].map(|sign| column.value + sign * judged.half_widths[k]),
        })
        .collect();
    let after = measured.iter().zip(&end.local.residuals).map(|(seen, r)| seen.value + r * seen.accuracy).collect();
    let half_widths = measured.iter().zip(&judged.curve).map(|(seen, width)| width * seen.accuracy).collect();
    Ok(Fit {
        estimates,
        before: model.values(bodies),
        bodies: fitted,
        after,
        half_widths,
        leverage: judged.leverage,
        scatter: judged.scatter,
        freedom: judged.freedom,
        correlation: judged.correlation.row_iter().map(|row| row.iter().copied().collect()).collect(),
        condition: judged.condition,
        steps: end.steps,
        models: Vec::new(),
    })
}

/// Error for unknowns that end far from their starts; `None` if there are none.
fn run_away(columns: &[Column], starts: &[f64], residuals: &DVector<f64>) -> Option<CalibrationError> {
    let is_away = |(column, start): &(&Column, &f64)| {
        let ratio = column.value / **start;
        ratio.is_finite() && !(1.0 / RUN_AWAY..=RUN_AWAY).contains(&ratio.abs())
    };
    let names: Vec<_> = columns.iter().zip(starts).filter(is_away).map(|(column, _)| column.name.clone()).collect();
    let (off, point) = (residuals.amax(), residuals.iamax());
    (!names.is_empty() && off > 1.0).then_some(CalibrationError::NotReproduced { names, off, point })
}

/// Name of an unknown in tables.
fn name(bodies: &[Body], unknown: &Unknown) -> String {
    let names: Vec<&str> = unknown.bodies.iter().map(|body| bodies[*body].name.as_str()).collect();
    format!("{} of {}", unknown.property, names.join(", "))
}

/// The value an unknown starts with.
fn start(bodies: &[Body], unknown: &Unknown) -> Result<f64, CalibrationError> {
    let property = unknown.property;
    let value = |index: usize| {
        let body = &bodies[index];
        property.value(body).ok_or_else(|| CalibrationError::NoSuchProperty {
            body: body.name.clone(),
            property,
            because: match property {
                Property::FiberModulus => "it has no winding, or bends with an ideal one",
                Property::SecondFiberModulus | Property::SecondFiberAngle => "it has no second winding",
                Property::FiberAngle => "it has no winding, or bends with an ideal one",
                _ => "its material is neo-Hookean",
            },
        })
    };
    let known = |index: &usize| *index < bodies.len();
    let Some(first) = unknown.bodies.first().filter(|_| unknown.bodies.iter().all(known)) else {
        return Err(CalibrationError::Invalid {
            field: "bodies",
            value: unknown.bodies.len() as f64,
            place: format!("the unknown {property}"),
            allowed: "at least one, each of those given",
        });
    };
    let start = value(*first)?;
    for other in &unknown.bodies[1..] {
        let other_value = value(*other)?;
        if (other_value - start).abs() > 1e-9 * start.abs() {
            return Err(CalibrationError::Different {
                property,
                first: bodies[*first].name.clone(),
                first_value: start,
                other: bodies[*other].name.clone(),
                other_value,
                unit: property.si_unit(),
            });
        }
    }
    Ok(start)
}
