"""A limb on the simulated device, led step by step."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.arrays import SEED_MAX, FloatLike, Floats, floats, within
from softlimb.errors import InvalidParameter

if TYPE_CHECKING:
    from softlimb.scene import Result

_STEP_MAX_S = 600.0

Pose: TypeAlias = tuple[float, ...]
"""Position, m, and quaternion x, y, z, w: seven numbers."""


@dataclass(frozen=True, eq=False)
class Observation:
    """The limb at one instant: measurements of the device, its model, and the true limb of the simulation.

    Attributes:
        time_s: Time since the start of the session, s.
        state: State of the device, such as ``"running"``.
        setpoint: Setpoints; shape ``(d,)``, quantities as of :class:`Plan`.
        modelled: The same by the model at the chamber pressures.
        achieved: The same of the simulated limb; NaN where it has fallen.
        pressure_pa: Measured gauge pressures, Pa; one a channel.
        reference_pa: Gauge pressures that the device tracks, Pa.
        tip_setpoint_m: Tip of the setpoints, m; shape ``(3,)``.
        tip_modelled_m: Tip of the model, m.
        tip_achieved_m: Tip of the simulated limb, m; NaN where it has fallen.
        gripping: Whether the gripper is commanded to close.
        is_moving: Whether setpoints change.
        refusal: Reason for which the last setpoints or the last command to the gripper were refused; None if they were accepted.
        faults: Faults of the device so far, in words.
        clearance_m: Distance from the nearest obstacle, m; NaN without obstacles.
        frames_time_s: Time of clearance and frames, s: they are observed at 10 Hz.
        frames: Poses in the frame ``world``: position, m, and quaternion x, y, z, w. Names as in ``docs/reference/log.md``.
    """

    time_s: float
    state: str
    setpoint: Floats
    modelled: Floats
    achieved: Floats
    pressure_pa: Floats
    reference_pa: Floats
    tip_setpoint_m: Floats
    tip_modelled_m: Floats
    tip_achieved_m: Floats
    gripping: bool
    is_moving: bool
    refusal: str | None
    faults: tuple[str, ...]
    clearance_m: float
    frames_time_s: float
    frames: dict[str, Pose]


class Session:
    """A limb on the simulated device, led step by step in virtual time. As ``softlimb jog``, with setpoints in place of keys.

    Every move is checked before it begins: pressures, obstacles, stability under load. A move that would violate one of them is refused, and the limb
    holds. The same scene, seed and steps give the same bits. A session ends with :meth:`close`, or as a context manager.

    Attributes:
        drives: Names of the setpoints.
        quantities: Quantity of each setpoint, such as ``"bend_angle_rad"``.
        setpoint_range: Setpoints at rest and at the highest pressure; shape ``(d, 2)``. Under load the highest accepted ones are lower.
        observation: The limb after the last step.
    """

    def __init__(self, scene: _native.Scene, out: str | os.PathLike[str] | None, seed: int | None) -> None:
        """For :meth:`Scene.session`."""
        drives = scene.drives()
        self.drives = tuple(name for name, _ in drives)
        self.quantities = tuple(quantity for _, quantity in drives)
        self.setpoint_range: npt.NDArray[np.float64] = np.array(scene.ranges())
        within("seed", seed, 0, SEED_MAX)
        self._unlogged = tempfile.TemporaryDirectory(prefix="softlimb-") if out is None else None
        folder = Path(self._unlogged.name if self._unlogged is not None else os.fspath(out or "."))
        self._native = _native.Session(scene, folder, seed)
        self._closed = False
        self.observation = _observation(self._native.begin())

    def step(
        self, duration_s: float, setpoints: FloatLike | None = None, *, gripping: bool | None = None
    ) -> Observation:
        """Lets time pass; gives new setpoints, or a command to the gripper, at its beginning.

        The drives move along a straight line to the setpoints, as fast as valves, supply and the rates of the scene allow. The move goes on in later
        steps, until other setpoints replace it. A command to the gripper ends it.

        Args:
            duration_s: Time, s: multiples of the period of the telemetry, 20 ms by default, up to 600 s.
            setpoints: One a drive; None leaves them.
            gripping: Whether the gripper is to be closed; None leaves it.

        Returns:
            The limb at the end of the step.

        Raises:
            InvalidParameter: A value is not accepted.
            TypeError: Setpoints and a command to the gripper in one step.
            RunError: The device stopped, or the session is over.
        """
        if not 0.0 < duration_s <= _STEP_MAX_S:
            raise InvalidParameter("duration_s", duration_s, f"above 0, up to {_STEP_MAX_S:g}")
        values = None
        if setpoints is not None:
            if gripping is not None:
                raise TypeError("setpoints or gripping, not both")
            values = self._setpoints(setpoints)
        until_s = self.observation.time_s + duration_s
        self.observation = _observation(self._native.step(until_s, values, gripping))
        return self.observation

    def vent(self) -> Observation:
        """Lets the pressures down, and holds the limb at rest.

        Raises:
            RunError: The device stopped, or the session is over.
        """
        self.observation = _observation(self._native.vent())
        return self.observation

    def close(self) -> Result | None:
        """Lets the pressures down and ends the session.

        Returns:
            The summary as of :meth:`Scene.run`, with the paths ``log`` and ``report``; None where nothing is logged, and for a closed session.

        Raises:
            RunError: The device stopped, or the log was not written.
        """
        if self._closed:
            return None
        self._closed = True
        try:
            text, log, report = self._native.close()
        finally:
            if self._unlogged is not None:
                self._unlogged.cleanup()
        if self._unlogged is not None:
            return None
        summary: dict[str, Any] = json.loads(text)
        return {**summary, "log": Path(log), "report": Path(report)}

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.close()
            return
        try:
            self.close()
        except RuntimeError:
            # The first error is the one to be seen.
            pass

    def _setpoints(self, setpoints: FloatLike) -> list[float]:
        values = floats("setpoints", setpoints)
        if values.shape != (len(self.drives),):
            raise InvalidParameter("setpoints", values.shape, f"shape ({len(self.drives)},): {', '.join(self.drives)}")
        bad = np.flatnonzero(~np.isfinite(values))
        if len(bad):
            index = int(bad[0])
            raise InvalidParameter("setpoints", float(values[index]), "finite", (index,))
        numbers: list[float] = values.tolist()
        return numbers


def posed(frames: list[tuple[str, list[float]]]) -> dict[str, Pose]:
    """Poses by the names of their frames."""
    return {name: tuple(pose) for name, pose in frames}


def _observation(native: _native._Observed) -> Observation:
    time_s, state, gripping, is_moving, refusal, faults, columns, (frames_time_s, frames), clearance_m = native
    setpoint, modelled, achieved, pressure_pa, reference_pa, tip_setpoint_m, tip_modelled_m, tip_achieved_m = columns
    return Observation(
        time_s=time_s,
        state=state,
        setpoint=setpoint,
        modelled=modelled,
        achieved=achieved,
        pressure_pa=pressure_pa,
        reference_pa=reference_pa,
        tip_setpoint_m=tip_setpoint_m,
        tip_modelled_m=tip_modelled_m,
        tip_achieved_m=tip_achieved_m,
        gripping=gripping,
        is_moving=is_moving,
        refusal=refusal,
        faults=tuple(faults),
        clearance_m=clearance_m,
        frames_time_s=frames_time_s,
        frames=posed(frames),
    )
