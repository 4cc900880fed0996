"""lss compiles conveyor track layouts: from text to track elements, drawings, bills and simulations.

>>> import lss
>>> layout = lss.build("hall.lss")
>>> run = lss.simulate(layout, laps=2)
>>> run.channels["steer_left"]  # N, an array over run.time, s

`build` gives a `Layout`, `simulate` a `Run`, `capacity` says how many items an hour a layout takes, `choose` which components do for
the least money, `identify` and `diagnose` tell what measured runs say of the model.
"""

from __future__ import annotations

import os
import sys
import sysconfig

from . import _lss
from ._capacity import Capacity, capacity
from ._choice import Choice, choose
from ._errors import LayoutError, RunError
from ._layout import Layout, build
from ._run import CHANNELS, Run
from ._simulation import Simulation, simulate
from ._study import Diagnosis, Identification, diagnose, identify


def _script() -> str:
    """The program `lss`, for work that it starts as processes of its own."""
    own = sys.argv[0] if sys.argv else ""
    if os.path.splitext(os.path.basename(own))[0] == "lss" and os.path.isfile(own):
        return os.path.abspath(own)
    return os.path.join(sysconfig.get_path("scripts"), "lss.exe" if os.name == "nt" else "lss")


# Results that the command line keeps on the disk belong to this build of the extension.
_lss.loaded(_lss.__file__, _script())

# As tracebacks show them.
LayoutError.__module__ = RunError.__module__ = "lss"

__version__ = _lss.__version__
__all__ = [
    "CHANNELS",
    "Capacity",
    "Choice",
    "Diagnosis",
    "Identification",
    "Layout",
    "LayoutError",
    "Run",
    "RunError",
    "Simulation",
    "build",
    "capacity",
    "choose",
    "diagnose",
    "identify",
    "simulate",
]
