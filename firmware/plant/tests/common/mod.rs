//! Plants shared by the tests.

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};
use softlimb_plant::*;

/// Coils of one channel: nothing, filling, venting.
pub(crate) const HOLD: ChannelDrive = ChannelDrive { fill_us: 0, vent_us: 0 };
pub(crate) const FILL: ChannelDrive = ChannelDrive { fill_us: 1_000, vent_us: 0 };
pub(crate) const VENT: ChannelDrive = ChannelDrive { fill_us: 0, vent_us: 1_000 };

/// An extending actuator of about 80 mL.
pub(crate) fn extender() -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: 11e-3,
        outer_radius_m: 15e-3,
        length_m: 0.21,
        material: Material::NeoHookean { shear_modulus_pa: 0.2226e6 },
        fiber: Some(Fiber {
            angle_rad: 0.05,
            families: Families::Two,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 15e-3,
        }),
    }
}

/// A bending actuator of about 11 mL.
pub(crate) fn bender() -> ActuatorParameters<f64> {
    ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: None,
    }
}

/// A plant of `channels` nominal extenders.
pub(crate) fn settings(seed: u64, channels: usize) -> PlantSettings {
    PlantSettings::new(seed, vec![ChannelSettings::new(extender()); channels])
}

/// Steps `ticks` times with the same coils on every channel.
pub(crate) fn run(plant: &mut Plant, ticks: usize, coils: ChannelDrive) {
    let channels = [coils; 64];
    for _ in 0..ticks {
        plant.step(&Drive { channels: &channels, supply_open: true, pump: 1.0, gripper_on: false });
    }
}

/// A valve command per tick that is different for each channel and repeats for each call:
/// 20 ms periods with pulses of every length.
pub(crate) fn pulses(tick: usize, channel: usize) -> ChannelDrive {
    let period = tick / 20;
    let at_us = (tick % 20) * 1_000;
    let mix = (period * 7_919 + channel * 104_729) % 1_000;
    let pulse_us = mix * 12;
    let on = pulse_us.saturating_sub(at_us).min(1_000) as u16;
    if (period / 25 + channel).is_multiple_of(2) {
        ChannelDrive { fill_us: on, vent_us: 0 }
    } else {
        ChannelDrive { fill_us: 0, vent_us: on }
    }
}
