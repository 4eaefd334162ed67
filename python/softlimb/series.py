"""Segments in series: one tube whose parts are wound differently."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.actuator import Actuator, loads, only
from softlimb.arrays import Codes, FloatLike, Floats, Ints, floats, one_shape
from softlimb.errors import InvalidParameter

_SUMS = 15
_OF_SEGMENT = 5


@dataclass(frozen=True, eq=False)
class SegmentState:
    """State of one segment. All fields are arrays of one shape, as of :class:`Solution`.

    Attributes:
        axial_stretch: Deformed over undeformed length; of a bending segment, of its axis.
        inner_radius_m: Deformed inner radius, m.
        outer_radius_m: Deformed outer radius, m.
        twist_rad: Twist of one end against the other, rad.
        bend_angle_rad: Bend angle, rad.
    """

    axial_stretch: Floats
    inner_radius_m: Floats
    outer_radius_m: Floats
    twist_rad: Floats
    bend_angle_rad: Floats


@dataclass(frozen=True, eq=False)
class SeriesSolution:
    """Equilibria of series. All fields are arrays of one shape; without a solution the numbers are NaN.

    Attributes:
        status: Codes of :class:`Status`.
        limit_segment: Without a solution, the index of the segment whose branch ends; -1 where no single segment is the cause.
        iterations: Evaluations of the model's equations, of all segments.
        pressure_pa: Gauge pressure, Pa.
        length_m: Length of the deformed axis, m.
        extension_m: Its change from rest, m.
        twist_rad: Sum of the twists, rad.
        bend_angle_rad: Sum of the bend angles, rad.
        volume_m3: Lumen volume, m3.
        tip_position_m: Tip, m; the base is at the origin, its axis along z; shape ``(..., 3)``.
        tip_quaternion: Orientation of the tip in the frame of the base: w, x, y, z; shape ``(..., 4)``.
        limit_pressure_pa: Without a solution, the pressure at which the branch ends, Pa; NaN where it ends at none.
        residual: Largest error of the equations, in units of the shear modulus.
        segments: States of the segments, from the base to the tip.
    """

    status: Codes
    limit_segment: Codes
    iterations: Ints
    pressure_pa: Floats
    length_m: Floats
    extension_m: Floats
    twist_rad: Floats
    bend_angle_rad: Floats
    volume_m3: Floats
    tip_position_m: Floats
    tip_quaternion: Floats
    limit_pressure_pa: Floats
    residual: Floats
    segments: tuple[SegmentState, ...]

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Where there is an equilibrium."""
        return np.asarray(self.status == 0)


class Series:
    """Actuators one behind the other along one tube, under one pressure. Equations: ``docs/explanation/model.md``, section 11.

    Attributes:
        segments: Actuators from the base to the tip, with equal radii and one winding each.
        bend_direction_rad: Direction that each segment bends towards: rotation about the undeformed tube from x, rad.
        shape: Shape to which actuators and directions broadcast.
    """

    def __init__(self, segments: Sequence[Actuator], bend_direction_rad: FloatLike | Sequence[FloatLike] = 0.0) -> None:
        """A series of actuators, each one or an array.

        Args:
            segments: Actuators from the base to the tip. Arrays of actuators broadcast.
            bend_direction_rad: A number for all, or one number or array a segment.

        Raises:
            InvalidParameter: No segment, or radii that differ from those of the first segment.
            ValueError: Arrays do not broadcast.
        """
        self.segments = tuple(segments)
        if not self.segments:
            raise InvalidParameter("segments", 0, "one actuator or more")
        given: Any = bend_direction_rad
        several = isinstance(given, (list, tuple)) or (isinstance(given, np.ndarray) and given.ndim > 0)
        directions = list(given) if several else [given] * len(self.segments)
        if len(directions) != len(self.segments):
            raise InvalidParameter("bend_direction_rad", len(directions), f"one direction, or {len(self.segments)}")
        self.bend_direction_rad: tuple[Floats, ...] = tuple(
            floats(f"bend_direction_rad[{i}]", direction) for i, direction in enumerate(directions)
        )
        for i, direction in enumerate(self.bend_direction_rad):
            if not np.all(np.isfinite(direction)):
                raise InvalidParameter(f"bend_direction_rad[{i}]", float("nan"), "finite")
        self._fields: dict[str, npt.NDArray[np.generic]] = {
            # Arrays of no size stand for the actuators: only their shapes count.
            **{f"segments[{i}]": np.broadcast_to(np.False_, s.shape) for i, s in enumerate(self.segments)},
            **{f"bend_direction_rad[{i}]": direction for i, direction in enumerate(self.bend_direction_rad)},
        }
        self.shape = one_shape(self._fields)

    def forward(
        self, pressure_pa: FloatLike, *, external_force_n: FloatLike = 0.0, external_torque_nm: FloatLike = 0.0
    ) -> SeriesSolution:
        """Equilibria at gauge pressures.

        Args:
            pressure_pa: Gauge pressure, Pa. Broadcasts against the series.
            external_force_n: Axial force on the free end, N; a series of straight and of bending segments takes no load.
            external_torque_nm: Torque on the free end, N m, as of :meth:`Actuator.forward`.

        Raises:
            InvalidParameter: A value is not accepted.
            ValueError: Arrays do not broadcast.
        """
        return self._solve("pressure_pa", pressure_pa, loads(external_force_n, external_torque_nm))

    def inverse(
        self,
        *,
        extension_m: FloatLike | None = None,
        twist_rad: FloatLike | None = None,
        bend_angle_rad: FloatLike | None = None,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
    ) -> SeriesSolution:
        """First gauge pressures, on raising them from zero, at which sums over the segments reach targets; vacuum is left out.

        Args:
            extension_m: Change of the length of the axis, m. Give exactly one target; it broadcasts against the series.
            twist_rad: Sum of the twists, rad; of a series with a straight segment.
            bend_angle_rad: Sum of the bend angles, rad, >= 0; of a series with a bending segment.
            external_force_n: As in :meth:`forward`, like ``external_torque_nm``.

        Raises:
            InvalidParameter: A value is not accepted, or no segment has this deformation.
            TypeError: Not exactly one target.
            ValueError: Arrays do not broadcast.
        """
        name, value = only(extension_m=extension_m, twist_rad=twist_rad, bend_angle_rad=bend_angle_rad)
        return self._solve(name, value, loads(external_force_n, external_torque_nm))

    def _solve(self, name: str, value: FloatLike, of_load: dict[str, Floats]) -> SeriesSolution:
        arguments = {name: floats(name, value), **of_load}
        shape = one_shape({**self._fields, **arguments})

        def flat(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
            return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1)

        parts = [
            (segment._built, flat(np.arange(segment.size, dtype=np.int64).reshape(segment.shape)), flat(direction))
            for segment, direction in zip(self.segments, self.bend_direction_rad, strict=True)
        ]
        forces = (flat(of_load["external_force_n"]), flat(of_load["external_torque_nm"])) if of_load else None
        try:
            (status, limit_segment), iterations, columns = _native.solve_series(parts, name, flat(arguments[name]), forces)
        except _native.Refused as refused:
            raise _refusal(refused, arguments, shape) from None
        numbers = [column.reshape(shape) for column in columns]
        sums, others = numbers[:_SUMS], numbers[_SUMS:]
        states = (others[i : i + _OF_SEGMENT] for i in range(0, len(others), _OF_SEGMENT))
        pressure_pa, length_m, extension_m, twist_rad, bend_angle_rad, volume_m3 = sums[:6]
        limit_pressure_pa, residual = sums[13:]
        return SeriesSolution(
            status=status.reshape(shape),
            limit_segment=limit_segment.reshape(shape),
            iterations=iterations.reshape(shape),
            pressure_pa=pressure_pa,
            length_m=length_m,
            extension_m=extension_m,
            twist_rad=twist_rad,
            bend_angle_rad=bend_angle_rad,
            volume_m3=volume_m3,
            tip_position_m=np.stack(sums[6:9], axis=-1),
            tip_quaternion=np.stack(sums[9:13], axis=-1),
            limit_pressure_pa=limit_pressure_pa,
            residual=residual,
            segments=tuple(SegmentState(*state) for state in states),
        )


def _refusal(refused: _native.Refused, arguments: dict[str, Floats], shape: tuple[int, ...]) -> InvalidParameter:
    """The error with the place of its value, in the argument of that name or in the answers."""
    name, flat, value, allowed = refused.args
    index = tuple(int(i) for i in np.unravel_index(flat, shape)) if shape else ()
    argument = arguments.get(name)
    if argument is not None:
        own = index[len(index) - argument.ndim :]
        index = tuple(place if length > 1 else 0 for place, length in zip(own, argument.shape, strict=True))
    return InvalidParameter(name, value, cast(str, allowed), index)
