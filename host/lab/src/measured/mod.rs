//! Measured actuators and elastomers beside the models.

mod command;
mod page;

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Status};
use softlimb::cli::Failure;
use softlimb_fea::cross_section::{BEND_TOLERANCE, EndLoad, Options, Section, analytic_bend_error};
use softlimb_files::table::{Known, Table, TableError};

pub(crate) use command::Measured;
pub use command::picture;
pub use page::{PLACE, page};

/// The readings. Their source is in the file's comments.
const BENDERS: &str = include_str!("benders.csv");
/// Shear modulus that the laboratory states, Pa.
pub const STATED_PA: f64 = 0.52e6;
/// Radii at rest, m.
const RADII_M: [f64; 2] = [0.5 * 9.525e-3, 0.5 * 12.13e-3];
/// Sheet of a family: its stiffness was not stated, and any stiff thread gives the same bends to 2 %.
const SHEET: [f64; 2] = [361e6, 0.178e-3];

/// A column of the readings.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Angle,
    Length,
    Pressure,
    Bend,
}

const COLUMNS: [Known<Column>; 4] = [
    Known { name: "alpha_from_axis_deg", kind: Column::Angle, factor: 1.0, shift: 0.0, range: [0.0, 90.0] },
    Known { name: "length_m", kind: Column::Length, factor: 1.0, shift: 0.0, range: [0.01, 1.0] },
    Known { name: "pressure_pa", kind: Column::Pressure, factor: 1.0, shift: 0.0, range: [0.0, 1e6] },
    Known { name: "bend_angle_rad", kind: Column::Bend, factor: 1.0, shift: 0.0, range: [0.0, 20.0] },
];

/// Readings of actuators wound at one angle, with one length.
#[derive(Clone, Debug)]
pub struct Set {
    /// Angle of the threads from the hoop, deg.
    pub angle_deg: f64,
    /// Length, m.
    pub length_m: f64,
    /// By pressure, from the least on.
    pub rows: Vec<Row>,
    /// Shear modulus with which finite elements fit the readings best, Pa.
    pub fitted_pa: f64,
}

/// Readings at one pressure, and the bends of the models, rad.
#[derive(Clone, Debug)]
pub struct Row {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Readings.
    pub readings: Vec<f64>,
    /// The analytic model, with nothing fitted.
    pub analytic: f64,
    /// Finite elements of the cross-section, with nothing fitted.
    pub section: f64,
    /// The model that `eval` and `eval --batch` choose.
    pub default: f64,
    /// Finite elements with the fitted modulus.
    pub fitted: f64,
}

impl Row {
    /// Mean of the readings, rad.
    pub fn mean(&self) -> f64 {
        self.readings.iter().sum::<f64>() / self.readings.len() as f64
    }
}

impl Set {
    /// Root mean square of the relative errors of a model beside the means.
    pub fn rms(&self, model: impl Fn(&Row) -> f64) -> f64 {
        let squares = self.rows.iter().map(|row| (model(row) / row.mean() - 1.0).powi(2));
        (squares.sum::<f64>() / self.rows.len() as f64).sqrt()
    }
}

/// All sets, with the models' bends.
///
/// # Errors
/// [`Failure`] if the readings or an actuator are refused.
pub fn sets() -> Result<Vec<Set>, Failure> {
    grouped().map_err(Failure::new)?.into_iter().map(|set| with_models(set).map_err(Failure::new)).collect()
}

fn grouped() -> Result<Vec<Set>, TableError> {
    let table = Table::cut(BENDERS)?;
    table.only(&COLUMNS, &["set"])?;
    let mut sets: Vec<Set> = Vec::new();
    for row in table.rows() {
        let mut values = [0.0; 4];
        for (place, column) in table.columns(&COLUMNS) {
            let missing = || row.refused(place, column.name, "a number".into());
            values[column.kind as usize] = row.number(place, column)?.ok_or_else(missing)?;
        }
        let [from_axis_deg, length_m, pressure_pa, bend] = values;
        let angle_deg = 90.0 - from_axis_deg;
        let index = sets.iter().position(|set| (set.angle_deg, set.length_m) == (angle_deg, length_m));
        let index = index.unwrap_or_else(|| {
            sets.push(Set { angle_deg, length_m, rows: Vec::new(), fitted_pa: STATED_PA });
            sets.len() - 1
        });
        let rows = &mut sets[index].rows;
        // Readings from a plot have the pressure to a few pascals.
        match rows.iter_mut().find(|row| (row.pressure_pa - pressure_pa).abs() < 10.0) {
            Some(row) => row.readings.push(bend),
            None => rows.push(Row {
                pressure_pa,
                readings: vec![bend],
                analytic: f64::NAN,
                section: f64::NAN,
                default: f64::NAN,
                fitted: f64::NAN,
            }),
        }
    }
    for set in &mut sets {
        set.rows.sort_by(|a, b| a.pressure_pa.total_cmp(&b.pressure_pa));
    }
    sets.sort_by(|a, b| {
        (b.length_m, a.angle_deg).partial_cmp(&(a.length_m, b.angle_deg)).unwrap_or(std::cmp::Ordering::Equal)
    });
    Ok(sets)
}

fn with_models(mut set: Set) -> Result<Set, String> {
    let actuator = bender(&set, STATED_PA);
    let section = by_section(&set, STATED_PA)?;
    set.fitted_pa = fit(&set)?;
    let fitted = by_section(&set, set.fitted_pa)?;
    let analytic = Actuator::new(&actuator).map_err(|error| error.to_string())?;
    for (row, (section, fitted)) in set.rows.iter_mut().zip(section.into_iter().zip(fitted)) {
        let found = analytic.forward(row.pressure_pa, &Load::none()).map_err(|error| error.to_string())?;
        if found.status != Status::Solved {
            return Err(format!("no analytic bend at {} Pa", row.pressure_pa));
        }
        let is_within = analytic_bend_error(&actuator, &found.state).is_some_and(|error| error <= BEND_TOLERANCE);
        row.analytic = found.state.bend_angle_rad;
        row.default = if is_within { row.analytic } else { section };
        (row.section, row.fitted) = (section, fitted);
    }
    Ok(set)
}

fn bender(set: &Set, shear_modulus_pa: f64) -> ActuatorParameters<f64> {
    let [inner_radius_m, outer_radius_m] = RADII_M;
    let [modulus_pa, thickness_m] = SHEET;
    ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m,
        outer_radius_m,
        length_m: set.length_m,
        material: Material::NeoHookean { shear_modulus_pa },
        fiber: Some(Fiber {
            angle_rad: set.angle_deg.to_radians(),
            families: Families::Two,
            modulus_pa,
            placement: Placement::Sheet,
            thickness_m,
            radius_m: outer_radius_m,
        }),
    }
}

/// Bends at the pressures of a set, rad.
fn by_section(set: &Set, shear_modulus_pa: f64) -> Result<Vec<f64>, String> {
    let section =
        Section::new(&bender(set, shear_modulus_pa), &Options::default()).map_err(|error| error.to_string())?;
    let pressures: Vec<f64> = set.rows.iter().map(|row| row.pressure_pa).collect();
    let curve = section.curve(&pressures, &EndLoad::default()).map_err(|error| error.to_string())?;
    let bends = curve.answers.iter().map(|answer| {
        let equilibrium = answer.equilibrium().ok_or_else(|| format!("no bend at {} Pa", answer.pressure_pa))?;
        Ok(equilibrium.state.over(set.length_m).bend_angle_rad)
    });
    bends.collect()
}

/// The modulus with the least sum of squared relative errors, by golden section: a set has one or two minima a decade apart at most.
fn fit(set: &Set) -> Result<f64, String> {
    let cost = |log_pa: f64| -> Result<f64, String> {
        let bends = by_section(set, log_pa.exp())?;
        Ok(set.rows.iter().zip(bends).map(|(row, bend)| (bend / row.mean() - 1.0).powi(2)).sum())
    };
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut low, mut high] = [0.7, 2.5].map(|factor: f64| (factor * STATED_PA).ln());
    let inner = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let mut points = inner(low, high);
    let mut costs = [cost(points[0])?, cost(points[1])?];
    while high - low > 1e-4 {
        if costs[0] < costs[1] {
            high = points[1];
            points = [inner(low, high)[0], points[0]];
            costs = [cost(points[0])?, costs[0]];
        } else {
            low = points[0];
            points = [points[1], inner(low, high)[1]];
            costs = [costs[1], cost(points[1])?];
        }
    }
    Ok((0.5 * (low + high)).exp())
}
