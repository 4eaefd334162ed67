//! The simulated inertial measurement units (IMUs): orientations and angular rates of the modules' end plates, with errors and gaps.
//!
//! Accelerations are not simulated.

use nalgebra::{UnitQuaternion, Vector3};
use softlimb_numerics::Random;
use softlimb_scene as scene;

use crate::camera::{EARLY, OFFSET};

/// Streams of the constant errors, of the readings' noise and of the lost readings, beside those of the camera.
const ERRORS: u64 = OFFSET + 2;
const NOISE: u64 = OFFSET + 3;
const DROP_OUTS: u64 = OFFSET + 4;

/// A reading of one IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reading {
    /// Orientation in the frame of the scene.
    pub(crate) orientation: UnitQuaternion<f64>,
    /// Mean angular rate since the last reading was due, in the frame of the IMU, rad/s; zero without noise in the first reading.
    pub(crate) rate_rad_per_s: Vector3<f64>,
}

/// One IMU on the end plate of each module. Its axes are those of the plate.
pub(crate) struct Imus {
    settings: scene::Imu,
    /// Constant errors of the orientations, as turns in the frame of the scene.
    errors: Vec<UnitQuaternion<f64>>,
    noise: Random,
    drop_outs: Random,
    /// Time, s, and true orientations of the last readings.
    last: Option<(f64, Vec<UnitQuaternion<f64>>)>,
}

impl Imus {
    /// As many IMUs with the noise of a seed; the constant errors are those of a limb's seed.
    pub(crate) fn new(settings: scene::Imu, count: usize, seed: u64, limb: u64) -> Self {
        let mut errors = Random::new(limb, ERRORS);
        let (tilt, heading) = (settings.tilt_error_rad, settings.heading_error_rad);
        let mut error = || Vector3::from([tilt, tilt, heading].map(|deviation| deviation * errors.normal()));
        let errors = (0..count).map(|_| UnitQuaternion::from_scaled_axis(error())).collect();
        let [noise, drop_outs] = [NOISE, DROP_OUTS].map(|stream| Random::new(seed, stream));
        Self { settings, errors, noise, drop_outs, last: None }
    }

    /// Whether readings are due at a time, s.
    pub(crate) fn are_due(&self, time_s: f64) -> bool {
        self.last.as_ref().is_none_or(|(last_s, _)| time_s >= last_s + (1.0 - EARLY) * self.settings.period_s)
    }

    /// Readings at a time, s, at which they are due, by the true orientations of the plates in the frame of the scene; `None` where one is lost.
    pub(crate) fn readings(&mut self, time_s: f64, orientations: Vec<UnitQuaternion<f64>>) -> Vec<Option<Reading>> {
        let last = self.last.take();
        let rate = |index: usize| {
            let Some((last_s, last)) = &last else { return Vector3::zeros() };
            // A turn about a fixed axis has the same coordinates in the frames of both of its ends.
            (last[index].inverse() * orientations[index]).scaled_axis() / (time_s - last_s)
        };
        let readings = (0..orientations.len()).map(|index| self.reading(index, &orientations[index], rate(index)));
        let readings = readings.collect();
        self.last = Some((time_s, orientations));
        readings
    }

    /// The reading of an IMU by its true orientation and rate.
    fn reading(&mut self, index: usize, orientation: &UnitQuaternion<f64>, rate: Vector3<f64>) -> Option<Reading> {
        let mut noise = |deviation: f64| Vector3::from_fn(|_, _| deviation * self.noise.normal());
        let noisy = orientation * UnitQuaternion::from_scaled_axis(noise(self.settings.noise_rad));
        let reading = Reading {
            orientation: self.errors[index] * noisy,
            rate_rad_per_s: rate + noise(self.settings.rate_noise_rad_per_s),
        };
        let is_lost = self.settings.drop_outs > 0.0 && self.drop_outs.uniform() < self.settings.drop_outs;
        (!is_lost).then_some(reading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_ERROR: scene::Imu = scene::Imu {
        feedback: false,
        period_s: 0.01,
        latency_s: 0.0,
        tilt_error_rad: 0.0,
        heading_error_rad: 0.0,
        noise_rad: 0.0,
        rate_noise_rad_per_s: 0.0,
        drop_outs: 0.0,
    };

    fn turned(vector: [f64; 3]) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(Vector3::from(vector))
    }

    /// Error of the orientation of a reading as a turn in the frame of the scene.
    fn error(reading: &Reading, truth: &UnitQuaternion<f64>) -> Vector3<f64> {
        (reading.orientation * truth.inverse()).scaled_axis()
    }

    #[test]
    fn constant_errors_are_the_limbs_and_have_the_stated_deviations() {
        let settings = scene::Imu { tilt_error_rad: 0.02, heading_error_rad: 0.05, ..NO_ERROR };
        let truth = turned([0.3, -1.0, 0.4]);
        let errors = |seed, limb| {
            let mut imus = Imus::new(settings, 2, seed, limb);
            [0.0, 1.0].map(|time_s| {
                let readings = imus.readings(time_s, vec![truth, turned([1.0, 0.0, 0.0]) * truth]);
                error(readings[0].as_ref().unwrap(), &truth)
            })
        };
        let [first, later] = errors(1, 7);
        assert!((first - later).norm() < 1e-12 && (first - errors(2, 7)[0]).norm() < 1e-12);
        assert!((first - errors(1, 8)[0]).norm() > 1e-3);
        let squares: Vector3<f64> = (0..1000).map(|limb| errors(1, limb)[0].map(|angle| angle * angle)).sum();
        let tilt = (0.5e-3 * (squares.x + squares.y)).sqrt();
        let heading = (1e-3 * squares.z).sqrt();
        assert!((tilt / 0.02 - 1.0).abs() < 0.05 && (heading / 0.05 - 1.0).abs() < 0.05, "{tilt} {heading}");
    }

    #[test]
    fn noise_of_readings_has_the_stated_deviations() {
        let settings = scene::Imu { noise_rad: 0.01, rate_noise_rad_per_s: 0.3, ..NO_ERROR };
        let truth = turned([0.1, 2.0, -0.4]);
        let mut imus = Imus::new(settings, 1, 1, 1);
        let readings: Vec<Reading> =
            (0..4000).map(|time| imus.readings(f64::from(time), vec![truth])[0].unwrap()).collect();
        let deviation = |of: &dyn Fn(&Reading) -> Vector3<f64>| {
            (readings.iter().map(|reading| of(reading).norm_squared()).sum::<f64>() / 12_000.0).sqrt()
        };
        let (angle, rate) =
            (deviation(&|reading| error(reading, &truth)), deviation(&|reading| reading.rate_rad_per_s));
        assert!((angle / 0.01 - 1.0).abs() < 0.03 && (rate / 0.3 - 1.0).abs() < 0.03, "{angle} {rate}");
    }

    #[test]
    fn rate_of_a_turning_frame_is_that_of_its_own_axes() {
        let mut imus = Imus::new(NO_ERROR, 1, 1, 1);
        // The frame turns about its own axes at 2 rad/s, from an orientation that has them elsewhere.
        let (start, rate) = (turned([0.7, -0.3, 1.9]), Vector3::new(1.2, 0.0, -1.6));
        for step in 0..50 {
            let time_s = 0.02 * f64::from(step);
            let reading =
                imus.readings(time_s, vec![start * UnitQuaternion::from_scaled_axis(rate * time_s)])[0].unwrap();
            let expected = if step == 0 { Vector3::zeros() } else { rate };
            assert!((reading.rate_rad_per_s - expected).norm() < 1e-9, "{step}: {}", reading.rate_rad_per_s);
        }
    }

    #[test]
    fn readings_are_a_period_apart_and_a_share_of_them_is_lost() {
        let mut imus = Imus::new(scene::Imu { period_s: 0.05, drop_outs: 0.3, ..NO_ERROR }, 3, 1, 1);
        let (mut due, mut lost) = (0, 0);
        for step in 0..10_000 {
            let time_s = 0.01 * f64::from(step);
            if imus.are_due(time_s) {
                due += 1;
                lost +=
                    imus.readings(time_s, vec![turned([0.0; 3]); 3]).iter().filter(|reading| reading.is_none()).count();
            }
        }
        assert_eq!(due, 2000);
        assert!((1_680..1_920).contains(&lost), "{lost}");
    }
}
