"""The Python package and the batch in Rust beside the strongest peers: numba on all processors, JAX, and numpy, each with the same equations.

    cargo xtask wheel
    python3 -m venv .venv && .venv/bin/pip install numpy scipy numba jax target/python/wheels/*.whl
    .venv/bin/python fra-model/benches/speed_peers.py

All solve the same arrays of actuators in turns, and the fastest of several runs counts. The answers are compared. Nothing else should be running.
"""

import tempfile
import time
import warnings

import numpy as np
import softlimb
import speed_compiled as compiled
from speed import rust_times
from speed_baselines import newton_forward, sample, wall_closed

COUNT = 16384
ROUNDS = 5
RUNS = 7
LENGTH_M = 0.1
# `2 C2/mu` and `3 C3/mu` of the Yeoh walls.
YEOH = 0.08, 0.005


def fields(t, motion, fiber, yeoh=(0.0, 0.0)):
    a, b = yeoh
    silicone = softlimb.Yeoh(c1_pa=t.mu1 / 2, c2_pa=a * t.mu1 / 2, c3_pa=b * t.mu1 / 3) if a else softlimb.NeoHookean(shear_modulus_pa=t.mu1)
    sheet = softlimb.Fiber(angle_rad=t.angle, families=2, modulus_pa=t.mu2, thickness_m=t.thickness) if fiber else None
    sizes = {"inner_radius_m": t.inner, "outer_radius_m": t.outer, "length_m": LENGTH_M}
    return {"motion": motion, "material": silicone, "fiber": sheet, **sizes}


def actuators(*given):
    return softlimb.Actuator(**fields(*given))


class Case:
    """A question, and the ways to answer it by name; each returns the answers that are compared."""

    def __init__(self, name, ways):
        self.name, self.ways = name, ways
        self.seconds = dict.fromkeys(ways, np.inf)
        self.answers = {way: run() for way, run in ways.items()}

    def measure(self):
        for way, run in self.ways.items():
            for _ in range(RUNS):
                start = time.perf_counter()
                run()
                self.seconds[way] = min(self.seconds[way], time.perf_counter() - start)

    def difference(self):
        """Median and largest relative difference from the first way, over all others."""
        first, *others = self.answers.values()
        off = np.abs(np.stack(others) / first - 1.0)
        return np.median(off), np.nanmax(off)


def cases(t):
    columns = [getattr(t, name) for name in t.__dataclass_fields__]
    zero = np.zeros(len(t))
    length = np.full(len(t), LENGTH_M)
    tubes, thick = actuators(t, "extension", True), actuators(t, "extension", True, YEOH)
    of_law = [np.full(len(t), value) for value in YEOH]
    yield Case("forward", {
        "Python": lambda: tubes.forward(t.pressure).axial_stretch,
        "numba": lambda: compiled.numba_forward(*columns, zero, zero)[0],
        "JAX": lambda: compiled.jax_forward(*columns)[0].block_until_ready(),
        "numpy": lambda: newton_forward(t, wall_closed())[0],
    })
    yield Case("forward from arrays", {
        "Python": lambda: softlimb.Actuator.forward_once(t.pressure, **fields(t, "extension", True)).axial_stretch,
        "numba": lambda: compiled.numba_forward(*columns, zero, zero)[0],
        "JAX": lambda: compiled.jax_forward(*columns)[0].block_until_ready(),
        "numpy": lambda: newton_forward(t, wall_closed())[0],
    })
    yield Case("forward, Yeoh", {
        "Python": lambda: thick.forward(t.pressure).axial_stretch,
        "numba": lambda: compiled.numba_forward_yeoh(*columns, *of_law)[0],
    })
    # Windings that lengthen: the stretch rises with the pressure, and has one.
    long = t.take(t.angle < 0.4)
    lengthening = actuators(long, "extension", True)
    of_long = [getattr(long, name) for name in long.__dataclass_fields__][:6]
    stretch = lengthening.forward(long.pressure).axial_stretch
    yield Case("inverse", {
        "Python": lambda: lengthening.inverse(axial_stretch=stretch).pressure_pa,
        "numba": lambda: compiled.numba_inverse(*of_long, stretch)[0],
    })
    bend = np.random.default_rng(8).uniform(0.02, 0.35, len(t)) * LENGTH_M / t.outer
    for name, yeoh in (("bend", (0.0, 0.0)), ("bend, Yeoh", YEOH)):
        of_wall = [np.full(len(t), value) for value in yeoh]
        benders = actuators(t, "bending", False, yeoh)
        wall = t.inner, t.outer, length, t.mu1, *of_wall
        pressure = benders.inverse(bend_angle_rad=bend, model="analytic").pressure_pa
        yield Case(f"inverse, {name}", {
            "Python": lambda benders=benders: benders.inverse(bend_angle_rad=bend, model="analytic").pressure_pa,
            "numba": lambda wall=wall: compiled.numba_bend_inverse(*wall, bend),
        })
        yield Case(f"forward, {name}", {
            "Python": lambda benders=benders, p=pressure: benders.forward(p, model="analytic").bend_angle_rad,
            "numba": lambda wall=wall, p=pressure: compiled.numba_bend_forward(*wall, p),
        })


def main():
    warnings.filterwarnings("ignore")
    t = sample(COUNT)
    rows = np.stack([getattr(t, name) for name in t.__dataclass_fields__], 1)
    measured, rust = list(cases(t)), {}
    with tempfile.TemporaryDirectory() as folder:
        np.savetxt(f"{folder}/sample.csv", rows, delimiter=",", fmt="%.17g")
        for _ in range(ROUNDS):
            for case in measured:
                case.measure()
            found = rust_times("softlimb-lab", "batch", folder)
            rust = {name: min(value, rust.get(name, np.inf)) for name, value in found.items()}
    print("| query | softlimb | peer | ns | ns | ratio | difference, median | largest |\n| --- | --- | --- | --: | --: | --: | --: | --: |")
    for case in measured:
        count = len(next(iter(case.answers.values())))
        ns = {way: seconds / count * 1e9 for way, seconds in case.seconds.items()}
        own = {"Python": ns.pop("Python")}
        if case.name == "forward":
            own["batch in Rust"] = rust["forward_batch_two"]
        median, largest = case.difference()
        for name, here in own.items():
            for peer, there in ns.items():
                print(f"| {case.name} | {name} | {peer} | {here:.0f} | {there:.0f} | {there / here:.2f} | {median:.0e} | {largest:.0e} |")


if __name__ == "__main__":
    main()
