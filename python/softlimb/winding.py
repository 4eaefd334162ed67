"""Windings of an actuator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from softlimb.arrays import FloatLike, NameLike


@dataclass(frozen=True, kw_only=True, eq=False)
class Fiber:
    """A winding. Every field is a scalar or an array.

    Attributes:
        angle_rad: Fiber angle from the hoop direction, rad, -pi/2 to pi/2. The sign gives the sense of the twist.
        families: 1 for one helix, 2 for a pair at plus and minus the angle.
        modulus_pa: ``mu2`` of each family, Pa, >= 0: a quarter of the modulus along the fiber.
        thickness_m: Thickness of a sheet, m, > 0. A layer and smeared fibers have none.
        placement: ``"sheet"``, ``"layer"`` (from ``radius_m`` to the outer surface) or ``"smeared"`` (through the whole wall).
        radius_m: Winding radius, m; the outer radius if it is None.
    """

    angle_rad: FloatLike
    families: npt.ArrayLike
    modulus_pa: FloatLike
    thickness_m: FloatLike | None = None
    placement: NameLike = "sheet"
    radius_m: FloatLike | None = None
