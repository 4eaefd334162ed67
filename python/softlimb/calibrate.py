"""Parameters from measurements, as arrays or data frames."""

from __future__ import annotations

import csv
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from softlimb.cli import command
from softlimb.errors import InvalidParameter


class Frame(Protocol):
    """A data frame: of pandas, or another with ``columns`` and columns by name."""

    @property
    def columns(self) -> Any:
        """Names of the columns."""

    def __getitem__(self, name: str, /) -> Any:
        """A column."""


Measurements: TypeAlias = "Mapping[str, npt.ArrayLike] | Frame"
"""Columns by name: a dictionary of arrays, or a data frame. A scalar stands for a column of it."""


def calibrate_pressure(
    data: Measurements,
    scene: str | os.PathLike[str],
    *,
    fit: Sequence[str],
    per: str = "part",
    accuracy: float = 0.002,
    confidence: float = 0.95,
    write: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Fits actuators to pressures and deformations. As ``softlimb calibrate pressure --json``.

    Args:
        data: Columns ``module``, ``pressure_pa`` (gauge) and one or more of ``axial_stretch``, ``outer_radius_m``, ``bend_angle_rad``,
            ``twist_rad``, with NaN or ``None`` where nothing was measured; optionally ``specimen``. Other units by the name of the column: ``pressure_kpa``, ``bend_angle_deg``.
        scene: The scene file that describes the actuators.
        fit: Properties to find: ``"shear_modulus"``, ``"fiber_angle"``, ``"pressure_offset"`` ...
        per: One value for each ``"part"`` (material or winding), or for each ``"module"``.
        accuracy: Accuracy of a measurement over the largest one of its kind, > 0.
        confidence: Share of intervals that hold the true value, 0 to 1.
        write: File for the scene with the values found.

    Returns:
        Values with intervals, residuals, and ``warnings``.

    Raises:
        CommandError: A row, column or property is not accepted, or the data do not determine the properties.
    """
    options = ["--scene", os.fspath(scene), "--fit", ",".join(fit), "--per", per]
    return _fitted("pressure", data, options, accuracy, confidence, write)


def calibrate_tension(data: Measurements, *, law: str = "yeoh", accuracy: float = 0.002, confidence: float = 0.95) -> dict[str, Any]:
    """Fits an elastomer to a tensile test. As ``softlimb calibrate tension --json``.

    Args:
        data: Columns of a strain or stretch and of a nominal stress: ``strain`` or ``stretch``, ``nominal_stress_pa`` or ``..._kpa``.
        law: ``"neo-hookean"`` or ``"yeoh"``.
        accuracy: As of :func:`calibrate_pressure`.
        confidence: As of :func:`calibrate_pressure`.

    Raises:
        CommandError: A row or column is not accepted, or the data do not determine the law.
    """
    return _fitted("tension", data, ["--law", law], accuracy, confidence, None)


def _fitted(
    mode: str,
    data: Measurements,
    options: list[str],
    accuracy: float,
    confidence: float,
    write: str | os.PathLike[str] | None,
) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "measurements.csv"
        _write(file, data)
        words = ["calibrate", mode, str(file), *options, "--accuracy", repr(accuracy), "--confidence", repr(confidence)]
        written = [] if write is None else ["--write", os.fspath(write)]
        found: dict[str, Any] = command(*words, *written, "--json").json()
        return found


def _write(file: Path, data: Measurements) -> None:
    """Writes columns; numbers read back exactly."""
    names = [str(name) for name in (data if isinstance(data, Mapping) else data.columns)]
    if not names:
        raise InvalidParameter("data", 0, "one column or more")
    columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(data[name])) for name in names))
    with file.open("w", newline="", encoding="utf-8") as text:
        rows = csv.writer(text)
        rows.writerow(names)
        rows.writerows(zip(*([_cell(value) for value in column.tolist()] for column in columns), strict=True))


def _cell(value: Any) -> Any:
    """A value as the table has it: what data frames hold where nothing was measured is an empty cell."""
    return "" if isinstance(value, float) and np.isnan(value) else value
