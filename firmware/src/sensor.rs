//! From ADC codes to calibrated gauge pressure: ratiometric conversion, plausibility, zero.

use softlimb_protocol::Telemetry;

/// A raw sample of the converter, `0..=` the full scale of the configuration. Not a pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct AdcCode(pub u16);

/// Samples in a row outside the band before a sensor counts as implausible, and inside before it counts as plausible again.
const DEBOUNCE_SAMPLES: u8 = 3;

/// Samples averaged for the zero, and those from one mean to the next: half a second.
const ZERO_SAMPLES: u16 = 32;
const ZERO_PERIOD: u16 = 500;

/// Largest change between two means of an empty chamber: share of the sensor's span.
const REST_LIMIT: f32 = 0.0005;

/// Number of means, taken over five seconds, from which on a reading that still changes is an error.
pub(crate) const RESTLESS_MEANS: u8 = 11;

/// Largest zero offset that is calibrated away, and largest fall below a zero: share of the sensor's span.
const ZERO_LIMIT: f32 = 0.03;

/// Transfer function of a ratiometric sensor (ASDX class): 10 % of full scale at `min_pa`, 90 % at `max_pa`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorScale {
    min_pa: f32,
    span_pa: f32,
    full_scale: f32,
}

impl SensorScale {
    /// A sensor whose 10 % and 90 % points are at the given gauge pressures in Pa (`min_pa < max_pa`), read by a converter of
    /// `full_scale` codes (> 0).
    pub fn new(min_pa: f32, max_pa: f32, full_scale: u16) -> Self {
        Self { min_pa, span_pa: max_pa - min_pa, full_scale: f32::from(full_scale) }
    }

    /// Gauge pressure of a sample, Pa, without the zero correction: `P = (u - 0.1)(Pmax - Pmin)/0.8 + Pmin`.
    pub fn pressure_pa(&self, code: AdcCode) -> f32 {
        (self.share(code) - 0.1) / 0.8 * self.span_pa + self.min_pa
    }

    /// Whether the sample lies within 2.5-97.5 % of full scale, where an intact sensor can be; an open or a short leaves it.
    pub fn is_plausible(&self, code: AdcCode) -> bool {
        (0.025..=0.975).contains(&self.share(code))
    }

    /// Largest zero offset that calibration may take away, and largest fall below a zero, Pa.
    pub fn zero_limit_pa(&self) -> f32 {
        ZERO_LIMIT * self.span_pa
    }

    /// Largest change of the reading of an empty chamber in half a second, Pa.
    pub(crate) fn rest_limit_pa(&self) -> f32 {
        REST_LIMIT * self.span_pa
    }

    fn share(&self, code: AdcCode) -> f32 {
        f32::from(code.0) / self.full_scale
    }
}

/// A voltage divider at an input of the converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoltageScale {
    full_scale_mv: u16,
    full_scale: u16,
}

impl VoltageScale {
    /// A divider that reaches `full_scale` codes (> 0) at `full_scale_mv`; 0 mV if the board has none.
    pub fn new(full_scale_mv: u16, full_scale: u16) -> Self {
        Self { full_scale_mv, full_scale }
    }

    /// Voltage of a sample, mV, rounded down: at most the full scale. [`Telemetry::VALVE_SUPPLY_NOT_SENSED`] without a divider.
    pub fn millivolts(&self, code: AdcCode) -> u16 {
        if self.full_scale_mv == 0 {
            return Telemetry::VALVE_SUPPLY_NOT_SENSED;
        }
        let code = u32::from(code.0.min(self.full_scale));
        // At most the full scale, so that the cast loses nothing.
        (code * u32::from(self.full_scale_mv) / u32::from(self.full_scale)) as u16
    }
}

/// State of one sensor: plausibility with debounce, the last good pressure, the zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    raw_pa: f32,
    step_pa: f32,
    zero_pa: f32,
    plausible: bool,
    against: u8,
}

impl Sensor {
    /// A sensor nobody has read yet: implausible until three good samples.
    pub const fn new() -> Self {
        Self { raw_pa: 0.0, step_pa: 0.0, zero_pa: 0.0, plausible: false, against: 0 }
    }

    /// Takes one sample. A sample outside the band leaves the pressure at its last good value.
    pub fn sample(&mut self, scale: &SensorScale, code: AdcCode) {
        let plausible = scale.is_plausible(code);
        let before_pa = self.raw_pa;
        if plausible {
            self.raw_pa = scale.pressure_pa(code);
        }
        self.step_pa = self.raw_pa - before_pa;
        if plausible != self.plausible {
            self.against += 1;
        } else {
            self.against = 0;
        }
        if self.against >= DEBOUNCE_SAMPLES {
            self.plausible = plausible;
            self.against = 0;
        }
    }

    /// Calibrated gauge pressure of the last plausible sample, Pa.
    pub fn pressure_pa(&self) -> f32 {
        self.raw_pa - self.zero_pa
    }

    /// Change from the last sample to this one, Pa.
    pub fn step_pa(&self) -> f32 {
        self.step_pa
    }

    /// Uncalibrated gauge pressure of the last plausible sample, Pa.
    pub fn raw_pa(&self) -> f32 {
        self.raw_pa
    }

    /// Whether three samples in a row left the band and no three came back.
    pub fn is_implausible(&self) -> bool {
        !self.plausible
    }

    /// The offset that is subtracted, Pa.
    pub fn zero_pa(&self) -> f32 {
        self.zero_pa
    }

    /// Sets the offset that is subtracted from now on, Pa.
    pub fn set_zero(&mut self, zero_pa: f32) {
        self.zero_pa = zero_pa;
    }
}

impl Default for Sensor {
    fn default() -> Self {
        Self::new()
    }
}

/// What is known of the channels' zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Zeros {
    /// Nothing: they are taken.
    Unknown,
    /// They were taken, and the chambers were vented since: readings are compared with them.
    Stored,
    /// They hold.
    Checked,
}

/// Means of one sensor's samples while its chamber is open to the atmosphere: one of 32 samples every half second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ZeroCheck {
    sum_pa: f32,
    mean_pa: f32,
    place: u16,
    means: u8,
}

/// A mean of 32 samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// Pa.
    pub(crate) mean_pa: f32,
    /// Difference to the mean before, Pa; infinite for the first.
    pub(crate) change_pa: f32,
    /// Number of means up to this one.
    pub(crate) count: u8,
}

impl ZeroCheck {
    /// No sample yet.
    pub(crate) const fn new() -> Self {
        Self { sum_pa: 0.0, mean_pa: f32::INFINITY, place: 0, means: 0 }
    }

    /// Adds a sample, Pa; `Some` once 32 are in.
    pub(crate) fn add(&mut self, raw_pa: f32) -> Option<Mean> {
        let place = self.place;
        self.place = (place + 1) % ZERO_PERIOD;
        if place < ZERO_SAMPLES {
            self.sum_pa += raw_pa;
        }
        if place + 1 != ZERO_SAMPLES {
            return None;
        }
        let mean_pa = core::mem::take(&mut self.sum_pa) / f32::from(ZERO_SAMPLES);
        let before_pa = core::mem::replace(&mut self.mean_pa, mean_pa);
        self.means = self.means.saturating_add(1);
        Some(Mean { mean_pa, change_pa: mean_pa - before_pa, count: self.means })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ASDX 030PG on a 12-bit converter.
    fn asdx() -> SensorScale {
        SensorScale::new(0.0, 206_843.0, 4095)
    }

    fn settled(code: u16) -> Sensor {
        let mut sensor = Sensor::new();
        for _ in 0..3 {
            sensor.sample(&asdx(), AdcCode(code));
        }
        sensor
    }

    #[test]
    fn ten_and_ninety_percent_are_the_ends_of_the_range() {
        let scale = SensorScale::new(0.0, 206_843.0, 1000);
        assert!(scale.pressure_pa(AdcCode(100)).abs() < 0.1);
        assert!((scale.pressure_pa(AdcCode(900)) - 206_843.0).abs() < 0.1);
        assert!((scale.pressure_pa(AdcCode(500)) - 103_421.5).abs() < 0.1);
    }

    #[test]
    fn band_is_2_5_to_97_5_percent() {
        let scale = SensorScale::new(0.0, 1.0, 1000);
        for (code, good) in [(0, false), (24, false), (25, true), (975, true), (976, false), (1000, false)] {
            assert_eq!(scale.is_plausible(AdcCode(code)), good, "{code}");
        }
    }

    #[test]
    fn voltage_is_in_proportion_to_the_code() {
        let divider = VoltageScale::new(36_300, 4_095);
        for (code, millivolts) in [(0, 0), (1, 8), (2_708, 24_004), (4_095, 36_300), (u16::MAX, 36_300)] {
            assert_eq!(divider.millivolts(AdcCode(code)), millivolts, "{code}");
        }
        assert_eq!(VoltageScale::new(60_000, u16::MAX).millivolts(AdcCode(u16::MAX)), 60_000);
        assert_eq!(VoltageScale::new(0, 4_095).millivolts(AdcCode(2_708)), Telemetry::VALVE_SUPPLY_NOT_SENSED);
    }

    #[test]
    fn three_samples_in_a_row_decide_both_ways() {
        let mut sensor = settled(2000);
        assert!(!sensor.is_implausible());
        let good = sensor.pressure_pa();
        for code in [0, 0, 2000, 0, 0] {
            sensor.sample(&asdx(), AdcCode(code));
        }
        assert!(!sensor.is_implausible(), "two in a row are not three");
        sensor.sample(&asdx(), AdcCode(0));
        assert!(sensor.is_implausible());
        assert_eq!(sensor.pressure_pa(), good, "the last good value stays");
        for _ in 0..3 {
            sensor.sample(&asdx(), AdcCode(2000));
        }
        assert!(!sensor.is_implausible());
    }

    #[test]
    fn zero_is_the_mean_of_32_samples_each_half_a_second() {
        let mut check = ZeroCheck::new();
        for sample in 0..1_500 {
            let mean = check.add(if sample < 500 { 500.0 } else { 450.0 });
            let expected = match sample {
                31 => Some((500.0, f32::NEG_INFINITY, 1)),
                531 => Some((450.0, -50.0, 2)),
                1_031 => Some((450.0, 0.0, 3)),
                _ => None,
            };
            assert_eq!(mean.map(|mean| (mean.mean_pa, mean.change_pa, mean.count)), expected, "{sample}");
        }
        let mut sensor = settled(2000);
        let before = sensor.pressure_pa();
        sensor.set_zero(500.0);
        assert!((before - sensor.pressure_pa() - 500.0).abs() < 0.01);
    }
}
