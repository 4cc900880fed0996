"""The wheel as it is installed: command line, types, and what it does without pandas."""

import importlib
import json
import subprocess
import sys
from importlib import metadata, resources
from pathlib import Path

from conftest import SMALL, run


def test_the_command_line_has_the_exit_codes_of_the_binary(small: Path, tmp_path: Path) -> None:
    said = run("--version")
    assert (said.returncode, said.stdout.strip()) == (0, f"lss {metadata.version('lss')}")
    assert run("--help").returncode == 0 and "Usage: lss" in run("--help").stdout
    assert run("check", small).returncode == 0
    (tmp_path / "wrong.lss").write_text("layout {")
    assert run("check", tmp_path / "wrong.lss").returncode == 1
    assert run("check", tmp_path / "gone.lss").returncode == 2
    wrong = run("biuld")
    assert wrong.returncode == 2 and "unrecognized subcommand 'biuld'" in wrong.stderr
    assert run().returncode == 2
    module = subprocess.run([sys.executable, "-m", "lss", "--version"], capture_output=True, text=True, check=True)
    assert module.stdout == said.stdout
    # No line break at the end of what is printed: nothing is lost.
    listed = run("simulate", small, "--list-parameters")
    assert listed.returncode == 0 and "cart.mass_kg" in listed.stdout


def test_processes_that_the_command_line_starts_are_its_own(small: Path, tmp_path: Path) -> None:
    study = 'name = "two"\n[[sweep]]\nsteps = ["simulate"]\nfile = "small.lss"\n'
    (tmp_path / "study.toml").write_text(study + "[sweep.simulate]\nspeed = [1.9, 2.1]\nsettle = 2\n")
    for words in (["run"], ["collect"]):
        ran = run("study", *words, "study.toml", "-o", "out", at=tmp_path)
        assert ran.returncode == 0, ran.stderr
    rows = (tmp_path / "out" / "study.csv").read_text().splitlines()
    assert len(rows) == 3, rows


def test_without_pandas_all_but_tables_works(tmp_path: Path) -> None:
    code = f"""
import sys
sys.modules["pandas"] = None
import lss
layout = lss.build({SMALL!r})
run = lss.simulate(layout, settle=1.0)
assert layout.json["vertices"] and layout.bill_json["articles"] and layout.svg and run.position is not None
layout.write({str(tmp_path / "out")!r})
for table in (lambda: layout.bill, run.to_frame):
    try:
        table()
    except ImportError as why:
        assert "pip install pandas" in str(why), why
    else:
        raise SystemExit("a table without pandas")
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_wheel_carries_types_and_models_outside() -> None:
    files = resources.files("lss")
    assert (files / "py.typed").is_file() and (files / "_lss.pyi").is_file()
    assert callable(importlib.import_module("lss_model").effect)


def test_everything_public_has_words() -> None:
    import lss

    for name in lss.__all__:
        thing = getattr(lss, name)
        if name == "CHANNELS":
            continue
        assert thing.__doc__, name
        if isinstance(thing, type):
            for member, value in vars(thing).items():
                documented = value.fget if isinstance(value, property) else getattr(value, "func", value)
                if not member.startswith("_") and callable(documented):
                    assert documented.__doc__, f"{name}.{member}"
    assert lss.CHANNELS["steer_left"] == ("N", "contact force of the left steering wheel")
    assert json.dumps(dict(lss.CHANNELS))
