//! The model that answers for a body: the analytic one, or finite elements of the cross-section where its bend errs by more than is accepted.

use std::fmt;

use fra_model::{Actuator, Load, Motion, Status};
use softlimb_fea::cross_section::{BEND_TOLERANCE, analytic_bend_error, is_wound_bender};

use super::{Body, Branch, Property, Unknown};

/// Model of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyModel {
    /// The equations of a straight tube.
    Tube,
    /// The analytic bend, with the largest error that it states at the readings, relative; `None` where it states none.
    AnalyticBend(Option<f64>),
    /// Finite elements of the cross-section, and why.
    SectionFe(Reason),
}

/// Why the analytic bend does not serve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// There are two windings.
    TwoWindings,
    /// It leaves out a property that is fitted.
    LeavesOut(Property),
    /// It states this relative error at a reading, more than [`BEND_TOLERANCE`].
    Error(f64),
    /// It states no error at a reading, or does not reach it.
    NoError,
}

impl BodyModel {
    /// Whether finite elements answer.
    pub fn is_by_section(&self) -> bool {
        matches!(self, Self::SectionFe(_))
    }

    /// The model of each body at its readings, Pa.
    pub(super) fn of_all(
        bodies: &[Body],
        unknowns: &[Unknown],
        readings_pa: impl Fn(usize) -> Vec<(f64, Branch)>,
    ) -> Vec<Self> {
        let of = |(index, body): (usize, &Body)| {
            let fitted = unknowns.iter().filter(|unknown| unknown.bodies.contains(&index));
            Self::of(body, readings_pa(index).into_iter(), fitted.map(|unknown| unknown.property))
        };
        bodies.iter().enumerate().map(of).collect()
    }

    /// The model of a body at readings, Pa, with the properties that are fitted.
    fn of(
        body: &Body,
        readings_pa: impl Iterator<Item = (f64, Branch)>,
        mut fitted: impl Iterator<Item = Property>,
    ) -> Self {
        let parameters = &body.parameters;
        if parameters.motion != Motion::Bending {
            return Self::Tube;
        }
        if body.second_fiber.is_some() {
            return Self::SectionFe(Reason::TwoWindings);
        }
        let error = body.largest_error(readings_pa);
        if !is_wound_bender(parameters) {
            return Self::AnalyticBend(error);
        }
        let follows_angle = parameters.fiber.is_some_and(|fiber| fiber.shrinks_bends());
        let is_left_out = |property: &Property| match property {
            Property::FiberModulus => true,
            Property::FiberAngle => !follows_angle,
            _ => false,
        };
        match (fitted.find(is_left_out), error) {
            (Some(property), _) => Self::SectionFe(Reason::LeavesOut(property)),
            (None, None) => Self::SectionFe(Reason::NoError),
            (None, Some(error)) if error > BEND_TOLERANCE => Self::SectionFe(Reason::Error(error)),
            (None, error) => Self::AnalyticBend(error),
        }
    }
}

impl Body {
    /// The largest error that the analytic bend states at readings, Pa; `None` where it states none at one of them.
    fn largest_error(&self, readings_pa: impl Iterator<Item = (f64, Branch)>) -> Option<f64> {
        let actuator = Actuator::new(&self.parameters).ok()?;
        let of_reading = |(reading_pa, branch): (f64, Branch)| {
            let solution = actuator.forward(self.deforming(reading_pa, branch).pressure_pa, &Load::none()).ok()?;
            let solved = solution.status == Status::Solved;
            solved.then(|| analytic_bend_error(&self.parameters, &solution.state)).flatten()
        };
        readings_pa.map(of_reading).try_fold(0.0, |largest, error| Some(f64::max(largest, error?)))
    }
}

impl fmt::Display for BodyModel {
    /// Behind a name and a colon.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tube => f.write_str("analytic tube"),
            Self::AnalyticBend(Some(error)) => {
                write!(f, "analytic bend, within {:.2} % of finite elements", 100.0 * error)
            }
            Self::AnalyticBend(None) => f.write_str("analytic bend, whose error is not known here"),
            Self::SectionFe(reason) => write!(f, "finite elements of the cross-section, because {reason}"),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TwoWindings => f.write_str("the analytic bend takes one winding"),
            Self::LeavesOut(property) => write!(f, "the analytic bend leaves out {property}"),
            Self::Error(error) => {
                let [error, most] = [*error, BEND_TOLERANCE].map(|error| 100.0 * error);
                write!(f, "the analytic bend errs by up to {error:.2} %, more than {most} %")
            }
            Self::NoError => f.write_str("the error of the analytic bend is not known here"),
        }
    }
}
