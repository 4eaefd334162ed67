"""Loaded limbs of scenes by shooting, beside `softlimb statics`: tip, sag, stiffness and load factor of every phase.

    cargo xtask lab statics            (python3 with numpy; --python PATH for another)

Only the pressures of the phases and the figures to compare come from softlimb. This program reads the scene file itself. A module is one Cosserat
rod whose section is derived here: the energy of a neo-Hookean tube with its threads, under its pressure, is integrated over the wall and minimised
by the lumen's radius; its slopes are force and moment at every stretch of every tube. The section is nonlinear and varies along the rod.
Weights are dead, so the force in every section is known, and three moments at the base are sought that leave none at the tip.

Pressures and loads grow together. Then the loads grow alone until the derivative of the tip's moments by those of the base is singular.
"""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
from numpy.polynomial import chebyshev

WORKSPACE = Path(__file__).resolve().parents[4]
GRAVITY = 9.80665
STEPS = 12  # of Runge and Kutta's method, a module
GROWTH = 8  # steps of pressures and loads together
FACTOR_MAX, FACTOR_STEP = 4.0, 0.25
PULL_N = 0.2  # at the tip, for its stiffness
FINEST = ["--tolerance", "0.01 %"]
UNITS = {"mm": 1e-3, "m": 1.0, "g": 1e-3, "kg": 1.0, "MPa": 1e6, "N": 1.0, "kPa": 1e3, "kg/m3": 1.0, "deg": np.pi / 180.0, "rad": 1.0}


def number(value):
    """A quantity of a scene in SI units."""
    if isinstance(value, (int, float)):
        return float(value)
    digits, unit = re.fullmatch(r"\s*([-+.\deE]+)\s*(\S+)\s*", value).groups()
    return float(digits) * UNITS[unit]


def gauss(low, high, count=16):
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (high + low) + 0.5 * (high - low) * x, 0.5 * (high - low) * w


def sheet_of_thread(thread, angle, mu, inner, outer):
    """Modulus times thickness of threads on the outer surface, N/m (docs/explanation/fabrication.md, threads as sheets)."""
    apart = 2.0 * np.pi * outer * np.sin(abs(angle)) / thread["starts"]
    width = number(thread["diameter"])
    order = np.arange(1, 20001)
    wave, strip = 2.0 * np.pi * order / apart, np.pi * order * width / apart
    deep = np.minimum(wave * (outer - inner), 20.0)
    layer = (np.sinh(deep) ** 2 - deep**2) / (np.sinh(deep) * np.cosh(deep) + deep)
    yields = (2.0 * (np.sin(strip) / strip) ** 2 / (2.0 * mu * wave * layer)).sum()
    return 0.25 / (apart / number(thread["stiffness"]) + yields * np.cos(angle) ** 4 / outer**2)


class Tube:
    """A wound neo-Hookean tube, energies per length at rest."""

    def __init__(self, module, scene):
        material = scene["materials"][module["material"]]
        self.mu = number(material["shear_modulus"])
        self.density = number(material["density"])
        self.inner, self.outer = number(module["inner_radius"]), number(module["outer_radius"])
        self.area = np.pi * (self.outer**2 - self.inner**2)
        winding = scene["windings"][module["winding"]] if "winding" in module else None
        self.families = []
        if winding is not None:
            angle = number(winding["angle"])
            self.families = [angle] if winding["families"] == 1 else [angle, -angle]
            if "thread" in winding:
                self.sheet = sheet_of_thread(winding["thread"], angle, self.mu, self.inner, self.outer)
            else:
                self.sheet = number(winding["modulus"]) * number(winding["thickness"])
        self.nodes, self.weights = gauss(self.inner, self.outer)
        # Cowper's coefficient of a hollow circle whose material keeps its volume.
        m = (self.inner / self.outer) ** 2
        self.shear_n = 9.0 * (1.0 + m) ** 2 / (10.0 * (1.0 + m) ** 2 + 26.0 * m) * self.mu * self.area

    def radius(self, at, stretch, lumen):
        return np.sqrt(lumen**2 + (at**2 - self.inner**2) / stretch)

    def energy(self, pressure, stretch, twist, lumen):
        """Of wall and threads less the work of the pressure, J/m; arrays of states."""
        stretch, twist, lumen = (np.asarray(value)[..., None] for value in (stretch, twist, lumen))
        at = self.nodes
        r = self.radius(at, stretch, lumen)
        i1 = stretch**2 + (r / at) ** 2 + (at / (r * stretch)) ** 2 + (r * twist) ** 2
        total = (0.5 * self.mu * (i1 - 3.0) * 2.0 * np.pi * at * self.weights).sum(axis=-1)
        r = self.radius(self.outer, stretch, lumen)[..., 0]
        for angle in self.families:
            cos, sin = np.cos(angle), np.sin(angle)
            i4 = (cos * r / self.outer + sin * r * twist[..., 0]) ** 2 + (sin * stretch[..., 0]) ** 2
            total = total + 0.5 * self.sheet * (i4 - 1.0) ** 2 * 2.0 * np.pi * self.outer
        return total - pressure * np.pi * lumen[..., 0] ** 2 * stretch[..., 0]

    def slope(self, axis, pressure, state):
        """Derivative of the energy by stretch, twist or lumen, by a complex step."""
        state = [np.asarray(value, dtype=complex) for value in state]
        state[axis] = state[axis] + 1e-30j
        return self.energy(pressure, *state).imag / 1e-30

    def settled(self, pressure, stretch, twist):
        """Lumen's radius of least energy at stretch and twist."""
        lumen = np.full(np.shape(stretch), self.inner / np.sqrt(np.mean(stretch)))
        for _ in range(60):
            slope = self.slope(2, pressure, (stretch, twist, lumen))
            step = 1e-6 * self.inner
            curve = (self.slope(2, pressure, (stretch, twist, lumen + step)) - slope) / step
            move = np.clip(-slope / curve, -0.02 * self.inner, 0.02 * self.inner)
            lumen = lumen + move
            if np.abs(move).max() < 1e-13:
                return lumen
        raise SystemExit("a tube has no equilibrium at its pressure")

    def forces(self, pressure, stretch, twist):
        """Axial force and torque that hold stretch and twist."""
        state = (stretch, twist, self.settled(pressure, stretch, twist))
        return self.slope(0, pressure, state), self.slope(1, pressure, state)

    def bending_nm2(self, pressure, stretch, twist, lumen):
        """Of the tube about its own axis, by second differences of the energy of a section whose axis bends in a plane.

        A wall point at the angle `t` moves outwards by `U cos t`, around by `V sin t` and along by `W sin t`; `U` and `W` are four and three functions of
        the radius, and `V` keeps the volume. The hydrostatic pressure of the straight wall keeps the volume to second order.
        """
        mu, sheet = self.mu, self.sheet if self.families else 0.0
        nodes, weights = gauss(self.inner, self.outer, 10)
        angle, count = 2.0 * np.pi * np.arange(16) / 16.0, 16
        cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
        ends = self.radius(np.array([self.inner, self.outer]), stretch, lumen)
        size = ends[1]

        def rise(high):
            at, w = gauss(self.inner, high, 10)
            r = self.radius(at, stretch, lumen)
            return (mu * ((r / at) ** 2 + (r * twist) ** 2 - (at / (r * stretch)) ** 2) * at / (r * r * stretch) * w).sum()

        radial = np.array([rise(at) for at in nodes]) - pressure
        slope = nodes / (self.radius(nodes, stretch, lumen) * stretch)
        hydrostatic = mu * slope**2 - radial

        def moved(x, at):
            """Places, their slopes around, by the radius and along the axis."""
            r = self.radius(at, stretch, lumen)
            y, by = r / size, at / (r * stretch)
            u = [(y**2, 2 * y, 2 + 0 * y), (y**-2, -2 * y**-3, 6 * y**-4), (np.log(y), 1 / y, -(y**-2)), (y**4, 4 * y**3, 12 * y**2)]
            w = [(y, 1 + 0 * y), (y**3, 3 * y**2), (1 / y, -(y**-2))]
            out, d_out, dd_out = (sum(a * f[k] for a, f in zip(x[1:5], u)) * size ** (1 - k) for k in range(3))
            along, d_along = (sum(a * f[k] for a, f in zip(x[5:], w)) * size ** (1 - k) for k in range(2))
            bend = x[0] / size
            both = bend * r * r / stretch - r * d_out
            d_both = 2.0 * bend * r / stretch - d_out - r * dd_out
            around, d_around = both - out, d_both - d_out
            place = np.stack([r + out * cos, around * sin + 0 * r, along * sin + 0 * r])
            turned = np.stack([-both * sin, r + both * cos, along * cos + 0 * r])
            radial = np.stack([by * (1 + d_out * cos), by * d_around * sin, by * d_along * sin])
            spin = np.stack([bend * sin + 0 * r, bend * cos + 0 * r, 0 * r * sin])
            axis = np.cross(spin, place, axis=0) + twist * turned
            axis[2] += stretch
            return place, turned, radial, axis, bend

        def energy(x):
            _, turned, by_radius, axis, _ = moved(x, nodes)
            hoop = turned / nodes
            i1 = (by_radius**2 + hoop**2 + axis**2).sum(axis=0)
            volume = (by_radius * np.cross(hoop, axis, axis=0)).sum(axis=0)
            total = ((0.5 * mu * i1 - hydrostatic * volume) * nodes * weights).sum() * 2.0 * np.pi / count
            place, turned, _, axis, bend = moved(x, np.array([self.inner]))
            area = 0.5 * (place[0] * turned[1] - place[1] * turned[0]).sum()
            sweep = ((place**2).sum(axis=0) * bend * (sin * turned[0] + cos * turned[1])).sum()
            total -= pressure * (stretch * area - 0.5 * sweep) * 2.0 * np.pi / count
            _, turned, _, axis, _ = moved(x, np.array([self.outer]))
            for family in self.families:
                c, s = np.cos(family), np.sin(family)
                along = turned / self.outer * c + axis * s
                i4 = (along**2).sum(axis=0)
                straight = (c * size / self.outer + s * size * twist) ** 2 + (s * stretch) ** 2
                # What the threads carry follows from the balance of the straight wall.
                pull = (c * size / self.outer + s * size * twist) * (c / self.outer + s * twist)
                carried = -(rise(self.outer) - pressure) * size * stretch / self.outer / pull / len(self.families)
                total += (0.5 * carried * (i4 - straight) + 0.5 * sheet * (i4 - straight) ** 2).sum() * self.outer * 2.0 * np.pi / count
            return total

        n, step = 8, 1e-3
        unit = np.eye(n) * step
        alone = [energy(e) + energy(-e) for e in unit]
        zero = energy(np.zeros(n))
        form = np.empty((n, n))
        for a in range(n):
            for b in range(a + 1):
                both = energy(unit[a] + unit[b]) + energy(-unit[a] - unit[b]) if a != b else 0.0
                form[a, b] = form[b, a] = 0.5 * (both - alone[a] - alone[b] + 2.0 * zero) if a != b else alone[a] - 2.0 * zero
        form /= step**2
        return (form[0, 0] - form[0, 1:] @ np.linalg.solve(form[1:, 1:], form[1:, 0])) * size**2


class Straight:
    """Extending tubes at places of the section."""

    RANGE, DEGREE = (0.8, 2.2), 20

    def __init__(self, tube, places, bay, pressure):
        self.places = places
        middle, half = 0.5 * sum(self.RANGE), 0.5 * (self.RANGE[1] - self.RANGE[0])
        x = np.cos(np.pi * (np.arange(32) + 0.5) / 32.0)
        stretch = middle + half * x
        force, _ = tube.forces(pressure, stretch, np.zeros_like(stretch))
        self.force = chebyshev.chebfit(x, force, self.DEGREE)
        self.by_x = chebyshev.chebder(self.force)
        roots = [z.real for z in chebyshev.chebroots(self.force) if abs(z.imag) < 1e-9 and -1.0 < z.real < 1.0]
        stable = [z for z in roots if chebyshev.chebval(z, self.by_x) > 0.0]
        self.free = middle + half * min(stable)
        lumen = tube.settled(pressure, np.array([self.free]), np.array([0.0]))[0]
        own = tube.bending_nm2(pressure, self.free, 0.0, lumen)
        step = 1e-3
        torque = [tube.forces(pressure, np.array([self.free]), np.array([t]))[1][0] for t in (step, -step)]
        slide = 1.0 / (1.0 / tube.shear_n + (bay * self.free) ** 2 / (12.0 * own) / self.free)
        reach = (places**2).sum()
        self.own = own * len(places)
        self.shear = slide * len(places)
        self.torsion = len(places) * (torque[0] - torque[1]) / (2.0 * step) + slide * reach
        self.start = np.array([self.free, 0.0, 0.0])


class Bent:
    """Bending tubes in a row: their strips keep their length, wall points move along rays and keep their volume, hoops keep their radius."""

    DEGREE = 14

    def __init__(self, tube, places, bay, pressure):
        outer, most = tube.outer, 0.6
        k = 0.5 * most * (1.0 + np.cos(np.pi * (np.arange(20) + 0.5) / 20.0))
        rho, w = gauss(tube.inner / outer, 1.0, 12)
        phi = 2.0 * np.pi * (np.arange(48) + 0.5) / 48.0
        rho, phi_, w = rho[:, None], phi[None, :], w[:, None] * 2.0 * np.pi / 48.0
        energy, across = [], []
        for bend in k:
            r = np.broadcast_to(rho, (rho.size, phi.size)).copy()
            for _ in range(50):
                f = (1 + bend) * (1 - r**2) / 2 - bend * np.cos(phi_) * (1 - r**3) / 3 - (1 - rho**2) / 2
                move = f / (-(1 + bend) * r + bend * np.cos(phi_) * r**2)
                r = r - move
                if abs(move).max() < 1e-14:
                    break
            stretch = 1 + bend * (1 - r * np.cos(phi_))
            turn = bend * np.sin(phi_) * (1 - r**3) / (3 * r * stretch)
            i1 = (rho / (r * stretch)) ** 2 + (turn / rho) ** 2 + (r / rho) ** 2 + stretch**2
            energy.append((0.5 * tube.mu * (i1 - 3.0) * rho * w).sum() * outer**2)
            tangent = tube.mu * (1.0 + 3.0 * (rho / r) ** 2 / stretch**4)
            lever = (r * np.sin(phi_) * outer) ** 2
            across.append([(tangent * lever * rho * w).sum() * outer**2, (tangent * rho * w).sum() * outer**2])
        x = 2.0 * k / most - 1.0
        moment = chebyshev.chebder(chebyshev.chebfit(x, energy, self.DEGREE)) * (2.0 * outer / most)
        moment[0] -= pressure * np.pi * outer**3
        self.half, self.outer, self.count = 0.5 * most / outer, outer, len(places)
        self.moment, self.by_x = moment, chebyshev.chebder(moment)
        roots = [z.real for z in chebyshev.chebroots(moment) if abs(z.imag) < 1e-9 and -1.05 < z.real < 1.0]
        free = (min(roots) + 1.0) if roots else 0.0
        own, line = (np.interp(free * self.half * outer, k[::-1], column[::-1]) for column in np.array(across).T)
        # Across, walls at both sides resist alone: strips that are pushed go slack.
        self.across = self.count * own + line * (places[:, 1] ** 2).sum()
        slide = 1.0 / (1.0 / tube.shear_n + bay**2 / (12.0 * 4.0 * tube.mu * np.pi / 4.0 * (outer**4 - tube.inner**4)))
        self.shear = slide * self.count
        polar = tube.mu * np.pi / 2.0 * (outer**4 - tube.inner**4)
        self.torsion = self.count * polar + slide * (places**2).sum()
        self.free = free * self.half
        self.start = np.array([self.free, 0.0, 0.0])


class Twisted:
    """One twisting tube on the axis, linear about its free state: loads strain it by less than a hundredth."""

    def __init__(self, tube, places, bay, pressure):
        stretch, twist, step = 1.0, 0.0, 1e-4
        for _ in range(50):
            states = np.array([[stretch, twist], [stretch + step, twist], [stretch, twist + step]])
            force, torque = tube.forces(pressure, states[:, 0], states[:, 1])
            base = np.array([force[0], torque[0]])
            hessian = np.array([[force[1] - force[0], force[2] - force[0]], [torque[1] - torque[0], torque[2] - torque[0]]]) / step
            move = np.linalg.solve(hessian, base)
            move *= min(1.0, 0.5 / max(abs(move[1]), 1e-12), 0.02 / max(abs(move[0]), 1e-12))
            stretch, twist = stretch - move[0], twist - move[1]
            if abs(move).max() < 1e-10:
                break
        self.free, self.compliance = np.array([stretch, twist]), np.linalg.inv(0.5 * (hessian + hessian.T))
        lumen = tube.settled(pressure, np.array([stretch]), np.array([twist]))[0]
        self.own = tube.bending_nm2(pressure, stretch, twist, lumen)
        # A rod has the bends of its tube, so that only the shear of the wall is left of a slide.
        self.shear = tube.shear_n
        self.start = np.array([stretch, 0.0, 0.0])


def stacked(laws, name):
    return np.stack([getattr(law, name) for law in laws])


def with_slope(series, slopes, x):
    """Values and slopes by `x` of series, which go on straight where they end."""
    inside = np.clip(x, -1.0, 1.0)
    slope = chebvals(slopes, inside)
    return chebvals(series, inside) + slope * (x - inside), slope


def chebvals(coefficients, x):
    """Series of shots (first axis) at points of the same first axis."""
    extra = (None,) * (x.ndim - 1)
    rows = coefficients.T[(...,) + extra]
    a, b = np.zeros_like(x), np.zeros_like(x)
    for row in rows[:0:-1]:
        a, b = row + 2.0 * x * a - b, a
    return rows[0] + x * a - b


class Module:
    """A module of several shots side by side: strains by forces and moments in its frame."""

    def __init__(self, laws):
        self.kind, first = type(laws[0]), laws[0]
        self.shear = stacked(laws, "shear")
        self.laws = laws
        self.warm = stacked(laws, "start")
        if self.kind is Straight:
            self.places = first.places
            self.force, self.by_x = stacked(laws, "force"), stacked(laws, "by_x")
            self.own, self.torsion = stacked(laws, "own"), stacked(laws, "torsion")
            low, high = Straight.RANGE
            self.middle, self.half = 0.5 * (low + high), 0.5 * (high - low)
        elif self.kind is Bent:
            self.moment, self.by_x = stacked(laws, "moment"), stacked(laws, "by_x")
            self.half, self.outer, self.count = first.half, first.outer, first.count
            self.across, self.torsion = stacked(laws, "across"), stacked(laws, "torsion")
        else:
            self.free, self.compliance, self.own = stacked(laws, "free"), stacked(laws, "compliance"), stacked(laws, "own")

    def strains(self, n, m):
        """Rates of place and of turn per length at rest, of all shots."""
        v, u = np.empty_like(n), np.empty_like(m)
        v[:, :2] = n[:, :2] / self.shear[:, None]
        if self.kind is Twisted:
            both = self.free + np.einsum("kij,kj->ki", self.compliance, np.stack([n[:, 2], m[:, 2]], axis=1))
            v[:, 2], u[:, 2] = both.T
            u[:, :2] = m[:, :2] / self.own[:, None]
            return v, u
        u[:, 2] = m[:, 2] / self.torsion
        if self.kind is Bent:
            bend = self.warm[:, 0].copy()
            wanted = m[:, 1] + n[:, 2] * self.outer
            for _ in range(30):
                x = bend / self.half - 1.0
                moment, slope = with_slope(self.moment, self.by_x, x)
                move = (self.count * moment - wanted) / (self.count * slope / self.half)
                bend = bend - move
                if abs(move).max() < 1e-11:
                    break
            self.warm[:, 0] = bend
            v[:, 2], u[:, 1], u[:, 0] = 1.0 + bend * self.outer, bend, m[:, 0] / self.across
            return v, u
        state, wanted = self.warm.copy(), np.stack([n[:, 2], m[:, 1], -m[:, 0]], axis=1)
        arms = np.column_stack([np.ones(len(self.places)), -self.places])
        own = np.zeros((len(n), 3, 3))
        own[:, 1, 1] = own[:, 2, 2] = self.own
        for _ in range(30):
            x = (state @ arms.T - self.middle) / self.half
            force, slope = with_slope(self.force, self.by_x, x)
            residual = force @ arms + np.einsum("kij,kj->ki", own, state) - wanted
            tangent = own + np.einsum("kt,ti,tj->kij", slope / self.half, arms, arms)
            move = np.linalg.solve(tangent, residual[..., None])[..., 0]
            state = state - move
            if abs(move).max() < 1e-12:
                break
        self.warm = state
        v[:, 2], u[:, 1], u[:, 0] = state[:, 0], state[:, 1], -state[:, 2]
        return v, u


def cross_matrix(u):
    zero = np.zeros(len(u))
    x, y, z = u.T
    return np.stack([np.stack([zero, -z, y], 1), np.stack([z, zero, -x], 1), np.stack([-y, x, zero], 1)], 1)


class Limb:
    def __init__(self, file):
        self.scene = scene = tomllib.loads(Path(file).read_text())
        limb = scene["limb"]
        self.base = np.array([number(value) for value in limb.get("base_position", [0, 0, 0])])
        z = np.array(limb["base_direction"], float)
        z /= np.linalg.norm(z)
        x = np.array(limb["base_up"], float)
        x -= z * (z @ x)
        x /= np.linalg.norm(x)
        self.axes = np.column_stack([x, np.cross(z, x), z])
        self.connector = [number(limb["connector"][name]) for name in ("length", "mass")]
        tool = limb["end_effector"]
        self.tool = [number(tool[name]) for name in ("length", "mass")]
        self.parts = []
        for module in scene["module"]:
            assert "spacer_mass" not in module
            count, tube = module["actuators"], Tube(module, scene)
            if module.get("arrangement", "circle") == "row":
                places = np.array([[0.0, (i - 0.5 * (count - 1)) * number(module["spacing"])] for i in range(count)])
            else:
                angles = 2.0 * np.pi * np.arange(count) / count
                places = number(module.get("circle_radius", 0.0)) * np.column_stack([np.cos(angles), np.sin(angles)])
            length = number(module["length"])
            mount = number(module.get("mount_angle", 0.0))
            turn = np.array([[np.cos(mount), -np.sin(mount), 0.0], [np.sin(mount), np.cos(mount), 0.0], [0.0, 0.0, 1.0]])
            law = {"extension": Straight, "bending": Bent, "twisting": Twisted}[module["motion"]]
            kg_per_m = count * tube.area * tube.density
            self.parts.append((law, tube, places, length, length / (module.get("spacers", 0) + 1), turn, kg_per_m))

    def kg(self):
        walls = sum(part[6] * part[3] for part in self.parts)
        return walls + len(self.parts) * self.connector[1] + self.tool[1]

    def length(self):
        return sum(part[3] for part in self.parts) + len(self.parts) * self.connector[0] + self.tool[0]

    def modules(self, pressures):
        """For each module its laws, one for each row of pressures."""
        made = []
        for index, (law, tube, places, _, bay, _, _) in enumerate(self.parts):
            known = {}
            rows = pressures[:, index]
            for pressure in rows:
                if pressure not in known:
                    known[pressure] = law(tube, places, bay, pressure)
            made.append([known[pressure] for pressure in rows])
        return made

    def shoot(self, modules, moments, loads, payloads, pull):
        """Moments left at the tip, and the tip, of shots with given moments at the base; `loads` are shares of the weights."""
        shots = len(moments)
        r, turn, m = np.tile(self.base, (shots, 1)), np.tile(self.axes, (shots, 1, 1)), moments.copy()
        down = np.zeros((shots, 3))
        down[:, 2] = -GRAVITY * loads
        beyond = self.kg() + payloads
        connector, mass = self.connector
        for index, (module, part) in enumerate(zip(modules, self.parts)):
            _, _, _, length, _, mount, kg_per_m = part
            h = length / STEPS
            turn = turn @ mount

            def rates(s, turn, m):
                force = down * (beyond - kg_per_m * s)[:, None] + pull
                v, u = module.strains(np.einsum("kji,kj->ki", turn, force), np.einsum("kji,kj->ki", turn, m))
                tangent = np.einsum("kij,kj->ki", turn, v)
                return tangent, turn @ cross_matrix(u), -np.cross(tangent, force)

            for step in range(STEPS):
                s = step * h
                a = rates(s, turn, m)
                b = rates(s + 0.5 * h, turn + 0.5 * h * a[1], m + 0.5 * h * a[2])
                c = rates(s + 0.5 * h, turn + 0.5 * h * b[1], m + 0.5 * h * b[2])
                d = rates(s + h, turn + h * c[1], m + h * c[2])
                r, turn, m = (old + h / 6.0 * (p + 2.0 * q + 2.0 * t + w) for old, p, q, t, w in zip((r, turn, m), a, b, c, d))
            turn = turn @ mount.T
            axis = turn[:, :, 2]
            beyond = beyond - kg_per_m * length
            masses = [(0.5 * connector, mass)]
            rigid = connector
            if index + 1 == len(self.parts):
                masses.append((connector + 0.5 * self.tool[0], self.tool[1]))
                rigid += self.tool[0]
            last = 0.0
            for distance, kg in masses + [(rigid, 0.0)]:
                m = m - np.cross(axis * (distance - last), down * beyond[:, None] + pull)
                beyond, last = beyond - kg, distance
            r = r + axis * rigid
        return m, r, turn

    def balanced(self, modules, moments, loads, payloads, pull):
        """Moments at the base of the equilibria, tips, and determinants of the derivative of the moments left by those at the base."""
        count, step = len(moments), 1e-5
        four = [Module([law for law in laws for _ in range(4)]) for laws in modules]
        repeat = lambda value: np.repeat(value, 4, axis=0)
        for _ in range(40):
            tried = repeat(moments)
            for axis in range(3):
                tried[axis + 1 :: 4, axis] += step
            left, tips, _ = self.shoot(four, tried, repeat(loads), repeat(payloads), repeat(pull))
            left = left.reshape(count, 4, 3)
            jacobian = (left[:, 1:] - left[:, :1]).transpose(0, 2, 1) / step
            move = np.linalg.solve(jacobian, left[:, 0, :, None])[..., 0]
            moments = moments - np.clip(move, -1.0, 1.0)
            if abs(left[:, 0]).max() < 1e-9:
                break
        found = abs(left[:, 0]).max(axis=1) < 1e-7
        return moments, tips.reshape(count, 4, 3)[:, 0], np.linalg.det(jacobian), found


def solve(limb, pressures, payloads):
    """Tip, tip without load, vertical stiffness and load factor of shots: rows of pressures with their payloads."""
    count = len(payloads)
    moments, none = np.zeros((count, 3)), np.zeros((count, 3))
    stable = np.ones(count, bool)
    for share in np.linspace(0.0, 1.0, GROWTH + 1)[1:]:
        modules = limb.modules(pressures * share)
        moments, tips, det, found = limb.balanced(modules, moments, np.full(count, share), payloads, none)
        stable &= found & (det > 0.0)
    _, free, _, _ = limb.balanced(modules, none, np.zeros(count), payloads, none)
    pull = none.copy()
    pull[:, 2] = PULL_N
    ends = [limb.balanced(modules, moments, np.ones(count), payloads, sign * pull)[1][:, 2] for sign in (1.0, -1.0)]
    stiffness = 2.0 * PULL_N / (ends[0] - ends[1])
    # Loads alone grow on.
    factor, last, low = np.full(count, FACTOR_MAX), det, np.ones(count)
    grown = moments
    for share in np.arange(1.0 + FACTOR_STEP, FACTOR_MAX + 1e-9, FACTOR_STEP):
        grown, _, det, found = limb.balanced(modules, grown, np.full(count, share), payloads, none)
        lost = (factor == FACTOR_MAX) & ~(found & (det > 0.0))
        # Where the determinant crosses zero, or where no shape was found.
        crossing = np.where(found, share - FACTOR_STEP * det / np.minimum(det - last, -1e-300), share - 0.5 * FACTOR_STEP)
        factor[lost] = crossing[lost]
        last = det
        if (factor < FACTOR_MAX).all():
            break
    return tips, free, stiffness, np.where(stable, factor, 0.0)


def printed(scene, words):
    """The answer of `softlimb statics`."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "softlimb", "--", "statics", str(scene), "--json", *words]
    done = subprocess.run(command, cwd=WORKSPACE, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise SystemExit(done.stderr)
    return json.loads(done.stdout)


def compared(scene, words):
    """Figures of the phases of a scene: those of softlimb and those found here."""
    limb, rows = Limb(scene), []
    answer = printed(scene, words)
    phases = answer["phases"]
    assert abs(limb.kg() - answer["mass_kg"]) < 1e-9, "another mass"
    pressures = np.array([phase["pressures_pa"] for phase in phases])
    found = solve(limb, pressures, np.array([phase["payload_kg"] for phase in phases]))
    for phase, tip, free, stiffness, factor in zip(phases, *found):
        off, unloaded = tip - phase["tip_m"], free - phase["free_tip_m"]
        row = {"scene": answer["scene"], "phase": phase["name"], "payload_kg": phase["payload_kg"]}
        row["tip_off_m"], row["free_tip_off_m"] = float(np.linalg.norm(off)), float(np.linalg.norm(unloaded))
        row["tip_off_share"] = row["tip_off_m"] / limb.length()
        row["sag_m"] = [phase["deflection_m"], float(np.linalg.norm(tip - free))]
        row["stiffness_n_per_m"] = [phase["tip_stiffness_n_per_m"][2], float(stiffness)]
        row["load_factor"] = [phase["load_factor"], float(factor)]
        rows.append(row)
    return rows


def table(rows):
    """In Markdown."""
    print("| scene, phase | kg | tip off, mm | % of the length | sag, mm | here | k_z, N/m | here | load factor | here |")
    print("| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |")
    factor = lambda value: "> 4" if value >= FACTOR_MAX else f"{value:.2f}"
    for row in rows:
        sag, stiffness = ([scale * value for value in row[name]] for name, scale in (("sag_m", 1e3), ("stiffness_n_per_m", 1.0)))
        cells = [f"{row['scene'][-1]}, {row['phase']}", f"{row['payload_kg']:.1f}", f"{1e3 * row['tip_off_m']:.1f}"]
        cells += [f"{100 * row['tip_off_share']:.2f}", *(f"{value:.1f}" for value in sag), *(f"{value:.1f}" for value in stiffness)]
        print("| " + " | ".join(cells + [factor(value) for value in row["load_factor"]]) + " |")


def largest(letters, rows):
    """Largest differences of each limb, in Markdown."""
    worst = lambda rows, name: 100.0 * max(abs(here / own - 1.0) for own, here in (row[name] for row in rows))
    print("\n| limb | tip off, % of the length | sag, % | k_z, % | load factor, % |")
    print("| --- | --: | --: | --: | --: |")
    for letter in letters:
        own = [row for row in rows if row["scene"][-1] == letter]
        figures = [100.0 * max(row["tip_off_share"] for row in own), *(worst(own, name) for name in ("sag_m", "stiffness_n_per_m", "load_factor"))]
        print(f"| {letter} | " + " | ".join(f"{figure:.2f}" for figure in figures) + " |")


def main():
    letters = "abc"
    scene = lambda letter: WORKSPACE / f"scenes/pick-and-place-{letter}.toml"
    every = lambda words: [row for letter in letters for row in compared(scene(letter), words)]
    loads = lambda words: every(words) + every(["--payload", "0", *words])
    rows, finest = loads([]), loads(FINEST)
    if "--json" in sys.argv:
        return print(json.dumps({"default": rows, "finest": finest}))
    table(rows)
    largest(letters, rows)
    print(f"\nWith `{' '.join(FINEST)}`:")
    largest(letters, finest)
    print(f"\nTips without load differ by at most {1e6 * max(row['free_tip_off_m'] for row in rows):.1f} um.")


if __name__ == "__main__":
    main()
