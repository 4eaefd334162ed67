"""Sweeps: the runs of a study, here or on the workers of a cluster."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import warnings
from concurrent.futures import Executor, as_completed
from pathlib import Path
from typing import Any, Protocol

from softlimb import _native
from softlimb.cli import command
from softlimb.errors import InvalidParameter, RunError

_RETRIES = 3
"""How often Dask gives a part to another worker after one has died."""


class Client(Protocol):
    """A client of a cluster: ``distributed.Client`` of Dask."""

    def get_executor(self, *, retries: int) -> Any:
        """Its workers as an executor."""


def sweep(
    study: str | os.PathLike[str],
    client: Client | Executor | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    shards: int = 16,
) -> Path:
    """Runs the scenes of a study on many simulated limbs, and writes one table. As ``softlimb sweep``.

    Without a client, all processors of this computer share the rows. With one, its workers run the parts of the study, each on one processor. They
    need this version of the package, and no access to the files. Finished parts lie in ``FILE.parts``: the same call continues an interrupted sweep.
    The table has the same bytes on all ways, on one type of machine.

    Args:
        study: The study file (``docs/reference/study.md``).
        client: ``distributed.Client`` of Dask, or a ``concurrent.futures.Executor`` whose workers are processes.
        out: The table; default the name of the study, as ``.csv``, in the current folder.
        shards: Number of parts, at least 1. Each plans every design anew; four parts a worker keep all of them busy.

    Returns:
        Path of the table: ``pandas.read_csv(path, skiprows=1)``.

    Raises:
        SceneError: The study or one of its scenes is not accepted.
        InvalidParameter: ``shards`` is below 1, or a scene of a study for workers has an absolute path.
        RunError: A worker has another version of the package.
        CommandError: A table cannot be written.

    Warns:
        UserWarning: Rows without figures; the column ``outcome`` has the reason.
    """
    study = Path(study)
    table = Path(out) if out is not None else Path(study.name).with_suffix(".csv")
    if shards < 1:
        raise InvalidParameter("shards", shards, ">= 1")
    scenes, rows = _native.read_study(study)
    if client is None:
        made = command("sweep", study, "--out", table)
    else:
        parts = _parts(client, _files(study, scenes), min(shards, rows), table)
        made = command("sweep", study, "--out", table, "--merge", *parts)
        shutil.rmtree(parts[0].parent)
        if not any(parts[0].parent.parent.iterdir()):
            parts[0].parent.parent.rmdir()
    if made.warned:
        warnings.warn(made.messages.strip(), stacklevel=2)
    return table


def _files(study: Path, scenes: list[str]) -> dict[str, bytes]:
    """Texts by their paths below the folder that holds them all; the study first."""
    for scene in scenes:
        if Path(scene).is_absolute():
            raise InvalidParameter("scenes", scene, "relative to the study")
    paths = [os.path.normpath(study.resolve().parent / name) for name in (study.name, *scenes)]
    root = os.path.commonpath([os.path.dirname(path) for path in paths])
    return {Path(os.path.relpath(path, root)).as_posix(): Path(path).read_bytes() for path in paths}


def _parts(client: Client | Executor, files: dict[str, bytes], count: int, table: Path) -> list[Path]:
    """The tables of all parts; those of an interrupted sweep are not run again."""
    version = _native.__version__
    known = hashlib.sha256(repr((version, files, count)).encode()).hexdigest()[:16]
    folder = table.with_name(table.name + ".parts") / known
    folder.mkdir(parents=True, exist_ok=True)
    parts = [folder / f"{index}.csv" for index in range(1, count + 1)]
    executor: Executor = client if isinstance(client, Executor) else client.get_executor(retries=_RETRIES)
    missing = [index for index, part in enumerate(parts, 1) if not part.exists()]
    running = {executor.submit(_part, files, index, count, version): parts[index - 1] for index in missing}
    failed: BaseException | None = None
    try:
        for done in as_completed(running):
            error = done.exception()
            if error is None:
                unfinished = running[done].with_suffix(".part")
                unfinished.write_bytes(done.result())
                unfinished.replace(running[done])
            failed = failed or error
    finally:
        for other in running:
            other.cancel()
    if failed is not None:
        raise failed
    return parts


def _part(files: dict[str, bytes], index: int, count: int, version: str) -> bytes:
    """The table of one part, on a worker."""
    if _native.__version__ != version:
        raise RunError(f"a worker has softlimb {_native.__version__}, and this computer {version}")
    study = next(iter(files))
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text)
        command("sweep", study, "--shard", f"{index}/{count}", "--threads", "1", "--out", "part.csv", cwd=folder)
        return Path(folder, "part.csv").read_bytes()
