"""Layouts: text to track elements, drawings and bills."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _lss
from ._frames import frame
from ._progress import Progress, telling
from ._simulation import Simulation

if TYPE_CHECKING:
    import pandas


def build(
    source: str | os.PathLike[str],
    *,
    layout: str | None = None,
    let: Mapping[str, str] | None = None,
    nodes: int = 6000,
    gap: float = 0.0,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Layout:
    """Optimise a layout and cover it with track elements, as `lss build` does.

    Parameters
    ----------
    source : str or path
        A `.lss` file, or its text: what has a line break is text. A text imports files by paths seen from the working
        directory.
    layout : str, optional
        Which layout, when the file has several.
    let : mapping, optional
        Other values for the layout's `let`s, as its text would have them: `{"aisle": "3 m"}`.
    nodes : int
        Most nodes of the search for the best layout on the catalogue's grid.
    gap : float
        The search ends when the proven gap is no larger, relative: 0.001 is 0.1 %.
    time_limit : float, optional
        Seconds after which the best layout so far is returned; its last stage then says `cut`.
    threads : int, optional
        All cores when not given. No result depends on it.
    progress : callable or False, optional
        By default tqdm's bar, where tqdm is installed and standard error is a terminal or a notebook. A callable is
        given (done, total, words); total is None where it is not known.

    Returns
    -------
    Layout

    Raises
    ------
    LayoutError
        The layout has mistakes, or none meets its constraints; `layout` is then the best that was found.
    OSError
        The file cannot be read.
    KeyboardInterrupt
        Ctrl-C stops the search within about a second. What it is at then ends on a thread of its own.
    """
    path, text = _source(source)
    with telling(progress) as tell:
        lets = [(name, str(value)) for name, value in (let or {}).items()]
        found = _lss.build(path, text, layout, lets, int(nodes), float(gap), _seconds(time_limit), threads, tell)
    return Layout(found)


def _seconds(limit: float | None) -> float | None:
    return None if limit is None else float(limit)


def _source(source: str | os.PathLike[str]) -> tuple[Path, str | None]:
    """A path, and the text that stands in for it."""
    if isinstance(source, str) and "\n" in source:
        return Path.cwd() / "<text>", source
    return Path(source), None


class Layout:
    """A layout that was built: measures, bill, proof, drawing. Values are read once and kept.

    Frames need pandas. Lengths are in m, angles in deg, masses in kg, prices in EUR; columns and keys say their unit.
    """

    def __init__(self, built: _lss.Layout) -> None:
        self._built = built

    def __repr__(self) -> str:
        state = "" if self.feasible else ", NOT FEASIBLE"
        return f"<lss.Layout {self.name!r}: {self.length:.3f} m, {self.price:.2f} EUR, {self.mass:.1f} kg{state}>"

    @cached_property
    def _summary(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self._built.summary)
        return found

    @cached_property
    def json(self) -> dict[str, Any]:
        """`layout.json` as plain values: vertices, centre line, elements, equipment, contacts, constraints, stages."""
        found: dict[str, Any] = json.loads(self._built.layout_json())
        return found

    @cached_property
    def bill_json(self) -> dict[str, Any]:
        """`bom.json` as plain values."""
        found: dict[str, Any] = json.loads(self._built.bom_json())
        return found

    @property
    def name(self) -> str:
        """The layout's name."""
        return self._built.name

    @property
    def length(self) -> float:
        """Length of the centre line, m; along the slope where there are heights."""
        return float(self._summary["length_m"])

    @property
    def price(self) -> float:
        """Price of the track elements, EUR."""
        return float(self._summary["price_eur"])

    @property
    def mass(self) -> float:
        """Mass of the track elements, kg."""
        return float(self._summary["mass_kg"])

    @property
    def footprint(self) -> float:
        """Floor covered by the track's band, m²."""
        return float(self._summary["footprint_m2"])

    @property
    def feasible(self) -> bool:
        """Whether it meets every constraint."""
        return bool(self._summary["feasible"])

    @property
    def chain(self) -> dict[str, Any] | None:
        """How a whole number of carts fits: `carts`, `left_over_mm`, `take_up_mm`; None where no chain closes."""
        found: dict[str, Any] | None = self._summary["chain"]
        return found

    @property
    def certificate(self) -> dict[str, Any] | None:
        """What is proven of the layout; None where nothing was searched.

        `lower_bound_m` (or `lower_bound_eur`): no layout of catalogue elements is shorter (cheaper). `gap`: how far the
        layout is above it, relative. `proven`: whether it is the best. `nodes`, `seconds`: of the search. `parts`,
        `assumed`: what the bound is about.
        """
        found: dict[str, Any] | None = self._summary["certificate"]
        return found

    @property
    def certificate_frame(self) -> pandas.DataFrame:
        """The certificate as a frame of one row; none where nothing was searched."""
        plain = {k: v for k, v in (self.certificate or {}).items() if not isinstance(v, (list, dict))}
        return frame([plain] if plain else [])

    @property
    def stages(self) -> pandas.DataFrame:
        """Stages of the optimisation, a row each: `name`, `length_m`, `max_violation_m`, `iterations`, `seconds`, `status`."""
        return frame(self._summary["stages"])

    @property
    def route(self) -> dict[str, Any] | None:
        """What the search for the vertices looked at; None where they were written."""
        return self._summary.get("route")

    @property
    def bill(self) -> pandas.DataFrame:
        """The bill of track elements, a row an article.

        `article`, `description`, `length_m`, `cut`, `radius_m`, `turn_deg`, `count`, `unit_price_eur`, `price_eur`,
        `unit_mass_kg`, `mass_kg`, `in_catalog`. What an article does not have is missing (NaN).
        """
        return frame(self.bill_json["articles"])

    @property
    def beside(self) -> pandas.DataFrame:
        """What is ordered beside the track, a row each: carts, joints, motors, sensors, supports, stations.

        `group`, `article`, `description`, `count`, `unit_price_eur`, `price_eur`, `unit_mass_kg`, `mass_kg`; missing where
        the declaration says none. It is no part of `price` and `mass`.
        """
        return frame(self.bill_json["beside"])

    @property
    def vertices(self) -> pandas.DataFrame:
        """Vertices in driving order: `name`, `x_m`, `y_m`, `radius_m`, `turn_deg` (left positive)."""
        return frame(self.json["vertices"])

    @property
    def sections(self) -> pandas.DataFrame:
        """Lines from each vertex to the next: `name`, `length_m`, `straight_m`, `heading_deg`."""
        return frame(self.json["sections"])

    @property
    def elements(self) -> pandas.DataFrame:
        """Track elements in driving order: `article`, `kind`, `length_m`, `cut`, `radius_m`, `turn_deg`, `s_m`, `x_m`, `y_m`,
        `heading_deg`, `in_catalog`. `s_m`, `x_m`, `y_m` and `heading_deg` are where it begins."""
        rows = []
        for element in self.json["elements"]:
            row = dict(element)
            x, y = row.pop("begin_m")
            rows.append({**row, "x_m": x, "y_m": y})
        return frame(rows)

    @property
    def equipment(self) -> pandas.DataFrame:
        """What stands along the track: `kind`, `name`, `s_m`, `x_m`, `y_m`, `z_m`, `heading_deg`."""
        return frame(self.json["equipment"])

    @property
    def contacts(self) -> pandas.DataFrame:
        """How the track's band meets obstacles and building: `name`, `area_left_m2`, `area_right_m2`, `clearance_m`, `required_m`."""
        return frame(self.json["contacts"])

    @property
    def constraints(self) -> pandas.DataFrame:
        """What the layout asks for, and the value it has: `row`, `reason`, `low`, `high`, `value`, `unit`."""
        return frame(self.json["constraints"])

    @cached_property
    def diagnostics(self) -> list[dict[str, Any]]:
        """Warnings, as `lss build --message-format json` prints them."""
        return [json.loads(line) for line in self._built.said[1]]

    @property
    def messages(self) -> str:
        """The same for people, with excerpts."""
        return self._built.said[0]

    @property
    def text(self) -> str | None:
        """The layout with the vertices that were found; None where they were written."""
        return self._built.text

    @cached_property
    def svg(self) -> str:
        """The general arrangement drawing: `drawing.svg`."""
        return self._built.svg()

    def _repr_svg_(self) -> str:
        return self.svg

    @cached_property
    def simulation(self) -> Simulation:
        """The input of a simulation of this layout."""
        return Simulation(self._built.simulation())

    def write(
        self,
        folder: str | os.PathLike[str],
        *,
        stages: bool = False,
        pdf: bool = False,
        report: bool = False,
        xlsx: bool = False,
        gltf: bool = False,
    ) -> None:
        """Write the files of `lss build`, all of them or none; more of them as its options of the same names say.

        Raises
        ------
        OSError
            The folder cannot be written to.
        """
        asked = {"stages": stages, "pdf": pdf, "report": report, "xlsx": xlsx, "gltf": gltf}
        self._built.write(Path(folder), [name for name, wanted in asked.items() if wanted])
