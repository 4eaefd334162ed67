//! Demands of a scene that the limb cannot meet, and those that it meets badly. `diagnostics` has the words.

use super::air::Bottleneck;
use super::inverse_kinematics::{Obstruction, Reach};
use super::setpoint::NoState;
use super::upright::Upright;
use super::weight::PoseError;

/// A demand of a scene that the limb cannot meet. Phases, targets, modules and obstacles are indices; times are after the start of the run.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unreachable {
    /// The limb at rest is too near an obstacle.
    AtRest(Obstruction),
    /// A module has no state at a target.
    Target { phase: usize, target: usize, cause: NoState },
    /// At its targets the limb is too near an obstacle; the straight move there is clear up to this fraction.
    TooNear { phase: usize, by: Obstruction, fraction: f64 },
    /// No pressures bring the tip to its goal; the search began at these setpoints and ended at the nearest.
    Tip { phase: usize, before: Vec<f64>, upright: Option<Upright>, nearest: Box<Reach> },
    /// No pressures bring the tip to this position of the marker series.
    Marker { phase: usize, position: usize, nearest: Reach },
    /// No way from these setpoints to those keeps clear.
    NoWay { phase: usize, from: Vec<f64>, to: Vec<f64>, upright: Option<Upright> },
    /// The supply suffices for no duration of the move.
    NoSupply { phase: usize },
    /// A setpoint changes faster than its limit, in its unit per second. A duration, s, is enough.
    MoveRate { phase: usize, module: usize, rate: f64, limit: f64, enough_s: f64 },
    /// A setpoint of a marker series changes faster than its limit at a time after the start of the series.
    SeriesRate { phase: usize, module: usize, rate: f64, limit: f64, time_us: u64 },
    /// A module has no state at a setpoint on the way.
    OnTheWay { phase: usize, module: usize, cause: NoState },
    /// On the way the limb is too near an obstacle, or has no shape.
    PassesTooNear { phase: usize, time_us: u64, by: Option<Obstruction> },
    /// The held object tilts by more than it may, rad: at a time of the run, or at the targets of the phase.
    Tilts { phase: usize, time_us: Option<u64>, tilt_rad: f64 },
    /// The limb does not carry its load.
    NotCarried { phase: usize, time_us: u64, cause: PoseError },
    /// The finest statics has too large an error, as a share of the limb's length.
    Uncertain { phase: usize, error: f64 },
    /// Under its load the tip does not get to where it shall be.
    UnderLoad { phase: usize, nearest: Reach },
    /// A move leaves more swing of the tip than it may, m, where frequencies are off at worst; its tip goes this far, m. A duration before
    /// shaping, s, is enough.
    Swings { phase: usize, worst_m: f64, way_m: f64, enough_s: Option<f64> },
    /// A correction of the scene is larger than the range of its module.
    Correction { time_s: f64, module: usize, value: f64 },
}

/// A demand that the limb meets badly.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shortcoming {
    /// A phase is faster than the bottleneck can follow. A duration, s, would keep a reserve; `None` where none does.
    TooFast { phase: usize, because: Bottleneck, enough_s: Option<f64> },
    /// A mass changes hands in a pause faster than the bottleneck can follow. A `hold`, s, would keep a reserve; `None` where none does.
    HandedTooFast { phase: usize, because: Bottleneck, enough_s: Option<f64> },
    /// Under load too few modules leave the tip this far, m, from where the targets of a phase have it without.
    Off { phase: usize, distance_m: f64 },
    /// The finest statics has this error, as a share of the limb's length, and the scene allows this.
    Statics { error: f64, allowed: f64 },
}
