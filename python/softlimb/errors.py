"""Errors of the package."""

from __future__ import annotations

from dataclasses import dataclass


class InvalidParameter(ValueError):
    """A value that the model does not accept.

    Attributes:
        field: Name of the field or argument, with its unit: ``"outer_radius_m"``, ``"fiber.angle_rad"``.
        index: Index of the element in its array; ``()`` for a scalar.
        value: The value found.
        allowed: Accepted values.
    """

    def __init__(self, field: str, value: object, allowed: str, index: tuple[int, ...] = ()) -> None:
        super().__init__(field, value, allowed, index)
        self.field = field
        self.index = index
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        place = f"[{', '.join(map(str, self.index))}]" if self.index else ""
        value = f"{self.value:.12g}" if isinstance(self.value, float) else repr(self.value)
        return f"{self.field}{place} = {value} is not allowed: {self.allowed}"


@dataclass(frozen=True)
class Diagnostic:
    """One problem of a scene.

    Attributes:
        message: The problem.
        line: Line of the scene, from 1; None where it is of no line.
        column: Column, in characters from 1; None where it is of no line.
        label: The words beside the underlined place.
        help: A remedy.
    """

    message: str
    line: int | None
    column: int | None
    label: str | None
    help: str | None


class SceneError(ValueError):
    """A scene that cannot be read, or that asks for what its limb cannot do. Its text draws the lines of the file.

    Attributes:
        diagnostics: Every problem found, in the order of the text.
    """

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...]) -> None:
        super().__init__(text, diagnostics)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        return str(self.args[0])


class RunError(RuntimeError):
    """A computation that has no result: no equilibrium, a run that did not begin or did not end well."""


class LogError(ValueError):
    """A file that is no log, or cannot be read."""


class CommandError(RuntimeError):
    """A command that failed. Its text is the one of the command.

    Attributes:
        code: Exit code: 1 failed, 2 wrong words.
    """

    def __init__(self, text: str, code: int) -> None:
        super().__init__(text, code)
        self.code = code

    def __str__(self) -> str:
        return str(self.args[0])


def scene_error(text: str, diagnostics: list[tuple[str, int | None, int | None, str | None, str | None]]) -> SceneError:
    """The error of the native part."""
    return SceneError(text, tuple(Diagnostic(*diagnostic) for diagnostic in diagnostics))
