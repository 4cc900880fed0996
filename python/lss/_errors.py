"""What `lss` raises beyond Python's own exceptions."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._layout import Layout


class RunError(Exception):
    """What was asked for could not be done with this input: the text says why, and often a way out.

    Numerical trouble in a simulation is one; `run` is then what was recorded before.
    """

    run: Any

    def __init__(self, text: str, diagnostics: list[str] | None = None, found: Any = None) -> None:
        super().__init__(text)
        self.run = None


class LayoutError(Exception):
    """A layout has mistakes, or none meets its constraints. The text is what `lss build` prints.

    Attributes
    ----------
    diagnostics : list[dict]
        One for each mistake and warning, as `lss build --message-format json` prints them: `code`, `name`, `severity`,
        `message`, `file`, `line` and `column` (from 1), and more.
    layout : Layout or None
        The best layout that was found, where none meets the constraints; its `feasible` is false.
    """

    diagnostics: list[dict[str, Any]]
    layout: Layout | None

    def __init__(self, text: str, diagnostics: list[str] | None = None, found: Any = None) -> None:
        super().__init__(text)
        self.diagnostics = [json.loads(line) for line in diagnostics or []]
        self.layout = None
        if found is not None:
            from ._layout import Layout

            self.layout = Layout(found)
