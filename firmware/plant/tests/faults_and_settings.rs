//! Broken parts and refused settings.

#[allow(unreachable_pub, reason = "shared by several test binaries")]
use crate::common::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use softlimb_plant::*;

fn charged(seed: u64) -> Plant {
    let mut s = settings(seed, 2);
    s.supply = Supply::Regulated { pressure_pa: 200e3 };
    let mut plant = Plant::new(&s).unwrap();
    run(&mut plant, 150, FILL);
    run(&mut plant, 3_000, HOLD);
    plant
}

fn pressures(plant: &Plant) -> Vec<f64> {
    plant.truth().channels.iter().map(|c| c.pressure_pa).collect()
}

#[test]
fn stuck_fill_valve_fills_to_the_supply_and_only_its_channel() {
    let mut plant = charged(1);
    let before = pressures(&plant);
    plant.inject(0, PartFault::FillStuckOpen).unwrap();
    run(&mut plant, 5_000, HOLD);
    let after = pressures(&plant);
    assert!((after[0] - 200e3).abs() < 500.0, "{after:?}");
    assert!((after[1] - before[1]).abs() < 1e3);
}

#[test]
fn stuck_vent_valve_empties_and_a_repair_ends_it() {
    let mut plant = charged(1);
    plant.inject(1, PartFault::VentStuckOpen).unwrap();
    run(&mut plant, 100, HOLD);
    let half_way = pressures(&plant)[1];
    plant.repair(1).unwrap();
    run(&mut plant, 1_000, HOLD);
    let kept = pressures(&plant)[1];
    assert!(kept > 5e3 && kept > 0.8 * half_way);
    plant.inject(1, PartFault::VentStuckOpen).unwrap();
    run(&mut plant, 5_000, HOLD);
    assert!(pressures(&plant)[1].abs() < 100.0);
}

#[test]
fn choked_leak_loses_its_conductance_times_pressure() {
    let mut plant = charged(1);
    let before = pressures(&plant);
    plant.inject(0, PartFault::Leak { conductance_m3_per_s_pa: 2e-11 }).unwrap();
    run(&mut plant, 1_000, HOLD);
    let after = pressures(&plant);
    // dP/dt = -R T m'/(V + P dV/dP), m' = C rho0 P phi; the volume grows with pressure, so the
    // rigid vessel of the volume at rest is the upper bound.
    let rigid = 287.05 * 293.15 * 2e-11 * 1.185 * (before[0] + 101_325.0) / 75e-6;
    let lost = before[0] - after[0];
    assert!(lost > 0.3 * rigid && lost < rigid, "{lost} {rigid}");
    assert!((after[1] - before[1]).abs() < 0.1 * lost);
}

#[test]
fn open_sensor_reads_zero_and_nothing_else_changes() {
    let (mut broken, mut intact) = (charged(1), charged(1));
    broken.inject(0, PartFault::SensorOpen).unwrap();
    run(&mut broken, 100, HOLD);
    run(&mut intact, 100, HOLD);
    assert_eq!(broken.pressure_codes()[0], 0);
    assert_eq!(broken.pressure_codes()[1], intact.pressure_codes()[1]);
    assert_eq!(pressures(&broken), pressures(&intact));
}

#[test]
fn valves_stuck_closed_pass_nothing() {
    for (fault, drive) in [(PartFault::FillStuckClosed, FILL), (PartFault::VentStuckClosed, VENT)] {
        let mut plant = charged(1);
        let before = pressures(&plant);
        plant.inject(0, fault).unwrap();
        run(&mut plant, 100, drive);
        run(&mut plant, 50, HOLD);
        let after = pressures(&plant);
        assert!((after[0] - before[0]).abs() < 1e3, "{fault:?}: {before:?} {after:?}");
        assert!((after[1] - before[1]).abs() > 10e3, "{fault:?}: {before:?} {after:?}");
    }
}

#[test]
fn swapped_coils_fill_where_they_should_vent() {
    let mut plant = charged(1);
    let before = pressures(&plant);
    plant.inject(0, PartFault::CoilsSwapped).unwrap();
    run(&mut plant, 60, VENT);
    let after = pressures(&plant);
    assert!(after[0] > before[0] + 5e3 && after[1] < before[1] - 5e3, "{before:?} {after:?}");
}

#[test]
fn broken_sensors_deceive_and_change_no_pressure() {
    let intact = {
        let mut plant = charged(1);
        run(&mut plant, 1_000, HOLD);
        plant
    };
    // One code is 206 843 Pa / 3276 = 63.1 Pa; a charged chamber reads about 2000 codes above the room's 410.
    let broken = |fault| {
        let mut plant = charged(1);
        let frozen = plant.pressure_codes()[0];
        plant.inject(0, fault).unwrap();
        run(&mut plant, 1_000, HOLD);
        assert_eq!(pressures(&plant), pressures(&intact), "{fault:?}");
        (frozen, plant.pressure_codes().to_vec(), plant.supply_code())
    };
    let codes = intact.pressure_codes();
    let (frozen, read, _) = broken(PartFault::SensorFrozen);
    assert_eq!((read[0], read[1]), (frozen, codes[1]));
    let (_, read, _) = broken(PartFault::SensorZero);
    assert!((i32::from(read[0]) - 410).abs() < 20, "{read:?}");
    let (_, read, _) = broken(PartFault::SensorDrift { pa_per_s: -6_310.0 });
    assert!((i32::from(codes[0]) - i32::from(read[0]) - 100).abs() <= 1, "{read:?} {codes:?}");
    let (_, read, _) = broken(PartFault::SensorsSwapped);
    assert_eq!(read, [codes[1], codes[0]]);
    let (_, read, supply) = broken(PartFault::ReferenceSag { share: 0.2 });
    let sagged = [codes[0], codes[1], intact.supply_code()].map(|code| f64::from(code) / 0.8);
    for (read, expected) in [read[0], read[1], supply].into_iter().zip(sagged) {
        assert!((f64::from(read) - expected.min(4_095.0)).abs() <= 0.5, "{read} {expected}");
    }
}

#[test]
fn kinked_hose_fills_the_manifold_and_hardly_the_chamber() {
    let mut plant = charged(1);
    run(&mut plant, 3_000, VENT);
    plant.inject(0, PartFault::HoseKinked { share: 0.02 }).unwrap();
    run(&mut plant, 60, FILL);
    let truth = plant.truth();
    assert!(truth.channels[0].line_pressure_pa > 100e3, "{}", truth.channels[0].line_pressure_pa);
    assert!(truth.channels[0].pressure_pa < 5e3, "{}", truth.channels[0].pressure_pa);
    assert!(truth.channels[1].pressure_pa > 20e3, "{}", truth.channels[1].pressure_pa);
}

#[test]
fn valves_without_voltage_stay_or_fall_closed() {
    let vented_pa = |lost: f64, is_open: bool| {
        let mut plant = charged(1);
        run(&mut plant, if is_open { 20 } else { 0 }, VENT);
        let before = pressures(&plant);
        plant.inject(0, PartFault::ValveSupplySag { share: lost }).unwrap();
        run(&mut plant, 100, VENT);
        (before[0] - pressures(&plant)[0], plant.valve_supply_code())
    };
    // 24 V of 36.3 V are 2707.4 of 4095 codes. A valve that falls closed passes air for 2 ms more, an open one for 100 ms.
    for (lost, code, opens, holds) in [(0.0, 2_707, true, true), (0.4, 1_624, false, true), (0.8, 541, false, false)] {
        for (is_open, passes) in [(false, opens), (true, holds)] {
            let (vented, read) = vented_pa(lost, is_open);
            assert_eq!((vented > 3e3, read), (passes, code), "{lost} {is_open}: {vented}");
        }
    }
}

#[test]
fn low_voltage_slows_the_pump_and_closes_the_supply() {
    let risen = |lost: f64| {
        let mut s = settings(1, 1);
        s.supply = Supply::Pump(PumpSettings { initial_pressure_pa: 0.0, ..PumpSettings::default() });
        let mut plant = Plant::new(&s).unwrap();
        plant.inject(0, PartFault::ValveSupplySag { share: lost }).unwrap();
        run(&mut plant, 200, FILL);
        (plant.truth().supply_pressure_pa, pressures(&plant)[0])
    };
    let (full_pa, filled_pa) = risen(0.0);
    let (slow_pa, kept_pa) = risen(0.8);
    assert!(filled_pa > 500.0 && kept_pa.abs() < 10.0, "{filled_pa} {kept_pa}");
    assert!(slow_pa < 0.5 * full_pa, "{slow_pa} {full_pa}");
}

#[test]
fn stuck_supply_valve_does_not_follow_its_coil() {
    let filled = |fault: Option<PartFault>, supply_open| {
        let mut plant = charged(1);
        run(&mut plant, 3_000, VENT);
        fault.map_or(Ok(()), |fault| plant.inject(9, fault)).unwrap();
        for _ in 0..100 {
            plant.step(&Drive { supply_open, ..Drive { channels: &[FILL; 2], ..Drive::default() } });
        }
        pressures(&plant)[0] > 10e3
    };
    assert!(filled(None, true) && !filled(None, false));
    assert!(filled(Some(PartFault::SupplyStuckOpen), false));
    assert!(!filled(Some(PartFault::SupplyStuckClosed), true));
}

#[test]
fn weak_pump_delivers_its_share_and_a_regulator_has_none() {
    let risen = |share| {
        let mut s = settings(1, 1);
        s.supply = Supply::Pump(PumpSettings { initial_pressure_pa: 0.0, ..PumpSettings::default() });
        let mut plant = Plant::new(&s).unwrap();
        plant.inject(0, PartFault::PumpWeak { share }).unwrap();
        for _ in 0..200 {
            plant.step(&Drive { pump: 1.0, ..Drive::default() });
        }
        plant.truth().supply_pressure_pa
    };
    let ratio = risen(0.25) / risen(1.0);
    assert!((ratio - 0.25).abs() < 0.01, "{ratio}");
    assert_eq!(charged(1).inject(0, PartFault::PumpWeak { share: 0.5 }), Err(PlantError::NoPump));
}

#[test]
fn faults_name_the_channel_that_is_missing() {
    let mut plant = charged(1);
    let missing = PlantError::NoSuchChannel { channel: 7, channels: 2 };
    assert_eq!(plant.inject(7, PartFault::FillStuckOpen), Err(missing.clone()));
    assert_eq!(plant.repair(7), Err(missing));
}

#[test]
fn refusals_name_field_value_and_range() {
    let refused = |change: fn(&mut PlantSettings)| {
        let mut s = settings(1, 2);
        change(&mut s);
        Plant::new(&s).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|s| s.channels[1].tube.bore_m = 0.1),
        "channels[1].tube.bore_m = 0.1 is not allowed: 5e-4 to 2e-2"
    );
    assert_eq!(refused(|s| s.spread.modulus = f64::NAN), "spread.modulus = NaN is not allowed: 0e0 to 3e-1");
    assert_eq!(
        refused(|s| s.channels[0].actuator.outer_radius_m = 1e-3),
        "channels[0].actuator: outer_radius_m = 0.001 is not allowed: finite and > inner_radius_m"
    );
    assert!(refused(|s| s.channels.clear()).starts_with("channels.len() = 0"));
    assert!(refused(|s| s.channels[0].motion.amplitude_m3 = 5e-3).contains("motion.amplitude_m3"));
    // Two valves: 25 x 2 x 1.44e-9 m3/(s Pa) x 2 ms x 1e5 Pa.
    assert!(
        refused(|s| s.supply = Supply::Pump(PumpSettings { reservoir_volume_m3: 1.2e-5, ..PumpSettings::default() }))
            .starts_with("supply.reservoir_volume_m3 = 0.000012 is not allowed: 1.44e-5")
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, rng_seed: RngSeed::Fixed(2026), ..ProptestConfig::default() })]
    /// Whatever the plant and the coils: pressures stay between vacuum and supply, codes between
    /// the rails.
    #[test]
    fn pressures_are_never_negative(
        seed: u64,
        tube_m in 0.05f64..2.0,
        bore_mm in 1.5f64..8.0,
        length_m in 0.01f64..0.3,
        conductance in 5e-11f64..1e-8,
        step_us in 10u32..1_000,
        wall in 0f64..5.0,
        pump in 0f64..1.0,
        swing in 0f64..0.2,
    ) {
        let mut s = settings(seed, 2);
        s.step_us = step_us;
        for channel in &mut s.channels {
            channel.actuator.length_m = length_m;
            channel.tube.length_m = tube_m;
            channel.tube.bore_m = bore_mm * 1e-3;
            channel.valve.conductance_m3_per_s_pa = conductance;
            channel.wall_w_per_k = wall;
            channel.motion = MotionSettings {
                amplitude_m3: swing * 3.8e-4 * length_m,
                frequency_hz: 2.0,
            };
        }
        let mut plant = Plant::new(&s).unwrap();
        for tick in 0..600 {
            let coils = [pulses(tick, 0), pulses(tick, 1)];
            plant.step(&Drive { channels: &coils, supply_open: tick % 100 < 90, pump, gripper_on: false });
            prop_assert!(plant.pressure_codes().iter().all(|c| (102..=3_993).contains(c)));
            if tick % 20 == 0 {
                let truth = plant.truth();
                for channel in &truth.channels {
                    prop_assert!((-100e3..600e3).contains(&channel.pressure_pa), "{channel:?}");
                    prop_assert!((-100e3..600e3).contains(&channel.line_pressure_pa), "{channel:?}");
                    prop_assert!(channel.shape.axial_stretch.is_finite());
                }
                prop_assert!((-1.0..250e3).contains(&truth.supply_pressure_pa));
            }
        }
    }

    /// The drawn parameters stay within three deviations and differ from the nominal ones.
    #[test]
    fn spread_is_truncated_and_never_nominal(seed: u64) {
        let s = settings(seed, 1);
        let p = Plant::new(&s).unwrap().truth().channels.remove(0).parameters;
        let nominal = &s.channels[0];
        let within = |value: f64, nominal: f64, deviation: f64| {
            let relative = (value / nominal - 1.0).abs();
            relative > 0.0 && relative <= 3.0 * deviation * (1.0 + 1e-9)
        };
        prop_assert!(within(p.fill.conductance_m3_per_s_pa, nominal.valve.conductance_m3_per_s_pa, 0.07));
        prop_assert!(within(p.vent.on_delay_us, nominal.valve.on_delay_us, 0.08));
        prop_assert!(within(p.volume_scale, 1.0, 0.03));
        prop_assert!(within(p.sensor_gain, 1.0, 0.002));
        prop_assert!(p.sensor_offset_pa.abs() <= 3.0 * 0.003 * 206_843.0);
        let thickness = p.actuator.outer_radius_m - p.actuator.inner_radius_m;
        prop_assert!(within(thickness, 4e-3, 0.02));
        prop_assert!(p.fill != p.vent);
    }
}
