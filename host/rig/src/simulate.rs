//! From a scene to the simulated device that runs it.

use softlimb_sim::SimSettings;
use softlimb_sim::plant::{
    ActuatorLaw, ChannelSettings, PlantSettings, PumpSettings, SegmentSettings, SensorSettings, Spread, Supply,
    TubeSettings, ValveSettings, ValveSupplySettings,
};

use fra_model::{ActuatorParameters, Fiber, State};
use softlimb_limb::{Bend, Limb, LimbModule, StateCurve};
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// The relief valve opens at this multiple of the pressure a reservoir is charged to. The pump is the device's to stop.
const RELIEF_RATIO: f64 = 1.1;
/// The pressure that volumes and shapes are tabulated to, as a multiple of the module's limit: room for overshoot.
const TABULATED_RATIO: f64 = 1.3;

/// Settings of the simulated MCU and plant of a scene. `seed` decides everything random in the plant.
pub fn settings(scene: &Scene, limb: &Limb, seed: u64) -> SimSettings {
    let plant = scene.plant();
    let channels = limb.modules().iter().flat_map(|module| {
        let nominal = ChannelSettings {
            pressure_max_pa: TABULATED_RATIO * module.pressure_max_pa,
            dead_volume_m3: plant.chamber.dead_volume_m3,
            wall_w_per_k: plant.chamber.wall_heat_w_per_k,
            creep_share: plant.chamber.creep_share,
            creep_time_s: plant.chamber.creep_time_s,
            valve: valve(&plant.valve),
            tube: TubeSettings {
                length_m: plant.line.length_m,
                bore_m: plant.line.inner_diameter_m,
                ..TubeSettings::default()
            },
            sensor: sensor(&plant.sensor, plant.sensor.full_scale_pa),
            leak_m3_per_s_pa: plant.valve.leak_m3_per_s_pa,
            second_fiber: module.second_fiber().copied(),
            law: law(module.bend()),
            segments: module.segments().iter().map(segment).collect(),
            ..ChannelSettings::new(*module.actuator.parameters())
        };
        module.channels.clone().map(move |_| nominal.clone())
    });
    let mut settings = PlantSettings::new(seed, channels.collect());
    settings.atmosphere_pa = plant.ambient.pressure_pa;
    settings.temperature_k = plant.ambient.temperature_k;
    settings.supply = supply(&plant.supply);
    settings.supply_sensor = sensor(&plant.sensor, plant.sensor.supply_full_scale_pa);
    settings.valve_supply = ValveSupplySettings {
        voltage_v: plant.valve.voltage_v,
        adc_full_scale: plant.sensor.adc_full_scale(),
        ..ValveSupplySettings::default()
    };
    settings.spread = spread(&plant.spread);
    settings.gripper_time_s = scene.gripper_time_s();
    SimSettings { seed, ..SimSettings::new(settings) }
}

fn segment(segment: &LimbModule) -> SegmentSettings {
    SegmentSettings {
        actuator: *segment.actuator.parameters(),
        second_fiber: segment.second_fiber().copied(),
        law: law(segment.bend()),
    }
}

/// The law of a true actuator whose bend has this model.
fn law(bend: Option<Bend>) -> Option<ActuatorLaw> {
    bend.filter(|bend| bend.is_by_section()).map(|_| ActuatorLaw(by_section))
}

/// Equilibria of a true bending actuator whose model is the finite elements of its section. Where these do not reach the room for overshoot, they end at the limit.
fn by_section(
    actuator: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressures_pa: &[f64],
) -> Option<Vec<State<f64>>> {
    let highest_pa = pressures_pa.last()?;
    let up_to = |most_pa: f64| StateCurve::by_section(actuator, second_fiber, most_pa).ok();
    let curve = up_to(*highest_pa).or_else(|| up_to(highest_pa / TABULATED_RATIO))?;
    let reached = pressures_pa.iter().take_while(|pressure_pa| **pressure_pa <= curve.pressure_max_pa());
    Some(reached.map(|pressure_pa| curve.at(*pressure_pa)).collect())
}

fn valve(valve: &scene::Valve) -> ValveSettings {
    ValveSettings {
        conductance_m3_per_s_pa: valve.conductance_m3_per_s_pa,
        critical_ratio: valve.critical_ratio,
        on_delay_us: valve.on_delay_s * 1e6,
        off_delay_us: valve.off_delay_s * 1e6,
        // Uniform over +-jitter_us, whose standard deviation is 1/sqrt(3) of it.
        jitter_us: 3f64.sqrt() * valve.jitter_s * 1e6,
    }
}

fn sensor(sensor: &scene::Sensor, full_scale_pa: f64) -> SensorSettings {
    SensorSettings {
        min_pa: 0.0,
        max_pa: full_scale_pa,
        lag_s: sensor.lag_s,
        noise_pa: sensor.noise_pa,
        adc_full_scale: sensor.adc_full_scale(),
    }
}

fn supply(supply: &scene::Supply) -> Supply {
    match *supply {
        scene::Supply::Regulated { pressure_pa } => Supply::Regulated { pressure_pa },
        scene::Supply::Pump { pressure_pa, flow_m3_per_s, stall_pressure_pa, reservoir_volume_m3 } => {
            Supply::Pump(PumpSettings {
                free_flow_normal_m3_per_s: flow_m3_per_s,
                stall_pressure_pa,
                reservoir_volume_m3,
                initial_pressure_pa: pressure_pa,
                relief_pressure_pa: RELIEF_RATIO * pressure_pa,
                ..PumpSettings::default()
            })
        }
    }
}

fn spread(spread: &scene::Spread) -> Spread {
    Spread {
        modulus: spread.modulus,
        wall_thickness: spread.wall,
        fiber_angle_rad: spread.fiber_angle_rad,
        // The volume follows from the wall and the moduli; no further spread of its own.
        volume: 0.0,
        dead_volume: spread.dead_volume,
        valve_conductance: spread.valve_conductance,
        valve_delay: spread.valve_delay,
        sensor_offset: spread.sensor_offset,
        sensor_gain: spread.sensor_gain,
    }
}
