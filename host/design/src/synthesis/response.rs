//! What a section does between rest and the highest pressure it may be given.
//!
//! A module's deformation is written as a share `u` of what its section reaches: of the stretch, the outer radius, the bend or the twist
//! between rest (0) and the cap (1). The cap is the highest pressure, the margin below the limit point, or where the deformation turns back. As a function of the deformation, and not of the pressure, the state stays
//! smooth up to a limit point.

use fra_model::{Motion, State};

use super::task::Space;
use crate::actuators::{Candidate, Counts, Elements, Geometry, errs};

/// Length, bend and twist of the bundle per length of the actuators at rest (1, rad/m, rad/m), outer radius of an actuator (m) and gauge
/// pressure (Pa).
pub(super) const FIELDS: usize = 5;
/// Index of the outer radius.
pub(super) const RADIUS: usize = 3;
/// Index of the pressure.
pub(super) const PRESSURE: usize = 4;

/// Pressures at which a deformation that turns back is looked for.
const SCANNED: usize = 32;

fn what(geometry: &Geometry, reason: &str) -> String {
    format!(
        "inner radius {:.3} mm, outer radius {:.3} mm, fiber angle {:.2} deg: {reason}",
        geometry.inner_radius_m * 1e3,
        geometry.outer_radius_m * 1e3,
        geometry.angle_rad.to_degrees()
    )
}

/// A section with the two ends of its range.
pub(super) struct Section<'a> {
    pub(super) candidate: Candidate<'a>,
    /// The bender by finite elements of its section, where the analytic bend may err by more than is accepted.
    elements: Option<Elements>,
    reach_m: f64,
    rest: State<f64>,
    end: State<f64>,
}

impl<'a> Section<'a> {
    /// `place` is that of the geometry in its unit box. The error says why there is no such section.
    pub(super) fn new(space: &'a Space, place: &[f64; 4]) -> Result<Self, String> {
        let section = Self::analytic(space, place)?;
        if section.errs() { section.with_elements() } else { Ok(section) }
    }

    /// Whether the analytic bend may err by more than is accepted.
    pub(super) fn errs(&self) -> bool {
        errs(&self.candidate, self.end.pressure_pa)
    }

    /// The same bender by finite elements.
    pub(super) fn with_elements(self) -> Result<Self, String> {
        let elements = Elements::new(&self.candidate)
            .map_err(|reason| self.what(&format!("finite elements do not bend it: {reason}")))?;
        let ends = elements.at(0.0).zip(elements.at(elements.cap_pa));
        let (rest, end) = ends.ok_or_else(|| self.what("no equilibrium at its highest pressure"))?;
        Ok(Self { elements: Some(elements), rest, end, ..self })
    }

    fn what(&self, reason: &str) -> String {
        what(&self.candidate.geometry, reason)
    }

    /// The same by the analytic model alone.
    pub(super) fn analytic(space: &'a Space, place: &[f64; 4]) -> Result<Self, String> {
        let geometry = space.segment.geometry(place);
        let what = |reason: &str| what(&geometry, reason);
        if let Err(error) = space.segment.actuator(&geometry) {
            return Err(what(&error.to_string()));
        }
        let candidate = Candidate::new(&space.segment, place).ok_or_else(|| what("the model refuses it"))?;
        let counts = &mut Counts::default();
        let cap = candidate.cap(counts).ok_or_else(|| what("its limit point is not found"))?;
        let end =
            candidate.at(cap.pressure_pa, counts).ok_or_else(|| what("no equilibrium at its highest pressure"))?;
        let rest = candidate.actuator.rest();
        let mut section = Self { rest, candidate, elements: None, reach_m: space.reach_m, end };
        if section.states(&[0.25, 0.5, 0.75]).is_none() {
            section.end = section.before_turning(cap.pressure_pa);
        }
        Ok(section)
    }

    /// The state at a pressure; `None` beyond the highest one.
    pub(super) fn at(&self, pressure_pa: f64) -> Option<State<f64>> {
        match &self.elements {
            Some(elements) => elements.at(pressure_pa),
            None => self.candidate.at(pressure_pa, &mut Counts::default()),
        }
    }

    /// The state without pressure.
    pub(super) fn rest(&self) -> &State<f64> {
        &self.rest
    }

    fn inverse(&self, value: f64) -> Option<State<f64>> {
        match &self.elements {
            Some(elements) => elements.bent(value),
            None => self.candidate.inverse(value, &mut Counts::default()),
        }
    }

    /// The last of evenly spaced states up to which the deformation goes one way.
    fn before_turning(&self, pressure_pa: f64) -> State<f64> {
        let measure = |state: &State<f64>| self.candidate.measure(state);
        let mut last = self.rest;
        let mut way = 0.0;
        for index in 1..=SCANNED {
            let share = index as f64 / SCANNED as f64;
            let Some(state) = self.at(pressure_pa.min(self.end.pressure_pa) * share) else { break };
            let change = measure(&state) - measure(&last);
            if change * way < 0.0 {
                break;
            }
            (way, last) = (change, state);
        }
        last
    }

    /// The highest gauge pressure, Pa.
    pub(super) fn cap_pa(&self) -> f64 {
        self.end.pressure_pa
    }

    /// Distance of the farthest actuator from the module's axis, m.
    pub(super) fn reach_m(&self) -> f64 {
        self.reach_m
    }

    /// The motion.
    pub(super) fn motion(&self) -> Motion {
        self.candidate.actuator.parameters().motion
    }

    /// The deformation, as eq. (14) measures it, at a share of the range; m or rad.
    pub(super) fn deformation(&self, share: f64) -> f64 {
        let [rest, end] = [self.rest, self.end].map(|state| self.candidate.measure(&state));
        rest + share * (end - rest)
    }

    /// The state at a share of the range.
    pub(super) fn state(&self, share: f64) -> Option<State<f64>> {
        let [rest, end] = [self.rest, self.end].map(|state| self.candidate.measure(&state));
        if share <= 0.0 || (end - rest).abs() <= 1e-9 * end.abs() {
            return self.at(share.max(0.0) * self.end.pressure_pa);
        }
        if share >= 1.0 {
            return Some(self.end);
        }
        let state = self.inverse(self.deformation(share))?;
        (state.pressure_pa > -1e-6 && state.pressure_pa <= self.end.pressure_pa * (1.0 + 1e-9)).then_some(state)
    }

    /// The states at rising shares; `None` unless the pressure rises with them.
    fn states(&self, shares: &[f64]) -> Option<Vec<State<f64>>> {
        let states = shares.iter().map(|share| self.state(*share)).collect::<Option<Vec<_>>>()?;
        states.windows(2).all(|pair| pair[0].pressure_pa <= pair[1].pressure_pa).then_some(states)
    }

    /// The fields at shares of the range, which rise.
    pub(super) fn fields(&self, shares: &[f64]) -> Result<Vec<[f64; FIELDS]>, String> {
        let states = self.states(shares).ok_or_else(|| {
            let parameters = self.candidate.actuator.parameters();
            format!("the deformation does not rise with the pressure: {parameters:?}")
        })?;
        Ok(states.iter().map(|state| self.of(state)).collect())
    }

    /// The fields of a state.
    pub(super) fn of(&self, state: &State<f64>) -> [f64; FIELDS] {
        let length_m = self.candidate.geometry.length_m;
        let (bend, twist) = (state.bend_angle_rad / length_m, state.twist_rad / length_m);
        let (length, bend, twist) = match self.motion() {
            Motion::Extension | Motion::Expansion => (state.axial_stretch, 0.0, 0.0),
            Motion::Bending => (state.axial_stretch, bend, 0.0),
            Motion::Twisting => (state.axial_stretch, 0.0, twist),
        };
        [length, bend, twist, state.outer_radius_m, state.pressure_pa]
    }
}
