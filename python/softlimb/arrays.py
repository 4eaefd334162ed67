"""Arguments as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from softlimb.errors import InvalidParameter

T = TypeVar("T")

Floats: TypeAlias = npt.NDArray[np.float64]
Codes: TypeAlias = npt.NDArray[np.int8]
Ints: TypeAlias = npt.NDArray[np.int32]
FloatLike: TypeAlias = npt.ArrayLike
"""A number, or an array of numbers."""
SEED_MAX = 2**64 - 1
"""Largest seed."""

NameLike: TypeAlias = "str | list[str] | tuple[str, ...] | npt.NDArray[np.str_]"
"""A name, or an array of names."""


def floats(field: str, value: FloatLike) -> Floats:
    """The value as an array of double precision."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidParameter(field, value, "a real number, or an array of real numbers") from None


def frozen(value: T) -> T | npt.NDArray[Any]:
    """A read-only copy of a list or an array; any other value itself."""
    if not isinstance(value, (list, np.ndarray)):
        return value
    copy = np.array(value)
    copy.flags.writeable = False
    return copy


def codes(field: str, value: object, allowed: Mapping[Any, int]) -> Codes:
    """The names as an array of their codes."""
    names = np.asarray(value)
    found = np.full(names.shape, -1, dtype=np.int8)
    for name, code in allowed.items():
        found[names == name] = code
    unknown = np.argwhere(found < 0)
    if len(unknown):
        index = tuple(int(i) for i in unknown[0])
        words = ", ".join(str(name) for name in allowed)
        raise InvalidParameter(field, names[index].item(), words, index)
    return found


def one_shape(fields: Mapping[str, npt.NDArray[np.generic]]) -> tuple[int, ...]:
    """The shape to which all fields broadcast."""
    try:
        return np.broadcast_shapes(*(array.shape for array in fields.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in fields.items() if array.shape)
        raise ValueError(f"shapes do not broadcast: {shapes}") from None


def within(field: str, value: float | None, low: float, high: float) -> None:
    """Refuses a number outside of a range; None stands for a default."""
    if value is not None and not low <= value <= high:
        raise InvalidParameter(field, value, f"{low} to {high}")
