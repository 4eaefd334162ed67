#!/usr/bin/env python3
"""A host in Python, from SPEC.md alone: connects, configures, streams a wave, closes the gripper half way, vents.

    python3 client.py tcp:127.0.0.1:4100 --channels 3 --seconds 2
    python3 client.py /dev/ttyACM0 --channels 9 --amplitude-kpa 20

Every channel follows the pressure `amplitude (1 - cos(2 pi t)) / 2`. Needs Python 3.9 and nothing else. Section numbers are
those of SPEC.md.
"""

import argparse
import math
import os
import random
import select
import socket
import struct
import termios
import time
import tty

VERSION, SCHEMA_HASH = 1, 0xC87C7122  # section 9

HELLO, HEARTBEAT, BEGIN, SYSTEM, CHANNEL, COMMIT, COMMAND, SETPOINT, KNOTS, SET_SAMPLING = 1, 2, 3, 4, 5, 6, 7, 8, 13, 14
HELLO_REPLY, ACK, HEARTBEAT_REPLY, TELEMETRY, FAULT, SAMPLES = 0x81, 0x82, 0x83, 0x84, 0x85, 0x86  # section 8.5
IDLE, READY, RUNNING, HOLDING, VENTING, FAULTED = range(6)  # section 8.1
START, VENT, CLEAR_FAULTS, GRIPPER = 0, 2, 4, 1
OK, UNEXPECTED_INDEX, QUEUE_FULL = 0, 5, 6


def crc32c(data):  # section 2.2
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def stuff(body):  # COBS, section 2.1
    out = bytearray()
    for run in body.split(b"\0"):
        while len(run) >= 254:
            out, run = out + b"\xff" + run[:254], run[254:]
        out += bytes([len(run) + 1]) + run
    return bytes(out)


def unstuff(piece):  # the body, or None where the delimiter came inside a piece
    out = bytearray()
    while piece:
        length, run = piece[0], piece[1 : piece[0]]
        if len(run) != length - 1:
            return None
        out, piece = out + run, piece[length:]
        if length < 255 and piece:
            out.append(0)
    return bytes(out)


def frame(kind, seq, payload):  # section 2
    body = struct.pack("<BH", kind, seq) + payload
    return b"\0" + stuff(body + struct.pack("<I", crc32c(body))) + b"\0"


def parse(piece):  # type, number and payload of what stood between two delimiters, or None (section 2.4)
    body = unstuff(piece)
    if body is None or not 7 <= len(body) <= 254 or crc32c(body[:-4]) != struct.unpack("<I", body[-4:])[0]:
        return None
    kind, seq = struct.unpack("<BH", body[:3])
    return kind, seq, body[3:-4]


def now_us():
    return time.monotonic_ns() // 1000


class Port:  # a TCP connection or a serial device
    def __init__(self, address):
        if address.startswith("tcp:"):
            _, host, port = address.split(":")
            self.socket = socket.create_connection((host, int(port)))
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.fd = self.socket.fileno()
            return
        self.fd = os.open(address, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.fd)
        settings = termios.tcgetattr(self.fd)
        settings[4] = settings[5] = termios.B115200
        termios.tcsetattr(self.fd, termios.TCSANOW, settings)

    def read(self, seconds):
        ready, _, _ = select.select([self.fd], [], [], max(seconds, 0.0))
        data = os.read(self.fd, 4096) if ready else b""
        if ready and not data:
            raise ConnectionError("the device closed the connection")
        return data

    def write(self, data):
        while data:
            data = data[os.write(self.fd, data) :]


class Host:  # one session (sections 3 and 4)
    def __init__(self, port):
        self.port, self.buffer = port, b""
        self.session, self.reliable_seq, self.seq = random.randrange(1, 65536), 0, 0
        self.state, self.telemetry, self.faults = None, None, []
        self.answer, self.acks, self.in_flight, self.samples = None, [], {}, []
        self.best_round_trip, self.offset_us, self.heartbeat_due = math.inf, 0.0, None

    def send(self, kind, payload):
        self.port.write(frame(kind, self.seq, payload))
        self.seq = (self.seq + 1) % 65536

    def turn(self, seconds):
        """Keeps the link alive and takes what arrives, for so long at most."""
        if self.heartbeat_due is not None and time.monotonic() >= self.heartbeat_due:
            self.heartbeat_due = time.monotonic() + 0.05
            self.send(HEARTBEAT, struct.pack("<HQ", self.session, now_us()))
        self.buffer += self.port.read(seconds)
        *pieces, self.buffer = self.buffer.split(b"\0")
        for message in filter(None, map(parse, filter(None, pieces))):
            self.on_message(*message)

    def on_message(self, kind, seq, payload):
        if kind in (ACK, HELLO_REPLY):
            self.on_answer(kind, payload)
        elif kind == HEARTBEAT_REPLY:
            sent_us, mcu_us, self.state, _ = struct.unpack_from("<QQBH", payload)
            round_trip = now_us() - sent_us
            if 0 <= round_trip <= self.best_round_trip:  # the shortest exchange tells the clock best (section 4)
                self.best_round_trip, self.offset_us = round_trip, mcu_us - (sent_us + round_trip / 2)
        elif kind == TELEMETRY:
            names = (
                "time_us state fault_bits supply_10pa valve_supply_mv free_knots next_index ticks_late stack_used outputs count"
            ).split()
            self.telemetry = dict(zip(names, struct.unpack_from("<QBHHHHIHHBB", payload)))
            samples = struct.iter_unpack("<HHbB", payload[27 : 27 + 6 * self.telemetry["count"]])
            self.telemetry["channels"] = [(10 * p, 10 * r, duty, status) for p, r, duty, status in samples]
            self.state = self.telemetry["state"]
        elif kind == SAMPLES:
            time_us, period_us, _, count = struct.unpack_from("<QIIB", payload)
            size = 2 + 3 * payload[18]  # state, number of channels, a pressure and a duty of each
            for k in range(count):
                channels = struct.iter_unpack("<Hb", payload[17 + k * size + 2 : 17 + (k + 1) * size])
                self.samples.append((time_us + k * period_us, [10 * pressure for pressure, _ in channels]))
        elif kind == FAULT:
            self.faults.append(struct.unpack_from("<QBBi", payload))

    def on_answer(self, kind, payload):
        if kind == HELLO_REPLY:
            self.answer = (HELLO, None, payload)
            return
        ref_type, ref_seq, result, detail, *_ = struct.unpack_from("<BHBIHQ", payload)
        if ref_type in (SETPOINT, KNOTS):
            self.acks.append((result, detail, self.in_flight.pop(ref_seq, 0)))
        elif ref_type != HELLO or result != OK:
            self.answer = (ref_type, ref_seq, (result, detail))

    def request(self, kind, payload):
        """Sends a reliable message until it is answered; the answer (section 3)."""
        seq, self.reliable_seq = self.reliable_seq, (self.reliable_seq + 1) % 65536
        for _ in range(10):
            self.answer = None
            self.port.write(frame(kind, seq, payload))
            deadline = time.monotonic() + 0.1
            while time.monotonic() < deadline:
                self.turn(deadline - time.monotonic())
                if self.answer and self.answer[0] == kind and self.answer[1] in (seq, None):
                    return self.answer[2]
        raise TimeoutError(f"no answer to message {kind:#04x}")

    def demand(self, kind, payload):
        result, detail = self.request(kind, payload)
        if result != OK:
            raise RuntimeError(f"message {kind:#04x} was refused with result {result}, detail {detail}")

    def command(self, code, time_us=0):
        self.demand(COMMAND, struct.pack("<HBQ", self.session, code, time_us))

    def until(self, states, seconds):
        deadline = time.monotonic() + seconds
        while self.state not in states:
            if time.monotonic() > deadline:
                raise TimeoutError(f"the device is in state {self.state}; faults {self.faults}")
            self.turn(0.05)

    def hello(self):
        reply = self.request(HELLO, struct.pack("<HIH", VERSION, SCHEMA_HASH, self.session))
        if isinstance(reply, tuple):
            raise RuntimeError(f"Hello was refused with result {reply[0]}")
        version, schema, _, *firmware = struct.unpack_from("<HIH3B", reply)
        if (version, schema) != (VERSION, SCHEMA_HASH):
            raise RuntimeError(f"the device speaks version {version}, schema {schema:#010x}")
        self.state, self.capacity = reply[16], struct.unpack_from("<H", reply, 18)[0]
        self.heartbeat_due = 0.0
        print(f"connected: firmware {'.'.join(map(str, firmware))}, {reply[17]} channels, state {self.state}")

    def make_safe(self):
        if self.state in (RUNNING, HOLDING):
            self.command(VENT)
        if self.state == FAULTED:
            self.command(CLEAR_FAULTS)
        self.until([IDLE, READY], 30)

    def configure(self, channels, pressure_max_pa):
        """Section 5: straight tubes of a neo-Hookean elastomer with two windings, set points in pascal."""
        times, air = (5000, 20000, 250000, 2000000, 0), (20e3, 100e3, 300e3, 101325, 293.15, 1.44e-9, 0.3)
        system = struct.pack("<4IB7f2I5fHBHH", *times, *air, 3500, 2000, 3.78e-9, 0, 206843, 0, 689476, 4095, 0, 0, 0)
        parts = [(BEGIN, struct.pack("<B", channels)), (SYSTEM, system)]
        for channel in range(channels):
            codes = struct.pack("<6B", channel, 0, 0, 0, 2, 0)
            tube = struct.pack("<12f", 0.008, 0.011, 0.18, 2e5, 0, 0, 0.05, 3.61e8, 1.78e-4, 0.011, pressure_max_pa, 2e-6)
            parts.append((CHANNEL, codes + tube + struct.pack("<2i", 0, int(pressure_max_pa))))
        for kind, payload in parts:
            self.demand(kind, struct.pack("<H", self.session) + payload)
        whole = crc32c(b"".join(payload for _, payload in parts))
        self.demand(COMMIT, struct.pack("<HI", self.session, whole))
        self.until([READY], 5)
        self.command(CLEAR_FAULTS)
        self.demand(SET_SAMPLING, struct.pack("<HIBB", self.session, 5000, min(4, 230 // (2 + 3 * channels)), 0))  # section 7.6

    def send_knots(self, knots, index, count):
        """The first knot as it is, the others by their steps (section 6); how many were sent."""
        if index == 0:
            (time_us, outputs, values), kind, count = knots[0], SETPOINT, 1
            form = f"<HIQBB{len(values)}i"
            payload = struct.pack(form, self.session, index, time_us, outputs, len(values), *values)
        else:
            kind, count = KNOTS, min(count, 4, len(knots) - index)  # four of 27 channels fit
            payload = struct.pack("<HIB", self.session, index, count)
            for (last_us, _, last), (time_us, outputs, values) in zip(knots[index - 1 :], knots[index : index + count]):
                steps = [value - before for value, before in zip(values, last)]
                payload += struct.pack(f"<HBB{len(steps)}h", time_us - last_us, outputs, len(steps), *steps)
        self.in_flight[self.seq] = count
        self.send(kind, payload)
        return count

    def stream(self, knots, on_telemetry):
        """Up to eight knots (device us, outputs, values) on the way; goes back to the index that a refusal names."""
        sent, accepted, free, sent_at, started, seen = 0, 0, self.capacity, 0.0, False, None
        begin_us, end_us = knots[0][0], knots[-1][0]
        while True:
            while sent < len(knots) and sent - accepted < min(8, free):
                sent += self.send_knots(knots, sent, min(8, free) - (sent - accepted))
                sent_at = time.monotonic()
            self.turn(0.005)
            for result, detail, count in self.acks:
                if result == OK:
                    accepted = min(accepted + count, sent)
                elif result == UNEXPECTED_INDEX:
                    accepted = sent = detail
                elif result != QUEUE_FULL:
                    raise RuntimeError(f"knot {accepted} was refused with result {result}, detail {detail}")
            self.acks.clear()
            if self.telemetry and self.telemetry is not seen:
                seen = self.telemetry
                accepted, free = max(accepted, seen["next_index"]), seen["free_knots"]
                sent = max(sent, accepted)
                on_telemetry(seen)
            if sent > accepted and time.monotonic() - sent_at > 0.1:
                sent = accepted
            if not started and (accepted == len(knots) or accepted >= self.capacity - 8):
                self.command(START, begin_us)
                started = True
            if self.state == FAULTED:
                raise RuntimeError(f"the device faulted: {self.faults}")
            if accepted == len(knots) and self.state == HOLDING and now_us() + self.offset_us >= end_us:
                return


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("address", help="tcp:HOST:PORT or a serial device")
    for name, default in (("--channels", 1), ("--amplitude-kpa", 30.0), ("--seconds", 2.0)):
        arguments.add_argument(name, type=type(default), default=default)
    options = arguments.parse_args()
    host = Host(Port(options.address))
    host.hello()
    host.make_safe()
    host.configure(options.channels, 60e3)
    while host.telemetry is None or 10 * host.telemetry["supply_10pa"] < 100e3:
        host.turn(0.05)
    begin_us, seen, knots = int(now_us() + host.offset_us) + 500_000, [], []
    for at_us in range(0, int(1e6 * options.seconds) + 1, 20_000):
        value = round(1e3 * options.amplitude_kpa * (1 - math.cos(2e-6 * math.pi * at_us)) / 2)
        closed = GRIPPER if at_us >= 5e5 * options.seconds else 0
        knots.append((begin_us + at_us, closed, [value] * options.channels))
    host.stream(knots, seen.append)
    host.command(VENT)
    host.until([READY], 60)
    seen = [telemetry for telemetry in seen if telemetry["state"] == RUNNING]
    errors = [p - r for telemetry in seen for p, r, duty, _ in telemetry["channels"] if duty == 0]
    grips = [telemetry["outputs"] & GRIPPER for telemetry in seen]
    rmse = math.sqrt(sum(e * e for e in errors) / max(len(errors), 1))
    print(f"ran {len(knots)} knots; pressure RMSE {rmse * 1e-3:.2f} kPa over {len(errors)} samples with closed valves")
    print(f"{len(host.samples)} samples between; gripper closed in {sum(grips)} of {len(grips)} messages; vented")


if __name__ == "__main__":
    main()
