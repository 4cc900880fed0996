"""`lss.build` beside `lss build`."""

import csv
import io
import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import LOOP, SMALL, run

import lss

FILES = ["layout.json", "simulation.json", "bom.csv", "bom.json", "drawing.svg", "drawing.png", "drawing.dxf"]


def test_files_are_those_of_the_command_line(loop: Path, tmp_path: Path) -> None:
    ran = run("build", loop, "-o", tmp_path / "cli", "--pdf", "--xlsx", "--gltf", "--report", "--stages", "--format", "json")
    assert ran.returncode == 0, ran.stderr
    layout = lss.build(loop)
    layout.write(tmp_path / "python", pdf=True, xlsx=True, gltf=True, report=True, stages=True)
    theirs = sorted(path.name for path in (tmp_path / "cli").iterdir() if not path.name.startswith("."))
    ours = sorted(path.name for path in (tmp_path / "python").iterdir() if not path.name.startswith("."))
    assert set(FILES) <= set(ours)
    # One option draws the stages as PDF where both are asked for.
    assert [name for name in theirs if name != "stages.pdf"] == [name for name in ours if name != "stages.pdf"]
    for name in ours:
        assert (tmp_path / "cli" / name).read_bytes() == (tmp_path / "python" / name).read_bytes(), name
    said = json.loads(ran.stdout)
    assert layout.length == said["length_m"] and layout.price == said["price_eur"]
    certificate = dict(layout.certificate or {})
    assert certificate.pop("seconds") >= 0.0
    del said["certificate"]["seconds"]
    assert certificate == said["certificate"]


def test_a_layout_tells_of_itself(loop: Path) -> None:
    layout = lss.build(str(loop))
    assert layout.name == "loop" and layout.feasible and "loop" in repr(layout)
    assert layout.certificate is not None and layout.certificate["proven"]
    assert layout.certificate["lower_bound_m"] <= layout.length + 1e-9
    assert layout.json["length_m"] == pytest.approx(layout.length, rel=1e-12)
    assert layout.mass > 0 and layout.footprint > 0 and layout.chain is not None
    assert layout.text is None and layout.route is None
    # A loop of four curves of the smallest radius: closed form of its length.
    radius = layout.vertices["radius_m"]
    straights = layout.sections["straight_m"].sum()
    assert layout.length == pytest.approx(straights + 0.5 * np.pi * radius.sum(), abs=1e-6)


def test_tables_say_what_the_files_say(loop: Path, tmp_path: Path) -> None:
    layout = lss.build(loop)
    layout.write(tmp_path / "out")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out" / "bom.csv").read_text())))
    assert list(layout.bill["article"]) == [row["article"] for row in rows]
    assert list(layout.bill["price_eur"]) == [float(row["price_eur"]) for row in rows]
    assert layout.bill["price_eur"].sum() == pytest.approx(layout.price)
    assert layout.bill["mass_kg"].sum() == pytest.approx(layout.mass)
    assert set(layout.beside["group"]) >= {"chain", "drive"}
    carts = layout.beside[layout.beside["description"].str.startswith("cart")]
    assert layout.chain is not None and carts["count"].tolist() == [layout.chain["carts"]]
    assert layout.elements["length_m"].sum() == pytest.approx(layout.length)
    assert {"x_m", "y_m", "s_m", "heading_deg"} <= set(layout.elements.columns)
    assert list(layout.stages["name"])[-1] == "stage3"
    assert len(layout.certificate_frame) == 1
    for table in (layout.vertices, layout.sections, layout.equipment, layout.contacts, layout.constraints):
        assert table is not None


def test_a_text_is_a_layout_as_a_file_is(loop: Path) -> None:
    assert lss.build(LOOP).json == lss.build(loop).json


def test_a_text_imports_from_the_working_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "carts.lss").write_text("use std.carts.tilt_tray\ncart own from tilt_tray(length: 1250 mm) { mass = 50 kg }\n")
    monkeypatch.chdir(tmp_path)
    text = 'use "carts.lss"\n' + SMALL.replace("use std.carts.tilt_tray\n", "")
    text = text.replace("cart tilt_tray(length: 1250 mm)", "cart own")
    layout = lss.build(text)
    assert layout.simulation.parameters["cart.mass_kg"] == 50.0


def test_a_let_gets_another_value(tmp_path: Path) -> None:
    text = SMALL.replace("layout small {", "let wide = 9 m\n\nlayout small {").replace("9 m) radius", "wide) radius")
    (tmp_path / "let.lss").write_text(text)
    ran = run("build", "let.lss", "-o", "out", "--let", "wide=11m", at=tmp_path)
    assert ran.returncode == 0, ran.stderr
    wider = json.loads((tmp_path / "out" / "layout.json").read_text())
    for source in (text, tmp_path / "let.lss"):
        assert lss.build(source, let={"wide": "11 m"}).json == wider
        assert lss.build(source).json != wider
        with pytest.raises(ValueError, match="wide"):
            lss.build(source, let={"wyde": "11 m"})


def test_the_drawing_is_svg(loop: Path) -> None:
    layout = lss.build(loop)
    assert layout._repr_svg_() == layout.svg
    assert ElementTree.fromstring(layout.svg).tag == "{http://www.w3.org/2000/svg}svg"


def test_mistakes_raise_what_the_terminal_shows(tmp_path: Path) -> None:
    path = tmp_path / "wrong.lss"
    path.write_text(LOOP.replace("speed 1.5 m/s", "speed 1.5 kg"))
    with pytest.raises(lss.LayoutError) as raised:
        lss.build(path)
    ran = run("build", path, "-o", tmp_path / "out")
    assert str(raised.value) == ran.stderr.strip()
    lines = run("build", path, "-o", tmp_path / "out", "--message-format", "json").stderr.splitlines()
    assert raised.value.diagnostics == [json.loads(line) for line in lines]
    assert raised.value.diagnostics[0]["code"] == "E0301" and raised.value.diagnostics[0]["line"] == 7
    assert raised.value.layout is None
    assert not (tmp_path / "out").exists()


def test_what_cannot_be_met_raises_with_the_best_layout() -> None:
    hall = "  building [(-5 m, -5 m), (20 m, -5 m), (20 m, 12 m), (-5 m, 12 m)]\n"
    text = LOOP.replace("  motors", hall + "  require length(P1..P2) >= 30 m\n  motors")
    with pytest.raises(lss.LayoutError) as raised:
        lss.build(text)
    found = raised.value.layout
    assert found is not None and not found.feasible and "NOT FEASIBLE" in repr(found)
    assert any(d["severity"] == "error" for d in raised.value.diagnostics)


def test_warnings_are_on_the_layout(small: Path) -> None:
    layout = lss.build(small)
    assert [d["code"] for d in layout.diagnostics] == ["W0712"] and "W0712" in layout.messages


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"could not read .*gone\.lss"):
        lss.build(tmp_path / "gone.lss")


def test_a_limit_of_time_ends_the_search() -> None:
    # No time at all: the best so far, with what is proven of it.
    layout = lss.build(LOOP, time_limit=0.0)
    assert layout.json["stages"][-1].get("cut") == "time"
    with pytest.raises(ValueError, match="time_limit"):
        lss.build(LOOP, time_limit=-1.0)


def test_a_folder_that_cannot_be_written_to(loop: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="could not write"):
        lss.build(loop).write(tmp_path / "file")
