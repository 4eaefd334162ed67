//! From a setpoint to a chamber pressure: by the channel's tables where the host sent some, else by the model of the actuator,
//! followed from the last solution.

use fra_model::{InvalidParameter, NotFinite, State, Tracker, VolumeTable};

use crate::config::{ChannelConfig, Source};
use crate::gas::Chamber;

/// Failures in a row after which the channel is at fault.
const FAILURES_MAX: u8 = 3;

/// Change of a pressure by its limits that is worth telling, Pa: less is rounding, as at rest.
const LIMITED_BY_PA: f32 = 100.0;

/// Outcome of the last setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InverseStatus {
    /// The pressure was limited to the channel's range.
    pub limited: bool,
    /// The model found no pressure; the last good one stands.
    pub failed: bool,
}

/// The chamber at the pressure that was last aimed at.
#[derive(Clone, Copy, Debug)]
struct Air {
    pressure_pa: f32,
    volume_m3: f32,
    compliance_m3_per_pa: f32,
}

impl From<&State<f32>> for Air {
    fn from(state: &State<f32>) -> Self {
        let State { pressure_pa, volume_m3, compliance_m3_per_pa, .. } = *state;
        Self { pressure_pa, volume_m3, compliance_m3_per_pa }
    }
}

/// The inverse model of one channel and its warm start.
#[derive(Clone, Copy, Debug)]
pub struct Inverse {
    /// The last solution of the model; none where tables stand in for it.
    warm: Option<State<f32>>,
    air: Option<Air>,
    failures: u8,
    status: InverseStatus,
}

impl Inverse {
    /// Nothing solved yet.
    pub const fn new() -> Self {
        Self { warm: None, air: None, failures: 0, status: InverseStatus { limited: false, failed: false } }
    }

    /// Gauge pressure for a setpoint in SI units, Pa, within the channel's range. Where there is none, the last good pressure;
    /// `None` if there is none yet.
    pub fn pressure_pa(&mut self, config: &ChannelConfig, setpoint: f32) -> Option<f32> {
        let last_pa = self.air.map(|air| air.pressure_pa.clamp(0.0, config.reference_max_pa()));
        let found = match &config.source {
            Source::Volume(volume) | Source::Tables(volume, _) => self.by_table(config, volume, setpoint),
            Source::Model(tracker) => self.by_model(config, tracker, setpoint),
            Source::Nothing => None,
        };
        self.failures = if found.is_some() { 0 } else { self.failures.saturating_add(1) };
        let limited = found.is_some_and(|(_, excess_pa)| excess_pa > LIMITED_BY_PA);
        self.status = InverseStatus { limited, failed: found.is_none() };
        found.map(|(allowed_pa, _)| allowed_pa).or(last_pa)
    }

    /// Follows the pressure without a setpoint, so that volume and compliance stay right.
    pub fn follow_pressure(&mut self, config: &ChannelConfig, pressure_pa: f32) {
        match &config.source {
            Source::Volume(volume) | Source::Tables(volume, _) => self.take(volume, pressure_pa),
            Source::Model(tracker) => {
                let start = self.start(tracker);
                self.keep(tracker.forward(&start, pressure_pa.max(0.0)));
            }
            Source::Nothing => {}
        }
    }

    /// Air volume of the channel about the last solution.
    pub fn chamber(&self, config: &ChannelConfig) -> Chamber {
        let air = self.air.unwrap_or_else(|| at_rest(config));
        Chamber {
            pressure_pa: air.pressure_pa,
            volume_m3: air.volume_m3 + config.dead_volume_m3,
            compliance_m3_per_pa: air.compliance_m3_per_pa.max(0.0),
            rest_volume_m3: config.rest_volume_m3 + config.dead_volume_m3,
            dead_volume_m3: config.dead_volume_m3,
        }
    }

    /// Outcome of the last setpoint.
    pub fn status(&self) -> InverseStatus {
        self.status
    }

    /// Whether no pressure was found three times in a row.
    pub fn is_at_fault(&self) -> bool {
        self.failures >= FAILURES_MAX
    }

    /// Forgets failures; the warm start stays.
    pub fn forgive(&mut self) {
        self.failures = 0;
        self.status = InverseStatus::default();
    }

    /// The pressure for a setpoint and by how much its limits changed it, Pa, without any iteration.
    fn by_table(&mut self, config: &ChannelConfig, volume: &VolumeTable<f32>, setpoint: f32) -> Option<(f32, f32)> {
        let (wanted_pa, beyond_pa) = look_up(config, setpoint).ok()?;
        let allowed_pa = wanted_pa.clamp(0.0, config.reference_max_pa());
        self.take(volume, allowed_pa);
        Some((allowed_pa, (wanted_pa - allowed_pa).abs() + beyond_pa))
    }

    /// The same by the model.
    fn by_model(&mut self, config: &ChannelConfig, tracker: &Tracker<f32>, setpoint: f32) -> Option<(f32, f32)> {
        let start = self.start(tracker);
        let highest_pa = config.reference_max_pa();
        let wanted_pa = match config.target(setpoint) {
            Some(target) => self.keep(tracker.inverse(&start, target))?.pressure_pa,
            None => {
                let within_pa = setpoint.clamp(0.0, highest_pa);
                self.keep(tracker.forward(&start, within_pa))?;
                setpoint
            }
        };
        let allowed_pa = wanted_pa.clamp(0.0, highest_pa);
        Some((allowed_pa, (wanted_pa - allowed_pa).abs()))
    }

    /// Start of a solve: the last solution, or at rest if nothing was found from there the last time. Chambers that were vented meanwhile
    /// are near rest.
    fn start(&self, tracker: &Tracker<f32>) -> State<f32> {
        self.warm.filter(|_| self.failures.is_multiple_of(2)).unwrap_or_else(|| tracker.rest())
    }

    /// Keeps the chamber that a table gives at a pressure; nothing at a pressure that is no number.
    fn take(&mut self, table: &VolumeTable<f32>, pressure_pa: f32) {
        if let Ok(found) = table.lookup(pressure_pa) {
            let (volume_m3, compliance_m3_per_pa) = (found.volume_m3, found.compliance_m3_per_pa);
            self.air = Some(Air { pressure_pa: pressure_pa.max(0.0), volume_m3, compliance_m3_per_pa });
        }
    }

    /// Keeps a solution that can be used as the next warm start.
    fn keep(&mut self, solution: Result<Option<State<f32>>, InvalidParameter<f32>>) -> Option<State<f32>> {
        let state = solution.ok()??;
        self.warm = Some(state);
        self.air = Some(Air::from(&state));
        Some(state)
    }
}

/// The chamber without pressure.
#[cold]
fn at_rest(config: &ChannelConfig) -> Air {
    let compliance_m3_per_pa = match &config.source {
        Source::Model(tracker) => tracker.rest().compliance_m3_per_pa,
        source => source
            .volume_table()
            .and_then(|volume| volume.lookup(0.0).ok())
            .map_or(0.0, |found| found.compliance_m3_per_pa),
    };
    Air { pressure_pa: 0.0, volume_m3: config.rest_volume_m3, compliance_m3_per_pa }
}

/// The pressure of a setpoint, and how far beyond its end an inverse table would have to go for it, Pa: in proportion to its
/// range, since it does not say more.
fn look_up(config: &ChannelConfig, setpoint: f32) -> Result<(f32, f32), NotFinite> {
    match config.source.inverse_table() {
        Some(table) => {
            let found = table.lookup(setpoint)?;
            Ok((found.pressure_pa, found.beyond * table.pressure_max_pa()))
        }
        None if setpoint.is_finite() => Ok((setpoint, 0.0)),
        None => Err(NotFinite),
    }
}

impl Default for Inverse {
    fn default() -> Self {
        Self::new()
    }
}
