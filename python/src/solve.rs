//! One query to one actuator, by the model that answers it.

use fra_model::{
    Actuator, ActuatorParameters, InvalidParameter, Load, Motion, PressureRange, Solution, State, Status, Target,
};
use softlimb::query::{Question, SectionAnswer, SectionQuery, solve_section};
use softlimb_fea::cross_section::{SectionError, analytic_bend_error, is_wound_bender};
use softlimb_limb::largest_stretch;

use super::answers::Piece;

/// Choice of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Choice {
    /// Analytic where its relative error of a bend is within a tolerance, else finite elements.
    Auto(f64),
    /// The analytic model.
    Analytic,
    /// Finite elements of the cross-section.
    SectionFe,
}

/// Codes of an answer: status, model, whether the wall stretches further than the test of its elastomer.
pub(crate) const CODES: usize = 3;
/// Numbers of an answer: the state, limit pressure, residual, errors of model and discretisation.
pub(crate) const NUMBERS: usize = 12;

const ANALYTIC: i8 = 0;
const SECTION_FE: i8 = 1;

/// Code of a status.
pub(crate) fn code(status: Status) -> i8 {
    match status {
        Status::Solved => 0,
        Status::NoSolution => 1,
        Status::NotConverged => 2,
    }
}

/// The numbers of a state, in the order of the columns.
pub(crate) fn numbers(state: &State<f64>) -> [f64; 8] {
    [
        state.pressure_pa,
        state.axial_stretch,
        state.inner_radius_m,
        state.outer_radius_m,
        state.twist_rad,
        state.bend_angle_rad,
        state.volume_m3,
        state.compliance_m3_per_pa,
    ]
}

/// One answer.
pub(crate) struct Answer {
    model: i8,
    status: Status,
    /// Of the equilibrium, if it is solved.
    state: State<f64>,
    count: u32,
    /// Limit pressure, residual, errors of model and discretisation; not a number where there is none.
    others: [f64; 4],
}

impl Answer {
    /// That of the analytic model, with the error of the model where it is known.
    #[inline(always)]
    pub(crate) fn analytic(solution: &Solution<f64>, error: Option<f64>) -> Self {
        let is_solved = solution.status == Status::Solved;
        let limit = solution.limit_pressure_pa.filter(|limit| limit.is_finite() && !is_solved).unwrap_or(f64::NAN);
        let error = error.filter(|_| is_solved).unwrap_or(f64::NAN);
        let discretisation = if is_solved { 0.0 } else { f64::NAN };
        Self {
            model: ANALYTIC,
            status: solution.status,
            state: solution.state,
            count: solution.iterations,
            others: [limit, solution.residual, error, discretisation],
        }
    }

    fn of_section(answer: &SectionAnswer, motion: Motion, rest: &State<f64>) -> Self {
        let limit = answer.limit_pressure_pa.unwrap_or(f64::NAN);
        let discretisation = answer.discretisation(motion).unwrap_or(f64::NAN);
        let error = if answer.status == Status::Solved { 0.0 } else { f64::NAN };
        Self {
            model: SECTION_FE,
            status: answer.status,
            state: answer.state.unwrap_or(*rest),
            count: answer.iterations,
            others: [limit, f64::NAN, error, discretisation],
        }
    }

    /// Writes the row, with the largest stretch of the test of the actuator's elastomer where there is one.
    #[inline(always)]
    pub(crate) fn write(
        &self,
        piece: &mut Piece<'_, CODES, NUMBERS>,
        row: usize,
        parameters: &ActuatorParameters<f64>,
        stretch_max: Option<f64>,
    ) {
        let is_solved = self.status == Status::Solved;
        let mut values = [f64::NAN; NUMBERS];
        if is_solved {
            values[..8].copy_from_slice(&numbers(&self.state));
        }
        values[8..].copy_from_slice(&self.others);
        let beyond = stretch_max.is_some_and(|most| is_solved && largest_stretch(parameters, &self.state) > most);
        piece.set(row, [code(self.status), self.model, i8::from(beyond)], self.count, values);
    }
}

/// A query without its actuator.
#[derive(Clone, Copy)]
pub(crate) struct Query {
    pub(crate) question: Question<Target<f64>>,
    pub(crate) range: PressureRange<f64>,
    pub(crate) load: Load<f64>,
}

impl Query {
    /// The answer of the analytic model.
    pub(crate) fn analytic(&self, actuator: &Actuator<f64>) -> Result<Solution<f64>, InvalidParameter<f64>> {
        match self.question {
            Question::Forward { pressure_pa } => actuator.forward(pressure_pa, &self.load),
            Question::Inverse { target } => actuator.inverse_within(&self.range, target, &self.load),
        }
    }

    fn by_section(&self, actuator: &Actuator<f64>) -> Result<Answer, SectionError> {
        let Self { question, range, load } = *self;
        let (parameters, second_fiber) = (actuator.parameters(), actuator.second_fiber());
        let answer = solve_section(&SectionQuery { parameters, second_fiber, question, range, load })?;
        Ok(Answer::of_section(&answer, parameters.motion, &actuator.rest()))
    }

    /// The answer of the chosen model.
    pub(crate) fn of(&self, actuator: &Actuator<f64>, choice: Choice) -> Result<Answer, SectionError> {
        if choice == Choice::SectionFe {
            return self.by_section(actuator);
        }
        Ok(self.chosen(actuator, &self.analytic(actuator)?, choice))
    }

    /// The answer of the analytic model with its error, or that of finite elements where this is too large.
    pub(crate) fn chosen(&self, actuator: &Actuator<f64>, solution: &Solution<f64>, choice: Choice) -> Answer {
        let parameters = actuator.parameters();
        if parameters.motion != Motion::Bending {
            return Answer::analytic(solution, Some(0.0));
        }
        let is_solved = solution.status == Status::Solved;
        let error = is_solved.then(|| analytic_bend_error(parameters, &solution.state)).flatten();
        // The estimate holds without a load.
        let stated = error.filter(|_| self.is_free());
        let analytic = Answer::analytic(solution, stated);
        match choice {
            Choice::Auto(tolerance) if is_wound_bender(parameters) && stated.is_none_or(|error| error > tolerance) => {
                // Vacuum and more than 100 shear moduli are outside the finite elements' range.
                self.by_section(actuator).unwrap_or(analytic)
            }
            _ => analytic,
        }
    }

    fn is_free(&self) -> bool {
        self.load == Load::none()
    }
}
