//! Judgement of an estimate by the Jacobian there: intervals, and whether the estimate is unique.

use nalgebra::{DMatrix, DVector};

use super::descent::svd;
use super::{CalibrationError, Property, Settings};
use softlimb_numerics::statistics::student_quantile;

/// Columns of the Jacobian whose condition exceeds this are the same column, whatever the accuracy of the data.
const MOST_CONDITION: f64 = 1e8;
/// Smallest difference of a leverage from 1: above it a point alone determines an unknown, and has no residual.
pub(super) const ALONE: f64 = 1e-6;
/// A confused direction has these shares of its largest component.
const NAMED: f64 = 0.1;

/// Assumed size of the errors of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// In proportion to the stated accuracies, with the factor that the residuals show.
    FromResiduals,
    /// Exactly as stated.
    AsStated,
}

/// One fitted value.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The property.
    pub property: Property,
    /// The bodies that share it.
    pub bodies: Vec<usize>,
    /// Name for tables: the property, and of which bodies.
    pub name: String,
    /// Start of the fit.
    pub start: f64,
    /// The value, in the SI unit of the property.
    pub value: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
    /// The ends of its confidence interval.
    pub interval: [f64; 2],
}

/// A value that is no property of an actuator in a scene, as tension and creep have them.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Its name, with the unit where it has one.
    pub name: &'static str,
    /// The value, in SI units.
    pub value: f64,
    /// Its standard deviation.
    pub standard_deviation: f64,
    /// The ends of its confidence interval.
    pub interval: [f64; 2],
}

impl Judgement {
    /// The unknowns with what is known of them.
    pub(super) fn values(&self, names: &[&'static str], columns: &[Column]) -> Vec<Value> {
        let one = |(k, column): (usize, &Column)| Value {
            name: names[k],
            value: column.value,
            standard_deviation: self.deviations[k],
            interval: [-1.0, 1.0].map(|sign| column.value + sign * self.half_widths[k]),
        };
        columns.iter().enumerate().map(one).collect()
    }
}

/// Form of a change of an unknown in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// As a share of its value.
    Percent,
    /// In degrees.
    Degrees,
    /// In kPa.
    Kilopascals,
}

/// An unknown as the judgement sees it.
pub(super) struct Column {
    pub(super) name: String,
    pub(super) shown: Shown,
    /// Value at the answer.
    pub(super) value: f64,
    /// Half width of the interval beyond which the value is not worth having.
    pub(super) tolerance: f64,
}

/// Standard deviations and intervals of all unknowns.
pub(super) struct Judgement {
    pub(super) deviations: Vec<f64>,
    pub(super) half_widths: Vec<f64>,
    /// Half widths of the intervals of the fitted values, one a point, in units of the stated accuracy.
    pub(super) curve: Vec<f64>,
    /// Share of each point in its own fitted value, 0 to 1: its leverage.
    pub(super) leverage: Vec<f64>,
    /// Root mean square of the residuals in units of the stated accuracy, with the degrees of freedom in the mean.
    pub(super) scatter: f64,
    pub(super) freedom: usize,
    pub(super) correlation: DMatrix<f64>,
    /// Condition number of the Jacobian with columns of equal length.
    pub(super) condition: f64,
}

/// Judges an answer. `jacobian` is that of the residuals in units of the stated accuracy by the unknowns in units of their tolerance.
///
/// # Errors
/// [`CalibrationError::TooFewPoints`], [`CalibrationError::NotReproduced`] and [`CalibrationError::NotIdentified`].
pub(super) fn judge(
    columns: &[Column],
    residuals: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    settings: &Settings,
    advise: impl Fn(&[usize]) -> String,
) -> Result<Judgement, CalibrationError> {
    let Settings { noise, confidence } = *settings;
    let (points, unknowns) = jacobian.shape();
    enough(points, unknowns, noise)?;
    let freedom = points - unknowns;
    let scatter = if freedom == 0 { 0.0 } else { (residuals.norm_squared() / freedom as f64).sqrt() };
    let condition = condition(jacobian);
    let Some((shares, directions, singular)) =
        svd(jacobian.clone()).and_then(|svd| Some((svd.u?, svd.v_t?, svd.singular_values)))
    else {
        return Err(CalibrationError::NotSettled { steps: 0 });
    };
    let leverage: Vec<f64> = shares.row_iter().map(|row| row.norm_squared()).collect();
    let least = singular.imin();
    let variance = |k: usize| (0..unknowns).map(|i| (directions[(i, k)] / singular[i]).powi(2)).sum::<f64>();
    let (factor, spread) = match noise {
        Noise::FromResiduals => (student_quantile(confidence, freedom), scatter),
        Noise::AsStated => (student_quantile(confidence, usize::MAX), 1.0),
    };
    // Data that happen to agree better than their accuracy are not more accurate for that.
    let widest = (0..unknowns).map(|k| factor * variance(k).sqrt()).fold(0.0, f64::max);
    let told = |spread: f64| spread.max(1.0) * widest <= 1.0 && condition <= MOST_CONDITION;
    if !told(spread) {
        // With smaller residuals the points would determine the unknowns.
        if told(1.0) {
            let names = columns.iter().map(|column| column.name.clone()).collect();
            // Distance from the fit to the other points: a point pulls the fit towards itself.
            let off = |k: usize| (residuals[k] / (1.0 - leverage[k]).max(ALONE)).abs();
            let point = (0..points).max_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0);
            return Err(CalibrationError::NotReproduced { names, off: residuals[point].abs(), point });
        }
        return Err(confused(columns, jacobian, directions.row(least).transpose(), advise));
    }
    let deviations: Vec<f64> =
        columns.iter().enumerate().map(|(k, column)| column.tolerance * spread * variance(k).sqrt()).collect();
    let covariance = |a: usize, b: usize| {
        (0..unknowns).map(|i| directions[(i, a)] * directions[(i, b)] / singular[i].powi(2)).sum::<f64>()
    };
    let correlation =
        DMatrix::from_fn(unknowns, unknowns, |a, b| covariance(a, b) / (variance(a) * variance(b)).sqrt());
    let half_widths = deviations.iter().map(|deviation| factor * deviation).collect();
    let curve = leverage.iter().map(|share| factor * spread * share.sqrt()).collect();
    Ok(Judgement { deviations, half_widths, curve, leverage, scatter, freedom, correlation, condition })
}

/// Refuses fewer points than it takes.
pub(super) fn enough(points: usize, unknowns: usize, noise: Noise) -> Result<(), CalibrationError> {
    let needed = unknowns + usize::from(noise == Noise::FromResiduals);
    if points < needed { Err(CalibrationError::TooFewPoints { unknowns, points, needed }) } else { Ok(()) }
}

/// Condition number with columns of equal length; infinite where one of them is zero.
fn condition(jacobian: &DMatrix<f64>) -> f64 {
    let mut equal = jacobian.clone();
    for mut column in equal.column_iter_mut() {
        let length = column.norm();
        column /= length;
    }
    if equal.iter().any(|value| !value.is_finite()) {
        return f64::INFINITY;
    }
    svd(equal).map_or(f64::INFINITY, |svd| svd.singular_values.max() / svd.singular_values.min())
}

/// The unknowns that are confused along a direction.
fn confused(
    columns: &[Column],
    jacobian: &DMatrix<f64>,
    direction: DVector<f64>,
    advise: impl Fn(&[usize]) -> String,
) -> CalibrationError {
    let largest = direction.amax();
    let direction = direction / largest;
    let mut named: Vec<usize> = (0..columns.len()).filter(|k| direction[*k].abs() >= NAMED).collect();
    named.sort_by(|a, b| direction[*b].abs().total_cmp(&direction[*a].abs()));
    // The first of them grows.
    let sign = named.first().map_or(1.0, |first| direction[*first].signum());
    let changes = named.iter().map(|k| change(&columns[*k], sign * direction[*k])).collect();
    CalibrationError::NotIdentified {
        names: named.iter().map(|k| columns[*k].name.clone()).collect(),
        changes,
        moved: (jacobian * direction).amax(),
        advice: advise(&named),
    }
}

/// A change by a share of the tolerance, in words.
fn change(column: &Column, share: f64) -> String {
    let by = share * column.tolerance;
    let name = &column.name;
    let relative = 100.0 * by / column.value.abs();
    match column.shown {
        Shown::Degrees => format!("{name} by {:+.2} deg", by.to_degrees()),
        Shown::Kilopascals => format!("{name} by {:+.3} kPa", by * 1e-3),
        Shown::Percent => format!("{name} by {relative:+.1} %"),
    }
}
