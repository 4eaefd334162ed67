//! Prints how many times faster than real time the plant runs on one core.
//!
//! `cargo run --release -p softlimb-plant --example plant_speed [channels]`

use std::time::Instant;

use fra_model::{ActuatorParameters, Material, Motion};
use softlimb_plant::{ChannelDrive, ChannelSettings, Drive, Plant, PlantSettings};

const SECONDS: usize = 60;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let channels = std::env::args().nth(1).map_or(Ok(9), |n| n.parse())?;
    let actuator = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 11e-3,
        outer_radius_m: 15e-3,
        length_m: 0.21,
        material: Material::NeoHookean { shear_modulus_pa: 0.2226e6 },
        fiber: None,
    };
    let settings = PlantSettings::new(1, vec![ChannelSettings::new(actuator); channels]);
    let built = Instant::now();
    let mut plant = Plant::new(&settings)?;
    println!("built {channels} channels in {:.1} ms", built.elapsed().as_secs_f64() * 1e3);

    let started = Instant::now();
    let mut coils = vec![ChannelDrive::default(); channels];
    for tick in 0..SECONDS * 1_000 {
        for (index, coil) in coils.iter_mut().enumerate() {
            *coil = pulse(tick, index);
        }
        plant.step(&Drive { channels: &coils, supply_open: true, pump: 1.0, gripper_on: false });
    }
    let took = started.elapsed().as_secs_f64();
    println!(
        "{SECONDS} s of {channels} channels in {took:.3} s: {:.0}x real time, {:.0} ns a channel tick",
        SECONDS as f64 / took,
        took * 1e9 / (SECONDS * 1_000 * channels) as f64
    );

    let asked = Instant::now();
    let rounds = 1_000;
    for _ in 0..rounds {
        std::hint::black_box(plant.truth());
    }
    let each = asked.elapsed().as_secs_f64() / f64::from(rounds);
    println!("truth with {channels} shapes: {:.1} us", each * 1e6);
    Ok(())
}

/// A 50 Hz pulse of 4 to 8 ms, half of the time filling, half venting: what a pressure loop does.
fn pulse(tick: usize, channel: usize) -> ChannelDrive {
    let (period, at_us) = (tick / 20, (tick % 20) * 1_000);
    let length_us = 4_000 + (period * 7_919 + channel * 104_729) % 4_000;
    let on_us = length_us.saturating_sub(at_us).min(1_000) as u16;
    if (period + channel).is_multiple_of(2) {
        ChannelDrive { fill_us: on_us, vent_us: 0 }
    } else {
        ChannelDrive { fill_us: 0, vent_us: on_us }
    }
}
