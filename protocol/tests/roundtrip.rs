//! Decoding is the exact inverse of encoding.

use crate::common::{config, decode_all, device_message, encode, host_message};
use proptest::prelude::*;
use softlimb_protocol::*;

proptest! {
    #![proptest_config(config())]

    #[test]
    fn host_messages_survive(message in host_message(), seq: u16) {
        prop_assert_eq!(decode_all(&encode(&message, seq)), [Ok(Frame { seq, message })]);
    }

    #[test]
    fn device_messages_survive(message in device_message(), seq: u16) {
        prop_assert_eq!(decode_all(&encode(&message, seq)), [Ok(Frame { seq, message })]);
    }

    #[test]
    fn frames_are_delimited_and_nothing_else_is_zero(message in host_message(), seq: u16) {
        let wire = encode(&message, seq);
        let [0, stuffed @ .., 0] = wire.as_slice() else { panic!("not delimited: {wire:?}") };
        prop_assert!(!stuffed.contains(&0));
        prop_assert!(wire.len() <= MAX_FRAME_LEN);
    }

    #[test]
    fn buffer_of_the_exact_length_suffices_and_none_shorter(message in device_message(), seq: u16) {
        let wire = encode(&message, seq);
        let mut exact = vec![0xAA; wire.len()];
        prop_assert_eq!(encode_frame(&message, seq, &mut exact), Ok(wire.len()));
        prop_assert_eq!(&exact, &wire);
        for short in 0..wire.len() {
            prop_assert_eq!(encode_frame(&message, seq, &mut exact[..short]), Err(EncodeError::BufferTooSmall));
        }
    }

    #[test]
    fn every_setpoint_survives_the_way_to_si_and_back(value: i32, kind in 0_u8..6) {
        let kind = SetpointKind::from_code(kind).unwrap();
        prop_assert_eq!(kind.to_wire(kind.from_wire_f64(value)), Ok(value));
        let error = (f64::from(kind.from_wire(value)) - kind.from_wire_f64(value)).abs();
        prop_assert!(error <= kind.from_wire_f64(value).abs() * f64::from(f32::EPSILON));
    }
}

#[test]
fn not_a_number_keeps_its_bits() {
    let bits = 0x7FC0_1234;
    let mut message = channel_zero();
    message.length_m = f32::from_bits(bits);
    let frames = decode_all(&encode(&HostMessage::from(message), 1));
    let Some(Ok(Frame { message: HostMessage::ConfigChannel(decoded), .. })) = frames.first() else {
        panic!("not a channel: {frames:?}")
    };
    assert_eq!(decoded.length_m.to_bits(), bits);
}

/// A channel whose numbers are all zero.
fn channel_zero() -> ConfigChannel {
    ConfigChannel {
        session: 0,
        channel: 0,
        motion: MotionKind::Extension.into(),
        setpoint_kind: SetpointKind::Pressure.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 0,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: 0.0,
        outer_radius_m: 0.0,
        length_m: 0.0,
        c_pa_1: 0.0,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: 0.0,
        fiber_modulus_pa: 0.0,
        fiber_thickness_m: 0.0,
        fiber_radius_m: 0.0,
        pressure_max_pa: 0.0,
        dead_volume_m3: 0.0,
        setpoint_min: 0,
        setpoint_max: 0,
    }
}

#[test]
fn lengths_are_those_of_the_table() {
    // Payload lengths counted by hand from the interface, plus header 3, checksum 4, COBS 1, delimiters 2.
    let frame_len = |message: &HostMessage| encode(message, 0x0101).len() - 10;
    let setpoint = |channels| {
        HostMessage::from(Setpoint {
            session: 0,
            index: 0,
            time_us: 0,
            outputs: Outputs::default(),
            values: List::from_slice(&vec![0; channels]).unwrap(),
        })
    };
    assert_eq!(frame_len(&channel_zero().into()), 2 + 6 + 12 * 4 + 2 * 4);
    assert_eq!(frame_len(&setpoint(1)), 2 + 4 + 8 + 1 + 1 + 4);
    assert_eq!(frame_len(&setpoint(27)), 2 + 4 + 8 + 1 + 1 + 27 * 4);
    let pulse = ManualPulse { session: 0, channel: 0, direction: PulseDirection::Fill.into(), duration_us: 0 };
    assert_eq!(frame_len(&pulse.into()), 2 + 1 + 1 + 4);
    assert_eq!(frame_len(&SetOutputs { session: 0, outputs: Outputs::GRIPPER }.into()), 2 + 1);
}

#[test]
fn lists_hold_one_to_27_elements() {
    assert_eq!(List::<i32>::from_slice(&[]), Err(ListLengthError));
    assert_eq!(List::from_slice(&[0; 28]), Err(ListLengthError));
    assert_eq!(List::from_slice(&[5; 27]).unwrap().len(), 27);
}

#[test]
fn fault_bits_are_distinct_and_fit() {
    let bits: Vec<u16> = (1..=9).map(|code| FaultCode::from_code(code).unwrap().bit()).collect();
    assert_eq!(bits, [1, 2, 4, 8, 16, 32, 64, 128, 256]);
}

#[test]
fn field_numbers_count_from_the_session() {
    assert_eq!(ConfigSystem::field_number("session"), Some(0));
    assert_eq!(ConfigSystem::field_number("vent_ramp_pa_per_s"), Some(6));
    assert_eq!(ConfigSystem::field_number("adc_full_scale"), Some(20));
    assert_eq!(ConfigSystem::field_number("pressure_loop"), Some(21));
    assert_eq!(ConfigChannel::field_number("setpoint_max"), Some(20));
    assert_eq!(ConfigChannel::field_number("setpoint_ma"), None);
}
