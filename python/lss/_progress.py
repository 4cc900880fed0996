"""How far work is: by tqdm where somebody looks, or to a callable."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal

Tell = Callable[[float, "float | None", str], object]
SOON = 0.5
"""Work that is done by then, s, shows no bar."""

Progress = Tell | Literal[False] | None


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    found = shell.get_ipython() if shell is not None else None
    return type(found).__name__ == "ZMQInteractiveShell"


@contextmanager
def telling(progress: Progress) -> Iterator[Tell | None]:
    """What the extension calls with (done, total, words)."""
    if progress is False:
        yield None
        return
    if progress is not None:
        if not callable(progress):
            raise TypeError("progress is None, False, or a callable of (done, total, words)")
        yield progress
        return
    seen = _in_notebook() or (sys.stderr is not None and sys.stderr.isatty())
    if not seen:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    began = time.monotonic()
    bar: Any = None

    def show(done: float, total: float | None, words: str) -> None:
        nonlocal bar
        if bar is None:
            if time.monotonic() - began < SOON:
                return
            bar = tqdm(total=total, leave=False, bar_format="{desc} {bar} {elapsed}")
        bar.total, bar.n = total, done
        bar.set_description_str(words, refresh=False)
        bar.refresh()

    try:
        yield show
    finally:
        if bar is not None:
            bar.close()
