"""Limbs under load by PyElastica beside softlimb: the same rods, the tips and the times side by side, at equal error.

    python3 -m venv .venv && .venv/bin/pip install pyelastica
    .venv/bin/python host/lab/benches/statics/compare.py [--quick]

`cargo run --release -p softlimb-lab --example statics_rods` tells the rods, its tips and its times. The truth is a solution of the same rods by collocation
(scipy), which shares no code with either. PyElastica solves them as it does everything: in time, damped until they rest. For each tier it is
given as many elements as bring it to that tier's error, and no more.

Twice: as it comes, when its error falls with the length of its elements, since the element that is clamped does not bend; and with the first
place of bending made to yield for the whole of that element, when it falls with about their square.

In PyElastica's favour: the damping is near the critical one, rotary inertia and stiff parts are made so heavy that they do not shorten
the time step (which moves no shape at rest), only steps are timed, by the processor's time, not the making of the rod nor the compiling, and a
run ends as soon as the tip hardly moves beside its error. Nothing else should be running.
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
from scipy.spatial.transform import Rotation

WORKSPACE = Path(__file__).resolve().parents[4]
PROFILE = os.environ.get("SPEED_PROFILE", "release")
RIGID_N = 8e3  # of rigid parts, against 1e3 N of tubes; what they yield is taken back (`stiffen`), and they bend not at all
CHECK = 100  # most steps from one look at the rod to the next
PART = 0.1  # of the way that constants go at a look
LAST_S = 12.0  # when what does not rest is given up
FIRST, LEAST = 50, 20  # elements from which is told how many are needed, and the fewest
LONGEST_S = 900.0  # of a run; what would take longer is carried on from a shorter one, and marked
REST = 0.003  # of the error looked for: the tip rests when it moves less than this in a fiftieth of a second, three times


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
            compliances.append(np.zeros((3, 3)))
            rates.append(np.zeros(3))
            sways.append(0.0)
            masses.append(0.0)
            for distance, kg in piece["masses"]:
                share = distance / piece["rigid_m"]
                masses[-2] += (1.0 - share) * kg
                masses[-1] += share * kg
    return [np.array(values) for values in (lengths, forces, compliances, rates, sways, masses)]


def rest(told, count, mended, error, share, damping):
    """The tip at rest by PyElastica with about `count` elements, seconds of stepping, and steps; `None` where it does not come to rest.
    `share` is that of the stable time step of a chain of springs, `mended` that the clamped element's bend is made up for."""
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
    if mended:
        half[0] = lengths[0]
    between = (half[:-1, None, None] * compliances[:-1] + half[1:, None, None] * compliances[1:]) / sums
    bends = np.linalg.inv(between)
    rod.bend_matrix[:] = np.moveaxis(bends, 0, -1)
    rod.rest_kappa[:] = ((half[:-1, None] * rates[:-1] + half[1:, None] * rates[1:]) / sums[:, :, 0]).T
    # The time step that the soft elements' stretching allows at their own mass; all else is made heavy enough for it.
    hardest = forces.max(axis=1) / lengths
    rigid = (forces == RIGID_N).all(axis=1)
    soft = ~rigid
    least = masses.sum() * lengths / lengths.sum()
    step = share * np.sqrt((least[soft] / hardest[soft]).min())
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
    beyond = np.cumsum(weights[:, ::-1], axis=1)[:, -2::-1]
    simulator.add_forcing_to(rod).using(Weights, weights)
    simulator.dampen(rod).using(ea.AnalyticalLinearDamper, uniform_damping_constant=damping, time_step=step)
    simulator.finalize()
    stepper = ea.PositionVerlet()
    now, steps, calm, seconds = np.float64(0.0), 0, 0, 0.0
    last, seen = rod.position_collection[:, -1].copy(), 0.0
    check = min(max(count // 2, 10), CHECK)
    while calm < 3:
        begin = time.process_time()
        for _ in range(check):
            now = stepper.step(simulator, now, step)
        # Compiling is in the first of them.
        seconds += (time.process_time() - begin) * (steps > 0)
        steps += check
        soften(rod, forces, bends, sways)
        stiffen(rod, rigid, beyond)
        if now - seen > 0.02:
            tip = rod.position_collection[:, -1].copy()
            calm = calm + 1 if np.linalg.norm(tip - last) < REST * error * lengths.sum() else 0
            last, seen = tip, now
        if not np.isfinite(last).all() or now > LAST_S:
            return None
    return last, seconds * steps / (steps - check), steps


def soften(rod, forces, bends, sways):
    """What PyElastica's constants are at this shape for springs that stay as they are.

    It has shear and stretch fall with the stretch and the bends with its cube, as of a solid that keeps its volume. And bundles that slide
    shorten: the force along them stiffens their shear, and their length follows the slide.
    """
    force = rod.internal_stress[2] / rod.dilatation
    for axis in range(3):
        slide = 2.0 * sways * force if axis < 2 else 0.0
        nearer(rod.shear_matrix[axis, axis], (forces[:, axis] + slide) * rod.dilatation)
    nearer(rod.rest_sigma[2], -sways * (rod.sigma[0] ** 2 + rod.sigma[1] ** 2))
    nearer(rod.bend_matrix, np.moveaxis(bends, 0, -1) * rod.voronoi_dilatation**3)


def nearer(value, goal):
    """Part of the way, so that a vibration of which only single moments are seen is not kept up."""
    value += PART * (goal - value)


def stiffen(rod, rigid, beyond):
    """Rigid parts that are as long and as straight under the weight beyond them as they are without."""
    force = np.einsum("ijk,jk->ik", rod.director_collection, beyond)
    rod.rest_sigma[:, rigid] = -force[:, rigid] / RIGID_N


def cross(a, b):
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rotated(q, v, back=False):
    """Vectors by unit quaternions, or back."""
    u = -q[1:] if back else q[1:]
    twice = 2.0 * cross(u, v)
    return v + q[:1] * twice + cross(u, twice)


def about_axis(v, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]])


def collocation(told):
    """The tip by collocation of the Cosserat equations, all pieces side by side with rigid parts between them. Weights are dead, so that the
    force in each section is known; place, quaternion and moment are sought, from the shape without load on while the load grows."""
    pieces, base = told["pieces"], np.array(told["axes"]).T
    start = np.concatenate([told["origin_m"], Rotation.from_matrix(base).as_quat(scalar_first=True)])
    beyond, kg = [], 0.0
    for piece in reversed(pieces):
        kg += sum(mass for _, mass in piece["masses"])
        beyond.insert(0, kg)
        kg += piece["kg_per_m"] * piece["length_m"]

    def bends(piece, strain):
        """Strains to rates of turn in the frame that mounts the piece."""
        _, x, y, twist = piece["free"]
        return about_axis(np.stack([-(y + strain[2]), x + strain[1], twist + strain[3]]), piece["mount_angle_rad"])

    def solve(g, s, guess):
        def rates(s, y):
            out = []
            for i, piece in enumerate(pieces):
                q, moment = y[10 * i + 3 : 10 * i + 7], y[10 * i + 7 : 10 * i + 10]
                length, angle, stretch = piece["length_m"], piece["mount_angle_rad"], piece["free"][0]
                force = g[:, None] * (beyond[i] + piece["kg_per_m"] * length * (1.0 - s))
                f, m = (about_axis(rotated(q, v, True), -angle) for v in (force, moment))
                strain = np.linalg.solve(np.array(piece["stiffness"]), np.stack([f[2], m[1], -m[0], m[2]]))
                slide = f[:2] / (piece["shear_n"] + 2.0 * piece["sway"] * f[2] / stretch)
                along = stretch + strain[0] - piece["sway"] * (slide**2).sum(axis=0) / stretch
                tangent = rotated(q, about_axis(np.stack([*slide, along]), angle))
                turn = bends(piece, strain)
                spin = np.concatenate([[-(q[1:] * turn).sum(axis=0)], q[:1] * turn + cross(q[1:], turn)])
                out += [length * tangent, 0.5 * length * spin, -length * cross(tangent, force)]
            return np.concatenate(out)

        def ends(a, b):
            out = [a[:7] - start]
            for i, piece in enumerate(pieces):
                here, there = b[10 * i : 10 * i + 10], a[10 * i + 10 : 10 * i + 20]
                axis = rotated(here[3:7, None], np.array([[0.0], [0.0], [1.0]]))[:, 0]
                after = beyond[i] - sum(mass for _, mass in piece["masses"])
                lever = after * piece["rigid_m"] + sum(distance * mass for distance, mass in piece["masses"])
                left = here[7:] - np.cross(axis * lever, g)
                out += [here[:3] + axis * piece["rigid_m"] - there[:3], here[3:7] - there[3:7], left - there[7:]] if there.size else [left]
            return np.concatenate(out)

        found = solve_bvp(rates, ends, s, guess, tol=1e-8, max_nodes=20_000)
        assert found.success, found.message
        return found.x, found.y

    s = np.linspace(0.0, 1.0, 15)
    y, q = np.zeros((10 * len(pieces), s.size)), Rotation.from_matrix(base)
    for i, piece in enumerate(pieces):
        turn = bends(piece, np.zeros(4)) * piece["length_m"]
        y[10 * i + 3 : 10 * i + 7] = np.array([(q * Rotation.from_rotvec(turn * t)).as_quat(scalar_first=True) for t in s]).T
        q = q * Rotation.from_rotvec(turn)
    for share in np.linspace(0.0, 1.0, 7):
        s, y = solve(np.array(told["gravity_m_per_s2"]) * share, s, y)
    axis = rotated(y[-7:-3, -1:], np.array([[0.0], [0.0], [1.0]]))[:, 0]
    return y[-10:-7, -1] + axis * pieces[-1]["rigid_m"]


def compare(case, tries, quick):
    told = case["rod"]
    length = sum(piece["length_m"] + piece["rigid_m"] for piece in told["pieces"])
    truth = collocation(told)

    def off(tip):
        return np.linalg.norm(np.array(tip) - truth) / length

    def run(count, mended, error):
        """Elements, error, seconds and steps of the first of the tries that comes to rest."""
        for share, damping in tries:
            if found := rest(told, count, mended, error, share, damping):
                return count, off(found[0]), found[1], found[2]
        raise SystemExit(f"no rest with {count} elements")

    print(f"\n{case['name']}, {length:.3f} m, moved {100.0 * off(case['free_tip_m']):.1f} % of its length by its weight")
    for tier in case["tiers"]:
        tier["error"] = off(tier["tip_m"])
        print(f"  {tier['name']:20} tip off by {100.0 * tier['error']:.4f} %, cold {tier['cold_us']:.0f} us, warm {tier['warm_us']:.0f} us")
    for mended in (False, True):
        print("  PyElastica, its clamp mended" if mended else "  PyElastica as it comes")
        rough = last = run(FIRST, mended, 1e-3)
        for tier in case["tiers"][: 1 if quick else None]:
            # No better than the tier, by a little; very few elements do not come to rest.
            count = max(int(0.94 * FIRST * (rough[1] / tier["error"]) ** (0.5 if mended else 1.0)), LEAST)
            about = last[2] * (count / last[0]) ** 2
            if about < LONGEST_S:
                last = count, error, seconds, steps = run(count, mended, tier["error"])
                note = f"tip off by {100.0 * error:.4f} %, {seconds:.2f} s, {steps} steps"
            else:
                seconds, note = about, f"NOT RUN; {about:.0f} s carried on from {last[0]} elements"
            cold, warm = (seconds / (tier[name] * 1e-6) for name in ("cold_us", "warm_us"))
            print(f"    {count:5} elements, {note}: {cold:.1e} and {warm:.1e} times {tier['name']}, cold and warm", flush=True)


def main():
    quick = "--quick" in sys.argv
    command = ["cargo", "run", "--quiet", "--profile", PROFILE, "-p", "softlimb-lab", "--example", "statics_rods"]
    out = subprocess.run(command, cwd=WORKSPACE, check=True, capture_output=True, text=True).stdout
    print(f"PyElastica {version('pyelastica')}")
    # Of time step and damping those first that rest soonest; they do not for every number of elements.
    tries = {
        "cantilever": [(0.8, 12.0), (0.7, 12.0), (0.6, 15.0)],
        "hanging limb": [(0.9, 7.0), (0.75, 8.0), (0.6, 9.0), (0.6, 13.0)],
        "level limb": [(0.6, 9.0), (0.75, 13.0), (0.6, 13.0)],
    }
    for case in json.loads(out):
        compare(case, tries[case["name"]], quick)


if __name__ == "__main__":
    main()
