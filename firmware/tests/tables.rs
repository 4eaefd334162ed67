//! Tables of a channel: looked up instead of the model, total over all numbers, checked on arrival.

use crate::common::{Bench, SESSION, channel, straight, system};
use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Target};
use softlimb_firmware::{ChannelConfig, Inverse, InverseStatus, Source};
use softlimb_protocol::*;

/// Highest pressure of the table, gauge Pa; the channel's reference stops at 147 kPa.
const TOP_PA: f32 = 147e3;

/// Volume at rest of the actuator that `crate::common::channel` describes: a cylinder of 15 mm by 113.2 mm.
fn rest_m3() -> f32 {
    std::f32::consts::PI * 15e-3 * 15e-3 * 0.1132
}

/// A volume that grows by half, in proportion to the pressure: not what the model says, so that one can tell them apart.
fn volume() -> ConfigVolume {
    let coefficients_m3 = List::from_slice(&[1.25 * rest_m3(), 0.25 * rest_m3()]).unwrap();
    ConfigVolume { session: SESSION, channel: 0, pressure_max_pa: TOP_PA, coefficients_m3 }
}

/// A bend of 3 rad at the top, in proportion to the pressure.
fn inverse() -> ConfigInverse {
    ConfigInverse {
        session: SESSION,
        channel: 0,
        argument: TableArgument::Linear.into(),
        steps: 32_768,
        setpoint_from: 0.0,
        setpoint_to: 3.0,
        pressure_max_pa: TOP_PA,
        coefficients_pa: List::from_slice(&[0.5 * TOP_PA, 0.5 * TOP_PA]).unwrap(),
    }
}

/// An upload of these parts between ConfigSystem and ConfigCommit, with the hash of all of them.
fn upload(channels: u8, parts: &[HostMessage]) -> Vec<HostMessage> {
    let begin = ConfigBegin { session: SESSION, channels };
    let mut hash = ConfigHash::begin(&begin);
    hash.add_system(&system());
    for part in parts {
        match part {
            HostMessage::ConfigChannel(part) => hash.add_channel(part),
            HostMessage::ConfigVolume(part) => hash.add_volume(part),
            HostMessage::ConfigInverse(part) => hash.add_inverse(part),
            other => panic!("{other:?} is no part"),
        }
    }
    let commit = ConfigCommit { session: SESSION, config_hash: hash.value() };
    [vec![begin.into(), system().into()], parts.to_vec(), vec![commit.into()]].concat()
}

/// The answers to an upload.
fn answers(channels: u8, parts: &[HostMessage]) -> (Bench, Vec<Ack>) {
    let mut bench = Bench::new();
    bench.hello();
    let acks = upload(channels, parts).iter().map(|part| bench.request(part)).collect();
    (bench, acks)
}

/// What the device makes of a channel and its tables.
fn config(parts: &[HostMessage]) -> ChannelConfig {
    let (bench, acks) = answers(1, parts);
    assert!(acks.iter().all(|ack| ack.result == ResultCode::Ok), "{acks:?}");
    bench.controller.config().unwrap().channels[0]
}

fn with_tables() -> ChannelConfig {
    config(&[channel(0, SetpointKind::BendAngle).into(), volume().into(), inverse().into()])
}

#[test]
fn table_is_followed() {
    let tables = with_tables();
    let mut by_table = Inverse::new();
    for bend_rad in [0.0_f32, 0.3, 0.75, 1.5] {
        let pressure_pa = by_table.pressure_pa(&tables, bend_rad).unwrap();
        assert!((pressure_pa - TOP_PA * bend_rad / 3.0).abs() <= TOP_PA / 65_536.0 * 1.01, "{bend_rad}: {pressure_pa}");
        let air = by_table.chamber(&tables);
        let wanted_m3 = rest_m3() * (1.0 + 0.5 * pressure_pa / TOP_PA) + tables.dead_volume_m3;
        assert!((air.volume_m3 / wanted_m3 - 1.0).abs() < 1e-6 && air.pressure_pa == pressure_pa);
        assert!((air.compliance_m3_per_pa / (0.5 * rest_m3() / TOP_PA) - 1.0).abs() < 1e-6);
    }
    by_table.follow_pressure(&tables, 0.5 * TOP_PA);
    let air = by_table.chamber(&tables);
    assert!((air.volume_m3 / (1.25 * rest_m3() + tables.dead_volume_m3) - 1.0).abs() < 1e-6);
}

#[test]
fn without_tables_the_model_of_a_tube_with_closed_forms_is_followed() {
    let model = config(&[straight(0).into()]);
    assert!(model.source.volume_table().is_none());
    let actuator = Actuator::new(&ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        material: Material::NeoHookean { shear_modulus_pa: 0.4e6 },
        fiber: Some(Fiber {
            angle_rad: 0.05,
            families: Families::Two,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            radius_m: 20e-3,
        }),
    })
    .unwrap()
    .by_search();
    let rest = Inverse::new().chamber(&model);
    assert!((rest.volume_m3 / (rest_m3() + model.dead_volume_m3) - 1.0).abs() < 1e-6 && rest.pressure_pa == 0.0);
    let mut solver = Inverse::new();
    // Up, back to rest, and up again.
    for stretch in [1.0_f32, 1.01, 1.02, 1.05, 1.08, 1.03, 1.0, 1.04] {
        let pressure_pa = solver.pressure_pa(&model, stretch).unwrap();
        let exact = actuator.inverse(Target::AxialStretch(f64::from(stretch)), &Load::none()).unwrap().state;
        assert!((f64::from(pressure_pa) - exact.pressure_pa).abs() < 10.0, "{stretch}: {pressure_pa}");
        let air = solver.chamber(&model);
        let volume_m3 = f64::from(air.volume_m3 - model.dead_volume_m3);
        assert!((volume_m3 / exact.volume_m3 - 1.0).abs() < 1e-4, "{stretch}: {volume_m3}");
        assert!((f64::from(air.compliance_m3_per_pa) / exact.compliance_m3_per_pa - 1.0).abs() < 1e-3, "{stretch}");
        assert_eq!(solver.status(), InverseStatus::default(), "{stretch}");
    }
    solver.follow_pressure(&model, 20e3);
    let exact = actuator.forward(20e3, &Load::none()).unwrap().state;
    let volume_m3 = f64::from(solver.chamber(&model).volume_m3 - model.dead_volume_m3);
    assert!((volume_m3 / exact.volume_m3 - 1.0).abs() < 1e-4, "{volume_m3}");
    // No pressure makes it shorter than at rest by that much: the last good one stands, and after three the channel is at fault.
    for count in 1..=3 {
        solver.pressure_pa(&model, 0.2).unwrap();
        assert!(solver.status().failed);
        assert_eq!(solver.is_at_fault(), count == 3);
    }
}

#[test]
fn actuator_whose_model_the_device_does_not_solve_needs_tables() {
    let yeoh = || ConfigChannel { law: MaterialLaw::Yeoh.into(), c_pa_2: 9.5e3, ..straight(1) };
    let smeared = || ConfigChannel { placement: FiberPlacement::Smeared.into(), ..straight(1) };
    let bending = || channel(1, SetpointKind::BendAngle);
    let pressed = || channel(1, SetpointKind::Pressure);
    for lacking in [yeoh(), smeared(), bending(), pressed()] {
        let (bench, acks) = answers(2, &[straight(0).into(), lacking.clone().into()]);
        let (last, parts) = acks.split_last().unwrap();
        assert!(parts.iter().all(|ack| ack.result == ResultCode::Ok), "{lacking:?}");
        assert_eq!((last.result.known(), last.detail), (Some(ResultCode::TablesMissing), 1), "{lacking:?}");
        assert!(bench.controller.config().is_none());
    }
    let volume = ConfigVolume { channel: 1, ..volume() };
    let inverse = ConfigInverse { channel: 1, setpoint_from: 1.0, setpoint_to: 1.2, ..inverse() };
    for parts in [
        vec![straight(0).into(), yeoh().into(), volume.clone().into(), inverse.into()],
        vec![straight(0).into(), pressed().into(), volume.into()],
    ] {
        let (_, acks) = answers(2, &parts);
        assert!(acks.iter().all(|ack| ack.result == ResultCode::Ok), "{acks:?}");
    }
}

#[test]
fn any_number_gives_a_pressure_within_the_limits_or_a_failure() {
    let tables = with_tables();
    let pressure = config(&[
        ConfigChannel { setpoint_max: 150_000, ..channel(0, SetpointKind::Pressure) }.into(),
        volume().into(),
    ]);
    for config in [tables, pressure] {
        let mut solver = Inverse::new();
        assert_eq!(solver.pressure_pa(&config, f32::NAN), None, "nothing is known yet");
        solver.forgive();
        solver.pressure_pa(&config, 0.5);
        // Every 65 521st bit pattern, NaN, infinities and subnormal numbers among them.
        for bits in (0..=u32::MAX / 65_521).map(|index| index * 65_521) {
            let setpoint = f32::from_bits(bits);
            let found = solver.pressure_pa(&config, setpoint).expect("the last one stands");
            assert!((0.0..=config.reference_max_pa()).contains(&found), "{setpoint:e}: {found}");
            assert_eq!(solver.status().failed, !setpoint.is_finite(), "{setpoint:e}");
            let air = solver.chamber(&config);
            assert!(air.volume_m3 > 0.0 && air.volume_m3.is_finite() && air.compliance_m3_per_pa >= 0.0);
        }
    }
}

#[test]
fn three_setpoints_that_are_no_numbers_are_a_fault() {
    let tables = with_tables();
    let mut solver = Inverse::new();
    let before = solver.pressure_pa(&tables, 1.0).unwrap();
    for count in 1..=3 {
        assert_eq!(solver.pressure_pa(&tables, f32::INFINITY), Some(before), "the last good one is kept");
        assert_eq!(solver.is_at_fault(), count == 3);
    }
    solver.pressure_pa(&tables, 1.0);
    assert!(!solver.is_at_fault());
}

#[test]
fn pressure_never_falls_as_the_setpoint_rises() {
    let tables = with_tables();
    let mut solver = Inverse::new();
    let mut highest_pa = 0.0;
    // From below the table to beyond it in the steps of the wire: 1 urad.
    for setpoint in -10..=3_000_010 {
        let found = solver.pressure_pa(&tables, SetpointKind::BendAngle.from_wire(setpoint)).unwrap();
        assert!(found >= highest_pa, "{setpoint}: {found} after {highest_pa}");
        highest_pa = found;
    }
    assert!((highest_pa - tables.reference_max_pa()).abs() < 1.0);
}

#[test]
fn setpoint_beyond_the_table_is_told_and_rounding_is_not() {
    let tables = with_tables();
    let mut solver = Inverse::new();
    // 100 Pa of 147 kPa are 2.04 mrad of 3 rad.
    for (setpoint, limited) in [(0.0, false), (-0.002, false), (-0.0021, true), (3.002, false), (3.0021, true)] {
        solver.pressure_pa(&tables, setpoint);
        assert_eq!(solver.status().limited, limited, "{setpoint}");
    }
}

#[test]
fn every_field_of_a_table_is_checked_and_named() {
    let base = || -> Vec<HostMessage> { vec![channel(0, SetpointKind::BendAngle).into()] };
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38];
    let list = |values: &[f32]| List::from_slice(values).unwrap();
    let mut volumes = vec![("channel", ConfigVolume { channel: 1, ..volume() })];
    let mut inverses = vec![
        ("channel", ConfigInverse { channel: 26, ..inverse() }),
        ("steps", ConfigInverse { steps: 255, ..inverse() }),
        ("steps", ConfigInverse { steps: 32_769, ..inverse() }),
        ("setpoint_from", ConfigInverse { setpoint_from: -0.1, ..inverse() }),
        ("setpoint_to", ConfigInverse { setpoint_to: -0.1, ..inverse() }),
        ("setpoint_to", ConfigInverse { setpoint_to: 0.0, ..inverse() }),
        // It falls on the way.
        ("coefficients_pa", ConfigInverse { coefficients_pa: list(&[73e3, -73e3]), ..inverse() }),
        ("coefficients_pa", ConfigInverse { coefficients_pa: list(&[73e3, 60e3, 30e3]), ..inverse() }),
        ("coefficients_pa", ConfigInverse { coefficients_pa: list(&[1.0; 18]), ..inverse() }),
        ("coefficients_pa", ConfigInverse { coefficients_pa: list(&[73e3, 2.1 * TOP_PA]), ..inverse() }),
    ];
    for value in bad {
        volumes.push(("pressure_max_pa", ConfigVolume { pressure_max_pa: value, ..volume() }));
        volumes.push(("coefficients_m3", ConfigVolume { coefficients_m3: list(&[rest_m3(), value]), ..volume() }));
        inverses.push(("setpoint_from", ConfigInverse { setpoint_from: value, ..inverse() }));
        inverses.push(("setpoint_to", ConfigInverse { setpoint_to: value, ..inverse() }));
        inverses.push(("pressure_max_pa", ConfigInverse { pressure_max_pa: value, ..inverse() }));
        inverses.push(("coefficients_pa", ConfigInverse { coefficients_pa: list(&[value]), ..inverse() }));
    }
    // Above the limit of the channel; another actuator's volume; more coefficients than a table holds.
    volumes.push(("pressure_max_pa", ConfigVolume { pressure_max_pa: 150.1e3, ..volume() }));
    volumes.push(("coefficients_m3", ConfigVolume { coefficients_m3: list(&[1.02 * rest_m3()]), ..volume() }));
    volumes.push(("coefficients_m3", ConfigVolume { coefficients_m3: list(&[rest_m3(); 18]), ..volume() }));
    inverses.push(("pressure_max_pa", ConfigInverse { pressure_max_pa: 150.1e3, ..inverse() }));
    for (field, part) in volumes {
        let (_, acks) = answers(1, &[base(), vec![part.clone().into()]].concat());
        let wanted = (Some(ResultCode::OutOfRange), ConfigVolume::field_number(field).unwrap());
        assert_eq!((acks[3].result.known(), acks[3].detail), wanted, "{part:?}");
    }
    for (field, part) in inverses {
        let (_, acks) = answers(1, &[base(), vec![volume().into(), part.clone().into()]].concat());
        let wanted = (Some(ResultCode::OutOfRange), ConfigInverse::field_number(field).unwrap());
        assert_eq!((acks[4].result.known(), acks[4].detail), wanted, "{part:?}");
    }
    let later = ConfigInverse { argument: Code::from_raw(2), ..inverse() };
    let (_, acks) = answers(1, &[base(), vec![volume().into(), later.into()]].concat());
    let wanted = ConfigInverse::field_number("argument").unwrap();
    assert_eq!((acks[4].result.known(), acks[4].detail), (Some(ResultCode::UnknownCode), wanted));
}

#[test]
fn tables_out_of_place_are_refused_and_the_upload_goes_on() {
    let bends = || HostMessage::from(channel(0, SetpointKind::BendAngle));
    let pressed = || HostMessage::from(channel(0, SetpointKind::Pressure));
    let (volume, inverse) = (|| HostMessage::from(volume()), || HostMessage::from(inverse()));
    // The parts, which of them is refused, and whether the commit is.
    for (said, parts, refused, commit) in [
        ("before any channel", vec![volume(), bends()], 0, true),
        ("a second volume", vec![bends(), volume(), volume(), inverse()], 2, true),
        ("a second inverse", vec![bends(), volume(), inverse(), inverse()], 3, true),
        ("an inverse without a volume", vec![bends(), inverse()], 1, true),
        ("an inverse of a pressure", vec![pressed(), volume(), inverse()], 2, true),
    ] {
        let (_, acks) = answers(1, &parts);
        assert_eq!(acks[2 + refused].result, ResultCode::ConfigMismatch, "{said}");
        assert_eq!(acks.last().unwrap().result == ResultCode::ConfigMismatch, commit, "{said}: hashed but not taken");
    }
    let (_, acks) = answers(1, &[bends(), volume()]);
    assert_eq!(acks.last().unwrap().result, ResultCode::ConfigMismatch, "a volume alone for a deformation");
    let (_, acks) = answers(1, &[pressed(), volume()]);
    assert!(acks.iter().all(|ack| ack.result == ResultCode::Ok), "{acks:?}");
    // A refused table leaves room for a better one: the hash names what was taken.
    let mut bench = Bench::new();
    bench.hello();
    let good = upload(1, &[bends(), volume(), inverse()]);
    let falling = ConfigInverse { setpoint_to: 0.0, ..self::inverse() };
    for part in &good[..4] {
        assert_eq!(bench.request(part).result, ResultCode::Ok);
    }
    assert_eq!(bench.request(&falling.into()).result, ResultCode::OutOfRange);
    assert_eq!(bench.request(&good[4]).result, ResultCode::Ok);
    assert_eq!(bench.request(&good[5]).result, ResultCode::Ok);
}

#[test]
fn hash_names_the_tables() {
    let hash = |parts: &[HostMessage]| answers(1, parts).0.controller.config().unwrap().hash;
    let one = || HostMessage::from(straight(0));
    let of_steps =
        |steps| HostMessage::from(ConfigInverse { steps, setpoint_from: 1.0, setpoint_to: 1.2, ..inverse() });
    let hashes = [
        hash(&[one()]),
        hash(&[one(), volume().into(), of_steps(32_768)]),
        hash(&[one(), volume().into(), of_steps(16_384)]),
    ];
    assert!(hashes[0] != hashes[1] && hashes[1] != hashes[2] && hashes[0] != hashes[2], "{hashes:x?}");
}

#[test]
fn new_configuration_without_tables_brings_the_model_back() {
    let stretched = ConfigInverse { setpoint_from: 1.0, setpoint_to: 1.2, ..inverse() };
    let (mut bench, _) = answers(1, &[straight(0).into(), volume().into(), stretched.into()]);
    assert!(matches!(bench.controller.config().unwrap().channels[0].source, Source::Tables(..)));
    bench.configure(&system(), &[straight(0)]);
    assert!(matches!(bench.controller.config().unwrap().channels[0].source, Source::Model(_)));
}
