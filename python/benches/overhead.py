"""Overhead of a call: calls without an answer beside calls with many, in turns in one run, by processor time of all threads.

    python python/benches/overhead.py
"""

import time
from collections.abc import Callable

import numpy as np

import softlimb

ROUNDS = 15


def mean_s(call: Callable[[], object], repeats: int) -> float:
    """Mean processor time of a call, of all threads."""
    begin = time.process_time()
    for _ in range(repeats):
        call()
    return (time.process_time() - begin) / repeats


def main() -> None:
    silicone = softlimb.NeoHookean(shear_modulus_pa=0.2e6)
    thread = softlimb.Fiber(angle_rad=np.radians(3), families=2, modulus_pa=3.61e8, thickness_m=0.178e-3)
    sizes = {"inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.1, "material": silicone}
    straight = softlimb.Actuator(motion="extension", fiber=thread, **sizes)
    bender = softlimb.Actuator(motion="bending", **sizes)
    calls: dict[tuple[str, int], Callable[[], object]] = {}
    for name, actuator in (("extension", straight), ("bending", bender)):
        for count in (0, 1, 100, 10_000):
            pressures = np.linspace(1e3, 3e4, count)
            calls[name, count] = lambda actuator=actuator, pressures=pressures: actuator.forward(pressures)
    found = {key: [] for key in calls}
    for _ in range(ROUNDS):
        for key, call in calls.items():
            found[key].append(mean_s(call, 200 if key[1] < 1000 else 5))
    print(f"{'actuator':10} {'answers':>8} {'us a call':>10} {'ns an answer':>13} {'overhead, %':>12}")
    for (name, count), times in found.items():
        call_s, empty_s = min(times), min(found[name, 0])
        each = f"{1e9 * call_s / count:13.0f}" if count else f"{'':13}"
        print(f"{name:10} {count:8} {1e6 * call_s:10.1f} {each} {100 * empty_s / call_s:12.2f}")


if __name__ == "__main__":
    main()
