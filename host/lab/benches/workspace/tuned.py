"""The kinematics of a workspace in numpy, written for speed: polynomials as short as the asked accuracy needs and summed in place, the sums over the
tubes of a bundle as matrix products, arcs seen from the start of the limb; in double or in single precision."""

import numpy as np
from numpy.polynomial import chebyshev, polynomial


def cut(powers, tolerance):
    """The polynomial without the Chebyshev terms that together are below a share of it."""
    terms = chebyshev.poly2cheb(powers)
    size, count = np.abs(terms).sum(), len(terms)
    while count > 1 and np.abs(terms[count - 1 :]).sum() <= tolerance * size:
        count -= 1
    return chebyshev.cheb2poly(terms[:count])


def rows(polynomials, tolerance, dtype):
    """Coefficients of several polynomials, the highest power first, as many as the longest has."""
    short = [cut(np.array(powers), tolerance) for powers in polynomials]
    count = max(map(len, short))
    return np.array([np.pad(powers, (0, count - len(powers)))[::-1] for powers in short]).astype(dtype)


class Tuned:
    """Tips of samples, whose pressures are given as `2 s - 1` of their shares `s`, one row a pressure."""

    def __init__(self, tables, dtype, tolerance):
        self.dtype = dtype
        self.modules = [self.module(module, tolerance) for module in tables["modules"]]
        self.rotation = np.array(tables["rotation"]).astype(dtype)
        self.origin = np.array(tables["origin_m"]).astype(dtype)[:, None]

    def module(self, module, tolerance):
        dtype, (cos, sin) = self.dtype, module["mount"]
        made = {"axes": module["axes"], "rigid": dtype(module["rigid_m"]), "twists": module["twists"], "bends": module["bends"]}
        if "places_m" not in module:
            made["rows"] = rows([module["powers"][0], module["powers"][2 if module["twists"] else 1]], tolerance, dtype)
            made["mount"] = dtype(cos), dtype(sin)
            return made
        stretch, axial, own = map(np.array, module["powers"])
        strain = stretch - np.eye(1, len(stretch))[0]
        places = np.array(module["places_m"]) @ np.array([[cos, sin], [-sin, cos]])
        radius = np.hypot(*places.T).max()
        x, y = places.T / radius
        unit = axial[0]
        made["rows"] = rows(
            [axial / unit, polynomial.polymul(axial, strain) / unit, own / (unit * radius**2)], tolerance, dtype
        )
        one = np.ones_like(x)
        made["stiffness"] = np.array([one, x, y, x * x, x * y, y * y]).astype(dtype)
        made["force"] = np.array([one, x, y]).astype(dtype)
        made["length"], made["bend"] = dtype(module["length_m"]), dtype(module["length_m"] / radius)
        return made

    def polynomials(self, rows, at):
        sums = np.empty((len(rows),) + at.shape, self.dtype)
        for row, total in zip(rows, sums):
            total.fill(row[0])
            for power in row[1:]:
                total *= at
                total += power
        return sums

    def bundle(self, module, at):
        stiffness, force, own = self.polynomials(module["rows"], at)
        s, sx, sy, xx, xy, yy = module["stiffness"] @ stiffness
        r, rx, ry = module["force"] @ force
        own = own.sum(0)
        xx += own
        yy += own
        mx, my = sx / s, sy / s
        a, b, c = xx - mx * sx, xy - mx * sy, yy - my * sy
        fx, fy = mx * r - rx, my * r - ry
        scale = 1 / (a * c - b * b)
        ux, uy = (c * fx - b * fy) * scale, (a * fy - b * fx) * scale
        strain = (r + sx * ux + sy * uy) / s
        return module["length"] * strain + module["length"], ux * module["bend"], uy * module["bend"]

    def tips(self, places):
        x = y = z = np.zeros(places.shape[1], self.dtype)
        end = len(places)
        for module in reversed(self.modules):
            at = places[end - module["axes"] : end]
            end -= module["axes"]
            z = z + module["rigid"]
            if "force" in module:
                length, bx, by = self.bundle(module, at)
            else:
                length, turn = self.polynomials(module["rows"], at[0])
                if module["twists"]:
                    cos, sin = np.cos(turn), np.sin(turn)
                    x, y, z = cos * x - sin * y, sin * x + cos * y, z + length
                    continue
                if not module["bends"]:
                    z = z + length
                    continue
                bx, by = turn * module["mount"][0], turn * module["mount"][1]
            square = bx * bx + by * by
            angle = np.maximum(np.sqrt(square), self.dtype(1e-4))
            per = 1 / angle
            a, half = np.sin(angle) * per, np.sin(0.5 * angle) * per
            b = 2 * half * half
            rest = length - bx * x - by * y
            out = a * z + b * rest
            x, y, z = x + bx * out, y + by * out, z * (1 - b * square) + a * rest
        return self.rotation @ np.stack([x, y, z]) + self.origin
