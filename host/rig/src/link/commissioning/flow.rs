//! Measured flow through valve and line of a channel, over the flow that the device's own model predicts.

use std::fmt;

use softlimb_firmware::{ActiveConfig, Chamber, ChannelConfig, Direction, Inverse, Pneumatics};

/// Uncertainty of the difference between a valve's opening and closing delays, us.
const DELAYS_US: f64 = 1_500.0;
/// Ratios of measured to modelled flow that the pressure loop can adapt to.
const SHARES: std::ops::RangeInclusive<f64> = 0.4..=2.5;
/// Number of parts of a pressure change; the modelled flow is constant within each part.
const PARTS: u8 = 16;

/// Pulses of one valve, and the model that predicts their effect on the chamber.
pub(super) struct Pulses<'a> {
    pneumatics: &'a Pneumatics,
    channel: &'a ChannelConfig,
    direction: Direction,
    open_us: f64,
    count: u32,
}

/// Measured flow and its uncertainty, both as a share of the modelled flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    pub(super) share: f64,
    pub(super) uncertainty: f64,
}

impl<'a> Pulses<'a> {
    /// No pulse yet. `None` for a channel that is not configured.
    pub(super) fn new(config: &'a ActiveConfig, channel: usize, direction: Direction) -> Option<Self> {
        let pneumatics = &config.system.pneumatics;
        Some(Self { pneumatics, channel: config.channels.get(channel)?, direction, open_us: 0.0, count: 0 })
    }

    /// Adds a pulse of a closed valve; its coil was energized for `coil_us`.
    pub(super) fn add(&mut self, coil_us: u32) {
        let timing = self.pneumatics.timing;
        let open_us = f64::from(coil_us) + f64::from(timing.off_delay_us) - f64::from(timing.on_delay_us);
        self.open_us += open_us.max(0.0);
        self.count += 1;
    }

    /// The flow, from the pressures of the chamber before and after the pulses. Both are pressures at rest, with closed valves.
    pub(super) fn share(&self, from_pa: f64, to_pa: f64, supply_pa: f64) -> Share {
        let share = self.modelled_us(from_pa, to_pa, supply_pa) / self.open_us;
        Share { share, uncertainty: share * DELAYS_US * f64::from(self.count) / self.open_us }
    }

    /// Modelled time that the valve is open for a change of pressure, us. The air has the temperature of the wall before and after.
    fn modelled_us(&self, from_pa: f64, to_pa: f64, supply_pa: f64) -> f64 {
        let mut inverse = Inverse::new();
        inverse.follow_pressure(self.channel, (0.5 * (from_pa + to_pa)) as f32);
        let chamber = inverse.chamber(self.channel);
        let at = |part: f64| from_pa + (to_pa - from_pa) * part / f64::from(PARTS);
        let part_s = |part: u8| {
            let part = f64::from(part);
            let air_kg = self.air_kg(&chamber, at(part + 1.0)) - self.air_kg(&chamber, at(part));
            air_kg / self.flow_kg_per_s(&chamber, at(part + 0.5), supply_pa)
        };
        1e6 * (0..PARTS).map(part_s).sum::<f64>()
    }

    /// Flow into the chamber through the open valve, kg/s: negative when venting.
    fn flow_kg_per_s(&self, chamber: &Chamber, pressure_pa: f64, supply_pa: f64) -> f64 {
        let Pneumatics { atmosphere, temperature_k, .. } = *self.pneumatics;
        let pressure_pa = pressure_pa as f32;
        let rate = self.pneumatics.rate_pa_per_s(self.direction, chamber, pressure_pa, supply_pa as f32);
        f64::from(rate / chamber.stiffness_pa_per_kg(pressure_pa, atmosphere, temperature_k))
    }

    fn air_kg(&self, chamber: &Chamber, pressure_pa: f64) -> f64 {
        f64::from(chamber.air_kg(pressure_pa as f32, self.pneumatics.atmosphere, self.pneumatics.temperature_k))
    }
}

impl Share {
    /// Whether the pressure loop can adapt to the flow, within its uncertainty; false if the flow is not a number.
    pub(super) fn is_usable(&self) -> bool {
        let Self { share, uncertainty } = *self;
        share + uncertainty >= *SHARES.start() && share - uncertainty <= *SHARES.end()
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.0} +- {:.0} % of the modelled flow", 100.0 * self.share, 100.0 * self.uncertainty)
    }
}
