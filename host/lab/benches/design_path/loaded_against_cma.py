#!/usr/bin/env python3
"""Sets the design of a limb under load against CMA-ES around the same statics.

Needs Python 3 and the package cma (pip install cma). Both searches judge limbs by the same function: this script asks for it through

    cargo run --release -p softlimb-design --example loaded_seeds -- SCENE evaluate

which answers points of the unit box on its standard input, a population at a time, in two threads. The design gets two threads, too. It has to keep
every margin with a reserve, by tubes between plates; CMA-ES only has to keep them without a reserve, by rods. CMA-ES starts at the design's first
guess with a step of 0.2, restarts with twice the population (IPOP) when it stops early, and stays within the box by cma's own transformation.
It gets --times as much time as the design took. Printed for each scene and seed: the time of the design to its confirmed limb and its reserve, what CMA-ES lacks
after the same time, the time after which it lacks nothing, and what it lacks at its end. A lack of 1 is 10 mm, 20 mm of clearance or a quarter of a limit.
"""

import argparse
import os
import re
import subprocess
import time

# One thread: the matrices are small, and threads that wait for each other take longer.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import cma  # noqa: E402

# The sum of squares of lacks that counts as none; the same as the design's.
NOTHING = 1e-5


class Objective:
    """The judge of one scene: the running example."""

    def __init__(self, command, scene):
        self.process = subprocess.Popen(command + [scene, "evaluate"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.guess = [float(word) for word in self.process.stdout.readline().split()]
        self.evaluations = 0

    def many(self, points):
        """Sum of squares of lacks and largest lack of several points, asked in one go."""
        self.process.stdin.write("".join(" ".join(map(repr, map(float, point))) + "\n" for point in points) + "\n")
        self.process.stdin.flush()
        self.evaluations += len(points)
        return [tuple(map(float, self.process.stdout.readline().split())) for _ in points]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def by_cma(objective, seed, equal_s, most_s):
    """The best pair of sum of squares and largest lack at equal time and at the end, and the time to none (None where it is not found)."""
    begin = time.perf_counter()
    best, at_equal = (float("inf"), float("inf")), None
    population, restart = None, 0
    while True:
        options = {"bounds": [0.0, 1.0], "seed": 1 + 1000 * seed + restart, "verbose": -9}
        if population:
            options["popsize"] = population
        search = cma.CMAEvolutionStrategy(objective.guess, 0.2, options)
        while not search.stop():
            points = search.ask()
            answers = objective.many(points)
            # A limb that does not stand is worse than any that does.
            search.tell(points, [value if value < 1e6 else 1e6 for value, _ in answers])
            spent = time.perf_counter() - begin
            if at_equal is None and spent > equal_s:
                at_equal = best
            best = min(best, min(answers))
            if best[0] <= NOTHING or spent > most_s:
                return at_equal or best, best, spent if best[0] <= NOTHING else None
        population, restart = 2 * search.popsize, restart + 1


def by_design(command, scene, seed):
    """Whether the limb is confirmed, its reserve, the limbs judged, and seconds."""
    text = subprocess.run(command + [scene, str(seed), str(seed)], check=True, capture_output=True, text=True).stdout
    found = re.search(r"confirmed (\w+) reserve ([\d.]+),.* (\d+) limbs in ([\d.]+) s and ([\d.]+) s", text)
    confirmed, reserve, limbs, search_s, confirm_s = found.groups()
    return confirmed == "true", float(reserve), int(limbs), float(search_s) + float(confirm_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=[f"scenes/open/loaded-group-{group}.toml" for group in "abc"], help="scenes (default: groups a, b, c)")
    parser.add_argument("--seeds", type=int, default=3, help="seeds of each scene (default 3)")
    parser.add_argument("--times", type=float, default=10.0, help="time of CMA-ES over that of the design (default 10)")
    parser.add_argument("--example", default=None, help="the example's program, where it is built already")
    arguments = parser.parse_args()
    command = [arguments.example] if arguments.example else "cargo run --release -q -p softlimb-design --example loaded_seeds --".split()
    print("| scene | seed | design: confirmed, time, limbs | reserve | CMA-ES: largest lack at equal time | time to none | limbs, largest lack at its end |")
    print("| --- | --: | --- | --: | --: | --: | --: |")
    for scene in arguments.scenes:
        for seed in range(1, arguments.seeds + 1):
            confirmed, reserve, limbs, seconds = by_design(command, scene, seed)
            objective = Objective(command, scene)
            equal, end, to_none = by_cma(objective, seed, seconds, arguments.times * seconds)
            objective.close()
            name = os.path.splitext(os.path.basename(scene))[0]
            none = f"{to_none:.0f} s" if to_none else f"> {arguments.times * seconds:.0f} s"
            own = f"{'yes' if confirmed else 'no'}, {seconds:.0f} s, {limbs}"
            print(f"| {name} | {seed} | {own} | {100 * reserve:.0f} % | {equal[1]:.3f} | {none} | {objective.evaluations}, {end[1]:.3f} |", flush=True)


if __name__ == "__main__":
    main()
