//! Modules whose actuator is a series of segments with different windings: each in its own equilibrium at the common pressure.
//!
//! The state of such a module has the totals: lengths, twists, bends and volumes add up. Its centre line is one arc a segment.

use fra_model::{Actuator, Fiber, Link, Motion, Segment, State};
use softlimb_scene::{Module, ModuleSegment, Scene, SceneError, TrueLimb, WoundActuator};

use crate::limb::{bend, segment_of};
use crate::{Bend, LimbModule, StateCurve};

/// Passes in which all curves of a series come to end at one pressure.
const PASSES: usize = 8;
/// Relative difference of pressures below which two curves end together.
const TOGETHER: f64 = 1e-9;

/// The actuator and the curve that a segment is built from.
pub(crate) struct Wound {
    pub(crate) actuator: Actuator<f64>,
    pub(crate) curve: StateCurve,
    pub(crate) bend: Option<Bend>,
    pub(crate) second_fiber: Option<Fiber<f64>>,
    /// Direction it bends towards, from that of its module, rad.
    pub(crate) bend_direction_rad: f64,
}

impl Wound {
    fn length_m(&self) -> f64 {
        self.actuator.parameters().length_m
    }
}

impl LimbModule {
    /// The segments of its actuator from the base to the tip, each as a module with the channels of this one; none where it is wound alike along
    /// its length.
    pub fn segments(&self) -> &[LimbModule] {
        &self.segments
    }

    /// Whether its actuator is a series of segments.
    pub fn is_series(&self) -> bool {
        !self.segments.is_empty()
    }

    /// Its parts of uniform winding: its segments, or the module itself.
    pub fn parts(&self) -> &[LimbModule] {
        if self.is_series() { &self.segments } else { std::slice::from_ref(self) }
    }

    /// Its links in a state that all its actuators have: one, or one a segment.
    pub fn links(&self, state: &State<f64>) -> Vec<Link<f64>> {
        if !self.is_series() {
            return vec![self.link(state)];
        }
        self.segments.iter().zip(self.segment_states(state)).map(|(segment, state)| segment.link(&state)).collect()
    }

    /// Derivatives by the pressure, 1/Pa, of the centre line and the radius of each of its links.
    pub fn link_slopes(&self, pressure_pa: f64) -> Vec<(Segment<f64>, f64)> {
        let of_part = |part: &LimbModule| {
            let slope = part.curve.slope_at(pressure_pa);
            (segment_of(part.motion, part.length_m(), &slope), slope.outer_radius_m)
        };
        self.parts().iter().map(of_part).collect()
    }

    /// States of its segments at the pressure of a state of the module; none where it is no series.
    pub fn segment_states(&self, state: &State<f64>) -> impl Iterator<Item = State<f64>> {
        self.segments.iter().map(|segment| segment.curve.at(state.pressure_pa))
    }

    /// The links of its segments, each with its radius about the centre line, m, in their states.
    pub(crate) fn segment_links(&self, states: impl Iterator<Item = State<f64>>) -> Vec<(Link<f64>, f64)> {
        self.segments
            .iter()
            .zip(states)
            .map(|(segment, state)| (segment.link(&state), segment.radius_m(&state)))
            .collect()
    }
}

/// Segments and the curve of their totals.
type Series = (Vec<Wound>, StateCurve);

/// The segments of a module and the curve of their totals; no segments of a module without.
///
/// # Errors
/// A diagnostic at the segment that the model refuses, and at the second one of a limb whose truth is a body.
pub(crate) fn series(scene: &Scene, module: &Module, pressure_max_pa: f64) -> Result<Option<Series>, SceneError> {
    if module.segments.is_empty() {
        return Ok(None);
    }
    if scene.plant().truth != TrueLimb::Simple {
        scene.require_no_segments("a true body")?;
    }
    let mut reach_pa = pressure_max_pa;
    let mut limit_pa: Option<f64> = None;
    for _ in 0..PASSES {
        let wound = module.segment_actuators();
        let made = module.segments.iter().zip(wound).map(|(segment, wound)| build(scene, segment, &wound, reach_pa));
        let segments = made.collect::<Result<Vec<_>, _>>()?;
        let limits = segments.iter().filter_map(|segment| segment.curve.limit_point_pa());
        limit_pa = limits.chain(limit_pa).reduce(f64::min);
        let ends = segments.iter().map(|segment| segment.curve.pressure_max_pa());
        let end_pa = ends.fold(f64::INFINITY, f64::min);
        if segments.iter().all(|one| one.curve.pressure_max_pa() - end_pa <= TOGETHER * end_pa) {
            let curve = total(&segments).map(|curve| curve.with_limit_point(limit_pa));
            return curve.map(|curve| Some((segments, curve))).ok_or_else(|| unsolved(scene, module));
        }
        reach_pa = end_pa;
    }
    Err(unsolved(scene, module))
}

fn unsolved(scene: &Scene, module: &Module) -> SceneError {
    let title = format!("the segments of `{}` have no common range of pressures", *module.name);
    scene.diagnostic(module.span, &title, "in this module", Some("lower its `pressure_max`"))
}

fn build(
    scene: &Scene,
    segment: &ModuleSegment,
    (parameters, second_fiber): &WoundActuator,
    pressure_max_pa: f64,
) -> Result<Wound, SceneError> {
    let refused = |error: &dyn std::fmt::Display| {
        scene.diagnostic(segment.span, "the model cannot take this segment", &error.to_string(), None)
    };
    let mut actuator = Actuator::new(parameters).map_err(|error| refused(&error))?;
    let (curve, bend) = match second_fiber {
        Some(second) if parameters.motion == Motion::Bending => {
            let curve = StateCurve::by_section(parameters, Some(second), pressure_max_pa);
            (curve.map_err(|why| refused(&why))?, Some(Bend::TwoWindings))
        }
        Some(second) => {
            actuator = actuator.with_second_fiber(second).map_err(|error| refused(&error))?;
            (StateCurve::new(&actuator, pressure_max_pa), None)
        }
        None if parameters.motion == Motion::Bending => bend(scene, &actuator, pressure_max_pa),
        None => (StateCurve::new(&actuator, pressure_max_pa), None),
    };
    Ok(Wound { actuator, curve, bend, second_fiber: *second_fiber, bend_direction_rad: segment.bend_direction_rad })
}

/// The curve of the totals.
fn total(segments: &[Wound]) -> Option<StateCurve> {
    let first = &segments.first()?.curve;
    let count = segments.iter().map(|segment| segment.curve.states().len()).min()?;
    let at = |node: usize| {
        State::in_series(segments.iter().map(|segment| (segment.length_m(), segment.curve.states()[node])))
    };
    let states: Option<Vec<_>> = (0..count).map(at).collect();
    Some(first.with_states(states.filter(|states| states.len() > 1)?))
}

/// The model of the bend of a series: the coarsest of its segments.
pub(crate) fn bend_of(segments: &[Wound]) -> Option<Bend> {
    let bends = || segments.iter().filter_map(|segment| segment.bend);
    let analytic = || bends().reduce(|a, b| if a.analytic_error() < b.analytic_error() { b } else { a });
    bends().find(|bend| bend.is_by_section()).or_else(analytic)
}
