//! Base, connectors, modules.

use fra_model::{ActuatorParameters, Arrangement, Fiber, Material, Motion, StateQuantity};

use super::{ModuleBounds, Thread};
use crate::source::{Located, Span};

/// The rigid parts of a limb and where it starts.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limb {
    /// Start of the first module, m.
    pub base_position_m: [f64; 3],
    /// Unit vector along the first module's axis.
    pub base_direction: [f64; 3],
    /// Unit vector, normal to `base_direction`, towards which a bending module with mount angle 0 bends.
    pub base_up: [f64; 3],
    /// Length of the connector at the far end of every module, m; >= 0.
    pub connector_length_m: f64,
    /// Mass of one connector, kg; >= 0.
    pub connector_mass_kg: f64,
    /// Tool on the last connector.
    pub end_effector: Option<EndEffector>,
}

/// The tool on the last connector.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EndEffector {
    /// Name.
    pub name: String,
    /// Distance from the last connector to the tip, m; >= 0.
    pub length_m: f64,
    /// Radius about its axis, m; >= 0.
    pub radius_m: f64,
    /// Mass, kg; >= 0.
    pub mass_kg: f64,
    /// Time that its gripper takes to close, and to open, s; 0 to 10.
    pub gripper_time_s: f64,
}

/// An actuator and its second winding.
pub type WoundActuator = (ActuatorParameters<f64>, Option<Fiber<f64>>);

/// A bundle of equal actuators in parallel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Module {
    /// Name, unique in the scene.
    pub name: Located<String>,
    /// The motion its actuators are wound for.
    pub motion: Located<Motion>,
    /// Number of actuators, each with its own channel; 1 to 9.
    pub actuators: u8,
    /// Places of the actuators on the connector, seen with `x` at the mount angle.
    pub arrangement: Arrangement<f64>,
    /// Whether each actuator has its own setpoint. Such a module has three or more extending actuators on a circle.
    pub steering: bool,
    /// Rotation about the limb's axis, rad.
    pub mount_angle_rad: f64,
    /// Plates between its connectors, 0 to 50.
    pub spacers: u8,
    /// Mass of one of them, kg; 0 to 5.
    pub spacer_mass_kg: f64,
    /// Inner radius at rest, m; > 0.
    pub inner_radius_m: Located<f64>,
    /// Outer radius at rest, m; > inner radius.
    pub outer_radius_m: Located<f64>,
    /// Length at rest, m; > 0. Of a series that of its segments together.
    pub length_m: Located<f64>,
    /// Length at each end that its cap takes out of the motion, m; >= 0, less than half of the length.
    pub end_length_m: f64,
    /// The elastomer, located at its name in the module.
    pub material: Located<Material<f64>>,
    /// Largest stretch of the test behind the elastomer's law, where it is known.
    pub stretch_max: Option<f64>,
    /// Density of the elastomer, kg/m3.
    pub density_kg_per_m3: f64,
    /// Segments of different winding from the base to the tip: two or more, of one actuator, or none.
    pub segments: Vec<ModuleSegment>,
    /// The winding, located at its name in the module; of a series that of its first segment with the module's motion.
    pub fiber: Option<Located<Fiber<f64>>>,
    /// The thread that the winding is made of, where the scene states it.
    pub thread: Option<Thread>,
    /// The second winding, located at its name in the module.
    pub second_fiber: Option<Located<Fiber<f64>>>,
    /// The thread that the second winding is made of, where the scene states it.
    pub second_thread: Option<Thread>,
    /// Largest gauge pressure in its chambers, Pa; located in the module or in `[limits]`.
    pub pressure_max_pa: Located<f64>,
    /// The quantity its targets are given in, the same in all phases; the natural one of its motion if no phase has a target for it.
    pub setpoint_kind: StateQuantity,
    /// The header of its table.
    pub span: Span,
}

/// A segment of an actuator that is wound differently along its length. Wall and chamber are those of its module.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModuleSegment {
    /// The motion it is wound for.
    pub motion: Located<Motion>,
    /// Length at rest, m; > 0.
    pub length_m: Located<f64>,
    /// Direction it bends towards, from that of its module, rad.
    pub bend_direction_rad: f64,
    /// The winding, located at its name in the segment.
    pub fiber: Option<Located<Fiber<f64>>>,
    /// The thread that the winding is made of, where the scene states it.
    pub thread: Option<Thread>,
    /// The second winding, located at its name in the segment.
    pub second_fiber: Option<Located<Fiber<f64>>>,
    /// The thread that the second winding is made of, where the scene states it.
    pub second_thread: Option<Thread>,
    /// Bounds of its length and its fiber angle in a design; none of its radii, which are those of the module.
    pub bounds: ModuleBounds,
    /// The header of its table.
    pub span: Span,
}

impl Module {
    /// A module for each segment, as it is made, with the motion, length, winding and direction of the segment.
    pub fn segment_modules(&self) -> Vec<Self> {
        let alone = |segment: &ModuleSegment| Self {
            motion: segment.motion,
            mount_angle_rad: self.mount_angle_rad + segment.bend_direction_rad,
            length_m: segment.length_m,
            end_length_m: 0.0,
            segments: Vec::new(),
            fiber: segment.fiber,
            thread: segment.thread,
            second_fiber: segment.second_fiber,
            second_thread: segment.second_thread,
            span: segment.span,
            ..self.clone()
        };
        self.segments.iter().map(alone).collect()
    }

    /// What has one winding along its length: its segments, each as a module, or the module.
    pub fn parts(&self) -> Vec<Self> {
        if self.segments.is_empty() { vec![self.clone()] } else { self.segment_modules() }
    }

    /// The segments of its actuator as [`actuator`](Self::actuator), each with its second winding, from the base to the tip; none of a module
    /// without segments. The end caps take from the first and the last.
    pub fn segment_actuators(&self) -> Vec<WoundActuator> {
        let last = self.segments.len().saturating_sub(1);
        let moving = |(index, segment): (usize, &ModuleSegment)| {
            let ends = f64::from(u8::from(index == 0)) + f64::from(u8::from(index == last));
            let actuator = ActuatorParameters {
                motion: *segment.motion,
                length_m: *segment.length_m - ends * self.end_length_m,
                fiber: segment.fiber.map(|fiber| *fiber),
                ..self.made_actuator()
            };
            (actuator, segment.second_fiber.map(|fiber| *fiber))
        };
        self.segments.iter().enumerate().map(moving).collect()
    }

    /// One of its actuators, for the model: as long as the part that moves, without a second winding. The parameters pass the model's own
    /// check.
    pub fn actuator(&self) -> ActuatorParameters<f64> {
        ActuatorParameters { length_m: self.moving_length_m(), ..self.made_actuator() }
    }

    /// One of its actuators as [`actuator`](Self::actuator), with its second winding.
    pub fn wound_actuator(&self) -> WoundActuator {
        (self.actuator(), self.second_fiber.map(|fiber| *fiber))
    }

    /// Length at rest that moves: between what the end caps take, m; > 0.
    pub fn moving_length_m(&self) -> f64 {
        *self.length_m - 2.0 * self.end_length_m
    }

    /// One of its actuators from cap to cap, as it is made, without a second winding.
    pub fn made_actuator(&self) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion: *self.motion,
            inner_radius_m: *self.inner_radius_m,
            outer_radius_m: *self.outer_radius_m,
            length_m: *self.length_m,
            material: *self.material,
            fiber: self.fiber.map(|fiber| *fiber),
        }
    }

    /// Place `[x, y]` of each actuator's axis on the connector, m, with `x` at the mount angle.
    pub fn positions_m(&self) -> Vec<[f64; 2]> {
        self.arrangement.positions_m(self.actuators).collect()
    }

    /// Distance from the connector's center to the farthest of its actuators' axes, m; >= 0.
    pub fn reach_m(&self) -> f64 {
        self.arrangement.reach_m(self.actuators)
    }

    /// Mass of the walls of its actuators, kg.
    pub fn elastomer_mass_kg(&self) -> f64 {
        let (inner, outer) = (*self.inner_radius_m, *self.outer_radius_m);
        let section = std::f64::consts::PI * (outer - inner) * (outer + inner);
        f64::from(self.actuators) * section * *self.length_m * self.density_kg_per_m3
    }

    /// A mass that is spread along it, kg, by what has one winding along its length, from the base to the tip.
    pub fn spread_kg(&self, kg: f64) -> Vec<f64> {
        if self.segments.is_empty() {
            return vec![kg];
        }
        self.segments.iter().map(|segment| kg * *segment.length_m / *self.length_m).collect()
    }

    /// Mass of its spacers, kg.
    pub fn spacers_mass_kg(&self) -> f64 {
        f64::from(self.spacers) * self.spacer_mass_kg
    }

    /// Mass between its connectors, kg: walls and spacers.
    pub fn mass_kg(&self) -> f64 {
        self.elastomer_mass_kg() + self.spacers_mass_kg()
    }
}
