"""The workspace of a scene in numpy beside `softlimb workspace`: the same tables, the same answers, time side by side.

    python3 -m venv .venv && .venv/bin/pip install numpy
    .venv/bin/python host/lab/benches/workspace/compare.py [SCENE]

Takes the polynomials that `softlimb workspace --json` prints, computes tips with numpy on whole arrays (in the piece size that suits the
cache best), and compares them with the samples that the command writes. Three ways in numpy: plainly, as the formulas are written, in double precision;
tuned for speed (`tuned.py`), with polynomials as short as those of the product, in double and in single precision, which the product takes for samples.
Times are the fastest of several runs on one thread, and of two processes beside two threads; those of the product come from
`cargo run --release -p softlimb-lab --example workspace_speed`. Nothing else should be running.
"""

import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
import numpy as np

from tuned import Tuned

WORKSPACE = Path(__file__).resolve().parents[4]
PROFILE = os.environ.get("SPEED_PROFILE", "release")
COUNT = 200_000
SIZES = (512, 1024, 2048, 4096, 8192, 16384)
# What the polynomials of the product's samples are made to.
TOLERANCE = 3e-7


def cargo(*words):
    command = ["cargo", "run", "--quiet", "--profile", PROFILE, "-p", *words]
    return subprocess.run(command, cwd=WORKSPACE, check=True, capture_output=True, text=True).stdout


def even(count, axes, seed=1):
    """The samples of the product: R_d sequence with offsets of SplitMix64."""
    root = 1.5
    for _ in range(60):
        root = (1 + root) ** (1 / (axes + 1))
    mask = (1 << 64) - 1
    offsets = []
    for axis in range(axes):
        z = (seed + (axis + 1) * 0x9E3779B97F4A7C15) & mask
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        offsets.append(((z ^ (z >> 31)) >> 11) / 2.0**53)
    steps = np.array([root ** -(axis + 1) for axis in range(axes)])
    return (np.array(offsets) + np.arange(1, count + 1)[:, None] * steps) % 1.0


def polynomial(powers, x):
    total = np.full_like(x, powers[-1])
    for power in powers[-2::-1]:
        total = total * x + power
    return total


def bundle(module, shares):
    """Stretch and bends of a bundle of springs."""
    stretch, axial, own = module["powers"]
    s = sx = sy = xx = xy = yy = r = rx = ry = 0.0
    for (x, y), share in zip(module["places_m"], shares.T):
        place = 2 * share - 1
        l, k, b = polynomial(stretch, place), polynomial(axial, place), polynomial(own, place)
        kx, ky, kl = k * x, k * y, k * l
        s, sx, sy = s + k, sx + kx, sy + ky
        xx, xy, yy = xx + kx * x + b, xy + kx * y, yy + ky * y + b
        r, rx, ry = r + kl, rx + kl * x, ry + kl * y
    mx, my = sx / s, sy / s
    a, b, c = xx - mx * sx, xy - mx * sy, yy - my * sy
    fx, fy = mx * r - rx, my * r - ry
    scale = 1 / (a * c - b * b)
    ux, uy = (c * fx - b * fy) * scale, (a * fy - b * fx) * scale
    return (r + sx * ux + sy * uy) / s, ux, uy


def carry(module, shares, x, y, z):
    z = z + module["rigid_m"]
    if "places_m" in module:
        stretch, ux, uy = bundle(module, shares)
        length, bx, by = stretch * module["length_m"], ux * module["length_m"], uy * module["length_m"]
        twist = 0.0
    else:
        place = 2 * shares[:, 0] - 1
        length = polynomial(module["powers"][0], place)
        bx = polynomial(module["powers"][1], place) if module["bends"] else 0.0
        twist = polynomial(module["powers"][2], place) if module["twists"] else 0.0
        by = np.zeros_like(length)
    if module["twists"]:
        cos, sin = np.cos(twist), np.sin(twist)
        return cos * x - sin * y, sin * x + cos * y, z + length
    if not module["bends"]:
        return x, y, z + length
    cos, sin = module["mount"]
    x, y = cos * x + sin * y, cos * y - sin * x
    square = bx * bx + by * by
    angle = np.sqrt(square)
    small = square < 1e-8
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 1 - square / 6, np.sin(safe) / safe)
    b = np.where(small, 0.5 - square / 24, (1 - np.cos(safe)) / np.where(small, 1.0, square))
    along = bx * y - by * x
    x2 = x + a * bx * z + b * (-by * along - square * x) + length * b * bx
    y2 = y + a * by * z + b * (bx * along - square * y) + length * b * by
    z2 = z - a * (bx * x + by * y) - b * square * z + length * a
    return cos * x2 - sin * y2, sin * x2 + cos * y2, z2


def tips(tables, shares):
    x = y = z = np.zeros(len(shares))
    end = shares.shape[1]
    for module in reversed(tables["modules"]):
        start = end - module["axes"]
        x, y, z = carry(module, shares[:, start:end], x, y, z)
        end = start
    return np.stack([x, y, z], 1) @ np.array(tables["rotation"]).T + np.array(tables["origin_m"])


def fastest(run, times=40):
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
    return best


def main():
    scene = sys.argv[1] if len(sys.argv) > 1 else "scenes/pick-and-place-a.toml"
    with tempfile.TemporaryDirectory() as folder:
        csv = f"{folder}/tips.csv"
        out = cargo("softlimb", "--bin", "softlimb", "--", "workspace", scene, "--json", "--samples", "20000", "--csv", csv, "--points", "even")
        written = np.loadtxt(csv, delimiter=",", skiprows=1)
    answer = json.loads(out)
    tables = answer["kinematics"]
    axes = len(answer["axes"])
    shares = even(COUNT, axes)
    ways = {"numpy, plain": lambda piece: tips(tables, piece)}
    pieces = {"numpy, plain": shares}
    for name, dtype in (("numpy, tuned", np.float64), ("numpy, tuned, single precision", np.float32)):
        tuned = Tuned(tables, dtype, TOLERANCE)
        ways[name] = lambda piece, tuned=tuned: tuned.tips(piece.T).T
        pieces[name] = np.ascontiguousarray(2 * shares.T - 1).astype(dtype).T
    own = json.loads(cargo("softlimb-lab", "--example", "workspace_speed", "--", scene))
    times = {"softlimb, double precision": (own["double_s"], own["double_two_threads_s"])}
    times["softlimb, samples"] = (own["sample_s"], own["sample_two_threads_s"])
    for name, way in ways.items():
        off = np.abs(way(pieces[name][:20000]) - written).max()
        one = {size: fastest(lambda: way(part(pieces[name], size))) / size for size in SIZES}
        size = min(one, key=one.get)
        times[name] = one[size], together(way, part(pieces[name], size))
        print(f"{name:34} at most {1e6 * off:6.1f} um from the samples of the product, which are in steps of 1 um")
    print(f"\n{'ns a sample':34} {'one thread':>12} {'two':>8}   times as long as the samples of the product")
    for name, (one, two) in times.items():
        ratios = one / times["softlimb, samples"][0], two / times["softlimb, samples"][1]
        print(f"{name:34} {one * 1e9:12.1f} {two * 1e9:8.1f}   {ratios[0]:.1f}, {ratios[1]:.1f}")
    print(f"\nextents {own['extents_s'] * 1e3:.2f} ms; tables {own['build_s'] * 1e3:.2f} ms")


def part(samples, size):
    """The first samples, in the order in memory that they have."""
    return np.ascontiguousarray(samples[:size].T).T if samples.flags.f_contiguous else samples[:size]


def together(way, piece, processes=2, rounds=200):
    """Seconds a sample of two processes that work at the same time."""
    barrier, context = multiprocessing.Barrier(processes), multiprocessing.get_context("fork")
    ends = context.SimpleQueue()

    def work():
        barrier.wait()
        start = time.perf_counter()
        for _ in range(rounds):
            way(piece)
        ends.put(time.perf_counter() - start)

    workers = [context.Process(target=work) for _ in range(processes)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    return max(ends.get() for _ in workers) / (processes * rounds * len(piece))


if __name__ == "__main__":
    main()
