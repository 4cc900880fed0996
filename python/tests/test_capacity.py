"""`lss.capacity` and `lss.choose` beside the command line."""

import json
from pathlib import Path

import pytest
from conftest import run

import lss

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_capacity_is_that_of_the_command_line() -> None:
    path = EXAMPLES / "waves.lss"
    found = lss.capacity(path, hours=3, replications=2, threads=1)
    ran = run("capacity", path, "--hours", 3, "--replications", 2, "--format", "json")
    assert ran.returncode in (0, 1), ran.stderr
    assert found.json == json.loads(ran.stdout)
    assert found.per_hour <= 1.01 * found.bound and found.limited_by in found.text
    assert list(found.waves["name"]) == ["large", "small"]
    assert set(found.costs["cause"]) == {"stops", "failures", "changeover", "shares"}
    assert found.inductions["available"].between(0.9, 1.0).all() and len(found.chutes) == 40
    assert "<html" in found.html and "Waves" in found.html
    assert found._repr_html_().startswith("<p>batches: ") and found._repr_html_().count("<tr") > len(found.inductions)


def test_capacity_of_two_infeeds() -> None:
    layout = lss.build(EXAMPLES / "infeeds.lss")
    found = lss.capacity(layout, hours=2, replications=2)
    # 2 K / (K + 1) of the carriers that pass.
    assert found.bound == pytest.approx(4 / 3 * found.json["carriers_per_hour"])
    assert found.bound_in_any_proportions == found.bound
    assert found.per_hour == pytest.approx(found.bound, rel=0.01)


def test_mistakes_are_told(small: Path) -> None:
    with pytest.raises(lss.RunError, match="an induction and chutes"):
        lss.capacity(small)
    with pytest.raises(ValueError, match="hours"):
        lss.capacity(small, hours=0)
    with pytest.raises(lss.RunError, match="hours are too few"):
        lss.capacity(EXAMPLES / "waves.lss", hours=1)
    with pytest.raises(ValueError, match="two or three"):
        lss.choose(EXAMPLES / "choice.lss", pareto=["price"])
    with pytest.raises(ValueError, match="no measure"):
        lss.choose(EXAMPLES / "choice.lss", pareto=["price", "beauty"])


def test_choice_is_that_of_the_command_line(tmp_path: Path) -> None:
    path = EXAMPLES / "choice.lss"
    found = lss.choose(path, pareto=["price", "capacity"], checks=0)
    ran = run("choose", path, "--pareto", "price,capacity", "--checks", 0, "-o", tmp_path / "out")
    assert ran.returncode == 0, ran.stderr
    assert found.json == json.loads((tmp_path / "out" / "choice.json").read_text())
    assert found.text == (tmp_path / "out" / "layout.lss").read_text()
    assert found.choice is not None and found.choice["capacity_per_hour"] >= 7500
    assert f"<td>{found.choice['cart']}</td>" in found._repr_html_()
    assert len(found.candidates) >= found.json["candidates"]
