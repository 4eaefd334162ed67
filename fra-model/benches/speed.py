"""Ratios of speed between the solvers of this workspace and the same equations solved in Python, measured side by side.

    python3 -m venv .venv && .venv/bin/pip install numpy scipy
    .venv/bin/python fra-model/benches/speed.py

Runs `cargo bench` of fra-model and softlimb on a sample of actuators, the solvers of `speed_baselines.py` on the same ones, compares the
answers, and prints a table. Every time is the fastest of several runs; Python and Rust take turns. Nothing else should be running.
"""

import os
import subprocess
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from speed_baselines import fsolve_forward, newton_forward, sample, wall_by_quadrature, wall_closed

COUNT = 16384
ROUNDS = 3
FSOLVES = 60
WORKSPACE = Path(__file__).resolve().parents[2]


def fastest(run, times):
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    return best


def numpy_time(tubes, wall):
    """Nanoseconds per answer, in pieces of the size that suits the cache best."""
    best = np.inf
    for size in (512, 1024, 2048, 4096, len(tubes)):
        piece = tubes.take(slice(0, size))
        best = min(best, fastest(lambda: newton_forward(piece, wall), 7) / size)
    return best * 1e9


def fsolve_time(tubes):
    columns = np.stack([getattr(tubes, name)[:FSOLVES] for name in tubes.__dataclass_fields__], 1)
    found = []
    seconds = fastest(lambda: found.append([fsolve_forward(*row) for row in columns]), 1)
    return seconds / FSOLVES * 1e9, found[-1]


def rust_times(package, bench, folder):
    environment = dict(os.environ, SPEED_SAMPLE=f"{folder}/sample.csv", SPEED_ANSWERS=f"{folder}/answers.csv")
    command = ["cargo", "bench", "--quiet", "-p", package, "--bench", bench]
    output = subprocess.run(command, cwd=WORKSPACE, env=environment, check=True, capture_output=True, text=True).stdout
    return {name: float(value) for name, value in (line.split() for line in output.splitlines() if line.count(" ") == 1)}


def main():
    warnings.filterwarnings("ignore")
    tubes = sample(COUNT)
    columns = np.stack([getattr(tubes, name) for name in tubes.__dataclass_fields__], 1)
    quadrature, closed = wall_by_quadrature(), wall_closed()
    with tempfile.TemporaryDirectory() as folder:
        np.savetxt(f"{folder}/sample.csv", columns, delimiter=",", fmt="%.17g")
        times = {}
        for _ in range(ROUNDS):
            measured = rust_times("fra-model", "speed", folder) | rust_times("softlimb-lab", "batch", folder)
            measured["numpy_quadrature"] = numpy_time(tubes, quadrature)
            measured["numpy_closed"] = numpy_time(tubes, closed)
            measured["fsolve"], by_fsolve = fsolve_time(tubes)
            times = {name: min(value, times.get(name, np.inf)) for name, value in measured.items()}
        answers = np.loadtxt(f"{folder}/answers.csv", delimiter=",")

    stretch, radius, done = newton_forward(tubes, quadrature)
    print(f"{COUNT} actuators; answered by numpy {done.mean():.1%}, here {answers[:, 2].mean():.1%}")
    print(f"largest difference from numpy: stretch {np.abs(answers[done, 0] - stretch[done]).max():.1e}, "
          f"radius {np.abs(answers[done, 1] / radius[done] - 1).max():.1e}")
    print(f"largest difference from fsolve: stretch {max(abs(f[0] - a[0]) for f, a in zip(by_fsolve, answers) if f[2]):.1e}\n")
    table(times)


def table(times):
    rows = [
        ("fsolve and adaptive quadrature", "one forward solve", "fsolve", "forward_cold_two"),
        ("numpy, quadrature", "one forward solve", "numpy_quadrature", "forward_cold_two"),
        ("numpy, quadrature", "one forward solve, actuators from memory", "numpy_quadrature", "forward_from_memory_two"),
        ("numpy, closed forms", "one forward solve", "numpy_closed", "forward_cold_two"),
        ("numpy, quadrature", "one build and forward solve", "numpy_quadrature", "build_and_forward_two"),
        ("numpy, quadrature", "batch of forward solves", "numpy_quadrature", "forward_batch_two"),
        ("numpy, closed forms", "batch of forward solves", "numpy_closed", "forward_batch_two"),
        ("numpy, quadrature", "batch, not prepared", "numpy_quadrature", "forward_batch_as_they_come_two"),
        ("search along the branch", "one forward solve", "forward_search_two", "forward_cold_two"),
        ("one family, forward", "two families, forward", "forward_cold_one", "forward_cold_two"),
        ("one family, inverse", "two families, inverse", "inverse_cold_one", "inverse_cold_two"),
        ("one family, inverse, warm, f32", "two families, the same", "inverse_near_f32_one", "inverse_near_f32_two"),
    ]
    print("| slower | faster | ns | ns | ratio |\n| --- | --- | --- | --- | --- |")
    for slower, faster, a, b in rows:
        print(f"| {slower} | {faster} | {times[a]:.0f} | {times[b]:.0f} | {times[a] / times[b]:.2f} |")
    print(f"\nevaluations of a forward solve: two families {times['evaluations_two']:.2f}, one family {times['evaluations_one']:.2f}")


if __name__ == "__main__":
    main()
