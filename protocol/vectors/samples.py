"""Values for the test vectors."""

import re

from wire import crc32c, payload, table_of

SYSTEM = {
    "session": 7, "telemetry_period_us": 10_000, "control_period_us": 20_000, "link_timeout_us": 250_000,
    "hold_time_us": 2_000_000, "link_loss_policy": 0, "vent_ramp_pa_per_s": 20_000.0, "supply_min_pa": 150_000.0,
    "supply_max_pa": 240_000.0, "atmosphere_pa": 101_325.0, "temperature_k": 293.15,
    "valve_conductance_m3_per_s_pa": 1.44e-9, "valve_critical_ratio": 0.3, "valve_on_delay_us": 3500,
    "valve_off_delay_us": 2000, "line_conductance_m3_per_s_pa": 3.78e-9, "sensor_min_pa": 0.0,
    "sensor_max_pa": 206_843.0, "supply_sensor_min_pa": 0.0, "supply_sensor_max_pa": 689_476.0, "adc_full_scale": 4095,
}
CHANNEL = {
    "session": 7, "channel": 0, "motion": 2, "setpoint_kind": 5, "law": 0, "families": 2, "placement": 0,
    "inner_radius_m": 0.0065, "outer_radius_m": 0.0085, "length_m": 0.16, "c_pa_1": 85_000.0, "c_pa_2": 0.0, "c_pa_3": 0.0,
    "fiber_angle_rad": 0.0523598776, "fiber_modulus_pa": 2.5e9, "fiber_thickness_m": 1e-4, "fiber_radius_m": 0.0085,
    "pressure_max_pa": 150_000.0, "dead_volume_m3": 6e-6, "setpoint_min": 0, "setpoint_max": 3_141_593,
}
VOLUME = {
    "session": 7, "channel": 0, "pressure_max_pa": 147_000.0, "coefficients_m3": [2.4e-5, 2.5e-6, -1.25e-7],
}
INVERSE = {
    "session": 7, "channel": 0, "argument": 0, "steps": 32_768, "setpoint_from": 0.0, "setpoint_to": 3.0,
    "pressure_max_pa": 147_000.0, "coefficients_pa": [75_000.0, 73_500.0, -1500.0],
}
HELLO = {"protocol_version": 1, "schema_hash": 0x01234567, "session": 7}
REPLY = {
    "protocol_version": 1, "schema_hash": 0x01234567, "session": 7, "firmware_major": 0, "firmware_minor": 1,
    "firmware_patch": 0, "boot_cause": 0, "boot_detail": 0, "state": 0, "channels_max": 27, "knots_capacity": 64, "tick_us": 1000,
    "config_hash": 0, "mcu_time_us": 1_234_567,
}
ACK = {"ref_type": 3, "ref_seq": 1, "result": 0, "detail": 0, "free_knots": 64, "mcu_time_us": 1_240_000}
TELEMETRY = {
    "time_us": 2_000_000, "state": 2, "fault_bits": 0, "supply_10pa": 20_000, "free_knots": 63, "next_index": 1,
    "ticks_late": 0, "stack_used": 2056, "channels": [
        {"pressure_10pa": 1000, "reference_10pa": 1010, "duty": 12, "status": 0},
        {"pressure_10pa": 0, "reference_10pa": 0, "duty": -127, "status": 5},
    ],
}
TYPICAL = {
    "Hello": HELLO,
    "Heartbeat": {"session": 7, "host_time_us": 1_000_000},
    "ConfigBegin": {"session": 7, "channels": 2},
    "ConfigSystem": SYSTEM,
    "ConfigChannel": CHANNEL,
    "ConfigCommit": {"session": 7, "config_hash": 0xDEADBEEF},
    "Command": {"session": 7, "code": 0, "time_us": 1_500_000},
    "ConfigVolume": VOLUME,
    "ConfigInverse": INVERSE,
    "Setpoint": {"session": 7, "index": 0, "time_us": 1_500_000, "values": [0, 1_570_796]},
    "HelloReply": REPLY,
    "Ack": ACK,
    "HeartbeatReply": {"host_time_us": 1_000_000, "mcu_time_us": 1_300_000, "state": 1, "free_knots": 64},
    "Telemetry": TELEMETRY,
    "Fault": {"time_us": 2_500_000, "channel": 3, "code": 2, "value": 151_000},
}
DENSE_SETPOINT = {
    "session": 0x0101, "index": 0x01010101, "time_us": 0x0101010101010101, "values": [-1, 0x7F7F7F7F],
}
FULL_SAMPLE = {"pressure_10pa": 65535, "reference_10pa": 65535, "duty": -128, "status": 255}


def variants():
    """Title, message, sequence number and values of frames at the edges of the ranges."""
    yield "Hello, all bits set", "Hello", 65535, {"protocol_version": 65535, "schema_hash": 2**32 - 1, "session": 65535}
    yield "Heartbeat, all zero", "Heartbeat", 0, {"session": 0, "host_time_us": 0}
    yield "Heartbeat, latest time", "Heartbeat", 256, {"session": 1, "host_time_us": 2**64 - 1}
    yield "ConfigBegin, 27 channels", "ConfigBegin", 1, {"session": 7, "channels": 27}
    yield "ConfigBegin, more channels than any device", "ConfigBegin", 1, {"session": 7, "channels": 255}
    for text in ("nan", "inf", "-inf"):
        yield f"ConfigSystem, {text} is left to the device", "ConfigSystem", 2, SYSTEM | {"temperature_k": float(text)}
    yield "ConfigSystem, policy of a later version", "ConfigSystem", 2, SYSTEM | {"link_loss_policy": 9}
    yield "ConfigSystem, smallest and largest numbers", "ConfigSystem", 2, SYSTEM | {
        "supply_min_pa": 1e-45, "supply_max_pa": 3.4028234663852886e38, "sensor_min_pa": -0.0}
    for motion, name in enumerate(("extension", "expansion", "bending", "twisting")):
        yield f"ConfigChannel, {name}", "ConfigChannel", 3, CHANNEL | {"channel": motion, "motion": motion}
    yield "ConfigChannel, Yeoh, extreme setpoints", "ConfigChannel", 3, CHANNEL | {
        "law": 1, "c_pa_2": -120.5, "c_pa_3": 3.25, "setpoint_min": -(2**31), "setpoint_max": 2**31 - 1}
    yield "ConfigVolume, 27 coefficients, of which the device takes 17", "ConfigVolume", 4, VOLUME | {
        "channel": 26, "coefficients_m3": [float(k) for k in range(27)]}
    yield "ConfigInverse, root, falling setpoints, one coefficient", "ConfigInverse", 5, INVERSE | {
        "argument": 1, "setpoint_from": -0.0, "setpoint_to": -1.5, "coefficients_pa": [float("nan")]}
    yield "ConfigInverse, argument of a later version", "ConfigInverse", 6, INVERSE | {"argument": 9, "steps": 65_535}
    for code, name in enumerate(("start", "hold", "vent", "emergency stop", "clear faults", "flush")):
        yield f"Command, {name}", "Command", 40 + code, {"session": 7, "code": code, "time_us": 0}
    yield "Command of a later version", "Command", 50, {"session": 7, "code": 200, "time_us": 0}
    yield "Setpoint, one value", "Setpoint", 1, {"session": 7, "index": 1, "time_us": 1, "values": [-1]}
    yield "Setpoint, 27 values", "Setpoint", 2, {
        "session": 7, "index": 2**32 - 1, "time_us": 2**64 - 1, "values": [(-1) ** k * (2**31 - 1 - k) for k in range(27)]}
    yield "HelloReply after a watchdog reset", "HelloReply", 0, REPLY | {"boot_cause": 3, "config_hash": 0xCAFEF00D}
    yield "HelloReply, state of a later version", "HelloReply", 0, REPLY | {"state": 77}
    for result in range(11):
        yield f"Ack, result {result}", "Ack", result, ACK | {"result": result, "detail": 10 * result}
    yield "Telemetry, 27 channels, all bits set", "Telemetry", 9, {
        "time_us": 2**64 - 1, "state": 5, "fault_bits": 65535, "supply_10pa": 65535, "free_knots": 65535,
        "next_index": 2**32 - 1, "ticks_late": 65535, "stack_used": 65535, "channels": [FULL_SAMPLE] * 27}
    for code in range(1, 10):
        yield f"Fault, code {code}", "Fault", code, {"time_us": 5, "channel": 255, "code": code, "value": -(2**31) + code}


MESSAGES = [(f"{name}, typical", name, 0x0A00, values) for name, values in TYPICAL.items()] + list(variants())


def schema_text(spec):
    """The schema text as printed in SPEC.md."""
    return re.search(r"```schema\n(.*?)```", spec.read_text(), re.DOTALL).group(1)


def session(schema_hash):
    """Message, sequence number and values of a session without losses, both directions in order of time."""
    upload = [
        ("ConfigBegin", {"session": 7, "channels": 2}),
        ("ConfigSystem", SYSTEM),
        ("ConfigChannel", CHANNEL),
        ("ConfigVolume", VOLUME),
        ("ConfigInverse", INVERSE),
        ("ConfigChannel", CHANNEL | {"channel": 1}),
    ]
    # Without the session, the first two bytes of each payload.
    config_hash = crc32c(b"".join(payload(table_of(name)[2], values)[2:] for name, values in upload))
    device_seq, now = iter(range(100)), iter(range(1_240_000, 2_000_000, 5_000))

    def answer(name, ref_seq, free_knots=64):
        ack = {"ref_type": table_of(name)[1], "ref_seq": ref_seq, "free_knots": free_knots, "mcu_time_us": next(now)}
        return "Ack", next(device_seq), ACK | ack

    yield "Hello", 0, HELLO | {"schema_hash": schema_hash}
    yield "HelloReply", next(device_seq), REPLY | {"schema_hash": schema_hash}
    yield answer("Hello", 0)
    for seq, (name, values) in enumerate(upload + [("ConfigCommit", {"session": 7, "config_hash": config_hash})], 1):
        yield name, seq, values
        yield answer(name, seq)
    yield "Setpoint", 0, TYPICAL["Setpoint"]
    yield answer("Setpoint", 0, 63)
    yield "Setpoint", 1, TYPICAL["Setpoint"] | {"index": 1, "time_us": 1_520_000}
    yield answer("Setpoint", 1, 62)
    yield "Command", 8, TYPICAL["Command"]
    yield answer("Command", 8, 62)
    yield "Heartbeat", 2, TYPICAL["Heartbeat"]
    yield "HeartbeatReply", next(device_seq), TYPICAL["HeartbeatReply"] | {"free_knots": 62}
    yield "Telemetry", next(device_seq), TELEMETRY
