"""Scenes: a limb, the phases of its task, its pneumatics."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from softlimb import _native
from softlimb.arrays import SEED_MAX, Floats, within
from softlimb.errors import InvalidParameter
from softlimb.session import Pose, Session, posed

Result: TypeAlias = dict[str, Any]
"""A result as ``--json`` of the command prints it: names of fields end with the unit."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Setpoints of a run, at every knot that the device interpolates between.

    Attributes:
        time_s: Times of the knots, s; shape ``(n,)``.
        drives: Names of the setpoints: of a module, or of an actuator of a steering module; ``d`` of them.
        quantities: Quantity of each setpoint, such as ``"bend_angle_rad"``; ``d`` of them.
        setpoint: Setpoints; shape ``(n, d)``.
        pressure_pa: Gauge pressures of the model, Pa; shape ``(n, d)``.
        tip_m: Positions of the tip, m; shape ``(n, 3)``.
        warnings: Moves that are faster than valves or supply, and others.
    """

    time_s: Floats
    drives: tuple[str, ...]
    quantities: tuple[str, ...]
    setpoint: Floats
    pressure_pa: Floats
    tip_m: Floats
    warnings: tuple[str, ...]


class Scene:
    """A scene: checked when it is read, never changed.

    Results are dictionaries with the fields of the command's ``--json`` (``docs/reference/command.md``). Every result has ``warnings``.
    """

    def __init__(self, native: _native.Scene) -> None:
        """For :meth:`load` and :meth:`parse`."""
        self._native = native

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file.

        Raises:
            SceneError: The file cannot be read, or is no scene; ``diagnostics`` names lines and columns.
        """
        return cls(_native.Scene.load(Path(path)))

    @classmethod
    def parse(cls, text: str, name: str = "scene.toml") -> Scene:
        """Reads the text of a scene; ``name`` stands for the file in diagnostics.

        Raises:
            SceneError: As of :meth:`load`.
        """
        return cls(_native.Scene.parse(text, name))

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._native.name()

    def __repr__(self) -> str:
        return f"<softlimb.Scene {self.name!r}>"

    def check(self) -> Result:
        """Checks that the limb reaches every target, clear of obstacles, within its pressures. As ``softlimb check --json``.

        Returns:
            Pressures, margins and clearances of modules and phases.

        Raises:
            SceneError: A target is out of reach.
        """
        return _read(self._native.check())

    def plan(self) -> Plan:
        """Setpoints of the run, corrected for weight.

        Raises:
            SceneError: A target is out of reach.
        """
        (time_s, setpoint, pressure_pa, tip_m), warnings = self._native.plan()
        drives = self._native.drives()
        shape = (len(time_s), len(drives))
        return Plan(
            time_s,
            tuple(name for name, _ in drives),
            tuple(quantity for _, quantity in drives),
            setpoint.reshape(shape),
            pressure_pa.reshape(shape),
            tip_m.reshape(-1, 3),
            tuple(warnings),
        )

    def statics(
        self, *, payload_kg: float | None = None, spacers: int | None = None, tolerance: float = 0.01
    ) -> Result:
        """Deflection, stiffness and margins under weight and a payload, at the end of each phase. As ``softlimb statics --json``.

        Args:
            payload_kg: Mass at the tip, kg, 0 to 100, in place of the phases' own.
            spacers: Plates in each module, 0 to 50, in place of the modules' own.
            tolerance: Largest error of the tip over the limb's length, 1e-5 to 0.5.

        Raises:
            InvalidParameter: A value is out of its range.
            SceneError: A target is out of reach.
            RunError: An actuator has no equilibrium.
        """
        within("payload_kg", payload_kg, 0, 100)
        within("spacers", spacers, 0, 50)
        within("tolerance", tolerance, 1e-5, 0.5)
        text, warnings = self._native.statics(payload_kg, spacers, tolerance)
        return {**_read(text), "warnings": warnings}

    def workspace(
        self,
        *,
        pressures: Literal["actuators", "modules"] = "actuators",
        loaded: bool = False,
        payload_kg: float = 0.0,
        spacers: int | None = None,
        samples: int | None = None,
        points: Literal["faces", "even", "random"] = "faces",
        seed: int = 1,
        cell_m: float | None = None,
    ) -> tuple[Result, npt.NDArray[np.float64]]:
        """Exact extents of the tip, and samples of its workspace. As ``softlimb workspace --json``.

        Args:
            pressures: The free pressures: of each actuator, or of each setpoint.
            loaded: Under the limb's own weight: poses that fall, buckle or bend backwards are not reached.
            payload_kg: Mass at the tip, kg, 0 to 100; only loaded.
            spacers: Plates in each module, 0 to 50; only loaded.
            samples: Number of samples, 1 to 1e8; default 1 000 000, or 4096 loaded.
            points: Low discrepancy with samples at the ends of each pressure, low discrepancy, or independent random numbers.
            seed: Seed of the samples.
            cell_m: Side of the counted cubes, m, 1e-3 to 1; default 0.02, or 0.1 loaded.

        Returns:
            The result, and the tips that are reached, m; shape ``(n, 3)``.

        Raises:
            InvalidParameter: A value is out of its range.
            RunError: The model has no equilibrium at an extreme, or no pose is reached.
        """
        if not loaded and (payload_kg != 0 or spacers is not None):
            raise TypeError("payload_kg and spacers are for loaded=True")
        samples = (4096 if loaded else 1_000_000) if samples is None else samples
        cell_m = (0.1 if loaded else 0.02) if cell_m is None else cell_m
        within("payload_kg", payload_kg, 0, 100)
        within("spacers", spacers, 0, 50)
        within("samples", samples, 1, 100_000_000)
        within("seed", seed, 0, SEED_MAX)
        within("cell_m", cell_m, 1e-3, 1.0)
        _one_of("pressures", pressures, ("actuators", "modules"))
        _one_of("points", points, ("faces", "even", "random"))
        of_load = (payload_kg, spacers) if loaded else None
        text, tips = self._native.workspace(pressures == "actuators", samples, points, seed, cell_m, of_load)
        return _read(text), tips.reshape(-1, 3)

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        seed: int | None = None,
        plant: Scene | None = None,
        link_fault: str | None = None,
        faults: tuple[str, ...] | list[str] = (),
    ) -> Result:
        """Runs the scene on the simulated device. As ``softlimb run --json``; Ctrl-C ends the run.

        Args:
            out: Folder for ``run.mcap`` and ``run.html``; default ``out/NAME``. Files of an earlier run there are replaced.
            seed: Seed of the plant; default that of the scene.
            plant: Scene of the simulated limb and pneumatics; default the scene itself.
            link_fault: Faults of the link, as of the command: ``"loss=0.05,flip=0.01"``.
            faults: Faults of limb, device or link, each as of the command: ``"sensor-frozen@4.5,1"``.

        Returns:
            The summary; ``log`` and ``report`` are the paths of the files.

        Raises:
            SceneError: A target is out of reach.
            RunError: The run did not begin, or did not end well.
            ValueError: A fault is not known.
        """
        within("seed", seed, 0, SEED_MAX)
        folder = Path("out") / self.name if out is None else Path(out)
        native = None if plant is None else plant._native
        text, log, report = self._native.run(folder, seed, native, link_fault, list(faults))
        return {**_read(text), "log": Path(log), "report": Path(report)}

    def session(self, out: str | os.PathLike[str] | None = None, *, seed: int | None = None) -> Session:
        """The limb on the simulated device, led step by step.

        Args:
            out: Folder for ``run.mcap`` and ``run.html``; None logs nothing.
            seed: Seed of the plant; default that of the scene.

        Raises:
            SceneError: The limb at rest is too near an obstacle, or does not stand there.
            RunError: The device does not start.
        """
        return Session(self._native, out, seed)

    def description(self) -> tuple[str, dict[str, Pose]]:
        """The limb as viewers load it.

        Returns:
            URDF (``/robot_description`` of a log), and the frames that do not move: position, m, and quaternion x, y, z, w, by name (``/tf_static``).
        """
        urdf, frames = self._native.description()
        return urdf, posed(frames)


def _read(text: str) -> Result:
    result: Result = json.loads(text)
    return result


def _one_of(field: str, value: str, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise InvalidParameter(field, value, ", ".join(allowed))
