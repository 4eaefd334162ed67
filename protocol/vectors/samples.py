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
    "pressure_loop": 1, "valve_supply_scale_mv": 36_300, "valve_supply_min_mv": 20_000,
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
    "time_us": 2_000_000, "state": 2, "fault_bits": 0, "supply_10pa": 20_000, "valve_supply_mv": 24_010,
    "free_knots": 63, "next_index": 1, "ticks_late": 0, "stack_used": 2056, "outputs": 1, "channels": [
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
    "Setpoint": {"session": 7, "index": 0, "time_us": 1_500_000, "outputs": 0, "values": [0, 1_570_796]},
    "ManualPulse": {"session": 7, "channel": 1, "direction": 0, "duration_us": 20_000},
    "SetOutputs": {"session": 7, "outputs": 1},
    "Knots": {"session": 7, "index": 1, "knots": [
        {"step_us": 20_000, "outputs": 0, "steps": [100, -200]}, {"step_us": 10_000, "outputs": 1, "steps": [0, 3000]}]},
    "SetSampling": {"session": 7, "period_us": 5000, "samples": 2, "content": 0},
    "ReadLinkErrors": {"session": 7},
    "ReadLog": {"session": 7, "first": 0},
    "HelloReply": REPLY,
    "Ack": ACK,
    "HeartbeatReply": {"host_time_us": 1_000_000, "mcu_time_us": 1_300_000, "state": 1, "free_knots": 64},
    "Telemetry": TELEMETRY,
    "Fault": {"time_us": 2_500_000, "channel": 3, "code": 2, "value": 151_000},
    "Samples": {"time_us": 2_000_000, "period_us": 5000, "left_out": 0, "samples": [
        {"state": 2, "channels": [{"pressure_10pa": 1000, "duty": 12}, {"pressure_10pa": 0, "duty": -127}]},
        {"state": 2, "channels": [{"pressure_10pa": 1010, "duty": 0}, {"pressure_10pa": 1, "duty": 127}]}]},
    "Ticks": {"time_us": 2_000_000, "left_out": 0, "ticks": [
        {"flags": 0, "supply_code": 2867, "valve_supply_code": 2708, "outputs_crc": 0x7D5DB7F3, "codes": [410, 1200]},
        {"flags": 1, "supply_code": 2866, "valve_supply_code": 2707, "outputs_crc": 0, "codes": [411, 4095]}]},
    "LinkErrors": {"overrun": 1, "framing": 2, "noise": 300, "parity": 0, "queue_full": 70_000},
    "LogRecords": {"records": [
        {"number": 9, "start": 4, "kind": 1, "code": 6, "channel": 255, "detail": 0x08001234, "time_us": 0},
        {"number": 10, "start": 4, "kind": 2, "code": 2, "channel": 3, "detail": 151_000, "time_us": 2_500_000}]},
    "LogState": {"condition": 1, "unstored": 0, "next": 11, "until": 11, "records": 2},
}
DENSE_SETPOINT = {
    "session": 0x0101, "index": 0x01010101, "time_us": 0x0101010101010101, "outputs": 1, "values": [-1, 0x7F7F7F7F],
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
    for code, name in enumerate(("start", "hold", "vent", "emergency stop", "clear faults", "flush", "zero")):
        yield f"Command, {name}", "Command", 40 + code, {"session": 7, "code": code, "time_us": 0}
    yield "Command of a later version", "Command", 50, {"session": 7, "code": 200, "time_us": 0}
    yield "Setpoint, one value", "Setpoint", 1, {"session": 7, "index": 1, "time_us": 1, "outputs": 0, "values": [-1]}
    yield "Setpoint, 27 values", "Setpoint", 2, {
        "session": 7, "index": 2**32 - 1, "time_us": 2**64 - 1, "outputs": 255,
        "values": [(-1) ** k * (2**31 - 1 - k) for k in range(27)]}
    yield "HelloReply after a watchdog reset", "HelloReply", 0, REPLY | {"boot_cause": 3, "config_hash": 0xCAFEF00D}
    yield "HelloReply, state of a later version", "HelloReply", 0, REPLY | {"state": 77}
    for result in range(13):
        yield f"Ack, result {result}", "Ack", result, ACK | {"result": result, "detail": 10 * result}
    yield "Telemetry, 27 channels, all bits set", "Telemetry", 9, {
        "time_us": 2**64 - 1, "state": 5, "fault_bits": 65535, "supply_10pa": 65535, "valve_supply_mv": 65535,
        "free_knots": 65535, "next_index": 2**32 - 1, "ticks_late": 65535, "stack_used": 65535, "outputs": 255, "channels": [FULL_SAMPLE] * 27}
    for code in range(1, 16):
        yield f"Fault, code {code}", "Fault", code, {"time_us": 5, "channel": 255, "code": code, "value": -(2**31) + code}
    yield from every_code()
    yield from every_length()
    yield from by_hand()
    yield from batches()


def every_code():
    """Each code of each set that a message carries, and the first one behind the set."""
    for title, name, base, field, count in (
        ("policy", "ConfigSystem", SYSTEM, "link_loss_policy", 3),
        ("pressure loop", "ConfigSystem", SYSTEM, "pressure_loop", 3),
        ("setpoint kind", "ConfigChannel", CHANNEL, "setpoint_kind", 6),
        ("law", "ConfigChannel", CHANNEL, "law", 2),
        ("fiber families", "ConfigChannel", CHANNEL, "families", 3),
        ("placement", "ConfigChannel", CHANNEL, "placement", 3),
        ("boot cause", "HelloReply", REPLY, "boot_cause", 7),
        ("state", "HeartbeatReply", TYPICAL["HeartbeatReply"], "state", 6),
        ("state", "Telemetry", TELEMETRY, "state", 6),
    ):
        for code in range(count + 1):
            title_of_code = f"{title} {code}" if code < count else f"{title} {code} of a later version"
            yield f"{name}, {title_of_code}", name, 0x0C00 + code, base | {field: code}


def every_length():
    """Lists of several lengths: other offsets, and other places of the zeros that COBS removes."""
    for count in (2, 3, 9, 18, 26):
        yield f"Setpoint, {count} zeros", "Setpoint", count, {
            "session": 7, "index": count, "time_us": count, "outputs": 1, "values": [0] * count}
        yield f"Setpoint, {count} values without a zero byte", "Setpoint", 0x0101, DENSE_SETPOINT | {
            "values": [0x01010101 + k for k in range(count)]}
        yield f"Telemetry, {count} channels", "Telemetry", count, TELEMETRY | {
            "channels": [{"pressure_10pa": 100 * k, "reference_10pa": 100 * k + 1, "duty": -k, "status": k % 8}
                         for k in range(count)]}
    for count in (1, 17):
        yield f"ConfigVolume, {count} coefficients", "ConfigVolume", count, VOLUME | {
            "coefficients_m3": [2.5e-5 / (k + 1) for k in range(count)]}
        yield f"ConfigInverse, {count} coefficients", "ConfigInverse", count, INVERSE | {
            "coefficients_pa": [75_000.0 / (k + 1) for k in range(count)]}


def by_hand():
    """Pulses and outputs that are asked for by hand."""
    pulse, outputs = TYPICAL["ManualPulse"], TYPICAL["SetOutputs"]
    for title, change in (
        ("vent", {"direction": 1}),
        ("shortest", {"duration_us": 1000}),
        ("longest", {"duration_us": 1_000_000}),
        ("shorter than a device takes", {"duration_us": 0}),
        ("longer than a device takes", {"duration_us": 2**32 - 1}),
        ("last channel", {"channel": 26}),
        ("channel of no device", {"channel": 255}),
        ("direction of a later version", {"direction": 2}),
    ):
        yield f"ManualPulse, {title}", "ManualPulse", 60, pulse | change
    for title, bits in (("all off", 0), ("output of a later version", 2), ("all bits set", 255)):
        yield f"SetOutputs, {title}", "SetOutputs", 61, outputs | {"outputs": bits}
    for title, bits in (("gripper closes", 1), ("output of a later version", 128)):
        yield f"Setpoint, {title}", "Setpoint", 62, TYPICAL["Setpoint"] | {"outputs": bits}
    yield "Telemetry, gripper open", "Telemetry", 63, TELEMETRY | {"outputs": 0}


def batches():
    """Knots and samples of several numbers of channels, up to the longest frame of each."""
    for count, most in ((1, 39), (9, 10), (27, 4)):
        for knots in sorted({1, 2, most}):
            yield f"Knots, {knots} of {count} channels", "Knots", 70 + knots, {"session": 7, "index": 2**32 - 2, "knots": [
                {"step_us": 65_535 - k, "outputs": k % 2, "steps": [(-1) ** (j + k) * (32_767 - j) for j in range(count)]}
                for k in range(knots)]}
    for count, most in ((1, 46), (9, 7), (27, 2)):
        for number in sorted({1, 2, most}):
            yield f"Samples, {number} of {count} channels", "Samples", 70 + number, {
                "time_us": 2**63, "period_us": 1000, "left_out": 2**32 - 1, "samples": [
                    {"state": k % 7, "channels": [{"pressure_10pa": 100 * j + k, "duty": j - k} for j in range(count)]}
                    for k in range(number)]}
    for count, most in ((1, 19), (9, 8), (27, 3)):
        for number in sorted({1, 2, most}):
            yield f"Ticks, {number} of {count} channels", "Ticks", 80 + number, {
                "time_us": 2**64 - 1, "left_out": 2**32 - 1, "ticks": [
                    {"flags": k % 2, "supply_code": 65_535 - k, "valve_supply_code": 256 * k, "outputs_crc": 2**32 - 1 - k,
                     "codes": [100 * j + k for j in range(count)]} for k in range(number)]}
    yield "Knots, another number of channels in each knot", "Knots", 90, {"session": 7, "index": 3, "knots": [
        {"step_us": 0, "outputs": 255, "steps": [-(2**15)] * 27}, {"step_us": 1, "outputs": 0, "steps": [2**15 - 1]}]}
    for period_us, number in ((0, 0), (1000, 255), (2**32 - 1, 1)):
        yield f"SetSampling, {number} every {period_us} us", "SetSampling", 91, {
            "session": 7, "period_us": period_us, "samples": number, "content": 0}
    yield "ReadLog, from the highest number", "ReadLog", 95, {"session": 7, "first": 2**32 - 1}
    yield "LogRecords, as many as a frame holds, kind of a later version", "LogRecords", 96, {"records": [
        {"number": 2**32 - 1, "start": 2**32 - 1 - k, "kind": 200 + k, "code": 255 - k, "channel": k, "detail": 2**32 - 1 - k, "time_us": 2**64 - 1 - k}
        for k in range(10)]}
    for condition in range(5):
        yield f"LogState, condition {condition}", "LogState", 97, {
            "condition": condition, "unstored": 2**32 - 1, "next": 2**32 - 1, "until": 5, "records": 255}
    yield "LinkErrors, none", "LinkErrors", 93, {
        "overrun": 0, "framing": 0, "noise": 0, "parity": 0, "queue_full": 0}
    yield "LinkErrors, each at its maximum", "LinkErrors", 94, {
        "overrun": 2**32 - 1, "framing": 2**32 - 2, "noise": 2**32 - 3, "parity": 2**32 - 4, "queue_full": 2**32 - 5}
    for content, name in ((1, "ticks"), (200, "content of a later version")):
        yield f"SetSampling, {name}", "SetSampling", 92, {
            "session": 7, "period_us": 1000, "samples": 8, "content": content}


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
    device_seq, time_us = iter(range(100)), 1_235_000

    def now(step_us=5_000):
        nonlocal time_us
        time_us += step_us
        return time_us

    def answer(name, ref_seq, free_knots=64):
        ack = {"ref_type": table_of(name)[1], "ref_seq": ref_seq, "free_knots": free_knots, "mcu_time_us": now()}
        return "Ack", next(device_seq), ACK | ack

    def telemetry(state, step_us=40_000, **changes):
        return "Telemetry", next(device_seq), TELEMETRY | {"time_us": now(step_us), "state": state, "outputs": 0} | changes

    def request(name, seq, free_knots=64, **changes):
        yield name, seq, TYPICAL[name] | changes
        yield answer(name, seq, free_knots)

    def command(code, seq, free_knots=64):
        return request("Command", seq, free_knots, code=code, time_us=0)

    yield "Hello", 0, HELLO | {"schema_hash": schema_hash}
    yield "HelloReply", next(device_seq), REPLY | {"schema_hash": schema_hash}
    yield answer("Hello", 0)
    for seq, (name, values) in enumerate(upload + [("ConfigCommit", {"session": 7, "config_hash": config_hash})], 1):
        yield name, seq, values
        yield answer(name, seq)
    # By hand: the zeros, a valve, its chamber vented, the gripper.
    yield telemetry(0, next_index=0, free_knots=64)
    yield telemetry(1, 600_000, next_index=0, free_knots=64)
    yield from command(6, 8)
    yield telemetry(0, next_index=0, free_knots=64)
    yield telemetry(1, 600_000, next_index=0, free_knots=64)
    yield from request("ManualPulse", 9)
    yield telemetry(3, next_index=0, free_knots=64)
    yield from command(2, 10)
    yield telemetry(4, next_index=0, free_knots=64)
    yield telemetry(1, 600_000, next_index=0, free_knots=64)
    yield from request("SetOutputs", 11)
    yield from request("SetOutputs", 12, outputs=0)
    yield from request("SetSampling", 13)
    yield "ReadLinkErrors", 14, TYPICAL["ReadLinkErrors"]
    yield "LinkErrors", next(device_seq), TYPICAL["LinkErrors"]
    yield answer("ReadLinkErrors", 14)
    yield "ReadLog", 15, TYPICAL["ReadLog"]
    yield answer("ReadLog", 15)
    yield "LogRecords", next(device_seq), TYPICAL["LogRecords"]
    yield "LogState", next(device_seq), TYPICAL["LogState"]
    # A run that closes the gripper with its last knot.
    start_us = 5_000_000
    setpoint = TYPICAL["Setpoint"] | {"time_us": start_us}
    yield "Setpoint", 0, setpoint
    yield answer("Setpoint", 0, 63)
    last = {"step_us": 10_000, "outputs": 1, "steps": [0, 100]}
    yield "Knots", 1, TYPICAL["Knots"] | {"knots": [last | {"outputs": 0}, last]}
    yield answer("Knots", 1, 61)
    yield from request("Command", 16, 61, time_us=start_us)
    yield "Heartbeat", 2, TYPICAL["Heartbeat"]
    yield "HeartbeatReply", next(device_seq), TYPICAL["HeartbeatReply"] | {"mcu_time_us": now(), "free_knots": 61}
    yield telemetry(2, start_us + 5_000 - time_us, free_knots=63, next_index=3)
    yield "Samples", next(device_seq), TYPICAL["Samples"] | {"time_us": now(0)}
    yield "Fault", next(device_seq), {"time_us": now(15_000), "channel": 255, "code": 4, "value": 3}
    yield telemetry(3, 5_000, fault_bits=8, free_knots=64, next_index=3, outputs=1)
    # The payload stays: the output keeps its state while the limb is vented.
    yield from command(2, 17)
    yield telemetry(4, fault_bits=8, next_index=3, free_knots=64, outputs=1)
    yield from command(4, 18)
    yield telemetry(1, 600_000, next_index=3, free_knots=64, outputs=1)
