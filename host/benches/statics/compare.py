"""A limb under load by PyElastica beside softlimb: the same rods, the tips and the times side by side.

    python3 -m venv .venv && .venv/bin/pip install pyelastica
    .venv/bin/python host/benches/statics/compare.py [--quick]

`cargo run --release --example statics_rods` tells the rods, its tips and its times. PyElastica solves the same rods as it does everything:
in time, damped until they rest. Its error falls with the length of its elements; the truth that both are held against is a solution of
the elastica by scipy for the cantilever, and PyElastica's own tips carried on to elements of no length for the limb.

In PyElastica's favour: the damping is near the critical one, rotary inertia and stiff parts are made so heavy that they do not shorten
the time step (which moves no shape at rest), only steps are timed, not the making of the rod nor the compiling, and a run ends as soon as
the tip moves less than a thousandth of its error. Nothing else should be running.
"""

import json
import os
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(name, "1")
import elastica as ea
import numpy as np
from scipy.integrate import solve_bvp

WORKSPACE = Path(__file__).resolve().parents[3]
PROFILE = os.environ.get("SPEED_PROFILE", "release")
RIGID_N, RIGID_NM2 = 8e3, 5e2  # of rigid parts, against 1e3 N and 1 N m2 of tubes
CHECK = 250  # steps from one look at the tip to the next
REST = 1e-6  # of the length: the tip rests when it moves less than this in a fiftieth of a second, three times


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):
    pass


class Weights(ea.NoForces):
    """Dead forces on the nodes; they do not follow from the inertia, which is free."""

    def __init__(self, forces):
        super().__init__()
        self.forces = forces

    def apply_forces(self, system, time=0.0):
        system.external_forces += self.forces


def turned(matrix, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return turn @ matrix @ turn.T if matrix.ndim == 2 else turn @ matrix


def elements(told, count):
    """Lengths, stiffness against shear and stretch, compliance and free rates of the bends, of about `count` elements, what each shortens by
    where it slides (over the square of the slide), and the masses of nodes, kg."""
    whole = sum(piece["length_m"] * piece["free"][0] for piece in told["pieces"])
    lengths, forces, compliances, rates, sways, masses = [], [], [], [], [], [0.0]
    for piece in told["pieces"]:
        stretch, x, y, twist = piece["free"]
        stiffness, angle = np.array(piece["stiffness"]), piece["mount_angle_rad"]
        assert abs(stiffness - np.diag(np.diag(stiffness))).max() < 1e-9, "a bundle of equal pressures"
        length = piece["length_m"] * stretch
        own = max(round(count * length / whole), 2)
        # Rates and stiffness are per length at rest, those of PyElastica per length without load.
        shear, axial = piece["shear_n"] / stretch * stretch**2, stiffness[0, 0] * stretch
        bends = np.diag([stiffness[2, 2], stiffness[1, 1], stiffness[3, 3]]) * stretch
        for _ in range(own):
            lengths.append(length / own)
            forces.append([shear, shear, axial])
            compliances.append(turned(np.linalg.inv(bends), angle))
            rates.append(turned(np.array([-y, x, twist]) / stretch, angle))
            sways.append(piece["sway"])
            kg = piece["kg_per_m"] * piece["length_m"] / own
            masses[-1] += 0.5 * kg
            masses.append(0.5 * kg)
        if piece["rigid_m"] > 0.0:
            lengths.append(piece["rigid_m"])
            forces.append([RIGID_N] * 3)
            compliances.append(np.eye(3) / RIGID_NM2)
            rates.append(np.zeros(3))
            sways.append(0.0)
            masses.append(0.0)
            for distance, kg in piece["masses"]:
                share = distance / piece["rigid_m"]
                masses[-2] += (1.0 - share) * kg
                masses[-1] += share * kg
    return [np.array(values) for values in (lengths, forces, compliances, rates, sways, masses)]


def rest(told, count, damping):
    """The tip at rest by PyElastica with about `count` elements, seconds of stepping, and steps."""
    lengths, forces, compliances, rates, sways, masses = elements(told, count)
    normal, _, direction = (np.array(axis) for axis in told["axes"])
    start = np.array(told["origin_m"])
    position = start[:, None] + direction[:, None] * np.concatenate([[0.0], np.cumsum(lengths)])
    rod = ea.CosseratRod.straight_rod(
        len(lengths), start, direction, normal.copy(), lengths.sum(), 0.02, 1000.0, youngs_modulus=1e6, position=position
    )
    for axis in range(3):
        rod.shear_matrix[axis, axis] = forces[:, axis]
    # A place between two elements bends by half of each: compliances and free rates add up.
    half = 0.5 * lengths
    sums = (half[:-1] + half[1:])[:, None, None]
    between = (half[:-1, None, None] * compliances[:-1] + half[1:, None, None] * compliances[1:]) / sums
    bends = np.linalg.inv(between)
    rod.bend_matrix[:] = np.moveaxis(bends, 0, -1)
    rod.rest_kappa[:] = ((half[:-1, None] * rates[:-1] + half[1:, None] * rates[1:]) / sums[:, :, 0]).T
    # The time step that the soft elements' stretching allows at their own mass; all else is made heavy enough for it.
    hardest = forces.max(axis=1) / lengths
    soft = (forces != RIGID_N).any(axis=1)
    least = masses.sum() * lengths / lengths.sum()
    step = 0.7 * np.sqrt((least[soft] / hardest[soft]).min())
    at_nodes = np.maximum(np.append(hardest, 0.0), np.insert(hardest, 0, 0.0))
    rod.mass[:] = np.maximum(masses, 4.0 * at_nodes * (0.5 * step) ** 2)
    stiff = np.zeros(len(lengths))
    springs = np.abs(bends).max(axis=(1, 2)) / (2.0 * sums[:, 0, 0] * 0.5)
    stiff[:-1] += springs
    stiff[1:] += springs
    stiff += forces[:, :2].max(axis=1) * lengths
    inertia = np.maximum(1e-3 * lengths, 4.0 * stiff * (0.5 * step) ** 2)
    rod.mass_second_moment_of_inertia[:] = np.eye(3)[:, :, None] * inertia
    rod.inv_mass_second_moment_of_inertia[:] = np.eye(3)[:, :, None] / inertia

    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    weights = np.outer(told["gravity_m_per_s2"], masses)
    simulator.add_forcing_to(rod).using(Weights, weights)
    simulator.dampen(rod).using(ea.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=step)
    simulator.finalize()
    stepper = ea.PositionVerlet()
    now, steps, calm, seconds = np.float64(0.0), 0, 0, 0.0
    last, seen = rod.position_collection[:, -1].copy(), 0.0
    while calm < 3:
        begin = time.perf_counter()
        for _ in range(CHECK):
            now = stepper.step(simulator, now, step)
        # Compiling is in the first of them.
        seconds += (time.perf_counter() - begin) * (steps > 0)
        steps += CHECK
        soften(rod, forces, bends, sways)
        if now - seen > 0.02:
            tip = rod.position_collection[:, -1].copy()
            calm = calm + 1 if np.linalg.norm(tip - last) < REST * lengths.sum() else 0
            last, seen = tip, now
        if not np.isfinite(last).all() or now > 60.0:
            raise SystemExit(f"no rest with {count} elements at {now:.1f} s: {last}")
    return last, seconds * steps / (steps - CHECK), steps


def soften(rod, forces, bends, sways):
    """What PyElastica's constants are at this shape for springs that stay as they are.

    It has shear and stretch fall with the stretch and the bends with its cube, as of a solid that keeps its volume. And bundles that slide
    shorten: the force along them stiffens their shear, and their length follows the slide.
    """
    force = rod.internal_stress[2] / rod.dilatation
    for axis in range(3):
        slide = 2.0 * sways * force if axis < 2 else 0.0
        rod.shear_matrix[axis, axis] = (forces[:, axis] + slide) * rod.dilatation
    rod.rest_sigma[2] = -sways * (rod.sigma[0] ** 2 + rod.sigma[1] ** 2)
    rod.bend_matrix[:] = np.moveaxis(bends, 0, -1) * rod.voronoi_dilatation**3


def elastica(told):
    """The tip of a heavy level cantilever of one piece by collocation: angle, moment and place along its length."""
    piece = told["pieces"][0]
    length, axial, ei = piece["length_m"], piece["stiffness"][0][0], piece["stiffness"][1][1]
    weight = piece["kg_per_m"] * np.linalg.norm(told["gravity_m_per_s2"])

    def rates(s, y):
        """Of angle below the level, moment, level and upright place."""
        cos, sin = np.cos(y[0]), np.sin(y[0])
        along, across = weight * (length - s) * sin, weight * (length - s) * cos
        slide = across / (piece["shear_n"] + 2.0 * piece["sway"] * along)
        stretch = 1.0 + along / axial - piece["sway"] * slide**2
        x, z = stretch * cos - slide * sin, -stretch * sin - slide * cos
        return np.array([y[1] / ei, -weight * (length - s) * x, x, z])

    def ends(a, b):
        return np.array([a[0], b[1], a[2], a[3]])

    s = np.linspace(0.0, length, 100)
    found = solve_bvp(rates, ends, s, np.zeros((4, s.size)), tol=1e-9, max_nodes=100_000)
    assert found.success
    return np.array([found.y[2, -1], 0.0, found.y[3, -1]])


def compare(case, counts, damping):
    told = case["rod"]
    length = sum(piece["length_m"] + piece["rigid_m"] for piece in told["pieces"])
    runs = [(count, *rest(told, count, damping)) for count in counts]
    carried = runs[-1][1] + (runs[-1][1] - runs[-2][1]) * counts[-2] / (counts[-1] - counts[-2])
    truth = elastica(told) if case["name"] == "cantilever" else carried

    def off(tip):
        return 100.0 * np.linalg.norm(np.array(tip) - truth) / length

    print(f"\n{case['name']}, {length:.3f} m, moved {off(case['free_tip_m']):.1f} % of its length by its weight")
    print(f"  PyElastica carried on to elements of no length: {off(carried):.4f} % of the length from the truth")
    for count, tip, seconds, steps in runs:
        print(f"  PyElastica, {count:4} elements {seconds:10.2f} s, {steps:7} steps, tip off by {off(tip):7.4f} % of the length")
    for tier in case["tiers"]:
        error = off(tier["tip_m"])
        worse = [run for run in runs if off(run[1]) >= error]
        against, seconds = (worse[-1][0], worse[-1][2]) if worse else (counts[0], runs[0][2])
        cold, warm = (seconds / (tier[name] * 1e-6) for name in ("cold_us", "warm_us"))
        label = f"{tier['name']}, cold {tier['cold_us']:.0f} us, warm {tier['warm_us']:.0f} us"
        note = "no better" if worse else "BETTER"
        print(f"  {label:50} tip off by {error:7.4f} %; {cold:.1e} and {warm:.1e} times as fast as {against} elements, which are {note}")


def main():
    quick = "--quick" in sys.argv
    command = ["cargo", "run", "--quiet", "--profile", PROFILE, "-p", "softlimb", "--example", "statics_rods"]
    out = subprocess.run(command, cwd=WORKSPACE, check=True, capture_output=True, text=True).stdout
    cantilever, limb = json.loads(out)
    print(f"PyElastica {version('pyelastica')}")
    compare(cantilever, [20, 40] if quick else [20, 50, 100, 320], 12.0)
    compare(limb, [20, 40] if quick else [20, 50, 100, 200], 8.0)


if __name__ == "__main__":
    main()
