"""Errors of the package."""

from __future__ import annotations


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
