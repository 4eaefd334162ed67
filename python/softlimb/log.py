"""Logs of runs."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from softlimb import _native

if TYPE_CHECKING:
    import pandas
    import xarray

Table = npt.NDArray[np.void]
"""A structured array: one row a message, one field a quantity, whose name ends with the unit."""


class Log(Mapping[str, Table]):
    """A log by its tables, as ``softlimb export --csv`` writes them.

    ``telemetry``, ``setpoint``, ``model``, ``truth``, ``fault``, ``shape``, ``body``, ``body_line``, ``samples``, ``wire`` and ``ticks``
    (``docs/reference/log.md``). A topic without a message has no table. Numbers that are not known are NaN.

    Attributes:
        info: What is known before the run: scene, modules, channels, limits.
        summary: As ``softlimb report --json``: errors of tip and modules, link counters, faults.
        incomplete: Why the log ends early; None for a finished log.
    """

    def __init__(
        self, tables: dict[str, Table], info: dict[str, Any], summary: dict[str, Any], incomplete: str | None
    ) -> None:
        """For :func:`read_log`."""
        self._tables = tables
        self.info = info
        self.summary = summary
        self.incomplete = incomplete

    def __getitem__(self, name: str) -> Table:
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __repr__(self) -> str:
        tables = ", ".join(f"{name} {len(table)}" for name, table in self.items())
        return f"<softlimb.Log of {self.info['scene_name']!r}: {tables}>"

    def frame(self, name: str) -> pandas.DataFrame:
        """A table as a data frame of pandas, which must be installed; ``time_s`` is its index where there is one."""
        import pandas

        frame = pandas.DataFrame(self[name])
        return frame.set_index("time_s") if "time_s" in frame.columns else frame

    def dataset(self, name: str) -> xarray.Dataset:
        """A table as a data set of xarray, which must be installed: variables over ``time_s``, or over ``row`` where there is no such column.

        Variables whose names end with a unit have it as attribute ``units``.
        """
        import xarray

        table = self[name]
        names = list(table.dtype.names or ())
        axis = "time_s" if "time_s" in names else "row"
        variables = {each: (axis, table[each], _units(each)) for each in names if each != axis}
        return xarray.Dataset(variables, {axis: (axis, table[axis], _units(axis))} if axis in names else None)


def read_log(path: str | os.PathLike[str]) -> Log:
    """Reads the log of a run (``run.mcap``).

    A log that was cut off is read up to there, and says why in ``incomplete``.

    Raises:
        LogError: The file cannot be read, or is no log.
    """
    tables, info, summary, incomplete = _native.read_log(Path(path))
    arrays = {name: _structured(columns) for name, columns in tables}
    return Log(arrays, json.loads(info), json.loads(summary), incomplete)


_UNITS = {"pa": "Pa", "m": "m", "s": "s", "rad": "rad", "us": "us"}


def _units(name: str) -> dict[str, str]:
    unit = _UNITS.get(name.rpartition("_")[2])
    return {} if unit is None else {"units": unit}


def _structured(columns: list[tuple[str, npt.NDArray[np.generic] | list[str]]]) -> Table:
    """One structured array of columns; words are objects."""
    arrays = [np.asarray(values, dtype=object if isinstance(values, list) else None) for _, values in columns]
    dtype = np.dtype([(name, array.dtype) for (name, _), array in zip(columns, arrays, strict=True)])
    table = np.empty(len(arrays[0]), dtype=dtype)
    for (name, _), array in zip(columns, arrays, strict=True):
        table[name] = array
    return table
