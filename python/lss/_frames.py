"""Tables as data frames of pandas, which is asked for when the first one is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas


def frame(rows: list[dict[str, Any]], columns: list[str] | None = None) -> pandas.DataFrame:
    """A frame of rows, with these columns where there are no rows."""
    try:
        import pandas
    except ImportError as why:
        raise ImportError(
            "this table needs pandas, which is not installed: `pip install pandas` (or `pip install lss[pandas]`); "
            "`.json` has the same as plain values"
        ) from why
    return pandas.DataFrame(rows, columns=columns if columns is not None and not rows else None)
