#!/usr/bin/env python3
"""Sets the design of a limb from tip way-points against CMA-ES on the same tasks.

Needs Python 3 and the package cma (pip install cma). Both searches use the same objective function: this script asks for it through

    cargo run --release -p softlimb-lab --example design_path evaluate KIND SEED

which answers places of the unit box on its standard input. CMA-ES gets at least --evaluations objective values and at least as much time
as the design took; the least objective is printed for the design, for CMA-ES after the same time (start, pipe and its own arithmetic included,
the tables of the objective not), and for CMA-ES at its end. CMA-ES starts in the middle of
the box with a step of 0.3, restarts with twice the population (IPOP) when it stops early, and stays within the box by cma's own transformation.
"""

import argparse
import os
import re
import statistics
import subprocess
import time

# One thread: the matrices are small, and threads that wait for each other take longer.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import cma  # noqa: E402


class Objective:
    """The objective of one task, asked of the running example."""

    def __init__(self, command, kind, seed):
        self.process = subprocess.Popen(command + ["evaluate", kind, str(seed)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.width = int(self.process.stdout.readline())
        self.evaluations = 0

    def many(self, places):
        """The objectives of several places, asked in one go."""
        self.process.stdin.write("".join(" ".join(map(repr, map(float, place))) + "\n" for place in places))
        self.process.stdin.flush()
        self.evaluations += len(places)
        return [float(self.process.stdout.readline()) for _ in places]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def by_cma(objective, seed, evaluations, seconds):
    """The least objectives that CMA-ES finds in that time and with as many evaluations, and the time these took."""
    begin = time.perf_counter()
    best, in_time = float("inf"), None
    population, restart = None, 0

    def spent():
        return objective.evaluations >= evaluations and time.perf_counter() - begin >= seconds

    while not spent():
        options = {"bounds": [0.0, 1.0], "seed": 1 + 1000 * seed + restart, "verbose": -9}
        if population:
            options["popsize"] = population
        search = cma.CMAEvolutionStrategy([0.5] * objective.width, 0.3, options)
        while not search.stop() and not spent():
            places = search.ask()
            values = objective.many(places)
            search.tell(places, values)
            best = min(best, min(values))
            if in_time is None and time.perf_counter() - begin >= seconds:
                in_time = best
        population, restart = 2 * search.popsize, restart + 1
    return best if in_time is None else in_time, best, time.perf_counter() - begin


def by_design(command, kind, seeds):
    """Objective and seconds of every seed."""
    text = subprocess.run(command + [str(seeds), kind], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\w (\d+) J (\S+) mm2.*, ([\d.]+) s", text, re.MULTILINE)
    return {int(seed): (float(objective), float(seconds)) for seed, objective, seconds in found}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20, help="tasks of each kind (default 20)")
    parser.add_argument("--kinds", default="ABCEH", help="kinds of tasks (default ABCEH)")
    parser.add_argument("--evaluations", type=int, default=20000, help="objective values that CMA-ES gets at least (default 20000)")
    parser.add_argument("--example", default=None, help="the example's program, where it is built already")
    arguments = parser.parse_args()
    command = [arguments.example] if arguments.example else "cargo run --release -q -p softlimb-lab --example design_path --".split()
    print("kind  median J, mm2 (and how many are at most 0.2): design  CMA-ES, equal time  CMA-ES, all evaluations   median time, s: design, CMA-ES")
    for kind in arguments.kinds:
        design = by_design(command, kind, arguments.seeds)
        in_time, in_all, times = [], [], []
        for seed in range(arguments.seeds):
            objective = Objective(command, kind, seed)
            first, last, seconds = by_cma(objective, seed, arguments.evaluations, design[seed][1])
            objective.close()
            in_time.append(first)
            in_all.append(last)
            times.append(seconds)
        columns = [[j for j, _ in design.values()], in_time, in_all]
        cells = [f"{statistics.median(column):9.2e} ({sum(j <= 0.2 for j in column)})" for column in columns]
        took = statistics.median(s for _, s in design.values()), statistics.median(times)
        print(f"{kind}  {'  '.join(cells)}  {took[0]:.2f}, {took[1]:.1f}", flush=True)


if __name__ == "__main__":
    main()
