//! Two clocks: the host's, which is the time of the simulation, and the device's, which drives its ticks.

/// One tick of the device's clock, us.
pub(crate) const TICK_US: u64 = softlimb_plant::TICK_US;

/// Maps the device's ticks to the host's time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clocks {
    offset_us: u64,
    /// Device microseconds per host microsecond.
    rate: f64,
}

impl Clocks {
    pub(crate) fn new(offset_us: u64, drift_ppm: f64) -> Self {
        Self { offset_us, rate: 1.0 + drift_ppm * 1e-6 }
    }

    /// Device time of a tick, us.
    pub(crate) fn device_us(&self, tick: u64) -> u64 {
        self.offset_us + tick * TICK_US
    }

    /// Host time of a tick, us, rounded down.
    pub(crate) fn host_us(&self, tick: u64) -> u64 {
        self.host_us_at(tick, 0)
    }

    /// Host time `later_us` of the device's clock after a tick, us, rounded down.
    pub(crate) fn host_us_at(&self, tick: u64, later_us: u64) -> u64 {
        ((tick * TICK_US + later_us) as f64 / self.rate) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_clock_gains_its_drift() {
        let clocks = Clocks::new(5_000_000, 200.0);
        assert_eq!((clocks.device_us(0), clocks.host_us(0)), (5_000_000, 0));
        // 200 ppm are 2 s in 10 000 s.
        assert_eq!(clocks.device_us(10_002_000), 5_000_000 + 10_002_000_000);
        assert_eq!(clocks.host_us(10_002_000), 10_000_000_000);
        assert_eq!(clocks.host_us_at(10_002_000, 5_001), 10_000_005_000);
    }
}
