//! Balance of a channel's air: pressures measured at the loop's decisions beside the modelled effects of all pulses between them.
//!
//! A valve that stays open or closed, a burst or a leak is compensated by the loop of the other valve. The air that it takes for that tells. All
//! amounts are in pascals of the chamber, in which walls that creep and air that cools do the same to chambers of all sizes.

use softlimb_protocol::FaultCode;

/// Real over modelled effect of a pulse, at least and at most: the bounds of the gains that the loop learns.
const GAIN_MIN: f32 = 0.3;
const GAIN_MAX: f32 = 3.0;

/// Doubt about a gain, as a factor either way: before any effect was seen, and once it was seen often.
const DOUBT_FIRST: f32 = 3.0;
const DOUBT_LEAST: f32 = 1.6;

/// Effects until the doubt is least; smallest effect that counts, Pa; and share of an innovation that is taken then.
const OFTEN: u8 = 12;
const EFFECT_PA: f32 = 1.5e3;
const RATE_FIRST: f32 = 0.15;
const RATE: f32 = 0.05;

/// Gain of one valve: real over modelled effect of its pulses, as seen so far.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gain {
    /// Deviation from 1, so that a new balance is all zeros.
    beyond_one: f32,
    count: u8,
}

impl Gain {
    const UNKNOWN: Self = Self { beyond_one: 0.0, count: 0 };

    fn learn(&mut self, gain: f32) {
        let rate = if self.count < OFTEN { RATE_FIRST } else { RATE };
        self.count = (self.count + 1).min(OFTEN);
        self.beyond_one += rate * (gain.clamp(GAIN_MIN, GAIN_MAX) - 1.0 - self.beyond_one);
    }

    /// The gain, or that of the other valve where more is known of it: volume and compliance are common to both.
    fn or(self, other: Self) -> Self {
        if other.count > self.count { other } else { self }
    }

    fn doubt(&self) -> f32 {
        DOUBT_FIRST - (DOUBT_FIRST - DOUBT_LEAST) * f32::from(self.count) / f32::from(OFTEN)
    }

    fn least(&self) -> f32 {
        ((1.0 + self.beyond_one) / self.doubt()).max(GAIN_MIN)
    }

    fn most(&self) -> f32 {
        ((1.0 + self.beyond_one) * self.doubt()).min(GAIN_MAX)
    }
}

/// Change that no valve explains and that is no fault, Pa/s: creep, heat, and a leak that the loop compensates.
const EXCESS_PA_PER_S: f32 = 2e3;
const MISSING_PA_PER_S: f32 = 3e3;

/// Share of the effect of a pulse by which the pressure comes back while the air takes the temperature of the wall, at most, and the time for it, s.
const HEAT: f32 = 0.15;
const HEAT_S: f32 = 0.3;

/// Unexplained pressure that is a fault, Pa. Walls that creep and air that cools take some; nothing brings any.
const EXCESS_PA: f32 = 5e3;
const MISSING_PA: f32 = 10e3;

/// Change of a reading from one sample to the next beyond which a single sample may be wrong, Pa.
const STEP_PA: f32 = 5e3;

/// Unexplained pressure of a channel, >= 0, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unexplained {
    excess_pa: f32,
    missing_pa: f32,
    /// Whether the pressure fell so far at once, since the last measurement, that it is the reading which is wrong, or a chamber that has burst.
    has_jumped: bool,
    /// Rise that is due while vented air warms up, and fall while compressed air cools down.
    warming_pa: f32,
    cooling_pa: f32,
}

impl Unexplained {
    const NONE: Self = Self { excess_pa: 0.0, missing_pa: 0.0, has_jumped: false, warming_pa: 0.0, cooling_pa: 0.0 };
}

/// Measurement of a chamber's pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) now_us: u64,
    pub(crate) pressure_pa: f32,
    /// Change of the reading from the last sample, Pa.
    pub(crate) step_pa: f32,
    /// Modelled drop from the manifold to the chamber, Pa, signed: 0 once the line has settled.
    pub(crate) drop_pa: f32,
}

/// Balance of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirBalance {
    /// Time, us, and pressure, Pa, of the last measurement of a settled line.
    since: Option<(u64, f32)>,
    /// Modelled effects of the pulses since then, >= 0, Pa.
    filled_pa: f32,
    vented_pa: f32,
    /// Until then, and until the latest measurement.
    settled: Unexplained,
    latest: Unexplained,
    fill: Gain,
    vent: Gain,
}

impl AirBalance {
    pub(crate) const fn new() -> Self {
        Self {
            since: None,
            filled_pa: 0.0,
            vented_pa: 0.0,
            settled: Unexplained::NONE,
            latest: Unexplained::NONE,
            fill: Gain::UNKNOWN,
            vent: Gain::UNKNOWN,
        }
    }

    /// Pressure beyond the highest that the valves explain, Pa.
    pub fn excess_pa(&self) -> f32 {
        self.latest.excess_pa
    }

    /// Pressure short of the least that the valves explain, Pa.
    pub fn missing_pa(&self) -> f32 {
        self.latest.missing_pa
    }

    /// A finding once there is more or less air than any working valves explain.
    pub(crate) fn finding(&self) -> Option<FaultCode> {
        if self.latest.missing_pa > MISSING_PA {
            Some(if self.latest.has_jumped { FaultCode::ReadingJumped } else { FaultCode::MissingAir })
        } else if self.latest.excess_pa > EXCESS_PA {
            Some(FaultCode::ExcessAir)
        } else {
            None
        }
    }

    /// The next measurement is the first: pulses since the last one were cut short.
    pub(crate) fn interrupt(&mut self) {
        self.since = None;
    }

    /// Takes the modelled effect of a pulse, Pa, signed.
    pub(crate) fn pulse(&mut self, effect_pa: f32) {
        self.filled_pa += effect_pa.max(0.0);
        self.vented_pa += (-effect_pa).max(0.0);
    }

    /// Takes a pressure of the chamber. Behind an open valve it is judged, with doubt about half of the drop, and not remembered.
    pub(crate) fn measure(&mut self, measurement: &Measurement) {
        let Measurement { now_us, pressure_pa, step_pa, drop_pa } = *measurement;
        let is_settled = drop_pa == 0.0;
        if step_pa.abs() > STEP_PA {
            return;
        }
        if let Some((at_us, from_pa)) = self.since {
            let doubt_pa = 0.5 * drop_pa.abs();
            let risen_pa = pressure_pa - from_pa;
            let time_s = now_us.saturating_sub(at_us) as u32 as f32 * 1e-6;
            let (fill, vent) = (self.fill.or(self.vent), self.vent.or(self.fill));
            let most_pa = fill.most() * self.filled_pa - vent.least() * self.vented_pa;
            let least_pa = fill.least() * self.filled_pa - vent.most() * self.vented_pa;
            let share = time_s / (time_s + HEAT_S);
            let before = self.settled;
            let (warming_pa, cooling_pa) =
                (before.warming_pa + HEAT * self.vented_pa, before.cooling_pa + HEAT * self.filled_pa);
            let excess_pa = risen_pa - most_pa - EXCESS_PA_PER_S * time_s - share * warming_pa - doubt_pa;
            let missing_pa = least_pa - risen_pa - MISSING_PA_PER_S * time_s - share * cooling_pa - doubt_pa;
            self.latest = Unexplained {
                excess_pa: (before.excess_pa + excess_pa).max(0.0),
                missing_pa: (before.missing_pa + missing_pa).max(0.0),
                has_jumped: risen_pa + vent.most() * self.vented_pa + doubt_pa < -MISSING_PA,
                warming_pa: (1.0 - share) * warming_pa,
                cooling_pa: (1.0 - share) * cooling_pa,
            };
            if is_settled {
                self.learn(risen_pa);
            }
        }
        if is_settled {
            self.settled = self.latest;
            self.since = Some((now_us, pressure_pa));
            (self.filled_pa, self.vented_pa) = (0.0, 0.0);
        }
    }

    /// Learns from the effect of one valve alone.
    fn learn(&mut self, risen_pa: f32) {
        if self.filled_pa > EFFECT_PA && self.vented_pa == 0.0 {
            self.fill.learn(risen_pa / self.filled_pa);
        } else if self.vented_pa > EFFECT_PA && self.filled_pa == 0.0 {
            self.vent.learn(-risen_pa / self.vented_pa);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A balance after periods of 20 ms from 50 kPa on: modelled effect of the pulse and the rise measured after it, Pa.
    fn after(periods: impl IntoIterator<Item = (f32, f32)>) -> AirBalance {
        let mut balance = AirBalance::new();
        let (mut now_us, mut pressure_pa) = (0, 50e3);
        let mut measure = |balance: &mut AirBalance, risen_pa: f32| {
            (now_us, pressure_pa) = (now_us + 20_000, pressure_pa + risen_pa);
            balance.measure(&Measurement { now_us, pressure_pa, step_pa: 0.0, drop_pa: 0.0 });
        };
        measure(&mut balance, 0.0);
        for (effect_pa, risen_pa) in periods {
            balance.pulse(effect_pa);
            measure(&mut balance, risen_pa);
        }
        balance
    }

    #[test]
    fn rise_that_vents_cannot_stop_is_excess_air() {
        // The vent takes away what an open fill valve brings, 2 kPa each period.
        let balance = after((0..40).map(|_| (-2e3, 0.0)));
        assert_eq!(balance.finding(), Some(FaultCode::ExcessAir), "{balance:?}");
        assert_eq!(after((0..4).map(|_| (0.0, 2e3))).finding(), Some(FaultCode::ExcessAir));
    }

    #[test]
    fn pulses_without_effect_are_missing_air() {
        let balance = after((0..20).map(|_| (3e3, 0.0)));
        assert_eq!(balance.finding(), Some(FaultCode::MissingAir), "{balance:?}");
        assert_eq!(after([(0.0, -12e3)]).finding(), Some(FaultCode::ReadingJumped));
    }

    #[test]
    fn wrong_volume_and_cooling_air_are_no_finding() {
        for gain in [0.4, 1.0, 2.7] {
            let up_and_down = (0..400).map(|index| if index / 20 % 2 == 0 { 3e3 } else { -3e3 });
            let balance = after(up_and_down.map(|effect_pa| (effect_pa, gain * effect_pa)));
            assert_eq!(balance.finding(), None, "{gain}: {balance:?}");
        }
        // 80 kPa in 0.4 s, of which 12 kPa are lost to the wall afterwards, and 1 kPa/s to a wall that creeps.
        let fill = (0..20).map(|_| (4e3, 4e3));
        let rest = (0..100).map(|index: i32| (0.0, -800.0 * 0.935_f32.powi(index) - 20.0));
        assert_eq!(after(fill.chain(rest)).finding(), None);
    }

    #[test]
    fn single_sample_far_off_is_left_out() {
        let mut balance = after([(0.0, 0.0)]);
        balance.measure(&Measurement { now_us: 60_000, pressure_pa: 150e3, step_pa: 100e3, drop_pa: 0.0 });
        assert_eq!((balance.finding(), balance.excess_pa()), (None, 0.0));
    }

    #[test]
    fn pressure_behind_an_open_valve_is_judged_with_doubt_and_not_remembered() {
        let mut balance = after([]);
        balance.pulse(-1e3);
        balance.measure(&Measurement { now_us: 40_000, pressure_pa: 58e3, step_pa: 0.0, drop_pa: -10e3 });
        assert_eq!(balance.finding(), None, "8 kPa with a doubt of 5");
        balance.measure(&Measurement { now_us: 60_000, pressure_pa: 64e3, step_pa: 0.0, drop_pa: -10e3 });
        assert_eq!(balance.finding(), Some(FaultCode::ExcessAir));
        balance.measure(&Measurement { now_us: 80_000, pressure_pa: 50e3, step_pa: 0.0, drop_pa: 0.0 });
        assert_eq!(balance.finding(), None);
    }
}
