//! Balance of a channel's air: pressures measured at the loop's decisions beside the modelled effects of all pulses between them.
//!
//! The loop makes up for a leak, a burst, or a valve that stays open or closed. The air that it needs for that reveals the fault. Amounts are
//! changes of the chamber's pressure, Pa: creeping walls and cooling air change it alike in chambers of all sizes.

use softlimb_protocol::FaultCode;

/// Ratio of real to modelled effect of a pulse, at least and at most: the bounds of the gains that the loop learns.
const GAIN_MIN: f32 = 0.3;
const GAIN_MAX: f32 = 3.0;

/// Doubt about a gain, as a factor either way: before any effect was seen, and once it was seen often.
const DOUBT_FIRST: f32 = 2.0;
const DOUBT_LEAST: f32 = 1.4;

/// Number of measured effects above which a valve uses its own gain. Below it, the valve borrows the other one's gain. The borrowed count exceeds
/// its own by at most this number, because conductances and delays differ.
const BORROWED: u8 = 3;

/// Number of effects after which the doubt is least; smallest effect that counts, Pa; share of an innovation that a gain takes, before and after.
const OFTEN: u8 = 12;
const EFFECT_PA: f32 = 1.5e3;
const RATE_FIRST: f32 = 0.15;
const RATE: f32 = 0.05;

/// Gain of one valve: ratio of real to modelled effect of its pulses, as seen so far.
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

    /// The gain; or the other valve's, with more doubt, while few own effects are known: volume and compliance are common to both.
    fn or(self, other: Self) -> Self {
        if self.count < BORROWED && other.count > self.count {
            Self { count: other.count.min(self.count + BORROWED), ..other }
        } else {
            self
        }
    }

    fn doubt(&self, pulse_doubt: f32) -> f32 {
        DOUBT_FIRST - (DOUBT_FIRST - DOUBT_LEAST) * f32::from(self.count) / f32::from(OFTEN) + pulse_doubt
    }

    fn value(&self) -> f32 {
        1.0 + self.beyond_one
    }

    fn least(&self, pulse_doubt: f32) -> f32 {
        (self.value() / self.doubt(pulse_doubt)).max(GAIN_MIN / (1.0 + pulse_doubt))
    }

    fn most(&self, pulse_doubt: f32) -> f32 {
        (self.value() * self.doubt(pulse_doubt)).min(GAIN_MAX * (1.0 + pulse_doubt))
    }
}

/// Change that no valve explains and that is no fault, Pa/s: walls that recover from creep; and the leak of a sound chamber.
const EXCESS_PA_PER_S: f32 = 2e3;
const MISSING_PA_PER_S: f32 = 0.8e3;

/// Share of a rise that the pressure loses while the walls creep, at most; shortest and longest time constant of that, s.
const CREEP: f32 = 0.15;
const CREEP_S: [f32; 2] = [1.5, 10.0];

/// Share of a measured change by which the pressure comes back while the air takes the temperature of the wall, at most: `1 - 1/1.4` where none of
/// the heat was lost before; vented air warms up while its chamber shrinks. Ratio of the shortest to the longest time constant: from 1 W/K to 0.2 W/K.
/// Least time constant, s.
const COOLING: f32 = 0.29;
const WARMING: f32 = 0.33;
const QUICK_HEAT: f32 = 0.2;
const HEAT_MIN_S: f32 = 1e-3;

/// Largest rise due after a fall that no valve explains, Pa, and its shortest and longest time constant, s. A limb moved at 2 Hz comes back within
/// 0.25 s. Each rise also reduces the amount due, so only a part of it is explained.
const RETURN_PA: f32 = 2e3;
const RETURN_S: [f32; 2] = [0.05, 0.5];

/// Unexplained pressure that is a fault, Pa.
pub(crate) const EXCESS_PA: f32 = 3.5e3;
const MISSING_PA: f32 = 3.5e3;

/// Pressure fall with closed valves that is no fault, in addition to creep and cooling, Pa/s. A moved chamber or noise can cause it.
const LOST_PA_PER_S: f32 = 3e3;

/// Fall of the reading after each fill pulse, while the last pressure drop of the line settles, Pa.
const SETTLING_PA: f32 = 200.0;

/// Consecutive pulses with a swing that are a finding.
const SWINGS: u8 = 3;

/// Unexplained pressure that may be noise, Pa: no due change is spent on it.
const MARGIN_PA: f32 = 0.6e3;

/// Pressure below which a chamber may be empty, Pa: then venting need not have changed anything.
const EMPTY_PA: f32 = 2e3;

/// Change of a reading from one sample to the next beyond which a single sample may be wrong, Pa.
const STEP_PA: f32 = 5e3;

/// Unexplained pressure of a channel, >= 0, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unexplained {
    excess_pa: f32,
    missing_pa: f32,
    /// Rise that is due while vented air warms up, and fall while compressed air cools down.
    warming_pa: f32,
    cooling_pa: f32,
    /// Fall that is due while the walls creep.
    creep_pa: f32,
    /// Rise that is due after a fall that no valve explains: of a chamber that is moved from outside.
    returning_pa: f32,
}

impl Unexplained {
    const NONE: Self =
        Self { excess_pa: 0.0, missing_pa: 0.0, warming_pa: 0.0, cooling_pa: 0.0, creep_pa: 0.0, returning_pa: 0.0 };
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
    /// Time for which the line has been settled, s.
    pub(crate) settled_s: f32,
    /// Longest time constant with which the air takes the temperature of the wall, s.
    pub(crate) cooling_s: f32,
    /// Share of a rigid chamber's change by which the pressure comes back meanwhile.
    pub(crate) heat_share: f32,
}

/// Balance of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirBalance {
    /// Time, us modulo 2^32, pressure, Pa, and modelled drop, Pa, of the last measurement.
    since: Option<(u32, f32, f32)>,
    /// Modelled effects of the pulses since then, >= 0, Pa.
    filled_pa: f32,
    vented_pa: f32,
    /// The same, each times the doubt about the chamber and the delay at its pulse.
    doubt_pa: f32,
    unexplained: Unexplained,
    /// Sum of unexplained pressure falls while both valves were closed, >= 0, Pa. It does not depend on the gains.
    lost_pa: f32,
    /// Start of the next such fall, Pa. Valid while `is_closed`.
    closed_pa: f32,
    /// Whether both valves have been closed since then.
    is_closed: bool,
    /// Whether the pressure fell so far since the last measurement that the reading is wrong or the chamber has burst.
    has_jumped: bool,
    /// Consecutive short pulses with a swing.
    swings: u8,
    fill: Gain,
    vent: Gain,
}

impl AirBalance {
    pub(crate) const fn new() -> Self {
        Self {
            since: None,
            filled_pa: 0.0,
            vented_pa: 0.0,
            doubt_pa: 0.0,
            unexplained: Unexplained::NONE,
            lost_pa: 0.0,
            closed_pa: 0.0,
            is_closed: false,
            has_jumped: false,
            swings: 0,
            fill: Gain::UNKNOWN,
            vent: Gain::UNKNOWN,
        }
    }

    /// Pressure beyond the highest that the valves explain, Pa.
    pub fn excess_pa(&self) -> f32 {
        self.unexplained.excess_pa
    }

    /// Pressure short of the least that the valves explain, Pa.
    pub fn missing_pa(&self) -> f32 {
        self.unexplained.missing_pa.max(self.lost_pa)
    }

    /// A finding once there is more or less air than any working valves explain.
    pub(crate) fn finding(&self) -> Option<FaultCode> {
        if self.missing_pa() > MISSING_PA {
            Some(if self.has_jumped { FaultCode::ReadingJumped } else { FaultCode::MissingAir })
        } else if self.unexplained.excess_pa > EXCESS_PA {
            Some(FaultCode::ExcessAir)
        } else {
            None
        }
    }

    /// The next measurement is the first: the effects of pulses since the last one are unknown.
    pub(crate) fn interrupt(&mut self) {
        (self.since, self.is_closed) = (None, false);
    }

    /// The same where the loop has ended.
    pub(crate) fn end(&mut self) {
        self.interrupt();
        self.swings = 0;
    }

    /// Takes a steady reading while both valves are closed and the line is settled.
    pub(crate) fn rest(&mut self, pressure_pa: f32) {
        if !self.is_closed {
            (self.is_closed, self.closed_pa) = (true, pressure_pa);
        }
    }

    /// Takes the modelled effect of a pulse, Pa, signed, and the doubt about its chamber and delay, as a factor beyond one.
    pub(crate) fn pulse(&mut self, effect_pa: f32, doubt: f32) {
        self.filled_pa += effect_pa.max(0.0);
        self.vented_pa += (-effect_pa).max(0.0);
        self.doubt_pa += effect_pa.abs() * doubt;
        if effect_pa != 0.0 {
            self.is_closed = false;
        }
    }

    /// Takes the swing after a short pulse, Pa, in the direction of the pulse: none of a sound line. Behind a kinked hose, the air of the line moves
    /// slowly. The third swing in a row is excess air, whatever the valve.
    pub(crate) fn swing(&mut self, swing_pa: Option<f32>) {
        self.swings = if swing_pa.is_some() { self.swings.saturating_add(1) } else { 0 };
        if let Some(swing_pa) = swing_pa.filter(|_| self.swings >= SWINGS) {
            self.come_to_rest(swing_pa);
        }
    }

    /// Counts as unexplained the difference between the settled reading and its prediction behind a kinked hose, Pa, signed.
    pub(crate) fn come_to_rest(&mut self, beyond_pa: f32) {
        self.unexplained.excess_pa = self.unexplained.excess_pa.max(beyond_pa);
        self.unexplained.missing_pa = self.unexplained.missing_pa.max(-beyond_pa);
    }

    /// Takes a reading that still falls after a fill pulse: the chamber's pressure is lower. It shows missing air since a settled reading, and
    /// nothing else.
    pub(crate) fn measure_falling(&mut self, measurement: &Measurement) {
        if self.since.is_some_and(|(.., drop_pa)| drop_pa != 0.0) {
            return;
        }
        let mut trial = *self;
        trial.measure(measurement);
        if trial.unexplained.missing_pa > MISSING_PA {
            self.unexplained.missing_pa = trial.unexplained.missing_pa;
        }
    }

    /// Takes a pressure of the chamber. Behind an open valve the drop, or its change, is in doubt.
    pub(crate) fn measure(&mut self, measurement: &Measurement) {
        let Measurement { now_us, pressure_pa, step_pa, drop_pa, settled_s, cooling_s, heat_share } = *measurement;
        if step_pa.abs() > STEP_PA {
            return;
        }
        if let Some((at_us, from_pa, from_drop_pa)) = self.since {
            let pulse_doubt = self.doubt_pa / (self.filled_pa + self.vented_pa).max(1.0);
            // Behind a valve that is wide for its line, the real drop may be zero or double.
            let doubt_pa = (drop_pa - from_drop_pa).abs();
            let risen_pa = pressure_pa - from_pa;
            let time_s = (now_us as u32).wrapping_sub(at_us) as f32 * 1e-6;
            let (fill, vent) = (self.fill.or(self.vent), self.vent.or(self.fill));
            let vent_least = if pressure_pa < EMPTY_PA { 0.0 } else { vent.least(pulse_doubt) };
            let most_pa = fill.most(pulse_doubt) * self.filled_pa - vent_least * self.vented_pa;
            let least_pa = fill.least(pulse_doubt) * self.filled_pa - vent.most(pulse_doubt) * self.vented_pa;
            let before = self.unexplained;
            // A share of the real effect comes back: of the measured change, which is no more than the valve explains. A valve without effect has none.
            let fallen_pa = (-risen_pa).max(0.0).min(vent.most(pulse_doubt) * self.vented_pa);
            let filled_pa = risen_pa.max(0.0).min(fill.most(pulse_doubt) * self.filled_pa);
            let mut warming_pa = before.warming_pa + WARMING * heat_share * fallen_pa;
            let mut cooling_pa = before.cooling_pa + COOLING * heat_share * filled_pa;
            let mut creep_pa = (before.creep_pa + CREEP * risen_pa).max(0.0);
            let valves_pa = fill.value() * self.filled_pa - vent.value() * self.vented_pa;
            let mut returning_pa = (before.returning_pa - (risen_pa - valves_pa)).clamp(0.0, RETURN_PA);
            let excess_pa = risen_pa - most_pa - EXCESS_PA_PER_S * time_s - doubt_pa;
            let missing_pa = least_pa - risen_pa - MISSING_PA_PER_S * time_s - doubt_pa;
            // While the loop fills, a fill valve that stays open changes nothing, nor does an open vent while it vents.
            let mut excess_pa = before.excess_pa + if drop_pa > 0.0 { 0.0 } else { excess_pa };
            let mut missing_pa = before.missing_pa + if drop_pa < 0.0 { 0.0 } else { missing_pa };
            let heat_s = [QUICK_HEAT, 1.0].map(|share| (share * cooling_s).max(HEAT_MIN_S));
            if self.is_closed {
                let closed_s = settled_s.min(time_s);
                let due_pa = due_within(cooling_pa, closed_s, heat_s[0]) + due_within(creep_pa, closed_s, CREEP_S[0]);
                let settling_pa = if self.filled_pa > 0.0 { SETTLING_PA } else { 0.0 };
                let fallen_pa = self.closed_pa - pressure_pa - due_pa - settling_pa;
                self.lost_pa = (self.lost_pa + fallen_pa - LOST_PA_PER_S * closed_s).max(0.0);
            }
            excess_pa -= come_back(&mut warming_pa, excess_pa, time_s, heat_s);
            excess_pa -= come_back(&mut returning_pa, excess_pa, time_s, RETURN_S);
            missing_pa -= come_back(&mut cooling_pa, missing_pa, time_s, heat_s);
            missing_pa -= come_back(&mut creep_pa, missing_pa, time_s, CREEP_S);
            self.unexplained = Unexplained {
                excess_pa: excess_pa.max(0.0),
                missing_pa: missing_pa.max(0.0),
                warming_pa,
                cooling_pa,
                creep_pa,
                returning_pa,
            };
            self.has_jumped = risen_pa + vent.most(pulse_doubt) * self.vented_pa + doubt_pa < -MISSING_PA;
            // Vents of an empty chamber teach nothing.
            let is_telling = pressure_pa >= EMPTY_PA || self.vented_pa == 0.0;
            if drop_pa == 0.0 && from_drop_pa == 0.0 && is_telling {
                self.learn(risen_pa);
            }
        }
        self.since = Some((now_us as u32, pressure_pa, drop_pa));
        self.closed_pa = pressure_pa;
        (self.filled_pa, self.vented_pa, self.doubt_pa) = (0.0, 0.0, 0.0);
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

/// Part of an unexplained pressure that a due change explains, Pa. The due change shrinks with a time constant between two bounds, s.
fn come_back(due_pa: &mut f32, unexplained_pa: f32, time_s: f32, [shortest_s, longest_s]: [f32; 2]) -> f32 {
    let most_pa = due_within(*due_pa, time_s, shortest_s);
    let least_pa = due_within(*due_pa, time_s, longest_s);
    let used_pa = (unexplained_pa - MARGIN_PA).max(0.0).min(most_pa);
    *due_pa -= used_pa.max(least_pa);
    used_pa
}

/// Part of a due change that occurs within a time, Pa.
fn due_within(due_pa: f32, time_s: f32, constant_s: f32) -> f32 {
    due_pa * time_s / (time_s + constant_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A measurement with a settled line. Time and pressure are set by each test.
    const SETTLED: Measurement = Measurement {
        now_us: 0,
        pressure_pa: 0.0,
        step_pa: 0.0,
        drop_pa: 0.0,
        settled_s: 8e-3,
        cooling_s: 0.8,
        heat_share: 1.0,
    };

    /// A balance after periods of 20 ms from 50 kPa on: modelled effect of the pulse and the rise measured after it, Pa.
    fn after(periods: impl IntoIterator<Item = (f32, f32)>) -> AirBalance {
        let mut balance = AirBalance::new();
        let (mut now_us, mut pressure_pa) = (0, 50e3);
        let mut measure = |balance: &mut AirBalance, risen_pa: f32| {
            (now_us, pressure_pa) = (now_us + 20_000, pressure_pa + risen_pa);
            balance.measure(&Measurement { now_us, pressure_pa, ..SETTLED });
        };
        measure(&mut balance, 0.0);
        for (effect_pa, risen_pa) in periods {
            balance.pulse(effect_pa, 0.3);
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
    fn fall_with_closed_valves_is_missing_air_at_any_gain() {
        // Each pulse has three times its modelled effect. A leak takes all of it, a third while the line is settled.
        let leaks = |lost_pa: f32| {
            let mut balance = AirBalance::new();
            for now_us in (0..400_000).step_by(20_000) {
                balance.rest(5e3 + lost_pa);
                balance.measure(&Measurement { now_us: now_us + 20_000, pressure_pa: 5e3, ..SETTLED });
                balance.pulse(lost_pa, 0.3);
            }
            assert!(balance.unexplained.missing_pa < MISSING_PA);
            balance.finding()
        };
        assert_eq!(leaks(420.0), Some(FaultCode::MissingAir));
        // A line that settles.
        assert_eq!(leaks(200.0), None);
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
    fn moved_chamber_is_no_finding() {
        // 3.6 kPa from peak to peak at 2 Hz: the rise alone would be excess air.
        let moved = |amplitude_pa: f32| {
            let place_pa = |index: i32| amplitude_pa * (0.02 * 2.0 * core::f32::consts::TAU * index as f32).cos();
            after((0..200).map(|index| (0.0, place_pa(index + 1) - place_pa(index)))).finding()
        };
        assert_eq!(moved(1.8e3), None);
        assert!(moved(2.4e3).is_some());
        assert_eq!(after((0..14).map(|_| (0.0, 0.3e3))).finding(), Some(FaultCode::ExcessAir));
    }

    #[test]
    fn gain_of_the_other_valve_is_in_doubt() {
        // Pulses of the vent with a gain of 0.74, a rest in which the air warms up, then short pulses of the fill valve with twice that gain.
        let vented = (0..12).map(|_| (-2e3, -1.48e3)).chain((0..200).map(|_| (0.0, 0.0)));
        assert_eq!(after(vented.clone().chain((0..40).map(|_| (1.05e3, 1.55e3)))).finding(), None);
        let half_open = (0..40).map(|_| (1.05e3, 2.5e3));
        assert_eq!(after(vented.chain(half_open)).finding(), Some(FaultCode::ExcessAir));
    }

    #[test]
    fn vents_of_an_empty_chamber_teach_no_gain() {
        let mut balance = AirBalance::new();
        for now_us in (0..800_000).step_by(20_000) {
            balance.measure(&Measurement { now_us, pressure_pa: 0.1e3, ..SETTLED });
            balance.pulse(-3e3, 0.3);
        }
        assert_eq!((balance.vent, balance.finding()), (Gain::UNKNOWN, None));
    }

    #[test]
    fn third_swing_in_a_row_is_excess_air() {
        let after = |swings: &[Option<f32>]| {
            let mut balance = AirBalance::new();
            swings.iter().for_each(|swing_pa| balance.swing(*swing_pa));
            balance.finding()
        };
        let far = Some(6e3);
        assert_eq!(after(&[far, far, None, far, far]), None);
        assert_eq!(after(&[far, far, None, far, far, far]), Some(FaultCode::ExcessAir));
    }

    #[test]
    fn reading_that_still_falls_shows_missing_air_alone() {
        // Three pulses of 5 kPa each, after which the reading is still 2 kPa above the empty chamber.
        let mut balance = after([]);
        let falling = |pressure_pa: f32| Measurement { now_us: 80_000, pressure_pa, ..SETTLED };
        (0..3).for_each(|_| balance.pulse(5e3, 0.3));
        let before = balance;
        balance.measure_falling(&falling(50e3 + 40e3));
        assert_eq!(balance, before);
        balance.measure_falling(&falling(50e3 + 2e3));
        assert_eq!(balance.finding(), Some(FaultCode::MissingAir));
    }

    #[test]
    fn single_sample_far_off_is_left_out() {
        let mut balance = after([(0.0, 0.0)]);
        balance.measure(&Measurement { now_us: 60_000, pressure_pa: 150e3, step_pa: 100e3, ..SETTLED });
        assert_eq!((balance.finding(), balance.excess_pa()), (None, 0.0));
    }

    #[test]
    fn pressure_behind_an_open_valve_is_judged_with_doubt_about_its_drop() {
        let mut balance = after([]);
        balance.pulse(-1e3, 0.3);
        balance.measure(&Measurement { now_us: 40_000, pressure_pa: 58e3, drop_pa: -10e3, ..SETTLED });
        assert_eq!(balance.finding(), None, "8 kPa with a doubt of 10");
        balance.measure(&Measurement { now_us: 60_000, pressure_pa: 62e3, drop_pa: -10e3, ..SETTLED });
        assert_eq!(balance.finding(), Some(FaultCode::ExcessAir));
        balance.measure(&Measurement { now_us: 80_000, pressure_pa: 54e3, ..SETTLED });
        assert_eq!(balance.finding(), None);
    }
}
