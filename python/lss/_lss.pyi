"""The extension module, as the package calls it."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

_Tell = Callable[[float, float | None, str], object] | None
_Array = NDArray[np.float64]

class Layout:
    @property
    def name(self) -> str: ...
    @property
    def summary(self) -> str: ...
    @property
    def said(self) -> tuple[str, list[str]]: ...
    @property
    def text(self) -> str | None: ...
    def layout_json(self) -> bytes: ...
    def bom_json(self) -> bytes: ...
    def svg(self) -> str: ...
    def simulation(self) -> Simulation: ...
    def write(self, folder: Path, more: list[str]) -> None: ...

class Capacity:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def html(self, progress: _Tell) -> str: ...

class Simulation:
    @staticmethod
    def of_file(path: Path, layout: str | None, threads_asked: int | None, progress: _Tell) -> Simulation: ...
    @staticmethod
    def of_layout(layout: Layout) -> Simulation: ...
    @staticmethod
    def of_json(bytes: bytes) -> Simulation: ...
    @property
    def name(self) -> str: ...
    def json(self) -> bytes: ...
    def parameters(self) -> list[tuple[str, str]]: ...
    def with_set(self, sets: list[tuple[str, str]]) -> Simulation: ...

class Sidecar:
    def __init__(
        self,
        layout: str,
        sensor_cart: int,
        speed_setpoint: float,
        trigger_position: float,
        lowpass: float,
        laps: int,
        tension_setpoint: float | None = None,
        zeroed: Sequence[str] = (),
    ) -> None: ...
    def json(self) -> str: ...

def loaded(file: str, program: str) -> None: ...
def main(words: Sequence[str]) -> int: ...
def build(
    path: Path,
    text: str | None,
    layout: str | None,
    lets: list[tuple[str, str]],
    nodes: int,
    gap: float,
    time_limit: float | None,
    threads_asked: int | None,
    progress: _Tell,
) -> Layout: ...
def capacity(
    layout: Layout,
    hours: float,
    replications: int,
    seed: int,
    threads_asked: int | None,
    progress: _Tell,
) -> Capacity: ...
def choose(
    path: Path,
    text: str | None,
    layout: str | None,
    lets: list[tuple[str, str]],
    pareto: list[str],
    checks: int,
    threads_asked: int | None,
    progress: _Tell,
) -> tuple[str, str, bytes, str | None]: ...
def simulate(
    simulation: Simulation,
    laps: int,
    settle: float,
    step: float | None,
    integrator: str,
    supports: bool,
    progress: _Tell,
) -> tuple[_Array, dict[str, _Array], Sidecar, str, str | None]: ...
def read_run(path: Path) -> tuple[_Array, dict[str, _Array], Sidecar]: ...
def write_run(arrays: Any, simulation: Simulation | None, folder: Path, name: str, format: str) -> None: ...
def position(arrays: Any, lap: float) -> _Array | None: ...
def channels() -> list[tuple[str, str, str]]: ...
def identify(
    folder: Path | None,
    given: list[Any],
    layout: Simulation | None,
    law: str,
    free: list[str],
    share: list[str],
    seed: int,
    threads_asked: int | None,
    progress: _Tell,
) -> tuple[str, str, list[tuple[str, Simulation]]]: ...
def diagnose(
    folder: Path | None,
    given: list[Any],
    layout: Simulation | None,
    title: str,
    seed: int,
    threads_asked: int | None,
    progress: _Tell,
) -> tuple[bytes, str, str, list[str]]: ...
