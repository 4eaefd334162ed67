//! The actuators themselves, and the ways to solve them.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use fra_model::{
    Actuator, ActuatorParameters, InvalidParameter, LANES, Motion, PressureRange, Solution, State, Status, Target,
};
use softlimb::query::Question;
use softlimb_fea::cross_section::is_wound_bender;
use softlimb_limb::batch::ActuatorBatch;

use super::answers::{FEW, Table, in_order};
use super::arguments::Loads;
use super::columns::Columns;
use super::refused::Refusal;
use super::solve::{Answer, CODES, Choice, NUMBERS, Query};

/// Answers that a processor takes at a time where a register holds several.
const PART: usize = 512;
/// Fewest answers for which SIMD pays.
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
    One { actuators: Shared, kinds: Kinds, in_order: OnceLock<ActuatorBatch<Shared>> },
    /// Straight tubes with two windings.
    Two(Vec<Actuator<f64>>),
}

/// Motions among actuators.
#[derive(Clone, Copy)]
pub(crate) struct Kinds {
    some_bend: bool,
    /// Of these, finite elements may answer in place of the analytic model.
    some_are_wound_benders: bool,
}

impl Kinds {
    fn of(actuators: &[Actuator<f64>]) -> Self {
        let some = |what: fn(&ActuatorParameters<f64>) -> bool| actuators.iter().any(|one| what(one.parameters()));
        Self {
            some_bend: some(|parameters| parameters.motion == Motion::Bending),
            some_are_wound_benders: some(is_wound_bender),
        }
    }
}

/// Solves the actuators of a batch from an index on for a range of rows.
type SolveRows<'a> = &'a (
        dyn Fn(&ActuatorBatch<Shared>, usize, Range<usize>, &mut [Solution<f64>]) -> Result<(), InvalidParameter<f64>>
            + Sync
    );

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
        let kinds = Kinds::of(&actuators);
        Ok(Self::One { actuators: Shared(Arc::new(actuators)), kinds, in_order: OnceLock::new() })
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
        self.solve(&rows, |_| true, question, &|batch, from, several, solutions| {
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
        self.solve(&rows, |kinds| kinds.some_bend, question, &|batch, from, several, solutions| {
            batch.inverse_from(from, &targets[several], &range, solutions)
        })
    }

    /// Answers queries without load by SIMD where that is worth it, others one by one.
    fn solve(
        &self,
        rows: &Rows<'_>,
        is_worth_it: fn(Kinds) -> bool,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
        solve: SolveRows<'_>,
    ) -> Result<Answers, Refusal> {
        let is_plain = rows.loads.are_none() && rows.choice != Choice::SectionFe && rows.count >= VECTORS_FROM;
        match &self.body {
            Body::One { actuators, kinds, in_order } if is_plain && is_worth_it(*kinds) => {
                self.solve_in_vectors(in_order.get_or_init(|| repeated(actuators)), *kinds, rows, question, solve)
            }
            _ => self.solve_one_by_one(rows, question),
        }
    }

    fn solve_in_vectors(
        &self,
        batch: &ActuatorBatch<Shared>,
        kinds: Kinds,
        rows: &Rows<'_>,
        question: impl Fn(usize) -> Question<Target<f64>> + Sync,
        solve: SolveRows<'_>,
    ) -> Result<Answers, Refusal> {
        let group = batch.actuators().len();
        // Independent of the number of processors: neighbors in a register affect the last digit.
        let has_finite_elements = kinds.some_are_wound_benders && matches!(rows.choice, Choice::Auto(_));
        let part = if has_finite_elements { FEW } else { PART }.next_multiple_of(batch.lanes());
        Table::filled(rows.count, group, part, |piece| {
            let mut solutions = [blank(); PART + LANES];
            let (from, count) = (piece.from, piece.rows());
            let solved = solve(batch, from % group, from..from + count, &mut solutions[..count]);
            if let Err(error) = solved {
                // The batch tells what it refuses, but not where.
                let one = |i: usize| rows.query(i, question(i)).analytic(&batch.actuators()[i % group]);
                let mut refused = (from..from + count).filter_map(|i| Some(Refusal::new(i, one(i).err()?)));
                return Err(refused.next().unwrap_or_else(|| Refusal::new(from, error)));
            }
            let actuators = batch.actuators()[from % group..].iter();
            for (row, (solution, actuator)) in solutions[..count].iter().zip(actuators).enumerate() {
                let i = from + row;
                // Reading the motion of every straight tube would add a seventh to its solution.
                let answer = if kinds.some_bend {
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

/// Equilibria of straight actuators that are not kept, each at its own gauge pressure.
///
/// # Errors
/// The first row that the model refuses.
pub(crate) fn forward_of_columns(
    columns: &Columns<'_>,
    stretch_max: Option<&[f64]>,
    pressures: &[f64],
    loads: &Loads,
) -> Result<Answers, Refusal> {
    Table::filled(pressures.len(), pressures.len(), PART, |piece| {
        for row in 0..piece.rows() {
            let i = piece.from + row;
            let parameters = columns.parameters(i);
            let solution = Actuator::forward_once(&parameters, pressures[i], &loads.at(i));
            let solution = solution.map_err(|error| Refusal::new(i, error))?;
            let answer = Answer::analytic(&solution, Some(0.0));
            answer.write(piece, row, &parameters, stretch_max.map(|column| column[i]));
        }
        Ok(())
    })
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

/// Actuators for a batch: fewer than fill a part are repeated.
fn repeated(actuators: &Shared) -> ActuatorBatch<Shared> {
    let count = actuators.0.len();
    let times = PART.div_ceil(count.max(1));
    let several = || Shared(Arc::new(actuators.0.repeat(times)));
    ActuatorBatch::new(if times > 1 { several() } else { actuators.clone() })
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
