//! Observes a channel by the model: the pressure that the coil times should have made, beside the reading.
//!
//! Between two readings the expected pressure changes by the modelled flow through the valves, times a gain per direction that is learned
//! while both agree. The expectation follows the reading slowly: leaks, creep and heat move a sound chamber by less than that. A reading
//! that leaves the expectation further than the model is wrong names the part that explains it.

use softlimb_protocol::FaultCode;

use crate::gas::Chamber;
use crate::pneumatics::Pneumatics;
use crate::sensor::AdcCode;
use crate::valve::{Direction, TICK_US, ValvePulse, ValveTiming};

/// Distance below and above the expectation that a sound channel keeps, Pa. A reading that is too low is the dangerous one: the loop would fill.
const BELOW_PA: f32 = 6_000.0;
const ABOVE_PA: f32 = 10_000.0;

/// Error of the modelled effect as a share of it: before a gain is learned, and after.
const ERROR_START: f32 = 0.6;
const ERROR_LEARNED: f32 = 0.2;

/// Share of the recent changes of the distance, to and fro, by which it may be larger: what moves a limb from outside moves it back too.
const AGITATION: f32 = 0.5;

/// Time between two readings that are compared for that, us, and change between them that is noise, Pa.
const AGITATION_US: u64 = 20_000;
const AGITATION_NOISE_PA: f32 = 150.0;

/// Effect after which a gain counts as learned, Pa.
const LEARNED_PA: f32 = 60_000.0;

/// Time after which an effect has lost `1 - 1/e` of its weight, s: heat is exchanged by then.
const EFFECT_MEMORY_S: f32 = 1.0;

/// The same for the sums that name a cause, s.
const CAUSE_MEMORY_S: f32 = 0.3;

/// Rate at which a sound chamber changes by itself, Pa/s: a leak of 0.6 normal mL/s in 80 mL.
const SELF_PA_PER_S: f32 = 600.0;

/// Bounds of a gain, its rate, and the effect at which it takes half of that, Pa.
const GAIN_MIN: f32 = 0.4;
const GAIN_MAX: f32 = 2.5;
const GAIN_RATE: f32 = 0.1;
const GAIN_NOISE_PA: f32 = 500.0;

/// Least effect that a gain is learned from, Pa: that of the air in the line is less.
const LEARNABLE_PA: f32 = 1_000.0;

/// Least rate of the effect that a gain is learned from, Pa/s: behind a slower one a drift of the sensor would hide.
const LEARNABLE_PA_PER_S: f32 = 15_000.0;

/// Ticks in a row that a finding has to last.
const TICKS: u8 = 3;

/// Effect without any change of the code that tells a frozen sensor, Pa: noise alone moves the code of a sound one.
const FROZEN_PA: f32 = 4_000.0;

/// Change within the ticks of a finding that no valve makes, Pa.
const JUMP_PA: f32 = 4_000.0;

/// Effect from which a direction explains a finding, Pa, and share of the distance that came without any effect where none explains it.
const CAUSE_PA: f32 = 1_000.0;
const UNPROMPTED: f32 = 0.4;

/// Time after which the flow through an open valve and its line is steady, us.
const STEADY_US: u32 = 9_000;

const TICK_S: f32 = TICK_US as f32 * 1e-6;

/// One valve as its coil makes it move.
#[derive(Clone, Copy, Debug)]
struct Poppet {
    opens_at_us: u64,
    closes_at_us: u64,
    is_energized: bool,
}

impl Poppet {
    const CLOSED: Self = Self { opens_at_us: u64::MAX, closes_at_us: 0, is_energized: false };

    /// Whether a coil time is the beginning of a pulse.
    fn begins(&self, coil_us: u16) -> bool {
        coil_us > 0 && !self.is_energized
    }

    /// Takes the coil time of the tick that begins at `now_us`.
    fn drive(&mut self, now_us: u64, coil_us: u16, timing: ValveTiming) {
        if self.begins(coil_us) {
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

/// Meaning of a reading for the chamber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// The valves are closed and the line has settled: the pressure itself.
    Settled,
    /// The flow of a fill valve is steady: more than the chamber's pressure.
    Filling,
    /// The flow of a vent is steady: less than that.
    Venting,
}

/// Gain of one direction.
#[derive(Clone, Copy, Debug)]
struct Gain {
    value: f32,
    /// Effect it was learned from, Pa, up to [`LEARNED_PA`].
    seen_pa: f32,
}

impl Gain {
    const UNKNOWN: Self = Self { value: 1.0, seen_pa: 0.0 };

    fn error(&self) -> f32 {
        ERROR_START + (ERROR_LEARNED - ERROR_START) * (self.seen_pa / LEARNED_PA)
    }

    /// Learns from a modelled effect, signed, that was `missed_pa` short of the measured one.
    fn learn(&mut self, effect_pa: f32, missed_pa: f32) {
        let step = GAIN_RATE * missed_pa * effect_pa / (effect_pa * effect_pa + GAIN_NOISE_PA * GAIN_NOISE_PA);
        self.value = (self.value + step).clamp(GAIN_MIN, GAIN_MAX);
        self.seen_pa = (self.seen_pa + effect_pa.abs()).min(LEARNED_PA);
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
    fill_gain: Gain,
    vent_gain: Gain,
    /// Expected pressure, Pa; `None` until the first reading.
    expected_pa: Option<f32>,
    recent: Recent,
    since: Since,
    last_code: AdcCode,
    /// Kind of the last reading, and the latest reading that has a kind: its kind and its distance, Pa.
    kind: Option<Kind>,
    compared: Option<(Kind, f32)>,
    /// Error of the recent effects at the last reading, Pa.
    allowed_pa: f32,
    /// Distance that the agitation is measured from, Pa, and its time, us.
    calm: (f32, u64),
    /// Reading of the last tick without a suspicion, Pa.
    before_pa: f32,
    suspicion: Option<Suspicion>,
}

/// Recent changes, Pa.
#[derive(Clone, Copy, Debug)]
struct Recent {
    /// Sizes of the effects over [`EFFECT_MEMORY_S`].
    fill_pa: f32,
    vent_pa: f32,
    /// Over [`CAUSE_MEMORY_S`]: effects with their sign, and changes of the distance while no valve was open.
    net_pa: f32,
    unprompted_pa: f32,
    /// Over [`EFFECT_MEMORY_S`]: sizes of the changes of the distance.
    agitation_pa: f32,
}

/// Sums since the start of the last pulse, and since the last change of the code, Pa.
#[derive(Clone, Copy, Debug)]
struct Since {
    fill_pa: f32,
    vent_pa: f32,
    /// Change of the distance between reading and expectation, between readings of one kind.
    missed_pa: f32,
    /// Time, s.
    time_s: f32,
    unchanged_pa: f32,
}

#[derive(Clone, Copy, Debug)]
struct Suspicion {
    finding: FaultCode,
    ticks: u8,
}

impl Observer {
    pub(crate) const fn new() -> Self {
        Self {
            fill: Poppet::CLOSED,
            vent: Poppet::CLOSED,
            fill_gain: Gain::UNKNOWN,
            vent_gain: Gain::UNKNOWN,
            expected_pa: None,
            recent: Recent { fill_pa: 0.0, vent_pa: 0.0, net_pa: 0.0, unprompted_pa: 0.0, agitation_pa: 0.0 },
            since: Since { fill_pa: 0.0, vent_pa: 0.0, missed_pa: 0.0, time_s: 0.0, unchanged_pa: 0.0 },
            last_code: AdcCode(0),
            kind: None,
            compared: None,
            allowed_pa: 0.0,
            calm: (0.0, 0),
            before_pa: 0.0,
            suspicion: None,
        }
    }

    /// Believes the next settled reading. What was learned of the valves stays.
    pub(crate) fn restart(&mut self) {
        let Self { fill, vent, fill_gain, vent_gain, .. } = *self;
        *self = Self { fill, vent, fill_gain, vent_gain, ..Self::new() };
    }

    /// Takes the coil times of the tick that begins at `now_us`.
    pub(crate) fn drive(&mut self, now_us: u64, pulse: ValvePulse, timing: ValveTiming) {
        let begins = self.fill.begins(pulse.fill_us) || self.vent.begins(pulse.vent_us);
        if begins && self.suspicion.is_none() {
            self.learn();
        }
        self.fill.drive(now_us, pulse.fill_us, timing);
        self.vent.drive(now_us, pulse.vent_us, timing);
    }

    /// Whether a valve was open in the tick before `now_us`.
    pub(crate) fn has_flowed(&self, now_us: u64) -> bool {
        self.fill.open_s(now_us) > 0.0 || self.vent.open_s(now_us) > 0.0
    }

    /// Takes the reading of a tick. A finding is returned once it has lasted, and from then on.
    pub(crate) fn observe(&mut self, input: &Observation<'_>) -> Option<FaultCode> {
        let Some(expected_pa) = self.expected_pa else {
            self.expected_pa = (!input.is_line_moving).then_some(input.reading_pa);
            self.before_pa = input.reading_pa;
            self.last_code = input.code;
            return None;
        };
        let fill_pa = self.effect_pa(input, Direction::Fill, expected_pa).max(0.0);
        let vent_pa = self.effect_pa(input, Direction::Vent, expected_pa).min(0.0);
        let distance_pa = input.reading_pa - (expected_pa + fill_pa + vent_pa);
        let kind = self.kind_at(input);
        self.add(input, (fill_pa, vent_pa));
        let step_pa = kind.map_or(0.0, |kind| self.compare(input.now_us, kind, distance_pa));
        self.allowed_pa = self.error_pa(0.0);
        self.kind = kind;
        let distance_pa = distance_pa - step_pa;
        self.expected_pa = Some(input.reading_pa - distance_pa);
        self.judge(input, distance_pa)
    }

    /// Kind of a reading; `None` while the air of the line moves unsteadily.
    fn kind_at(&self, input: &Observation<'_>) -> Option<Kind> {
        match input.is_line_moving {
            false => Some(Kind::Settled),
            true if self.fill.is_steady(input.now_us) => Some(Kind::Filling),
            true if self.vent.is_steady(input.now_us) => Some(Kind::Venting),
            true => None,
        }
    }

    /// Modelled effect of a valve in this tick, Pa.
    fn effect_pa(&self, input: &Observation<'_>, direction: Direction, pressure_pa: f32) -> f32 {
        let (poppet, gain) = match direction {
            Direction::Fill => (&self.fill, &self.fill_gain),
            Direction::Vent => (&self.vent, &self.vent_gain),
        };
        let open_s = poppet.open_s(input.now_us);
        match &input.chamber {
            Some(chamber) if open_s > 0.0 => {
                let rate = input.pneumatics.rate_pa_per_s(direction, chamber, pressure_pa, input.supply_pa);
                gain.value * rate * open_s
            }
            _ => 0.0,
        }
    }

    fn add(&mut self, input: &Observation<'_>, (fill_pa, vent_pa): (f32, f32)) {
        const LASTING: f32 = 1.0 - TICK_S / EFFECT_MEMORY_S;
        const KEPT: f32 = 1.0 - TICK_S / CAUSE_MEMORY_S;
        let (size_pa, net_pa) = (fill_pa - vent_pa, fill_pa + vent_pa);
        self.recent.fill_pa = LASTING * self.recent.fill_pa + fill_pa;
        self.recent.vent_pa = LASTING * self.recent.vent_pa - vent_pa;
        self.recent.net_pa = KEPT * self.recent.net_pa + net_pa;
        self.recent.unprompted_pa *= KEPT;
        self.recent.agitation_pa *= LASTING;
        self.since.time_s += TICK_S;
        self.since.fill_pa += fill_pa;
        self.since.vent_pa += vent_pa;
        self.since.unchanged_pa = if input.code == self.last_code { self.since.unchanged_pa + size_pa } else { 0.0 };
        self.last_code = input.code;
    }

    /// Compares the distance with that of the latest reading of this kind; the step of the expectation towards a settled reading, Pa.
    fn compare(&mut self, now_us: u64, kind: Kind, distance_pa: f32) -> f32 {
        if let Some((_, before_pa)) = self.compared.filter(|&(before, _)| before == kind) {
            self.since.missed_pa += distance_pa - before_pa;
            if kind == Kind::Settled && self.kind == Some(kind) {
                self.recent.unprompted_pa += distance_pa - before_pa;
            }
        }
        let step_pa = if kind == Kind::Settled {
            self.agitate(now_us, distance_pa);
            // What is not learned yet lasts, and what was allowed for a move is taken back with the allowance.
            let lasting_pa = (SELF_PA_PER_S + self.error_pa(ERROR_LEARNED) / EFFECT_MEMORY_S) * TICK_S;
            let most_pa = lasting_pa + (self.allowed_pa - self.error_pa(0.0)).max(0.0);
            distance_pa.clamp(-most_pa, most_pa)
        } else {
            self.learn();
            0.0
        };
        self.compared = Some((kind, distance_pa - step_pa));
        self.calm.0 -= step_pa;
        step_pa
    }

    fn agitate(&mut self, now_us: u64, distance_pa: f32) {
        let (before_pa, at_us) = self.calm;
        let since_us = now_us.saturating_sub(at_us);
        if since_us < AGITATION_US {
            return;
        }
        if since_us < 10 * AGITATION_US {
            self.recent.agitation_pa += ((distance_pa - before_pa).abs() - AGITATION_NOISE_PA).max(0.0);
        }
        self.calm = (distance_pa, now_us);
    }

    /// The gain of the valve that did most learns from the distance that came since: of short pulses when the next begins, since air cools
    /// after a pulse.
    fn learn(&mut self) {
        let Since { fill_pa, vent_pa, missed_pa, time_s, .. } = self.since;
        let size_pa = fill_pa - vent_pa;
        let is_fast = size_pa > LEARNABLE_PA_PER_S * time_s;
        if is_fast && size_pa < LEARNABLE_PA {
            return;
        }
        if !is_fast {
            // A drift would be learned.
        } else if fill_pa > -2.0 * vent_pa {
            self.fill_gain.learn(fill_pa, missed_pa);
        } else if -vent_pa > 2.0 * fill_pa {
            self.vent_gain.learn(vent_pa, missed_pa);
        }
        self.since = Since { fill_pa: 0.0, vent_pa: 0.0, missed_pa: 0.0, time_s: 0.0, ..self.since };
    }

    /// Error of the recent effects, Pa, beyond a share of them.
    fn error_pa(&self, share: f32) -> f32 {
        (self.fill_gain.error() - share) * self.recent.fill_pa + (self.vent_gain.error() - share) * self.recent.vent_pa
    }

    /// The first name of a suspicion stays: what a fault does later looks like another.
    fn judge(&mut self, input: &Observation<'_>, distance_pa: f32) -> Option<FaultCode> {
        let Some(now) = self.finding(input, distance_pa) else {
            self.suspicion = None;
            self.before_pa = input.reading_pa;
            return None;
        };
        let suspicion = self.suspicion.get_or_insert(Suspicion { finding: now, ticks: 0 });
        suspicion.ticks = suspicion.ticks.saturating_add(1);
        (suspicion.ticks >= TICKS).then_some(suspicion.finding)
    }

    fn finding(&self, input: &Observation<'_>, distance_pa: f32) -> Option<FaultCode> {
        if self.since.unchanged_pa > FROZEN_PA {
            return Some(FaultCode::SensorFrozen);
        }
        let error_pa = self.error_pa(0.0) + AGITATION * self.recent.agitation_pa;
        // While air flows, the manifold reads more than a filling chamber and less than a venting one.
        let is_low = distance_pa < -BELOW_PA - error_pa && matches!(self.kind, Some(Kind::Settled | Kind::Filling));
        let is_high = distance_pa > ABOVE_PA + error_pa && matches!(self.kind, Some(Kind::Settled | Kind::Venting));
        let Recent { net_pa, unprompted_pa, .. } = self.recent;
        let is_unprompted = unprompted_pa / distance_pa > UNPROMPTED;
        match () {
            () if !is_low && !is_high => None,
            () if (input.reading_pa - self.before_pa).abs() > JUMP_PA => Some(FaultCode::ReadingJumped),
            () if is_low && !is_unprompted && net_pa > CAUSE_PA => Some(FaultCode::FillWithoutEffect),
            () if is_high && !is_unprompted && -net_pa > CAUSE_PA => Some(FaultCode::VentWithoutEffect),
            () if is_low => Some(FaultCode::FallWithoutVent),
            () => Some(FaultCode::RiseWithoutFill),
        }
    }
}
