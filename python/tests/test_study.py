"""Identification and diagnosis of runs in memory beside those of the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import SMALL, run

import lss


@pytest.fixture(scope="module")
def measured() -> lss.Run:
    """Three laps of a chain that differs from the layout's; its sidecar has the nominal values."""
    nominal = lss.build(SMALL).simulation
    real = nominal.with_set({"chain.speed_m_s": 2.02, "joint.axial.restitution": 0.7})
    made = lss.simulate(real, laps=3, settle=10.0)
    sidecar = {**made.sidecar, "speed_setpoint": 2.0}
    sidecar = {k: sidecar[k] for k in ("layout", "sensor_cart", "speed_setpoint", "trigger_position", "lowpass", "laps")}
    return lss.Run(made.time, made.channels, sidecar=sidecar, simulation=nominal)


def test_identification_finds_the_truth_and_agrees_with_files(measured: lss.Run, tmp_path: Path) -> None:
    told: list[tuple[float, float | None, str]] = []
    found = lss.identify(measured, free=["speed", "tension"], progress=lambda *step: told.append(step))
    speed = found.parameters.set_index("parameter").loc["speed"]
    assert speed["value"] == pytest.approx(2.02, abs=2e-3) and speed["low"] < speed["value"] < speed["high"]
    assert speed["unit"] == "m/s" and speed["fitted"]
    assert not found.parameters.set_index("parameter").loc["k_p"]["fitted"]
    assert told[-1][:2] == (1.0, 1.0)
    assert found.simulation().parameters["chain.speed_m_s"] == speed["value"]
    assert found.objective == found.fits["objective"].iloc[0] and found.fits["limit"].iloc[0] > 0
    profile = found.profile("run-01", "steer_left")
    assert profile["s"].shape == profile["measured"].shape == profile["simulated"].shape
    assert {"channel", "from_m", "deviations"} <= set(found.residuals.columns)

    # From files, in memory, and by the command line it is the same.
    measured.write(tmp_path / "runs")
    words = ["--free", "speed,tension", "--format", "json"]
    ran = run("identify", tmp_path / "runs", "-o", tmp_path / "out", *words)
    assert ran.returncode == 0, ran.stderr
    theirs = json.loads(ran.stdout)
    campaign = lss.identify(tmp_path / "runs", free=["speed", "tension"])
    read = lss.Run.read(tmp_path / "runs" / "run-01.csv", simulation=measured.simulation)
    memory = lss.identify([read], free=["speed", "tension"])
    for law in (campaign.json["laws"][0], memory.json["laws"][0]):
        # A fit's key has the program's build, options and data.
        assert law == theirs

    found.write(tmp_path / "written")
    assert (tmp_path / "written" / "identification.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_what_cannot_be_identified_is_said(measured: lss.Run, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no parameter"):
        lss.identify(measured, free=["sped"])
    with pytest.raises(ValueError, match="no law"):
        lss.identify(measured, law="newton")
    with pytest.raises(ValueError, match="add it to free"):
        lss.identify(measured, free=["speed"], share=["tension"])
    with pytest.raises(ValueError, match="no runs"):
        lss.identify([])
    alone = lss.Run(measured.time, measured.channels, sidecar=measured._sidecar)
    with pytest.raises(ValueError, match="which chain"):
        lss.identify(alone)
    with pytest.raises(OSError):
        lss.identify(tmp_path / "gone")
    still = {name: np.zeros_like(samples) for name, samples in measured.channels.items()}
    with pytest.raises(lss.RunError):
        lss.identify(lss.Run(measured.time, still, sidecar=measured._sidecar, simulation=measured.simulation))


@pytest.mark.slow
def test_a_diagnosis_is_that_of_the_command_line(measured: lss.Run, tmp_path: Path) -> None:
    measured.write(tmp_path / "runs", format="parquet")
    ran = run("gap", "diagnose", tmp_path / "runs" / "run-01.parquet", "-o", tmp_path / "out", "--format", "json")
    assert ran.returncode == 0, ran.stderr
    found = lss.diagnose(tmp_path / "runs" / "run-01.parquet")
    found.write(tmp_path / "written")
    for name in ("gap.json", "gap.html"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "written" / name).read_bytes(), name
    assert found.verdict == json.loads(ran.stdout)["verdict"] and found.summary
    assert found.findings["probability"].is_monotonic_decreasing and len(found.gap) == 1
    assert found.cost["simulations"] > 0 and "run-01" in found.gap["run"].tolist()
