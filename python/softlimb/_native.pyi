from pathlib import Path
from typing import TypeAlias, final

import numpy as np
import numpy.typing as npt

_Floats: TypeAlias = npt.NDArray[np.float64]
_Codes: TypeAlias = npt.NDArray[np.int8]
_Arrays: TypeAlias = tuple[list[_Codes], npt.NDArray[np.int32], list[_Floats]]
_Observed: TypeAlias = tuple[
    float, str, bool, bool, str | None, list[str], list[_Floats], tuple[float, list[tuple[str, list[float]]]], float
]
_Elastomer: TypeAlias = tuple[str, list[float], list[float]]

__all__ = [
    "Actuators",
    "Refused",
    "Scene",
    "Session",
    "__version__",
    "castable_elastomer",
    "castable_elastomers",
    "forward_once",
    "main",
    "read_log",
    "read_study",
    "solve_series",
]

__version__: str

class Refused(ValueError): ...

@final
class Actuators:
    def __new__(
        cls,
        rows: int,
        tube: tuple[npt.NDArray[np.generic], ...],
        windings: list[tuple[npt.NDArray[np.generic], ...]],
        stretch_max: npt.NDArray[np.generic] | None,
    ) -> Actuators: ...
    def __len__(self) -> int: ...
    def forward(
        self, pressures_pa: _Floats, loads: tuple[_Floats, _Floats] | None, model: str, tolerance: float
    ) -> _Arrays: ...
    def inverse(
        self,
        quantity: str,
        targets: _Floats,
        loads: tuple[_Floats, _Floats] | None,
        range_pa: tuple[float, float] | None,
        model: str,
        tolerance: float,
    ) -> _Arrays: ...
    def inverse_all(
        self,
        quantity: str,
        targets: _Floats,
        loads: tuple[_Floats, _Floats] | None,
        range_pa: tuple[float, float] | None,
    ) -> _Arrays: ...
    def sensitivity(
        self, of: str, quantity: str, given: _Floats, loads: tuple[_Floats, _Floats] | None
    ) -> _Arrays: ...
    def blocked(self, pressures_pa: _Floats, stretches: _Floats, twists_rad: _Floats) -> _Arrays: ...

def forward_once(
    rows: int,
    tube: tuple[npt.NDArray[np.generic], ...],
    windings: list[tuple[npt.NDArray[np.generic], ...]],
    stretch_max: npt.NDArray[np.generic] | None,
    pressures_pa: _Floats,
    loads: tuple[_Floats, _Floats] | None,
) -> _Arrays: ...
def castable_elastomers() -> list[_Elastomer]: ...
def castable_elastomer(name: str) -> _Elastomer: ...

@final
class Scene:
    @staticmethod
    def load(path: Path) -> Scene: ...
    @staticmethod
    def parse(text: str, name: str) -> Scene: ...
    def name(self) -> str: ...
    def drives(self) -> list[tuple[str, str]]: ...
    def ranges(self) -> list[tuple[float, float]]: ...
    def description(self) -> tuple[str, list[tuple[str, list[float]]]]: ...
    def check(self) -> str: ...
    def plan(self) -> tuple[tuple[_Floats, _Floats, _Floats, _Floats], list[str]]: ...
    def statics(self, payload_kg: float | None, spacers: int | None, tolerance: float) -> tuple[str, list[str]]: ...
    def workspace(
        self,
        each_actuator: bool,
        samples: int,
        points: str,
        seed: int,
        cell_m: float,
        loaded: tuple[float, int | None] | None,
    ) -> tuple[str, _Floats]: ...
    def run(
        self, out: Path, seed: int | None, plant: Scene | None, link_fault: str | None, faults: list[str]
    ) -> tuple[str, Path, Path]: ...

@final
class Session:
    def __new__(cls, scene: Scene, out: Path, seed: int | None) -> Session: ...
    def begin(self) -> _Observed: ...
    def step(self, until_s: float, setpoints: list[float] | None, gripping: bool | None) -> _Observed: ...
    def vent(self) -> _Observed: ...
    def close(self) -> tuple[str, Path, Path]: ...

def main(words: list[str]) -> int: ...
def solve_series(
    segments: list[tuple[Actuators, npt.NDArray[np.int64], _Floats]],
    quantity: str,
    given: _Floats,
    loads: tuple[_Floats, _Floats] | None,
) -> _Arrays: ...
def read_study(path: Path) -> tuple[list[str], int]: ...
def read_log(
    path: Path,
) -> tuple[list[tuple[str, list[tuple[str, npt.NDArray[np.generic] | list[str]]]]], str, str, str | None]: ...
