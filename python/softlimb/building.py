"""Fields of actuators as columns, and the native actuators built from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.arrays import FloatLike, NameLike, codes, floats, one_shape
from softlimb.errors import InvalidParameter
from softlimb.material import MaterialLike, law
from softlimb.winding import Fiber

Column: TypeAlias = npt.NDArray[np.generic]

_MOTIONS = {"extension": 0, "expansion": 1, "bending": 2, "twisting": 3}
_PLACEMENTS = {"sheet": 0, "layer": 1, "smeared": 2}
_FAMILIES = {1: 1, 2: 2}
_OF_A_WINDING = ("angle_rad", "modulus_pa", "thickness_m", "radius_m")


@dataclass(frozen=True)
class Fields:
    """Fields of actuators as flat columns of one value, or of one for each.

    Attributes:
        shape: Shape of the array of actuators.
        own: Shape of each field by itself.
        is_pair: Whether there are two windings.
        bends: Whether an actuator bends.
    """

    shape: tuple[int, ...]
    own: Mapping[str, tuple[int, ...]]
    tube: tuple[Column, ...]
    windings: list[tuple[Column, ...]]
    stretch_max: Column | None
    is_pair: bool
    bends: bool

    @property
    def count(self) -> int:
        """Number of actuators."""
        return int(np.prod(self.shape))

    def error(self, refused: _native.Refused) -> InvalidParameter:
        """A refused value by the name of its field in Python."""
        name, flat, value, allowed = refused.args
        name, column = _names(name, self.is_pair)
        index = np.unravel_index(flat, self.shape) if self.shape else ()
        own = self.own[column]
        places = zip(index[len(index) - len(own) :], own, strict=True)
        return InvalidParameter(name, value, allowed, tuple(int(place) if length > 1 else 0 for place, length in places))


def columns(
    motion: NameLike,
    inner_radius_m: FloatLike,
    outer_radius_m: FloatLike,
    length_m: FloatLike,
    material: MaterialLike,
    fiber: Fiber | Sequence[Fiber] | None,
    others: Mapping[str, Column] | None = None,
) -> Fields:
    """The fields, in the shape to which they and some other arrays broadcast."""
    windings = _windings(fiber)
    of_material = law(material)
    tube: dict[str, Column] = {
        "motion": codes("motion", motion, _MOTIONS),
        "inner_radius_m": floats("inner_radius_m", inner_radius_m),
        "outer_radius_m": floats("outer_radius_m", outer_radius_m),
        "length_m": floats("length_m", length_m),
        "material": of_material.code,
        **{f"material.c_pa[{i}]": c for i, c in enumerate(of_material.c_pa)},
    }
    wound = {place: _winding(place, winding, tube) for place, winding in windings.items()}
    stretch_max = {} if of_material.stretch_max is None else {"material": of_material.stretch_max}
    fields = {**tube, **{name: column for winding in wound.values() for name, column in winding.items()}}
    shape = one_shape({**fields, **stretch_max, **(others or {})})
    flat = {name: _flat(column, shape) for name, column in fields.items()}
    return Fields(
        shape=shape,
        own={name: column.shape for name, column in fields.items()},
        tube=tuple(flat[name] for name in tube),
        windings=[tuple(flat[name] for name in winding) for winding in wound.values()],
        stretch_max=None if of_material.stretch_max is None else _whole(of_material.stretch_max, shape),
        is_pair=len(windings) > 1,
        bends=bool(np.any(tube["motion"] == _MOTIONS["bending"])),
    )


def built(fields: Fields) -> _native.Actuators:
    """The native actuators."""
    try:
        return _native.Actuators(fields.count, fields.tube, fields.windings, fields.stretch_max)
    except _native.Refused as refused:
        raise fields.error(refused) from None


def _windings(fiber: Fiber | Sequence[Fiber] | None) -> dict[str, Fiber]:
    """Windings by the name of their place."""
    if fiber is None:
        return {}
    if isinstance(fiber, Fiber):
        return {"fiber": fiber}
    if len(fiber) != 2:
        raise InvalidParameter("fiber", len(fiber), "one winding, or a pair")
    return {f"fiber[{i}]": winding for i, winding in enumerate(fiber)}


def _winding(place: str, fiber: Fiber, tube: Mapping[str, Column]) -> dict[str, Column]:
    placement = codes(f"{place}.placement", fiber.placement, _PLACEMENTS)
    is_straight = bool(np.any(tube["motion"] != _MOTIONS["bending"]))
    if fiber.thickness_m is None and is_straight and bool(np.any(placement == _PLACEMENTS["sheet"])):
        raise InvalidParameter(f"{place}.thickness_m", None, "finite and > 0: a sheet needs it")
    thickness = 0.0 if fiber.thickness_m is None else fiber.thickness_m
    radius = tube["outer_radius_m"] if fiber.radius_m is None else floats(f"{place}.radius_m", fiber.radius_m)
    return {
        f"{place}.angle_rad": floats(f"{place}.angle_rad", fiber.angle_rad),
        f"{place}.families": codes(f"{place}.families", fiber.families, _FAMILIES),
        f"{place}.modulus_pa": floats(f"{place}.modulus_pa", fiber.modulus_pa),
        f"{place}.placement": placement,
        f"{place}.thickness_m": floats(f"{place}.thickness_m", thickness),
        f"{place}.radius_m": radius,
    }


def _names(name: str, is_pair: bool) -> tuple[str, str]:
    """A field of the model by its name in Python, and by that of its column."""
    second = name.removeprefix("second_fiber.")
    if second != name:
        name = f"fiber[1].{second}"
    elif name in _OF_A_WINDING:
        name = f"fiber[0].{name}" if is_pair else f"fiber.{name}"
    elif name == "shear_modulus_pa":
        return f"material.{name}", "material.c_pa[0]"
    elif name.startswith("c_pa["):
        return f"material.c{int(name[5]) + 1}_pa", f"material.{name}"
    return name, name


def _flat(column: Column, shape: tuple[int, ...]) -> Column:
    """The column with one value for all actuators, or one for each."""
    return column.reshape(1) if column.size == 1 else _whole(column, shape)


def _whole(column: npt.NDArray[np.generic], shape: tuple[int, ...]) -> npt.NDArray[np.generic]:
    return np.ascontiguousarray(np.broadcast_to(column, shape)).reshape(-1)
