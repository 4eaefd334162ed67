"""Results of the actuator model."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from softlimb.arrays import Codes, Floats, Ints


class Status(IntEnum):
    """Outcome of a solve."""

    OK = 0
    """The equilibrium, on the branch connected to zero pressure."""
    NO_SOLUTION = 1
    """That branch ends before the requested pressure or target."""
    NOT_CONVERGED = 2
    """The solver gave up, or double precision does not hold a number of the answer."""
    NO_DERIVATIVE = 3
    """An equilibrium at a limit point, or a target that stands still: its derivatives are infinite."""


class Model(IntEnum):
    """Model that answered."""

    ANALYTIC = 0
    SECTION_FE = 1
    """Finite elements of the cross-section."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Equilibria. All fields are arrays of one shape; without a solution the numbers of the state are NaN.

    Attributes:
        status: Codes of :class:`Status`.
        model: Codes of :class:`Model`.
        iterations: Evaluations of the model's equations.
        beyond_test: Whether the wall of a named elastomer stretches further than the test behind its law.
        pressure_pa: Gauge pressure, Pa.
        axial_stretch: Deformed over undeformed length; of a bending actuator, of its axis.
        inner_radius_m: Deformed inner radius, m; bending: of a circle of the lumen's mean area.
        outer_radius_m: Deformed outer radius, m; bending: of a circle of the cross-section's mean area.
        twist_rad: Twist of one end against the other, rad; 0 for bending.
        bend_angle_rad: Bend angle, rad; 0 for straight tubes.
        volume_m3: Lumen volume, m3.
        compliance_m3_per_pa: Derivative of the volume by the pressure at constant load, m3/Pa.
        limit_pressure_pa: Without a solution, the pressure at which the branch ends, Pa; NaN where it ends at none.
        residual: Largest error of the equations, in units of the shear modulus; NaN from finite elements.
        model_error: Upper estimate of the bend's relative difference from finite elements; 0 from finite elements and for straight tubes;
            NaN where no estimate holds.
        discretisation_error: Estimated relative distance from the answer of infinitely many elements; 0 from the analytic model.
    """

    status: Codes
    model: Codes
    iterations: Ints
    beyond_test: npt.NDArray[np.bool_]
    pressure_pa: Floats
    axial_stretch: Floats
    inner_radius_m: Floats
    outer_radius_m: Floats
    twist_rad: Floats
    bend_angle_rad: Floats
    volume_m3: Floats
    compliance_m3_per_pa: Floats
    limit_pressure_pa: Floats
    residual: Floats
    model_error: Floats
    discretisation_error: Floats

    @property
    def ok(self) -> npt.NDArray[np.bool_]:
        """Where there is an equilibrium."""
        return np.asarray(self.status == Status.OK)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of every field."""
        return self.status.shape


@dataclass(frozen=True, eq=False)
class Solutions:
    """Several equilibria of each target. Numbers are arrays of shape ``(..., k)``, ``k`` the largest count; behind the last solution they are NaN.

    Attributes:
        count: Number of solutions; shape ``(...)``.
        complete: False where the solver gave up before the ends of the branch or of the range; shape ``(...)``.
        pressure_pa: Gauge pressure, Pa.
        axial_stretch: As of :class:`Solution`, like the others.
    """

    count: Ints
    complete: npt.NDArray[np.bool_]
    pressure_pa: Floats
    axial_stretch: Floats
    inner_radius_m: Floats
    outer_radius_m: Floats
    twist_rad: Floats
    bend_angle_rad: Floats
    volume_m3: Floats
    compliance_m3_per_pa: Floats


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of the fields of a :class:`Solution` by one input, per unit of the input. All fields are arrays of one shape.

    Attributes:
        status: Codes of :class:`Status`; other than OK the derivatives are NaN.
        pressure_pa: Of the gauge pressure; 0 where the pressure is kept, 1 by itself.
        axial_stretch: Of the stretch.
        inner_radius_m: Of the deformed inner radius.
        outer_radius_m: Of the deformed outer radius.
        twist_rad: Of the twist.
        bend_angle_rad: Of the bend angle.
        volume_m3: Of the lumen volume.
        compliance_m3_per_pa: Of the compliance.
    """

    status: Codes
    pressure_pa: Floats
    axial_stretch: Floats
    inner_radius_m: Floats
    outer_radius_m: Floats
    twist_rad: Floats
    bend_angle_rad: Floats
    volume_m3: Floats
    compliance_m3_per_pa: Floats


@dataclass(frozen=True, eq=False)
class Blocked:
    """Loads on the free end of actuators whose ends are blocked. The actuator pushes and turns with their opposites.

    Attributes:
        status: Codes of :class:`Status`; without a solution the numbers are NaN.
        force_n: Axial force, N; tension is positive.
        torque_nm: Torque about the axis, N m.
        by_pressure: Derivative of (force, torque) by the pressure, m2 and m3; shape ``(..., 2)``.
        stiffness: Derivative of (force, torque) by (length, twist), N/m, N, N m/m and N m/rad; shape ``(..., 2, 2)``.
        volume_m3: Lumen volume, m3.
    """

    status: Codes
    force_n: Floats
    torque_nm: Floats
    by_pressure: Floats
    stiffness: Floats
    volume_m3: Floats
