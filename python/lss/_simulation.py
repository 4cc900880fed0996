"""Simulations of the chain of carts."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _lss
from ._errors import RunError
from ._progress import Progress, telling
from ._run import Run

if TYPE_CHECKING:
    from ._layout import Layout


class Simulation:
    """The input of a simulation: track, chain, cart, wheels, joints, motors, controller, sensors. It does not change."""

    def __init__(self, own: _lss.Simulation) -> None:
        self._own = own

    def __repr__(self) -> str:
        chain = self.json["chain"]
        return f"<lss.Simulation {self._own.name!r}: {chain['carts']} carts, {chain['speed_m_s']} m/s>"

    @staticmethod
    def read(path: str | os.PathLike[str], *, layout: str | None = None, progress: Progress = None) -> Simulation:
        """That of a `simulation.json`, or of a `.lss`, which is built; `layout` says which one of several."""
        with telling(progress) as tell:
            return Simulation(_lss.Simulation.of_file(Path(path), layout, None, tell))

    @staticmethod
    def of(document: Mapping[str, Any]) -> Simulation:
        """From plain values, as `json` has them."""
        return Simulation(_lss.Simulation.of_json(json.dumps(dict(document)).encode()))

    @cached_property
    def json(self) -> dict[str, Any]:
        """`simulation.json` as plain values, in SI units unless a key says otherwise."""
        found: dict[str, Any] = json.loads(self._own.json())
        return found

    @property
    def parameters(self) -> dict[str, float | str]:
        """Each number of the model by its name, in SI units, and the contact law: `lss simulate --list-parameters`."""
        return {name: _number(value) for name, value in self._own.parameters()}

    def with_set(self, changes: Mapping[str, float | str]) -> Simulation:
        """The same with other numbers, by the names of `parameters`: `{"cart.mass_kg": 45}`.

        Raises
        ------
        ValueError
            There is no such name, or the value does not fit.
        """
        return Simulation(self._own.with_set([(name, str(value)) for name, value in changes.items()]))

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write `simulation.json`."""
        Path(path).write_bytes(self._own.json())


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def simulate(
    source: Layout | Simulation | str | os.PathLike[str],
    *,
    layout: str | None = None,
    laps: int = 1,
    settle: float = 30.0,
    speed: float | None = None,
    tension: float | None = None,
    law: str | None = None,
    step: float | None = None,
    integrator: str = "verlet",
    sensor_cart: int | None = None,
    supports: bool = False,
    set: Mapping[str, float | str] | None = None,
    progress: Progress = None,
) -> Run:
    """Simulate the chain and record what a sensor cart would measure, as `lss simulate` does.

    Parameters
    ----------
    source : Layout, Simulation or path
        A layout that was built, the input of a simulation, or a file: `.lss`, which is built, or `.json`.
    layout : str, optional
        Which layout, when a file has several.
    laps : int
        Laps of the sensor cart to record, 1 to 10000.
    settle : float
        Time before recording, s.
    speed : float, optional
        Of the chain, m/s.
    tension : float, optional
        Of the chain on its centre line, N.
    law : str, optional
        Damping law of every contact: `herbert_mcwhannell`, `kelvin_voigt` and others.
    step : float, optional
        Largest time step, s. As the joints' damping bounds it when not given.
    integrator : str
        `verlet` or `cash_karp`.
    sensor_cart : int, optional
        Number of the cart that carries the sensors, from 1.
    supports : bool
        Keep what each of the track's supports carries, for the page of the lap.
    set : mapping, optional
        Any numbers of the model, by the names of `Simulation.parameters`, in SI units.
    progress : callable or False, optional
        As of `build`; done is a share, total is 1.

    Returns
    -------
    Run
        `time`, shape (samples,), s; `channels`, a dict of arrays of that shape.

    Raises
    ------
    RunError
        Numerical trouble; its `run` is what was recorded before.
    ValueError
        No chain can be like that, or a name or value is wrong.
    KeyboardInterrupt
        Ctrl-C stops it within about a tenth of a second.
    """
    if not 1 <= laps <= 10_000:
        raise ValueError(f"laps is {laps}; it is a number from 1 to 10000")
    for name, value in (("settle", settle), ("step", step), ("speed", speed)):
        if value is not None and not 0 <= value < float("inf"):
            raise ValueError(f"{name} is {value}; it is a number from 0")
    changes: dict[str, float | str] = {}
    for key, number in (("chain.speed_m_s", speed), ("chain.tension_n", tension), ("sensor.cart", sensor_cart)):
        if number is not None:
            changes[key] = number
    changes.update(set or {})
    if law is not None:
        changes["contact_law"] = law
    with telling(progress) as tell:
        simulation = input_of(source, layout, tell)
        if changes:
            simulation = simulation.with_set(changes)
        found = _lss.simulate(simulation._own, int(laps), float(settle), step, integrator, supports, tell)
    time, channels, sidecar, summary, trouble = found
    run = Run(time, channels, sidecar=sidecar, simulation=simulation, summary=json.loads(summary))
    if trouble is not None:
        error = RunError(trouble)
        error.run = run
        raise error
    return run


def input_of(source: Layout | Simulation | str | os.PathLike[str], layout: str | None, tell: Any) -> Simulation:
    """The input of a simulation of whatever has one."""
    if isinstance(source, Simulation):
        return source
    if isinstance(source, (str, os.PathLike)):
        return Simulation(_lss.Simulation.of_file(Path(source), layout, None, tell))
    return source.simulation
