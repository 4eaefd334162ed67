#!/usr/bin/env python3
"""Writes the test vectors of the link: `generate.py` writes them, `generate.py --check` compares them with the files.

Each vector is a stretch of bytes on the wire and what a decoder of that direction yields for it, in order: frames or errors.
"""

import json
import pathlib
import struct
import sys
import zlib

import samples
from wire import body, cobs, crc32c, frame, payload, shown, table_of

HERE = pathlib.Path(__file__).parent


def encoded(name, seq, values, tail=b""):
    """A body of the named message, with bytes that a later version may append."""
    _, message_type, fields = table_of(name)
    return body(message_type, seq, payload(fields, values) + tail)


def accepted(name, seq, values):
    """What a decoder yields for a good frame."""
    _, _, fields = table_of(name)
    return {"seq": seq, "message": name, "fields": shown(fields, values)}


def vector(title, direction, wire, *outcomes):
    """One entry of a file."""
    return {"name": title, "direction": direction, "bytes": wire.hex(), "expect": list(outcomes)}


def good(title, name, seq, values, tail=b""):
    """A frame that is accepted."""
    direction, _, _ = table_of(name)
    return vector(title, direction, frame(encoded(name, seq, values, tail)), accepted(name, seq, values))


def error(kind):
    """What a decoder yields for a bad frame."""
    return {"error": kind}


def valid():
    """Every message: typical, extreme, and longer than this version knows."""
    for title, name, seq, values in samples.MESSAGES:
        yield good(title, name, seq, values)
    for name, values in samples.TYPICAL.items():
        yield good(f"{name} with a tail of a later version", name, 0x0102, values, b"\x00\xff\x07")
    setpoint = samples.TYPICAL["Setpoint"]
    room = 254 - len(encoded("Setpoint", 1, setpoint))
    yield good("body of exactly 254 bytes", "Setpoint", 1, setpoint, bytes(room))
    dense, tail = samples.DENSE_SETPOINT, b""
    for salt in range(1, 256):
        tail = bytes([salt]) * (254 - len(encoded("Setpoint", 0x0101, dense)))
        raw = encoded("Setpoint", 0x0101, dense, tail)
        if 0 not in raw:
            break
    assert len(raw) == 254 and 0 not in raw
    yield good("254 bytes without a zero: one full COBS run", "Setpoint", 0x0101, dense, tail)
    yield vector("a full COBS run closed by an empty one", "host", b"\0" + cobs(raw) + b"\x01\0",
                 accepted("Setpoint", 0x0101, dense))


def wrong_checksum():
    """Bodies whose checksum does not match."""
    raw = encoded("Heartbeat", 9, samples.TYPICAL["Heartbeat"])
    for title, place in (("type", 0), ("sequence", 1), ("payload", 5), ("checksum", len(raw) - 1)):
        bad = bytearray(raw)
        bad[place] ^= 0x10
        yield vector(f"one bit flipped in the {title}", "host", frame(bytes(bad)), error("crc"))
    for name, values in samples.TYPICAL.items():
        direction, _, _ = table_of(name)
        bad = bytearray(encoded(name, 9, values))
        bad[3 + (len(bad) - 7) // 2] ^= 0x01
        yield vector(f"{name} with one bit flipped", direction, frame(bytes(bad)), error("crc"))
    checked = raw[:-4]
    for title, crc in (
        ("big-endian checksum", struct.pack(">I", crc32c(checked))),
        ("CRC-32 of zlib", struct.pack("<I", zlib.crc32(checked))),
        ("checksum without the final xor", struct.pack("<I", crc32c(checked) ^ 0xFFFFFFFF)),
        ("checksum of the payload alone", struct.pack("<I", crc32c(checked[3:]))),
        ("checksum zero", bytes(4)),
    ):
        yield vector(title, "host", frame(checked + crc), error("crc"))


def wrong_length():
    """Bodies and payloads that are too short or too long."""
    yield vector("empty body", "host", frame(b""), error("too_short"))
    yield vector("one byte", "host", frame(b"\x02"), error("too_short"))
    yield vector("six bytes with a right checksum", "host", frame(b"\x02\x00" + struct.pack("<I", crc32c(b"\x02\x00"))),
                 error("too_short"))
    for name, values in samples.TYPICAL.items():
        direction, message_type, fields = table_of(name)
        content = payload(fields, values)
        yield vector(f"{name} without its last byte", direction, frame(body(message_type, 3, content[:-1])),
                     error("payload"))
    yield vector("Hello without payload", "host", frame(body(0x01, 3, b"")), error("payload"))
    setpoint = samples.TYPICAL["Setpoint"]
    raw = encoded("Setpoint", 1, setpoint)
    for size in (255, 256, 600):
        long = encoded("Setpoint", 1, setpoint, bytes(size - len(raw)))
        yield vector(f"body of {size} bytes", "host", frame(long), error("oversize"))
    yield vector("255 bytes without a zero", "host", frame(b"\x01" * 255), error("oversize"))


def wrong_content():
    """Unknown types and impossible lists."""
    for message_type in (0x00, 0x11, 0x7F, 0x80, 0xFF):
        yield vector(f"type {message_type:#04x}", "host", frame(body(message_type, 1, bytes(8))), error("unknown_type"))
    yield vector("a host's message at the host", "device",
                 frame(encoded("Heartbeat", 1, samples.TYPICAL["Heartbeat"])), error("unknown_type"))
    yield vector("a device's message at the device", "host", frame(encoded("Fault", 1, samples.TYPICAL["Fault"])),
                 error("unknown_type"))
    head = struct.pack("<HIQB", 7, 0, 1000, 0)
    for count, elements in ((0, 0), (0, 4), (2, 1), (28, 28), (255, 40)):
        content = head + bytes([count]) + bytes(4 * elements)
        yield vector(f"{count} values announced, {elements} sent", "host", frame(body(0x08, 1, content)), error("payload"))
    for title, rows in (("fewer knots than announced", 1), ("a knot without steps", 2)):
        row = struct.pack("<HBB2h", 1000, 0, 2, 1, 1)
        content = struct.pack("<HIB", 7, 1, 2) + (row + b"\1\0\0\0" if rows == 2 else row)
        yield vector(f"Knots, {title}", "host", frame(body(0x0d, 1, content)), error("payload"))
    for name, values in samples.TYPICAL.items():
        direction, message_type, fields = table_of(name)
        if ":list:" in fields:
            front = payload(" ".join(fields.split()[:-1]), values)
            for count in (0, 28):
                content = front + bytes([count]) + bytes(6 * count)
                yield vector(f"{name} with a list of {count}", direction, frame(body(message_type, 1, content)),
                             error("payload"))


def wrong_stuffing():
    """Delimiters where none can be."""
    whole = frame(encoded("Heartbeat", 9, samples.TYPICAL["Heartbeat"]))
    yield vector("delimiter inside a run", "host", b"\0\x05\x11\x22\0", error("malformed"))
    yield vector("length without a run", "host", b"\0\xff\0", error("malformed"))
    yield vector("frame cut after its last but one byte", "host", whole[:-2] + b"\0", error("malformed"))


def streams():
    """Several frames, noise and silence."""
    first, second = samples.TYPICAL["Heartbeat"], samples.TYPICAL["Command"]
    a, b = frame(encoded("Heartbeat", 1, first)), frame(encoded("Command", 2, second))
    is_a, is_b = accepted("Heartbeat", 1, first), accepted("Command", 2, second)
    yield vector("silence", "host", b"")
    yield vector("idle delimiters", "host", bytes(9))
    yield vector("two frames", "host", a + b, is_a, is_b)
    yield vector("two frames that share a delimiter", "host", a + b[1:], is_a, is_b)
    yield vector("no leading delimiter", "host", a[1:], is_a)
    yield vector("idle delimiters around frames", "host", bytes(3) + a + bytes(3) + b + bytes(3), is_a, is_b)
    yield vector("frame not yet ended", "host", a + b[:-1], is_a)
    yield vector("noise before a frame", "host", b"\x05\xaa\xbb" + a, error("malformed"), is_a)
    yield vector("noise that is one COBS block", "host", b"\x03\xaa\xbb" + a, error("too_short"), is_a)
    assert a[:6] == bytes.fromhex("000302010207")
    yield vector("frame cut inside a piece, then a frame", "host", a[:5] + b, error("malformed"), is_b)
    yield vector("frame cut between two pieces, then a frame", "host", a[:6] + b, error("too_short"), is_b)
    yield vector("both delimiters lost between two frames", "host", a[:-1] + b[1:] + b, error("crc"), is_b)
    yield vector("flood without delimiters, then a frame", "host", b"\x01" * 5000 + a, error("oversize"), is_a)
    yield vector("flood of one long run, then a frame", "host", b"\xff" * 5000 + a, error("oversize"), is_a)
    yield vector("the same frame twice", "host", a + a, is_a, is_a)
    yield from streams_of_all()


def streams_of_all():
    """All messages of a direction in one stream, whole, and each behind a damaged frame."""
    for direction in ("host", "device"):
        names = [name for name in samples.TYPICAL if table_of(name)[0] == direction]
        frames = [frame(encoded(name, seq, samples.TYPICAL[name])) for seq, name in enumerate(names)]
        outcomes = [accepted(name, seq, samples.TYPICAL[name]) for seq, name in enumerate(names)]
        yield vector(f"every message of the {direction}", direction, b"".join(frames), *outcomes)
        shared = b"".join(part[:-1] for part in frames) + b"\0"
        yield vector(f"every message of the {direction}, sharing delimiters", direction, shared, *outcomes)
        for name, whole, outcome in zip(names, frames, outcomes):
            bad = bytearray(encoded(name, 1, samples.TYPICAL[name]))
            bad[-1] ^= 0x80
            yield vector(f"damaged {name}, then a whole one", direction, frame(bytes(bad)) + whole, error("crc"), outcome)


def transcript():
    """A whole session: handshake, upload, a knot, start, telemetry."""
    schema_text = samples.schema_text(HERE.parent / "SPEC.md")
    for name, seq, values in samples.session(crc32c(schema_text.encode())):
        yield good(name, name, seq, values)


FILES = {
    "valid.json": valid,
    "invalid.json": lambda: (entry for part in (wrong_checksum, wrong_length, wrong_content, wrong_stuffing) for entry in part()),
    "streams.json": streams,
    "session.json": transcript,
}


def main():
    """Writes or compares every file."""
    stale = []
    for name, make in FILES.items():
        text = "[\n" + ",\n".join(json.dumps(entry) for entry in make()) + "\n]\n"
        path = HERE / name
        if "--check" not in sys.argv[1:]:
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            stale.append(name)
    if stale:
        sys.exit("differ from what this script writes: " + ", ".join(stale))


if __name__ == "__main__":
    main()
