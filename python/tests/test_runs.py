"""`lss.simulate` and runs beside `lss simulate`."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import SMALL, run

import lss


def simulated(**more: object) -> lss.Run:
    return lss.simulate(lss.build(SMALL), settle=3.0, **more)  # type: ignore[arg-type]


def test_a_run_is_that_of_the_command_line(small: Path, tmp_path: Path) -> None:
    for format in ("csv", "parquet"):
        words = ["--laps", "2", "--settle", "3s", "--speed", "2.1m/s", "--set", "cart.mass_kg=45", "--format", "json"]
        ran = run("simulate", small, "-o", tmp_path / "cli", "--run-format", format, *words)
        assert ran.returncode == 0, ran.stderr
        found = lss.simulate(small, laps=2, settle=3.0, speed=2.1, set={"cart.mass_kg": 45})
        found.write(tmp_path / "python", format=format)
        for name in (f"run-01.{format}", "run-01.toml", "simulation.json", "lap.html"):
            assert (tmp_path / "cli" / name).read_bytes() == (tmp_path / "python" / name).read_bytes(), name
    said = json.loads(ran.stdout)
    summary = dict(found.summary)
    assert summary.pop("wall_s") > 0
    del said["wall_s"]
    assert summary == said
    # A notebook shows a row a channel, and the trigger.
    assert found._repr_html_().count("<tr") == len(found.channels) + 1


def test_arrays_are_what_stands_in_the_file(small: Path, tmp_path: Path) -> None:
    assert run("simulate", small, "-o", tmp_path, "--settle", "3s").returncode == 0
    read = lss.Run.read(tmp_path / "run-01.csv")
    found = lss.simulate(small, settle=3.0)
    assert np.array_equal(found.time, read.time)
    assert sorted(found.channels) == sorted(read.channels) and "steer_left" in found.channels
    for name, samples in found.channels.items():
        assert samples.dtype == np.float64 and samples.shape == found.time.shape
        # The file has seven digits, and no finer than a millionth.
        np.testing.assert_allclose(read.channels[name], samples, rtol=1e-6, atol=1e-6, err_msg=name)
    assert found.units["steer_left"] == "N" and found.units["trigger"] == ""
    assert found.sidecar["speed_setpoint"] == 2.0 and found.sidecar["sensor_cart"] == 1


def test_arrays_are_no_copies() -> None:
    found = simulated()
    for samples in (found.time, *found.channels.values()):
        # The memory is the simulation's own: an owner that is no array holds it.
        assert samples.base is not None and not isinstance(samples.base, np.ndarray)
        assert samples.flags.c_contiguous and samples.flags.writeable


def test_the_layout_may_be_built_or_changed_or_read(small: Path, tmp_path: Path) -> None:
    layout = lss.build(small)
    ways = [
        lss.simulate(layout, settle=3.0),
        lss.simulate(layout.simulation, settle=3.0),
        lss.simulate(lss.Simulation.of(layout.simulation.json), settle=3.0),
        lss.simulate(str(small), settle=3.0),
    ]
    layout.simulation.write(tmp_path / "simulation.json")
    ways.append(lss.simulate(tmp_path / "simulation.json", settle=3.0))
    for other in ways[1:]:
        assert np.array_equal(ways[0].channels["joint_xi"], other.channels["joint_xi"])
    heavy = layout.simulation.with_set({"cart.mass_kg": 60})
    assert heavy.parameters["cart.mass_kg"] == 60.0 and layout.simulation.parameters["cart.mass_kg"] != 60.0
    assert lss.simulate(heavy, settle=3.0).channels["run_left"].mean() > ways[0].channels["run_left"].mean()


def test_the_position_goes_on_by_a_lap_at_every_edge() -> None:
    found = simulated(laps=3)
    assert found.position is not None and found.simulation is not None
    lap = found.simulation.json["chain"]["track_length_m"]
    edges = np.flatnonzero(np.diff(found.channels["trigger"]) > 0)
    at = 0.5 * (found.position[edges] + found.position[edges + 1])
    np.testing.assert_allclose(np.diff(at), lap, rtol=1e-3)
    assert np.all(np.diff(found.position) > 0)
    assert at[0] == pytest.approx(found.sidecar["trigger_position"], abs=1e-2)


def test_a_run_is_a_frame_with_units() -> None:
    found = simulated()
    table = found.to_frame()
    assert list(table.columns)[0] == "time_s" and {"steer_left_n", "wheel_speed_run_left_rad_s", "trigger"} <= set(table.columns)
    assert len(table) == found.time.size
    assert np.array_equal(table["steer_left_n"].to_numpy(), found.channels["steer_left"])


def test_own_measurements_are_a_run(tmp_path: Path) -> None:
    time = np.arange(100) / 100.0
    sidecar = {"sensor_cart": 1, "speed_setpoint": 2.0, "trigger_position": 0.0, "lowpass": 40.0}
    mine = lss.Run(time, {"steer_left": np.sin(time), "trigger": time > 0.5}, sidecar=sidecar, name="mine")
    mine.write(tmp_path)
    read = lss.Run.read(tmp_path / "mine.csv")
    np.testing.assert_allclose(read.channels["steer_left"], np.sin(time), atol=1e-6)
    assert mine.position is None
    for wrong, why in (({"stear": time}, "no channel"), ({"steer_left": time[1:]}, "99 samples, time has 100")):
        with pytest.raises(ValueError, match=why):
            lss.Run(time, wrong, sidecar=sidecar).write(tmp_path)
    own = lss.Run(time, {"steer_left": time}, sidecar={**sidecar, "tension_setpoint": 400.0, "zeroed": ["steer_left"]})
    assert own.sidecar["tension_setpoint"] == 400.0 and own.sidecar["zeroed"] == ["steer_left"]
    with pytest.raises(ValueError, match='no channel "trigger"'):
        lss.Run(time, {"steer_left": time}, sidecar={**sidecar, "zeroed": ["trigger"]})
    with pytest.raises(ValueError, match="increase"):
        lss.Run(time[::-1], {"steer_left": time}, sidecar=sidecar).write(tmp_path)


def test_what_is_wrong_is_said() -> None:
    layout = lss.build(SMALL)
    cases = [
        ({"laps": 0}, "laps is 0"),
        ({"settle": -1.0}, "settle is -1"),
        ({"integrator": "euler"}, "verlet"),
        ({"set": {"cart.mas_kg": 1}}, "cart.mass_kg"),
        ({"law": "none"}, "contact_law"),
        ({"sensor_cart": 1000}, "sensor.cart"),
    ]
    for options, why in cases:
        with pytest.raises(ValueError, match=why):
            lss.simulate(layout, **options)  # type: ignore[arg-type]


def test_numerical_trouble_keeps_what_was_recorded(small: Path) -> None:
    with pytest.raises(lss.RunError, match="the simulation stopped") as raised:
        lss.simulate(small, settle=0.0, set={"joint.axial.stiffness_n_per_m_n": 1e3})
    assert "help:" in str(raised.value) and raised.value.run.time.size == 1


def test_supports_are_on_the_page(tmp_path: Path) -> None:
    layout = lss.build(SMALL.replace("  motors", "  supports every 3 m\n  motors"))
    with_them = lss.simulate(layout, settle=3.0, supports=True)
    with_them.write(tmp_path)
    assert "support" in (tmp_path / "lap.html").read_text(encoding="utf-8")
