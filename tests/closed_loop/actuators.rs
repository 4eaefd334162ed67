//! The actuators of the bench, and what the device is told about them.

use fra_model::{
    Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, State, StateQuantity, Target,
    Tracker,
};
use softlimb_limb::StateCurve;
use softlimb_motion::ModuleInverse;
use softlimb_motion::inverse_table as table;
use softlimb_protocol::{
    ConfigChannel, ConfigInverse, ConfigSystem, ConfigVolume, FiberPlacement, LinkLossPolicy, MaterialLaw, MotionKind,
    PressureLoopKind, SetpointKind,
};

/// Gauge pressure above which a channel is vented, Pa.
pub(crate) const PRESSURE_MAX_PA: f64 = 100e3;
/// Gauge pressure that tables reach, Pa: more than any of the trajectories takes.
const TABULATED_PA: f64 = 70e3;
/// Sonic conductance of 1 m of 2.5 mm tube, m3/(s Pa): `0.029 d^2/sqrt(L/d^1.25 + 510)`.
const LINE_CONDUCTANCE: f32 = 3.78e-9;
/// Fittings, and the section of that tube times its length, m3.
const DEAD_VOLUME_M3: f32 = 1e-6 + 4.909e-6;

pub(crate) const NEO_HOOKEAN: Material<f64> = Material::NeoHookean { shear_modulus_pa: 0.223e6 };
/// Dragon Skin 30 by a fit to large stretches, Pa.
pub(crate) const YEOH: Material<f64> = Material::Yeoh { c_pa: [96e3, 9.5e3, 0.0] };

/// A tube of 10 mm and 14 mm radius, 240 mm long.
pub(crate) fn tube(motion: Motion, material: Material<f64>, fiber: Option<Fiber<f64>>) -> ActuatorParameters<f64> {
    ActuatorParameters { motion, inner_radius_m: 10e-3, outer_radius_m: 14e-3, length_m: 0.24, material, fiber }
}

/// Kevlar thread every 3 mm, as a sheet on the outer surface.
pub(crate) fn wound(angle_deg: f64, families: Families) -> Option<Fiber<f64>> {
    Some(Fiber {
        angle_rad: angle_deg.to_radians(),
        families,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: 14e-3,
    })
}

/// One actuator, and the quantity it is told to follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject {
    pub(crate) parameters: ActuatorParameters<f64>,
    pub(crate) kind: SetpointKind,
}

impl Subject {
    /// The quantity of the setpoint in a state, in SI units.
    pub(crate) fn measure(&self, state: &State<f64>) -> f64 {
        quantity(self.kind).of(state)
    }

    fn actuator(&self) -> Actuator<f64> {
        Actuator::new(&self.parameters).expect("a sound actuator")
    }

    /// The setpoint that belongs to a pressure, by the model in f64.
    pub(crate) fn setpoint_at(&self, pressure_pa: f64) -> f64 {
        self.measure(&self.actuator().forward(pressure_pa, &Load::none()).unwrap().state)
    }

    /// The pressure that belongs to a setpoint, by the model in f64.
    pub(crate) fn pressure_pa(&self, setpoint: f64) -> f64 {
        let target = match self.kind {
            SetpointKind::Pressure => return setpoint,
            SetpointKind::AxialStretch => Target::AxialStretch(setpoint),
            SetpointKind::OuterRadius => Target::OuterRadius(setpoint),
            SetpointKind::InnerRadius => Target::InnerRadius(setpoint),
            SetpointKind::Twist => Target::Twist(setpoint),
            SetpointKind::BendAngle => Target::BendAngle(setpoint),
        };
        self.actuator().inverse(target, &Load::none()).unwrap().state.pressure_pa
    }

    /// The tables of an actuator whose model the device does not solve, for channel 0.
    pub(crate) fn tables(&self) -> Option<(ConfigVolume, Option<ConfigInverse>)> {
        if Tracker::new(&self.parameters).expect("a sound actuator").is_some() {
            return None;
        }
        let (actuator, kind) = (self.actuator(), quantity(self.kind));
        let curve = StateCurve::new(&actuator, TABULATED_PA);
        let subject = table::Subject::new(&actuator, kind, &curve);
        let tables = table::device_tables(&subject, 1e-4, 101_325.0).unwrap_or_else(|reason| panic!("{reason}"));
        ModuleInverse::Table(tables).messages()
    }

    /// What the device is told.
    pub(crate) fn channel(&self) -> ConfigChannel {
        let p = &self.parameters;
        let ends = [0.0, PRESSURE_MAX_PA].map(|end_pa| self.kind.to_wire(self.setpoint_at(end_pa)).expect("fits"));
        let (law, [c1, c2, c3]) = match p.material {
            Material::NeoHookean { shear_modulus_pa } => (MaterialLaw::NeoHookean, [shear_modulus_pa, 0.0, 0.0]),
            Material::Yeoh { c_pa } => (MaterialLaw::Yeoh, c_pa),
        };
        let fiber = p.fiber;
        ConfigChannel {
            session: 0,
            channel: 0,
            motion: motion(p.motion).into(),
            setpoint_kind: self.kind.into(),
            law: law.into(),
            families: fiber.map_or(0, |fiber| if fiber.families == Families::One { 1 } else { 2 }),
            placement: FiberPlacement::Sheet.into(),
            inner_radius_m: p.inner_radius_m as f32,
            outer_radius_m: p.outer_radius_m as f32,
            length_m: p.length_m as f32,
            c_pa_1: c1 as f32,
            c_pa_2: c2 as f32,
            c_pa_3: c3 as f32,
            fiber_angle_rad: fiber.map_or(0.0, |fiber| fiber.angle_rad as f32),
            fiber_modulus_pa: fiber.map_or(0.0, |fiber| fiber.modulus_pa as f32),
            fiber_thickness_m: fiber.map_or(0.0, |fiber| fiber.thickness_m as f32),
            fiber_radius_m: fiber.map_or(p.outer_radius_m, |fiber| fiber.radius_m) as f32,
            pressure_max_pa: PRESSURE_MAX_PA as f32,
            dead_volume_m3: DEAD_VOLUME_M3,
            setpoint_min: ends[0].min(ends[1]),
            setpoint_max: ends[0].max(ends[1]),
        }
    }
}

/// The quantity of a setpoint on the wire.
fn quantity(kind: SetpointKind) -> StateQuantity {
    match kind {
        SetpointKind::Pressure => StateQuantity::Pressure,
        SetpointKind::AxialStretch => StateQuantity::AxialStretch,
        SetpointKind::OuterRadius => StateQuantity::OuterRadius,
        SetpointKind::InnerRadius => StateQuantity::InnerRadius,
        SetpointKind::Twist => StateQuantity::Twist,
        SetpointKind::BendAngle => StateQuantity::BendAngle,
    }
}

fn motion(motion: Motion) -> MotionKind {
    match motion {
        Motion::Extension => MotionKind::Extension,
        Motion::Expansion => MotionKind::Expansion,
        Motion::Bending => MotionKind::Bending,
        Motion::Twisting => MotionKind::Twisting,
    }
}

/// What all channels share: the nominal plant of the simulation.
pub(crate) fn system() -> ConfigSystem {
    ConfigSystem {
        session: 0,
        telemetry_period_us: 20_000,
        control_period_us: 20_000,
        link_timeout_us: 250_000,
        hold_time_us: 2_000_000,
        link_loss_policy: LinkLossPolicy::HoldThenRamp.into(),
        vent_ramp_pa_per_s: 50_000.0,
        supply_min_pa: 110e3,
        supply_max_pa: 240e3,
        atmosphere_pa: 101_325.0,
        temperature_k: 293.15,
        valve_conductance_m3_per_s_pa: 1.44e-9,
        valve_critical_ratio: 0.3,
        valve_on_delay_us: 3_500,
        valve_off_delay_us: 2_000,
        line_conductance_m3_per_s_pa: LINE_CONDUCTANCE,
        sensor_min_pa: 0.0,
        sensor_max_pa: 206_843.0,
        supply_sensor_min_pa: 0.0,
        supply_sensor_max_pa: 689_476.0,
        adc_full_scale: 4095,
        pressure_loop: PressureLoopKind::Pulses.into(),
        valve_supply_scale_mv: 36_300,
        valve_supply_min_mv: 20_000,
    }
}
