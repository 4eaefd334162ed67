//! The actuators themselves, and the ways to solve them.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use fra_model::{Actuator, InvalidParameter, LANES, Motion, PressureRange, Solution, State, Status, Target};
use softlimb::query::Question;
use softlimb_limb::batch::ActuatorBatch;

use super::answers::{FEW, Table, in_order, processors};
use super::arguments::Loads;
use super::columns::Columns;
use super::refused::Refusal;
use super::solve::{Answer, CODES, Choice, NUMBERS, Query};

/// Most answers that a processor takes at a time where a register holds several.
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
    One { actuators: Shared, some_bend: bool, laid_out: OnceLock<ActuatorBatch<Shared>> },
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
        let some_bend = actuators.iter().any(|actuator| actuator.parameters().motion == Motion::Bending);
        Ok(Self::One { actuators: Shared(Arc::new(actuators)), some_bend, laid_out: OnceLock::new() })
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
        let rows = Rows { count: pressures.len(), choice, loads, range: PressureRange::physical() };
        let question = |i: usize| Question::Forward { pressure_pa: pressures[i] };
        self.solve(&rows, question, |batch, from, several, solutions| {
            batch.forward_from(from, &pressures[several], solutions)
        })
    }

    /// Gauge pressures in a range that reach targets.
    ///
    /// # Errors
    /// A value that the model refuses.
    pub(crate) fn inverse(
        &self,
        targets: &[Target<f64>],
        choice: Choice,
        loads: &Loads,
        range: PressureRange<f64>,
    ) -> Result<Answers, Refusal> {
        let rows = Rows { count: targets.len(), choice, loads, range };
        let question = |i: usize| Question::Inverse { target: targets[i] };
        self.solve(&rows, question, |batch, from, several, solutions| {
            batch.inverse_from(from, &targets[several], &range, solutions)
        })
    }

    /// Queries without load several to a register, others one by one.
    fn solve(
        &self,
        rows: &Rows<'_>,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
        solve: impl Fn(
            &ActuatorBatch<Shared>,
            usize,
            Range<usize>,
            &mut [Solution<f64>],
        ) -> Result<(), InvalidParameter<f64>>
        + Sync,
    ) -> Result<Answers, Refusal> {
        let is_plain = rows.loads.are_none() && rows.choice != Choice::SectionFe && rows.count >= VECTORS_FROM;
        match &self.body {
            Body::One { actuators, some_bend, laid_out } if is_plain => {
                let batch = laid_out.get_or_init(|| laid_out_once(actuators));
                self.solve_in_vectors(batch, *some_bend, rows, question, solve)
            }
            _ => self.solve_one_by_one(rows, question),
        }
    }

    fn solve_in_vectors(
        &self,
        batch: &ActuatorBatch<Shared>,
        some_bend: bool,
        rows: &Rows<'_>,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
        solve: impl Fn(
            &ActuatorBatch<Shared>,
            usize,
            Range<usize>,
            &mut [Solution<f64>],
        ) -> Result<(), InvalidParameter<f64>>
        + Sync,
    ) -> Result<Answers, Refusal> {
        let group = batch.actuators().len();
        // A processor that is done early finds another part.
        let part = (rows.count / (4 * processors())).clamp(FEW, PART).next_multiple_of(batch.lanes());
        Table::filled(rows.count, group, part, |piece| {
            let mut solutions = [blank(); PART + LANES];
            let (from, count) = (piece.from, piece.rows());
            let solved = solve(batch, from % group, from..from + count, &mut solutions[..count]);
            if let Err(error) = solved {
                // The batch tells what it refuses, but not where.
                let one = |i: usize| rows.query(i, question(i)).of(&batch.actuators()[i % group], rows.choice);
                let mut refused = (from..from + count).filter_map(|i| Some(Refusal::of_section(i, one(i).err()?)));
                return Err(refused.next().unwrap_or_else(|| Refusal::new(from, error)));
            }
            let actuators = batch.actuators()[from % group..].iter();
            for (row, (solution, actuator)) in solutions[..count].iter().zip(actuators).enumerate() {
                let i = from + row;
                // A look at every straight tube would take as long as its solution.
                let answer = if some_bend {
                    rows.query(i, question(i)).chosen(actuator, solution, rows.choice)
                } else {
                    Answer::analytic(solution, Some(0.0))
                };
                answer.write(piece, row, actuator.parameters(), self.stretch_max(i));
            }
            Ok(())
        })
    }

    fn stretch_max(&self, row: usize) -> Option<f64> {
        self.stretch_max.as_ref().map(|column| column[row % column.len()])
    }

    fn solve_one_by_one(
        &self,
        rows: &Rows<'_>,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
    ) -> Result<Answers, Refusal> {
        // Finite elements take a processor as long as thousands of analytic answers.
        let part = if rows.choice == Choice::SectionFe { 1 } else { FEW };
        let actuators = self.body.actuators();
        Table::filled(rows.count, rows.count, part, |piece| {
            for row in 0..piece.rows() {
                let i = piece.from + row;
                let actuator = &actuators[i % actuators.len()];
                let answer = rows.query(i, question(i)).of(actuator, rows.choice);
                let answer = answer.map_err(|error| Refusal::of_section(i, error))?;
                answer.write(piece, row, actuator.parameters(), self.stretch_max(i));
            }
            Ok(())
        })
    }
}

/// Queries but for their questions.
struct Rows<'a> {
    count: usize,
    choice: Choice,
    loads: &'a Loads,
    range: PressureRange<f64>,
}

impl Rows<'_> {
    fn query(&self, i: usize, question: Question<Target<f64>>) -> Query {
        Query { question, range: self.range, load: self.loads.at(i) }
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
