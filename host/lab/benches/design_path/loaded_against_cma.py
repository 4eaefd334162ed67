#!/usr/bin/env python3
"""CMA-ES on the design of a limb under load: `cargo xtask lab design --loaded SCENE --cma PYTHON` runs it.

    loaded_against_cma.py LABORATORY SCENE SEED EQUAL_S MOST_S RAISE

Needs the package cma (pip install cma). The laboratory judges limbs by the statics of the search: this script asks it for sums of squares of lacks, a
population at a time, in two threads. Times are processor times of the judge alone. CMA-ES starts at the search's first guess with a step of 0.2,
restarts with twice the population (IPOP) when it stops early, and stays within the box by cma's own transformation. Tubes between plates confirm a limb
that lacks nothing by rods, as those of the search; the reserve of all margins rises by RAISE as often as nothing is lacking.
Printed: seconds to every margin by rods, seconds to a confirmed limb, and the largest reserve of a confirmed limb after EQUAL_S; `none` for what was not
found.
"""

import os
import subprocess
import sys

# One thread: the matrices are small, and threads that wait for each other take longer.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import cma  # noqa: E402

# The sum of squares of lacks that counts as none; the same as the search's.
NOTHING = 1e-5


class Judge:
    """The laboratory, judging limbs of one scene."""

    def __init__(self, laboratory, scene):
        command = [laboratory, "design", "--loaded", scene, "--judge"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.guess = [float(word) for word in self.process.stdout.readline().split()]
        self.seconds = 0.0

    def say(self, text):
        self.process.stdin.write(text)
        self.process.stdin.flush()

    def many(self, points):
        """Sum of squares of lacks and largest lack of several points."""
        self.say("".join(" ".join(map(repr, map(float, point))) + "\n" for point in points) + "\n")
        answers = [tuple(map(float, self.process.stdout.readline().split())) for _ in points]
        self.seconds = float(self.process.stdout.readline())
        return answers

    def confirms(self, point):
        self.say("confirm " + " ".join(map(repr, map(float, point))) + "\n")
        kept, self.seconds = map(float, self.process.stdout.readline().split())
        return kept == 1.0

    def reserve(self, reserve):
        self.say(f"reserve {reserve!r}\n")


def main():
    laboratory, scene = sys.argv[1:3]
    seed, equal_s, most_s, rise = int(sys.argv[3]), *map(float, sys.argv[4:7])
    judge = Judge(laboratory, scene)
    by_rods = by_tubes = None
    kept, reserve, at_equal = None, 0.0, None
    population, restart, done = None, 0, False
    while not done:
        options = {"bounds": [0.0, 1.0], "seed": 1 + 1000 * seed + restart, "verbose": -9}
        if population:
            options["popsize"] = population
        search = cma.CMAEvolutionStrategy(judge.guess, 0.2, options)
        while not search.stop() and not done:
            points = search.ask()
            answers = judge.many(points)
            # A limb that does not stand is worse than any that does.
            values = [value if value < 1e6 else 1e6 for value, _ in answers]
            best = min(range(len(points)), key=values.__getitem__)
            if at_equal is None and judge.seconds > equal_s:
                at_equal = kept
            search.tell(points, values)
            if values[best] <= NOTHING:
                by_rods = by_rods or judge.seconds
                if judge.confirms(points[best]):
                    kept, by_tubes = reserve, by_tubes or judge.seconds
                reserve += rise
                judge.reserve(reserve)
            done = judge.seconds > most_s or (judge.seconds > equal_s and by_rods is not None and by_tubes is not None)
        population, restart = 2 * search.popsize, restart + 1
    if judge.seconds <= equal_s or (at_equal is None and by_rods is not None and by_rods <= equal_s):
        at_equal = kept
    number = lambda value: f"{value:.6g}" if value is not None else "none"
    print(number(by_rods), number(by_tubes), number(at_equal))


if __name__ == "__main__":
    main()
