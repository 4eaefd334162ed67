//! Phases, limits and control.

use fra_model::StateQuantity;

use super::{Aim, Gripper};
use crate::source::{Located, Span};

/// Goal of one module.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Target {
    /// Index of the module in [`Scene::modules`](super::Scene::modules).
    pub module: usize,
    /// The quantity; the module's [`setpoint_kind`](super::Module::setpoint_kind).
    pub kind: StateQuantity,
    /// Its value in SI units.
    pub value: Located<f64>,
}

/// Goal of a phase at the end of its move.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// These modules change, all others keep what they have; in the order of the modules, each at most once.
    Targets(Vec<Target>),
    /// The tip reaches this point, m.
    Tip(Located<[f64; 3]>),
    /// The tip is in a region: its index in [`Scene::regions`](super::Scene::regions).
    Inside(Located<usize>),
    /// The tip follows the marker series, [`Scene::markers`](super::Scene::markers), from its first position on.
    Series(Span),
}

/// A move and the pause after it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Phase {
    /// Name, unique in the scene.
    pub name: Located<String>,
    /// Time of the move, microseconds; > 0. `None`: the shortest that is feasible.
    pub move_us: Option<Located<u64>>,
    /// Time of the pause, microseconds.
    pub hold_us: u64,
    /// Mass that the tip carries, kg; >= 0.
    pub payload_kg: f64,
    /// The object that this mass is: its index in [`Scene::objects`](super::Scene::objects).
    pub object: Option<usize>,
    /// Goal of the move.
    pub goal: Goal,
    /// Direction of the end effector at the end of the move; only with a goal of the tip.
    pub aim: Option<Aim>,
    /// Command to the gripper at the end of the move.
    pub gripper: Option<Gripper>,
    /// The header of its table.
    pub span: Span,
}

/// Bounds that hold for all modules.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Largest gauge pressure in a chamber unless its module says otherwise, Pa.
    pub pressure_max_pa: Located<f64>,
    /// Least distance of the limb from every obstacle, m; >= 0.
    pub clearance_m: f64,
    /// Smallest gauge pressure of the supply, Pa.
    pub supply_min_pa: f64,
    /// Largest gauge pressure of the supply, Pa; > `supply_min_pa`.
    pub supply_max_pa: f64,
    /// Lowest voltage of the valves' supply, V; `None` if it is not watched.
    pub valve_voltage_min_v: Option<Located<f64>>,
    /// Largest rate of an axial stretch, 1/s.
    pub stretch_rate_max_per_s: Option<f64>,
    /// Largest rate of a radius, m/s.
    pub radius_rate_max_m_per_s: Option<f64>,
    /// Largest rate of a bend angle or twist, rad/s.
    pub angle_rate_max_rad_per_s: Option<f64>,
    /// Margins of the limb under weight.
    pub standing: MarginLimits,
}

/// Margins that a limb under weight should keep in every pose: without its payload, with half and with all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginLimits {
    /// Least load factor; 1..4.
    pub load_factor: f64,
    /// Least vertical stiffness of the tip, N/m; >= 0.
    pub stiffness_n_per_m: f64,
    /// Largest sag over the length at rest; > 0.
    pub sag_share: f64,
    /// Least buckling margin of a tube; >= 1.
    pub buckling_margin: f64,
    /// Highest pressure over the lower of the scene's limit and the limit point; 0..1.
    pub pressure_share: f64,
}

/// Effect of the limb's own weight and the payloads in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Weight {
    /// Whether the simulated limb carries them.
    pub simulated: bool,
    /// Whether setpoints are corrected for them.
    pub compensated: bool,
    /// Error of the tip that the correction's statics may have, as a share of the limb's length; > 0.
    pub error: f64,
}

/// How moves are shaped against swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shaping {
    /// Not at all.
    None,
    /// Zero vibration.
    ZeroVibration,
    /// Zero vibration, and zero derivative of it by the frequency.
    ZeroDerivative,
    /// A smooth course as long as with `ZeroDerivative`, adapted to all vibrations.
    Adapted,
}

/// What becomes of a move with too much swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Excess {
    /// It is refused.
    Refuse,
    /// It takes longer.
    Stretch,
}

/// Swing of the limb under weight after its moves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Swing {
    /// Loss factor of the elastomer; 0 to 0.5.
    pub loss_factor: f64,
    /// How moves are shaped; without effect on a limb whose setpoints are not corrected for weight.
    pub shaping: Shaping,
    /// Largest swing of the tip after a move, m; > 0.
    pub residual_max_m: Option<Located<f64>>,
    /// What becomes of a move with more.
    pub excess: Excess,
}

/// A camera that observes the tip of the simulated limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Whether runs correct their setpoints by its images.
    pub feedback: bool,
    /// Least time between two images, s; > 0.
    pub period_s: f64,
    /// Time from an image to the position that it gives, s; >= 0.
    pub latency_s: f64,
    /// Standard deviation of a coordinate in one image, m; >= 0.
    pub noise_m: f64,
    /// Standard deviation of the constant error of its calibration in a coordinate, m; >= 0.
    pub offset_m: f64,
    /// Share of the images in which the tip is not found; 0 to 0.95.
    pub drop_outs: f64,
}

/// An inertial measurement unit on the end plate of each module of the simulated limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imu {
    /// Whether runs correct their setpoints by the orientations.
    pub feedback: bool,
    /// Least time between two readings, s; > 0.
    pub period_s: f64,
    /// Time from a reading to its arrival, s; >= 0.
    pub latency_s: f64,
    /// Standard deviation of the constant error of an orientation about a horizontal axis, rad; >= 0.
    pub tilt_error_rad: f64,
    /// The same about the vertical, rad; >= 0.
    pub heading_error_rad: f64,
    /// Standard deviation of an orientation about each axis in one reading, rad; >= 0.
    pub noise_rad: f64,
    /// Standard deviation of an angular rate about each axis in one reading, rad/s; >= 0.
    pub rate_noise_rad_per_s: f64,
    /// Share of the readings that are lost; 0 to 0.95.
    pub drop_outs: f64,
}

/// Reaction of the controller to a silent host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkLoss {
    /// Hold the pressures for a while, then ramp them down.
    HoldThenRamp,
    /// Hold the pressures.
    Hold,
    /// Vent at once.
    Vent,
}

/// Inverse of the controller, from a deformation to a pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InverseChoice {
    /// In tables where their verified error is within the bound, by the model elsewhere.
    Auto,
    /// In tables, or not at all.
    Table,
    /// By the model.
    Model,
}

/// Model of bending modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BendingModel {
    /// Finite elements of the section for a module whose analytic bend errs by more than is accepted, else the analytic model.
    Auto,
    /// The analytic one.
    Analytic,
    /// The analytic one, with inverse tables by a cubic fitted to the finite elements of the section.
    SectionFe,
}

/// How the controller makes pressures follow their setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PressureLoop {
    /// Predicted pulses.
    Pulses,
    /// PI controller with feed-forward.
    ProportionalIntegral,
    /// Valves on or off beyond a dead band.
    OnOff,
}

/// Settings of the pressure controller.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Controller {
    /// Time between two streamed setpoints, microseconds.
    pub knot_period_us: u32,
    /// Period of the valve pulses, microseconds; whole milliseconds.
    pub control_period_us: u32,
    /// Time between two telemetry messages, microseconds; whole milliseconds.
    pub telemetry_period_us: u32,
    /// Silence of the host after which the link counts as lost, microseconds.
    pub link_timeout_us: u32,
    /// Time that pressures are held before they ramp down, microseconds.
    pub hold_time_us: u32,
    /// Reaction to a lost link.
    pub link_loss: LinkLoss,
    /// Rate at which pressures ramp down, Pa/s; > 0.
    pub vent_ramp_pa_per_s: f64,
    /// Pressure loop.
    pub pressure_loop: PressureLoop,
    /// Inverse of the controller, from a deformation to a pressure.
    pub inverse: InverseChoice,
    /// Model of bending modules.
    pub bending: BendingModel,
    /// Largest error of an inverse table, as a share of the highest pressure; > 0.
    pub inverse_error: f64,
}
