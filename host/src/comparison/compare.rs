//! One question to every model.

use fra_model::{Actuator, Load, Motion, Status};

use super::case::{Case, at_rest, of_error, value};
use softlimb_fea::cross_section::{BendPolynomial, Curve, EndLoad, SectionError};

/// Answer of a three-dimensional model to a case: the quantity at each of its pressures, `None` where it gave up before.
pub type Solid = Vec<Option<f64>>;

/// One actuator at one pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the case.
    pub case: String,
    /// Motion, whose deformation is compared.
    pub motion: Motion,
    /// Its value at rest.
    pub rest: f64,
    /// Gauge pressure, kPa.
    pub pressure_kpa: f64,
    /// By the equations of `docs/explanation/model.md`; `None` where there is no equilibrium, and of a bending actuator with two windings, which
    /// they leave out.
    pub analytic: Option<f64>,
    /// By the bending polynomial fitted to the section.
    pub calibrated: Option<f64>,
    /// By finite elements of the section.
    pub section: Option<f64>,
    /// Error of discretisation of that; `None` where the coarser of the two meshes has no equilibrium.
    pub section_error: Option<f64>,
    /// By CalculiX.
    pub solid: Option<f64>,
}

/// A set of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// In the order of the cases and their pressures.
    pub rows: Vec<Row>,
}

impl Row {
    /// Difference of a value from that of the section, as a share of the motion; `None` where one is missing or nothing moves.
    pub fn difference(&self, value: Option<f64>) -> Option<f64> {
        let section = self.section?;
        let motion = section - self.rest;
        (motion != 0.0).then(|| value.map(|value| (value - section) / motion)).flatten()
    }
}

impl Comparison {
    /// These rows among those recorded before: cases that are not here stay, and so does what a three-dimensional model has said of the
    /// same pressure where it has said nothing now. Cases keep the order of the record.
    #[must_use]
    pub fn onto(self, recorded: &Self) -> Self {
        let mut rows = Vec::new();
        for old in recorded.by_case() {
            let new = self.rows.iter().filter(|row| row.case == old[0].case);
            let joined = new.map(|row| {
                let before = old.iter().find(|old| old.pressure_kpa == row.pressure_kpa).and_then(|old| old.solid);
                Row { solid: row.solid.or(before), ..row.clone() }
            });
            let joined: Vec<_> = joined.collect();
            rows.extend(if joined.is_empty() { old.to_vec() } else { joined });
        }
        let known = |row: &Row| recorded.rows.iter().any(|old| old.case == row.case);
        rows.extend(self.rows.into_iter().filter(|row| !known(row)));
        Self { rows }
    }
}

/// The section's answers at the pressures of a case.
///
/// # Errors
/// [`SectionError`] of a case that is no actuator.
pub fn section_curve(case: &Case) -> Result<Curve, SectionError> {
    case.section()?.curve(&case.pressures_pa, &EndLoad::default())
}

/// Asks the analytic model about a case, and joins what the section and a three-dimensional model have said of it. Where the section gives no
/// bending polynomial, that stays empty.
///
/// # Errors
/// [`SectionError`] of a case that is no actuator.
pub fn compare(case: &Case, curve: &Curve, solid: &Solid) -> Result<Vec<Row>, SectionError> {
    let (parameters, length_m) = (&case.parameters, case.parameters.length_m);
    let motion = parameters.motion;
    let actuator = match &case.second_fiber {
        None => Some(Actuator::new(parameters)?),
        Some(_) if motion == Motion::Bending => None,
        Some(second) => Some(Actuator::new(parameters)?.with_second_fiber(second)?),
    };
    let polynomial = polynomial(case)?;
    let mut rows = Vec::new();
    for (index, answer) in curve.answers.iter().enumerate() {
        let analytic =
            actuator.as_ref().map(|actuator| actuator.forward(answer.pressure_pa, &Load::none())).transpose()?;
        let analytic = analytic.filter(|analytic| analytic.status == Status::Solved);
        let equilibrium = answer.equilibrium();
        rows.push(Row {
            case: case.name.clone(),
            motion,
            rest: at_rest(parameters),
            pressure_kpa: answer.pressure_pa * 1e-3,
            analytic: analytic.map(|analytic| value(motion, &analytic.state)),
            calibrated: polynomial.map(|curve| (curve.bend_rate_rad_per_m(answer.pressure_pa) * length_m).to_degrees()),
            section: equilibrium.map(|equilibrium| value(motion, &equilibrium.state.over(length_m))),
            section_error: equilibrium.and_then(|found| found.error).map(|error| of_error(motion, &error, length_m)),
            solid: solid.get(index).copied().flatten(),
        });
    }
    Ok(rows)
}

/// The bending polynomial over the pressures of a case; `None` for other motions and where there is none.
fn polynomial(case: &Case) -> Result<Option<BendPolynomial>, SectionError> {
    let (Motion::Bending, [lowest, .., highest]) = (case.parameters.motion, &case.pressures_pa[..]) else {
        return Ok(None);
    };
    match case.section()?.calibrate([*lowest, *highest]) {
        Ok(calibration) => Ok(Some(calibration.polynomial)),
        Err(SectionError::NoBend { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
