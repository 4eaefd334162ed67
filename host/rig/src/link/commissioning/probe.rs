//! Measurements of a device under direct control, and the steps of one channel.

use std::cell::RefCell;

use softlimb_firmware::{ActiveConfig, Direction};
use softlimb_protocol::{ChannelStatus, DeviceState, PulseDirection, Telemetry};

use super::flow::{Pulses, Share};
use super::step::{Finding, StepKind, failed, passed};
use crate::link::direct::Direct;
use crate::link::error::LinkError;
use crate::link::transport::Transport;
use crate::link::words::fault_names;

/// Pressure that a channel is filled to, Pa, and its largest share of the channel's highest pressure.
const TARGET_PA: f64 = 10_000.0;
const TARGET_SHARE: f64 = 0.3;
/// First and longest pulse, us; a pulse without much effect is followed by one of twice its length.
const PULSE_US: u32 = 5_000;
const PULSE_MAX_US: u32 = 100_000;
/// Longest time of the fill valve to reach the target, us.
const FILL_US: u64 = 4_000_000;
/// Time for line and chamber to come to rest after a pulse, us.
const REST_US: u64 = 200_000;
/// Time within which a leak as large as a valve empties a chamber, us, and the share of the target that is held at least then.
const HELD_US: u64 = 1_000_000;
const HELD_SHARE: f64 = 0.25;
/// Rise of another channel, as a share of the target, by which it counts as connected to this one.
const OTHER_SHARE: f64 = 0.3;
/// Change of pressure from which on a valve has an effect, Pa: several times the scatter of a sensor.
const EFFECT_PA: f64 = 300.0;
/// Settling and watch of a closed chamber, us, and the largest rate of change, Pa/s: air that cools and walls that creep stay below.
const SETTLE_US: u64 = 3_000_000;
const WATCH_US: u64 = 2_000_000;
const WINDOW_US: u64 = 250_000;
const RATE_PA_PER_S: f64 = 150.0;
/// Pulse that opens the supply of a ready device, but no fill valve, us: shorter than any opening delay.
const SUPPLY_PULSE_US: u32 = 1_000;
/// First and longest pulse of the vent, us, greatest sum of its pulses, us, and highest pressure of a vented chamber, Pa. Each pulse is twice as
/// long as the previous one.
const VENT_US: u32 = 20_000;
const VENT_MAX_US: u32 = 500_000;
const VENTS_US: u32 = 4_000_000;
const VENTED_PA: f64 = 2_000.0;
/// Least shares of its pressure that a chamber has kept and lost when the flow of its vent is judged: near zero pressure the flow is uncertain.
const KEPT_SHARE: f64 = 0.2;
const LOST_SHARE: f64 = 0.1;

/// A device under direct control, and the measurements that it sends.
pub(super) struct Probe<'a, 'h, T> {
    pub(super) hand: Direct<'a, T>,
    heard: &'h RefCell<Vec<Telemetry>>,
}

impl<'a, 'h, T: Transport> Probe<'a, 'h, T> {
    pub(super) fn new(hand: Direct<'a, T>, heard: &'h RefCell<Vec<Telemetry>>) -> Self {
        Self { hand, heard }
    }

    /// Collects measurements for a time, us. A lost link ends this early; the next command then fails.
    pub(super) fn observe(&mut self, time_us: u64) -> Vec<Telemetry> {
        self.heard.borrow_mut().clear();
        // After an error there are fewer measurements.
        let _ = self.hand.wait(time_us);
        self.heard.take()
    }

    pub(super) fn is_ready(&self) -> bool {
        matches!(self.hand.state(), Some(DeviceState::Ready | DeviceState::Holding))
    }

    /// Lets the supply reach the fill valves.
    pub(super) fn open_supply(&mut self) -> Result<(), LinkError> {
        self.hand.pulse(0, PulseDirection::Fill, SUPPLY_PULSE_US)
    }

    /// A finding, with the faults that the device has latched.
    pub(super) fn with_faults(&self, text: String) -> String {
        let faults = self.hand.telemetry().map_or_else(Vec::new, |last| fault_names(last.fault_bits));
        if faults.is_empty() { text } else { format!("{text}; {}", faults.join(", ")) }
    }

    /// Vents all channels, and checks their pressures.
    pub(super) fn down(&mut self) -> Finding {
        let vented = self.hand.vent();
        if vented.is_err() {
            return self.told(vented.map(|()| passed(String::new())));
        }
        let heard = self.observe(REST_US);
        let highest_pa = (0..channels(&heard)).map(|channel| mean_pa(&heard, channel)).fold(0.0, f64::max);
        let text = format!("{:.2} kPa at most", highest_pa * 1e-3);
        if highest_pa <= VENTED_PA && !heard.is_empty() { passed(text) } else { failed(self.with_faults(text)) }
    }

    /// Fills, watches and vents one channel. `add` notes a step and says whether it passed.
    pub(super) fn channel(&mut self, index: u8, model: &ActiveConfig, mut add: impl FnMut(StepKind, Finding) -> bool) {
        let channel = usize::from(index);
        let pulses = [Direction::Fill, Direction::Vent].map(|direction| Pulses::new(model, channel, direction));
        let ([Some(fills), Some(vents)], Some(config)) = (pulses, model.channels.get(channel)) else { return };
        let target_pa = TARGET_PA.min(TARGET_SHARE * f64::from(config.pressure_max_pa));
        let filled = self.fill(index, target_pa, fills);
        if !add(StepKind::Fill, self.told(filled)) {
            return;
        }
        let leak = self.leak(channel);
        add(StepKind::Leak, leak);
        let vented = self.vent(index, vents);
        add(StepKind::Vent, self.told(vented));
    }

    /// A refusal or a lost link fails a step.
    fn told(&self, finding: Result<Finding, LinkError>) -> Finding {
        finding.unwrap_or_else(|error| failed(self.with_faults(error.to_string())))
    }

    /// Pulses the fill valve until its chamber is at the target.
    fn fill(&mut self, index: u8, target_pa: f64, mut pulses: Pulses<'_>) -> Result<Finding, LinkError> {
        let channel = usize::from(index);
        let before = self.observe(REST_US);
        let start_pa = mean_pa(&before, channel);
        let (mut pulse_us, mut spent_us, mut at_pa, mut peak_pa) = (PULSE_US, 0, start_pa, start_pa);
        let mut moved = None;
        while moved.is_none() && at_pa - start_pa < target_pa && spent_us < FILL_US {
            self.hand.pulse(index, PulseDirection::Fill, pulse_us)?;
            pulses.add(pulse_us);
            let during = self.observe(u64::from(pulse_us) + REST_US / 4);
            peak_pa = pressures_pa(&during, channel).fold(peak_pa, f64::max);
            let after = self.observe(REST_US);
            // A channel that was vented a moment ago rises too, as its air warms up and its wall creeps back, but less.
            moved = (0..channels(&after)).find(|&other| {
                other != channel && mean_pa(&after, other) - mean_pa(&before, other) >= OTHER_SHARE * target_pa
            });
            let reached_pa = mean_pa(&after[after.len() / 2..], channel);
            spent_us += u64::from(pulse_us);
            if reached_pa - at_pa < 0.25 * target_pa {
                pulse_us = PULSE_MAX_US.min(2 * pulse_us);
            }
            at_pa = reached_pa;
        }
        if moved.is_none() && peak_pa - start_pa < EFFECT_PA && self.does_vent_fill(index)? {
            return Ok(failed("the coil of the vent valve fills: the coils are exchanged".to_owned()));
        }
        let rest = self.observe(HELD_US);
        let held_pa = mean_pa(&rest[rest.len() - rest.len() / 4..], channel);
        let [from, to, peak] = [start_pa, at_pa, peak_pa].map(|pressure_pa| pressure_pa * 1e-3);
        let text = format!("{from:.2} to {to:.2} kPa within {} ms", spent_us / 1_000);
        let share = pulses.share(start_pa, held_pa, supply_pa(&before));
        Ok(match moved {
            Some(other) => failed(format!("{text}; channel {other} rises")),
            None if peak_pa - start_pa >= EFFECT_PA && held_pa - start_pa < HELD_SHARE * target_pa => {
                failed(self.with_faults(format!("{text}: {peak:.2} kPa while it fills, and the air escapes")))
            }
            None if at_pa - start_pa >= target_pa => self.judged(&text, Some(share)),
            None => failed(self.with_faults(text)),
        })
    }

    /// Whether pulses of the vent valve raise the pressure of a channel. They end as its sensor shows the rise.
    fn does_vent_fill(&mut self, index: u8) -> Result<bool, LinkError> {
        let channel = usize::from(index);
        let before_pa = mean_pa(&self.observe(REST_US), channel);
        let mut pulse_us = PULSE_US;
        while pulse_us <= PULSE_MAX_US {
            self.hand.pulse(index, PulseDirection::Vent, pulse_us)?;
            let after = self.observe(u64::from(pulse_us) + REST_US);
            if mean_pa(&after[after.len() / 2..], channel) - before_pa >= EFFECT_PA {
                return Ok(true);
            }
            pulse_us *= 2;
        }
        Ok(false)
    }

    /// Watches a filled chamber with closed valves.
    fn leak(&mut self, channel: usize) -> Finding {
        self.observe(SETTLE_US);
        let first_pa = mean_pa(&self.observe(WINDOW_US), channel);
        self.observe(WATCH_US - WINDOW_US);
        let last_pa = mean_pa(&self.observe(WINDOW_US), channel);
        let rate_pa_per_s = (last_pa - first_pa) * 1e6 / WATCH_US as f64;
        let text = format!("{:+.3} kPa/s at {:.2} kPa", rate_pa_per_s * 1e-3, last_pa * 1e-3);
        if rate_pa_per_s.abs() <= RATE_PA_PER_S { passed(text) } else { failed(self.with_faults(text)) }
    }

    /// Pulses the vent valve until its chamber is empty.
    fn vent(&mut self, index: u8, mut pulses: Pulses<'_>) -> Result<Finding, LinkError> {
        let channel = usize::from(index);
        let before = self.observe(REST_US);
        let (start_pa, supply_pa) = (mean_pa(&before, channel), supply_pa(&before));
        let (mut at_pa, mut pulse_us, mut spent_us, mut share) = (start_pa, VENT_US, 0, None);
        while at_pa > VENTED_PA && spent_us < VENTS_US {
            self.hand.pulse(index, PulseDirection::Vent, pulse_us)?;
            self.observe(u64::from(pulse_us) + REST_US / 2);
            // Venting cools the air left in the chamber, which lowers its pressure until the wall has warmed it.
            at_pa = mean_pa(&self.observe(REST_US), channel);
            pulses.add(pulse_us);
            if at_pa >= KEPT_SHARE * start_pa && at_pa <= (1.0 - LOST_SHARE) * start_pa {
                share = Some(pulses.share(start_pa, at_pa, supply_pa));
            }
            spent_us += pulse_us;
            pulse_us = VENT_MAX_US.min(2 * pulse_us);
        }
        let text = format!("{:.2} to {:.2} kPa", start_pa * 1e-3, at_pa * 1e-3);
        // A chamber that is empty already shows nothing of its vent.
        let is_good = at_pa <= VENTED_PA && start_pa - at_pa >= EFFECT_PA;
        Ok(if is_good { self.judged(&text, share) } else { failed(self.with_faults(text)) })
    }

    /// The verdict on a valve that works, by its flow if that was measured.
    fn judged(&self, text: &str, share: Option<Share>) -> Finding {
        match share {
            Some(share) if share.is_usable() => passed(format!("{text}: {share}")),
            Some(share) => failed(self.with_faults(format!("{text}: {share}"))),
            None => passed(text.to_owned()),
        }
    }
}

fn channels(heard: &[Telemetry]) -> usize {
    heard.first().map_or(0, |message| message.channels.len())
}

fn pressures_pa(heard: &[Telemetry], channel: usize) -> impl Iterator<Item = f64> {
    heard.iter().filter_map(move |message| Some(10.0 * f64::from(message.channels.get(channel)?.pressure_10pa)))
}

/// Mean pressure of a channel, Pa; not a number without measurements.
pub(super) fn mean_pa(heard: &[Telemetry], channel: usize) -> f64 {
    mean(pressures_pa(heard, channel))
}

/// Standard deviation of a channel's pressure, Pa.
pub(super) fn scatter_pa(heard: &[Telemetry], channel: usize) -> f64 {
    let mean_pa = mean_pa(heard, channel);
    mean(pressures_pa(heard, channel).map(|pressure_pa| (pressure_pa - mean_pa).powi(2))).sqrt()
}

/// Rise of a channel's pressure from the first quarter of the measurements to the last, Pa.
pub(super) fn rise_pa(heard: &[Telemetry], channel: usize) -> f64 {
    let quarter = heard.len() / 4;
    mean_pa(&heard[heard.len() - quarter..], channel) - mean_pa(&heard[..quarter], channel)
}

/// Mean pressure of the supply, Pa.
pub(super) fn supply_pa(heard: &[Telemetry]) -> f64 {
    let last = &heard[heard.len() / 2..];
    mean(last.iter().map(|message| 10.0 * f64::from(message.supply_10pa)))
}

/// Whether the device finds a sensor plausible.
pub(super) fn is_plausible(message: &Telemetry, channel: usize) -> bool {
    let sample = message.channels.get(channel);
    sample.is_some_and(|sample| sample.status.bits() & ChannelStatus::SENSOR_IMPLAUSIBLE.bits() == 0)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}
