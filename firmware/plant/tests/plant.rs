//! The whole plant from outside: coils in, codes and truth out.

#[allow(unreachable_pub, reason = "shared by several test binaries")]
use crate::common::*;
use fra_model::{Actuator, ActuatorParameters, Load, Motion, Series};
use softlimb_plant::*;

fn nominal(seed: u64) -> PlantSettings {
    let mut s = settings(seed, 1);
    s.spread = Spread::NONE;
    s.supply = Supply::Regulated { pressure_pa: 200e3 };
    s.channels[0].valve.jitter_us = 0.0;
    s.channels[0].sensor.noise_pa = 0.0;
    s
}

#[test]
fn same_seed_and_drive_give_the_same_bits() {
    let play = |seed| {
        let mut plant = Plant::new(&settings(seed, 3)).unwrap();
        let mut codes = Vec::new();
        for tick in 0..2_000 {
            let coils = [0, 1, 2].map(|c| pulses(tick, c));
            plant.step(&Drive { channels: &coils, supply_open: true, pump: 0.7, gripper_on: false });
            codes.extend_from_slice(plant.pressure_codes());
            codes.push(plant.supply_code());
        }
        (codes, plant.truth())
    };
    let (codes, truth) = play(11);
    assert_eq!((codes.clone(), truth), play(11));
    assert_ne!(codes, play(12).0);
}

#[test]
fn another_noise_seed_is_another_run_of_the_same_parts() {
    let plant = |noise_seed| Plant::new(&PlantSettings { noise_seed, ..nominal(7) }).expect("good settings");
    let (mut one, mut other, mut again) = (plant(7), plant(8), Plant::new(&nominal(7)).expect("good settings"));
    let parts =
        |plant: &Plant| plant.truth().channels.iter().map(|channel| channel.parameters.clone()).collect::<Vec<_>>();
    assert_eq!(parts(&one), parts(&other));
    let mut differs = false;
    for _ in 0..50 {
        [&mut one, &mut other, &mut again].into_iter().for_each(|plant| plant.step(&Drive::default()));
        assert_eq!(one.pressure_codes(), again.pressure_codes());
        differs |= one.pressure_codes() != other.pressure_codes() || one.supply_code() != other.supply_code();
    }
    assert!(differs);
}

#[test]
fn asking_for_the_truth_changes_nothing() {
    let mut asked = Plant::new(&settings(5, 2)).unwrap();
    let mut silent = asked.clone();
    for tick in 0..500 {
        let coils = [pulses(tick, 0), pulses(tick, 1)];
        let drive = Drive { channels: &coils, supply_open: true, pump: 1.0, gripper_on: false };
        asked.step(&drive);
        silent.step(&drive);
        asked.truth();
    }
    assert_eq!(asked.truth(), silent.truth());
    assert_eq!(asked.pressure_codes(), silent.pressure_codes());
}

#[test]
fn one_channel_more_leaves_the_parameters_of_the_others() {
    let parameters = |n| {
        let truth = Plant::new(&settings(3, n)).unwrap().truth();
        truth.channels.iter().map(|c| c.parameters.clone()).collect::<Vec<_>>()
    };
    let (two, three) = (parameters(2), parameters(3));
    assert_eq!(two[..], three[..2]);
    assert_ne!(two[0], two[1]);
}

#[test]
fn steps_of_100_and_10_us_agree_within_100_pa() {
    let mut coarse = settings(2, 3);
    coarse.channels[1].tube.length_m = 0.1;
    coarse.channels[2].tube.length_m = 2.0;
    let mut fine = coarse.clone();
    (coarse.step_us, fine.step_us) = (100, 10);
    let (mut coarse, mut fine) = (Plant::new(&coarse).unwrap(), Plant::new(&fine).unwrap());
    let mut worst = 0.0f64;
    for tick in 0..8_000 {
        let coils = [0, 1, 2].map(|c| pulses(tick, c));
        let drive = Drive { channels: &coils, supply_open: true, pump: 1.0, gripper_on: false };
        coarse.step(&drive);
        fine.step(&drive);
        if tick % 10 == 0 {
            for (a, b) in coarse.truth().channels.iter().zip(&fine.truth().channels) {
                worst = worst.max((a.pressure_pa - b.pressure_pa).abs());
            }
        }
    }
    assert!(worst <= 100.0, "{worst} Pa");
    println!("largest difference {worst:.1} Pa");
}

#[test]
fn at_rest_nothing_moves() {
    let mut plant = Plant::new(&nominal(1)).unwrap();
    let code = plant.pressure_codes()[0];
    // 10 % of 4095 is 409.5, a tie that the last digit of the pressure decides.
    let at_zero = |code: u16| (409..=410).contains(&code);
    assert!(at_zero(code), "{code}");
    run(&mut plant, 1_000, HOLD);
    assert!(at_zero(plant.pressure_codes()[0]), "{:?}", plant.pressure_codes());
    let truth = plant.truth();
    assert_eq!(truth.time_us, 1_000_000);
    assert!(truth.channels[0].pressure_pa.abs() < 1e-6);
    assert!((truth.channels[0].shape.axial_stretch - 1.0).abs() < 1e-9);
    assert_eq!(truth.air_used_kg, 0.0);
}

#[test]
fn valves_open_and_close_after_their_delays() {
    let mut plant = Plant::new(&nominal(1)).unwrap();
    let mut opened = Vec::new();
    for tick in 0..20 {
        run(&mut plant, 1, if tick < 10 { FILL } else { HOLD });
        opened.push(plant.truth().channels[0].fill_open);
    }
    // Coil on 0..10 ms, on delay 3.5 ms, off delay 2 ms: open from 3.5 to 12 ms. The state at the
    // end of the tick 0-based k is that of (k + 1) ms; an edge at 12 ms acts in the next tick.
    let expected: Vec<bool> = (1..=20).map(|ms| (4..=12).contains(&ms)).collect();
    assert_eq!(opened, expected);
}

#[test]
fn the_sensor_sits_on_the_line_and_reads_it_by_its_transfer() {
    let mut plant = Plant::new(&nominal(1)).unwrap();
    run(&mut plant, 150, FILL);
    let filling = plant.truth().channels.remove(0);
    assert!(filling.line_pressure_pa > filling.pressure_pa + 10e3);
    run(&mut plant, 1_000, HOLD);
    let line = plant.truth().channels[0].line_pressure_pa;
    let code = f64::from(plant.pressure_codes()[0]);
    let read = (code / 4_095.0 - 0.1) / 0.8 * 206_843.0;
    // Half a code is 32 Pa; the air still cools a little.
    assert!((read - line).abs() < 40.0, "{read} {line}");
}

#[test]
fn shape_is_the_models_at_the_true_pressure_plus_creep() {
    let mut s = nominal(1);
    s.channels[0].creep_share = 0.0;
    let mut crept = s.clone();
    crept.channels[0].creep_share = 0.1;
    crept.channels[0].creep_time_s = 0.5;
    let (mut plain, mut creeping) = (Plant::new(&s).unwrap(), Plant::new(&crept).unwrap());
    run(&mut plain, 200, FILL);
    run(&mut plain, 6_000, HOLD);
    run(&mut creeping, 200, FILL);
    run(&mut creeping, 6_000, HOLD);

    let truth = plain.truth().channels.remove(0);
    let model = fra_model::Actuator::new(&extender()).unwrap();
    let expected = model.forward(truth.pressure_pa, &fra_model::Load::none());
    let expected = expected.unwrap().state;
    assert!((truth.shape.axial_stretch - expected.axial_stretch).abs() < 1e-6);
    assert!((truth.shape.volume_m3 / expected.volume_m3 - 1.0).abs() < 1e-6);

    // After twelve time constants the volume gained is 10 % more; the pressure is the same.
    let slow = creeping.truth().channels.remove(0);
    assert_eq!(slow.pressure_pa, truth.pressure_pa);
    let rest = model.rest().volume_m3;
    let gained = (slow.shape.volume_m3 - rest) / (truth.shape.volume_m3 - rest);
    assert!((gained - 1.1).abs() < 1e-3, "{gained}");
    assert!(slow.shape.axial_stretch > truth.shape.axial_stretch);
}

#[test]
fn bending_actuators_bend() {
    let mut s = nominal(1);
    s.channels[0] = ChannelSettings::new(bender());
    let mut plant = Plant::new(&s).unwrap();
    run(&mut plant, 30, FILL);
    let truth = plant.truth().channels.remove(0);
    assert!(truth.pressure_pa > 20e3 && truth.within_branch);
    assert!(truth.shape.bend_angle_rad > 0.3);
}

#[test]
fn segments_in_series_share_the_pressure_and_add_up() {
    let mut s = nominal(1);
    let straight = extender();
    let wall = ActuatorParameters { motion: Motion::Bending, fiber: None, length_m: 0.1, ..straight };
    let whole = ActuatorParameters { length_m: straight.length_m + wall.length_m, ..wall };
    let segment = |actuator| SegmentSettings { actuator, second_fiber: None, law: None };
    let segments = vec![segment(straight), segment(wall)];
    s.channels[0] = ChannelSettings { segments, creep_share: 0.0, ..ChannelSettings::new(whole) };
    let mut plant = Plant::new(&s).unwrap();
    run(&mut plant, 150, FILL);
    let truth = plant.truth().channels.remove(0);
    assert!(truth.pressure_pa > 20e3 && truth.within_branch);
    let each = [straight, wall].map(|parameters| Actuator::new(&parameters).unwrap());
    let expected = Series::new(&each).unwrap().forward(truth.pressure_pa, &Load::none()).unwrap().state;
    assert!((truth.shape.axial_stretch * whole.length_m - expected.length_m).abs() < 1e-7);
    assert!((truth.shape.bend_angle_rad - expected.bend_angle_rad).abs() < 1e-6);
    assert!((truth.shape.volume_m3 / expected.volume_m3 - 1.0).abs() < 1e-6);
    let [first, second] = truth.segments[..] else { panic!("{truth:?}") };
    let own = each.map(|actuator| actuator.forward(truth.pressure_pa, &Load::none()).unwrap().state);
    assert!((first.axial_stretch - own[0].axial_stretch).abs() < 1e-6 && first.bend_angle_rad == 0.0);
    assert!((second.bend_angle_rad - own[1].bend_angle_rad).abs() < 1e-6);
    assert_eq!((first.pressure_pa, second.pressure_pa), (truth.pressure_pa, truth.pressure_pa));
}

/// A stiffer wall and another angle are those of the whole actuator.
#[test]
fn segments_of_an_actuator_have_the_same_errors() {
    let mut s = settings(3, 1);
    let segment = SegmentSettings { actuator: extender(), second_fiber: None, law: None };
    s.channels[0] = ChannelSettings { segments: vec![segment; 2], ..ChannelSettings::new(extender()) };
    let made = Plant::new(&s).unwrap().truth().channels.remove(0).parameters;
    assert_ne!(made.actuator, extender());
    assert!(made.segments.iter().all(|segment| segment.actuator == made.actuator));
}

#[test]
fn shut_supply_delivers_nothing() {
    let mut plant = Plant::new(&nominal(1)).unwrap();
    for _ in 0..500 {
        plant.step(&Drive { channels: &[FILL], supply_open: false, pump: 1.0, gripper_on: false });
    }
    assert!(plant.truth().channels[0].pressure_pa.abs() < 1e-6);
    assert_eq!(plant.truth().air_used_kg, 0.0);
}

#[test]
fn nine_channels_in_phase_empty_the_reservoir_by_what_they_take() {
    let mut s = settings(4, 9);
    s.supply_sensor.noise_pa = 0.0;
    let mut plant = Plant::new(&s).unwrap();
    let start = plant.truth().supply_pressure_pa;
    for _ in 0..300 {
        plant.step(&Drive { channels: &[FILL; 9], supply_open: true, pump: 0.0, gripper_on: false });
    }
    let truth = plant.truth();
    let drop = start - truth.supply_pressure_pa;
    // 1 L: dP = R T dm / V.
    let expected = 287.05 * 293.15 * truth.air_used_kg / 1e-3;
    assert!(drop > 50e3);
    assert!((drop / expected - 1.0).abs() < 1e-9);
}

#[test]
fn motion_of_the_limb_moves_the_pressure_of_a_closed_channel() {
    let mut s = nominal(1);
    s.channels[0].motion = MotionSettings { amplitude_m3: 1.5e-6, frequency_hz: 2.0 };
    let mut plant = Plant::new(&s).unwrap();
    run(&mut plant, 120, FILL);
    run(&mut plant, 4_000, HOLD);
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for _ in 0..500 {
        run(&mut plant, 1, HOLD);
        let p = plant.truth().channels[0].pressure_pa;
        (low, high) = (low.min(p), high.max(p));
    }
    // n P dV/(V + n P dV/dP): with n between 1 and 1.4, V about 90 mL, the line's 6 mL and a
    // compliance that at most halves the answer.
    let rigid = (high + 101_325.0) * 3e-6 / 90e-6;
    let swing = high - low;
    assert!(swing > 0.4 * rigid && swing < 1.4 * rigid, "{swing} {rigid}");
}
