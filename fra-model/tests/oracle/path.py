"""Pseudo-arclength continuation of the equilibria of a tube."""

from decimal import Decimal as D

from equilibrium import newton, solve


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


def fold(tube, x):
    """The limit point next to `x`, where the slope of the pressure over the volume is zero, by the secant method."""
    x = list(x)

    def at(volume):
        """Slope of the pressure in equilibrium with the volume; `x` is moved there."""
        x[1] = volume

        def equations(y):
            rest, rows = tube.matrix([y[0], volume, y[1]])
            unit = tube.inputs["c1"]
            rest[1] -= y[2] * unit
            return rest, [[row[0], row[2], -unit * (i == 1)] for i, row in enumerate(rows)]

        x[0], x[2], pressure = newton(equations, [x[0], x[2], x[3] / tube.inputs["c1"]])
        x[3] = pressure * tube.inputs["c1"]
        _, rows = tube.matrix(x[:3])
        return solve([[row[0], row[2], -D(i == 1)] for i, row in enumerate(rows)], [-row[1] for row in rows])[2]

    last, now = x[1], x[1] + (1 + x[1]) * D("1e-9")
    slope = at(last)
    for _ in range(20):
        change = at(now) - slope
        slope += change
        last, now = now, now - slope * (now - last) / change
        # The pressure's error is the square of this.
        if abs(now - last) < D("1e-20"):
            at(now)
            return x
    raise ArithmeticError("the limit point was not found")
