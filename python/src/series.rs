//! Segments in series: one tube whose parts are wound differently.

use fra_model::{Actuator, InvalidSeries, Series, SeriesSolution, SeriesTarget, Solution, State, Status};
use nalgebra::Isometry3;
use numpy::{IntoPyArray, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::actuators::Actuators;
use super::answers::{Arrays, in_order};
use super::arguments::{Loads, values};
use super::columns::Numbers;
use super::refused::Refusal;
use super::solve::code;

/// Sums of a series: pressure, length, extension, twist, bend, volume, tip (place, quaternion), limit pressure, residual.
const SUMS: usize = 15;
/// Numbers of a segment: stretch, radii, twist, bend.
const OF_SEGMENT: usize = 5;

/// Indices of actuators, one a row.
type Indices<'py> = PyReadonlyArray1<'py, i64>;

/// One answer.
struct Answer {
    status: i8,
    /// The segment that ends the branch, or -1.
    limit_segment: i8,
    iterations: u32,
    sums: [f64; SUMS],
    segments: Vec<[f64; OF_SEGMENT]>,
}

/// A segment: its actuators, the one of each row, and the direction that it bends towards in each row, rad.
struct Segment<'a> {
    actuators: &'a [Actuator<f64>],
    index: Vec<usize>,
    direction_rad: Vec<f64>,
}

/// What is given.
enum Given {
    Pressure,
    Target(fn(f64) -> SeriesTarget<f64>),
}

/// Equilibria of tubes whose segments are actuators, at gauge pressures or at targets of a quantity. A row takes one actuator of each segment.
#[pyfunction]
pub(crate) fn solve_series<'py>(
    py: Python<'py>,
    segments: Vec<(PyRef<'py, Actuators>, Indices<'py>, Numbers<'py>)>,
    quantity: &str,
    given: Numbers<'py>,
    loads: Option<(Numbers<'py>, Numbers<'py>)>,
) -> PyResult<Arrays<'py>> {
    let rows = given.len();
    let (numbers, loads) = (values(&given)?, Loads::new(loads, rows)?);
    let given = match quantity {
        "pressure_pa" => Given::Pressure,
        "extension_m" => Given::Target(SeriesTarget::Extension),
        "twist_rad" => Given::Target(SeriesTarget::Twist),
        "bend_angle_rad" => Given::Target(SeriesTarget::BendAngle),
        _ => return Err(PyValueError::new_err(format!("{quantity:?} is no quantity of a series"))),
    };
    let parts = segments.iter().map(|(actuators, index, direction)| {
        let actuators = actuators.list();
        let index: Vec<usize> =
            index.as_slice()?.iter().map(|index| usize::try_from(*index).unwrap_or(usize::MAX)).collect();
        let direction_rad = values(direction)?;
        let fits =
            index.len() == rows && direction_rad.len() == rows && index.iter().all(|index| *index < actuators.len());
        if !fits {
            return Err(PyValueError::new_err("an actuator and a direction a row and segment"));
        }
        Ok(Segment { actuators, index, direction_rad })
    });
    let parts = parts.collect::<PyResult<Vec<_>>>()?;
    let answers = py.detach(|| {
        loads.check()?;
        in_order(rows, |row| answer(&parts, row, &given, numbers[row], &loads))
    })?;
    Ok(arrays(py, &answers, parts.len()))
}

fn answer(parts: &[Segment<'_>], row: usize, given: &Given, value: f64, loads: &Loads) -> Result<Answer, Refusal> {
    let tubes: Vec<Actuator<f64>> = parts.iter().map(|part| part.actuators[part.index[row]]).collect();
    let series = Series::new(&tubes).map_err(|error| match error {
        InvalidSeries::Empty => Refusal::no_segment(),
        InvalidSeries::Segment { segment, error } => Refusal::of_segment(row, segment, error),
    })?;
    let (load, mut states) = (loads.at(row), Vec::with_capacity(tubes.len()));
    let each = |_: usize, solution: &Solution<f64>| states.push(solution.state);
    let solved = match given {
        Given::Pressure => series.forward_each(value, &load, each),
        Given::Target(target) => series.inverse_each(target(value), &load, each),
    };
    let solution = solved.map_err(|error| Refusal::new(row, error))?;
    let directions = parts.iter().map(|part| part.direction_rad[row]);
    let tip = series.tip_pose(&Isometry3::identity(), states.iter().copied().zip(directions));
    Ok(Answer::new(&solution, &states, parts.len(), &tip))
}

impl Answer {
    fn new(solution: &SeriesSolution<f64>, states: &[State<f64>], count: usize, tip: &Isometry3<f64>) -> Self {
        let is_solved = solution.status == Status::Solved;
        let limit_pa = solution.limit.and_then(|limit| limit.pressure_pa).unwrap_or(f64::NAN);
        let mut sums = [f64::NAN; SUMS];
        if is_solved {
            let (state, place, turn) = (&solution.state, tip.translation.vector, tip.rotation.quaternion());
            sums[..6].copy_from_slice(&[
                state.pressure_pa,
                state.length_m,
                state.extension_m,
                state.twist_rad,
                state.bend_angle_rad,
                state.volume_m3,
            ]);
            sums[6..13].copy_from_slice(&[place.x, place.y, place.z, turn.w, turn.i, turn.j, turn.k]);
        }
        (sums[13], sums[14]) = (limit_pa, solution.residual);
        let of = |state: &State<f64>| {
            [state.axial_stretch, state.inner_radius_m, state.outer_radius_m, state.twist_rad, state.bend_angle_rad]
        };
        let segments = if is_solved { states.iter().map(of).collect() } else { vec![[f64::NAN; OF_SEGMENT]; count] };
        let limit_segment = solution.limit.and_then(|limit| i8::try_from(limit.segment).ok()).unwrap_or(-1);
        Self { status: code(solution.status), limit_segment, iterations: solution.iterations, sums, segments }
    }
}

/// The answers as columns: those of the sums, then of each segment.
fn arrays<'py>(py: Python<'py>, answers: &[Answer], segments: usize) -> Arrays<'py> {
    let codes = |of: fn(&Answer) -> i8| answers.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
    let counts = answers.iter().map(|answer| i32::try_from(answer.iterations).unwrap_or(i32::MAX));
    let numbers = |of: &dyn Fn(&Answer) -> f64| answers.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
    let sums = (0..SUMS).map(|column| numbers(&|answer| answer.sums[column]));
    let parts = (0..segments).flat_map(|segment| (0..OF_SEGMENT).map(move |column| (segment, column)));
    let parts = parts.map(|(segment, column)| numbers(&|answer| answer.segments[segment][column]));
    (
        vec![codes(|answer| answer.status), codes(|answer| answer.limit_segment)],
        counts.collect::<Vec<_>>().into_pyarray(py),
        sums.chain(parts).collect(),
    )
}
