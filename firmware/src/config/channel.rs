//! One channel's part of the configuration.

use fra_model::{
    ActuatorParameters, Families, Fiber, InvalidParameter, InverseTable, Material, Motion, Placement, Target, Tracker,
    VolumeTable,
};
use softlimb_protocol::{
    ConfigChannel, ConfigInverse, ConfigVolume, FiberPlacement, MaterialLaw, MotionKind, SetpointKind,
};

use super::{ConfigError, StagingError, known, number, tables, within};

/// The reference keeps this distance from the pressure limit, Pa, at which the channel is vented.
const REFERENCE_MARGIN_PA: f32 = 3_000.0;

/// An actuator with its limits and the meaning of its setpoint.
#[derive(Clone, Copy, Debug)]
pub struct ChannelConfig {
    /// Source of its pressures.
    pub source: Source,
    /// Volume of the lumen without pressure, m3.
    pub rest_volume_m3: f32,
    /// Meaning of the setpoint.
    pub setpoint_kind: SetpointKind,
    /// Lowest and highest setpoint, in the unit of the setpoint.
    pub setpoint_range: (i32, i32),
    /// Gauge pressure above which the channel is vented, Pa.
    pub pressure_max_pa: f32,
    /// Air volume of fittings and line, m3.
    pub dead_volume_m3: f32,
}

/// Source of pressures and volumes of a channel.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// Not at all: the device does not solve the model of this actuator, and the host has sent no tables yet.
    Nothing,
    /// By the model of a tube with closed forms, where the host sent no tables.
    Model(Tracker<f32>),
    /// The volume in a table; the setpoint is the pressure.
    Volume(VolumeTable<f32>),
    /// Volume and pressure in tables.
    Tables(VolumeTable<f32>, InverseTable<f32>),
}

impl Source {
    /// The volume over the pressure, where the host sent a table.
    pub fn volume_table(&self) -> Option<&VolumeTable<f32>> {
        match self {
            Self::Volume(volume) | Self::Tables(volume, _) => Some(volume),
            Self::Nothing | Self::Model(_) => None,
        }
    }

    /// The pressure over the setpoint, where the host sent a table.
    pub fn inverse_table(&self) -> Option<&InverseTable<f32>> {
        match self {
            Self::Tables(_, inverse) => Some(inverse),
            _ => None,
        }
    }
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
        if self.source.volume_table().is_some() {
            return Err(StagingError::Mismatch);
        }
        self.source = Source::Volume(tables::volume(self, wire)?);
        Ok(())
    }

    /// Takes the inverse table, once, behind the volume table.
    ///
    /// # Errors
    /// [`StagingError`]; the channel is as before.
    pub(super) fn set_inverse(&mut self, wire: &ConfigInverse) -> Result<(), StagingError> {
        match self.source {
            Source::Volume(volume) if self.setpoint_kind != SetpointKind::Pressure => {
                self.source = Source::Tables(volume, tables::inverse(self, wire)?);
                Ok(())
            }
            _ => Err(StagingError::Mismatch),
        }
    }

    /// Whether the device can do without its model, or has it for everything: a volume alone is enough for a pressure only.
    pub(super) fn has_all_tables_or_none(&self) -> bool {
        self.setpoint_kind == SetpointKind::Pressure || !matches!(self.source, Source::Volume(_))
    }

    /// Whether the device needs tables and has none.
    pub(super) fn lacks_tables(&self) -> bool {
        matches!(self.source, Source::Nothing)
    }

    /// The deformation behind a setpoint in SI units; `None` for a pressure.
    pub fn target(&self, setpoint: f32) -> Option<Target<f32>> {
        target(self.setpoint_kind, setpoint)
    }
}

impl TryFrom<&ConfigChannel> for ChannelConfig {
    type Error = ConfigError;

    fn try_from(wire: &ConfigChannel) -> Result<Self, ConfigError> {
        let parameters = parameters(wire)?;
        let model = Tracker::new(&parameters).map_err(|error| ConfigError::OutOfRange { field: wire_field(&error) })?;
        let setpoint_kind = known(number!(ConfigChannel, "setpoint_kind"), wire.setpoint_kind)?;
        within(number!(ConfigChannel, "setpoint_max"), wire.setpoint_max, wire.setpoint_min..=i32::MAX)?;
        check_setpoint(parameters.motion, setpoint_kind, wire.setpoint_min, number!(ConfigChannel, "setpoint_min"))?;
        check_setpoint(parameters.motion, setpoint_kind, wire.setpoint_max, number!(ConfigChannel, "setpoint_max"))?;
        let ActuatorParameters { inner_radius_m, length_m, .. } = parameters;
        Ok(Self {
            source: model.map_or(Source::Nothing, Source::Model),
            rest_volume_m3: core::f32::consts::PI * inner_radius_m * inner_radius_m * length_m,
            setpoint_kind,
            setpoint_range: (wire.setpoint_min, wire.setpoint_max),
            pressure_max_pa: within(number!(ConfigChannel, "pressure_max_pa"), wire.pressure_max_pa, 1e3..=1e6)?,
            dead_volume_m3: within(number!(ConfigChannel, "dead_volume_m3"), wire.dead_volume_m3, 0.0..=1e-2)?,
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

/// A deformation must be one of the motion at both ends of the range; whether it can be reached shows at run time.
fn check_setpoint(motion: Motion, kind: SetpointKind, setpoint: i32, field: u8) -> Result<(), ConfigError> {
    let is_of_motion =
        kind == SetpointKind::Pressure || (kind == SetpointKind::BendAngle) == (motion == Motion::Bending);
    if is_of_motion && tables::is_in_domain(kind, kind.from_wire(setpoint)) {
        Ok(())
    } else {
        Err(ConfigError::OutOfRange { field })
    }
}

fn parameters(wire: &ConfigChannel) -> Result<ActuatorParameters<f32>, ConfigError> {
    let motion = match known(number!(ConfigChannel, "motion"), wire.motion)? {
        MotionKind::Extension => Motion::Extension,
        MotionKind::Expansion => Motion::Expansion,
        MotionKind::Bending => Motion::Bending,
        MotionKind::Twisting => Motion::Twisting,
    };
    Ok(ActuatorParameters {
        motion,
        inner_radius_m: within(number!(ConfigChannel, "inner_radius_m"), wire.inner_radius_m, 1e-5..=1.0)?,
        outer_radius_m: within(number!(ConfigChannel, "outer_radius_m"), wire.outer_radius_m, 1e-5..=1.0)?,
        length_m: within(number!(ConfigChannel, "length_m"), wire.length_m, 1e-4..=10.0)?,
        material: material(wire)?,
        fiber: fiber(wire)?,
    })
}

fn material(wire: &ConfigChannel) -> Result<Material<f32>, ConfigError> {
    let c1 = within(number!(ConfigChannel, "c_pa_1"), wire.c_pa_1, 1.0..=1e9)?;
    let c2 = within(number!(ConfigChannel, "c_pa_2"), wire.c_pa_2, -1e9..=1e9)?;
    let c3 = within(number!(ConfigChannel, "c_pa_3"), wire.c_pa_3, -1e9..=1e9)?;
    Ok(match known(number!(ConfigChannel, "law"), wire.law)? {
        MaterialLaw::NeoHookean => Material::NeoHookean { shear_modulus_pa: c1 },
        MaterialLaw::Yeoh => Material::Yeoh { c_pa: [c1, c2, c3] },
    })
}

fn fiber(wire: &ConfigChannel) -> Result<Option<Fiber<f32>>, ConfigError> {
    let placement = match known(number!(ConfigChannel, "placement"), wire.placement)? {
        FiberPlacement::Sheet => Placement::Sheet,
        FiberPlacement::Layer => Placement::Layer,
        FiberPlacement::Smeared => Placement::Smeared,
    };
    let fiber = Fiber {
        angle_rad: within(number!(ConfigChannel, "fiber_angle_rad"), wire.fiber_angle_rad, -1.571..=1.571)?,
        families: if wire.families == 1 { Families::One } else { Families::Two },
        modulus_pa: within(number!(ConfigChannel, "fiber_modulus_pa"), wire.fiber_modulus_pa, 0.0..=1e12)?,
        placement,
        thickness_m: within(number!(ConfigChannel, "fiber_thickness_m"), wire.fiber_thickness_m, 0.0..=1.0)?,
        radius_m: within(number!(ConfigChannel, "fiber_radius_m"), wire.fiber_radius_m, 0.0..=1.0)?,
    };
    Ok((within(number!(ConfigChannel, "families"), wire.families, 0..=2)? > 0).then_some(fiber))
}

/// The wire's number for a field of the model.
fn wire_field(error: &InvalidParameter<f32>) -> u8 {
    match error.field {
        "inner_radius_m" => number!(ConfigChannel, "inner_radius_m"),
        "outer_radius_m" => number!(ConfigChannel, "outer_radius_m"),
        "length_m" => number!(ConfigChannel, "length_m"),
        "shear_modulus_pa" | "c_pa[0]" => number!(ConfigChannel, "c_pa_1"),
        "c_pa[1]" => number!(ConfigChannel, "c_pa_2"),
        "c_pa[2]" => number!(ConfigChannel, "c_pa_3"),
        "angle_rad" => number!(ConfigChannel, "fiber_angle_rad"),
        "modulus_pa" => number!(ConfigChannel, "fiber_modulus_pa"),
        "thickness_m" => number!(ConfigChannel, "fiber_thickness_m"),
        "radius_m" => number!(ConfigChannel, "fiber_radius_m"),
        _ => number!(ConfigChannel, "families"),
    }
}
