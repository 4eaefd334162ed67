"""The forward problem of a straight neo-Hookean tube with a sheet of fibers, as one would write it in Python.

Equations: docs/explanation/model.md, section 3, the stress integrals for P (I) and N_ext (II). Two families without torque: the unknowns are the stretch and the deformed
inner radius. SI units throughout; an actuator is one row of `Tubes`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import fsolve


@dataclass
class Tubes:
    """Columns of equal length: radii, sheet thickness and shear moduli of many actuators, and the pressure on each."""

    inner: np.ndarray
    outer: np.ndarray
    angle: np.ndarray
    thickness: np.ndarray
    mu1: np.ndarray
    mu2: np.ndarray
    pressure: np.ndarray

    def take(self, which):
        return Tubes(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def __len__(self):
        return len(self.inner)


def sample(count, seed=7):
    """Actuators as people build them, at pressures well below their limit."""
    rng = np.random.default_rng(seed)
    inner = rng.uniform(3e-3, 15e-3, count)
    ratio = rng.uniform(1.15, 2.0, count)
    mu1 = 10 ** rng.uniform(4.5, 5.7, count)
    return Tubes(
        inner=inner,
        outer=inner * ratio,
        angle=np.radians(rng.uniform(0.0, 75.0, count)),
        thickness=0.1 * inner * (ratio - 1.0),
        mu1=mu1,
        mu2=mu1 * 10 ** rng.uniform(0.0, 3.0, count),
        pressure=mu1 * np.log(ratio) * rng.uniform(0.02, 0.5, count),
    )


# --- one actuator, fsolve and adaptive quadrature -------------------------------------------------------------------------------


def fsolve_forward(inner, outer, angle, thickness, mu1, mu2, pressure):
    """`(stretch, deformed inner radius)` by MINPACK on the stress integrals (I) and (II)."""
    c, s = np.cos(angle), np.sin(angle)

    def residual(unknowns):
        stretch, r_i = unknowns[0], unknowns[1] * inner

        def deformed(radius):
            return np.sqrt(r_i**2 + (radius**2 - inner**2) / stretch)

        def differences(radius):
            r = deformed(radius)
            radial = (radius / (r * stretch)) ** 2
            return mu1 * ((r / radius) ** 2 - radial), mu1 * (stretch**2 - radial)

        def by_pressure(radius):
            return differences(radius)[0] * radius / (stretch * deformed(radius) ** 2)

        def by_force(radius):
            hoop, axial = differences(radius)
            return np.pi * (2.0 * axial - hoop) * radius / stretch

        r_f = deformed(outer)
        hoop, axial = c * r_f / outer, s * stretch
        tension = 2.0 * 2.0 * mu2 * (hoop**2 + axial**2 - 1.0) * thickness * outer / (r_f * stretch)
        n_tt, n_zz = tension * hoop**2, tension * axial**2
        wall = quad(by_pressure, inner, outer, epsabs=1e-12 * mu1, epsrel=1e-12)[0]
        force = quad(by_force, inner, outer, epsabs=1e-12 * mu1 * outer**2, epsrel=1e-12)[0]
        return [
            (wall + n_tt / r_f - pressure) / mu1,
            (force + np.pi * r_f * (2.0 * n_zz - n_tt)) / (mu1 * np.pi * inner**2),
        ]

    found, _, success, _ = fsolve(residual, [1.0, 1.0], xtol=1e-12, full_output=True)
    return found[0], found[1] * inner, success == 1


# --- many actuators, numpy ------------------------------------------------------------------------------------------------------


def wall_by_quadrature(nodes=8):
    """Pressure and force of the wall and their derivatives by `(stretch, lumen area ratio)`, Gauss nodes in the radius' logarithm."""
    abscissae, weights = np.polynomial.legendre.leggauss(nodes)
    abscissae, weights = abscissae[:, None], weights[:, None]

    def prepare(t):
        half = 0.5 * np.log(t.outer / t.inner)
        x = np.exp(2.0 * half * (1.0 + abscissae))  # (R/R_i)^2
        return x, x - 1.0, weights * half

    def evaluate(prepared, stretch, a):
        # a = (r_i/R_i)^2, y = (r/R)^2, dr/r = d ln R/(stretch y), r dr = R^2 d ln R/stretch.
        x, x_less_1, w = prepared
        inverse = 1.0 / stretch
        y = (a + x_less_1 * inverse) / x
        radial = inverse**2 / y
        axial = stretch**2 - radial
        hoop = y - radial
        radial_y = -radial / y
        y_l, y_a = -x_less_1 / x * inverse**2, 1.0 / x
        radial_l = radial_y * y_l - 2.0 * radial * inverse
        g = hoop / y
        g_y = (1.0 - radial_y - g) / y
        wi = w * inverse
        p = (wi * g).sum(0)
        p_l = (wi * (g_y * y_l + 2.0 * radial * inverse / y)).sum(0) - p * inverse
        p_a = (wi * g_y * y_a).sum(0)
        wx = wi * x
        n = (wx * (2.0 * axial - hoop)).sum(0)
        n_l = (wx * (4.0 * stretch - radial_l - y_l)).sum(0) - n * inverse
        n_a = (wx * (-radial_y - 1.0) * y_a).sum(0)
        return p, p_l, p_a, n, n_l, n_a

    return prepare, evaluate


def wall_closed():
    """The same from the closed forms of the integrals: one logarithm."""

    def prepare(t):
        x_outer = (t.outer / t.inner) ** 2
        return (x_outer, x_outer - 1.0)

    def evaluate(prepared, stretch, a):
        x_outer, d = prepared
        inverse = 1.0 / stretch
        v = stretch * a  # lumen volume ratio
        b = v + d
        log = np.log(x_outer * v / b)
        q = d / (v * b)
        p = 0.5 * inverse * (log + (v - 1.0) * q)
        p_v = 0.5 * inverse * q * (1.0 / v + x_outer / b)
        n = d * (stretch - inverse**2) - 0.5 * inverse**2 * (v - 1.0) * log
        n_v = -0.5 * inverse**2 * (log + (v - 1.0) * q)
        n_l = d * (1.0 + 2.0 * inverse**3) + inverse**3 * (v - 1.0) * log
        # From (stretch, volume) to (stretch, area).
        return p, -p * inverse + p_v * a, p_v * stretch, n, n_l + n_v * a, n_v * stretch

    return prepare, evaluate


def newton_forward(t, wall, tolerance=1e-10, iterations=60):
    """Damped Newton iteration over all actuators at once; those that have converged leave the iteration.

    Returns the stretch, the deformed inner radius and which have converged.
    """
    prepare, evaluate = wall
    stretch_out, area_out, done_out = np.ones(len(t)), np.ones(len(t)), np.zeros(len(t), bool)
    active = np.arange(len(t))
    stretch, a = np.ones(len(t)), np.ones(len(t))
    c2, s2 = np.cos(t.angle) ** 2, np.sin(t.angle) ** 2
    x_f = (t.outer / t.inner) ** 2
    weight = 4.0 * t.mu2 / t.mu1 * t.thickness / t.outer
    wanted = t.pressure / t.mu1
    prepared = prepare(t)
    for _ in range(iterations):
        p, p_l, p_a, n, n_l, n_a = evaluate(prepared, stretch, a)
        # The sheet: y = (r_f/R_f)^2, line tension k = 4 mu2 t/(R_f mu1) (I4 - 1).
        inverse = 1.0 / stretch
        y = (a + (x_f - 1.0) * inverse) / x_f
        y_l, y_a = (1.0 - x_f) / x_f * inverse**2, 1.0 / x_f
        l2 = stretch**2
        k = weight * (c2 * y + s2 * l2 - 1.0)
        k_l, k_a = weight * (c2 * y_l + 2.0 * s2 * stretch), weight * c2 * y_a
        p = p + k * c2 * inverse
        p_l = p_l + (k_l - k * inverse) * c2 * inverse
        p_a = p_a + k_a * c2 * inverse
        shape = x_f * (2.0 * s2 * l2 - c2 * y) * inverse
        n = n + k * shape
        n_l = n_l + k_l * shape + k * (x_f * (4.0 * s2 * stretch - c2 * y_l) - shape) * inverse
        n_a = n_a + k_a * shape - k * x_f * c2 * y_a * inverse
        rest = wanted - p
        det = p_l * n_a - p_a * n_l
        dl = (rest * n_a + p_a * n) / det
        da = (-p_l * n - rest * n_l) / det
        size = np.maximum(np.abs(dl) * inverse, np.abs(da) / a)
        damping = np.minimum(1.0, 0.5 / size)
        stretch = stretch + damping * dl
        a = a + damping * da
        done = size < tolerance
        if done.any():
            at = active[done]
            stretch_out[at], area_out[at], done_out[at] = stretch[done], a[done], True
            keep = ~done
            active = active[keep]
            if not len(active):
                break
            stretch, a, wanted = stretch[keep], a[keep], wanted[keep]
            c2, s2, x_f, weight = c2[keep], s2[keep], x_f[keep], weight[keep]
            prepared = tuple(column[..., keep] for column in prepared)
    return stretch_out, np.sqrt(area_out) * t.inner, done_out
