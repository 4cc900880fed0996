"""What docs/python.md shows, as types and as a program: run by .ci/wheel."""

import tempfile
from pathlib import Path

import numpy as np

import lss

EXAMPLES = Path(__file__).parents[2] / "examples"


def main() -> None:
    layout = lss.build(EXAMPLES / "smallest.lss")
    print(layout)
    print(layout.bill[["article", "count", "price_eur"]])
    assert layout.certificate is not None
    print(f"no layout is shorter than {layout.certificate['lower_bound_m']:.3f} m")

    run = lss.simulate(layout, laps=2, settle=5.0, speed=1.4)
    force: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = run.channels["joint_xi"]
    print(f"{run}: {force.mean():.0f} N in the joints, {force.max():.0f} N at most")

    with tempfile.TemporaryDirectory() as folder:
        layout.write(folder)
        run.write(Path(folder) / "run")

    capacity = lss.capacity(EXAMPLES / "infeeds.lss", hours=1, replications=2)
    print(f"{capacity.per_hour:.0f} items an hour, at most {capacity.bound:.0f}: {capacity.limited_by}")

    try:
        lss.build("layout {\n}")
    except lss.LayoutError as error:
        print(error.diagnostics[0]["code"])


if __name__ == "__main__":
    main()
