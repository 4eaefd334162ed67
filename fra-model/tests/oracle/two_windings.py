"""Writes two_windings.tsv, reference values of 30 digits of tubes with two windings. No packages needed; a few minutes.

    python3 two_windings.py             writes the file
    python3 two_windings.py --doubled   solves all cases with twice the digits and nodes, and fails if the file differs by 1e-30

The energies of the windings add up, so the loads of a state are those with the first winding and those with the second, less those of the
bare wall. Rounding of the inputs and `condition` as in hard_cases.py.
"""

import csv
import os
import sys
from decimal import Decimal as D, localcontext
from multiprocessing import Pool

from equilibrium import INPUTS, ROUGH, Tube, newton, precision
from hard_cases import DS30, RIGHT, DEG, condition, fiber, measure, nh, pressure_path, rounded
from path import fold

WINDING = ["angle", "mu2", "thickness", "winding"]
SECOND = [f"{name}_2" for name in WINDING]
COLUMNS = (
    "group case scalar kind motion inner outer length material c1 c2 c3 placement families angle mu2 thickness winding "
    "placement_2 families_2 angle_2 mu2_2 thickness_2 winding_2 "
    "pressure force torque target target_value first second third condition"
).split()


class TwoWindings(Tube):
    """`fiber` is a pair of (placement, families); inputs of the second winding end in _2."""

    names = INPUTS + SECOND

    def __init__(self, inputs, fiber):
        super().__init__(inputs, fiber[0])
        self.fiber, self.twists = fiber, True

    def loads(self, state, inputs=None):
        p = inputs or self.inputs
        of_second = {**p, **{name: p[f"{name}_2"] for name in WINDING}}
        first, second = Tube(p, self.fiber[0]).loads(state), Tube(of_second, self.fiber[1]).loads(state)
        return [a + b - bare for a, b, bare in zip(first, second, Tube(p, None).loads(state))]


CASES = []


def add(group, name, first, second, walls=(6, 8), length=100, material=nh(), p=20e3, force=0, torque=0, target=None):
    """As `case` of hard_cases.py, with two windings."""
    CASES.append(dict(locals()))


HELIX, AXIAL = fiber("sheet", 1, 30, 1e3), fiber("sheet", 1, 90, 1e3)
PAIRS = {
    "helix_axial": (HELIX, AXIAL),
    "helix_axial_inside": (HELIX, fiber("sheet", 1, 90, 1e3, 0.2, 0.25)),
    "helices_20_-50": (fiber("sheet", 1, 20, 1e3), fiber("sheet", 1, -50, 100)),
    "helices_mirrored_unequal": (fiber("sheet", 1, 15, 1e3), fiber("sheet", 1, -15, 200)),
    "hoop_helix_layer": (fiber("sheet", 1, 0, 1e3), fiber("layer", 1, 40, 50)),
    "two_families_and_axial": (fiber("sheet", 2, 25, 1e3), fiber("sheet", 1, 90, 10)),
    "smeared_helix_layer": (fiber("smeared", 1, 30, 5), fiber("layer", 1, -60, 20)),
    "stiff_helix_axial": (fiber("sheet", 1, 30, 1e5), fiber("sheet", 1, 90, 1e5)),
}

for name, (first, second) in PAIRS.items():
    for p in (0, 1e-3, 1, -1e-3):
        add("hardly_any_pressure", f"{name}_{p}", first, second, p=p)
    for p in (-1e3, -20e3):
        add("vacuum", f"{name}_{p:.0f}", first, second, p=p)
    for p in (20e3, 60e3):
        add("usual_pressures", f"{name}_{p:.0f}", first, second, p=p)
    add("yeoh", name, first, second, p=25e3, material=DS30)
for p in (200e3, 400e3, 800e3):
    add("saturation", f"helix_axial_{p:.0f}", HELIX, AXIAL, p=p)

LIMITS = {
    "soft_axials": (fiber("smeared", 1, 90, 1), fiber("sheet", 1, 90, 20)),
    "axial_and_soft_helix": (fiber("sheet", 1, 80, 10), fiber("sheet", 1, 90, 100)),
    "opposite_steep_helices": (fiber("smeared", 1, 75, 0.5), fiber("layer", 1, -80, 1)),
    "soft_helix_soft_hoop": (fiber("sheet", 1, 60, 0.3), fiber("sheet", 1, 0, 0.1)),
}
for name, (first, second) in LIMITS.items():
    for group, factor in (("just_below_the_limit", "0.999999"), ("just_above_the_limit", "1.000001"), ("far_above_the_limit", "3")):
        add(group, name, first, second, p=("limit", factor))
add("far_above_the_limit", "yeoh", *LIMITS["soft_axials"], p=("limit", "3"), material=DS30)
add("far_above_the_limit", "loaded", *LIMITS["opposite_steep_helices"], p=("limit", "3"), force=1.0, torque=5e-3)

for special in (0, 35.264389682754654, 54.735610317245346, 90):
    for off in (0, 1e-3, -1e-5):
        if special + off <= 90:
            add("special_angles", f"{special:.0f}_{off}_axial", fiber("sheet", 1, special + off, 1e3), fiber("sheet", 1, 90, 10))
            add("special_angles", f"{special:.0f}_{off}_helix", fiber("sheet", 1, special + off, 1e3), fiber("layer", 1, -30, 10))

for ratio in (1e5, 1e6):
    for name, (first, second) in {
        "sheet_28_axial": (("sheet", 1, 28), ("sheet", 1, 90)),
        "sheet_10_sheet_-40": (("sheet", 1, 10), ("sheet", 1, -40)),
        "sheet_50_hoop": (("sheet", 1, 50), ("sheet", 1, 0)),
        "layer_60_sheet_20": (("layer", 1, 60), ("sheet", 1, 20)),
        "stiff_and_soft": (("sheet", 1, 28), None),
    }.items():
        second = fiber(*second, ratio) if second else fiber("smeared", 1, -60, 0.1)
        add("stiff_fibers", f"{name}_{ratio:.0e}", fiber(*first, ratio), second, p=30e3)

for ratio in (0.01, 3):
    walls, p = (6, 6 * (1 + ratio)), 0.3 * 0.2e6 * min(ratio, 1)
    for name in ("helix_axial", "helices_20_-50", "smeared_helix_layer"):
        add("thin_and_thick_walls", f"{name}_{ratio}", *PAIRS[name], walls=walls, p=p)

add("large_rotations", "soft_helices", fiber("sheet", 1, 30, 10), fiber("sheet", 1, 50, 5), p=50e3, length=1000)
add("large_rotations", "turned", fiber("sheet", 1, 45, 5), fiber("sheet", 1, -60, 2), p=10e3, torque=0.2, length=500)
for force in (-2.0, 4.0):
    for torque in (-0.02, 0.0, 0.02):
        for name in ("helix_axial", "helices_20_-50", "hoop_helix_layer"):
            add("loads_of_both_signs", f"{name}_{force}_{torque}", *PAIRS[name], force=force, torque=torque)
# Helices that mirror each other turn by the torque alone, however small it is.
MIRRORED = (fiber("sheet", 1, 15, 1e3), fiber("sheet", 1, -15, 1e3))
for torque in (1e-6, 1e-20, -1e-25, 1e-31, -1e-34, 1e-36, 1e-60):
    add("tiny_torques", f"mirrored_{torque}", *MIRRORED, p=0, torque=torque)

for name, degrees, other, ratio in (
    ("equal", 30, 30, 1e3),
    ("by_angle", 30, 30 + 1e-7, 1e3),
    ("by_modulus", 30, 30, 1e3 * (1 + 1e-12)),
    ("mirrored", 20, -20, 1e3),
    ("mirrored_by_angle", 20, -20 - 1e-7, 1e3),
    ("mirrored_by_modulus", 20, -20, 1e3 * (1 + 1e-6)),
):
    for p in (1, 20e3):
        add("near_equal_families", f"{name}_{p:.0f}", fiber("sheet", 1, degrees, 1e3), fiber("sheet", 1, other, ratio), p=p)

for ratio in (0, 1e-12, 1e-30):
    for placement in ("sheet", "layer", "smeared"):
        soft = fiber(placement, 1, -50, ratio)
        add("hardly_any_modulus", f"{placement}_second_{ratio}", HELIX, soft, p=30e3)
        add("hardly_any_modulus", f"{placement}_first_{ratio}", soft, fiber("sheet", 2, 25, 1e3), p=30e3, torque=1e-3)
    add("hardly_any_modulus", f"both_{ratio}", fiber("sheet", 1, 30, ratio), fiber("layer", 1, 60, ratio), p=20e3)

for name, target in (
    ("helix_axial", "twist"),
    ("helix_axial", "outer_radius"),
    ("helices_20_-50", "stretch"),
    ("hoop_helix_layer", "stretch"),
    ("two_families_and_axial", "stretch"),
    ("smeared_helix_layer", "outer_radius"),
    ("stiff_helix_axial", "outer_radius"),
):
    for p in (1, 15e3):
        add("inverse", f"{name}_{target}_{p:.0f}", *PAIRS[name], p=p, target=target)


def inputs_of(c, scalar):
    material, walls = c["material"], c["walls"]
    r = lambda v: rounded(v, scalar)
    out = {"inner": r(walls[0] * 1e-3), "outer": r(walls[1] * 1e-3), "length": r(c["length"] * 1e-3)}
    mu1 = float(material[1]) if material[0] == "nh" else 2 * material[1]
    out.update(c1=r(mu1) / 2, c2=D(0), c3=D(0)) if material[0] == "nh" else out.update({f"c{i}": r(material[i]) for i in (1, 2, 3)})
    for wind, end in ((c["first"], ""), (c["second"], "_2")):
        angle = RIGHT if wind[2] == 90 else wind[2] * DEG
        radius = walls[0] + (walls[1] - walls[0]) * wind[5]
        values = r(angle), r(wind[3] * mu1), r(wind[4] * 1e-3), out["outer"] if wind[5] == 1 else r(radius * 1e-3)
        out.update({f"{name}{end}": value for name, value in zip(WINDING, values)})
    out.update(pressure=D(0), force=r(c["force"]), torque=r(c["torque"]))
    return out


def row(c, scalar, inputs, kind, values, size, target=("-", D(0))):
    out = {**inputs, "group": c["group"], "case": c["name"], "scalar": scalar, "kind": kind, "motion": "twisting"}
    out.update(material=c["material"][0], target=target[0], target_value=target[1], condition=size)
    for wind, end in ((c["first"], ""), (c["second"], "_2")):
        out.update({f"placement{end}": wind[0], f"families{end}": wind[1]})
    out.update(zip(("first", "second", "third"), values + [D(0)] * 3))
    answers = ("first", "second", "third")
    text = lambda k, v: f"{v:.33e}" if k in answers else f"{v:.4e}" if k == "condition" else repr(float(v)) if isinstance(v, D) else str(v)
    return "\t".join(text(k, out[k]) for k in COLUMNS)


def limit_row(c, scalar, inputs, tube, path):
    """The pressure of the first limit point, whose condition weighs the equations by the path's tangent."""
    x, tangent = path.points[-1]
    x = fold(tube, x)
    direction = [t * s for t, s in zip(tangent, path.scales(x))]
    moved = tube.by_inputs(x[:3])
    total = sum(abs(sum(a * b for a, b in zip(change, direction)) / direction[1]) for change in moved.values())
    return row(c, scalar, inputs, "limit", [x[3]], max(D(1), total / abs(x[3])))


def inverse_row(c, scalar, inputs, tube, state, path):
    """The pressure for a target, whose value is that of the forward solution, rounded. It is one Newton step from there."""
    kind = c["target"]
    target = rounded(measure(kind, inputs, state), scalar)
    along = [measure(kind, inputs, x[:3]) for x, _ in path.points]
    assert len({b > a for a, b in zip(along, along[1:])}) == 1, "the target is not monotone"
    h = D(10) ** -20
    pressure = inputs["pressure"]

    def reached(changed, at):
        moved = TwoWindings({**inputs, **changed, "pressure": at}, tube.fiber)
        return measure(kind, moved.inputs, newton(moved.matrix, state))

    for _ in range(3):
        value = reached({}, pressure)
        slope = (reached({}, pressure * (1 + h)) - value) / (pressure * h)
        pressure += (target - value) / slope
    names = [name for name in TwoWindings.names + ["length"] if inputs[name] != 0 and name != "pressure"]
    effects = [(reached({name: inputs[name] * (1 + h)}, pressure) - target) / h for name in names] + [target]
    size = sum(abs(effect / slope) for effect in effects) / abs(pressure)
    return row(c, scalar, {**inputs, "pressure": D(0)}, "inverse", [pressure], max(D(1), size), (kind, target))


def run(job):
    c, scalar = job
    try:
        inputs = inputs_of(c, scalar)
        tube = TwoWindings(inputs, (c["first"][:2], c["second"][:2]))
        wanted = None if isinstance(c["p"], tuple) else rounded(c["p"], scalar)
        with localcontext() as context:
            context.prec = ROUGH
            go_on = (lambda x: True) if wanted is None else (lambda x: abs(x[3]) < abs(wanted))
            path = pressure_path(tube, go_on, wanted is None or wanted > 0)
        if wanted is None:
            assert path.end == "fold", path.end
            factor = D(c["p"][1])
            wanted = inputs["pressure"] = rounded(path.points[-1][0][3] * factor, scalar)
            if factor > 1:
                return [limit_row(c, scalar, inputs, tube, path)]
        else:
            assert path.end == "reached", path.end
        inputs["pressure"] = wanted
        with localcontext() as context:
            context.prec = ROUGH
            guess = path.near(wanted) if wanted != 0 else path.points[0][0][:3]
        tube = TwoWindings(inputs, tube.fiber)
        at_rest = wanted == 0 and not any(guess)
        state = [D(0)] * 3 if at_rest else newton(tube.matrix, guess)
        rows = [row(c, scalar, inputs, "forward", state, condition(tube, state))]
        return rows + ([inverse_row(c, scalar, inputs, tube, state, path)] if c["target"] else [])
    except (ArithmeticError, AssertionError) as error:
        return f"{c['group']}/{c['name']}/{scalar}: {error!r}"


def compare(lines, path):
    """Fails unless the answers are those of the file within 1e-30 of the largest of each row."""
    with open(path) as file:
        written = list(csv.DictReader(file, delimiter="\t"))
    found = [dict(zip(COLUMNS, line.split("\t"))) for line in lines]
    assert len(written) == len(found), (len(written), len(found))
    worst = D(0)
    for old, new in zip(written, found):
        assert all(old[k] == new[k] for k in COLUMNS if k not in ("first", "second", "third", "condition")), (old, new)
        values = [[D(row[k]) for k in ("first", "second", "third")] for row in (old, new)]
        size = max(map(abs, values[1]))
        off = max(abs(a - b) for a, b in zip(*values))
        worst = max(worst, off / size if size else off)
    print(f"{len(found)} rows, answers within {worst:.1e}")
    assert worst < D("1e-30"), worst


def main():
    doubled = "--doubled" in sys.argv
    # A tiny torque's twist is small beside one by as many digits as its answer lacks.
    precision(*((200, 72) if doubled else (100, 36)))
    jobs = [(c, scalar) for c in CASES for scalar in ("f64", "f32")]
    with Pool() as pool:
        results = list(pool.imap(run, jobs, chunksize=1))
    failures = [r for r in results if isinstance(r, str)]
    if failures:
        raise SystemExit("\n".join(failures))
    lines = [line for rows in results for line in rows]
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "two_windings.tsv")
    if doubled:
        return compare(lines, path)
    with open(path, "w") as out:
        out.write("\t".join(COLUMNS) + "\n")
        out.writelines(line + "\n" for line in lines)


if __name__ == "__main__":
    main()
