"""Identification and diagnosis: what measured runs tell of the model."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _lss
from ._frames import frame
from ._progress import Progress, telling
from ._run import Run
from ._simulation import Simulation, input_of

if TYPE_CHECKING:
    import pandas

    from ._layout import Layout

Runs = Run | Iterable[Run] | str | os.PathLike[str]


class _Given:
    """A run as the extension takes it."""

    def __init__(self, name: str, run: Run, simulation: _lss.Simulation) -> None:
        self.name = name
        self.arrays = run
        self.simulation = simulation


def _given(runs: Runs, chain: Simulation | None) -> tuple[Path | None, list[Any]]:
    """A campaign's folder, or runs in memory."""
    if isinstance(runs, (str, os.PathLike)):
        return Path(runs), []
    found: list[Any] = []
    names: set[str] = set()
    for run in [runs] if isinstance(runs, Run) else runs:
        simulation = chain or run.simulation
        if simulation is None:
            raise ValueError(f"nothing says which chain made {run.name}: give layout, or the run's simulation")
        name, k = run.name, 1
        while name in names:
            k += 1
            name = f"{run.name} ({k})"
        names.add(name)
        found.append(_Given(name, run, simulation._own))
    if not found:
        raise ValueError("there are no runs")
    return None, found


def _chain(layout: Any, tell: Any) -> Simulation | None:
    return None if layout is None else input_of(layout, None, tell)


def identify(
    runs: Runs,
    *,
    layout: Layout | Simulation | str | os.PathLike[str] | None = None,
    law: str = "herbert_mcwhannell",
    free: Sequence[str] = (),
    share: Sequence[str] = (),
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Identification:
    """Find parameters of the model from measured runs, as `lss identify` does.

    Parameters
    ----------
    runs : Run, several of them, or path
        Runs in memory, or a campaign: its folder, its `campaign.toml`, or a single data file.
    layout : Layout, Simulation or path, optional
        The chain of all runs, instead of those that runs or campaign name.
    law : str
        Damping law, or `all`.
    free : sequence of str
        Parameters to fit; all when empty. The others keep the layout's values and those of the sidecar.
    share : sequence of str
        Parameters that all runs have in common.
    seed : int
        Another seed is another answer that is as good.
    threads : int, optional
        All cores when not given. No result depends on it.
    progress : callable or False, optional
        As of `build`; counts fits.

    Returns
    -------
    Identification

    Raises
    ------
    RunError
        No run can be used or fitted.
    KeyboardInterrupt
        Ctrl-C stops the simulations within about a second.
    """
    with telling(progress) as tell:
        chain = _chain(layout, tell)
        folder, given = _given(runs, chain)
        own = None if chain is None else chain._own
        found = _lss.identify(folder, given, own, law, list(free), list(share), int(seed), threads, tell)
    return Identification(*found)


class Identification:
    """Parameters that runs speak for, with intervals."""

    def __init__(self, document: str, page: str, fitted: list[tuple[str, _lss.Simulation]]) -> None:
        self.json: dict[str, Any] = json.loads(document)
        self.html = page
        self._units = dict(self.json.pop("units"))
        self._fitted = fitted

    def __repr__(self) -> str:
        laws = ", ".join(f"{law['law']} {law['objective']:.3f}" for law in self.json["laws"])
        return f"<lss.Identification of {len(self._fitted)} runs: objective {laws}>"

    def _repr_html_(self) -> str:
        table: str = self.parameters.to_html(index=False)
        return table

    @property
    def warnings(self) -> list[str]:
        """Runs that were not fitted or do not fit, parameters at a bound, and what runs lack."""
        return list(self.json["warnings"])

    @property
    def objective(self) -> float:
        """Of the first law: residuals over the repeatability of laps, root mean square over runs; 1 is as near as laps are."""
        return float(self.json["laws"][0]["objective"])

    @property
    def parameters(self) -> pandas.DataFrame:
        """A row for each law, run and parameter, in SI units.

        `law`, `run`, `parameter`, `unit`, `value`, `low` and `high` (the 90 % interval), `at_bound`, `fitted`.
        """
        rows = []
        for law in self.json["laws"]:
            for run, fit in law["runs"].items():
                for name, estimate in fit["parameters"].items():
                    row = {"law": law["law"], "run": run, "parameter": name, "unit": self._units[name]}
                    rows.append({**row, **estimate})
        return frame(rows)

    @property
    def shared(self) -> pandas.DataFrame:
        """Parameters that the runs have in common: `law`, `parameter`, `unit`, `value`, `low`, `high`, `at_bound`, `fitted`."""
        rows = [
            {"law": law["law"], "parameter": name, "unit": self._units[name], **estimate}
            for law in self.json["laws"]
            for name, estimate in law["shared"].items()
        ]
        return frame(rows, ["law", "parameter", "unit", "value", "low", "high", "at_bound", "fitted"])

    @property
    def fits(self) -> pandas.DataFrame:
        """A row for each law and run: `law`, `run`, `objective`, `limit` (what repeatability allows), `laps`, `simulations`,
        and `nrmsd_CHANNEL`, the root mean square difference of a simulated lap over the measured range."""
        rows = []
        for law in self.json["laws"]:
            for run, fit in law["runs"].items():
                row = {"law": law["law"], "run": run, "objective": fit["objective"]}
                row |= {"limit": fit["goodness"]["limit"]["objective"], "laps": fit["laps"]}
                row |= {"simulations": fit["simulations"]}
                rows.append(row | {f"nrmsd_{channel}": x for channel, x in fit["nrmsd"].items()})
        return frame(rows)

    @property
    def residuals(self) -> pandas.DataFrame:
        """Where the model is off, the farthest first: `law`, `run`, `channel`, `feature`, `from_m`, `to_m`, `deviations`.

        A row is a stretch of the track on which a residual of a feature is over three deviations of repeated laps.
        """
        rows = [
            {"law": law["law"], "run": run, **stretch}
            for law in self.json["laws"]
            for run, fit in law["runs"].items()
            for stretch in fit["goodness"]["stretches"]
        ]
        return frame(rows, ["law", "run", "channel", "feature", "from_m", "to_m", "deviations"])

    def profile(self, run: str, channel: str) -> dict[str, Any]:
        """Means of a force along the track, of the first law: `s` (m), `measured`, `simulated`, `deviation` (N).

        Each is an array of shape (cells,); NaN where a cell was not measured. `deviation` is that of repeated laps.
        """
        import numpy as np

        goodness = self.json["laws"][0]["runs"][run]["goodness"]
        profile = goodness["profiles"][channel]
        found: dict[str, Any] = {name: np.array(values, dtype=np.float64) for name, values in profile.items()}
        cells = len(profile["measured"])
        found["s"] = (np.arange(cells) + 0.5) * goodness["lap_m"] / max(cells, 1)
        return found

    def simulation(self, run: str | None = None) -> Simulation:
        """The input of a simulation with what was fitted to a run (the first one) in the first law."""
        for name, own in self._fitted:
            if run is None or run == name:
                return Simulation(own)
        raise KeyError(run)

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Write `identification.html`, `identification.json` and a JSON file for each law."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        files = {"identification.json": json.dumps(self.json["study"], indent=2) + "\n", "identification.html": self.html}
        for law in self.json["laws"]:
            files[f"{law['law']}.json"] = json.dumps(law, indent=2) + "\n"
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")


def diagnose(
    runs: Runs,
    *,
    layout: Layout | Simulation | str | os.PathLike[str] | None = None,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Diagnosis:
    """Say where built system and simulation part, which effect does it, and how much of the gap it closes, as
    `lss gap diagnose` does with the chain of carts as the model.

    Parameters
    ----------
    runs, layout, threads, progress
        As of `identify`. More than one run tells more: strengths are then judged on runs left out.
    seed : int
        Which noise simulations get: another seed is another answer that is as good.

    Returns
    -------
    Diagnosis

    Raises
    ------
    RunError
        A run cannot be used.
    KeyboardInterrupt
        Ctrl-C stops the simulations within about a second.
    """
    title = "runs"
    if isinstance(runs, (str, os.PathLike)):
        title = Path(runs).name or "campaign"
    with telling(progress) as tell:
        chain = _chain(layout, tell)
        folder, given = _given(runs, chain)
        own = None if chain is None else chain._own
        found = _lss.diagnose(folder, given, own, title, int(seed), threads, tell)
    return Diagnosis(*found)


class Diagnosis:
    """Which effects the model lacks, how probable each is, and what it closes of the gap."""

    def __init__(self, document: bytes, page: str, cost: str, warnings: list[str]) -> None:
        self._document = document
        self.html = page
        self.cost: dict[str, Any] = json.loads(cost)
        self.warnings = warnings

    def __repr__(self) -> str:
        return f"<lss.Diagnosis: {self.verdict}, {', '.join(self.json['with']) or 'no effect'}>"

    def _repr_html_(self) -> str:
        table: str = self.findings.head(6).to_html(index=False)
        return f"<p>{self.summary}</p>{table}"

    @cached_property
    def json(self) -> dict[str, Any]:
        """`gap.json` as plain values."""
        found: dict[str, Any] = json.loads(self._document)
        return found

    @property
    def verdict(self) -> str:
        """`effect`, `pair`, `sensor`, `none` (no gap) or `unknown` (a gap that no effect of the library explains)."""
        return str(self.json["verdict"])

    @property
    def summary(self) -> str:
        """The verdict in a few sentences."""
        return str(self.json["summary"])

    @property
    def findings(self) -> pandas.DataFrame:
        """A row an effect, the most probable first.

        `effect`, `place`, `probability`, `gap_closed` and `gap_closed_placebo` (of the gap of runs left out, shares), then
        for each strength `NAME`, `NAME_low`, `NAME_high` (the 90 % interval) and `NAME_unit`.
        """
        rows = []
        for found in self.json["effects"]:
            row = {"effect": found["name"], "place": found["place"], "probability": found["probability"]}
            row |= {"gap_closed": found["gap_closed"], "gap_closed_placebo": found["gap_closed_placebo"]}
            for name, amount in found["strength"].items():
                row |= {name: amount["value"], f"{name}_low": amount["low"], f"{name}_high": amount["high"]}
                row |= {f"{name}_unit": amount["unit"]}
            rows.append(row)
        return frame(rows)

    @property
    def places(self) -> pandas.DataFrame:
        """Where the gap lies, the largest share first: `channel`, `from_m`, `to_m`, `band`, `share`."""
        return frame(self.json["where"], ["channel", "from_m", "to_m", "band", "share"])

    @property
    def gap(self) -> pandas.DataFrame:
        """The gap of each run, as mean square over that of repeated laps (1 is none): `run`, `before`, `after`, `limit`.

        `after` is with the effects of the verdict; over `limit` there is a gap.
        """
        rows = [
            {"run": r["run"], "before": r["before"], "after": r["after"], "limit": r["honest_high"]}
            for r in self.json["runs"]
        ]
        return frame(rows, ["run", "before", "after", "limit"])

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Write `gap.json` and `gap.html`."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "gap.json").write_bytes(self._document)
        (folder / "gap.html").write_text(self.html, encoding="utf-8")
