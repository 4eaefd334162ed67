"""Equilibria of fiber-reinforced tubes in decimal arithmetic of 50 digits, or as `precision` sets, from the equilibrium of stresses.

A straight tube: P = int (s_tt - s_rr) dr/r, N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr, M = 2 pi int s_tz r^2 dr with
r^2 = r_i^2 + (R^2 - R_i^2)/lambda, in the textbook form: fifty digits afford its cancellations. A sheet is a membrane.
Unknowns: e = lambda - 1, w = V/V0 - 1, g = Phi R_i/L. All derivatives are difference quotients.
"""

from decimal import Decimal as D, getcontext, localcontext

ROUGH = 28


def arctangent_of_inverse(n):
    term, total, k = D(1) / n, D(0), 1
    while term:
        total += term / k if k % 4 == 1 else -term / k
        term, k = (term / (n * n) if abs(term) > D(10) ** -(FINE + 10) else D(0)), k + 2
    return total


def precision(digits, nodes):
    """Digits of the arithmetic, and nodes of the quadrature in each panel."""
    global FINE, PI, RULES
    FINE = getcontext().prec = digits
    with localcontext() as context:
        context.prec = FINE + 10
        PI = 16 * arctangent_of_inverse(5) - 4 * arctangent_of_inverse(239)
    RULES = {"rough": gauss(10), "fine": gauss(nodes)}


def cos_sin(angle):
    with localcontext() as context:
        context.prec = FINE + 10
        term, total = D(1), [D(1), D(0)]
        for k in range(1, FINE + 10):
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
            for _ in range(10):
                last, now = D(1), x
                for k in range(2, n + 1):
                    last, now = now, ((2 * k - 1) * x * now - (k - 1) * last) / k
                slope = n * (x * now - last) / (x * x - 1)
                x -= now / slope
            rule.append(((1 - x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


precision(50, 36)


def nodes(a, b, pole):
    """Nodes and weights on (a, b); the panels grow with their distance from the pole left of them."""
    rule = RULES["fine" if getcontext().prec > ROUGH else "rough"]
    while a < b:
        end = min(b, 2 * a - pole)
        for t, weight in rule:
            yield a + (end - a) * t, (end - a) * weight
        a = end


INPUTS = ["inner", "outer", "c1", "c2", "c3", "angle", "mu2", "thickness", "winding", "pressure", "force", "torque"]


class Tube:
    """A tube and its inputs; `fiber` is None or (placement, families)."""

    names = INPUTS

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
            if value != 0 and name in self.names:
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
        if last is not None and (size < D(10) ** (14 - FINE) or (size < D(10) ** (22 - FINE) and size >= last / 2)):
            return x
        last = size
    raise ArithmeticError("Newton's method did not settle")
