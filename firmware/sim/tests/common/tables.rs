//! Tables of the bending actuators that tests use: the device does not solve their model.
#![allow(dead_code, unreachable_pub, reason = "each user takes its own part")]

use std::f64::consts::PI;

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, State, Target};
use softlimb_protocol::*;

/// Nodes of the interpolation, and coefficients of the tables.
const COUNT: usize = 16;

/// Chebyshev coefficients of a function on `0..=1`.
fn coefficients(f: impl Fn(f64) -> f64) -> Vec<f32> {
    let angle = |node: usize| PI * (node as f64 + 0.5) / COUNT as f64;
    let values: Vec<f64> = (0..COUNT).map(|node| f(0.5 + 0.5 * angle(node).cos())).collect();
    let coefficient = |k: usize| {
        let sum: f64 = values.iter().enumerate().map(|(node, value)| value * (k as f64 * angle(node)).cos()).sum();
        (sum * if k == 0 { 1.0 } else { 2.0 } / COUNT as f64) as f32
    };
    (0..COUNT).map(coefficient).collect()
}

/// The tables of a channel that bends, of a neo-Hookean elastomer, up to 98 % of its highest pressure; none for
/// others, and for channels that no device accepts.
pub fn tables(channel: &ConfigChannel) -> Option<(ConfigVolume, Option<ConfigInverse>)> {
    let parameters = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: f64::from(channel.inner_radius_m),
        outer_radius_m: f64::from(channel.outer_radius_m),
        length_m: f64::from(channel.length_m),
        material: Material::NeoHookean { shear_modulus_pa: f64::from(channel.c_pa_1) },
        fiber: (channel.families == 2).then(|| Fiber {
            angle_rad: f64::from(channel.fiber_angle_rad),
            families: Families::Two,
            modulus_pa: f64::from(channel.fiber_modulus_pa),
            placement: Placement::Sheet,
            thickness_m: f64::from(channel.fiber_thickness_m),
            radius_m: f64::from(channel.fiber_radius_m),
        }),
    };
    let bends = channel.motion == MotionKind::Bending && channel.law == MaterialLaw::NeoHookean;
    let actuator = Actuator::new(&parameters).ok().filter(|_| bends)?;
    let pressure_max_pa =
        if (1e3..=1e6).contains(&channel.pressure_max_pa) { 0.98 * channel.pressure_max_pa } else { 1e3 };
    let top_pa = f64::from(pressure_max_pa);
    let state =
        |pressure_pa: f64| -> State<f64> { actuator.forward(pressure_pa, &Load::none()).expect("finite").state };
    let list = |values: Vec<f32>| List::from_slice(&values).expect("sixteen");
    let volume = ConfigVolume {
        session: channel.session,
        channel: channel.channel,
        pressure_max_pa,
        coefficients_m3: list(coefficients(|share| state(share * top_pa).volume_m3)),
    };
    let top_rad = state(top_pa).bend_angle_rad;
    let pressure_pa = |share: f64| {
        actuator.inverse(Target::BendAngle(share * top_rad), &Load::none()).expect("an angle").state.pressure_pa
    };
    let inverse = || ConfigInverse {
        session: channel.session,
        channel: channel.channel,
        argument: TableArgument::Linear.into(),
        steps: 32_768,
        setpoint_from: 0.0,
        setpoint_to: top_rad as f32,
        pressure_max_pa,
        coefficients_pa: list(coefficients(pressure_pa)),
    };
    Some((volume, (channel.setpoint_kind == SetpointKind::BendAngle).then(inverse)))
}

/// The parts of an upload that tell of a channel, each also fed to the hash.
pub fn parts(channel: &ConfigChannel, hash: &mut ConfigHash) -> Vec<HostMessage> {
    hash.add_channel(channel);
    let mut parts = vec![channel.clone().into()];
    if let Some((volume, inverse)) = tables(channel) {
        hash.add_volume(&volume);
        parts.push(volume.into());
        if let Some(inverse) = inverse {
            hash.add_inverse(&inverse);
            parts.push(inverse.into());
        }
    }
    parts
}
