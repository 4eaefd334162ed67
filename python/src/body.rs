//! The actuators themselves, and the ways to solve them.

use std::sync::{Arc, OnceLock};

use fra_model::{Actuator, InvalidParameter, LANES, Motion, PressureRange, Solution, State, Status, Target};
use softlimb::query::Question;
use softlimb_limb::batch::ActuatorBatch;

use super::answers::{FEW, Table, in_order};
use super::arguments::Loads;
use super::columns::Columns;
use super::refused::Refusal;
use super::solve::{Answer, CODES, Choice, NUMBERS, Query};

/// Answers that a processor takes at a time where a register holds several.
const PART: usize = 512;
/// Fewest answers that are worth the layout for vectors.
const VECTORS_FROM: usize = 64;

/// Answers to forward and inverse queries.
pub(crate) type Answers = Table<CODES, NUMBERS>;

/// Actuators and their layout for vectors hold them together.
#[derive(Clone)]
pub(crate) struct Shared(Arc<Vec<Actuator<f64>>>);

impl AsRef<[Actuator<f64>]> for Shared {
    fn as_ref(&self) -> &[Actuator<f64>] {
        &self.0
    }
}

/// Actuators with the same number of windings.
pub(crate) enum Body {
    /// One winding or none.
    One { actuators: Shared, in_vectors: bool, laid_out: OnceLock<ActuatorBatch<Shared>> },
    /// Straight tubes with two windings.
    Two(Vec<Actuator<f64>>),
}

/// Actuators with what is known of their elastomers.
pub(crate) struct Built {
    pub(crate) body: Body,
    /// Largest stretch of the test behind the law of each elastomer, where the elastomers are named.
    pub(crate) stretch_max: Option<Vec<f64>>,
}

impl Body {
    /// # Errors
    /// The first row that the model refuses.
    pub(crate) fn new(columns: &Columns<'_>) -> Result<Self, Refusal> {
        let refused = |row| move |error: InvalidParameter<f64>| Refusal::new(row, error);
        if columns.has_second() {
            let tubes = in_order(columns.rows(), |row| {
                // A caller states two windings or one for all rows.
                let second = columns.second(row).expect("two windings");
                let tube = Actuator::new(&columns.parameters(row)).and_then(|tube| tube.with_second_fiber(&second));
                tube.map_err(refused(row))
            });
            return Ok(Self::Two(tubes?));
        }
        let actuators = in_order(columns.rows(), |row| Actuator::new(&columns.parameters(row)).map_err(refused(row)))?;
        let in_vectors = actuators.iter().all(|actuator| actuator.parameters().motion != Motion::Bending);
        Ok(Self::One { actuators: Shared(Arc::new(actuators)), in_vectors, laid_out: OnceLock::new() })
    }

    pub(crate) fn len(&self) -> usize {
        self.actuators().len()
    }

    /// The actuators.
    pub(crate) fn actuators(&self) -> &[Actuator<f64>] {
        match self {
            Self::One { actuators, .. } => actuators.as_ref(),
            Self::Two(tubes) => tubes,
        }
    }
}

impl Built {
    /// Equilibria at gauge pressures.
    ///
    /// # Errors
    /// A value that the model refuses.
    pub(crate) fn forward(&self, pressures: &[f64], choice: Choice, loads: &Loads) -> Result<Answers, Refusal> {
        let is_plain = loads.are_none() && choice != Choice::SectionFe && pressures.len() >= VECTORS_FROM;
        match &self.body {
            Body::One { actuators, in_vectors: true, laid_out } if is_plain => {
                self.forward_in_vectors(laid_out.get_or_init(|| laid_out_once(actuators)), pressures)
            }
            _ => {
                let query = |i: usize| Question::Forward { pressure_pa: pressures[i] };
                self.solve(pressures.len(), choice, loads, PressureRange::physical(), query)
            }
        }
    }

    /// Straight tubes without load, several to a register.
    fn forward_in_vectors(&self, batch: &ActuatorBatch<Shared>, pressures: &[f64]) -> Result<Answers, Refusal> {
        let group = batch.actuators().len();
        let part = PART.next_multiple_of(batch.lanes());
        Table::filled(pressures.len(), group, part, |piece| {
            let mut solutions = [blank(); PART + LANES];
            let (from, rows) = (piece.from, piece.rows());
            let solved = batch.forward_from(from % group, &pressures[from..from + rows], &mut solutions[..rows]);
            solved.map_err(|error| Refusal::new(from, error))?;
            let actuators = batch.actuators()[from % group..].iter();
            for (row, (solution, actuator)) in solutions[..rows].iter().zip(actuators).enumerate() {
                let answer = Answer::analytic(solution, Some(0.0));
                answer.write(piece, row, actuator.parameters(), self.stretch_max(from + row));
            }
            Ok(())
        })
    }

    fn stretch_max(&self, row: usize) -> Option<f64> {
        self.stretch_max.as_ref().map(|column| column[row % column.len()])
    }

    /// Any queries, one by one.
    ///
    /// # Errors
    /// A value that the model refuses.
    pub(crate) fn solve(
        &self,
        rows: usize,
        choice: Choice,
        loads: &Loads,
        range: PressureRange<f64>,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
    ) -> Result<Answers, Refusal> {
        // Finite elements take a processor as long as thousands of analytic answers.
        let part = if choice == Choice::SectionFe { 1 } else { FEW };
        let actuators = self.body.actuators();
        Table::filled(rows, rows, part, |piece| {
            for row in 0..piece.rows() {
                let i = piece.from + row;
                let query = Query { question: question(i), range, load: loads.at(i) };
                let actuator = &actuators[i % actuators.len()];
                let answer = query.of(actuator, choice).map_err(|error| Refusal::of_section(i, error))?;
                answer.write(piece, row, actuator.parameters(), self.stretch_max(i));
            }
            Ok(())
        })
    }
}

/// The layout for vectors. A part is filled: fewer actuators are repeated.
fn laid_out_once(actuators: &Shared) -> ActuatorBatch<Shared> {
    let count = actuators.0.len();
    let times = PART.div_ceil(count.max(1));
    let repeated = || Shared(Arc::new(actuators.0.repeat(times)));
    ActuatorBatch::new(if times > 1 { repeated() } else { actuators.clone() })
}

/// A solution to be overwritten.
fn blank() -> Solution<f64> {
    let state = State {
        pressure_pa: 0.0,
        axial_stretch: 0.0,
        axial_strain: 0.0,
        inner_radius_m: 0.0,
        outer_radius_m: 0.0,
        twist_rad: 0.0,
        bend_angle_rad: 0.0,
        volume_m3: 0.0,
        volume_strain: 0.0,
        compliance_m3_per_pa: 0.0,
    };
    Solution { status: Status::NotConverged, state, limit_pressure_pa: None, residual: 0.0, iterations: 0 }
}
