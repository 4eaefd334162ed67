"""Writes hard_cases.tsv, the reference values of the test of the same name. No packages needed; a few minutes.

    python3 hard_cases.py                 all groups
    python3 hard_cases.py bending vacuum  these groups; the rows of the others stay

Every case is solved twice, with its inputs rounded to f64 and to f32, so that the rounding of the inputs is nobody's error. `condition` is
the sum over the inputs p of |p| max|d answer/dp| / max|answer|, at least one.
"""

import os
import struct
import sys
from decimal import Decimal as D, localcontext
from multiprocessing import Pool

import bend as section
from equilibrium import ROUGH, Tube, newton, solve
from path import Path

COLUMNS = (
    "group case scalar kind motion inner outer length material c1 c2 c3 placement families angle mu2 thickness winding "
    "pressure force torque target target_value first second third condition"
).split()
ZERO = [D(0)] * 3


def rounded(value, scalar):
    value = float(value)
    return D(struct.unpack("f", struct.pack("f", value))[0] if scalar == "f32" else value)


def nh(mu=0.2e6):
    return ("nh", mu)


DS30 = ("yeoh", 86.56e3, 13.805e3, -1.4661e3)
STIFFENING = ("yeoh", 15.36e4, 0.16e4, 0.02e4)
RIGHT = 1.5707963267948966
DEG = RIGHT / 90


def case(group, name, kind="forward", walls=(6, 8), length=100, material=nh(), fiber=None, p=0, force=0, torque=0, target=None):
    """`walls` and `length` in mm; `fiber`: placement, families, degrees, mu2/mu1, thickness/mm, winding share of the wall.

    `p`: Pa, or ("limit", factor) of the pressure of the first limit point on the side of the factor's sign.
    """
    return dict(locals())


def fiber(placement, families, degrees, ratio, thickness=0.2, at=None):
    at = {"sheet": 1.0, "layer": 0.8, "smeared": 1.0}[placement] if at is None else at
    return (placement, families, degrees, ratio, thickness, at)


def inputs_of(c, scalar):
    material, walls, wind = c["material"], c["walls"], c["fiber"]
    r = lambda v: rounded(v, scalar)
    out = {"inner": r(walls[0] * 1e-3), "outer": r(walls[1] * 1e-3), "length": r(c["length"] * 1e-3)}
    if material[0] == "nh":
        mu = r(material[1])
        out.update(c1=mu / 2, c2=D(0), c3=D(0))
    else:
        out.update({f"c{i}": r(material[i]) for i in (1, 2, 3)})
    out.update(angle=D(0), mu2=D(0), thickness=D(0), winding=out["outer"])
    if wind is not None:
        radius = walls[0] + (walls[1] - walls[0]) * wind[5]
        angle = RIGHT if wind[2] == 90 else wind[2] * DEG
        mu1 = float(material[1]) if material[0] == "nh" else 2 * material[1]
        out.update(angle=r(angle), mu2=r(wind[3] * mu1), thickness=r(wind[4] * 1e-3))
        out["winding"] = out["outer"] if wind[5] == 1 else r(radius * 1e-3)
    out.update(pressure=D(0), force=r(c["force"]), torque=r(c["torque"]))
    return out


def rest_under_load(tube):
    if tube.inputs["force"] == 0 and tube.inputs["torque"] == 0:
        return ZERO
    free = type(tube)({**tube.inputs, "force": D(0), "torque": D(0)}, tube.fiber)
    free.twists = tube.twists
    path = Path(free, ZERO, D(0), tube.applied(), D(1), True, lambda x: x[3] < 1)
    assert path.end == "reached", path.end
    return path.near(D(1))


def pressure_path(tube, go_on, up=True):
    unit = 10 * tube.inputs["c1"]
    start = rest_under_load(tube)
    base = type(tube)(tube.inputs, tube.fiber)
    return Path(base, start, D(0), [D(0), D(1), D(0)], unit, up, go_on)


def row(c, scalar, inputs, kind, values, condition, target=("-", D(0))):
    wind = c["fiber"]
    motion = "bending" if kind.startswith("bend") else "twisting" if wind and wind[1] == 1 else "extension"
    out = {**c, **inputs, "scalar": scalar, "kind": kind, "motion": motion, "material": c["material"][0], "case": c["name"]}
    out.update(placement=wind[0] if wind else "-", families=wind[1] if wind else 0)
    out.update(target=target[0], target_value=target[1], condition=condition)
    out.update(zip(("first", "second", "third"), values + [D(0)] * 3))
    digits = lambda v: f"{v:.25e}" if isinstance(v, D) else str(v)
    exact = set("inner outer length c1 c2 c3 angle mu2 thickness winding pressure force torque target_value".split())
    text = lambda k: repr(float(out[k])) if k in exact else f"{out[k]:.4e}" if k == "condition" else digits(out[k])
    return "\t".join(text(k) for k in COLUMNS)


def condition(tube, state):
    _, matrix = tube.matrix(state)
    size = max(map(abs, state))
    total = sum(max(map(abs, solve(matrix, change))) for change in tube.by_inputs(state).values())
    return max(D(1), total / size) if size else D(1)


def limit(c, scalar, inputs, factor):
    """Pressure of the first limit point, its condition and the inputs with that pressure times the factor."""
    tube = Tube(inputs, c["fiber"] and c["fiber"][:2])
    with localcontext() as context:
        context.prec = ROUGH
        path = pressure_path(tube, lambda x: True, factor > 0)
    assert path.end == "fold", (c["name"], path.end)
    x, tangent = path.points[-1]
    direction = [t * s for t, s in zip(tangent, path.scales(x))]
    moved = tube.by_inputs(x[:3])
    total = sum(abs(sum(a * b for a, b in zip(change, direction)) / direction[1]) for change in moved.values())
    return tube, path, x[3], max(D(1), total / abs(x[3]))


def straight(c, scalar):
    inputs = inputs_of(c, scalar)
    rows = []
    if isinstance(c["p"], tuple):
        factor = D(str(c["p"][1]))
        tube, path, end, limit_condition = limit(c, scalar, inputs, factor)
        inputs["pressure"] = rounded(end * abs(factor), scalar)
        if abs(factor) > 1:
            return [row(c, scalar, inputs, "limit", [end], limit_condition)]
        tube.inputs["pressure"] = D(0)
    else:
        inputs["pressure"] = rounded(c["p"], scalar)
        tube = Tube({**inputs, "pressure": D(0)}, c["fiber"] and c["fiber"][:2])
        with localcontext() as context:
            context.prec = ROUGH
            wanted = inputs["pressure"]
            path = pressure_path(tube, lambda x: abs(x[3]) < abs(wanted), wanted > 0)
        assert path.end == "reached", (c["name"], path.end, path.points[-1])
    with localcontext() as context:
        context.prec = ROUGH
        wanted = inputs["pressure"]
        guess = path.near(wanted) if wanted != 0 else path.points[0][0][:3]
    tube = Tube(inputs, tube.fiber)
    state = newton(tube.matrix, guess) if any(guess) or wanted != 0 else ZERO
    rows.append(row(c, scalar, inputs, "forward", state, condition(tube, state)))
    if c["target"]:
        rows.append(inverse(c, scalar, inputs, tube, state, path))
    return rows


def measure(kind, inputs, state):
    e, w, g = state
    if kind == "stretch":
        return 1 + e
    if kind == "twist":
        return g * inputs["length"] / inputs["inner"]
    radius = inputs["inner" if kind == "inner_radius" else "outer"]
    x = (radius / inputs["inner"]) ** 2
    return radius * ((x + w) / (x * (1 + e))).sqrt()


def inverse(c, scalar, inputs, tube, state, path):
    """The pressure for a target, whose value is that of the forward solution, rounded."""
    kind = c["target"]
    target = rounded(measure(kind, inputs, state), scalar)
    along = [measure(kind, inputs, x[:3]) for x, _ in path.points]
    signs = {b > a for a, b in zip(along, along[1:])}
    assert len(signs) == 1, f"{c['name']}: the target is not monotone"

    def equations(x):
        tube.inputs["pressure"] = x[3]
        rest, rows = tube.matrix(x[:3])
        h = D(10) ** -25
        base = measure(kind, tube.inputs, x[:3])
        last = [(measure(kind, tube.inputs, [v + (h if i == j else 0) for i, v in enumerate(x[:3])]) - base) / h for j in range(3)]
        return rest + [base - target], [r + [-D(i == 1)] for i, r in enumerate(rows)] + [last + [D(0)]]

    x = newton(lambda x: scaled(equations, x, inputs["c1"]), state + [inputs["pressure"] / inputs["c1"]])
    x[3] *= inputs["c1"]
    rest, matrix = equations(x)
    moved = {k: v + [D(0)] for k, v in tube.by_inputs(x[:3]).items() if k != "pressure"}
    h = D(10) ** -25
    for name in ("inner", "outer", "length"):
        other = {**tube.inputs, name: tube.inputs[name] * (1 + h)}
        moved.setdefault(name, [D(0)] * 4)[3] = (measure(kind, other, x[:3]) - measure(kind, tube.inputs, x[:3])) / h
    moved["target"] = [D(0)] * 3 + [-target]
    total = sum(abs(solve(matrix, change)[3]) for change in moved.values())
    out = {**inputs, "pressure": D(0)}
    return row(c, scalar, out, "inverse", [x[3]], max(D(1), total / abs(x[3])), (kind, target))


def scaled(equations, x, unit):
    """The equations with the pressure in that unit, so that all unknowns are of one size."""
    rest, rows = equations(x[:3] + [x[3] * unit])
    return rest, [r[:3] + [r[3] * unit] for r in rows]


def bending(c, scalar):
    inputs = inputs_of(c, scalar)
    if c["fiber"] is None:
        inputs["winding"] = inputs["outer"]
    # The case states an angle in degrees; the forward problem gets its pressure, rounded.
    angle = rounded(c["p"] * DEG, scalar)
    held = section.pressure(inputs, angle)
    by_input, by_angle = section.slopes(inputs, angle)
    total = sum(map(abs, by_input.values())) + abs(by_angle)
    back = row(c, scalar, {**inputs, "pressure": D(0)}, "bend_inverse", [held], max(D(1), total / abs(held)), ("bend", angle))
    inputs["pressure"] = rounded(held, scalar)
    # That pressure is within a rounding of the one held: to second order nothing is left.
    found = angle * (1 + (inputs["pressure"] - held) / by_angle)
    total = (sum(map(abs, by_input.values())) + abs(held)) / abs(by_angle)
    return [row(c, scalar, inputs, "bend", [found], max(D(1), total)), back]


def run(job):
    c, scalar = job
    try:
        return bending(c, scalar) if c["kind"] == "bend" else straight(c, scalar)
    except (ArithmeticError, AssertionError) as error:
        return f"{c['group']}/{c['name']}/{scalar}: {error!r}"


def main():
    from hard_case_list import CASES

    wanted = set(sys.argv[1:])
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "hard_cases.tsv")
    known = {}
    if wanted:
        with open(path) as table:
            for line in list(table)[1:]:
                known.setdefault(line.split("\t")[0], []).append(line)
    jobs = [(c, scalar) for c in CASES for scalar in ("f64", "f32") if not wanted or c["group"] in wanted]
    with Pool() as pool:
        results = list(pool.imap(run, jobs, chunksize=2))
    failures = [r for r in results if isinstance(r, str)]
    if failures:
        sys.exit("\n".join(failures))
    for rows in results:
        for line in rows:
            group = line.split("\t")[0]
            if group in wanted:
                known[group] = []
                wanted.discard(group)
            known.setdefault(group, []).append(line + "\n")
    with open(path, "w") as out:
        out.write("\t".join(COLUMNS) + "\n")
        out.writelines(line for lines in known.values() for line in lines)


if __name__ == "__main__":
    main()
