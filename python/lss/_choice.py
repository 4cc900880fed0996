"""Which components do what a layout requires for the least money."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from . import _lss
from ._layout import _source
from ._progress import Progress, telling

if TYPE_CHECKING:
    import pandas


def choose(
    source: str | os.PathLike[str],
    *,
    layout: str | None = None,
    let: Mapping[str, str] | None = None,
    pareto: Sequence[str] = (),
    checks: int = 20,
    threads: int | None = None,
    progress: Progress = None,
) -> Choice:
    """Choose carts, speed, motors and radii that do what a layout requires at the least price with energy, as `lss choose` does.

    Parameters
    ----------
    source : str or path
        A `.lss` file, or its text, whose `choose` lines say what is free.
    layout, let, threads
        As of `build`.
    pareto : sequence of str
        Two or three of `price`, `cost` (EUR), `footprint` (m²), `capacity` (items an hour), `smoothness` (mm), `energy` (kWh a year)
        and `length` (m): `json["pareto"]` then has the candidates that no other one beats in them.
    checks : int
        Candidates that are checked in the dynamic model until one passes, 0 to 1000; 0 leaves the check out.
    progress : callable or False, optional
        As of `build`; counts tracks, then checks, whose number is not known.

    Returns
    -------
    Choice

    Raises
    ------
    LayoutError
        The layout has mistakes, or no candidate does what is required (E0605).
    RunError
        There are too many candidates.
    ValueError
        `pareto` or `checks` is wrong.
    OSError
        The file cannot be read.
    """
    if not 0 <= checks <= 1000:
        raise ValueError(f"checks is {checks}; it is a number from 0 to 1000")
    path, text = _source(source)
    lets = [(name, str(value)) for name, value in (let or {}).items()]
    with telling(progress) as tell:
        return Choice(*_lss.choose(path, text, layout, lets, list(pareto), int(checks), threads, tell))


class Choice:
    """What was chosen, and what was not.

    Attributes
    ----------
    json : dict
        `choice.json` as plain values; keys say their units.
    html : str
        `choice.html`.
    text : str or None
        The layout with the choice: `layout.lss`.
    """

    def __init__(self, document: str, page: str, table: bytes, text: str | None) -> None:
        self.json: dict[str, Any] = json.loads(document)
        self.html = page
        self.text = text
        self._table = table

    def __repr__(self) -> str:
        return f"<lss.Choice of {self.json['candidates']} candidates, {self.json['feasible']} feasible: {self.lines}>"

    def _repr_html_(self) -> str:
        found = self.choice or {}
        shown = {key: str(value) for key, value in found.items() if not isinstance(value, dict | list)}
        rows = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in shown.items())
        return f"<p>{escape(repr(self)[1:-1])}</p><table>{rows}</table>"

    @property
    def choice(self) -> dict[str, Any] | None:
        """The winner: `cart`, `cart_length_m`, `speed_m_s`, `motor`, `motors`, `price_eur`, `capacity_per_hour` and more."""
        found: dict[str, Any] | None = self.json.get("choice")
        return found

    @property
    def lines(self) -> list[str]:
        """The lines of the layout that say the choice."""
        return list(self.json["lines"])

    @property
    def candidates(self) -> pandas.DataFrame:
        """Every candidate, a row each: `candidates.csv`. Columns say their units."""
        try:
            import pandas
        except ImportError as why:
            raise ImportError("this table needs pandas, which is not installed: `pip install pandas`") from why
        return pandas.read_csv(io.BytesIO(self._table))
