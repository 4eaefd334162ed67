//! Questions to the finite element model of the section.

use fra_model::{
    Actuator, ActuatorParameters, Fiber, InvalidParameter, Load, Motion, PressureRange, Solution, State, StateQuantity,
    Status, Target,
};
use serde::Serialize;

use super::request::Question;
use softlimb_fea::cross_section::{Answer, EndLoad, Equilibrium, Options, Outcome, Section, SectionError};
use softlimb_files::range::OutOfRange;

/// Steps of the search for a pressure.
pub(super) const STEPS: usize = 30;
/// Relative tolerance of the search for a target: far below the error of discretisation.
const TOLERANCE: f64 = 1e-11;
/// Smaller angles are compared with this, rad.
const LEAST_ANGLE_RAD: f64 = 1e-3;

/// Error of discretisation of an answer, in its own units.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Discretisation {
    axial_stretch: f64,
    outer_radius_m: f64,
    twist_rad: f64,
    bend_angle_rad: f64,
}

impl Discretisation {
    /// Of the deformation that a motion is named after.
    pub(super) fn natural(&self, motion: Motion) -> f64 {
        match motion {
            Motion::Extension => self.axial_stretch,
            Motion::Expansion => self.outer_radius_m,
            Motion::Bending => self.bend_angle_rad,
            Motion::Twisting => self.twist_rad,
        }
    }
}

/// A query to the finite elements of the cross-section.
#[derive(Clone, Copy, Debug)]
pub struct SectionQuery<'a> {
    /// The actuator.
    pub parameters: &'a ActuatorParameters<f64>,
    /// A winding beside that of the parameters. A bending actuator then twists, too, unless the two mirror each other.
    pub second_fiber: Option<&'a Fiber<f64>>,
    /// The given pressure or deformation.
    pub question: Question<Target<f64>>,
    /// Pressures that may answer an inverse question.
    pub range: PressureRange<f64>,
    /// Load on the free end.
    pub load: Load<f64>,
}

/// Answer of the finite elements of the cross-section.
#[derive(Clone, Copy, Debug)]
pub struct SectionAnswer {
    /// Outcome of the solve.
    pub status: Status,
    /// The equilibrium, if the status is [`Status::Solved`].
    pub state: Option<State<f64>>,
    pub(super) error: Option<Discretisation>,
    /// Pressure at the end of the branch, Pa, where it ends at one.
    pub limit_pressure_pa: Option<f64>,
    /// Linear systems solved, on both meshes.
    pub iterations: u32,
}

impl SectionAnswer {
    /// Estimated relative error of discretisation, of the deformation that a motion is named after; `None` where the coarser mesh has no
    /// equilibrium.
    pub fn discretisation(&self, motion: Motion) -> Option<f64> {
        let value = StateQuantity::natural(motion).of(self.state.as_ref()?);
        Some(self.error?.natural(motion) / value.abs())
    }
}

/// A section with the question's length and load, and the work done for it.
pub(super) struct Asked<'a> {
    pub(super) section: Section,
    pub(super) query: &'a SectionQuery<'a>,
    load: EndLoad,
    pub(super) iterations: u32,
}

/// Answers a query.
///
/// # Errors
/// An error with field, value and range, if a value is outside the range of the finite elements.
pub fn solve_section(query: &SectionQuery<'_>) -> Result<SectionAnswer, SectionError> {
    let mut asked = Asked::new(query)?;
    match query.question {
        Question::Forward { pressure_pa } => {
            let answer = asked.at(pressure_pa)?;
            Ok(asked.found(&answer))
        }
        Question::Inverse { target } => {
            let near_analytic = asked.reach(target)?;
            if near_analytic.status == Status::Solved {
                return Ok(near_analytic);
            }
            // A bend that first falls leads the secant astray.
            let every = asked.every(near_analytic, target)?;
            Ok(if every.solutions.is_empty() { near_analytic } else { every.first })
        }
    }
}

/// The error with the name of the one pressure.
fn plain(error: SectionError) -> SectionError {
    match error {
        SectionError::Option(OutOfRange { field: "pressures_pa", value, allowed }) => {
            SectionError::Option(OutOfRange { field: "pressure_pa", value, allowed })
        }
        other => other,
    }
}

impl SectionQuery<'_> {
    /// The analytic answer to an inverse question. Of a bending actuator with two windings it is that without the second, near which
    /// the answer lies.
    fn analytic(&self, target: Target<f64>) -> Result<Solution<f64>, InvalidParameter<f64>> {
        let actuator = Actuator::new(self.parameters)?;
        let actuator = match self.second_fiber.filter(|_| self.parameters.motion != Motion::Bending) {
            None => actuator,
            Some(second) => actuator.with_second_fiber(second)?,
        };
        actuator.inverse(target, &self.load)
    }
}

impl<'a> Asked<'a> {
    pub(super) fn new(query: &'a SectionQuery<'a>) -> Result<Self, SectionError> {
        let options = Options::default();
        let section = match query.second_fiber {
            None => Section::new(query.parameters, &options),
            Some(second) => Section::with_two_windings(query.parameters, second, &options),
        };
        let load = EndLoad::of(&query.load, query.parameters.motion);
        Ok(Self { section: section.map_err(plain)?, query, load, iterations: 0 })
    }

    /// The answers along the curve at rising pressures, Pa.
    pub(super) fn along(&mut self, pressures_pa: &[f64]) -> Result<Vec<Answer>, SectionError> {
        let curve = self.section.curve(pressures_pa, &self.load).map_err(plain)?;
        self.iterations += curve.effort.newton_iterations + curve.coarse_effort.newton_iterations;
        Ok(curve.answers)
    }

    pub(super) fn at(&mut self, pressure_pa: f64) -> Result<Answer, SectionError> {
        // One answer a pressure.
        Ok(self.along(&[pressure_pa])?[0])
    }

    /// The pressure that reaches a target: from that of the analytic model by the secant method, below what is known to have no answer.
    pub(super) fn reach(&mut self, target: Target<f64>) -> Result<SectionAnswer, SectionError> {
        let range = &self.query.range;
        range.check()?;
        let first = self.query.analytic(target)?;
        if first.status != Status::Solved || first.state.pressure_pa < 0.0 {
            return Ok(self.nothing(Status::NoSolution, first.limit_pressure_pa));
        }
        let mut before = (0.0, self.at(0.0)?);
        let mut pressure_pa = first.state.pressure_pa;
        let mut beyond: Option<Answer> = None;
        for _ in 0..STEPS {
            let answer = self.at(pressure_pa)?;
            let Some(miss) = self.miss(&answer, target) else {
                beyond = Some(answer);
                pressure_pa = 0.5 * (before.0 + pressure_pa);
                continue;
            };
            if is_reached(miss, target) {
                let inside = range.contains(answer.pressure_pa);
                return Ok(if inside { self.found(&answer) } else { self.nothing(Status::NoSolution, None) });
            }
            let Some(old) = self.miss(&before.1, target) else { return Ok(self.found(&before.1)) };
            let next = pressure_pa - miss * (pressure_pa - before.0) / (miss - old);
            match next {
                // Two answers that do not differ.
                _ if !next.is_finite() => return Ok(self.nothing(Status::NotConverged, None)),
                _ if next < 0.0 => return Ok(self.nothing(Status::NoSolution, None)),
                _ => {}
            }
            before = (pressure_pa, answer);
            let limit_pa = beyond.map_or(f64::INFINITY, |beyond| beyond.pressure_pa);
            pressure_pa = if next < limit_pa { next } else { 0.5 * (pressure_pa + limit_pa) };
        }
        Ok(beyond.map_or_else(|| self.nothing(Status::NotConverged, None), |answer| self.found(&answer)))
    }

    /// Distance of an answer beyond a target.
    pub(super) fn miss(&self, answer: &Answer, target: Target<f64>) -> Option<f64> {
        let state = answer.equilibrium()?.state.over(self.query.parameters.length_m);
        Some(match target {
            Target::AxialStretch(value) => state.axial_stretch - value,
            Target::OuterRadius(value) => state.outer_radius_m - value,
            Target::InnerRadius(value) => state.inner_radius_m - value,
            Target::Twist(value) => state.twist_rad - value,
            Target::BendAngle(value) => state.bend_angle_rad - value,
        })
    }

    pub(super) fn found(&self, answer: &Answer) -> SectionAnswer {
        let length_m = self.query.parameters.length_m;
        let Some(equilibrium) = answer.equilibrium() else { return self.nothing(status(answer), limit(answer)) };
        SectionAnswer {
            state: Some(equilibrium.state.over(length_m)),
            error: discretisation(equilibrium, length_m),
            ..self.nothing(Status::Solved, None)
        }
    }

    pub(super) fn nothing(&self, status: Status, limit_pressure_pa: Option<f64>) -> SectionAnswer {
        SectionAnswer { status, state: None, error: None, limit_pressure_pa, iterations: self.iterations }
    }
}

/// Whether there is an equilibrium, and if not whether that is known.
fn status(answer: &Answer) -> Status {
    match answer.outcome {
        Outcome::Equilibrium(_) => Status::Solved,
        Outcome::NotConverged { .. } => Status::NotConverged,
        Outcome::NoEquilibrium { .. } | Outcome::LoadNotCarried => Status::NoSolution,
    }
}

pub(super) fn is_reached(miss: f64, target: Target<f64>) -> bool {
    miss.abs() <= TOLERANCE * size(target)
}

/// Reference size of a miss.
fn size(target: Target<f64>) -> f64 {
    match target {
        Target::AxialStretch(value) | Target::OuterRadius(value) | Target::InnerRadius(value) => value,
        Target::Twist(value) | Target::BendAngle(value) => value.abs().max(LEAST_ANGLE_RAD),
    }
}

fn limit(answer: &Answer) -> Option<f64> {
    match answer.outcome {
        Outcome::NoEquilibrium { limit_pressure_pa } => Some(limit_pressure_pa),
        _ => None,
    }
}

fn discretisation(equilibrium: &Equilibrium, length_m: f64) -> Option<Discretisation> {
    let error = equilibrium.error?;
    let [first, second] = error.bend_rates_rad_per_m;
    Some(Discretisation {
        axial_stretch: error.axial_strain,
        outer_radius_m: error.outer_radius_m,
        twist_rad: error.twist_rate_rad_per_m * length_m,
        bend_angle_rad: first.hypot(second) * length_m,
    })
}
