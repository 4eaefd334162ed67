//! True pressures of a session beside those of a sound plant of the same seed.

use super::bench::CHANNELS;

/// Distance from the sound plant's pressures that is an effect, Pa.
const EFFECT_PA: f64 = 3e3;

/// Time by which the sound plant's pressures may come earlier or later, us: two periods of the loop, whose pulses no two runs share.
const NEAR_US: u64 = 40_000;

/// True pressures tick by tick.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Device time, us, and the pressure of each chamber, Pa.
    ticks: Vec<(u64, [f64; CHANNELS])>,
}

impl Trace {
    /// Takes the pressures of one tick.
    pub(super) fn push(&mut self, time_us: u64, pressures: impl Iterator<Item = f64>) {
        let mut of_tick = [0.0; CHANNELS];
        of_tick.iter_mut().zip(pressures).for_each(|(to, pressure_pa)| *to = pressure_pa);
        if self.ticks.last().is_none_or(|last| last.0 < time_us) {
            self.ticks.push((time_us, of_tick));
        }
    }

    /// First time from `from_us` on at which a pressure is 3 kPa outside those that the sound plant has about that time, us.
    pub(super) fn departs_us(&self, sound: &Self, from_us: u64) -> Option<u64> {
        let index = |trace: &Self, time_us| trace.ticks.partition_point(|tick| tick.0 < time_us);
        let (last_us, _) = sound.ticks.last()?;
        let ticks = self.ticks.get(index(self, from_us)..)?.iter();
        let is_off = |(time_us, pressures): &&(u64, [f64; CHANNELS])| {
            let window = index(sound, time_us.saturating_sub(NEAR_US))..index(sound, time_us + NEAR_US + 1);
            let near = sound.ticks.get(window).unwrap_or_default();
            pressures.iter().enumerate().any(|(channel, pressure_pa)| {
                let of_sound = near.iter().map(|(_, pressures)| pressures[channel]);
                let (least_pa, most_pa) =
                    of_sound.fold((f64::MAX, f64::MIN), |(least, most), it| (least.min(it), most.max(it)));
                *pressure_pa < least_pa - EFFECT_PA || *pressure_pa > most_pa + EFFECT_PA
            })
        };
        ticks.take_while(|tick| tick.0 <= *last_us).find(is_off).map(|tick| tick.0)
    }
}
