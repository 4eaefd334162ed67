#!/usr/bin/env python3
"""Sets the design of a limb from tip way-points against CMA-ES on the same tasks.

Needs Python 3 and the package cma (pip install cma). Both searches use the same objective function: this script asks for it through

    cargo run --release -p softlimb --example design_path evaluate KIND SEED

which answers places of the unit box on its standard input. CMA-ES gets at least --evaluations objective values and at least as much time
as the design took (its own and the pipe's included); then the least objective of both is printed. CMA-ES starts in the middle of
the box with a step of 0.3, restarts with twice the population (IPOP) when it stops early, and stays within the box by cma's own transformation.
"""

import argparse
import re
import statistics
import subprocess
import time

import cma


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
    """The least objective that CMA-ES finds, and the time it took."""
    begin = time.perf_counter()
    best = float("inf")
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
        population, restart = 2 * search.popsize, restart + 1
    return best, time.perf_counter() - begin


def by_design(command, kind, seeds):
    """Objective and seconds of every seed."""
    text = subprocess.run(command + [str(seeds), kind], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\w (\d+) J (\S+) mm2.*, ([\d.]+) s", text, re.MULTILINE)
    return {int(seed): (float(objective), float(seconds)) for seed, objective, seconds in found}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20, help="tasks of each kind (default 20)")
    parser.add_argument("--kinds", default="ABCE", help="kinds of tasks (default ABCE)")
    parser.add_argument("--evaluations", type=int, default=20000, help="objective values that CMA-ES gets at least (default 20000)")
    parser.add_argument("--example", default=None, help="the example's program, where it is built already")
    arguments = parser.parse_args()
    command = [arguments.example] if arguments.example else "cargo run --release -q -p softlimb --example design_path --".split()
    print("kind  median J, mm2: design      CMA-ES   ratio   median time, s: design  CMA-ES   evaluations of CMA-ES")
    for kind in arguments.kinds:
        design = by_design(command, kind, arguments.seeds)
        rows = []
        for seed in range(arguments.seeds):
            objective = Objective(command, kind, seed)
            least, seconds = by_cma(objective, seed, arguments.evaluations, design[seed][1])
            rows.append((least, seconds, objective.evaluations))
            objective.close()
        ours, theirs = statistics.median(j for j, _ in design.values()), statistics.median(row[0] for row in rows)
        times = statistics.median(s for _, s in design.values()), statistics.median(row[1] for row in rows)
        evaluations = statistics.median(row[2] for row in rows)
        print(f"{kind:4}  {ours:22.3e}  {theirs:10.3e}  {theirs / max(ours, 1e-12):6.0e}  {times[0]:22.2f}  {times[1]:6.1f}   {evaluations:.0f}", flush=True)
    print("The ratio counts objectives below 1e-12 mm2 as 1e-12.")


if __name__ == "__main__":
    main()
