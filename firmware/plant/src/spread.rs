//! True parameters of a channel: the nominal ones plus manufacturing tolerances.

use core::f64::consts::FRAC_PI_2;

use fra_model::{Actuator, ActuatorParameters, Fiber, InvalidParameter, Material};

use crate::random::Random;
use crate::settings::{ChannelSettings, SegmentSettings, SensorSettings, Spread, ValveSettings};

/// True parameters of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueSegment {
    /// The segment.
    pub actuator: ActuatorParameters<f64>,
    /// Its second winding.
    pub second_fiber: Option<Fiber<f64>>,
}

impl TrueSegment {
    /// The model of the segment.
    ///
    /// # Errors
    /// [`InvalidParameter`] names a field that the model does not accept.
    pub fn model(&self) -> Result<Actuator<f64>, InvalidParameter<f64>> {
        let actuator = Actuator::new(&self.actuator)?;
        self.second_fiber.as_ref().map_or(Ok(actuator), |second| actuator.with_second_fiber(second))
    }
}

/// True parameters of one channel, for reports only.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueParameters {
    /// The actuator.
    pub actuator: ActuatorParameters<f64>,
    /// Its second winding.
    pub second_fiber: Option<Fiber<f64>>,
    /// The segments of the actuator, where it is a series of them.
    pub segments: Vec<TrueSegment>,
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
        self.whole().model()
    }

    /// The actuator where it is no series.
    pub fn whole(&self) -> TrueSegment {
        TrueSegment { actuator: self.actuator, second_fiber: self.second_fiber }
    }

    /// Draws the parameters of one channel.
    pub(crate) fn draw(nominal: &ChannelSettings, spread: &Spread, random: &mut Random) -> Self {
        // Every parameter is drawn whatever its spread, so that switching one off leaves the
        // others as they were.
        let errors = Errors::draw(spread, random);
        let TrueSegment { actuator, second_fiber } = errors.of(&nominal.actuator, nominal.second_fiber);
        let of_segment = |segment: &SegmentSettings| errors.of(&segment.actuator, segment.second_fiber);
        let segments = nominal.segments.iter().map(of_segment).collect();
        let volume_scale = factor(spread.volume, random);
        let dead_volume_m3 = nominal.dead_volume_m3 * factor(spread.dead_volume, random);
        let fill = valve(&nominal.valve, spread, random);
        let vent = valve(&nominal.valve, spread, random);
        let (sensor_offset_pa, sensor_gain) = calibration(&nominal.sensor, spread, random);
        Self {
            actuator,
            second_fiber,
            segments,
            volume_scale,
            dead_volume_m3,
            fill,
            vent,
            sensor_offset_pa,
            sensor_gain,
        }
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

/// Errors of the making of one actuator, the same for all its segments and windings: one mould casts and one machine winds them.
struct Errors {
    modulus: f64,
    thickness: f64,
    angle_rad: f64,
}

impl Errors {
    fn draw(spread: &Spread, random: &mut Random) -> Self {
        Self {
            modulus: factor(spread.modulus, random),
            thickness: factor(spread.wall_thickness, random),
            angle_rad: spread.fiber_angle_rad * random.truncated_normal(),
        }
    }

    fn of(&self, nominal: &ActuatorParameters<f64>, mut second_fiber: Option<Fiber<f64>>) -> TrueSegment {
        let Self { modulus, thickness, angle_rad } = *self;
        let inner = nominal.inner_radius_m;
        let material = match nominal.material {
            Material::NeoHookean { shear_modulus_pa } => {
                Material::NeoHookean { shear_modulus_pa: shear_modulus_pa * modulus }
            }
            Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(|c| c * modulus) },
        };
        let outer_radius_m = inner + (nominal.outer_radius_m - inner) * thickness;
        let mut actuator = ActuatorParameters { outer_radius_m, material, ..*nominal };
        for fiber in actuator.fiber.iter_mut().chain(&mut second_fiber) {
            fiber.angle_rad = (fiber.angle_rad + angle_rad).clamp(-FRAC_PI_2, FRAC_PI_2);
            // The winding keeps its relative place in the wall.
            fiber.radius_m = inner + (fiber.radius_m - inner) * thickness;
        }
        TrueSegment { actuator, second_fiber }
    }
}
