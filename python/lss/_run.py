"""Runs: what a sensor cart measured, or a simulation in its stead."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from functools import cached_property
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lss
from ._frames import frame

if TYPE_CHECKING:
    import pandas

    from ._simulation import Simulation

CHANNELS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {name: (unit, label) for name, unit, label in _lss.channels()}
)
"""Every channel that a run may have: its unit (empty for the trigger, which is 0 or 1) and what it is."""


class Run:
    """Samples of a sensor cart over time.

    Parameters
    ----------
    time : array, shape (samples,)
        s, increasing.
    channels : mapping of arrays, shape (samples,)
        By the names of `CHANNELS`, in their units. NaN is a lost sample.
    sidecar : mapping
        Nominal values: `sensor_cart` (from 1), `speed_setpoint` (m/s), `trigger_position` (m), `lowpass` (Hz), `laps`;
        where the layout's is not meant, `tension_setpoint` (N); and `zeroed`, names of forces that were set to zero
        under load.
    simulation : Simulation, optional
        The chain that is thought to have made it: `identify` and `diagnose` ask for it.
    name : str
        What reports call it.

    Attributes
    ----------
    summary : dict
        Of a simulation, what `lss simulate --format json` prints: `carts`, `track_m`, `simulated_s`, `step_s`,
        `mean_tension_n`, and mean, sd, min and max of each channel.
    """

    time: NDArray[np.float64]
    channels: dict[str, NDArray[np.float64]]
    simulation: Simulation | None
    summary: dict[str, Any]
    name: str

    def __init__(
        self,
        time: ArrayLike,
        channels: Mapping[str, ArrayLike],
        *,
        sidecar: Mapping[str, Any] | _lss.Sidecar,
        simulation: Simulation | None = None,
        summary: dict[str, Any] | None = None,
        name: str = "run-01",
    ) -> None:
        self.time = np.asarray(time, dtype=np.float64)
        self.channels = {name: np.asarray(samples, dtype=np.float64) for name, samples in channels.items()}
        self.simulation = simulation
        self.summary = summary or {}
        self.name = name
        if isinstance(sidecar, _lss.Sidecar):
            self._sidecar = sidecar
        else:
            given = {"layout": "simulation.json", "laps": 1, **sidecar}
            self._sidecar = _lss.Sidecar(**given)

    def __repr__(self) -> str:
        span = f", {self.time[0]:.2f} to {self.time[-1]:.2f} s" if self.time.size else ""
        return f"<lss.Run {self.name!r}: {self.time.size} samples of {len(self.channels)} channels{span}>"

    def _repr_html_(self) -> str:
        amounts: dict[str, Callable[[Any], Any]] = {
            "mean": np.nanmean,
            "sd": np.nanstd,
            "min": np.nanmin,
            "max": np.nanmax,
        }
        rows = [
            {"channel": name, "unit": CHANNELS[name][0], **{amount: of(x) for amount, of in amounts.items()}}
            for name, x in self.channels.items()
            if np.isfinite(x).any()
        ]
        table: str = frame(rows).to_html(index=False, float_format=lambda value: f"{value:.4g}")
        return f"<p>{escape(repr(self)[1:-1])}</p>{table}"

    @staticmethod
    def read(path: str | os.PathLike[str], *, simulation: Simulation | None = None) -> Run:
        """Read a data file (CSV, Parquet or MDF 4) with its sidecar, a `.toml` of the same name."""
        time, channels, sidecar = _lss.read_run(Path(path))
        return Run(time, channels, sidecar=sidecar, simulation=simulation, name=Path(path).stem)

    @property
    def sidecar(self) -> dict[str, Any]:
        """Nominal values beside the samples, in SI units."""
        found: dict[str, Any] = json.loads(self._sidecar.json())
        return found

    @property
    def units(self) -> dict[str, str]:
        """The unit of each channel; empty for the trigger."""
        return {name: CHANNELS[name][0] for name in self.channels}

    @cached_property
    def position(self) -> NDArray[np.float64] | None:
        """Arc length that the sensor cart has travelled, shape (samples,), m: modulo the lap it is the place on the track.

        From the trigger, as nothing on the cart measures it; None without an edge of the trigger or without `simulation`.
        """
        if self.simulation is None:
            return None
        return _lss.position(self, float(self.simulation.json["chain"]["track_length_m"]))

    def to_frame(self) -> pandas.DataFrame:
        """A frame with a row a sample: `time_s`, then each channel with its unit: `steer_left_n`, `trigger`."""
        suffix = {"N": "_n", "rad": "_rad", "rad/s": "_rad_s", "°C": "_c"}
        table = frame([])
        table["time_s"] = self.time
        for name, samples in self.channels.items():
            table[name + suffix.get(CHANNELS[name][0], "")] = samples
        return table

    def write(self, folder: str | os.PathLike[str], *, name: str | None = None, format: str = "csv") -> None:
        """Write what `lss simulate` writes: data and sidecar and, where the chain is known, `simulation.json` and `lap.html`.

        `format` is `csv`, which rounds to seven digits, or `parquet`.
        """
        own = None if self.simulation is None else self.simulation._own
        _lss.write_run(self, own, Path(folder), name or self.name, format)
