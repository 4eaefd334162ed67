//! A ratiometric pressure sensor read by a converter.

use crate::random::Random;
use crate::settings::SensorSettings;

/// Share of full scale at the low end of the range.
const LOW: f64 = 0.1;
/// Share of full scale between the ends of the range.
const SPAN: f64 = 0.8;
/// The output stage cannot leave these shares of full scale.
const RAILS: (f64, f64) = (0.025, 0.975);

/// A sensor with its own calibration error.
#[derive(Clone, Debug)]
pub(crate) struct Sensor {
    settings: SensorSettings,
    offset_pa: f64,
    gain: f64,
    lagged_pa: f64,
}

impl Sensor {
    /// A sensor that reads `offset_pa + gain * pressure`.
    pub(crate) fn new(settings: SensorSettings, offset_pa: f64, gain: f64) -> Self {
        Self { settings, offset_pa, gain, lagged_pa: 0.0 }
    }

    /// Lets the sensing element follow a gauge pressure for `h_s` seconds.
    pub(crate) fn follow(&mut self, pressure_pa: f64, h_s: f64) {
        self.lagged_pa += (pressure_pa - self.lagged_pa) * h_s / (self.settings.lag_s + h_s);
    }

    /// Moves the offset by `change_pa`.
    pub(crate) fn drift(&mut self, change_pa: f64) {
        self.offset_pa += change_pa;
    }

    /// Puts the sensing element at a gauge pressure that has been there for long.
    pub(crate) fn settle(&mut self, pressure_pa: f64) {
        self.lagged_pa = pressure_pa;
    }

    /// The code of the converter now.
    pub(crate) fn sample(&self, random: &mut Random) -> u16 {
        let s = &self.settings;
        let reading = self.offset_pa + self.gain * self.lagged_pa + s.noise_pa * random.noise();
        let share = LOW + SPAN * (reading - s.min_pa) / (s.max_pa - s.min_pa);
        let clipped = share.clamp(RAILS.0, RAILS.1);
        (clipped * f64::from(s.adc_full_scale)).round() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quiet() -> SensorSettings {
        SensorSettings { min_pa: 0.0, max_pa: 200e3, lag_s: 0.0, noise_pa: 0.0, adc_full_scale: 4_000 }
    }

    fn code(sensor: &mut Sensor, pressure_pa: f64) -> u16 {
        sensor.follow(pressure_pa, 1e-3);
        sensor.sample(&mut Random::new(1, 0))
    }

    #[test]
    fn transfer_is_ten_to_ninety_per_cent() {
        let mut s = Sensor::new(quiet(), 0.0, 1.0);
        assert_eq!(code(&mut s, 0.0), 400);
        assert_eq!(code(&mut s, 100e3), 2_000);
        assert_eq!(code(&mut s, 200e3), 3_600);
    }

    #[test]
    fn output_stops_at_the_rails() {
        let mut s = Sensor::new(quiet(), 0.0, 1.0);
        assert_eq!(code(&mut s, 1e6), 3_900);
        assert_eq!(code(&mut s, -1e6), 100);
    }

    #[test]
    fn codes_are_quantised_to_the_nearest() {
        let mut s = Sensor::new(quiet(), 0.0, 1.0);
        // One code is 200 kPa / 3200 = 62.5 Pa.
        assert_eq!(code(&mut s, 31.0), 400);
        assert_eq!(code(&mut s, 32.0), 401);
    }

    #[test]
    fn calibration_error_shifts_and_scales() {
        let mut s = Sensor::new(quiet(), 1_250.0, 1.01);
        assert_eq!(code(&mut s, 0.0), 420);
        assert_eq!(code(&mut s, 100e3), 2_000 + 20 + 16);
    }

    #[test]
    fn lag_reaches_63_per_cent_after_its_time() {
        let settings = SensorSettings { lag_s: 0.02, ..quiet() };
        let mut s = Sensor::new(settings, 0.0, 1.0);
        for _ in 0..2_000 {
            s.follow(100e3, 1e-5);
        }
        let expected = 100e3 * (1.0 - (-1.0f64).exp());
        assert!((s.lagged_pa / expected - 1.0).abs() < 1e-3);
    }

    #[test]
    fn noise_has_the_stated_deviation() {
        let settings = SensorSettings { noise_pa: 1_000.0, ..quiet() };
        let mut s = Sensor::new(settings, 0.0, 1.0);
        s.follow(100e3, 1e-3);
        let mut random = Random::new(9, 0);
        let codes: Vec<f64> = (0..20_000).map(|_| f64::from(s.sample(&mut random))).collect();
        let mean = codes.iter().sum::<f64>() / 20_000.0;
        let variance = codes.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / 20_000.0;
        // 1000 Pa are 16 codes.
        assert!((mean - 2_000.0).abs() < 0.5, "{mean}");
        assert!((variance.sqrt() - 16.0).abs() < 0.3, "{variance}");
    }
}
