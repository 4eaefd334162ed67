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

/// Looks at one code in a row after which a sensor that was noisy before is frozen. The noise is the mean excess of the codes' second differences over 2:
/// a bit that flips and a ramp have none, a jump counts as 4. `NOISY` is that of a standard deviation of 0.7 codes.
const FROZEN_LOOKS: u8 = 80;
const NOISY: f32 = 0.25;
const NOISE_MAX: u32 = 4;
const NOISE_RATE: f32 = 1.0 / 32.0;

/// Looks after which a line at rest has second differences without the flow before.
const REST_LOOKS: u8 = 3;

/// Looks at one code in a row after which a sensor may be frozen: its noise is then no longer learned.
const STILL_LOOKS: u8 = 3;

/// Fall of a reading that no venting explains, Pa, and part of the modelled venting by which it may be more.
const FALL_PA: f32 = 6_000.0;
const VENTED: f32 = 3.0;

/// Change of a reading from one look to the next below which it stands, Pa. Behind a long hose a line settles for longer than the loop waits.
const STANDS_PA: f32 = 1_000.0;

/// Filling after which the reading has to have risen, beyond that which creep and cooling air take, Pa; share of it that is an effect; and share
/// below which there is none.
const FILLED_PA: f32 = 10_000.0;
const EFFECT: f32 = 0.25;
const NO_EFFECT: f32 = 0.1;

/// Venting beside such a filling may take so many times its modelled effect: of a chamber that is 30 % smaller, by a valve that is 20 % larger, and
/// without loss of heat.
const VENTED_MOST: f32 = 2.0;

/// Filling that makes up for the heat of a fill, as a share of it. Air that is compressed without loss of heat loses `1 - 1/1.4` of the rise as it cools
/// down: a third of the effect that the model expects with an exponent of 1.2. What makes up for it is compressed, too.
const COOLING: f32 = 0.5;

/// Filling that makes up for walls that creep, as a share of the absolute pressure, 1/s; and share of the effort that it takes at most.
const CREEP_PER_S: f32 = 0.005;
const CREEP_MAX: f32 = 0.3;

/// Time between two looks, s.
const LOOK_S: f32 = (LOOK_TICKS * TICK_US) as f32 * 1e-6;

/// Looks in a row that a finding has to last.
const LOOKS: u8 = 2;

/// Ticks between two looks at a channel: a look costs two flows through orifices, and a turn of the controller has nine channels.
const LOOK_TICKS: u32 = 3;

/// Whether the device looks at a channel in a tick: the channels take turns.
pub(crate) const fn is_due(tick: u32, channel: usize) -> bool {
    tick.wrapping_add(channel as u32).is_multiple_of(LOOK_TICKS)
}

/// Time after which the flow through an open valve and its line is steady, us.
const STEADY_US: i32 = 9_000;

/// Length of one tick, us.
const TICK: i32 = TICK_US as i32;

/// One valve as its coil makes it move. Times are counted from the start of the next tick, us.
#[derive(Clone, Copy, Debug)]
struct Poppet {
    opens_us: i32,
    closes_us: i32,
    is_energized: bool,
    /// Time for which the valve was open since the last look.
    open_us: u16,
}

impl Poppet {
    /// Later than any tick.
    const NEVER: i32 = i32::MAX / 2;

    const CLOSED: Self = Self { opens_us: Self::NEVER, closes_us: 0, is_energized: false, open_us: 0 };

    /// Takes the coil time of one tick.
    fn drive(&mut self, coil_us: u16, timing: ValveTiming) {
        let coil_us = i32::from(coil_us);
        if coil_us == 0 && self.closes_us <= 0 {
            return;
        }
        if coil_us > 0 {
            let is_open = self.closes_us > 0 && self.opens_us <= 0;
            if !self.is_energized && !is_open {
                self.opens_us = timing.on_delay_us as i32;
            }
            self.closes_us = coil_us + timing.off_delay_us as i32;
        }
        self.is_energized = coil_us == TICK;
        if !self.is_energized && self.opens_us > coil_us {
            // Switched off within the opening delay: it never opens.
            (self.opens_us, self.closes_us) = (Self::NEVER, 0);
            return;
        }
        let open_us = self.closes_us.min(TICK) - self.opens_us.max(0);
        self.open_us = self.open_us.saturating_add(open_us.max(0) as u16);
        self.opens_us = (self.opens_us - TICK).max(-STEADY_US);
        self.closes_us -= TICK;
    }

    /// Time for which the valve was open since the last look, s.
    fn take_open_s(&mut self) -> f32 {
        f32::from(core::mem::take(&mut self.open_us)) * 1e-6
    }

    /// Whether the valve is open for so long that the flow through the line is steady.
    fn is_steady(&self) -> bool {
        self.closes_us > 0 && self.opens_us <= -STEADY_US
    }
}

/// Inputs of one look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation<'a> {
    pub(crate) code: AdcCode,
    pub(crate) reading_pa: f32,
    pub(crate) supply_pa: f32,
    /// Air may still move in the line, so that the manifold does not read the chamber's pressure.
    pub(crate) is_line_moving: bool,
    /// Air volume of the channel.
    pub(crate) chamber: &'a Chamber,
    pub(crate) pneumatics: &'a Pneumatics,
}

/// Observer of one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observer {
    fill: Poppet,
    vent: Poppet,
    last_code: AdcCode,
    last_step: i32,
    last_pa: f32,
    /// Looks at one code in a row, looks since the line came to rest, and the noise at rest.
    same_looks: u8,
    rest_looks: u8,
    noise: f32,
    /// Effects since the code changed, Pa.
    unchanged_pa: f32,
    /// The latest settled reading, Pa, and what venting has done since, >= 0, Pa.
    settled_pa: Option<f32>,
    vented_pa: f32,
    /// Effort to fill that is being judged.
    effort: Effort,
    /// Filling that will make up for the cooling of the air, Pa.
    warm_pa: f32,
    suspicion: Option<FaultCode>,
    looks: u8,
}

/// Filling and venting since a reading, Pa.
#[derive(Clone, Copy, Debug)]
struct Effort {
    from_pa: f32,
    filled_pa: f32,
    vented_pa: f32,
    /// Filling that neither creep nor cooling air takes.
    due_pa: f32,
}

impl Effort {
    const fn new(from_pa: f32) -> Self {
        Self { from_pa, filled_pa: 0.0, vented_pa: 0.0, due_pa: 0.0 }
    }

    /// Whether the filling should have raised the reading, and did not.
    fn is_without_effect(&self, reading_pa: f32) -> bool {
        let risen_pa = reading_pa - self.from_pa + VENTED_MOST * self.vented_pa;
        self.due_pa > FILLED_PA && risen_pa < NO_EFFECT * self.due_pa
    }
}

impl Observer {
    pub(crate) const fn new() -> Self {
        Self {
            fill: Poppet::CLOSED,
            vent: Poppet::CLOSED,
            last_code: AdcCode(0),
            last_step: 0,
            last_pa: 0.0,
            same_looks: 0,
            rest_looks: 0,
            noise: 0.0,
            unchanged_pa: 0.0,
            settled_pa: None,
            vented_pa: 0.0,
            effort: Effort::new(0.0),
            warm_pa: 0.0,
            suspicion: None,
            looks: 0,
        }
    }

    /// Believes the next settled reading; the valves stay as they are.
    pub(crate) fn restart(&mut self) {
        let (fill, vent) = (Poppet { open_us: 0, ..self.fill }, Poppet { open_us: 0, ..self.vent });
        *self = Self { fill, vent, ..Self::new() };
    }

    /// Whether the code is that of the last look. The reading of a frozen sensor tells nothing.
    pub(crate) fn is_unchanged(&self) -> bool {
        self.same_looks > 0
    }

    /// Takes the coil times of one tick.
    pub(crate) fn drive(&mut self, pulse: ValvePulse, timing: ValveTiming) {
        self.fill.drive(pulse.fill_us, timing);
        self.vent.drive(pulse.vent_us, timing);
    }

    /// Takes a reading. A finding is returned once it has lasted.
    pub(crate) fn observe(&mut self, input: &Observation<'_>) -> Option<FaultCode> {
        let fill_pa = effect_pa(&mut self.fill, input, Direction::Fill).max(0.0);
        let vent_pa = -effect_pa(&mut self.vent, input, Direction::Vent).min(0.0);
        let size_pa = fill_pa + vent_pa;
        self.unchanged_pa = if input.code == self.last_code { self.unchanged_pa + size_pa } else { 0.0 };
        self.compare(input);
        self.vented_pa += vent_pa;
        self.effort.filled_pa += fill_pa;
        self.effort.vented_pa += vent_pa;
        let step_pa = input.reading_pa - self.last_pa;
        self.last_pa = input.reading_pa;
        let losses_pa = self.take_losses_pa(input, fill_pa);
        self.effort.due_pa = (self.effort.due_pa + fill_pa - losses_pa).max(0.0);
        let finding = self.finding(input, step_pa);
        if finding.is_none() && !input.is_line_moving && step_pa.abs() < STANDS_PA {
            self.settle(input.reading_pa);
        }
        self.looks = if finding.is_some() && finding == self.suspicion { self.looks.saturating_add(1) } else { 1 };
        self.suspicion = finding;
        finding.filter(|_| self.looks >= LOOKS)
    }

    /// Filling since the last look that creep and the cooling of the air may have taken, Pa.
    fn take_losses_pa(&mut self, input: &Observation<'_>, fill_pa: f32) -> f32 {
        let (atmosphere, temperature_k) = (input.pneumatics.atmosphere, input.pneumatics.temperature_k);
        let creep_pa = CREEP_PER_S * LOOK_S * (input.reading_pa + atmosphere.pa());
        let cooling_s = input.chamber.cooling_s(input.reading_pa, atmosphere, temperature_k);
        let cooled_pa = self.warm_pa * LOOK_S / (cooling_s + LOOK_S);
        self.warm_pa -= cooled_pa;
        cooled_pa + if fill_pa > 0.0 { creep_pa.min(CREEP_MAX * fill_pa) } else { creep_pa }
    }

    /// Compares the code with the last ones.
    fn compare(&mut self, input: &Observation<'_>) {
        let step = i32::from(input.code.0) - i32::from(self.last_code.0);
        self.same_looks = if step == 0 { self.same_looks.saturating_add(1) } else { 0 };
        self.rest_looks = if input.is_line_moving { 0 } else { self.rest_looks.saturating_add(1) };
        if self.rest_looks > REST_LOOKS && self.same_looks <= STILL_LOOKS {
            let size = (step - self.last_step).unsigned_abs().saturating_sub(2).min(NOISE_MAX);
            self.noise += NOISE_RATE * (size as f32 - self.noise);
        }
        (self.last_code, self.last_step) = (input.code, step);
    }

    /// Takes a settled reading that is plausible. An effort whose effect has come, or with venting in it, is judged no longer.
    fn settle(&mut self, reading_pa: f32) {
        let risen_pa = reading_pa - self.effort.from_pa;
        let Effort { filled_pa, vented_pa, .. } = self.effort;
        let is_over = vented_pa > EFFECT * filled_pa || risen_pa > EFFECT * filled_pa;
        if self.settled_pa.is_none() || filled_pa == 0.0 || is_over {
            self.warm_pa += COOLING * risen_pa.clamp(0.0, filled_pa);
            self.effort = Effort::new(reading_pa);
        }
        self.settled_pa = Some(reading_pa);
        self.vented_pa = 0.0;
    }

    fn finding(&self, input: &Observation<'_>, step_pa: f32) -> Option<FaultCode> {
        if self.unchanged_pa > FROZEN_PA || self.same_looks >= FROZEN_LOOKS && self.noise > NOISY {
            return Some(FaultCode::SensorFrozen);
        }
        let settled_pa = self.settled_pa?;
        // While air flows steadily, the manifold reads more than a filling chamber.
        let is_filling = self.fill.is_steady() && input.supply_pa > input.reading_pa + FALL_PA;
        if input.is_line_moving && !is_filling {
            return None;
        }
        // A reading that rises by itself comes back from venting.
        let falls = step_pa < STANDS_PA;
        if falls && input.reading_pa < settled_pa - FALL_PA - VENTED * self.vented_pa {
            Some(FaultCode::ReadingJumped)
        } else if self.effort.is_without_effect(input.reading_pa) {
            Some(FaultCode::FillWithoutEffect)
        } else {
            None
        }
    }
}

/// Modelled effect of a valve since the last look, Pa.
fn effect_pa(poppet: &mut Poppet, input: &Observation<'_>, direction: Direction) -> f32 {
    let open_s = poppet.take_open_s();
    if open_s > 0.0 {
        input.pneumatics.rate_pa_per_s(direction, input.chamber, input.reading_pa, input.supply_pa) * open_s
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::Orifice;
    use crate::gas::Absolute;

    const CHAMBER: Chamber = Chamber {
        pressure_pa: 50e3,
        volume_m3: 80e-6,
        compliance_m3_per_pa: 0.0,
        rest_volume_m3: 80e-6,
        dead_volume_m3: 6e-6,
    };

    /// Looks with closed valves until the finding; `None` after all codes.
    fn looks_until_frozen(codes: impl IntoIterator<Item = u16>) -> Option<usize> {
        let timing = ValveTiming { on_delay_us: 3_500, off_delay_us: 2_000 };
        let (valve, line) = (Orifice::new(1.44e-9, 0.3), Orifice::line(3.78e-9));
        let pneumatics = Pneumatics::new(valve, line, Absolute::new(101_325.0), 293.15, timing);
        let mut observer = Observer::new();
        codes.into_iter().position(|code| {
            let found = observer.observe(&Observation {
                code: AdcCode(code),
                reading_pa: 63.0 * f32::from(code),
                supply_pa: 200e3,
                is_line_moving: false,
                chamber: &CHAMBER,
                pneumatics: &pneumatics,
            });
            found == Some(FaultCode::SensorFrozen)
        })
    }

    #[test]
    fn noisy_sensor_that_stands_still_is_frozen_and_a_quiet_one_is_not() {
        let noise = [0, 2, 1, 3, 0, 1, 3, 2, 0, 3, 1, 0, 2];
        let noisy = |count: usize| (0..count).map(move |index| 800 + noise[index % noise.len()]);
        let still = std::iter::repeat_n(801, 300);
        let after = looks_until_frozen(noisy(200).chain(still.clone())).expect("frozen");
        assert!((270..290).contains(&after), "{after}");
        assert_eq!(looks_until_frozen(noisy(2_000)), None);
        // Codes of a quiet sensor: a bit that flips, and a pressure that rises slowly; then a rest.
        assert_eq!(looks_until_frozen((0..200).map(|index| 800 + index % 2).chain(still.clone())), None);
        assert_eq!(looks_until_frozen((0..200).map(|index| 800 + index / 2).chain(still)), None);
    }
}
