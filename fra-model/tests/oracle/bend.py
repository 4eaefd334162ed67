"""The bend of a hoop-wound tube with an inextensible line, in decimal arithmetic: the energy of the isochoric map of the section,

    A0 (R_f^2 - r^2)/2 - kappa cos f (R_f^3 - r^3)/3 = (R_f^2 - R^2)/2,  A0 = 1 + kappa R_o,  lambda = A0 - kappa r cos f,

by quadrature over the section, and the balance P pi R_f^2 R_o + M + N R_o = dU/dkappa by a central difference.
"""

from decimal import Decimal as D, getcontext, localcontext

from equilibrium import PI, cos_sin, gauss

INPUTS = ["outer", "inner", "length", "c1", "c2", "c3", "winding", "pressure", "force", "torque"]


def section(radial, angles):
    """Quadrature of the section: Gauss in ln R, where thin and thick walls converge alike; midpoints of equal angles on half a turn."""
    return gauss(radial), [cos_sin(PI * (2 * j + 1) / (2 * angles)) for j in range(angles)]


FINE, ROUGH = section(28, 100), section(8, 20)


def energy(p, kappa, rule):
    """Strain energy per length."""
    small, smaller = (D(1).scaleb(-int(getcontext().prec * share)) for share in (0.7, 0.9))
    inner, outer, wound = p["inner"], p["outer"], p["winding"]
    total, (radial, angles) = D(0), rule
    span = 2 * (outer / inner).ln()
    for t, weight in radial:
        square = inner**2 * (span * t).exp()
        weight *= square * span
        radius = square.sqrt()
        for cos, sin in angles:
            r, last = radius, None
            while True:
                rest = (1 + kappa * outer) * (wound**2 - r * r) / 2 - kappa * cos * (wound**3 - r**3) / 3
                rest -= (wound**2 - square) / 2
                step = rest / (r * (1 + kappa * outer - kappa * r * cos))
                r += step
                if last is not None and (abs(step) < r * smaller or (abs(step) < r * small and abs(step) >= last / 2)):
                    break
                last = abs(step)
            stretch = 1 + kappa * outer - kappa * r * cos
            lean = kappa * sin * (wound**3 - r**3) / (3 * r * stretch)
            i1 = (radius / (r * stretch)) ** 2 + (lean / radius) ** 2 + (r / radius) ** 2 + stretch**2 - 3
            total += weight * i1 * (p["c1"] + i1 * (p["c2"] + i1 * p["c3"]))
    # Both halves of the section; dA = d(R^2)/2 df.
    return total * PI / len(angles)


def moment(p, kappa, rule=FINE):
    with localcontext() as context:
        context.prec, share = (58, D("1e-11")) if rule is FINE else (30, D("1e-4"))
        h = kappa * share
        return (energy(p, kappa + h, rule) - energy(p, kappa - h, rule)) / (2 * h)


def pressure(p, angle, rule=FINE):
    """The pressure that holds a bend angle."""
    kappa = angle / p["length"]
    lever = PI * p["winding"] ** 2 * p["outer"]
    return (moment(p, kappa, rule) - p["torque"] - p["force"] * p["outer"]) / lever


def slopes(p, angle):
    """dP/d ln(input) at fixed angle for the inputs but the pressure, and dP/d ln(angle)."""
    h = D("1e-3")
    base = pressure(p, angle, ROUGH)
    out = {}
    for name in INPUTS:
        if p[name] != 0 and name != "pressure":
            moved = dict(p)
            moved[name] = p[name] * (1 + h)
            out[name] = (pressure(moved, angle, ROUGH) - base) / h
    h = D("1e-8")
    by_angle = (pressure(p, angle * (1 + h)) - pressure(p, angle * (1 - h))) / (2 * h)
    return out, by_angle
