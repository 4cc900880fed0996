"""How many items an hour a sorter takes."""

from __future__ import annotations

import json
import os
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from . import _lss
from ._frames import frame
from ._layout import Layout, build
from ._progress import Progress, telling

if TYPE_CHECKING:
    import pandas


def capacity(
    source: Layout | str | os.PathLike[str],
    *,
    layout: str | None = None,
    hours: float = 8.0,
    replications: int = 10,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Capacity:
    """Work out and simulate how many items an hour a layout's sorter takes, as `lss capacity` does.

    Parameters
    ----------
    source : Layout, path or str
        A layout that was built, or what `build` takes.
    layout : str, optional
        Which layout, when a file has several.
    hours : float
        Simulated time of each replication, h, 0.2 to 10000; with waves at least twice the time after which they repeat.
    replications : int
        2 to 10000, on other random items each.
    seed : int
        The same seed gives the same items, to whatever layout they come; from 0.
    threads : int, optional
        All cores when not given. No result depends on it.
    progress : callable or False, optional
        As of `build`, of a source that is built.

    Returns
    -------
    Capacity

    Raises
    ------
    RunError
        The layout has no carts that close the loop, no induction or no chutes, or `hours` are too few for its waves.
    LayoutError
        The layout that is built has mistakes; a capacity that it requires and cannot reach (E0604) is one.
    ValueError
        A number is out of its range.
    """
    if not 0.2 <= hours <= 10_000:
        raise ValueError(f"hours is {hours}; it is a number from 0.2 to 10000")
    if not 2 <= replications <= 10_000:
        raise ValueError(f"replications is {replications}; it is a number from 2 to 10000")
    if not 0 <= seed < 2**64:
        raise ValueError(f"seed is {seed}; it is a number from 0 to 2**64 - 1")
    built = source if isinstance(source, Layout) else build(source, layout=layout, threads=threads, progress=progress)
    with telling(progress) as tell:
        return Capacity(_lss.capacity(built._built, float(hours), int(replications), int(seed), threads, tell))


class Capacity:
    """Items an hour: a closed form, and a simulation with intervals of 95 %."""

    def __init__(self, own: _lss.Capacity) -> None:
        self._own = own
        self.json: dict[str, Any] = json.loads(own.json())

    def __repr__(self) -> str:
        return (
            f"<lss.Capacity {self.json['layout']!r}: {self.per_hour:.0f} ± {self.half_width:.0f} items an hour, "
            f"at most {self.bound_in_any_proportions:.0f}>"
        )

    def _repr_html_(self) -> str:
        said = f"{self.per_hour:.0f} ± {self.half_width:.0f} items an hour, at most {self.bound_in_any_proportions:.0f}"
        table: str = self.inductions.to_html(index=False)
        return f"<p>{escape(self.json['layout'])}: {said}; {escape(self.limited_by)}</p>{table}"

    @property
    def bound(self) -> float:
        """Closed form: items an hour that fit in the proportions in which they come, or in any where an induction always has items; with
        waves the mean over them. Simulations do not beat it unless chutes fail or full ones limit it."""
        return float(self.json["bound_per_hour"])

    @property
    def bound_in_any_proportions(self) -> float:
        """The same however items come, so no less than `bound`."""
        any_proportions = self.json.get("any_proportions") or self.json
        return float(any_proportions["bound_per_hour"])

    @property
    def limited_by(self) -> str:
        """What is used up first, in words."""
        return str(self.json["limited_by"])

    @property
    def per_hour(self) -> float:
        """Items an hour, simulated with items at every induction at any time."""
        return float(self.json["always_fed"]["per_hour"]["value"])

    @property
    def half_width(self) -> float:
        """Half the width of the 95 % interval of `per_hour`, items an hour."""
        return float(self.json["always_fed"]["per_hour"]["half_width"])

    @property
    def _shown(self) -> dict[str, Any]:
        found: dict[str, Any] = self.json.get("as_fed", self.json["always_fed"])
        return found

    @property
    def inductions(self) -> pandas.DataFrame:
        """Inductions, with the items that the layout says come, else always fed: `name`, `s_m`, `comes_per_hour`, `per_hour`,
        `waits_s`, `queue` (items at the end), `used_before`, `used_behind` (shares of carriers), `available` (share of time)."""
        return frame(self._shown["inductions"])

    @property
    def chutes(self) -> pandas.DataFrame:
        """Chutes, likewise: `name`, `s_m`, `per_hour`; `refused`, `down`: shares of the items that found them full or down."""
        return frame(self._shown["chutes"])

    @property
    def waves(self) -> pandas.DataFrame:
        """Waves until they repeat: `name`, `bound_per_hour`, `limited_by`, `busiest`, `busiest_share`, `per_hour`."""
        waves, simulated = self.json.get("waves", []), self._shown.get("waves_per_hour", [])
        return frame([{**wave, "per_hour": rate} for wave, rate in zip(waves, simulated, strict=True)])

    @property
    def costs(self) -> pandas.DataFrame:
        """What stops, failures and waves take, always fed: `cause`, `of`, `per_hour`, `half_width` (items an hour)."""
        rows = [{**cost, **_mean(cost["per_hour"])} for cost in self.json.get("costs", [])]
        return frame(rows)

    @property
    def text(self) -> str:
        """What `lss capacity` prints."""
        return self._own.text()

    @cached_property
    def html(self) -> str:
        """`capacity.html`; other speeds and fewer inductions are simulated when it is asked for."""
        return self._own.html(None)


def _mean(of: dict[str, float]) -> dict[str, float]:
    return {"per_hour": of["value"], "half_width": of["half_width"]}
