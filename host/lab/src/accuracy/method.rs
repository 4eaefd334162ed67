//! Every method that is measured, by name.

use fra_model::{Load, Motion, Solution, Status};

use super::kernel::{self, Balance, Found, Integration, Stop};
use super::number::Number;
use super::question::{Question, Scalar, target};
use super::series;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Problem {
    /// The deformation at a pressure.
    Forward,
    /// The pressure at a deformation.
    Inverse,
}

impl Problem {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Inverse => "inverse",
        }
    }
}

/// A way to answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// `Actuator::forward`, `Actuator::inverse`.
    Cold,
    /// `Actuator::forward_from`, `Actuator::inverse_from`.
    Warm,
    /// `Actuator::inverse_near`.
    Near,
    /// Newton's method without safeguards, from rest or from the nearby state.
    Newton { stop: Stop, warm: bool },
    /// The same to the end, with every wall integral by so many nodes.
    Nodes(u32),
    /// The same to the end, with nothing but closed forms; where there are some.
    ClosedForm,
    /// A Chebyshev series of a degree in place of the equations.
    Series(usize),
    /// `InverseTable` with that series.
    Table(usize),
    /// The limit of inextensible fibers.
    Inextensible,
    /// The pressure of the true state by the printed (8).
    Printed,
    /// A balance of moments of a bend.
    Bend(Balance),
    /// `Cold`, `Warm` and `Near`, where the wall is neo-Hookean and the winding a sheet.
    Sheet(&'static Way),
}

/// One method for one problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Method {
    pub(super) problem: Problem,
    pub(super) way: Way,
}

/// A method made ready for one question.
pub(super) type Ready<T> = Box<dyn Fn() -> Found<T>>;

/// All methods, in the order of the table.
pub(super) fn methods() -> Vec<Method> {
    use Problem::{Forward, Inverse};
    let newton = |warm| move |stop| Way::Newton { stop, warm };
    let tolerances = [1e-3, 1e-6, 1e-10].map(Stop::Below);
    let degrees = [4, 6, 8, 12, 16];
    let steps = [1, 2, 3].map(Stop::Steps);
    let balances = [(2, 4), (3, 6), (4, 8), (6, 12)].map(|(radial, angles)| Balance::Map(radial, angles));
    let balances = [Balance::Printed, Balance::Caps, Balance::Winding].into_iter().chain(balances);
    let bends: Vec<Way> = balances.map(Way::Bend).collect();
    let sheet = [&Way::Cold, &Way::Warm, &Way::Near].map(Way::Sheet);
    let forward = [Way::Cold, Way::Warm, sheet[0], sheet[1]]
        .into_iter()
        .chain(tolerances.map(newton(false)))
        .chain(steps.map(newton(true)))
        .chain([Way::ClosedForm])
        .chain((2..=8).map(Way::Nodes))
        .chain(bends.clone());
    let inverse = [Way::Cold, Way::Warm, Way::Near]
        .into_iter()
        .chain(sheet)
        .chain(steps.map(newton(true)))
        .chain(degrees.map(Way::Series))
        .chain(degrees.map(Way::Table))
        .chain([Way::Inextensible, Way::Printed])
        .chain(bends);
    let forward = forward.map(|way| Method { problem: Forward, way });
    forward.chain(inverse.map(|way| Method { problem: Inverse, way })).collect()
}

impl Method {
    /// The name in the table.
    pub(super) fn name(&self) -> String {
        let inverse = self.problem == Problem::Inverse;
        match self.way {
            Way::Cold => if inverse { "inverse" } else { "forward" }.into(),
            Way::Warm => if inverse { "inverse_from" } else { "forward_from" }.into(),
            Way::Near => "inverse_near".into(),
            Way::Sheet(way) => format!("{}, sheet", Method { way: *way, ..*self }.name()),
            Way::Newton { stop, warm } => {
                let start = if warm { "warm" } else { "cold" };
                match stop {
                    Stop::Steps(1) => format!("Newton, {start}, 1 step"),
                    Stop::Steps(count) => format!("Newton, {start}, {count} steps"),
                    Stop::Settled => format!("Newton, {start}"),
                    Stop::Below(tolerance) => format!("Newton, {start}, to {tolerance:e}"),
                }
            }
            Way::Nodes(count) => format!("{count} nodes"),
            Way::ClosedForm => "closed form".into(),
            Way::Series(degree) => format!("Chebyshev, degree {degree}"),
            Way::Table(degree) => format!("table, degree {degree}"),
            Way::Inextensible => "inextensible fibers".into(),
            Way::Printed => "printed (8)".into(),
            Way::Bend(Balance::Printed) => "printed (13)".into(),
            Way::Bend(Balance::Caps) => "B0".into(),
            Way::Bend(Balance::Winding) => "B1".into(),
            Way::Bend(Balance::Map(radial, angles)) => format!("B2, {radial} x {angles} nodes"),
        }
    }

    /// The method made ready for a question; `None` where it does not apply.
    pub(super) fn ready<T: Scalar>(&self, question: &Question) -> Option<Ready<T>> {
        let p = &question.parameters;
        let bends = question.motion() == Motion::Bending;
        match (self.way, self.problem) {
            (Way::Cold | Way::Warm | Way::Near, _) => self.product(question),
            (Way::Sheet(way), _) => {
                kernel::closed_form(p).then(|| Method { way: *way, ..*self }.ready(question)).flatten()
            }
            (Way::Series(degree), _) => Some(series::ready(question, degree)),
            (Way::Table(degree), _) => series::table(question, degree),
            (Way::Bend(balance), Problem::Forward) if bends => {
                Some(Box::new(kernel::bend::<T>(p, balance, question.pressure_pa)))
            }
            (Way::Bend(balance), Problem::Inverse) if bends => {
                Some(Box::new(kernel::unbend::<T>(p, balance, question.truth.target)))
            }
            (Way::Bend(_), _) => None,
            _ if bends => None,
            (Way::Inextensible, _) => {
                kernel::inextensible::<T>(p, question.truth.target).map(|solve| Box::new(solve) as Ready<T>)
            }
            (Way::Printed, _) => {
                let state = question.truth.at_target.map(|value| T::of(Number::nearest(value)));
                Some(Box::new(kernel::printed::<T>(p, state)))
            }
            (Way::Newton { .. } | Way::Nodes(_) | Way::ClosedForm, _) => self.newton(question),
        }
    }

    fn newton<T: Scalar>(&self, question: &Question) -> Option<Ready<T>> {
        let p = &question.parameters;
        let (integration, stop, warm) = match self.way {
            Way::Newton { stop: Stop::Below(tolerance), warm } => {
                // A tolerance below what the scalar can tell is none.
                let reachable = tolerance >= 10.0 * <T as Number>::epsilon();
                (Integration::Closed, reachable.then_some(Stop::Below(tolerance))?, warm)
            }
            Way::Newton { stop, warm } => (Integration::Closed, stop, warm),
            Way::Nodes(count) => (Integration::Nodes(count), Stop::Settled, true),
            _ => (kernel::closed_form(p).then_some(Integration::Closed)?, Stop::Settled, true),
        };
        let start = if warm { question.start() } else { [T::of(0.0); 3] };
        Some(match self.problem {
            Problem::Forward => Box::new(kernel::forward::<T>(p, integration, stop, start, question.pressure_pa)),
            Problem::Inverse => Box::new(kernel::inverse::<T>(p, integration, stop, start, question.truth.target)),
        })
    }

    fn product<T: Scalar>(&self, question: &Question) -> Option<Ready<T>> {
        /// Newton iterations a controller grants.
        const BUDGET: u32 = 50;
        let actuator = question.actuator::<T>()?;
        let none = Load { force_n: T::of(0.0), torque_nm: T::of(0.0) };
        let (pressure, goal) = (T::of(question.pressure_pa), target(question.motion(), T::of(question.truth.target)));
        let start = fra_model::State::combine([&question.nearby], |[value]| T::of(value));
        let (way, problem, question) = (self.way, self.problem, *question);
        Some(Box::new(move || {
            let solution: Solution<T> = match (problem, way) {
                (Problem::Forward, Way::Cold) => actuator.forward(pressure, &none),
                (Problem::Forward, _) => actuator.forward_from(&start, pressure, &none),
                (Problem::Inverse, Way::Cold) => actuator.inverse(goal, &none),
                (Problem::Inverse, Way::Near) => actuator.inverse_near(&start, goal, &none, BUDGET),
                (Problem::Inverse, _) => actuator.inverse_from(&start, goal, &none),
            }
            .ok()
            .filter(|solution| solution.status == Status::Solved)?;
            let value = match problem {
                Problem::Forward => question.coordinates(&solution.state),
                Problem::Inverse => [solution.state.pressure_pa, T::of(0.0), T::of(0.0)],
            };
            Some((value, solution.iterations))
        }))
    }
}
