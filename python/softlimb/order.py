"""Broadcasting of arguments against actuators, without a copy of an actuator."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.arrays import Floats, one_shape
from softlimb.errors import InvalidParameter

T = TypeVar("T", bound=np.generic)


class Order:
    """Order in which the answers pass through the actuators again and again: the axes of the actuators come last.

    Attributes:
        shape: Shape of the answers.
    """

    def __init__(self, actuators: tuple[int, ...], arguments: dict[str, Floats]) -> None:
        self._arguments = arguments
        self._axes: tuple[int, ...] | None = None
        if not actuators and len(arguments) == 1:
            # The most frequent call needs no broadcasting.
            [argument] = arguments.values()
            self.shape = argument.shape
            return
        # An array of no size stands for the actuators: only its shape counts.
        stand_in = np.broadcast_to(np.False_, actuators)
        self.shape = one_shape({"the actuators": stand_in, **arguments})
        own = (1,) * (len(self.shape) - len(actuators)) + actuators
        repeated = [axis for axis, (a, b) in enumerate(zip(own, self.shape, strict=True)) if a != b]
        kept = [axis for axis in range(len(self.shape)) if axis not in repeated]
        axes = (*repeated, *kept)
        if axes != tuple(range(len(self.shape))):
            self._axes = axes

    def __getitem__(self, name: str) -> Floats:
        """An argument in that order, flat."""
        argument = self._arguments[name]
        if argument.shape != self.shape:
            argument = np.broadcast_to(argument, self.shape)
        ordered = argument if self._axes is None else argument.transpose(self._axes)
        return np.ascontiguousarray(ordered).reshape(-1)

    def loads(self) -> tuple[Floats, Floats] | None:
        """Forces and torques, if there are any."""
        if "external_force_n" not in self._arguments:
            return None
        return self["external_force_n"], self["external_torque_nm"]

    def back(self, column: npt.NDArray[T]) -> npt.NDArray[T]:
        """A column of answers in the shape of the answers."""
        if self._axes is None:
            return column if column.shape == self.shape else column.reshape(self.shape)
        ordered = column.reshape([self.shape[axis] for axis in self._axes])
        return ordered.transpose(np.argsort(self._axes))

    def error(self, refused: _native.Refused, **words: str) -> InvalidParameter:
        """A refused value as an error that says where it is; words are the arguments that are no arrays."""
        name, flat, value, allowed = refused.args
        if name.startswith("pressure_range["):
            name, allowed = (text.replace("pressure_range[", "pressure_range_pa[") for text in (name, allowed))
            return InvalidParameter(name, value, allowed)
        if name in words:
            return InvalidParameter(name, words[name], f"{allowed}; answer {self._index(name, flat)} has none")
        return InvalidParameter(name, value, allowed, self._index(name, flat))

    def _index(self, name: str, flat: int) -> tuple[int, ...]:
        """Index of an answer in the argument of that name, or in the answers."""
        axes = range(len(self.shape)) if self._axes is None else self._axes
        ordered = np.unravel_index(flat, [self.shape[axis] for axis in axes]) if self.shape else ()
        index = [0] * len(self.shape)
        for axis, place in zip(axes, ordered, strict=True):
            index[axis] = int(place)
        argument = self._arguments.get(name)
        if argument is None:
            return tuple(index)
        own = index[len(index) - argument.ndim :]
        return tuple(place if length > 1 else 0 for place, length in zip(own, argument.shape, strict=True))
