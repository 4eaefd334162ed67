//! A scene as checked data in SI units.

mod corrections;
mod design;
mod limb;
mod motion;
mod plant;
mod task;
mod thread;
mod winding;

pub use corrections::{CorrectionRow, Corrections, PhaseCorrections, PhaseTimes};
pub use design::{Bounds, Choice, Design, ModuleBounds};
pub use limb::{EndEffector, Limb, Module, ModuleSegment, WoundActuator};
pub use motion::{
    BendingModel, Camera, Controller, Excess, Goal, Imu, InverseChoice, Limits, LinkLoss, MarginLimits, Phase,
    PressureLoop, Shaping, Swing, Target, Weight,
};
pub use plant::{Ambient, BodyEffects, Chamber, Line, Plant, Sensor, Spread, Supply, TrueLimb, Valve};
pub use task::{Aim, Gripper, Marker, Object, Obstacle, Region};
pub use thread::{Thread, WoundWall};

use super::error::{Problem, Problems, SceneError};
use super::source::{Located, Source, Span};

/// Time that a gripper takes to close where no end effector states one, s.
const GRIPPER_TIME_S: f64 = 0.3;

/// A checked scene. There is no way to have one but [`parse`](super::parse) and [`load`](super::load).
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub(super) source: Source,
    pub(super) name: String,
    pub(super) description: String,
    pub(super) seed: u64,
    pub(super) limb: Limb,
    pub(super) modules: Vec<Module>,
    pub(super) phases: Vec<Phase>,
    pub(super) markers: Option<Located<Vec<Marker>>>,
    pub(super) corrections: Option<Located<PhaseCorrections>>,
    pub(super) obstacles: Vec<Obstacle>,
    pub(super) regions: Vec<Region>,
    pub(super) objects: Vec<Object>,
    pub(super) design: Option<Design>,
    pub(super) limits: Limits,
    pub(super) controller: Controller,
    pub(super) weight: Weight,
    pub(super) swing: Swing,
    pub(super) camera: Option<Camera>,
    pub(super) imu: Option<Imu>,
    pub(super) plant: Plant,
}

impl Scene {
    /// Name: a letter, then letters, digits, `-` or `_`, at most 32 in all; safe as the name of a folder.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Purpose of the scene, in its author's words; may be empty.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Seed of everything random in the simulated plant.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Base, connectors and end effector.
    pub fn limb(&self) -> &Limb {
        &self.limb
    }

    /// Modules from the base to the tip, 1 to 27.
    pub fn modules(&self) -> &[Module] {
        &self.modules
    }

    /// Phases in order of time, at least one. A scene with a marker series has two: the way to its first position, and the series.
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// The marker series, located at the name of its file: at least two, by rising time from 0.
    pub fn markers(&self) -> Option<&Located<Vec<Marker>>> {
        self.markers.as_ref()
    }

    /// Corrections of the planned setpoints in a run, located at the name of its file.
    pub fn corrections(&self) -> Option<&Located<PhaseCorrections>> {
        self.corrections.as_ref()
    }

    /// Solids that the limb keeps clear of.
    pub fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// The boxes that phases may name.
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The things that phases may carry.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Bounds of a design; `None` where the scene leaves nothing open.
    pub fn design(&self) -> Option<&Design> {
        self.design.as_ref()
    }

    /// Bounds that hold for all modules.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Settings of the pressure controller.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Effect of weight in a run; `None` where it is neither simulated nor compensated.
    pub fn weight(&self) -> Option<&Weight> {
        Some(&self.weight).filter(|weight| weight.simulated || weight.compensated)
    }

    /// Whether the simulated limb carries neither its own weight nor a payload; all figures of it are labelled so.
    pub fn weightless(&self) -> bool {
        !self.weight.simulated
    }

    /// Swing after moves.
    pub fn swing(&self) -> &Swing {
        &self.swing
    }

    /// The camera that observes the tip; `None` where the scene states none.
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// The IMUs on the end plates of the modules; `None` where the scene states none.
    pub fn imu(&self) -> Option<&Imu> {
        self.imu.as_ref()
    }

    /// The pneumatics.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The same scene with a mass on the tip in all phases, kg, 0 to 100, whatever the gripper does; the simulated limb carries its weight
    /// and the mass, and setpoints are corrected for both or for nothing.
    pub fn carrying(&self, payload_kg: f64, compensated: bool) -> Self {
        let mut scene = self.clone();
        for phase in &mut scene.phases {
            (phase.payload_kg, phase.gripper) = (payload_kg, None);
        }
        (scene.weight.simulated, scene.weight.compensated) = (true, compensated);
        scene
    }

    /// Number of channels, the sum of the modules' actuators, 1 to 27.
    pub fn channels(&self) -> usize {
        self.modules.iter().map(|module| usize::from(module.actuators)).sum()
    }

    /// Length of the limb at rest from its base to its tip, m.
    pub fn rest_length_m(&self) -> f64 {
        let modules: f64 = self.modules.iter().map(|m| *m.length_m + self.limb.connector_length_m).sum();
        modules + self.limb.end_effector.as_ref().map_or(0.0, |tool| tool.length_m)
    }

    /// Time that the gripper takes to close, and to open, s; without an end effector that of a common one.
    pub fn gripper_time_s(&self) -> f64 {
        self.limb.end_effector.as_ref().map_or(GRIPPER_TIME_S, |tool| tool.gripper_time_s)
    }

    /// Mass of elastomer, spacers, connectors and end effector, kg. Fibers, tubes and air are not counted.
    pub fn mass_kg(&self) -> f64 {
        let modules: f64 = self.modules.iter().map(|m| m.mass_kg() + self.limb.connector_mass_kg).sum();
        modules + self.limb.end_effector.as_ref().map_or(0.0, |tool| tool.mass_kg)
    }

    /// Time of all holds, and of the moves whose time is given, microseconds.
    pub fn duration_us(&self) -> u64 {
        self.phases.iter().map(|phase| phase.move_us.map_or(0, |time| *time) + phase.hold_us).sum()
    }

    /// The text the scene was parsed from.
    pub fn source_text(&self) -> &str {
        &self.source.text
    }

    /// The name the scene was parsed under: its path, for a file.
    pub fn source_name(&self) -> &str {
        &self.source.name
    }

    /// FNV-1a (64 bits) of [`source_text`](Self::source_text), to recognize the scene in logs and reports.
    pub fn source_hash(&self) -> u64 {
        self.source.hash()
    }

    /// Line and column of a place, both from 1.
    pub fn position(&self, span: Span) -> (usize, usize) {
        self.source.position(span.range().start)
    }

    /// A diagnostic of another room at a place of this scene: what is wrong, what the underlined text has to do with it, and what to do.
    pub fn diagnostic(&self, span: Span, title: &str, label: &str, help: Option<&str>) -> SceneError {
        let problem = Problem::at(span, title, label);
        let problem = match help {
            Some(text) => problem.help(text),
            None => problem,
        };
        SceneError::Invalid(Problems::new(self.source.clone(), vec![problem]))
    }
}
