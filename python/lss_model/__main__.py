"""`python3 -m lss_model FILE.py`: FILE.py has a function `simulate(inputs, parameters)` and the lists EFFECTS, NUISANCES
(may be missing) and the dictionary ACCURACY (may be missing)."""
import os
import runpy
import sys

from . import serve


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: python3 -m lss_model FILE.py")
    sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[1])))
    own = runpy.run_path(sys.argv[1], run_name="lss_model_file")
    for name in ("simulate", "EFFECTS"):
        if name not in own:
            sys.exit(f"{sys.argv[1]} has no `{name}`")
    serve(own["simulate"], own["EFFECTS"], own.get("NUISANCES", ()), own.get("ACCURACY"))


main()
