#!/usr/bin/env python3
"""Methods for eq. (14) side by side, on problems made by seed.

Asked are `softlimb design actuators`, and of the Python package index a particle swarm (pyswarms), CMA-ES (cma), differential
evolution and least squares from many starts (scipy). They ask the same model: `softlimb design actuators FILE --evaluate`.
Every method gets as many evaluations as it is told; `softlimb design actuators` takes what it takes. The least objective that any of
them finds is the best known, and gaps are relative to it.

    python3 -m venv venv && venv/bin/pip install numpy scipy cma pyswarms
    cargo build --release -p softlimb
    venv/bin/python host/lab/benches/design/compare.py

Several commands with a --first of their own share the work; the problems of a seed are the same.

Kinds: A, B, C reachable; F, G as A and B with one pressure for all segments. The methods of the index are run on the first
--others problems of each kind; on the others softlimb is compared with a search of its own with 100 descents from other starts.
"""
import argparse
import contextlib
import json
import logging
import math
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy

PHASES = 4
CHUNK = 32  # points that are on their way at a time: they fit into a pipe
MOTIONS = {"A": "ebe", "B": "tbe", "C": "ebb", "F": "ebe", "G": "tbe"}
NAMES = {"e": "extension", "b": "bending", "t": "twisting"}
TARGETS = {"e": "length_m", "b": "bend_angle_rad", "t": "twist_rad"}
ANGLES = {"e": [0, 15], "t": [15, 45]}
WEIGHTS = {"length_per_m2": 1e6, "bend_angle_per_rad2": 1e4, "twist_per_rad2": 1e4}


class Enough(Exception):
    """A method has used up its evaluations."""


class Model:
    """A problem, and a process that answers points of its unit box."""

    def __init__(self, program, problem, folder):
        self.file = Path(folder) / "problem.json"
        self.file.write_text(json.dumps(problem))
        self.program = program
        command = [program, "design", "actuators", str(self.file), "--evaluate"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        segments = problem["segments"]
        lines = 1 if problem["shared_pressure"] else len(segments)
        self.width = sum(3 + ("fiber" in segment) for segment in segments) + PHASES * lines
        self.evaluations = 0
        self.most = math.inf
        self.least = math.inf
        self.begin = time.monotonic()

    def ask(self, points):
        if self.evaluations >= self.most:
            raise Enough
        answers = []
        for first in range(0, len(points), CHUNK):
            chunk = points[first:first + CHUNK]
            for point in chunk:
                self.process.stdin.write(json.dumps([min(1.0, max(0.0, float(x))) for x in point]) + "\n")
            self.process.stdin.flush()
            answers += [json.loads(self.process.stdout.readline()) for _ in chunk]
        self.evaluations += len(points)
        for answer in answers:
            if answer["objective"] is None:
                answer["objective"] = 1e12
            self.least = min(self.least, answer["objective"])
        return answers

    def objectives(self, points):
        return numpy.array([answer["objective"] for answer in self.ask(points)])

    def differences(self, point):
        differences = self.ask([point])[0]["differences"]
        return numpy.full(self.width, 1e6) if differences is None else numpy.array(differences)

    def design(self, seed, starts=None):
        more = [] if starts is None else ["--starts", str(starts)]
        command = [self.program, "design", "actuators", str(self.file), "--json", "--seed", str(seed), *more]
        answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        self.evaluations = answer["cost"]["evaluations"]
        self.least = answer["objective"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def segment(letter, targets):
    made = {
        "name": NAMES[letter], "motion": NAMES[letter],
        "material": {"law": "neo-hookean", "shear_modulus_pa": 2e5},
        "bounds": {"inner_radius_m": [0.006, 0.010], "wall_m": [0.003, 0.005], "length_m": [0.1, 0.3],
                   "pressure_max_pa": 60000},
        "targets": {TARGETS[letter]: list(targets)},
    }
    if letter != "b":
        made["fiber"] = {"families": 1 if letter == "t" else 2, "modulus_pa": 3.61e8, "thickness_m": 0.000178}
        made["bounds"]["angle_deg"] = ANGLES[letter]
    return made


def problem(program, kind, seed):
    """Targets are what hidden geometries do at hidden pressures, each segment at its own."""
    random = numpy.random.default_rng([ord(kind), seed])
    letters = MOTIONS[kind]
    made = {"format": 1, "shared_pressure": False, "weights": WEIGHTS,
            "segments": [segment(letter, [1.0] * PHASES) for letter in letters]}
    with tempfile.TemporaryDirectory() as folder:
        model = Model(program, made, folder)
        differences = None
        while differences is None:
            differences = model.ask([random.random(model.width)])[0]["differences"]
        model.close()
    for index, letter in enumerate(letters):
        root = math.sqrt(WEIGHTS["length_per_m2" if letter == "e" else "bend_angle_per_rad2"])
        values = [1.0 + one / root for one in differences[PHASES * index:PHASES * (index + 1)]]
        made["segments"][index] = segment(letter, values)
    made["shared_pressure"] = kind in "FG"
    return made


def softlimb(model, budget, seed):
    model.design(seed)


def longer(model, budget, seed):
    model.design(seed + 1_000_000, 100)


def swarm(model, budget, seed):
    # It writes a log into the folder that it is run in.
    with contextlib.chdir(model.file.parent):
        import pyswarms
        logging.disable(logging.CRITICAL)
        numpy.random.seed(seed)
        box = (numpy.zeros(model.width), numpy.ones(model.width))
        options = {"c1": 1.49618, "c2": 1.49618, "w": 0.7298}
        optimizer = pyswarms.single.GlobalBestPSO(
            n_particles=50, dimensions=model.width, options=options, bounds=box, velocity_clamp=(-0.2, 0.2),
            bh_strategy="reflective")
        optimizer.optimize(model.objectives, iters=budget // 50, verbose=False)


def covariance(model, budget, seed):
    import cma
    random = numpy.random.default_rng(seed)
    run = 0
    while model.evaluations < budget:
        settings = {"bounds": [0, 1], "seed": seed * 100 + run + 1, "verbose": -9, "tolfun": 1e-13,
                    "maxfevals": budget - model.evaluations, "popsize_factor": 2 ** (run % 3)}
        strategy = cma.CMAEvolutionStrategy(random.random(model.width), 0.25, settings)
        while not strategy.stop() and model.evaluations < budget:
            points = strategy.ask()
            strategy.tell(points, list(model.objectives(points)))
        run += 1


def evolution(model, budget, seed):
    from scipy.optimize import differential_evolution
    size = 5 * model.width
    differential_evolution(
        lambda points: model.objectives(points.T), [(0, 1)] * model.width, popsize=5, maxiter=budget // size, tol=0,
        seed=seed, polish=False, updating="deferred", vectorized=True)


def squares(model, budget, seed):
    from scipy.optimize import least_squares
    random = numpy.random.default_rng(seed)

    def slopes(point):
        """By central differences: one-sided ones stop too early."""
        steps = numpy.minimum(1e-5, numpy.maximum(1e-9, numpy.minimum(point, 1 - point)))
        points = [point + sign * step * axis for step, axis in zip(steps, numpy.eye(model.width)) for sign in (1, -1)]
        answers = [answer["differences"] for answer in model.ask(points)]
        columns = [(numpy.array(up) - numpy.array(down)) for up, down in zip(answers[::2], answers[1::2])]
        return numpy.array(columns).T / (2 * steps)

    while model.evaluations < budget:
        try:
            least_squares(model.differences, random.random(model.width), slopes, bounds=(0, 1), xtol=1e-12, ftol=1e-14,
                          gtol=1e-12, max_nfev=100)
        except (TypeError, ValueError):
            pass  # no equilibrium on the way: the next start


OTHERS = {"swarm (pyswarms)": swarm, "CMA-ES (cma)": covariance, "differential evolution (scipy)": evolution,
          "least squares (scipy)": squares}


def measure(program, made, name, method, budget, seed):
    with tempfile.TemporaryDirectory() as folder:
        model = Model(program, made, folder)
        model.most = budget or math.inf
        try:
            method(model, budget, seed)
        except Enough:
            pass
        model.close()
        return {"method": name, "objective": model.least, "evaluations": model.evaluations,
                "seconds": time.monotonic() - model.begin}


def gap(objective, best):
    return objective - best if best <= 1e-12 else (objective - best) / best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/softlimb", help="the command (default: %(default)s)")
    parser.add_argument("--kinds", default="FG", help="of ABCFG (default: %(default)s)")
    parser.add_argument("--seeds", type=int, default=10, help="problems of each kind (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="first seed (default: %(default)s)")
    parser.add_argument("--others", type=int, default=1, help="problems of each kind on which all run (default: %(default)s)")
    parser.add_argument("--repeat", type=int, default=1, help="seeds of softlimb on each of those (default: %(default)s)")
    parser.add_argument("--evaluations", type=int, default=10_000, help="of each other method (default: %(default)s)")
    parser.add_argument("--methods", default="", help="only others whose name contains one of these words, by comma")
    arguments = parser.parse_args()
    if set(arguments.kinds) - set(MOTIONS):
        parser.error(f"--kinds {arguments.kinds}: of {''.join(MOTIONS)}")
    warnings.filterwarnings("ignore")
    words = [word for word in arguments.methods.split(",") if word]
    others = {name: method for name, method in OTHERS.items() if not words or any(word in name for word in words)}
    near, most, gaps = {}, {}, {}
    print(f"{'problem':<8} {'method':<32} {'objective':>16} {'gap':>9} {'evaluations':>12} {'s':>7}")
    for kind in arguments.kinds:
        for index in range(arguments.seeds):
            seed = arguments.first + index
            made = problem(arguments.program, kind, seed)
            all_run = index < arguments.others
            repeats = arguments.repeat if all_run else 1
            results = [measure(arguments.program, made, "softlimb design", softlimb, 0, seed + 1000 * again)
                       for again in range(repeats)]
            results += [measure(arguments.program, made, "softlimb design, 100 starts", longer, 0, seed)]
            if all_run:
                results += [measure(arguments.program, made, name, method, arguments.evaluations, seed)
                            for name, method in others.items()]
            best = min(result["objective"] for result in results)
            for result in results:
                here = gap(result["objective"], best)
                print(f"{kind} {seed:<6} {result['method']:<32} {result['objective']:16.9e} {here:9.1e} "
                      f"{result['evaluations']:12} {result['seconds']:7.2f}", flush=True)
                key = (kind, result["method"])
                near[key] = near.get(key, 0) + (here <= 1e-6)
                gaps.setdefault(key, []).append(here)
                most[key] = max(most.get(key, 0), result["evaluations"])
    print("\nwithin 1e-6 of the best known; gaps; most evaluations:")
    for (kind, method), count in near.items():
        every = gaps[kind, method]
        print(f"{kind} {method:<32} {count:3} of {len(every):<3} median {numpy.median(every):8.1e}, "
              f"largest {max(every):8.1e} {most[kind, method]:8}")


if __name__ == "__main__":
    sys.exit(main())
