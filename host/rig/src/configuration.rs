//! Configuration of the device before a run: limits, valves, sensors, and one actuator per channel.

use fra_model::{ActuatorParameters, Families, Material, Motion, Placement};
use softlimb_protocol::{
    ConfigChannel, ConfigInverse, ConfigSystem, ConfigVolume, FiberPlacement, LinkLossPolicy, MaterialLaw, MotionKind,
    PressureLoopKind,
};

use crate::link::DeviceConfiguration;
use softlimb_limb::{Limb, LimbModule};
use softlimb_motion::{ModuleInverse, dead_volume_m3, line_conductance_m3_per_s_pa, to_wire, wire_kind};
use softlimb_scene::{LinkLoss, PressureLoop, Scene};

/// Room left beyond the limits of setpoints for the rounding to wire units, wire units.
const SETPOINT_MARGIN: i32 = 2;

/// The configuration a scene asks for, with the tables of its modules. The device models its actuators from the scene's nominal
/// values.
pub fn configuration(scene: &Scene, inverses: &[ModuleInverse], limb: &Limb) -> DeviceConfiguration {
    let channels =
        limb.modules().iter().flat_map(|module| module.channels.clone().map(move |c| channel(scene, module, c)));
    let (mut volumes, mut all_inverses) = (Vec::new(), Vec::new());
    for (module, inverse) in limb.modules().iter().zip(inverses) {
        for number in module.channels.clone().map(wire_number) {
            if let Some((volume, inverse)) = inverse.messages() {
                volumes.push(ConfigVolume { channel: number, ..volume });
                all_inverses.extend(inverse.map(|inverse| ConfigInverse { channel: number, ..inverse }));
            }
        }
    }
    DeviceConfiguration { system: system(scene), channels: channels.collect(), volumes, inverses: all_inverses }
}

/// A channel's number on the wire; there are at most 27.
fn wire_number(channel: usize) -> u8 {
    u8::try_from(channel).unwrap_or(u8::MAX)
}

/// Voltage at the converter's full scale, mV: 3.3 V behind the divider of `docs/reference/hardware.md`.
const VALVE_SUPPLY_FULL_SCALE_MV: u16 = 36_300;

fn system(scene: &Scene) -> ConfigSystem {
    let (controller, plant, limits) = (scene.controller(), scene.plant(), scene.limits());
    let voltage_min_v = limits.valve_voltage_min_v.as_deref();
    ConfigSystem {
        session: 0,
        telemetry_period_us: controller.telemetry_period_us,
        control_period_us: controller.control_period_us,
        link_timeout_us: controller.link_timeout_us,
        hold_time_us: controller.hold_time_us,
        link_loss_policy: match controller.link_loss {
            LinkLoss::HoldThenRamp => LinkLossPolicy::HoldThenRamp,
            LinkLoss::Hold => LinkLossPolicy::Hold,
            LinkLoss::Vent => LinkLossPolicy::Vent,
        }
        .into(),
        vent_ramp_pa_per_s: controller.vent_ramp_pa_per_s as f32,
        supply_min_pa: limits.supply_min_pa as f32,
        supply_max_pa: limits.supply_max_pa as f32,
        atmosphere_pa: plant.ambient.pressure_pa as f32,
        temperature_k: plant.ambient.temperature_k as f32,
        valve_conductance_m3_per_s_pa: plant.valve.conductance_m3_per_s_pa as f32,
        valve_critical_ratio: plant.valve.critical_ratio as f32,
        valve_on_delay_us: (plant.valve.on_delay_s * 1e6).round() as u32,
        valve_off_delay_us: (plant.valve.off_delay_s * 1e6).round() as u32,
        line_conductance_m3_per_s_pa: line_conductance_m3_per_s_pa(&plant.line) as f32,
        sensor_min_pa: 0.0,
        sensor_max_pa: plant.sensor.full_scale_pa as f32,
        supply_sensor_min_pa: 0.0,
        supply_sensor_max_pa: plant.sensor.supply_full_scale_pa as f32,
        adc_full_scale: plant.sensor.adc_full_scale(),
        pressure_loop: match controller.pressure_loop {
            PressureLoop::Pulses => PressureLoopKind::Pulses,
            PressureLoop::ProportionalIntegral => PressureLoopKind::ProportionalIntegral,
            PressureLoop::OnOff => PressureLoopKind::OnOff,
        }
        .into(),
        // A board may have no divider: its input then has no meaning.
        valve_supply_scale_mv: voltage_min_v.map_or(0, |_| VALVE_SUPPLY_FULL_SCALE_MV),
        valve_supply_min_mv: voltage_min_v.map_or(0, |least_v| (1e3 * least_v).round() as u16),
    }
}

fn channel(scene: &Scene, module: &LimbModule, channel: usize) -> ConfigChannel {
    let actuator: &ActuatorParameters<f64> = module.actuator.parameters();
    let (law, c_pa) = match actuator.material {
        Material::NeoHookean { shear_modulus_pa } => (MaterialLaw::NeoHookean, [shear_modulus_pa, 0.0, 0.0]),
        Material::Yeoh { c_pa } => (MaterialLaw::Yeoh, c_pa),
    };
    let fiber = actuator.fiber;
    let (least, most) = setpoint_limits(module);
    ConfigChannel {
        session: 0,
        channel: wire_number(channel),
        motion: motion_kind(actuator.motion).into(),
        setpoint_kind: wire_kind(module.kind).into(),
        law: law.into(),
        families: fiber.map_or(0, |f| if f.families == Families::One { 1 } else { 2 }),
        placement: fiber.map_or(FiberPlacement::Sheet, |f| placement(f.placement)).into(),
        inner_radius_m: actuator.inner_radius_m as f32,
        outer_radius_m: actuator.outer_radius_m as f32,
        length_m: actuator.length_m as f32,
        c_pa_1: c_pa[0] as f32,
        c_pa_2: c_pa[1] as f32,
        c_pa_3: c_pa[2] as f32,
        fiber_angle_rad: fiber.map_or(0.0, |f| f.angle_rad as f32),
        fiber_modulus_pa: fiber.map_or(0.0, |f| f.modulus_pa as f32),
        fiber_thickness_m: fiber.map_or(0.0, |f| f.thickness_m as f32),
        fiber_radius_m: fiber.map_or(actuator.outer_radius_m, |f| f.radius_m) as f32,
        pressure_max_pa: module.pressure_max_pa as f32,
        dead_volume_m3: dead_volume_m3(scene) as f32,
        setpoint_min: least,
        setpoint_max: most,
    }
}

/// The setpoints between rest and the highest pressure, wherever on the way they are extreme.
fn setpoint_limits(module: &LimbModule) -> (i32, i32) {
    let wire = module.curve.states().iter().map(|state| to_wire(module.kind, module.measure(state)));
    let (least, most) = wire.fold((i32::MAX, i32::MIN), |(a, b), value| (a.min(value), b.max(value)));
    // Only a twist has values below zero; for all others the margin ends there.
    let floor = if least < 0 { i32::MIN } else { 0 };
    (least.saturating_sub(SETPOINT_MARGIN).max(floor), most.saturating_add(SETPOINT_MARGIN))
}

fn motion_kind(motion: Motion) -> MotionKind {
    match motion {
        Motion::Extension => MotionKind::Extension,
        Motion::Expansion => MotionKind::Expansion,
        Motion::Bending => MotionKind::Bending,
        Motion::Twisting => MotionKind::Twisting,
    }
}

fn placement(placement: Placement) -> FiberPlacement {
    match placement {
        Placement::Sheet => FiberPlacement::Sheet,
        Placement::Layer => FiberPlacement::Layer,
        Placement::Smeared => FiberPlacement::Smeared,
    }
}
