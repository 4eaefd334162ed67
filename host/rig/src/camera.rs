//! The simulated camera: positions of the tip with noise, a constant error, and gaps.

use nalgebra::Vector3;
use softlimb_numerics::Random;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Streams of the images' noise, of the calibration's error and of the images without a tip. The plant draws its limb from streams below 2^34.
const NOISE: u64 = 1;
pub(crate) const OFFSET: u64 = 1 << 34;
const DROP_OUTS: u64 = OFFSET + 1;

/// Largest part of a period by which an observation may come early: reports of a device are not exactly periodic.
pub(crate) const EARLY: f64 = 0.05;

/// A camera with normal noise in each coordinate and a constant error.
pub(crate) struct Camera {
    settings: scene::Camera,
    offset_m: Vector3<f64>,
    noise: Random,
    drop_outs: Random,
    /// Time from which on it takes an image, s.
    next_s: f64,
}

impl Camera {
    /// Takes images with the noise of a seed; the error of its calibration is that of a limb's seed.
    pub(crate) fn new(settings: scene::Camera, seed: u64, limb: u64) -> Self {
        let mut offset = Random::new(limb, OFFSET);
        let offset_m = Vector3::from_fn(|_, _| settings.offset_m * offset.normal());
        let [noise, drop_outs] = [NOISE, DROP_OUTS].map(|stream| Random::new(seed, stream));
        Self { settings, offset_m, noise, drop_outs, next_s: f64::NEG_INFINITY }
    }

    /// The camera of a scene, without calibration error and with an image of each report where the scene has none; `noise_m` replaces its noise.
    pub(crate) fn learning(scene: &Scene, noise_m: f64, (seed, limb): (u64, u64)) -> Self {
        let plain =
            scene::Camera { feedback: false, period_s: 0.0, latency_s: 0.0, noise_m, offset_m: 0.0, drop_outs: 0.0 };
        Self::new(scene.camera().map_or(plain, |camera| scene::Camera { noise_m, ..*camera }), seed, limb)
    }

    /// Time begins anew.
    pub(crate) fn restart(&mut self) {
        self.next_s = f64::NEG_INFINITY;
    }

    /// The position in the image of a time, s, which rises from call to call; `None` where no image is due or the tip is not found in it.
    pub(crate) fn image(&mut self, time_s: f64, tip_m: &Vector3<f64>) -> Option<Vector3<f64>> {
        if time_s < self.next_s {
            return None;
        }
        self.next_s = time_s + (1.0 - EARLY) * self.settings.period_s;
        if self.settings.drop_outs > 0.0 && self.drop_outs.uniform() < self.settings.drop_outs {
            return None;
        }
        Some(tip_m + self.offset_m + self.noise_m())
    }

    /// Noise of one image, m.
    pub(crate) fn noise_m(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.settings.noise_m * self.noise.normal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: scene::Camera =
        scene::Camera { feedback: false, period_s: 0.1, latency_s: 0.0, noise_m: 0.0, offset_m: 1e-3, drop_outs: 0.0 };

    #[test]
    fn images_are_a_period_apart() {
        let mut camera = Camera::new(SETTINGS, 1, 1);
        // Reports come every 20 ms, a little late or early.
        let times = (0..100).map(|index| 0.02 * f64::from(index) + if index % 2 == 0 { 1e-4 } else { -1e-4 });
        let taken: Vec<f64> = times.filter(|time_s| camera.image(*time_s, &Vector3::zeros()).is_some()).collect();
        assert_eq!(taken.len(), 20, "{taken:?}");
        assert!(taken.windows(2).all(|pair| (pair[1] - pair[0] - 0.1).abs() < 1e-3), "{taken:?}");
        camera.restart();
        assert!(camera.image(0.0, &Vector3::zeros()).is_some());
    }

    #[test]
    fn error_of_the_calibration_is_the_limbs_and_constant() {
        let seen = |seed, limb| {
            let mut camera = Camera::new(SETTINGS, seed, limb);
            [0.0, 1.0].map(|time_s| camera.image(time_s, &Vector3::new(1.0, 2.0, 3.0)).unwrap())
        };
        let [first, later] = seen(1, 7);
        assert_eq!(first, later);
        assert_eq!([first, later], seen(2, 7));
        assert_ne!([first, later], seen(1, 8));
        let squares = (0..1000).map(|limb| (seen(1, limb)[0] - Vector3::new(1.0, 2.0, 3.0)).norm_squared());
        let deviation_m = (squares.sum::<f64>() / 3000.0).sqrt();
        assert!((deviation_m / 1e-3 - 1.0).abs() < 0.05, "{deviation_m}");
    }

    #[test]
    fn share_of_the_images_has_no_tip() {
        let mut camera = Camera::new(scene::Camera { drop_outs: 0.3, ..SETTINGS }, 1, 1);
        let times = (0..10_000).map(f64::from);
        let lost = times.filter(|time_s| camera.image(*time_s, &Vector3::zeros()).is_none()).count();
        assert!((2_800..3_200).contains(&lost), "{lost}");
    }
}
