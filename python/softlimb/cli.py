"""The command ``softlimb``, called from Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from softlimb.errors import CommandError


@dataclass(frozen=True)
class CommandResult:
    """What a command has printed.

    Attributes:
        output: Standard output.
        messages: Standard error: warnings, and names of written files.
        warned: Whether it ended with warnings, exit code 3.
    """

    output: str
    messages: str
    warned: bool

    def json(self) -> Any:
        """The output of ``--json``."""
        return json.loads(self.output)


def command(*words: str | os.PathLike[str], cwd: str | os.PathLike[str] | None = None) -> CommandResult:
    """Runs a verb of the command in a process of its own: ``command("design", "limb", "scene.toml", "--json")``.

    Args:
        words: The words behind ``softlimb``.
        cwd: Folder in which it runs; default the current one.

    Raises:
        CommandError: The command failed, with its message.
    """
    package = Path(__file__).parents[1]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(package), os.environ.get("PYTHONPATH", "")])}
    program = [sys.executable, "-m", "softlimb", *(os.fspath(word) for word in words)]
    done = subprocess.run(program, cwd=cwd, env=environment, capture_output=True, text=True, encoding="utf-8")
    if done.returncode not in (0, 3):
        raise CommandError(done.stderr.strip(), done.returncode)
    return CommandResult(done.stdout, done.stderr, done.returncode == 3)
