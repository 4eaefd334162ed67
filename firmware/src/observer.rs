//! Observes a channel by the model: what the coil times should have done, beside the reading.
//!
//! A sensor that is frozen, or whose hose is off, reads a plausible pressure, and the loop would fill its chamber to the supply. Effects are those
//! of the model at gain 1, which may be wrong by a factor of two.

use softlimb_protocol::FaultCode;

use crate::gas::Chamber;
use crate::pneumatics::Pneumatics;
use crate::sensor::AdcCode;
use crate::valve::{Direction, TICK_US, ValvePulse, ValveTiming};

/// Effect without any change of the code that tells a frozen sensor, Pa: noise alone moves the code of a sound one.
const FROZEN_PA: f32 = 4_000.0;

/// Fall of a reading that no venting explains, Pa, and part of the modelled venting by which it may be more.
const FALL_PA: f32 = 6_000.0;
const VENTED: f32 = 3.0;

/// Filling after which the reading has to have risen, Pa; share of it that is an effect; and share below which there is none.
const FILLED_PA: f32 = 25_000.0;
const EFFECT: f32 = 0.25;
const NO_EFFECT: f32 = 0.1;

/// Ticks in a row that a finding has to last.
const TICKS: u8 = 3;

/// Time after which the flow through an open valve and its line is steady, us.
const STEADY_US: u32 = 9_000;

/// One valve as its coil makes it move.
#[derive(Clone, Copy, Debug)]
struct Poppet {
    opens_at_us: u64,
    closes_at_us: u64,
    is_energized: bool,
}

impl Poppet {
    const CLOSED: Self = Self { opens_at_us: u64::MAX, closes_at_us: 0, is_energized: false };

    /// Takes the coil time of the tick that begins at `now_us`.
    fn drive(&mut self, now_us: u64, coil_us: u16, timing: ValveTiming) {
        if coil_us > 0 && !self.is_energized {
            let is_open = self.closes_at_us > now_us && self.opens_at_us <= now_us;
            if !is_open {
                self.opens_at_us = now_us + u64::from(timing.on_delay_us);
            }
        }
        if coil_us > 0 {
            self.closes_at_us = now_us + u64::from(coil_us) + u64::from(timing.off_delay_us);
        }
        self.is_energized = u32::from(coil_us) == TICK_US;
        let coil_off_us = now_us + u64::from(coil_us);
        if !self.is_energized && self.opens_at_us > coil_off_us {
            // Switched off within the opening delay: it never opens.
            self.opens_at_us = u64::MAX;
        }
    }

    /// Time within the tick before `now_us` for which the valve was open, s.
    fn open_s(&self, now_us: u64) -> f32 {
        let begin = self.opens_at_us.max(now_us.saturating_sub(u64::from(TICK_US)));
        let end = self.closes_at_us.min(now_us);
        end.saturating_sub(begin).min(u64::from(TICK_US)) as f32 * 1e-6
    }

    /// Whether the valve is open for so long that the flow through the line is steady.
    fn is_steady(&self, now_us: u64) -> bool {
        self.closes_at_us >= now_us && now_us.saturating_sub(self.opens_at_us) >= u64::from(STEADY_US)
    }
}

/// Inputs of one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation<'a> {
    pub(crate) now_us: u64,
    pub(crate) code: AdcCode,
    pub(crate) reading_pa: f32,
    pub(crate) supply_pa: f32,
    /// Air may still move in the line, so that the manifold does not read the chamber's pressure.
    pub(crate) is_line_moving: bool,
    /// Air volume of the channel, where a valve was open.
    pub(crate) chamber: Option<Chamber>,
    pub(crate) pneumatics: &'a Pneumatics,
}

/// Observer of one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observer {
    fill: Poppet,
    vent: Poppet,
    last_code: AdcCode,
    /// Effects since the code changed, Pa.
    unchanged_pa: f32,
    /// The latest settled reading, Pa, and what venting has done since, >= 0, Pa.
    settled_pa: Option<f32>,
    vented_pa: f32,
    /// Effort to fill that is being judged.
    effort: Effort,
    suspicion: Option<FaultCode>,
    ticks: u8,
}

/// Filling and venting since a reading, Pa.
#[derive(Clone, Copy, Debug)]
struct Effort {
    from_pa: f32,
    filled_pa: f32,
    vented_pa: f32,
}

impl Observer {
    pub(crate) const fn new() -> Self {
        Self {
            fill: Poppet::CLOSED,
            vent: Poppet::CLOSED,
            last_code: AdcCode(0),
            unchanged_pa: 0.0,
            settled_pa: None,
            vented_pa: 0.0,
            effort: Effort { from_pa: 0.0, filled_pa: 0.0, vented_pa: 0.0 },
            suspicion: None,
            ticks: 0,
        }
    }

    /// Believes the next settled reading.
    pub(crate) fn restart(&mut self) {
        let Self { fill, vent, .. } = *self;
        *self = Self { fill, vent, ..Self::new() };
    }

    /// Takes the coil times of the tick that begins at `now_us`.
    pub(crate) fn drive(&mut self, now_us: u64, pulse: ValvePulse, timing: ValveTiming) {
        self.fill.drive(now_us, pulse.fill_us, timing);
        self.vent.drive(now_us, pulse.vent_us, timing);
    }

    /// Whether a valve was open in the tick before `now_us`.
    pub(crate) fn has_flowed(&self, now_us: u64) -> bool {
        self.fill.open_s(now_us) > 0.0 || self.vent.open_s(now_us) > 0.0
    }

    /// Takes the reading of a tick. A finding is returned once it has lasted.
    pub(crate) fn observe(&mut self, input: &Observation<'_>) -> Option<FaultCode> {
        let fill_pa = effect_pa(&self.fill, input, Direction::Fill).max(0.0);
        let vent_pa = -effect_pa(&self.vent, input, Direction::Vent).min(0.0);
        let size_pa = fill_pa + vent_pa;
        self.unchanged_pa = if input.code == self.last_code { self.unchanged_pa + size_pa } else { 0.0 };
        self.last_code = input.code;
        self.vented_pa += vent_pa;
        self.effort.filled_pa += fill_pa;
        self.effort.vented_pa += vent_pa;
        let finding = self.finding(input);
        if finding.is_none() && !input.is_line_moving {
            self.settle(input.reading_pa);
        }
        self.ticks = if finding.is_some() && finding == self.suspicion { self.ticks.saturating_add(1) } else { 1 };
        self.suspicion = finding;
        finding.filter(|_| self.ticks >= TICKS)
    }

    /// Takes a settled reading that is plausible. An effort whose effect has come, or with venting in it, is judged no longer.
    fn settle(&mut self, reading_pa: f32) {
        let risen_pa = reading_pa - self.effort.from_pa;
        let Effort { filled_pa, vented_pa, .. } = self.effort;
        if self.settled_pa.is_none() || vented_pa > EFFECT * filled_pa || risen_pa > EFFECT * filled_pa {
            self.effort = Effort { from_pa: reading_pa, filled_pa: 0.0, vented_pa: 0.0 };
        }
        self.settled_pa = Some(reading_pa);
        self.vented_pa = 0.0;
    }

    fn finding(&self, input: &Observation<'_>) -> Option<FaultCode> {
        if self.unchanged_pa > FROZEN_PA {
            return Some(FaultCode::SensorFrozen);
        }
        let settled_pa = self.settled_pa?;
        // While air flows steadily, the manifold reads more than a filling chamber.
        if input.is_line_moving && !self.fill.is_steady(input.now_us) {
            return None;
        }
        let risen_pa = input.reading_pa - self.effort.from_pa;
        if input.reading_pa < settled_pa - FALL_PA - VENTED * self.vented_pa {
            Some(FaultCode::ReadingJumped)
        } else if self.effort.filled_pa > FILLED_PA && risen_pa < NO_EFFECT * self.effort.filled_pa {
            Some(FaultCode::FillWithoutEffect)
        } else {
            None
        }
    }
}

/// Modelled effect of a valve in this tick, Pa.
fn effect_pa(poppet: &Poppet, input: &Observation<'_>, direction: Direction) -> f32 {
    let open_s = poppet.open_s(input.now_us);
    match &input.chamber {
        Some(chamber) if open_s > 0.0 => {
            input.pneumatics.rate_pa_per_s(direction, chamber, input.reading_pa, input.supply_pa) * open_s
        }
        _ => 0.0,
    }
}
