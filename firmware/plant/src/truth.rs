//! True state of the plant, for reports and tests. The controller never sees it.

use fra_model::State;

use crate::pneumatics::{Gas, Openings};
use crate::spread::TrueParameters;

/// The true state of the plant at the end of a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Plant time, us.
    pub time_us: u64,
    /// Gauge pressure of the supply, Pa.
    pub supply_pressure_pa: f64,
    /// Air taken from the supply since the start, kg.
    pub air_used_kg: f64,
    /// Jaws of the gripper: 0 open, 1 closed, and between them the share of the way.
    pub gripper_closure: f64,
    /// One entry per channel.
    pub channels: Vec<ChannelTruth>,
}

/// The true state of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelTruth {
    /// Gauge pressure in the actuator, Pa.
    pub pressure_pa: f64,
    /// Gauge pressure at the manifold, where the sensor sits, Pa.
    pub line_pressure_pa: f64,
    /// Air that this channel took from the supply since the start, kg.
    pub air_used_kg: f64,
    /// Temperature of the air in the actuator, K.
    pub air_temperature_k: f64,
    /// Whether the fill valve passes air.
    pub fill_open: bool,
    /// Whether the vent valve passes air.
    pub vent_open: bool,
    /// Shape of the true actuator, creep included; its pressure is [`pressure_pa`](Self::pressure_pa).
    pub shape: State<f64>,
    /// Shapes of its segments, where it is a series of them.
    pub segments: Vec<State<f64>>,
    /// False where the actuator has no equilibrium at this pressure: the shape is the last one
    /// on its branch, and the volume goes on along its last slope.
    pub within_branch: bool,
    /// True parameters of the channel.
    pub parameters: TrueParameters,
}

/// The changing part of a [`Truth`], without the shapes: cheap enough to keep at every tick.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    pub(crate) time_us: u64,
    pub(crate) supply_pressure_pa: f64,
    pub(crate) air_used_kg: f64,
    pub(crate) gripper_closure: f64,
    pub(crate) channels: Vec<ChannelSnapshot>,
}

/// The changing part of a [`ChannelTruth`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChannelSnapshot {
    pub(crate) gas: Gas,
    pub(crate) creep_m3: f64,
    pub(crate) open: Openings,
}
