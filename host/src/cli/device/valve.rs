//! `softlimb device valve`: one valve by hand, and what its chamber says to it.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::super::port::MeasuringDevice;
use super::super::shared::{above_zero, show};
use super::super::{Failure, Outcome, warn};
use softlimb_rig::link::{Direct, PulseDirection, Transport};
use softlimb_scene::Quantity;

/// Time for the measurement before the pulse, and for line and chamber to come to rest after it, us.
const REST_US: u64 = 300_000;
/// Change of pressure from which on a valve has an effect, Pa: several times the scatter of a sensor.
const EFFECT_PA: f64 = 200.0;
/// Pressure below which a vent has nothing to let out, Pa.
const EMPTY_PA: f64 = 1_000.0;

/// Open one valve for a time, and compare the pressure of its chamber before and after
#[derive(Args)]
#[command(
    after_help = "The device takes it where it is ready or holding. It closes the valve by itself, watches all faults meanwhile, and stops a\n\
                  filling valve at the channel's highest pressure. It lets the pressure down once it hears no host for a while.\n\
                  A valve without effect is a warning.\n\n\
                  Examples:\n  softlimb device valve 0 fill 50 --port /dev/ttyACM0 --scene scenes/single-bending.toml\n  \
                  softlimb device valve 0 vent 0.2s --port /dev/ttyACM0"
)]
pub(super) struct Valve {
    /// Channel, from 0
    channel: u8,
    /// The valve
    valve: Side,
    /// Time for which its coil is energized, 1 to 1000 ms
    #[arg(value_name = "MS", value_parser = above_zero("ms", 1000.0))]
    time: Quantity,
    #[command(flatten)]
    device: MeasuringDevice,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Valve of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
enum Side {
    /// The one that lets air in from the supply
    Fill,
    /// The one that lets air out
    Vent,
}

/// What the pulse did. Pressures are gauge, Pa.
#[derive(Debug, PartialEq, Serialize)]
struct Pulse {
    channel: u8,
    valve: Side,
    time_s: f64,
    before_pa: f64,
    after_pa: f64,
    /// Whether the pressure moved as it must; absent where there was no pressure to let out.
    effect: Option<bool>,
}

impl Valve {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let time_us = (self.time.si() * 1e6).round() as u32;
        if time_us < 1_000 {
            return Err(Failure::wrong_line(format!("time = {} is not allowed: 1 ms to 1000 ms", self.time)));
        }
        let direction = match self.valve {
            Side::Fill => PulseDirection::Fill,
            Side::Vent => PulseDirection::Vent,
        };
        let [before_pa, after_pa] = self.device.by_hand(|hand| {
            hand.wait(REST_US)?;
            let before_pa = pressure_pa(hand, self.channel);
            hand.pulse(self.channel, direction, time_us)?;
            hand.wait(u64::from(time_us) + REST_US)?;
            Ok([before_pa, pressure_pa(hand, self.channel)])
        })?;
        let effect = effect(self.valve, before_pa, after_pa);
        let (channel, valve) = (self.channel, self.valve);
        let pulse = Pulse { channel, valve, time_s: self.time.si(), before_pa, after_pa, effect };
        show(self.json, &pulse, || pulse.line())?;
        Ok(warn(&pulse.warning().into_iter().collect::<Vec<_>>()))
    }
}

fn pressure_pa<T: Transport>(hand: &Direct<'_, T>, channel: u8) -> f64 {
    let sample = hand.telemetry().and_then(|telemetry| telemetry.channels.get(usize::from(channel)));
    sample.map_or(f64::NAN, |sample| 10.0 * f64::from(sample.pressure_10pa))
}

/// Whether the pressure moved as the valve must have it; `None` where there was nothing to let out.
fn effect(valve: Side, before_pa: f64, after_pa: f64) -> Option<bool> {
    match valve {
        Side::Fill => Some(after_pa - before_pa >= EFFECT_PA),
        Side::Vent if before_pa < EMPTY_PA => None,
        Side::Vent => Some(before_pa - after_pa >= EFFECT_PA),
    }
}

impl Pulse {
    fn line(&self) -> String {
        let verdict = match self.effect {
            Some(true) => "passed",
            Some(false) => "no effect",
            None => "nothing to let out: fill first",
        };
        let valve = format!("{:?}", self.valve).to_lowercase();
        let [before, after] = [self.before_pa, self.after_pa].map(|pressure_pa| pressure_pa * 1e-3);
        let ms = self.time_s * 1e3;
        format!("channel {}: {valve} for {ms:.0} ms, {before:.2} kPa, then {after:.2} kPa: {verdict}\n", self.channel)
    }

    fn warning(&self) -> Option<String> {
        let look = match self.valve {
            Side::Fill => {
                "the supply (`softlimb device sensors`), the coil and its driver, the hose, the sensor; or pulse for longer"
            }
            Side::Vent => "the coil and its driver, a blocked outlet, the sensor; or pulse for longer",
        };
        (self.effect == Some(false))
            .then(|| format!("channel {}: the pressure did not move: look at {look}", self.channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_must_move_the_way_of_the_valve() {
        assert_eq!(effect(Side::Fill, 0.0, 200.0), Some(true));
        assert_eq!(effect(Side::Fill, 5_000.0, 5_190.0), Some(false));
        assert_eq!(effect(Side::Vent, 5_000.0, 0.0), Some(true));
        assert_eq!(effect(Side::Vent, 5_000.0, 5_300.0), Some(false));
        assert_eq!(effect(Side::Vent, 900.0, 0.0), None);
        assert_eq!(effect(Side::Fill, f64::NAN, 200.0), Some(false));
    }
}
