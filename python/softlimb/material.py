"""Elastomers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from softlimb import _native
from softlimb.arrays import Codes, FloatLike, Floats, NameLike, floats


@dataclass(frozen=True, kw_only=True, eq=False)
class NeoHookean:
    """Strain energy ``mu/2 (I1 - 3)``.

    Attributes:
        shear_modulus_pa: ``mu``, Pa, > 0; a number or an array.
    """

    shear_modulus_pa: FloatLike


@dataclass(frozen=True, kw_only=True, eq=False)
class Yeoh:
    """Strain energy ``C1 (I1-3) + C2 (I1-3)^2 + C3 (I1-3)^3``; the shear modulus is ``2 C1``.

    Attributes:
        c1_pa: ``C1``, Pa, > 0; a number or an array, like the others.
        c2_pa: ``C2``, Pa.
        c3_pa: ``C3``, Pa.
    """

    c1_pa: FloatLike
    c2_pa: FloatLike = 0.0
    c3_pa: FloatLike = 0.0


MaterialLike: TypeAlias = "NameLike | NeoHookean | Yeoh"
"""A law, the trade name of a castable elastomer, or an array of trade names."""


@dataclass(frozen=True, kw_only=True)
class CastableElastomer:
    """A castable elastomer, its law fitted to a tensile test.

    Attributes:
        name: Trade name.
        c_pa: Coefficients of the Yeoh law, Pa.
        stretch: Least and largest stretch of the test that the law describes.
    """

    name: str
    c_pa: tuple[float, float, float]
    stretch: tuple[float, float]


def castable_elastomers() -> list[CastableElastomer]:
    """The known castable elastomers, as ``softlimb materials`` lists them."""
    rows = _native.castable_elastomers()
    return [CastableElastomer(name=name, c_pa=(c[0], c[1], c[2]), stretch=(s[0], s[1])) for name, c, s in rows]


@dataclass(frozen=True)
class Law:
    """A material as arrays: code of the law, coefficients in Pa, and the largest stretch of the test behind them, if there is one."""

    code: Codes
    c_pa: tuple[Floats, Floats, Floats]
    stretch_max: Floats | None


def law(material: MaterialLike) -> Law:
    """The law of a material."""
    zero = np.zeros(())
    if isinstance(material, NeoHookean):
        return Law(np.zeros((), dtype=np.int8), (floats("material.shear_modulus_pa", material.shear_modulus_pa), zero, zero), None)
    yeoh = np.ones((), dtype=np.int8)
    if isinstance(material, Yeoh):
        c1, c2, c3 = (floats(f"material.c{i}_pa", c) for i, c in enumerate((material.c1_pa, material.c2_pa, material.c3_pa), 1))
        return Law(yeoh, (c1, c2, c3), None)
    names = np.asarray(material)
    if names.dtype.kind != "U":
        raise TypeError(f"material is a NeoHookean, a Yeoh, a trade name, or an array of trade names, not {type(material).__name__}")
    known = {name: _native.castable_elastomer(name) for name in {str(name) for name in names.flat}}
    c_pa = [np.array([known[str(name)][1][i] for name in names.flat]).reshape(names.shape) for i in range(3)]
    stretch_max = np.array([known[str(name)][2][1] for name in names.flat]).reshape(names.shape)
    return Law(yeoh, (c_pa[0], c_pa[1], c_pa[2]), stretch_max)
