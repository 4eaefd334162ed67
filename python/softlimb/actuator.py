"""One actuator, or an array of them."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.arrays import Codes, FloatLike, Floats, NameLike, floats, frozen
from softlimb.building import built, columns
from softlimb.errors import InvalidParameter
from softlimb.material import MaterialLike
from softlimb.order import Order
from softlimb.solution import Blocked, Sensitivity, Solution, Solutions
from softlimb.winding import Fiber

WINDING_ERROR_RAD = float(np.radians(2.0))
"""Error of the winding angle that answers state the effect of, rad."""

ModelName: TypeAlias = Literal["auto", "analytic", "section-fe"]
InputName: TypeAlias = Literal[
    "inner_radius_m",
    "outer_radius_m",
    "length_m",
    "material.shear_modulus_pa",
    "material.c1_pa",
    "material.c2_pa",
    "material.c3_pa",
    "fiber.angle_rad",
    "fiber.modulus_pa",
    "fiber.thickness_m",
    "fiber.radius_m",
    "fiber[0].angle_rad",
    "fiber[0].modulus_pa",
    "fiber[0].thickness_m",
    "fiber[0].radius_m",
    "fiber[1].angle_rad",
    "fiber[1].modulus_pa",
    "fiber[1].thickness_m",
    "fiber[1].radius_m",
    "pressure_pa",
    "external_force_n",
    "external_torque_nm",
]
"""Inputs of an equilibrium."""

_INPUTS: dict[str, str] = {
    "inner_radius_m": "inner_radius_m",
    "outer_radius_m": "outer_radius_m",
    "length_m": "length_m",
    "material.shear_modulus_pa": "shear_modulus_pa",
    **{f"material.c{i + 1}_pa": f"c_pa[{i}]" for i in range(3)},
    **{
        f"{place}.{name}": f"{prefix}{name}"
        for place, prefix in (("fiber", ""), ("fiber[0]", ""), ("fiber[1]", "second_fiber."))
        for name in ("angle_rad", "modulus_pa", "thickness_m", "radius_m")
    },
    **{name: name for name in ("pressure_pa", "external_force_n", "external_torque_nm")},
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Actuator:
    """An actuator, or an array of actuators: checked and built once, solved for any number of pressures and deformations.

    Every field is a scalar or an array; arrays broadcast to the shape of the actuators. All solutions lie on the branch of stable
    equilibria connected to zero pressure. Equations: ``docs/explanation/model.md``, after Xu et al. 2024, eq. (1) to (13).

    Attributes:
        motion: ``"extension"``, ``"expansion"``, ``"bending"`` or ``"twisting"``.
        inner_radius_m: Inner radius, m, > 0.
        outer_radius_m: Outer radius, m, > ``inner_radius_m``.
        length_m: Length, m, > 0.
        material: A :class:`NeoHookean`, a :class:`Yeoh`, or trade names of castable elastomers.
        fiber: The winding, or a pair of windings of a straight tube. None: a bare tube; for bending, wound at the outer radius.

    Raises:
        InvalidParameter: A value is not accepted.
        ValueError: Arrays do not broadcast, or a trade name is not known.
    """

    motion: NameLike
    inner_radius_m: FloatLike
    outer_radius_m: FloatLike
    length_m: FloatLike
    material: MaterialLike
    fiber: Fiber | Sequence[Fiber] | None = None
    _built: _native.Actuators = field(init=False, repr=False)
    _shape: tuple[int, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        of_tube = (self.motion, self.inner_radius_m, self.outer_radius_m, self.length_m)
        fields = columns(*of_tube, self.material, self.fiber)
        object.__setattr__(self, "_built", built(fields))
        object.__setattr__(self, "_shape", fields.shape)
        for name in ("motion", "inner_radius_m", "outer_radius_m", "length_m", "material"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of actuators; ``()`` for one actuator."""
        return self._shape

    @property
    def size(self) -> int:
        """Number of actuators."""
        return len(self._built)

    def forward(
        self,
        pressure_pa: FloatLike,
        *,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
        model: ModelName = "auto",
        tolerance: float = 0.005,
    ) -> Solution:
        """Equilibria at gauge pressures.

        Args:
            pressure_pa: Gauge pressure, Pa; negative is vacuum. Broadcasts against the actuators.
            external_force_n: Axial force on the free end, N; tension is positive. Broadcasts against the actuators.
            external_torque_nm: Torque about the axis, N m; on a bending actuator the bending moment in the sense of the bend. Broadcasts
                against the actuators.
            model: ``"analytic"``, ``"section-fe"`` (finite elements of the cross-section), or ``"auto"``: finite elements for bending
                actuators whose analytic bend may be off by more than ``tolerance``.
            tolerance: Relative error of the bend that the analytic model may have, for ``"auto"``; > 0.

        Returns:
            The equilibria, in the shape to which pressures, loads and actuators broadcast.

        Raises:
            InvalidParameter: A value is not accepted.
            ValueError: Arrays do not broadcast.
        """
        arguments = {"pressure_pa": floats("pressure_pa", pressure_pa), **loads(external_force_n, external_torque_nm)}
        order, tolerance = Order(self._shape, arguments), _tolerance(tolerance)
        try:
            answer = self._built.forward(order["pressure_pa"], order.loads(), model, tolerance)
        except _native.Refused as refused:
            raise order.error(refused) from None
        return _solution(order, answer)

    @staticmethod
    def forward_once(
        pressure_pa: FloatLike,
        *,
        motion: NameLike,
        inner_radius_m: FloatLike,
        outer_radius_m: FloatLike,
        length_m: FloatLike,
        material: MaterialLike,
        fiber: Fiber | Sequence[Fiber] | None = None,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
        model: ModelName = "auto",
        tolerance: float = 0.005,
    ) -> Solution:
        """Equilibria of actuators that are solved only once.

        The answers are those of ``Actuator(...).forward(...)`` up to rounding. Straight actuators with at most one winding are not built, which
        takes less time and memory.

        Args:
            pressure_pa: Gauge pressure, Pa, as in :meth:`forward`, like loads, model and tolerance. Broadcasts against the fields.
            motion: As the attribute, like the other fields.

        Returns:
            The equilibria, in the shape to which pressures, loads and fields broadcast.

        Raises:
            InvalidParameter: A value is not accepted.
            ValueError: Arrays do not broadcast, or a trade name is not known.
        """
        arguments = {"pressure_pa": floats("pressure_pa", pressure_pa), **loads(external_force_n, external_torque_nm)}
        fields = columns(motion, inner_radius_m, outer_radius_m, length_m, material, fiber, arguments)
        order, tolerance = Order(fields.shape, arguments), _tolerance(tolerance)
        try:
            if fields.bends or fields.is_pair or model == "section-fe":
                answer = built(fields).forward(order["pressure_pa"], order.loads(), model, tolerance)
            else:
                tubes = fields.count, fields.tube, fields.windings, fields.stretch_max
                answer = _native.forward_once(*tubes, order["pressure_pa"], order.loads())
        except _native.Refused as refused:
            of_field = refused.args[0] not in arguments
            raise (fields.error(refused) if of_field else order.error(refused)) from None
        return _solution(order, answer)

    def inverse(
        self,
        *,
        axial_stretch: FloatLike | None = None,
        outer_radius_m: FloatLike | None = None,
        inner_radius_m: FloatLike | None = None,
        twist_rad: FloatLike | None = None,
        bend_angle_rad: FloatLike | None = None,
        pressure_range_pa: tuple[float, float] | None = None,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
        model: ModelName = "auto",
        tolerance: float = 0.005,
    ) -> Solution:
        """Gauge pressures that reach deformations, and the equilibria there.

        The answer is the first pressure on raising it from zero, and a vacuum only if no pressure reaches the target.

        Args:
            axial_stretch: Target stretch, > 0. Give exactly one target; it broadcasts against the actuators.
            outer_radius_m: Target outer radius, m, > 0.
            inner_radius_m: Target inner radius, m, > 0.
            twist_rad: Target twist, rad.
            bend_angle_rad: Target bend angle, rad, >= 0, of bending actuators.
            pressure_range_pa: Least and largest gauge pressure that may answer, Pa; default -101 325 Pa and everything above.
            external_force_n: As in :meth:`forward`, like the others.

        Returns:
            The equilibria, in the shape to which targets, loads and actuators broadcast.

        Raises:
            InvalidParameter: A value is not accepted, or the motion does not have this deformation.
            TypeError: Not exactly one target.
            ValueError: Arrays do not broadcast.
        """
        name, value = only(
            axial_stretch=axial_stretch,
            outer_radius_m=outer_radius_m,
            inner_radius_m=inner_radius_m,
            twist_rad=twist_rad,
            bend_angle_rad=bend_angle_rad,
        )
        order = Order(self._shape, {name: floats(name, value), **loads(external_force_n, external_torque_nm)})
        tolerance = _tolerance(tolerance)
        try:
            answer = self._built.inverse(name, order[name], order.loads(), pressure_range_pa, model, tolerance)
        except _native.Refused as refused:
            raise order.error(refused) from None
        return _solution(order, answer)

    def inverse_all(
        self,
        *,
        axial_stretch: FloatLike | None = None,
        outer_radius_m: FloatLike | None = None,
        inner_radius_m: FloatLike | None = None,
        twist_rad: FloatLike | None = None,
        bend_angle_rad: FloatLike | None = None,
        pressure_range_pa: tuple[float, float] | None = None,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
    ) -> Solutions:
        """All gauge pressures in a range that reach deformations, by the analytic model, and the equilibria there.

        Pressures come before vacuums, each in the order in which they are met from zero. Two solutions that rounding cannot tell apart, next to a
        turning point, count as one.

        Args:
            axial_stretch: As in :meth:`inverse`, like the others.

        Returns:
            The equilibria along a last axis, in the shape to which targets, loads and actuators broadcast before it.

        Raises:
            InvalidParameter: A value is not accepted, or the motion does not have this deformation.
            TypeError: Not exactly one target.
            ValueError: Arrays do not broadcast.
        """
        name, value = only(
            axial_stretch=axial_stretch,
            outer_radius_m=outer_radius_m,
            inner_radius_m=inner_radius_m,
            twist_rad=twist_rad,
            bend_angle_rad=bend_angle_rad,
        )
        order = Order(self._shape, {name: floats(name, value), **loads(external_force_n, external_torque_nm)})
        try:
            answer = self._built.inverse_all(name, order[name], order.loads(), pressure_range_pa)
        except _native.Refused as refused:
            raise order.error(refused) from None
        [complete], count, columns = answer
        filled = np.arange(count.max(initial=0)) < count.reshape(-1, 1)

        def padded(column: Floats) -> Floats:
            table = np.full(filled.shape, np.nan)
            table[filled] = column
            parts = [order.back(np.ascontiguousarray(part)) for part in table.T]
            return np.stack(parts, axis=-1) if parts else np.empty((*order.shape, 0))

        return Solutions(order.back(count), order.back(complete).astype(bool), *(padded(column) for column in columns))

    def sensitivity(
        self,
        of: InputName,
        *,
        pressure_pa: FloatLike | None = None,
        axial_stretch: FloatLike | None = None,
        outer_radius_m: FloatLike | None = None,
        inner_radius_m: FloatLike | None = None,
        twist_rad: FloatLike | None = None,
        bend_angle_rad: FloatLike | None = None,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
    ) -> Sensitivity:
        """Exact derivatives of equilibria by one input, of the analytic model, by the implicit function theorem.

        With ``pressure_pa`` the pressure stays the same while the input changes. With a deformation that stays the same, and the
        pressure follows: ``pressure_pa`` of the answer is its derivative. By ``outer_radius_m`` the radius of a sheet whose ``radius_m`` is None
        follows, too.

        Args:
            of: The input, such as ``"fiber.angle_rad"``; of a pair of windings ``"fiber[0].angle_rad"`` and ``"fiber[1].angle_rad"``.
            pressure_pa: Gauge pressure, Pa. Give exactly one of this and the targets of :meth:`inverse`.
            external_force_n: As in :meth:`forward`, like ``external_torque_nm``.

        Returns:
            Derivatives per unit of the input, in the shape to which arguments and actuators broadcast.

        Raises:
            InvalidParameter: A value is not accepted, or ``of`` is no input of every actuator: a bare tube has no fiber angle.
            TypeError: Not exactly one of pressure and targets.
            ValueError: Arrays do not broadcast.
        """
        name, value = only(
            pressure_pa=pressure_pa,
            axial_stretch=axial_stretch,
            outer_radius_m=outer_radius_m,
            inner_radius_m=inner_radius_m,
            twist_rad=twist_rad,
            bend_angle_rad=bend_angle_rad,
        )
        if of not in _INPUTS:
            raise InvalidParameter("of", of, ", ".join(_INPUTS))
        order = Order(self._shape, {name: floats(name, value), **loads(external_force_n, external_torque_nm)})

        def by(one: str) -> tuple[Any, list[Floats]]:
            try:
                [status], _, numbers = self._built.sensitivity(_INPUTS[one], name, order[name], order.loads())
            except _native.Refused as refused:
                raise order.error(refused, of=one) from None
            return status, list(numbers)

        status, numbers = by(of)
        for radius in self._radii_that_follow() if of == "outer_radius_m" else ():
            numbers = [own + more for own, more in zip(numbers, by(radius)[1], strict=True)]
        return Sensitivity(order.back(status), *(order.back(column) for column in numbers))

    def _radii_that_follow(self) -> list[str]:
        """The winding radii that are those of the actuator's outside."""
        if self.fiber is None:
            return []
        alone = isinstance(self.fiber, Fiber)
        windings = [self.fiber] if isinstance(self.fiber, Fiber) else list(self.fiber)
        names = ["fiber.radius_m"] if alone else [f"fiber[{index}].radius_m" for index in range(len(windings))]
        pairs = zip(names, windings, strict=True)
        return [name for name, fiber in pairs if fiber.radius_m is None and np.all(np.asarray(fiber.placement) == "sheet")]

    def winding_effect(
        self,
        pressure_pa: FloatLike,
        *,
        error_rad: float = WINDING_ERROR_RAD,
        external_force_n: FloatLike = 0.0,
        external_torque_nm: FloatLike = 0.0,
    ) -> Floats:
        """Largest relative change of the bends of wound benders if the winding is off by an angle, nearer to the hoop or farther from it.

        Finite elements of the cross-section give all bends, three for each answer.

        Args:
            pressure_pa: Gauge pressure, Pa; not 0. Broadcasts against the actuators.
            error_rad: Error of the winding angle, rad, > 0; 2 deg by default.
            external_force_n: As in :meth:`forward`.
            external_torque_nm: As in :meth:`forward`.

        Returns:
            The change over the bend, in the shape to which pressures, loads and actuators broadcast; NaN where one of the three has no solution.

        Raises:
            InvalidParameter: A value is not accepted.
            ValueError: An actuator does not bend or has no winding, or arrays do not broadcast.
        """
        winding = self.fiber
        if not isinstance(winding, Fiber) or np.any(np.asarray(self.motion) != "bending"):
            raise ValueError("winding_effect is for bending actuators with a winding")

        if np.any(np.asarray(pressure_pa) == 0.0):
            raise InvalidParameter("pressure_pa", 0.0, "not 0: nothing bends there")

        def bend(error: float) -> Floats:
            turned = replace(winding, angle_rad=_turned(winding.angle_rad, error))
            bent = replace(self, fiber=turned).forward(
                pressure_pa,
                external_force_n=external_force_n,
                external_torque_nm=external_torque_nm,
                model="section-fe",
            )
            return bent.bend_angle_rad

        own, nearer, farther = bend(0.0), bend(-error_rad), bend(error_rad)
        effect: Floats = np.maximum(np.abs(nearer / own - 1.0), np.abs(farther / own - 1.0))
        return effect

    def blocked_force(
        self, pressure_pa: FloatLike, *, axial_stretch: FloatLike = 1.0, twist_rad: FloatLike = 0.0
    ) -> Blocked:
        """Force and torque on the blocked end of straight actuators, with stiffness and lever arms of the pressure.

        Args:
            pressure_pa: Gauge pressure, Pa. Broadcasts against the actuators, like the others.
            axial_stretch: Stretch at which the end is blocked, > 0.
            twist_rad: Twist at which the end is blocked, rad.

        Returns:
            Loads in the shape to which arguments and actuators broadcast.

        Raises:
            InvalidParameter: A value is not accepted, or an actuator bends.
            ValueError: Arrays do not broadcast.
        """
        given = {"pressure_pa": pressure_pa, "axial_stretch": axial_stretch, "twist_rad": twist_rad}
        order = Order(self._shape, {name: floats(name, value) for name, value in given.items()})
        try:
            [status], _, numbers = self._built.blocked(*(order[name] for name in given))
        except _native.Refused as refused:
            raise order.error(refused) from None
        force, torque, *derivatives, volume = (order.back(column) for column in numbers)
        pair = np.stack(derivatives[:2], axis=-1)
        stiffness = np.stack(derivatives[2:], axis=-1).reshape((*order.shape, 2, 2))
        return Blocked(order.back(status), force, torque, pair, stiffness, volume)

    def __reduce__(self) -> tuple[object, ...]:
        # The built part is not kept: the receiver builds it again.
        return _rebuilt, ({each.name: getattr(self, each.name) for each in fields(self) if each.init},)


def _turned(angle_rad: FloatLike, error_rad: float) -> Floats:
    """Angles farther from the hoop by an error, on either side of it. Beyond the axis it is a winding of the other hand."""
    angles = np.asarray(angle_rad, dtype=np.float64)
    turned = angles + error_rad * np.where(angles < 0.0, -1.0, 1.0)
    return np.where(np.abs(turned) > np.pi / 2, turned - np.pi * np.sign(turned), turned)


def _rebuilt(values: dict[str, object]) -> Actuator:
    return Actuator(**values)  # type: ignore[arg-type]


def only(**targets: FloatLike | None) -> tuple[str, FloatLike]:
    """The one argument that is given."""
    given = [(name, value) for name, value in targets.items() if value is not None]
    if len(given) != 1:
        raise TypeError(f"exactly one of {', '.join(targets)} is needed; {len(given)} are given")
    return given[0]


def _tolerance(tolerance: float) -> float:
    if not (np.isfinite(tolerance) and tolerance > 0):
        raise InvalidParameter("tolerance", tolerance, "finite and > 0")
    return float(tolerance)


def loads(force_n: FloatLike, torque_nm: FloatLike) -> dict[str, Floats]:
    """The loads by name; none where there is none, which is faster."""
    loads = {"external_force_n": force_n, "external_torque_nm": torque_nm}
    if all(isinstance(load, (int, float)) and load == 0 for load in loads.values()):
        return {}
    return {name: floats(name, load) for name, load in loads.items()}


def _solution(order: Order, answer: tuple[list[Codes], npt.NDArray[np.int32], list[Floats]]) -> Solution:
    (status, model, beyond), iterations, numbers = answer
    beyond_test = order.back(beyond).view(np.bool_)
    if beyond_test.any():
        count, all_of_them = np.count_nonzero(beyond_test), beyond_test.size
        text = f"{count} of {all_of_them} walls stretch further than the test behind their law"
        warnings.warn(text, stacklevel=3)
    columns = [order.back(column) for column in numbers]
    return Solution(order.back(status), order.back(model), order.back(iterations), beyond_test, *columns)
