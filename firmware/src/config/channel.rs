//! One channel's part of the configuration.

use fra_model::{
    Actuator, ActuatorParameters, Families, Fiber, InvalidParameter, InverseTable, Load, Material, Motion, Placement,
    State, Target, VolumeTable,
};
use softlimb_protocol::{
    ConfigChannel, ConfigInverse, ConfigVolume, FiberPlacement, MaterialLaw, MotionKind, SetpointKind,
};

use super::{ConfigError, StagingError, known, tables, within};

/// The reference keeps this distance from the pressure limit, Pa, at which the channel is vented.
const REFERENCE_MARGIN_PA: f32 = 3_000.0;

/// An actuator with its limits and the meaning of its setpoint.
#[derive(Clone, Copy, Debug)]
pub struct ChannelConfig {
    /// The actuator's model, ready to solve.
    pub actuator: Actuator<f32>,
    /// Its state without pressure.
    pub rest: State<f32>,
    /// Meaning of the setpoint.
    pub setpoint_kind: SetpointKind,
    /// Lowest and highest setpoint, in the unit of the setpoint.
    pub setpoint_range: (i32, i32),
    /// Gauge pressure above which the channel is vented, Pa.
    pub pressure_max_pa: f32,
    /// Air volume of fittings and line, m3.
    pub dead_volume_m3: f32,
    /// Its volume over the pressure, where the host sent a table; else the model is solved for it.
    pub volume_table: Option<VolumeTable<f32>>,
    /// Its pressure over the setpoint, where the host sent a table; else the model is solved for it. Only beside a volume table.
    pub inverse_table: Option<InverseTable<f32>>,
}

impl ChannelConfig {
    /// Highest gauge pressure that the loop may aim at, Pa.
    pub fn reference_max_pa(&self) -> f32 {
        self.pressure_max_pa - REFERENCE_MARGIN_PA.min(0.1 * self.pressure_max_pa)
    }

    /// Takes the volume table, once.
    ///
    /// # Errors
    /// [`StagingError`]; the channel is as before.
    pub(super) fn set_volume(&mut self, wire: &ConfigVolume) -> Result<(), StagingError> {
        if self.volume_table.is_some() {
            return Err(StagingError::Mismatch);
        }
        self.volume_table = Some(tables::volume(self, wire)?);
        Ok(())
    }

    /// Takes the inverse table, once, behind the volume table.
    ///
    /// # Errors
    /// [`StagingError`]; the channel is as before.
    pub(super) fn set_inverse(&mut self, wire: &ConfigInverse) -> Result<(), StagingError> {
        let has_no_use = self.setpoint_kind == SetpointKind::Pressure;
        if self.volume_table.is_none() || self.inverse_table.is_some() || has_no_use {
            return Err(StagingError::Mismatch);
        }
        self.inverse_table = Some(tables::inverse(self, wire)?);
        Ok(())
    }

    /// Whether the device can do without its model, or has it for everything: a volume alone is enough for a pressure only.
    pub(super) fn has_all_tables_or_none(&self) -> bool {
        let needs_inverse = self.volume_table.is_some() && self.setpoint_kind != SetpointKind::Pressure;
        self.inverse_table.is_some() == needs_inverse
    }

    /// The deformation behind a setpoint in SI units; `None` for a pressure.
    pub fn target(&self, setpoint: f32) -> Option<Target<f32>> {
        target(self.setpoint_kind, setpoint)
    }
}

impl TryFrom<&ConfigChannel> for ChannelConfig {
    type Error = ConfigError;

    fn try_from(wire: &ConfigChannel) -> Result<Self, ConfigError> {
        let actuator =
            Actuator::new(&parameters(wire)?).map_err(|error| ConfigError::OutOfRange { field: wire_field(&error) })?;
        let setpoint_kind = known("setpoint_kind", wire.setpoint_kind)?;
        within("setpoint_max", wire.setpoint_max, wire.setpoint_min..=i32::MAX)?;
        check_target(&actuator, setpoint_kind, wire.setpoint_min, "setpoint_min")?;
        check_target(&actuator, setpoint_kind, wire.setpoint_max, "setpoint_max")?;
        Ok(Self {
            actuator,
            rest: actuator.rest(),
            setpoint_kind,
            setpoint_range: (wire.setpoint_min, wire.setpoint_max),
            pressure_max_pa: within("pressure_max_pa", wire.pressure_max_pa, 1e3..=1e6)?,
            dead_volume_m3: within("dead_volume_m3", wire.dead_volume_m3, 0.0..=1e-2)?,
            volume_table: None,
            inverse_table: None,
        })
    }
}

fn target(kind: SetpointKind, setpoint: f32) -> Option<Target<f32>> {
    match kind {
        SetpointKind::Pressure => None,
        SetpointKind::AxialStretch => Some(Target::AxialStretch(setpoint)),
        SetpointKind::OuterRadius => Some(Target::OuterRadius(setpoint)),
        SetpointKind::InnerRadius => Some(Target::InnerRadius(setpoint)),
        SetpointKind::Twist => Some(Target::Twist(setpoint)),
        SetpointKind::BendAngle => Some(Target::BendAngle(setpoint)),
    }
}

/// The model must know the deformation at both ends of the range; whether it can be reached shows at run time. One iteration says as
/// much as all of them, and a device that solves for long looks dead to its watchdog.
fn check_target(
    actuator: &Actuator<f32>,
    kind: SetpointKind,
    setpoint: i32,
    field: &'static str,
) -> Result<(), ConfigError> {
    let Some(target) = target(kind, kind.from_wire(setpoint)) else {
        return Ok(());
    };
    actuator
        .inverse_near(&actuator.rest(), target, &Load::none(), 1)
        .map(|_| ())
        .map_err(|_| ConfigError::OutOfRange { field })
}

fn parameters(wire: &ConfigChannel) -> Result<ActuatorParameters<f32>, ConfigError> {
    let motion = match known("motion", wire.motion)? {
        MotionKind::Extension => Motion::Extension,
        MotionKind::Expansion => Motion::Expansion,
        MotionKind::Bending => Motion::Bending,
        MotionKind::Twisting => Motion::Twisting,
    };
    Ok(ActuatorParameters {
        motion,
        inner_radius_m: within("inner_radius_m", wire.inner_radius_m, 1e-5..=1.0)?,
        outer_radius_m: within("outer_radius_m", wire.outer_radius_m, 1e-5..=1.0)?,
        length_m: within("length_m", wire.length_m, 1e-4..=10.0)?,
        material: material(wire)?,
        fiber: fiber(wire)?,
    })
}

fn material(wire: &ConfigChannel) -> Result<Material<f32>, ConfigError> {
    let c1 = within("c_pa_1", wire.c_pa_1, 1.0..=1e9)?;
    let c2 = within("c_pa_2", wire.c_pa_2, -1e9..=1e9)?;
    let c3 = within("c_pa_3", wire.c_pa_3, -1e9..=1e9)?;
    Ok(match known("law", wire.law)? {
        MaterialLaw::NeoHookean => Material::NeoHookean { shear_modulus_pa: c1 },
        MaterialLaw::Yeoh => Material::Yeoh { c_pa: [c1, c2, c3] },
    })
}

fn fiber(wire: &ConfigChannel) -> Result<Option<Fiber<f32>>, ConfigError> {
    let placement = match known("placement", wire.placement)? {
        FiberPlacement::Sheet => Placement::Sheet,
        FiberPlacement::Layer => Placement::Layer,
        FiberPlacement::Smeared => Placement::Smeared,
    };
    let fiber = Fiber {
        angle_rad: within("fiber_angle_rad", wire.fiber_angle_rad, -1.571..=1.571)?,
        families: if wire.families == 1 { Families::One } else { Families::Two },
        modulus_pa: within("fiber_modulus_pa", wire.fiber_modulus_pa, 0.0..=1e12)?,
        placement,
        thickness_m: within("fiber_thickness_m", wire.fiber_thickness_m, 0.0..=1.0)?,
        radius_m: within("fiber_radius_m", wire.fiber_radius_m, 0.0..=1.0)?,
    };
    Ok((within("families", wire.families, 0..=2)? > 0).then_some(fiber))
}

/// The wire's name for a field of the model.
fn wire_field(error: &InvalidParameter<f32>) -> &'static str {
    match error.field {
        "shear_modulus_pa" | "c_pa[0]" => "c_pa_1",
        "c_pa[1]" => "c_pa_2",
        "c_pa[2]" => "c_pa_3",
        "angle_rad" => "fiber_angle_rad",
        "modulus_pa" => "fiber_modulus_pa",
        "thickness_m" => "fiber_thickness_m",
        "radius_m" => "fiber_radius_m",
        other => other,
    }
}
