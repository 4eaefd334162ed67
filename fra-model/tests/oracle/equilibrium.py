"""Equilibria of fiber-reinforced tubes in decimal arithmetic of 50 digits, from the equilibrium of stresses.

A straight tube: P = int (s_tt - s_rr) dr/r, N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr, M = 2 pi int s_tz r^2 dr with
r^2 = r_i^2 + (R^2 - R_i^2)/lambda, in the textbook form: fifty digits afford its cancellations. A sheet is a membrane.
Unknowns: e = lambda - 1, w = V/V0 - 1, g = Phi R_i/L. All derivatives are difference quotients.
"""

from decimal import Decimal as D, getcontext, localcontext

getcontext().prec = 50
PI = D("3.14159265358979323846264338327950288419716939937510582097494459")
ROUGH, FINE = 28, 50


def cos_sin(angle):
    with localcontext() as context:
        context.prec = 60
        term, total = D(1), [D(1), D(0)]
        for k in range(1, 60):
            term = term * angle / k
            total[k % 2] += term if k % 4 < 2 else -term
    return +total[0], +total[1]


def gauss(n):
    """Nodes and weights on (0, 1)."""
    from math import cos, pi

    with localcontext() as context:
        context.prec = FINE + 5
        rule = []
        for i in range(n):
            x = D(cos(pi * (i + 0.75) / (n + 0.5)))
            for _ in range(8):
                last, now = D(1), x
                for k in range(2, n + 1):
                    last, now = now, ((2 * k - 1) * x * now - (k - 1) * last) / k
                slope = n * (x * now - last) / (x * x - 1)
                x -= now / slope
            rule.append(((1 - x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


RULES = {ROUGH: gauss(10), FINE: gauss(36)}


def nodes(a, b, pole):
    """Nodes and weights on (a, b); the panels grow with their distance from the pole left of them."""
    rule = RULES[FINE if getcontext().prec > ROUGH else ROUGH]
    while a < b:
        end = min(b, 2 * a - pole)
        for t, weight in rule:
            yield a + (end - a) * t, (end - a) * weight
        a = end


INPUTS = ["inner", "outer", "c1", "c2", "c3", "angle", "mu2", "thickness", "winding", "pressure", "force", "torque"]


class Tube:
    """A tube and its inputs; `fiber` is None or (placement, families)."""

    def __init__(self, inputs, fiber):
        self.inputs, self.fiber = dict(inputs), fiber
        self.twists = inputs["torque"] != 0 or (fiber is not None and fiber[1] == 1)

    def loads(self, state, inputs=None):
        """(N/(pi R_i^2), P, M/(pi R_i^3)) in equilibrium with the state."""
        p = inputs or self.inputs
        e, w, g = state
        stretch, inner = 1 + e, p["inner"]
        c = (p["c1"], 2 * p["c2"], 3 * p["c3"])
        cosine, sine = cos_sin(p["angle"])
        families = [] if self.fiber is None else [cosine, -cosine][: self.fiber[1]]

        def rubber(x, h, turn):
            radial = 1 / (h * stretch) ** 2
            i1 = radial + h * h + turn * turn + stretch * stretch - 3
            modulus = 2 * (c[0] + i1 * (c[1] + c[2] * i1))
            return (
                modulus * (h * h + turn * turn - radial),
                modulus * (stretch * stretch - radial),
                modulus * turn * stretch,
            )

        def thread(h, turn):
            total = [D(0)] * 3
            for cos in families:
                hoop, axial = cos * h + sine * turn, sine * stretch
                stress = 2 * p["mu2"] * (hoop * hoop + axial * axial - 1)
                for i, s in enumerate((hoop * hoop, axial * axial, hoop * axial)):
                    total[i] += stress * s
            return total

        total = [D(0)] * 3

        def integrate(a, b, smeared, wall):
            for x, weight in nodes(a, b, max(D(0), -w)):
                h = ((x + w) / (stretch * x)).sqrt()
                radius = h * x.sqrt()
                stress = rubber(x, h, g * radius) if wall else (D(0),) * 3
                if smeared:
                    stress = [a + b for a, b in zip(stress, thread(h, g * radius))]
                tt, zz, tz = stress
                total[0] += (2 * zz - tt) * weight / (2 * stretch)
                total[1] += tt * weight / (2 * (x + w))
                total[2] += tz * radius * weight / stretch

        outer = (p["outer"] / inner) ** 2
        placement = self.fiber and self.fiber[0]
        integrate(D(1), outer, placement == "smeared", True)
        at = (p["winding"] / inner) ** 2
        if placement == "layer":
            integrate(at, outer, True, False)
        if placement == "sheet":
            h = ((at + w) / (stretch * at)).sqrt()
            radius = p["winding"] * h
            tt, zz, tz = thread(h, g * radius / inner)
            thickness = p["thickness"] * p["winding"] / (radius * stretch)
            total[0] += radius * thickness * (2 * zz - tt) / inner**2
            total[1] += tt * thickness / radius
            total[2] += 2 * radius**2 * thickness * tz / inner**3
        return total

    def applied(self, inputs=None):
        p = inputs or self.inputs
        area = PI * p["inner"] ** 2
        return [p["force"] / area, p["pressure"], p["torque"] / (area * p["inner"])]

    def rest(self, state, inputs=None):
        """What is missing from equilibrium; the twist is zero by symmetry unless the tube twists."""
        out = [a - b for a, b in zip(self.loads(state, inputs), self.applied(inputs))]
        if not self.twists:
            out[2] = 2 * self.inputs["c1"] * state[2]
        return out

    def matrix(self, state):
        """d rest/d state; row: equation."""
        h = D(10) ** (-getcontext().prec // 2)
        base = self.rest(state)
        columns = []
        for j in range(3):
            moved = list(state)
            moved[j] += h
            columns.append([(a - b) / h for a, b in zip(self.rest(moved), base)])
        rows = [[columns[j][i] for j in range(3)] for i in range(3)]
        if not self.twists:
            rows[0][2] = rows[1][2] = D(0)
        return base, rows

    def by_inputs(self, state):
        """{input: d rest/d ln input} for those that are not zero."""
        h = D(10) ** (-getcontext().prec // 2)
        base = self.rest(state)
        out = {}
        for name, value in self.inputs.items():
            if value != 0 and name in INPUTS:
                moved = dict(self.inputs)
                moved[name] = value * (1 + h)
                out[name] = [(a - b) / h for a, b in zip(self.rest(state, moved), base)]
                if not self.twists:
                    out[name][2] = D(0)
        return out


def solve(a, b):
    n = len(b)
    a = [row[:] + [rhs] for row, rhs in zip(a, b)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(a[i][k]) / max(map(abs, a[i][:n])))
        a[k], a[pivot] = a[pivot], a[k]
        for i in range(k + 1, n):
            factor = a[i][k] / a[k][k]
            a[i] = [x - factor * y for x, y in zip(a[i], a[k])]
    x = [D(0)] * n
    for k in reversed(range(n)):
        x[k] = (a[k][n] - sum(a[k][j] * x[j] for j in range(k + 1, n))) / a[k][k]
    return x


def newton(equations, x):
    """Newton's method started close to the root; `equations(x)` gives residuals and matrix."""
    last = None
    for _ in range(30):
        rest, matrix = equations(x)
        step = solve(matrix, rest)
        x = [a - b for a, b in zip(x, step)]
        size = max(map(abs, step)) / max(max(map(abs, x)), D(10) ** -20)
        if last is not None and (size < D(10) ** -36 or (size < D(10) ** -28 and size >= last / 2)):
            return x
        last = size
    raise ArithmeticError("Newton's method did not settle")


class Path:
    """Pseudo-arclength continuation of rest(state) = at * direction from a stable state, with the direction a load or the pressure."""

    def __init__(self, tube, state, start, direction, unit, forwards, go_on):
        self.tube, self.direction, self.unit = tube, direction, unit
        self.points, self.end = [], "reached"
        sign = D(1) if forwards else D(-1)
        here = self.point(state + [start], [D(0), D(0), D(0), sign])
        step = D("0.001")
        self.points.append(here)
        while go_on(here[0]):
            there = self.step(here, step)
            if there is None or sum(a * b for a, b in zip(self.scaled(here, there), here[1])) < D("0.985"):
                step /= 2
                if step < D("1e-12"):
                    raise ArithmeticError("the continuation is stuck")
                continue
            if there[1][3] * here[1][3] <= 0:
                self.points.append(self.last(here, step, lambda p: p[1][3] * here[1][3] > 0))
                self.end = "fold"
                return
            if not self.stable(there[0]):
                if step > D("1e-6"):
                    step /= 4
                    continue
                self.end = "crossing"
                return
            self.points.append(there)
            here = there
            step = min(step * D("1.5"), D("0.1"))

    def scales(self, x):
        return [1 + x[0], 1 + x[1], D(1), self.unit]

    def equations(self, x, scales):
        rest, rows = self.tube.matrix(x[:3])
        rest = [r - x[3] * d for r, d in zip(rest, self.direction)]
        rows = [[v * s for v, s in zip(row, scales)] + [-d * scales[3]] for row, d in zip(rows, self.direction)]
        return rest, rows

    def point(self, x, towards):
        scales = self.scales(x)
        _, rows = self.equations(x, scales)
        tangent = solve(rows + [towards], [D(0), D(0), D(0), D(1)])
        size = sum(t * t for t in tangent).sqrt()
        return x, [t / size for t in tangent]

    def scaled(self, a, b):
        tangent = [t * s / r for t, s, r in zip(b[1], self.scales(b[0]), self.scales(a[0]))]
        size = sum(t * t for t in tangent).sqrt()
        return [t / size for t in tangent]

    def step(self, here, step):
        (x, tangent), scales = here, self.scales(here[0])
        moved = [t * step for t in tangent]
        last = None
        for _ in range(8):
            at = [a + s * m for a, s, m in zip(x, scales, moved)]
            if at[0] <= -1 or at[1] <= -1:
                return None
            rest, rows = self.equations(at, scales)
            change = solve(rows + [tangent], rest + [D(0)])
            moved = [m - c for m, c in zip(moved, change)]
            off = sum((m - t * step) ** 2 for m, t in zip(moved, tangent)).sqrt()
            if off > step / 2 + D("1e-12"):
                return None
            size = max(map(abs, change))
            if size < D("1e-11") * step + D("1e-18") or (last and size < D("1e-6") * step and size >= last / 2):
                return self.point([a + s * m for a, s, m in zip(x, scales, moved)], tangent)
            last = size
        return None

    def last(self, here, step, good):
        """The last good point on the way from `here`, whose neighbour a step ahead is not."""
        while step > D("1e-13"):
            step /= 2
            there = self.step(here, step)
            if there is not None and good(there):
                here = there
        return here

    def stable(self, x):
        _, m = self.tube.matrix(x[:3])
        h = lambda i, j: (m[i][j] + m[j][i]) / 2
        first = h(0, 0)
        if first <= 0:
            return False
        second = h(1, 1) - h(0, 1) ** 2 / first
        if second <= 0:
            return False
        coupling = h(1, 2) - h(0, 1) * h(0, 2) / first
        return h(2, 2) - h(0, 2) ** 2 / first - coupling**2 / second > 0

    def near(self, at):
        """A state close to that at a value of the parameter: the path is walked again from the point before it."""
        for a, b in zip(self.points, self.points[1:]):
            if (a[0][3] - at) * (b[0][3] - at) <= 0:
                step, here = D("0.1"), a
                while step > D("1e-12"):
                    if abs(here[0][3] - at) <= D("1e-14") * abs(at):
                        break
                    wanted = abs((at - here[0][3]) / (here[1][3] * self.unit))
                    there = self.step(here, min(step, wanted))
                    if there is not None and (there[0][3] - at) * (a[0][3] - at) >= 0 and there[1][3] * a[1][3] > 0:
                        here = there
                    else:
                        step = min(step, wanted) / 2
                return here[0][:3]
        raise ArithmeticError(f"{at} is not on the path")
