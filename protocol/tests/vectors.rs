//! The frames of `vectors/`, written by an independent implementation, decode as it says.

use std::path::Path;

use crate::common::{decode_all, encode};
use serde_json::{Value, json};
use softlimb_protocol::*;

fn load(name: &str) -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors").join(name);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn bytes(vector: &Value) -> Vec<u8> {
    let hex = vector["bytes"].as_str().unwrap();
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect()
}

/// A binary32 as the vectors spell it.
fn number(value: f32) -> Value {
    if value.is_nan() {
        json!("nan")
    } else if value.is_infinite() {
        json!(if value > 0.0 { "inf" } else { "-inf" })
    } else {
        json!(f64::from(value))
    }
}

fn numbers(values: &[f32]) -> Vec<Value> {
    values.iter().copied().map(number).collect()
}

fn host_fields(message: &HostMessage) -> (&'static str, Value) {
    match message {
        HostMessage::Hello(m) => (
            "Hello",
            json!({ "protocol_version": m.protocol_version, "schema_hash": m.schema_hash, "session": m.session }),
        ),
        HostMessage::Heartbeat(m) => ("Heartbeat", json!({ "session": m.session, "host_time_us": m.host_time_us })),
        HostMessage::ConfigBegin(m) => ("ConfigBegin", json!({ "session": m.session, "channels": m.channels })),
        HostMessage::ConfigSystem(m) => ("ConfigSystem", system_fields(m)),
        HostMessage::ConfigChannel(m) => ("ConfigChannel", channel_fields(m)),
        HostMessage::ConfigVolume(m) => (
            "ConfigVolume",
            json!({
                "session": m.session, "channel": m.channel, "pressure_max_pa": number(m.pressure_max_pa),
                "coefficients_m3": numbers(&m.coefficients_m3),
            }),
        ),
        HostMessage::ConfigInverse(m) => (
            "ConfigInverse",
            json!({
                "session": m.session, "channel": m.channel, "argument": m.argument.raw(), "steps": m.steps,
                "setpoint_from": number(m.setpoint_from), "setpoint_to": number(m.setpoint_to),
                "pressure_max_pa": number(m.pressure_max_pa), "coefficients_pa": numbers(&m.coefficients_pa),
            }),
        ),
        HostMessage::ConfigCommit(m) => ("ConfigCommit", json!({ "session": m.session, "config_hash": m.config_hash })),
        HostMessage::Command(m) => {
            ("Command", json!({ "session": m.session, "code": m.code.raw(), "time_us": m.time_us }))
        }
        HostMessage::Setpoint(m) => (
            "Setpoint",
            json!({
                "session": m.session, "index": m.index, "time_us": m.time_us, "outputs": m.outputs.bits(),
                "values": m.values.to_vec(),
            }),
        ),
        HostMessage::Knots(m) => ("Knots", knots_fields(m)),
        HostMessage::SetSampling(m) => {
            let content = m.content.raw();
            (
                "SetSampling",
                json!({ "session": m.session, "period_us": m.period_us, "samples": m.samples, "content": content }),
            )
        }
        HostMessage::ManualPulse(m) => (
            "ManualPulse",
            json!({
                "session": m.session, "channel": m.channel, "direction": m.direction.raw(), "duration_us": m.duration_us,
            }),
        ),
        HostMessage::ReadLog(m) => ("ReadLog", json!({ "session": m.session, "first": m.first })),
        HostMessage::ReadLinkErrors(m) => ("ReadLinkErrors", json!({ "session": m.session })),
        HostMessage::SetOutputs(m) => ("SetOutputs", json!({ "session": m.session, "outputs": m.outputs.bits() })),
    }
}

fn system_fields(m: &ConfigSystem) -> Value {
    json!({
        "session": m.session,
        "telemetry_period_us": m.telemetry_period_us,
        "control_period_us": m.control_period_us,
        "link_timeout_us": m.link_timeout_us,
        "hold_time_us": m.hold_time_us,
        "link_loss_policy": m.link_loss_policy.raw(),
        "vent_ramp_pa_per_s": number(m.vent_ramp_pa_per_s),
        "supply_min_pa": number(m.supply_min_pa),
        "supply_max_pa": number(m.supply_max_pa),
        "atmosphere_pa": number(m.atmosphere_pa),
        "temperature_k": number(m.temperature_k),
        "valve_conductance_m3_per_s_pa": number(m.valve_conductance_m3_per_s_pa),
        "valve_critical_ratio": number(m.valve_critical_ratio),
        "valve_on_delay_us": m.valve_on_delay_us,
        "valve_off_delay_us": m.valve_off_delay_us,
        "line_conductance_m3_per_s_pa": number(m.line_conductance_m3_per_s_pa),
        "sensor_min_pa": number(m.sensor_min_pa),
        "sensor_max_pa": number(m.sensor_max_pa),
        "supply_sensor_min_pa": number(m.supply_sensor_min_pa),
        "supply_sensor_max_pa": number(m.supply_sensor_max_pa),
        "adc_full_scale": m.adc_full_scale,
        "pressure_loop": m.pressure_loop.raw(),
        "valve_supply_scale_mv": m.valve_supply_scale_mv,
        "valve_supply_min_mv": m.valve_supply_min_mv,
    })
}

fn channel_fields(m: &ConfigChannel) -> Value {
    json!({
        "session": m.session,
        "channel": m.channel,
        "motion": m.motion.raw(),
        "setpoint_kind": m.setpoint_kind.raw(),
        "law": m.law.raw(),
        "families": m.families,
        "placement": m.placement.raw(),
        "inner_radius_m": number(m.inner_radius_m),
        "outer_radius_m": number(m.outer_radius_m),
        "length_m": number(m.length_m),
        "c_pa_1": number(m.c_pa_1),
        "c_pa_2": number(m.c_pa_2),
        "c_pa_3": number(m.c_pa_3),
        "fiber_angle_rad": number(m.fiber_angle_rad),
        "fiber_modulus_pa": number(m.fiber_modulus_pa),
        "fiber_thickness_m": number(m.fiber_thickness_m),
        "fiber_radius_m": number(m.fiber_radius_m),
        "pressure_max_pa": number(m.pressure_max_pa),
        "dead_volume_m3": number(m.dead_volume_m3),
        "setpoint_min": m.setpoint_min,
        "setpoint_max": m.setpoint_max,
    })
}

fn device_fields(message: &DeviceMessage) -> (&'static str, Value) {
    match message {
        DeviceMessage::HelloReply(m) => ("HelloReply", reply_fields(m)),
        DeviceMessage::Ack(m) => (
            "Ack",
            json!({
                "ref_type": m.ref_type, "ref_seq": m.ref_seq, "result": m.result.raw(), "detail": m.detail,
                "free_knots": m.free_knots, "mcu_time_us": m.mcu_time_us,
            }),
        ),
        DeviceMessage::HeartbeatReply(m) => (
            "HeartbeatReply",
            json!({
                "host_time_us": m.host_time_us, "mcu_time_us": m.mcu_time_us, "state": m.state.raw(),
                "free_knots": m.free_knots,
            }),
        ),
        DeviceMessage::Telemetry(m) => ("Telemetry", telemetry_fields(m)),
        DeviceMessage::Samples(m) => ("Samples", samples_fields(m)),
        DeviceMessage::Ticks(m) => ("Ticks", ticks_fields(m)),
        DeviceMessage::LogRecords(m) => {
            ("LogRecords", json!({ "records": m.records.iter().map(log_record).collect::<Vec<_>>() }))
        }
        DeviceMessage::LogState(m) => (
            "LogState",
            json!({
                "condition": m.condition.raw(), "unstored": m.unstored, "next": m.next, "until": m.until,
                "records": m.records,
            }),
        ),
        DeviceMessage::LinkErrors(m) => (
            "LinkErrors",
            json!({
                "overrun": m.overrun, "framing": m.framing, "noise": m.noise, "parity": m.parity,
                "queue_full": m.queue_full,
            }),
        ),
        DeviceMessage::Fault(m) => {
            ("Fault", json!({ "time_us": m.time_us, "channel": m.channel, "code": m.code.raw(), "value": m.value }))
        }
    }
}

fn log_record(r: LogRecord) -> Value {
    json!({
        "number": r.number, "start": r.start, "kind": r.kind.raw(), "code": r.code, "channel": r.channel, "detail": r.detail,
        "time_us": r.time_us,
    })
}

fn reply_fields(m: &HelloReply) -> Value {
    json!({
        "protocol_version": m.protocol_version,
        "schema_hash": m.schema_hash,
        "session": m.session,
        "firmware_major": m.firmware_major,
        "firmware_minor": m.firmware_minor,
        "firmware_patch": m.firmware_patch,
        "boot_cause": m.boot_cause.raw(),
        "boot_detail": m.boot_detail,
        "state": m.state.raw(),
        "channels_max": m.channels_max,
        "knots_capacity": m.knots_capacity,
        "tick_us": m.tick_us,
        "config_hash": m.config_hash,
        "mcu_time_us": m.mcu_time_us,
    })
}

fn telemetry_fields(m: &Telemetry) -> Value {
    let sample = |s: &ChannelSample| {
        json!({
            "pressure_10pa": s.pressure_10pa, "reference_10pa": s.reference_10pa, "duty": s.duty, "status": s.status.bits(),
        })
    };
    json!({
        "time_us": m.time_us,
        "state": m.state.raw(),
        "fault_bits": m.fault_bits,
        "supply_10pa": m.supply_10pa,
        "valve_supply_mv": m.valve_supply_mv,
        "free_knots": m.free_knots,
        "next_index": m.next_index,
        "ticks_late": m.ticks_late,
        "stack_used": m.stack_used,
        "outputs": m.outputs.bits(),
        "channels": m.channels.iter().map(sample).collect::<Vec<_>>(),
    })
}

fn samples_fields(m: &Samples) -> Value {
    let channel = |s: &PressureSample| json!({ "pressure_10pa": s.pressure_10pa, "duty": s.duty });
    let sample =
        |s: Sample| json!({ "state": s.state.raw(), "channels": s.channels.iter().map(channel).collect::<Vec<_>>() });
    json!({
        "time_us": m.time_us,
        "period_us": m.period_us,
        "left_out": m.left_out,
        "samples": m.samples.iter().map(sample).collect::<Vec<_>>(),
    })
}

fn ticks_fields(m: &Ticks) -> Value {
    let tick = |t: Tick| {
        json!({
            "flags": t.flags.bits(), "supply_code": t.supply_code, "valve_supply_code": t.valve_supply_code,
            "outputs_crc": t.outputs_crc, "codes": t.codes.to_vec(),
        })
    };
    json!({ "time_us": m.time_us, "left_out": m.left_out, "ticks": m.ticks.iter().map(tick).collect::<Vec<_>>() })
}

fn knots_fields(m: &Knots) -> Value {
    let knot = |k: KnotStep| json!({ "step_us": k.step_us, "outputs": k.outputs.bits(), "steps": k.steps.to_vec() });
    json!({ "session": m.session, "index": m.index, "knots": m.knots.iter().map(knot).collect::<Vec<_>>() })
}

fn error_name(error: FrameError) -> &'static str {
    match error {
        FrameError::Malformed => "malformed",
        FrameError::Oversize => "oversize",
        FrameError::TooShort => "too_short",
        FrameError::Crc => "crc",
        FrameError::UnknownType { .. } => "unknown_type",
        FrameError::Payload { .. } => "payload",
    }
}

/// What the decoder yields, spelled as in the vectors.
fn spelled<M: Message>(wire: &[u8], fields: fn(&M) -> (&'static str, Value)) -> Value {
    decode_all::<M>(wire)
        .into_iter()
        .map(|outcome| match outcome {
            Err(error) => json!({ "error": error_name(error) }),
            Ok(frame) => {
                let (name, fields) = fields(&frame.message);
                json!({ "seq": frame.seq, "message": name, "fields": fields })
            }
        })
        .collect()
}

fn check(file: &str) -> usize {
    let vectors = load(file);
    for vector in &vectors {
        let wire = bytes(vector);
        let yielded = match vector["direction"].as_str().unwrap() {
            "host" => spelled(&wire, host_fields),
            "device" => spelled(&wire, device_fields),
            other => panic!("direction {other}"),
        };
        assert_eq!(yielded, vector["expect"], "{file}: {}", vector["name"]);
    }
    vectors.len()
}

#[test]
fn every_vector_decodes_as_written() {
    let counts = ["valid.json", "invalid.json", "streams.json", "session.json"].map(check);
    println!("vectors: {counts:?}");
    assert!(counts[0] + counts[1] >= 60);
}

#[test]
fn good_frames_are_encoded_to_the_same_bytes() {
    let mut compared = 0;
    for vector in load("session.json") {
        let wire = bytes(&vector);
        let again = match vector["direction"].as_str().unwrap() {
            "host" => decode_all::<HostMessage>(&wire).remove(0).map(|frame| encode(&frame.message, frame.seq)),
            _ => decode_all::<DeviceMessage>(&wire).remove(0).map(|frame| encode(&frame.message, frame.seq)),
        };
        assert_eq!(again.unwrap(), wire, "{}", vector["name"]);
        compared += 1;
    }
    assert!(compared > 15, "{compared}");
}

#[test]
fn hashes_of_the_transcript_are_ours() {
    let (mut hash, mut hellos, mut commits) = (None, 0, 0);
    for vector in load("session.json") {
        let wire = bytes(&vector);
        let Some(Ok(frame)) = decode_all::<HostMessage>(&wire).pop() else { continue };
        match &frame.message {
            HostMessage::Hello(hello) => {
                assert_eq!(hello.schema_hash, SCHEMA_HASH);
                hellos += 1;
            }
            HostMessage::ConfigBegin(begin) => hash = Some(ConfigHash::begin(begin)),
            HostMessage::ConfigSystem(system) => hash.as_mut().unwrap().add_system(system),
            HostMessage::ConfigChannel(channel) => hash.as_mut().unwrap().add_channel(channel),
            HostMessage::ConfigVolume(volume) => hash.as_mut().unwrap().add_volume(volume),
            HostMessage::ConfigInverse(inverse) => hash.as_mut().unwrap().add_inverse(inverse),
            HostMessage::ConfigCommit(commit) => {
                assert_eq!(hash.unwrap().value(), commit.config_hash);
                commits += 1;
            }
            _ => {}
        }
    }
    assert_eq!((hellos, commits), (1, 1));
}
