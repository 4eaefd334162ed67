"""COBS, CRC-32C and the message table of SPEC.md, apart from the code that they check; standard library only."""

import struct

# Fields of every message: name and format. "list:" stands for a count byte and that many numbers or records.
HOST = {
    0x01: ("Hello", "protocol_version:H schema_hash:I session:H"),
    0x02: ("Heartbeat", "session:H host_time_us:Q"),
    0x03: ("ConfigBegin", "session:H channels:B"),
    0x04: ("ConfigSystem", "session:H telemetry_period_us:I control_period_us:I link_timeout_us:I hold_time_us:I "
           "link_loss_policy:B vent_ramp_pa_per_s:f supply_min_pa:f supply_max_pa:f atmosphere_pa:f temperature_k:f "
           "valve_conductance_m3_per_s_pa:f valve_critical_ratio:f valve_on_delay_us:I valve_off_delay_us:I "
           "line_conductance_m3_per_s_pa:f sensor_min_pa:f sensor_max_pa:f supply_sensor_min_pa:f "
           "supply_sensor_max_pa:f adc_full_scale:H pressure_loop:B "
           "valve_supply_scale_mv:H valve_supply_min_mv:H"),
    0x05: ("ConfigChannel", "session:H channel:B motion:B setpoint_kind:B law:B families:B placement:B "
           "inner_radius_m:f outer_radius_m:f length_m:f c_pa_1:f c_pa_2:f c_pa_3:f fiber_angle_rad:f "
           "fiber_modulus_pa:f fiber_thickness_m:f fiber_radius_m:f pressure_max_pa:f dead_volume_m3:f "
           "setpoint_min:i setpoint_max:i"),
    0x06: ("ConfigCommit", "session:H config_hash:I"),
    0x07: ("Command", "session:H code:B time_us:Q"),
    0x08: ("Setpoint", "session:H index:I time_us:Q outputs:B values:list:i"),
    0x09: ("ConfigVolume", "session:H channel:B pressure_max_pa:f coefficients_m3:list:f"),
    0x0a: ("ConfigInverse", "session:H channel:B argument:B steps:H setpoint_from:f setpoint_to:f pressure_max_pa:f "
           "coefficients_pa:list:f"),
    0x0b: ("ManualPulse", "session:H channel:B direction:B duration_us:I"),
    0x0c: ("SetOutputs", "session:H outputs:B"),
    0x0d: ("Knots", "session:H index:I knots:list:step"),
    0x0e: ("SetSampling", "session:H period_us:I samples:B content:B"),
    0x0f: ("ReadLinkErrors", "session:H"),
    0x10: ("ReadLog", "session:H first:I"),
}
DEVICE = {
    0x81: ("HelloReply", "protocol_version:H schema_hash:I session:H firmware_major:B firmware_minor:B firmware_patch:B "
           "boot_cause:B boot_detail:I state:B channels_max:B knots_capacity:H tick_us:I config_hash:I mcu_time_us:Q"),
    0x82: ("Ack", "ref_type:B ref_seq:H result:B detail:I free_knots:H mcu_time_us:Q"),
    0x83: ("HeartbeatReply", "host_time_us:Q mcu_time_us:Q state:B free_knots:H"),
    0x84: ("Telemetry", "time_us:Q state:B fault_bits:H supply_10pa:H valve_supply_mv:H free_knots:H next_index:I ticks_late:H "
           "stack_used:H outputs:B channels:list:sample"),
    0x85: ("Fault", "time_us:Q channel:B code:B value:i"),
    0x86: ("Samples", "time_us:Q period_us:I left_out:I samples:list:moment"),
    0x87: ("Ticks", "time_us:Q left_out:I ticks:list:tick"),
    0x88: ("LinkErrors", "overrun:I framing:I noise:I parity:I queue_full:I"),
    0x89: ("LogRecords", "records:list:record"),
    0x8a: ("LogState", "condition:B unstored:I next:I until:I records:B"),
}
RECORDS = {
    "sample": "pressure_10pa:H reference_10pa:H duty:b status:B",
    "step": "step_us:H outputs:B steps:list:h",
    "moment": "state:B channels:list:pressure",
    "pressure": "pressure_10pa:H duty:b",
    "record": "number:I start:I kind:B code:B channel:B detail:I time_us:Q",
    "tick": "flags:B supply_code:H valve_supply_code:H outputs_crc:I codes:list:H",
}


def crc32c(data):
    """CRC-32C bit by bit: reflected polynomial 82F63B78, initial value and final xor FFFFFFFF."""
    register = 0xFFFFFFFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register >> 1) ^ (0x82F63B78 if register & 1 else 0)
    return register ^ 0xFFFFFFFF


def cobs(data):
    """Each run of up to 254 non-zero bytes follows its length plus one; a full run stands for no zero."""
    out, run = bytearray(), bytearray()
    open_run = True
    for byte in data:
        open_run = True
        if byte:
            run.append(byte)
            if len(run) == 254:
                out += b"\xff" + run
                run = bytearray()
                open_run = False
        else:
            out += bytes([len(run) + 1]) + run
            run = bytearray()
    if open_run:
        out += bytes([len(run) + 1]) + run
    return bytes(out)


def single(fields):
    """The (name, rest) pairs of a format string."""
    return [field.split(":", 1) for field in fields.split()]


def payload(fields, values):
    """Bytes of the fields, in order."""
    out = b""
    for name, form in single(fields):
        value = values[name]
        kind = form.removeprefix("list:")
        if kind in RECORDS:
            out += bytes([len(value)]) + b"".join(payload(RECORDS[kind], element) for element in value)
        elif kind != form:
            out += bytes([len(value)]) + b"".join(struct.pack("<" + kind, element) for element in value)
        else:
            out += struct.pack("<" + form, value)
    return out


def table_of(name):
    """Direction, type byte and fields of a message."""
    for direction, table in (("host", HOST), ("device", DEVICE)):
        for message_type, (message, fields) in table.items():
            if message == name:
                return direction, message_type, fields
    raise KeyError(name)


def body(message_type, seq, content):
    """Header, payload and checksum."""
    checked = struct.pack("<BH", message_type, seq) + content
    return checked + struct.pack("<I", crc32c(checked))


def frame(raw_body):
    """A body between two delimiters."""
    return b"\0" + cobs(raw_body) + b"\0"


def binary32(value):
    """A number as binary32 keeps it, what is not a number as text."""
    value = struct.unpack("<f", struct.pack("<f", value))[0]
    return str(value) if value != value or value in (float("inf"), float("-inf")) else value


def shown(fields, values):
    """The values as a reader gets them back."""
    out = {}
    for name, form in single(fields):
        value = values[name]
        if form == "f":
            value = binary32(value)
        elif form == "list:f":
            value = [binary32(element) for element in value]
        out[name] = value
    return out


assert crc32c(b"123456789") == 0xE3069283
assert cobs(b"") == b"\x01" and cobs(b"\0") == b"\x01\x01" and cobs(b"\x11\x22\0\x33") == b"\x03\x11\x22\x02\x33"
assert cobs(b"\x01" * 254) == b"\xff" + b"\x01" * 254
