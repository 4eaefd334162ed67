//! Configuration: every field is checked and named, and the swap is all or nothing.

use crate::common::{Bench, channel, channels, frame, system, upload};
use softlimb_protocol::*;

const KINDS: [SetpointKind; 2] = [SetpointKind::Pressure, SetpointKind::BendAngle];

/// Sends a system part and a channel part; the two answers.
fn offer(system: &ConfigSystem, channel: &ConfigChannel) -> (Ack, Ack) {
    let mut bench = Bench::new();
    bench.hello();
    let parts = upload(system, std::slice::from_ref(channel));
    bench.request(&parts[0]);
    (bench.request(&parts[1]), bench.request(&parts[2]))
}

macro_rules! system_fields {
    ($($field:ident: $bad:expr),+ $(,)?) => {
        vec![$((stringify!($field), $bad.map(|value| ConfigSystem { $field: value, ..system() }).to_vec())),+]
    };
}

macro_rules! channel_fields {
    ($($field:ident: $bad:expr),+ $(,)?) => {
        vec![$((
            stringify!($field),
            $bad.map(|value| ConfigChannel { $field: value, ..channel(0, SetpointKind::BendAngle) }).to_vec(),
        )),+]
    };
}

const NOT_A_NUMBER: [f32; 4] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38];

#[test]
fn every_system_field_is_checked_and_named() {
    let cases = system_fields![
        telemetry_period_us: [0, 999, u32::MAX],
        control_period_us: [0, 9_000, 20_500, 101_000],
        link_timeout_us: [0, u32::MAX],
        hold_time_us: [u32::MAX],
        vent_ramp_pa_per_s: NOT_A_NUMBER,
        supply_min_pa: NOT_A_NUMBER,
        supply_max_pa: NOT_A_NUMBER,
        atmosphere_pa: NOT_A_NUMBER,
        temperature_k: NOT_A_NUMBER,
        valve_conductance_m3_per_s_pa: NOT_A_NUMBER,
        valve_critical_ratio: NOT_A_NUMBER,
        valve_on_delay_us: [20_001],
        valve_off_delay_us: [20_001],
        line_conductance_m3_per_s_pa: NOT_A_NUMBER,
        sensor_min_pa: NOT_A_NUMBER,
        sensor_max_pa: NOT_A_NUMBER,
        supply_sensor_min_pa: NOT_A_NUMBER,
        supply_sensor_max_pa: NOT_A_NUMBER,
        adc_full_scale: [0],
        valve_supply_scale_mv: [60_001],
        valve_supply_min_mv: [36_301],
    ];
    assert_eq!(cases.len() + 3, ConfigSystem::FIELDS.len(), "session and codes have tests of their own");
    for (field, variants) in cases {
        for variant in variants {
            let (ack, _) = offer(&variant, &channel(0, SetpointKind::BendAngle));
            let wanted = (Some(ResultCode::OutOfRange), ConfigSystem::field_number(field).unwrap());
            assert_eq!((ack.result.known(), ack.detail), wanted, "{field}: {variant:?}");
        }
    }
}

#[test]
fn every_number_of_a_channel_is_checked_and_named() {
    let cases = channel_fields![
        channel: [1, 27, 255],
        families: [3],
        inner_radius_m: NOT_A_NUMBER,
        outer_radius_m: NOT_A_NUMBER,
        length_m: NOT_A_NUMBER,
        c_pa_1: NOT_A_NUMBER,
        c_pa_2: NOT_A_NUMBER,
        c_pa_3: NOT_A_NUMBER,
        fiber_angle_rad: NOT_A_NUMBER,
        fiber_modulus_pa: NOT_A_NUMBER,
        fiber_thickness_m: NOT_A_NUMBER,
        fiber_radius_m: NOT_A_NUMBER,
        pressure_max_pa: NOT_A_NUMBER,
        dead_volume_m3: NOT_A_NUMBER,
        setpoint_min: [-1],
        setpoint_max: [-1],
    ];
    for (field, variants) in cases {
        for variant in variants {
            let (_, ack) = offer(&system(), &variant);
            let wanted = (Some(ResultCode::OutOfRange), ConfigChannel::field_number(field).unwrap());
            assert_eq!((ack.result.known(), ack.detail), wanted, "{field}: {variant:?}");
        }
    }
}

#[test]
fn parameters_that_the_model_refuses_are_named_by_the_wires_field() {
    let base = || ConfigChannel { families: 2, fiber_radius_m: 20e-3, ..channel(0, SetpointKind::BendAngle) };
    for (field, variant) in [
        ("outer_radius_m", ConfigChannel { outer_radius_m: 14e-3, ..base() }),
        ("fiber_radius_m", ConfigChannel { fiber_radius_m: 21e-3, ..base() }),
        ("setpoint_min", ConfigChannel { setpoint_kind: SetpointKind::Twist.into(), ..base() }),
    ] {
        let (_, ack) = offer(&system(), &variant);
        let wanted = (Some(ResultCode::OutOfRange), ConfigChannel::field_number(field).unwrap());
        assert_eq!((ack.result.known(), ack.detail), wanted, "{field}");
    }
}

#[test]
fn unknown_codes_are_named() {
    let base = || channel(0, SetpointKind::BendAngle);
    for (field, variant) in [
        ("link_loss_policy", ConfigSystem { link_loss_policy: Code::from_raw(3), ..system() }),
        ("pressure_loop", ConfigSystem { pressure_loop: Code::from_raw(3), ..system() }),
    ] {
        let (ack, _) = offer(&variant, &base());
        let wanted = ConfigSystem::field_number(field).unwrap();
        assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::UnknownCode), wanted), "{field}");
    }
    for (field, variant) in [
        ("motion", ConfigChannel { motion: Code::from_raw(9), ..base() }),
        ("setpoint_kind", ConfigChannel { setpoint_kind: Code::from_raw(9), ..base() }),
        ("law", ConfigChannel { law: Code::from_raw(9), ..base() }),
        ("placement", ConfigChannel { placement: Code::from_raw(9), ..base() }),
    ] {
        let (_, ack) = offer(&system(), &variant);
        let wanted = ConfigChannel::field_number(field).unwrap();
        assert_eq!((ack.result.known(), ack.detail), (Some(ResultCode::UnknownCode), wanted), "{field}");
    }
}

#[test]
fn incomplete_and_mixed_up_uploads_are_refused() {
    let parts = upload(&system(), &channels(&KINDS));
    for missing in 0..parts.len() - 1 {
        let mut bench = Bench::new();
        bench.hello();
        let mut results: Vec<_> = parts
            .iter()
            .enumerate()
            .filter(|&(i, _)| i != missing)
            .map(|(_, part)| bench.request(part).result)
            .collect();
        assert_eq!(results.pop().unwrap(), ResultCode::ConfigMismatch, "without part {missing}");
        assert!(bench.controller.config().is_none());
    }
    let mut bench = Bench::new();
    bench.hello();
    for part in &parts[..4] {
        assert_eq!(bench.request(part).result, ResultCode::Ok);
    }
    assert_eq!(bench.request(&parts[1]).result, ResultCode::ConfigMismatch, "a second system part");
    assert_eq!(bench.request(&parts[3]).result, ResultCode::ConfigMismatch, "a channel too many");
    let wrong = ConfigCommit { session: crate::common::SESSION, config_hash: 1 };
    assert_eq!(bench.request(&wrong.into()).result, ResultCode::ConfigMismatch);
    assert_eq!(bench.request(&parts[4]).result, ResultCode::Ok, "the upload survives a wrong hash");
}

#[test]
fn limit_beyond_the_sensor_is_refused_at_the_commit() {
    let mut bench = Bench::new();
    bench.hello();
    let blind = ConfigChannel { pressure_max_pa: 250e3, ..channel(0, SetpointKind::Pressure) };
    let results: Vec<_> = upload(&system(), &[blind]).iter().map(|part| bench.request(part).result).collect();
    assert_eq!(*results.last().unwrap(), ResultCode::ConfigMismatch);
}

#[test]
fn upload_cut_at_any_byte_leaves_the_old_configuration_or_the_new_one() {
    let old = ConfigSystem { supply_min_pa: 120e3, ..system() };
    let new = ConfigSystem { supply_min_pa: 160e3, ..system() };
    let new_channels = channels(&[SetpointKind::BendAngle, SetpointKind::Pressure, SetpointKind::Pressure]);
    let mut bytes = Vec::new();
    for (index, part) in upload(&new, &new_channels).iter().enumerate() {
        bytes.extend(frame(500 + index as u16, part));
    }
    let mut swapped_at = None;
    for cut in 0..=bytes.len() {
        let mut bench = Bench::new();
        bench.hello();
        bench.configure(&old, &channels(&KINDS));
        bench.ticks(40);
        let old_hash = bench.controller.config().unwrap().hash;
        bench.controller.receive(bench.now_us, &bytes[..cut]);
        let config = bench.controller.config().unwrap();
        if config.hash == old_hash {
            assert_eq!(config.system.supply_min_pa, 120e3, "cut at {cut}");
            assert_eq!(config.channels.len(), 2);
            assert!(swapped_at.is_none());
        } else {
            assert_eq!(config.system.supply_min_pa, 160e3, "cut at {cut}");
            assert_eq!(config.channels.len(), 3);
            assert_eq!(config.channels[0].setpoint_kind, SetpointKind::BendAngle);
            swapped_at.get_or_insert(cut);
        }
    }
    assert_eq!(swapped_at, Some(bytes.len()), "only the whole upload swaps");
}

#[test]
fn running_device_is_not_reconfigured() {
    let mut bench = Bench::running(1, 50_000, 50);
    let results: Vec<_> = upload(&system(), &channels(&KINDS)).iter().map(|part| bench.request(part).result).collect();
    assert_eq!(*results.last().unwrap(), ResultCode::WrongState);
    assert_eq!(bench.controller.config().unwrap().channels.len(), 1);
    assert_eq!(bench.controller.state(), DeviceState::Running);
}

#[test]
fn controller_fits_a_small_microcontroller() {
    let size = size_of::<softlimb_firmware::Controller<9>>();
    println!("Controller of nine channels: {size} bytes");
    assert!(size < 16 * 1024, "{size}");
}
