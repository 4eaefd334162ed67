//! Parts that break.

use crate::random::Random;

/// A broken part of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelFault {
    /// The fill valve stays open.
    StuckFill,
    /// The vent valve stays open.
    StuckVent,
    /// A hole in the actuator.
    Leak {
        /// Its sonic conductance, m3/(s Pa); 0..=1e-7. A slow puncture is 2e-11, a torn tube 1e-9.
        conductance_m3_per_s_pa: f64,
    },
    /// The wire of the pressure sensor is off: the converter reads 0.
    SensorOpen,
}

/// A fault with its place and time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFault {
    /// Plant time at which the part breaks, us; it takes effect at the next tick.
    pub time_us: u64,
    /// The channel.
    pub channel: usize,
    /// Kind of the fault.
    pub fault: ChannelFault,
}

impl TimedFault {
    /// Draws one fault by `seed`: any kind, any of `channels` channels, uniform in time from
    /// `from_us` to `until_us`.
    pub fn draw(seed: u64, channels: usize, from_us: u64, until_us: u64) -> Self {
        let mut random = Random::new(seed, u64::MAX);
        let fault = match random.below(4) {
            0 => ChannelFault::StuckFill,
            1 => ChannelFault::StuckVent,
            2 => ChannelFault::Leak { conductance_m3_per_s_pa: 2e-11 + 1e-9 * random.unit() },
            _ => ChannelFault::SensorOpen,
        };
        Self {
            time_us: from_us + random.below(until_us.saturating_sub(from_us)),
            channel: random.below(channels as u64) as usize,
            fault,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_cover_kinds_channels_and_the_window() {
        let faults: Vec<_> = (0..200).map(|seed| TimedFault::draw(seed, 3, 1_000, 2_000)).collect();
        assert!(faults.iter().all(|f| f.channel < 3 && (1_000..2_000).contains(&f.time_us)));
        let kinds: std::collections::HashSet<_> = faults.iter().map(|f| std::mem::discriminant(&f.fault)).collect();
        assert_eq!(kinds.len(), 4);
        let channels: std::collections::HashSet<_> = faults.iter().map(|f| f.channel).collect();
        assert_eq!(channels.len(), 3);
        assert_eq!(TimedFault::draw(5, 3, 0, 9), TimedFault::draw(5, 3, 0, 9));
    }
}
