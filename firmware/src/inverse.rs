//! From a setpoint to a chamber pressure, by the model of the actuator, started from the last solution.

use fra_model::{InvalidParameter, Load, Solution, State, Status};

use crate::config::ChannelConfig;
use crate::gas::Chamber;

/// Newton iterations of one inverse: from one setpoint to the next it needs a few, from rest to the end of the stroke some tens.
const ITERATIONS_MAX: u32 = 120;

/// Failures in a row after which the channel is at fault.
const FAILURES_MAX: u8 = 3;

/// Change of a pressure by its limits that is worth telling, Pa: less is rounding, as at rest.
const LIMITED_BY_PA: f32 = 100.0;

/// What became of the last setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InverseStatus {
    /// The pressure was limited to what the channel allows.
    pub limited: bool,
    /// The model found no pressure; the last good one stands.
    pub failed: bool,
}

/// The inverse model of one channel and its warm start.
#[derive(Clone, Copy, Debug)]
pub struct Inverse {
    warm: Option<State<f32>>,
    failures: u8,
    status: InverseStatus,
}

impl Inverse {
    /// Nothing solved yet.
    pub const fn new() -> Self {
        Self { warm: None, failures: 0, status: InverseStatus { limited: false, failed: false } }
    }

    /// Gauge pressure for a setpoint in SI units, Pa, within what the channel allows. Where the model finds none, the last good
    /// pressure; `None` if there is none yet.
    pub fn pressure_pa(&mut self, config: &ChannelConfig, setpoint: f32) -> Option<f32> {
        let solution = match config.target(setpoint) {
            Some(target) => config.actuator.inverse_near(&self.start(config), target, &Load::none(), ITERATIONS_MAX),
            None => {
                let wanted_pa = setpoint.clamp(0.0, config.reference_max_pa());
                config.actuator.forward_from(&self.start(config), wanted_pa, &Load::none())
            }
        };
        let solved = self.keep(solution);
        self.failures = if solved.is_some() { 0 } else { self.failures.saturating_add(1) };
        let wanted_pa = match config.target(setpoint) {
            Some(_) => solved.or(self.warm)?.pressure_pa,
            None if solved.is_none() => self.warm?.pressure_pa,
            None => setpoint,
        };
        let allowed_pa = wanted_pa.clamp(0.0, config.reference_max_pa());
        self.status =
            InverseStatus { limited: (allowed_pa - wanted_pa).abs() > LIMITED_BY_PA, failed: solved.is_none() };
        Some(allowed_pa)
    }

    /// Follows the pressure without a setpoint, so that volume and compliance stay right.
    pub fn follow_pressure(&mut self, config: &ChannelConfig, pressure_pa: f32) {
        let solution = config.actuator.forward_from(&self.start(config), pressure_pa.max(0.0), &Load::none());
        self.keep(solution);
    }

    /// Air volume of the channel about the last solution.
    pub fn chamber(&self, config: &ChannelConfig) -> Chamber {
        let state = self.start(config);
        Chamber {
            pressure_pa: state.pressure_pa,
            volume_m3: state.volume_m3 + config.dead_volume_m3,
            compliance_m3_per_pa: state.compliance_m3_per_pa.max(0.0),
            rest_volume_m3: config.rest.volume_m3 + config.dead_volume_m3,
            dead_volume_m3: config.dead_volume_m3,
        }
    }

    /// What became of the last setpoint.
    pub fn status(&self) -> InverseStatus {
        self.status
    }

    /// Whether the model failed three times in a row.
    pub fn is_at_fault(&self) -> bool {
        self.failures >= FAILURES_MAX
    }

    /// Forgets failures; the warm start stays.
    pub fn forgive(&mut self) {
        self.failures = 0;
        self.status = InverseStatus::default();
    }

    fn start(&self, config: &ChannelConfig) -> State<f32> {
        self.warm.unwrap_or(config.rest)
    }

    /// Keeps a solution that can be used as the next warm start.
    fn keep(&mut self, solution: Result<Solution<f32>, InvalidParameter<f32>>) -> Option<State<f32>> {
        let solution = solution.ok()?;
        let state = solution.state;
        let usable = solution.status == Status::Solved
            && state.pressure_pa.is_finite()
            && state.volume_m3.is_finite()
            && state.compliance_m3_per_pa.is_finite();
        let solved = usable.then_some(state);
        self.warm = solved.or(self.warm);
        solved
    }
}

impl Default for Inverse {
    fn default() -> Self {
        Self::new()
    }
}
