"""The same equations as in `speed_baselines.py`, compiled: by numba, one actuator after another on all processors, and by JAX, over whole arrays.

A bend is the balance of `docs/explanation/model.md`, section 5, for a hoop winding: eight Gauss nodes through the wall, sixteen angles on half a turn.
A Yeoh wall has no closed form: eight Gauss nodes in the radius' logarithm. All iterations are Newton's with exact derivatives.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from numba import njit, prange

jax.config.update("jax_enable_x64", True)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
ANGLES = (np.arange(16) + 0.5) * np.pi / 16
COS, SIN = np.cos(ANGLES), np.sin(ANGLES)
TOLERANCE = 1e-7
"""Of a last step, whose square is the error that it leaves."""
ROUNDS = 60

# Vectors along a loop of fixed length need sums in any order, and quotients without a check for zero.
compiled = partial(njit, fastmath=True, error_model="numpy")


@compiled(inline="always")
def sheet(x_f, weight, c2, s2, stretch, a, wall):
    """Adds the sheet to pressure and force of the wall and their derivatives by stretch and lumen area ratio."""
    p, p_l, p_a, n, n_l, n_a = wall
    inverse = 1.0 / stretch
    y = (a + (x_f - 1.0) * inverse) / x_f
    y_l, y_a = (1.0 - x_f) / x_f * inverse * inverse, 1.0 / x_f
    k = weight * (c2 * y + s2 * stretch * stretch - 1.0)
    k_l, k_a = weight * (c2 * y_l + 2.0 * s2 * stretch), weight * c2 * y_a
    shape = x_f * (2.0 * s2 * stretch * stretch - c2 * y) * inverse
    return (
        p + k * c2 * inverse,
        p_l + (k_l - k * inverse) * c2 * inverse,
        p_a + k_a * c2 * inverse,
        n + k * shape,
        n_l + k_l * shape + k * (x_f * (4.0 * s2 * stretch - c2 * y_l) - shape) * inverse,
        n_a + k_a * shape - k * x_f * c2 * y_a * inverse,
    )


def closed_wall(log):
    """Pressure and force of a neo-Hookean wall by closed forms, with their derivatives by stretch and lumen area ratio."""

    def wall(x_outer, stretch, a):
        d = x_outer - 1.0
        inverse = 1.0 / stretch
        v = stretch * a
        b = v + d
        thick = log(x_outer * v / b)
        q = d / (v * b)
        p = 0.5 * inverse * (thick + (v - 1.0) * q)
        p_v = 0.5 * inverse * q * (1.0 / v + x_outer / b)
        n = d * (stretch - inverse * inverse) - 0.5 * inverse * inverse * (v - 1.0) * thick
        n_v = -0.5 * inverse * inverse * (thick + (v - 1.0) * q)
        n_l = d * (1.0 + 2.0 * inverse**3) + inverse**3 * (v - 1.0) * thick
        return p, -p * inverse + p_v * a, p_v * stretch, n, n_l + n_v * a, n_v * stretch

    return wall


numba_wall = compiled(inline="always")(closed_wall(np.log))
jax_wall = closed_wall(jnp.log)


@compiled(inline="always")
def wall_closed(x_outer, _c2, _c3, stretch, a):
    return numba_wall(x_outer, stretch, a)


@compiled(inline="always")
def wall_yeoh(x_outer, c2, c3, stretch, a):
    """Of a Yeoh wall; `c2` and `c3` are `2 c_2/mu_1` and `3 c_3/mu_1` of `psi'/mu_1 = 1/2 + c2 J + c3 J^2`."""
    half, inverse = 0.25 * np.log(x_outer), 1.0 / stretch
    p = p_l = p_a = n = n_l = n_a = 0.0
    for i in range(8):
        x = np.exp(2.0 * half * (1.0 + NODES[i]))
        w = WEIGHTS[i] * half * inverse
        y = (a + (x - 1.0) * inverse) / x
        y_l, y_a = -(x - 1.0) / x * inverse * inverse, 1.0 / x
        radial = inverse * inverse / y
        radial_y, radial_l = -radial / y, -2.0 * radial * inverse
        j = y + radial + stretch * stretch - 3.0
        j_l, j_y = radial_l + 2.0 * stretch, 1.0 + radial_y
        m = 1.0 + 2.0 * j * (c2 + c3 * j)
        m_j = 2.0 * c2 + 4.0 * c3 * j
        hoop, axial = y - radial, stretch * stretch - radial
        g = hoop / y
        g_y = (1.0 - radial_y - g) / y
        f = 2.0 * axial - hoop
        f_y, f_l = -radial_y - 1.0, 4.0 * stretch - radial_l
        m_l, m_a = m_j * (j_l + j_y * y_l), m_j * j_y * y_a
        p += w * m * g
        p_l += w * (m * (g_y * y_l - radial_l / y) + m_l * g)
        p_a += w * (m * g_y * y_a + m_a * g)
        n += w * x * m * f
        n_l += w * x * (m * (f_l + f_y * y_l) + m_l * f)
        n_a += w * x * (m * f_y * y_a + m_a * f)
    return p, p_l - p * inverse, p_a, n, n_l - n * inverse, n_a


def forward_by(wall):
    """The forward problem with the integrals of one kind of wall: stretch and deformed inner radius."""

    @compiled(parallel=True)
    def forward(inner, outer, angle, thickness, mu1, mu2, pressure, c2, c3):
        count = len(inner)
        found = np.empty((2, count))
        for i in prange(count):
            x_outer = (outer[i] / inner[i]) ** 2
            cos2 = np.cos(angle[i]) ** 2
            weight = 4.0 * mu2[i] / mu1[i] * thickness[i] / outer[i]
            wanted = pressure[i] / mu1[i]
            stretch = a = 1.0
            for _ in range(ROUNDS):
                of_wall = wall(x_outer, c2[i], c3[i], stretch, a)
                p, p_l, p_a, n, n_l, n_a = sheet(x_outer, weight, cos2, 1.0 - cos2, stretch, a, of_wall)
                rest = wanted - p
                det = p_l * n_a - p_a * n_l
                dl, da = (rest * n_a + p_a * n) / det, (-p_l * n - rest * n_l) / det
                size = max(abs(dl) / stretch, abs(da) / a)
                damping = 0.5 / max(size, 0.5)
                stretch, a = stretch + damping * dl, a + damping * da
                if size < TOLERANCE:
                    break
            found[0, i], found[1, i] = stretch, np.sqrt(a) * inner[i]
        return found

    return forward


numba_forward = forward_by(wall_closed)
numba_forward_yeoh = forward_by(wall_yeoh)


@compiled(parallel=True)
def numba_inverse(inner, outer, angle, thickness, mu1, mu2, target):
    """Gauge pressure and deformed inner radius at a stretch."""
    count = len(inner)
    found = np.empty((2, count))
    for i in prange(count):
        x_outer = (outer[i] / inner[i]) ** 2
        cos2 = np.cos(angle[i]) ** 2
        weight = 4.0 * mu2[i] / mu1[i] * thickness[i] / outer[i]
        stretch, a, p = target[i], 1.0 / target[i], 0.0
        for _ in range(ROUNDS):
            wall = wall_closed(x_outer, 0.0, 0.0, stretch, a)
            p, _, p_a, n, _, n_a = sheet(x_outer, weight, cos2, 1.0 - cos2, stretch, a, wall)
            da = -n / n_a
            p += p_a * da
            a += da * 0.5 / max(abs(da) / a, 0.5)
            if abs(da) < TOLERANCE * a:
                break
        found[0, i], found[1, i] = p * mu1[i], np.sqrt(a) * inner[i]
    return found


@compiled(inline="always")
def moment(k, inner, a, b, rounds, with_slope):
    """Restoring moment over `mu_1 R_o^3` and its slope, of a wall wound at its outer face, all lengths in units of `R_o`."""
    half = -0.5 * np.log(inner)
    per_stretch = 1.0 / (1.0 + k)
    sum_moment = sum_slope = 0.0
    for i in range(8):
        square = inner * inner * np.exp(2.0 * half * (1.0 + NODES[i]))
        inverse = 1.0 / square
        straight2 = 1.0 - (1.0 - square) * per_stretch
        straight = np.sqrt(straight2)
        u = (straight2 * straight - 1.0) * (2.0 / 3.0)
        ring = ring_slope = 0.0
        for j in range(16):
            cos, sin = COS[j], SIN[j]
            x = cos * k * per_stretch
            r = np.sqrt(max(straight2 + u * x * (1.0 + straight * x), 0.3 * straight2))
            for _ in range(rounds):
                r2 = r * r
                shift = 0.5 * (1.0 - r2) - cos / 3.0 * (1.0 - r2 * r)
                r += (square + 2.0 * k * shift - r2) / (2.0 * r * (1.0 + k - k * r * cos))
            r2 = r * r
            h = 1.0 - r * cos
            stretch = 1.0 + k * h
            reach = 1.0 - r2 * r
            shift = 0.5 * (1.0 - r2) - cos / 3.0 * reach
            g = shift / (r2 * stretch)
            p, q = r2 * inverse, stretch * stretch
            per_pq = 1.0 / (p * q)
            l = (h - k * cos * r * g) / stretch
            lean = sin / stretch
            m = lean * reach / (3.0 * r)
            m_k = -lean * r2 * g - m * (g + l)
            lean_k = m + m_k * k
            by_radius, by_stretch = p - per_pq, q - per_pq
            first = g * by_radius + l * by_stretch + k * m * lean_k * inverse
            invariant = p + q + per_pq - 3.0 + (k * m) ** 2 * inverse
            stiffness = 1.0 + 2.0 * invariant * (a + b * invariant)
            ring += stiffness * first
            if with_slope:
                total = g + l
                g_k = -g * (h / stretch + g + total)
                bow = g * g + g_k
                l_k = -cos * r * (2.0 * g + bow * k) / stretch - l * l
                m_kk = -lean * r2 * (2.0 * g * g + g_k - g * l) - m_k * total - m * (g_k + l_k)
                lean_kk = 2.0 * m_k + m_kk * k
                curve = (
                    g_k * by_radius
                    + l_k * by_stretch
                    + 2.0 * (g * g * p + l * l * q + total * total * per_pq)
                    + (lean_k * lean_k + m * k * lean_kk) * inverse
                )
                ring_slope += stiffness * curve + 4.0 * (a + 2.0 * b * invariant) * first * first
        weight = WEIGHTS[i] * half * 2.0 * square
        sum_moment += weight * ring
        sum_slope += weight * ring_slope
    scale = np.pi / 16
    return sum_moment * scale, sum_slope * scale


@compiled(parallel=True)
def numba_bend_inverse(inner, outer, length, mu1, c2, c3, angle):
    """Gauge pressure at a bend angle."""
    found = np.empty(len(inner))
    for i in prange(len(inner)):
        k = angle[i] * outer[i] / length[i]
        found[i] = moment(k, inner[i] / outer[i], c2[i], c3[i], 3, False)[0] * mu1[i] / np.pi
    return found


@compiled(parallel=True)
def numba_bend_forward(inner, outer, length, mu1, c2, c3, pressure):
    """Bend angle at a gauge pressure."""
    found = np.empty(len(inner))
    for i in prange(len(inner)):
        wanted = pressure[i] / mu1[i] * np.pi
        k = 0.0
        for _ in range(ROUNDS):
            value, slope = moment(k, inner[i] / outer[i], c2[i], c3[i], 3, True)
            step = (wanted - value) / slope
            k += min(step, 0.5 * (k + 0.5))
            if abs(step) < TOLERANCE * k:
                break
        found[i] = k * length[i] / outer[i]
    return found


@jax.jit
def jax_forward(inner, outer, angle, thickness, mu1, mu2, pressure):
    """As `numba_forward` by closed forms: all actuators until the last has converged."""
    x_outer = (outer / inner) ** 2
    cos2 = jnp.cos(angle) ** 2
    weight = 4.0 * mu2 / mu1 * thickness / outer
    wanted = pressure / mu1

    def advance(state):
        stretch, a, _, count = state
        wall = jax_wall(x_outer, stretch, a)
        p, p_l, p_a, n, n_l, n_a = sheet.py_func(x_outer, weight, cos2, 1.0 - cos2, stretch, a, wall)
        rest = wanted - p
        det = p_l * n_a - p_a * n_l
        dl, da = (rest * n_a + p_a * n) / det, (-p_l * n - rest * n_l) / det
        size = jnp.maximum(jnp.abs(dl) / stretch, jnp.abs(da) / a)
        damping = 0.5 / jnp.maximum(size, 0.5)
        return stretch + damping * dl, a + damping * da, size.max(), count + 1

    one = jnp.ones_like(inner)
    goes_on = lambda state: (state[2] > TOLERANCE) & (state[3] < ROUNDS)
    stretch, a, _, _ = jax.lax.while_loop(goes_on, advance, (one, one, jnp.inf, 0))
    return stretch, jnp.sqrt(a) * inner
