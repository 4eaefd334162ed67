//! True parameters of a channel: the nominal ones plus manufacturing tolerances.

use core::f64::consts::FRAC_PI_2;

use fra_model::{Actuator, ActuatorParameters, Fiber, InvalidParameter, Material};

use crate::random::Random;
use crate::settings::{ChannelSettings, SensorSettings, Spread, ValveSettings};

/// True parameters of one channel, for reports only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueParameters {
    /// The actuator.
    pub actuator: ActuatorParameters<f64>,
    /// Its second winding.
    pub second_fiber: Option<Fiber<f64>>,
    /// True gas volume of the actuator over that of the model.
    pub volume_scale: f64,
    /// Volume of the fittings, m3.
    pub dead_volume_m3: f64,
    /// The fill valve.
    pub fill: ValveSettings,
    /// The vent valve.
    pub vent: ValveSettings,
    /// Reading of the sensor at zero gauge, Pa.
    pub sensor_offset_pa: f64,
    /// Slope of the sensor's reading against the true pressure.
    pub sensor_gain: f64,
}

impl TrueParameters {
    /// The model of the actuator.
    ///
    /// # Errors
    /// [`InvalidParameter`] names a field that the model does not accept.
    pub fn model(&self) -> Result<Actuator<f64>, InvalidParameter<f64>> {
        let actuator = Actuator::new(&self.actuator)?;
        self.second_fiber.as_ref().map_or(Ok(actuator), |second| actuator.with_second_fiber(second))
    }

    /// Draws the parameters of one channel.
    pub(crate) fn draw(nominal: &ChannelSettings, spread: &Spread, random: &mut Random) -> Self {
        // Every parameter is drawn whatever its spread, so that switching one off leaves the
        // others as they were.
        let (actuator, second_fiber) = actuator(&nominal.actuator, nominal.second_fiber, spread, random);
        let volume_scale = factor(spread.volume, random);
        let dead_volume_m3 = nominal.dead_volume_m3 * factor(spread.dead_volume, random);
        let fill = valve(&nominal.valve, spread, random);
        let vent = valve(&nominal.valve, spread, random);
        let (sensor_offset_pa, sensor_gain) = calibration(&nominal.sensor, spread, random);
        Self { actuator, second_fiber, volume_scale, dead_volume_m3, fill, vent, sensor_offset_pa, sensor_gain }
    }
}

/// Offset, Pa, and gain of a sensor.
pub(crate) fn calibration(sensor: &SensorSettings, spread: &Spread, random: &mut Random) -> (f64, f64) {
    let span = sensor.max_pa - sensor.min_pa;
    let offset = span * spread.sensor_offset * random.truncated_normal();
    (offset, factor(spread.sensor_gain, random))
}

fn factor(deviation: f64, random: &mut Random) -> f64 {
    1.0 + deviation * random.truncated_normal()
}

fn valve(nominal: &ValveSettings, spread: &Spread, random: &mut Random) -> ValveSettings {
    ValveSettings {
        conductance_m3_per_s_pa: nominal.conductance_m3_per_s_pa * factor(spread.valve_conductance, random),
        on_delay_us: nominal.on_delay_us * factor(spread.valve_delay, random),
        off_delay_us: nominal.off_delay_us * factor(spread.valve_delay, random),
        ..*nominal
    }
}

/// The actuator and its second winding. Both windings have the same error of angle: one machine winds them.
fn actuator(
    nominal: &ActuatorParameters<f64>,
    mut second_fiber: Option<Fiber<f64>>,
    spread: &Spread,
    random: &mut Random,
) -> (ActuatorParameters<f64>, Option<Fiber<f64>>) {
    let modulus = factor(spread.modulus, random);
    let thickness = factor(spread.wall_thickness, random);
    let angle_rad = spread.fiber_angle_rad * random.truncated_normal();
    let inner = nominal.inner_radius_m;
    let material = match nominal.material {
        Material::NeoHookean { shear_modulus_pa } => {
            Material::NeoHookean { shear_modulus_pa: shear_modulus_pa * modulus }
        }
        Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(|c| c * modulus) },
    };
    let mut true_one = ActuatorParameters {
        outer_radius_m: inner + (nominal.outer_radius_m - inner) * thickness,
        material,
        ..*nominal
    };
    for fiber in true_one.fiber.iter_mut().chain(&mut second_fiber) {
        fiber.angle_rad = (fiber.angle_rad + angle_rad).clamp(-FRAC_PI_2, FRAC_PI_2);
        // The winding keeps its relative place in the wall.
        fiber.radius_m = inner + (fiber.radius_m - inner) * thickness;
    }
    (true_one, second_fiber)
}
