"""What the tests share: a small track, and the command line of the same wheel."""

import subprocess
import sys
from pathlib import Path

import pytest

SMALL = """\
use std.carts.tilt_tray
use std.tracks.standard

layout small {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m

  vertex A (0 m, 0 m) radius 4 m
  vertex B (16 m, 0 m) radius 4 m
  vertex C (16 m, 9 m) radius 4 m
  vertex D (0 m, 9 m) radius 4 m

  photocell on A..B at 2 m
  motors 3 evenly

  optimise nothing
}
"""

LOOP = """\
use std.carts.tilt_tray
use std.tracks.standard

layout loop {
  catalog standard
  cart tilt_tray(length: 0.7 m)
  speed 1.5 m/s
  width 0.8 m

  vertex P1 (0 m, 0 m) radius 3 m
  vertex P2 (12 m, 0 m) radius 3 m
  vertex P3 (12 m, 9 m) radius 3 m
  vertex P4 (0 m, 9 m) radius 3 m

  motors 2 evenly

  optimise length
}
"""


def program() -> list[str]:
    """The script `lss` that the wheel has put beside its Python."""
    script = Path(sys.executable).parent / ("lss.exe" if sys.platform == "win32" else "lss")
    assert script.exists(), f"the wheel has put no {script} there"
    return [str(script)]


def run(*words: object, at: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the command line."""
    return subprocess.run(
        [*program(), *map(str, words)], cwd=at, capture_output=True, text=True, encoding="utf-8", check=False
    )


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A track on which chains are simulated in a moment."""
    path = tmp_path / "small.lss"
    path.write_text(SMALL)
    return path


@pytest.fixture
def loop(tmp_path: Path) -> Path:
    """A track that is optimised in a moment."""
    path = tmp_path / "loop.lss"
    path.write_text(LOOP)
    return path
