"""Searches for actuators and bundles."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softlimb.arrays import within
from softlimb.cli import command


def design_actuators(problem: Mapping[str, Any], *, seed: int = 1, starts: int = 40) -> dict[str, Any]:
    """Geometry and pressures for target deformations, eq. (14) of the paper. As ``softlimb design actuators --json``.

    Args:
        problem: The problem (``docs/reference/actuator-problem.md``), of dictionaries, lists and arrays. NaN is no target.
        seed: Seed of the starting points.
        starts: Most local solves, >= 1.

    Returns:
        The geometry and pressures of each segment, and the objective.

    Raises:
        InvalidParameter: ``starts`` is out of its range.
        CommandError: A field of the problem is not accepted.
    """
    within("starts", starts, 1, 1_000_000)
    return _designed("actuators", problem, ["--seed", str(seed), "--starts", str(starts)])


def design_bundle(problem: Mapping[str, Any], *, seed: int = 1) -> dict[str, Any]:
    """A bundle of actuators for target forces and moments, eq. (18) of the paper. As ``softlimb design bundle --json``.

    Args:
        problem: The problem (``docs/reference/bundle-problem.md``), of dictionaries, lists and arrays.
        seed: Seed of the starting points.

    Returns:
        The actuators, their places and pressures, and the objective.

    Raises:
        CommandError: A field of the problem is not accepted.
    """
    return _designed("bundle", problem, ["--seed", str(seed)])


def _designed(mode: str, problem: Mapping[str, Any], options: list[str]) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "problem.json"
        file.write_text(json.dumps(_plain(problem), indent=1), encoding="utf-8")
        found: dict[str, Any] = command("design", mode, os.fspath(file), *options, "--json").json()
        return found


def _plain(value: Any) -> Any:
    """The value of dictionaries, lists, numbers and words alone; None in place of NaN."""
    if isinstance(value, Mapping):
        return {str(name): _plain(field) for name, field in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and math.isnan(value) else value
