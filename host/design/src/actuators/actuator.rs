//! One segment at one geometry: solves, their count, and exact derivatives by the design variables.

use fra_model::{Actuator, Load, Motion, Parameter, Solution, State, Status, Target};

use serde::Serialize;

use super::problem::{Geometry, Segment};

/// What a search has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Equilibria solved for, forward or inverse, whatever they are for.
    #[serde(rename = "model_solves")]
    pub solves: u64,
    /// Derivatives of an equilibrium by one parameter.
    pub derivatives: u64,
    /// Objectives and Jacobians: each of either counts one.
    pub evaluations: u64,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.solves += other.solves;
        self.derivatives += other.derivatives;
        self.evaluations += other.evaluations;
    }
}

/// The highest pressure that a geometry may be given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cap {
    pub(crate) pressure_pa: f64,
    /// The state at the limit point, where the margin to it is what bounds the pressure.
    pub(super) limit: Option<State<f64>>,
}

impl Cap {
    /// The margin below the end of a branch: a limit point, or the largest volume that the model follows it to.
    fn below(beyond: &Solution<f64>, share: f64) -> Self {
        let limit = beyond.limit_pressure_pa.map(|_| beyond.state);
        Self { pressure_pa: share * beyond.limit_pressure_pa.unwrap_or(beyond.state.pressure_pa), limit }
    }
}

/// One segment at one geometry.
pub(crate) struct Candidate<'a> {
    pub(crate) segment: &'a Segment,
    pub(crate) geometry: Geometry,
    pub(crate) actuator: Actuator<f64>,
}

impl<'a> Candidate<'a> {
    /// `None` where the model cannot take the geometry.
    pub(crate) fn new(segment: &'a Segment, place: &[f64]) -> Option<Self> {
        let geometry = segment.geometry(place);
        let actuator = segment.actuator(&geometry).ok()?;
        Some(Self { segment, geometry, actuator })
    }

    /// What eq. (14) compares.
    pub(crate) fn measure(&self, state: &State<f64>) -> f64 {
        self.segment.measure(state, self.geometry.length_m)
    }

    /// Any status but that the solver gave up.
    fn forward(&self, from: Option<&State<f64>>, pressure_pa: f64, counts: &mut Counts) -> Option<Solution<f64>> {
        counts.solves += 1;
        let solution = match from {
            None => self.actuator.forward(pressure_pa, &Load::none()),
            Some(state) => self.actuator.forward_from(state, pressure_pa, &Load::none()),
        };
        solution.ok().filter(|solution| solution.status != Status::NotConverged)
    }

    /// The state at a pressure within the cap.
    pub(crate) fn at(&self, pressure_pa: f64, counts: &mut Counts) -> Option<State<f64>> {
        let solution = self.forward(None, pressure_pa, counts)?;
        (solution.status == Status::Solved).then_some(solution.state)
    }

    /// The state at a pressure, of a geometry and a pressure next to those of a state.
    pub(super) fn near(&self, state: &State<f64>, pressure_pa: f64, counts: &mut Counts) -> Option<State<f64>> {
        // The closed form from rest is cheaper than any start; a bend has none.
        let from = (self.segment.motion == Motion::Bending).then_some(state);
        let solution = self.forward(from, pressure_pa, counts)?;
        (solution.status == Status::Solved).then_some(solution.state)
    }

    /// The state at a deformation.
    pub(crate) fn inverse(&self, value: f64, counts: &mut Counts) -> Option<State<f64>> {
        let target = self.segment.target(value, self.geometry.length_m)?;
        counts.solves += 1;
        let solution = self.actuator.inverse(target, &Load::none()).ok()?;
        (solution.status == Status::Solved).then_some(solution.state)
    }

    /// The margin below the limit point, where that is less than a pressure or the pressure has no state at all; else there is no cap.
    pub(super) fn cap_below(&self, pressure_pa: f64, counts: &mut Counts) -> Option<Option<Cap>> {
        if self.segment.bends_without_limit() {
            return Some(None);
        }
        let share = 1.0 - self.segment.limit_margin;
        let beyond = self.forward(None, pressure_pa / share, counts)?;
        if beyond.status == Status::Solved {
            return Some(None);
        }
        Some(Some(Cap::below(&beyond, share)))
    }

    /// The highest pressure: that of the bounds, or the margin below the limit point where that is less.
    pub(crate) fn cap(&self, counts: &mut Counts) -> Option<Cap> {
        let (highest, share) = (self.segment.pressure_max_pa, 1.0 - self.segment.limit_margin);
        if self.segment.bends_without_limit() {
            return Some(Cap { pressure_pa: highest, limit: None });
        }
        let beyond = self.forward(None, highest / share, counts)?;
        if beyond.status == Status::Solved {
            return Some(Cap { pressure_pa: highest, limit: None });
        }
        let below = Cap::below(&beyond, share);
        Some(if below.pressure_pa < highest { below } else { Cap { pressure_pa: highest, limit: None } })
    }

    /// The margin below the limit point, whether it bounds the pressure or not; `None` where no limit point is found below `highest_pa`.
    pub(super) fn margin(&self, highest_pa: f64, counts: &mut Counts) -> Option<Cap> {
        let beyond = self.forward(None, highest_pa / (1.0 - self.segment.limit_margin), counts)?;
        let limit = beyond.limit_pressure_pa.filter(|_| beyond.status != Status::Solved)?;
        Some(Cap { pressure_pa: (1.0 - self.segment.limit_margin) * limit, limit: Some(beyond.state) })
    }

    /// `dq/dP` at a pressure, m/Pa or rad/Pa.
    pub(super) fn by_pressure(&self, state: &State<f64>, counts: &mut Counts) -> Option<f64> {
        self.by(state, Parameter::Pressure, counts)
    }

    /// `dq/dP` of a bender, rad/Pa: what its lumen grows by the pressure over what it grows by the bend.
    pub(super) fn bend_by_pressure(&self, state: &State<f64>) -> Option<f64> {
        Some(state.compliance_m3_per_pa / self.actuator.volume_by_bend(state.bend_angle_rad)?[0])
    }

    /// `dq` at a given pressure by each variable of the unit box.
    pub(super) fn by_place(&self, state: &State<f64>, counts: &mut Counts) -> Option<[f64; 4]> {
        let q = self.measure(state);
        // Stretch, radii and the twist and bend per length do not depend on the length.
        let by_length = if self.segment.motion == Motion::Expansion { 0.0 } else { q / self.geometry.length_m };
        self.by_variables(by_length, |parameter| self.by(state, parameter, counts))
    }

    /// The derivative of the cap by each variable of the unit box.
    pub(super) fn cap_by_place(&self, cap: &Cap, counts: &mut Counts) -> Option<[f64; 4]> {
        let Some(limit) = &cap.limit else { return Some([0.0; 4]) };
        let share = 1.0 - self.segment.limit_margin;
        // Any target that the pressure moves will do: at a limit point it is the pressure that stands still.
        let target = match self.segment.motion {
            Motion::Bending => Target::BendAngle(limit.bend_angle_rad),
            _ => Target::InnerRadius(limit.inner_radius_m),
        };
        self.by_variables(0.0, |parameter| {
            counts.derivatives += 1;
            let change = self.actuator.inverse_sensitivity(limit, &Load::none(), target, parameter);
            Some(share * change.ok()?.pressure_pa)
        })
    }

    /// Carries derivatives by the model's parameters over to the unit box.
    fn by_variables(&self, by_length: f64, mut by: impl FnMut(Parameter) -> Option<f64>) -> Option<[f64; 4]> {
        let mut by_inner = by(Parameter::InnerRadius)?;
        let mut by_outer = by(Parameter::OuterRadius)?;
        if let Some([inner, outer]) = self.segment.winding.and_then(|winding| winding.radius_slopes()) {
            let by_winding = by(Parameter::WindingRadius)?;
            by_inner += inner * by_winding;
            by_outer += outer * by_winding;
        }
        let second = self.segment.second.filter(|_| self.segment.motion != Motion::Bending);
        if let Some([inner, outer]) = second.and_then(|(winding, _)| winding.radius_slopes()) {
            let by_winding = by(Parameter::SecondWindingRadius)?;
            by_inner += inner * by_winding;
            by_outer += outer * by_winding;
        }
        let by_angle = if self.segment.dimensions() > 3 && self.segment.axis(3)[1] > 0.0 {
            by(Parameter::FiberAngle)?
        } else {
            0.0
        };
        let along = |sizes: [f64; 2]| {
            let [inner, outer] = self.segment.bounds.sizes.radii(sizes);
            inner * by_inner + outer * by_outer
        };
        let gradient = [along([1.0, 0.0]), along([0.0, 1.0]), by_length, by_angle];
        Some(std::array::from_fn(|index| gradient[index] * self.segment.axis(index)[1]))
    }

    fn by(&self, state: &State<f64>, parameter: Parameter, counts: &mut Counts) -> Option<f64> {
        counts.derivatives += 1;
        let change = self.actuator.sensitivity(state, &Load::none(), parameter).ok()?;
        Some(match self.segment.motion {
            Motion::Extension => change.axial_stretch * self.geometry.length_m,
            Motion::Expansion => change.outer_radius_m,
            Motion::Bending => change.bend_angle_rad,
            Motion::Twisting => change.twist_rad,
        })
    }
}
