//! The limb of a scene: its modules with their solvers, its base and its kinematics.

use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

use fra_model::{
    Actuator, ActuatorParameters, Arrangement, Fiber, InvalidParameter, Link, Motion, Segment, State, StateQuantity,
    Target,
};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::bend::out_of_plane;
use super::{Bend, StateCurve, chain};
use crate::series::{Wound, bend_of, series};
use crate::statics::{Spring, check_bundles};
use softlimb_fea::cross_section::{BEND_TOLERANCE, BendingLaw, is_wound_bender, largest_bend_error};
use softlimb_scene::collision::Body;
use softlimb_scene::{BendingModel, Located, Module, Scene, SceneError, TrueLimb};

/// By how much a setpoint may be beyond its range: two steps of the wire's coarsest unit, of stretch or rad.
const ROUNDING: f64 = 2e-6;
/// Laws of benders reach this multiple of the module's highest pressure: for overshoot, and for bends beyond the free ones.
const LAW_RATIO: f64 = 1.3;

/// One module: a bundle of equal actuators and the rigid part behind it.
#[derive(Clone, Debug)]
pub struct LimbModule {
    /// Its name in the scene.
    pub name: String,
    /// What its actuators do.
    pub motion: Motion,
    /// What its setpoints mean.
    pub kind: StateQuantity,
    /// The channels of its actuators.
    pub channels: Range<usize>,
    /// Highest gauge pressure the scene allows, Pa.
    pub pressure_max_pa: f64,
    /// Highest gauge pressure the device follows a setpoint to, Pa: it keeps a margin below its limit for the loop.
    pub reference_max_pa: f64,
    /// The solver of one actuator by the analytic model, with the first winding alone where finite elements of the section have the bend
    /// ([`LimbModule::is_by_section`]).
    pub actuator: Actuator<f64>,
    /// Its states over the pressure range. Those of several twisting actuators are of the bundle as its plates hold it back
    /// ([`StateCurve::restrained`]), those of a bending actuator may be by finite elements of the section.
    pub curve: StateCurve,
    bend: Option<Bend>,
    /// Of actuators whose curve is by finite elements of the section, from their first load on; `None` where the section has none.
    law: OnceLock<Option<Arc<BendingLaw>>>,
    second_fiber: Option<Fiber<f64>>,
    pub(crate) segments: Vec<LimbModule>,
    length_m: f64,
    /// Stretches between plates.
    bays: usize,
    arrangement: Arrangement<f64>,
    /// Whether each actuator has its own setpoint.
    steering: bool,
    mount_angle_rad: f64,
    rigid_length_m: f64,
    /// Length and radius of the tool behind the connector, m.
    tool_m: Option<(f64, f64)>,
}

/// A limb that can be asked for its shape.
#[derive(Clone, Debug)]
pub struct Limb {
    base: Isometry3<f64>,
    modules: Vec<LimbModule>,
    /// Module and channels of each drive.
    drives: Vec<(usize, Range<usize>)>,
}

/// Actuators of a module that have one setpoint: all of them, or one of a steering module. As a module it stands for its own.
#[derive(Clone, Debug)]
pub struct Drive<'a> {
    /// Index of its module.
    pub index: usize,
    /// The channels of its actuators.
    pub channels: Range<usize>,
    module: &'a LimbModule,
}

impl Drive<'_> {
    /// The name of its module; of one of a steering module's drives with its number, from 1.
    pub fn name(&self) -> String {
        if self.module.steering {
            format!("{}.{}", self.module.name, self.channels.start - self.module.channels.start + 1)
        } else {
            self.module.name.clone()
        }
    }

    /// Place `[x, y]` of its first actuator's axis, m, with `x` at the mount angle.
    pub fn position_m(&self) -> [f64; 2] {
        let index = self.channels.start - self.module.channels.start;
        self.module.arrangement.position_m(u8::try_from(index).unwrap_or(u8::MAX), self.module.count())
    }
}

impl Deref for Drive<'_> {
    type Target = LimbModule;

    fn deref(&self) -> &LimbModule {
        self.module
    }
}

impl LimbModule {
    /// The setpoint as a target of the inverse model; `None` for a pressure, which needs no inverse.
    pub fn target(&self, value: f64) -> Option<Target<f64>> {
        self.kind.target(value)
    }

    /// The setpoint value of a state.
    pub fn measure(&self, state: &State<f64>) -> f64 {
        self.kind.of(state)
    }

    /// The second winding of its actuators.
    pub fn second_fiber(&self) -> Option<&Fiber<f64>> {
        self.second_fiber.as_ref()
    }

    /// The model of its bend; `None` of straight actuators, and of benders with an ideal winding, which have the analytic one alone.
    pub fn bend(&self) -> Option<Bend> {
        self.bend
    }

    /// Whether the curve of its bending actuators is by finite elements of the section.
    pub fn is_by_section(&self) -> bool {
        self.bend.is_some_and(Bend::is_by_section)
    }

    /// Whether its curve is the model, beside which no solver has the states.
    pub fn is_by_curve(&self) -> bool {
        self.is_restrained() || self.is_by_section() || self.is_series()
    }

    /// One of its actuators as a spring at a gauge pressure, Pa, by the model of its curve; `None` where that has no equilibrium, and of a series.
    pub fn spring(&self, pressure_pa: f64) -> Option<Spring> {
        if self.is_series() {
            return None;
        }
        if !self.is_by_section() {
            return Spring::new(&self.actuator, pressure_pa);
        }
        let spring = Spring::by_section(&self.actuator, self.law()?, pressure_pa)?;
        // The mesh of the curve is finer.
        let is_on_curve = pressure_pa <= self.curve.pressure_max_pa();
        Some(if is_on_curve { spring.about(&self.curve.at(pressure_pa)) } else { spring })
    }

    /// The law of a bender whose curve is by finite elements of the section; `None` for another actuator, or where the section has none.
    pub(crate) fn law(&self) -> Option<&Arc<BendingLaw>> {
        let found = || bending_law(self.actuator.parameters(), self.second_fiber.as_ref(), self.pressure_max_pa);
        (self.is_by_section() && !self.is_series()).then(|| self.law.get_or_init(found).as_ref())?
    }

    /// Setpoint values at rest and at the highest reachable pressure.
    pub fn range(&self) -> (f64, f64) {
        let states = self.curve.states();
        (self.measure(&states[0]), self.measure(&states[states.len() - 1]))
    }

    /// The highest pressure up to which the quantity of its setpoints only rises or only falls, Pa: each value below belongs to one state.
    pub fn single_valued_max_pa(&self) -> f64 {
        let values: Vec<f64> = self.curve.states().iter().map(|state| self.measure(state)).collect();
        let rises = |pair: &[f64]| pair[1] > pair[0];
        let first = values.windows(2).next().is_some_and(rises);
        let turn = values.windows(2).position(|pair| rises(pair) != first || pair[0] == pair[1]);
        let node = turn.unwrap_or(values.len() - 1);
        self.curve.states()[node].pressure_pa
    }

    /// The lower of the highest pressure that the scene allows and the actuator's limit point, gauge Pa.
    pub fn ceiling_pa(&self) -> f64 {
        self.curve.limit_point_pa().map_or(self.pressure_max_pa, |limit| limit.min(self.pressure_max_pa))
    }

    /// The state at a setpoint by the curve; `None` where no pressure of the range gives it. Setpoints that the rounding to wire units
    /// has put beyond an end of the range have the state of that end.
    pub fn state_at(&self, value: f64) -> Option<State<f64>> {
        match self.kind {
            StateQuantity::Pressure => Some(self.curve.at(value)),
            _ => self.curve.find(|state| self.measure(state), value).or_else(|| self.end_at(value)),
        }
    }

    fn end_at(&self, value: f64) -> Option<State<f64>> {
        let states = self.curve.states();
        let near = |state: &&State<f64>| (self.measure(state) - value).abs() <= ROUNDING;
        [states.first()?, states.last()?].into_iter().find(near).copied()
    }

    /// Radius of the module about its centre line in a state, m.
    pub fn radius_m(&self, state: &State<f64>) -> f64 {
        self.reach_m() + state.outer_radius_m
    }

    /// Places of its actuators, with `x` at the mount angle.
    pub fn arrangement(&self) -> Arrangement<f64> {
        self.arrangement
    }

    /// Place `[x, y]` of each actuator's axis, m, with `x` at the mount angle.
    pub fn positions_m(&self) -> Vec<[f64; 2]> {
        self.arrangement.positions_m(self.count()).collect()
    }

    /// Distance of the farthest of its actuators' axes from the module's, m; >= 0.
    pub fn reach_m(&self) -> f64 {
        self.arrangement.reach_m(self.count())
    }

    /// Number of actuators; a scene has at most nine a module.
    fn count(&self) -> u8 {
        u8::try_from(self.channels.len()).unwrap_or(u8::MAX)
    }

    /// Stretches between its plates: one more than its spacers.
    pub fn bays(&self) -> usize {
        self.bays
    }

    /// Length at rest of the part of an actuator that moves, m.
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Distance of its plates at rest, m.
    pub fn bay_m(&self) -> f64 {
        self.length_m / self.bays as f64
    }

    /// Direction it bends towards: rotation about the limb's axis, rad.
    pub fn mount_angle_rad(&self) -> f64 {
        self.mount_angle_rad
    }

    /// Length of the rigid part behind it, m, with what caps take out of the motion.
    pub fn rigid_length_m(&self) -> f64 {
        self.rigid_length_m
    }

    /// Lengths of the rigid parts behind it: connector and tool, m; >= 0.
    pub fn rigid_parts_m(&self) -> [f64; 2] {
        let tool_m = self.tool_m.map_or(0.0, |(length, _)| length);
        [self.rigid_length_m - tool_m, tool_m]
    }

    /// Adds the rigid parts behind the module to a body.
    pub(crate) fn rigid_shape(&self, body: &mut Body) {
        let [connector_m, tool_m] = self.rigid_parts_m();
        body.rigid(connector_m, self.radius_m(&self.curve.states()[0]));
        body.rigid(tool_m, self.tool_m.map_or(0.0, |(_, radius)| radius));
    }

    /// Whether each actuator has its own setpoint: unequal setpoints bend the module.
    pub fn is_steering(&self) -> bool {
        self.steering
    }

    /// Setpoints of the module: one, or one an actuator of a steering module.
    pub fn drives(&self) -> usize {
        if self.steering { self.channels.len() } else { 1 }
    }

    /// The module's link and its radius about its centre line, m, in the next of the limb's states, one a drive; of a series its links. `None`
    /// where there are not enough. `segments` are the states of its segments where they are not those of its model.
    fn formed<'a>(
        &self,
        states: &mut impl Iterator<Item = &'a State<f64>>,
        segments: Option<&Vec<State<f64>>>,
    ) -> Option<Formed> {
        let first = states.next()?;
        if self.is_series() {
            let made = segments.filter(|states| !states.is_empty());
            let own = || self.segment_links(self.segment_states(first));
            return Some((None, made.map_or_else(own, |states| self.segment_links(states.iter().copied()))));
        }
        let one = |link, radius_m| Some((Some((link, radius_m)), Vec::new()));
        if !self.steering {
            return one(self.link(first), self.radius_m(first));
        }
        let own: Vec<&State<f64>> = std::iter::once(first).chain(states.take(self.drives() - 1)).collect();
        let stretches: Vec<f64> = own.iter().map(|state| state.axial_stretch).collect();
        let radius_m = own.iter().map(|state| self.radius_m(state)).fold(0.0, f64::max);
        // A scene has three or more on a circle.
        let (segment, towards_rad) = Segment::of_stretches(self.length_m, self.reach_m(), &stretches)?;
        let mount_angle_rad = self.mount_angle_rad + towards_rad;
        one(Link { segment, mount_angle_rad, rigid_length_m: self.rigid_length_m }, radius_m)
    }

    /// The module's link in a state that all its actuators have.
    ///
    /// # Panics
    /// Of a series, which has several ([`links`](Self::links)).
    pub fn link(&self, state: &State<f64>) -> Link<f64> {
        assert!(!self.is_series(), "a series has a link for each segment");
        let segment = segment_of(self.motion, self.length_m, state);
        Link { segment, mount_angle_rad: self.mount_angle_rad, rigid_length_m: self.rigid_length_m }
    }
}

/// A link with its radius about the centre line, m; or those of a series.
type Formed = (Option<(Link<f64>, f64)>, Vec<(Link<f64>, f64)>);

/// The centre line of an actuator in a state; in the derivative of a state, its derivative.
pub(crate) fn segment_of(motion: Motion, length_m: f64, state: &State<f64>) -> Segment<f64> {
    let [bend_angle_rad, twist_rad] = match motion {
        Motion::Extension | Motion::Expansion => [0.0; 2],
        // Only two different windings twist a bending actuator.
        Motion::Bending => [state.bend_angle_rad, state.twist_rad],
        Motion::Twisting => [0.0, state.twist_rad],
    };
    Segment { length_m: length_m * state.axial_stretch, bend_angle_rad, twist_rad }
}

impl Limb {
    /// Builds the limb of a scene.
    ///
    /// # Errors
    /// A diagnostic at the module whose actuator the model refuses, or whose bending actuators hold each other
    /// ([`check_bundles`](crate::statics::check_bundles)).
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let limb = scene.limb();
        let count = scene.modules().len();
        let mut first_channel = 0;
        let mut modules = Vec::with_capacity(count);
        for (index, module) in scene.modules().iter().enumerate() {
            let tool = limb.end_effector.as_ref().filter(|_| index + 1 == count);
            let tool_m = tool.map(|tool| (tool.length_m, tool.radius_m));
            let channels = first_channel..first_channel + usize::from(module.actuators);
            first_channel = channels.end;
            // What caps take out of the motion is rigid: its own behind a module, and that of the next.
            let next_m = scene.modules().get(index + 1).map_or(0.0, |next| next.end_length_m);
            modules.push(build_module(scene, module, channels, module.end_length_m + next_m, tool_m)?);
        }
        check_bundles(scene, &modules)?;
        let of_module = |(index, module): (usize, &LimbModule)| {
            let channels = module.channels.clone();
            let width = channels.len() / module.drives();
            channels.step_by(width).map(move |at| (index, at..at + width))
        };
        let drives = modules.iter().enumerate().flat_map(of_module).collect();
        let mut base = base_pose(limb.base_position_m, limb.base_direction, limb.base_up);
        if let Some(first) = scene.modules().first().filter(|first| first.end_length_m > 0.0) {
            base *= Translation3::new(0.0, 0.0, first.end_length_m);
        }
        Ok(Self { base, modules, drives })
    }

    /// What has one setpoint, in the order of the channels: as many as there are modules where none steers.
    pub fn drives(&self) -> impl ExactSizeIterator<Item = Drive<'_>> + DoubleEndedIterator {
        (0..self.drives.len()).map(|index| self.drive(index))
    }

    /// One of them.
    ///
    /// # Panics
    /// When there are not as many.
    pub fn drive(&self, index: usize) -> Drive<'_> {
        let (index, channels) = self.drives[index].clone();
        Drive { index, channels, module: &self.modules[index] }
    }

    /// Indices of the drives of a module.
    pub fn drives_of(&self, module: usize) -> Range<usize> {
        let start = self.drives.partition_point(|(index, _)| *index < module);
        start..start + self.modules[module].drives()
    }

    /// Whether a module steers.
    pub fn is_steering(&self) -> bool {
        self.drives.len() > self.modules.len()
    }

    /// A value of each channel, from one of each drive.
    pub fn channel_values<T: Clone>(&self, values: &[T]) -> Vec<T> {
        let drives = self.drives().zip(values);
        drives.flat_map(|(drive, value)| std::iter::repeat_n(value.clone(), drive.channels.len())).collect()
    }

    /// Each module with its link and radius, m, in states, one a drive; a series with each of its links.
    pub(crate) fn links<'a>(
        &self,
        states: impl IntoIterator<Item = &'a State<f64>>,
    ) -> impl Iterator<Item = (&LimbModule, Link<f64>, f64)> {
        self.links_made(states, &[])
    }

    /// The same with the states of the segments of each module, where they are not those of its model.
    pub(crate) fn links_made<'a>(
        &self,
        states: impl IntoIterator<Item = &'a State<f64>>,
        segments: &[Vec<State<f64>>],
    ) -> impl Iterator<Item = (&LimbModule, Link<f64>, f64)> {
        let mut states = states.into_iter();
        let modules = self.modules.iter().enumerate();
        let formed =
            modules.map_while(move |(index, module)| Some((module, module.formed(&mut states, segments.get(index))?)));
        formed.flat_map(|(module, (one, several))| {
            one.into_iter().chain(several).map(move |(link, radius_m)| (module, link, radius_m))
        })
    }

    /// The modules from the base outwards.
    pub fn modules(&self) -> &[LimbModule] {
        &self.modules
    }

    /// Number of channels of all modules.
    pub fn channels(&self) -> usize {
        self.modules.last().map_or(0, |module| module.channels.end)
    }

    /// The parts of uniform winding, from the base outwards: modules, or the segments of a series.
    pub fn parts(&self) -> impl Iterator<Item = &LimbModule> {
        self.modules.iter().flat_map(LimbModule::parts)
    }

    /// Pose of the tip in states, one a drive, in the scene's frame.
    pub fn tip_pose<'a>(&self, states: impl IntoIterator<Item = &'a State<f64>>) -> Isometry3<f64> {
        fra_model::tip_pose(&self.base, self.links(states).map(|(_, link, _)| link))
    }

    /// Pose of the start of the first module, in the scene's frame.
    pub fn base(&self) -> &Isometry3<f64> {
        &self.base
    }

    /// The limb as a solid in states, one a drive. Modules are as thick as their bundle, a connector as the bundle before it at rest.
    pub fn body<'a>(&self, states: impl IntoIterator<Item = &'a State<f64>>) -> Body {
        let mut body = Body::new(&self.base);
        self.shape(states, &mut body);
        body
    }

    /// Makes `body` what [`Limb::body`] gives.
    pub fn shape<'a>(&self, states: impl IntoIterator<Item = &'a State<f64>>, body: &mut Body) {
        chain::shape(&self.base, self.links(states), body);
    }

    /// Position of the tip in states, one a drive, m.
    pub fn tip<'a>(&self, states: impl IntoIterator<Item = &'a State<f64>>) -> [f64; 3] {
        self.tip_pose(states).translation.vector.into()
    }

    /// Points along the centre line from the base to the tip in states, one a drive, m.
    pub fn backbone<'a>(&self, states: impl IntoIterator<Item = &'a State<f64>>) -> Vec<[f64; 3]> {
        chain::backbone(&self.base, self.links(states))
    }
}

fn build_module(
    scene: &Scene,
    module: &Module,
    channels: Range<usize>,
    ends_m: f64,
    tool_m: Option<(f64, f64)>,
) -> Result<LimbModule, SceneError> {
    let refused = |error: InvalidParameter<f64>| {
        scene.diagnostic(module.span, "the model cannot take this actuator", &error.to_string(), None)
    };
    let mut actuator = Actuator::new(&module.actuator()).map_err(refused)?;
    let reference_max_pa = reference_max_pa(*module.pressure_max_pa);
    let (segments, curve, bend) = match series(scene, module, reference_max_pa)? {
        Some((segments, curve)) => {
            let bend = bend_of(&segments);
            (segments, curve, bend)
        }
        None => {
            let (curve, bend) = alone(scene, module, &mut actuator, reference_max_pa)?;
            (Vec::new(), curve, bend)
        }
    };
    let needs_law = segments.is_empty() && bend.is_some_and(Bend::is_by_section);
    let law = law(scene, needs_law, &module.actuator(), (module.second_fiber.as_deref(), module))?;
    let mut built = LimbModule {
        name: module.name.to_string(),
        motion: *module.motion,
        kind: module.setpoint_kind,
        channels,
        pressure_max_pa: *module.pressure_max_pa,
        reference_max_pa,
        curve,
        bend,
        law,
        actuator,
        second_fiber: module.second_fiber.filter(|_| segments.is_empty()).map(|fiber| *fiber),
        segments: Vec::new(),
        length_m: module.moving_length_m(),
        bays: usize::from(module.spacers) + 1,
        arrangement: module.arrangement,
        steering: module.steering,
        mount_angle_rad: module.mount_angle_rad,
        rigid_length_m: ends_m + scene.limb().connector_length_m + tool_m.map_or(0.0, |(length, _)| length),
        tool_m,
    };
    if built.is_restrained() {
        built.curve = built.curve.restrained(&built.actuator, &built.positions_m(), built.bay_m());
    }
    let last = segments.len().saturating_sub(1);
    let described = segments.into_iter().zip(module.segment_modules()).enumerate();
    let parts = described.map(|(index, (wound, described))| part(scene, &built, (index, last), wound, &described));
    built.segments = parts.collect::<Result<_, _>>()?;
    Ok(built)
}

/// A segment of a module, as a module. Only the last segment has the rigid part behind it.
fn part(
    scene: &Scene,
    module: &LimbModule,
    (index, last): (usize, usize),
    wound: Wound,
    described: &Module,
) -> Result<LimbModule, SceneError> {
    let Wound { actuator, curve, bend, second_fiber, bend_direction_rad } = wound;
    let parameters = *actuator.parameters();
    let needs_law = bend.is_some_and(Bend::is_by_section);
    let is_last = index == last;
    Ok(LimbModule {
        name: format!("{}.{}", module.name, index + 1),
        motion: parameters.motion,
        kind: StateQuantity::Pressure,
        law: law(scene, needs_law, &parameters, (second_fiber.as_ref(), described))?,
        actuator,
        curve,
        bend,
        second_fiber,
        length_m: parameters.length_m,
        bays: 1,
        mount_angle_rad: module.mount_angle_rad + bend_direction_rad,
        rigid_length_m: if is_last { module.rigid_length_m } else { 0.0 },
        tool_m: module.tool_m.filter(|_| is_last),
        ..module.clone()
    })
}

/// The bending law of an actuator that needs one. A scene without weight makes it at the first load.
fn law(
    scene: &Scene,
    needs_law: bool,
    actuator: &ActuatorParameters<f64>,
    (second_fiber, described): (Option<&Fiber<f64>>, &Module),
) -> Result<OnceLock<Option<Arc<BendingLaw>>>, SceneError> {
    let law = OnceLock::new();
    if needs_law && scene.weight().is_some() {
        let found = bending_law(actuator, second_fiber, *described.pressure_max_pa);
        if found.is_none() {
            let title = format!("finite elements do not tell how a load bends `{}`", *described.name);
            let help = "`bending = \"analytic\"` in [controller] takes the analytic model, of one winding";
            return Err(scene.diagnostic(described.span, &title, "its section has too few equilibria", Some(help)));
        }
        law.get_or_init(|| found);
    }
    Ok(law)
}

/// The curve of an actuator that is wound alike along its length, and the model of its bend. The actuator gets its second winding where its
/// solver takes it.
fn alone(
    scene: &Scene,
    module: &Module,
    actuator: &mut Actuator<f64>,
    pressure_max_pa: f64,
) -> Result<(StateCurve, Option<Bend>), SceneError> {
    let refused = |error: InvalidParameter<f64>| {
        scene.diagnostic(module.span, "the model cannot take this actuator", &error.to_string(), None)
    };
    Ok(match &module.second_fiber {
        Some(second) if *module.motion == Motion::Bending => {
            (bender_curve(scene, module, second, pressure_max_pa)?, Some(Bend::TwoWindings))
        }
        Some(second) => {
            *actuator = actuator.with_second_fiber(second).map_err(refused)?;
            (StateCurve::new(actuator, pressure_max_pa), None)
        }
        None if *module.motion == Motion::Bending => bend(scene, actuator, pressure_max_pa),
        None => (StateCurve::new(actuator, pressure_max_pa), None),
    })
}

/// The curve of a bending actuator with one winding, and its model.
pub(crate) fn bend(scene: &Scene, actuator: &Actuator<f64>, pressure_max_pa: f64) -> (StateCurve, Option<Bend>) {
    let analytic = StateCurve::new(actuator, pressure_max_pa);
    let parameters = actuator.parameters();
    if !is_wound_bender(parameters) {
        return (analytic, None);
    }
    let error = largest_bend_error(parameters, &analytic.states()[1..]);
    let is_asked = scene.controller().bending == BendingModel::Auto;
    let errs = error.is_none_or(|error| error > BEND_TOLERANCE);
    let by_section = (is_asked && errs).then(|| StateCurve::by_section(parameters, None, pressure_max_pa).ok());
    match by_section.flatten() {
        Some(curve) => (curve, Some(Bend::SectionFe(error))),
        None => (analytic, Some(Bend::Analytic(error))),
    }
}

/// The curve of a bending actuator with two windings.
fn bender_curve(
    scene: &Scene,
    module: &Module,
    second: &Located<Fiber<f64>>,
    pressure_max_pa: f64,
) -> Result<StateCurve, SceneError> {
    let refused = |title: &str, label: &str| scene.diagnostic(second.span, title, label, None);
    let curve = StateCurve::by_section(&module.actuator(), Some(second), pressure_max_pa);
    let curve = curve.map_err(|why| refused("finite elements give this actuator no bend", &why))?;
    let room = match scene.plant().truth {
        TrueLimb::Simple => scene.weight().map(|_| "a limb with `[weight]`"),
        _ => Some("a true body"),
    };
    match room.filter(|_| twists(&curve)) {
        Some(room) => Err(out_of_plane(scene, module, room)),
        None => Ok(curve),
    }
}

/// Whether a bender twists as it bends.
pub(crate) fn twists(curve: &StateCurve) -> bool {
    curve.states().iter().any(|state| state.twist_rad != 0.0)
}

/// The law of a bending actuator by finite elements. It reaches beyond `pressure_max_pa` where the branch does. `None` where the section has none.
pub fn bending_law(
    actuator: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressure_max_pa: f64,
) -> Option<Arc<BendingLaw>> {
    let up_to = |most_pa: f64| BendingLaw::new(actuator, second_fiber, most_pa).ok().flatten();
    up_to(LAW_RATIO * pressure_max_pa).or_else(|| up_to(pressure_max_pa)).map(Arc::new)
}

/// Where a device stops its reference: 3 kPa, at most a tenth, below the limit (`protocol/SPEC.md`, ConfigChannel).
pub fn reference_max_pa(pressure_max_pa: f64) -> f64 {
    pressure_max_pa - f64::min(3e3, 0.1 * pressure_max_pa)
}

/// The frame whose `z` is the direction of the limb and whose `x`, towards which modules bend, is as near to `up` as can be.
pub fn base_pose(position_m: [f64; 3], direction: [f64; 3], up: [f64; 3]) -> Isometry3<f64> {
    let z = Vector3::from(direction).normalize();
    let up = Vector3::from(up);
    let x = (up - z * z.dot(&up)).normalize();
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Isometry3::from_parts(Translation3::from(Vector3::from(position_m)), rotation)
}
