//! The simulated camera: what it makes of the position of a tip.

use nalgebra::Vector3;
use softlimb_numerics::Random;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Streams of the images' noise, of the calibration's error and of the images without a tip.
const NOISE: u64 = 1;
const OFFSET: u64 = 2;
const DROP_OUTS: u64 = 3;

/// Largest part of a period by which an image may come early: reports of a device are not exactly periodic.
const EARLY: f64 = 0.05;

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
