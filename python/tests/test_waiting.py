"""What goes on while `lss` works: other threads, Ctrl-C, progress."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from conftest import SMALL, program

import lss

HARD = Path(__file__).parents[2] / "examples" / "hub.lss"

WAYS = {
    "build": "lss.build(HARD, nodes=10**9)",
    "simulate": "lss.simulate(lss.build(SMALL), laps=1_500)",
    "identify": "lss.identify(lss.simulate(lss.build(SMALL), laps=3), law='all')",
    "diagnose": "lss.diagnose(lss.simulate(lss.build(SMALL), laps=3))",
    "capacity": "lss.capacity(lss.build(WAVES), hours=5_000, replications=200)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for one child")
@pytest.mark.parametrize("way", WAYS)
def test_ctrl_c_stops_it(way: str) -> None:
    # The flag that stops work is heard before the process is asked to end: what is left running would hold it up.
    child = subprocess.Popen(
        [sys.executable, "-c", f"""
import signal, sys, time, pathlib
# A shell that starts things in the background has them ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.path.insert(0, {str(Path(__file__).parent)!r})
from conftest import SMALL
import lss
HARD = pathlib.Path({str(HARD)!r})
WAVES = HARD.parent / "waves.lss"
def told(done, total, words):
    print("working", flush=True)
try:
    {WAYS[way][:-1]}, progress=told)
except KeyboardInterrupt:
    print("stopped", flush=True)
else:
    print("done", flush=True)
"""],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "working\n", "it is done before it could be stopped"
    time.sleep(0.3)
    asked = time.monotonic()
    child.send_signal(signal.SIGINT)
    rest = child.stdout.read()
    waited = time.monotonic() - asked
    assert child.wait(timeout=60) == 0
    assert rest.splitlines()[-1] == "stopped", rest
    # Not how fast it is, but that it does not go on to its end, which is many minutes away.
    assert waited < 20, f"it took {waited:.1f} s"


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for one child")
def test_ctrl_c_stops_the_command_line(small: Path, tmp_path: Path) -> None:
    words = ["simulate", str(small), "-o", str(tmp_path / "out"), "--laps", "10000", "--settle", "0s"]
    # Few samples, as pages of long runs take their time.
    words += ["--set", "sensor.rate_hz=20", "--set", "sensor.lowpass_hz=5"]
    child = subprocess.Popen([*program(), *words], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    time.sleep(2.0)
    child.send_signal(signal.SIGINT)
    _, said = child.communicate(timeout=60)
    assert child.returncode == 1 and "interrupted after" in said
    assert (tmp_path / "out" / "run-01.csv").exists()
    build = subprocess.Popen([*program(), "build", str(HARD), "-o", str(tmp_path / "hard"), "--nodes", "1000000000"])
    time.sleep(2.0)
    build.send_signal(signal.SIGINT)
    assert build.wait(timeout=60) == -signal.SIGINT
    assert not (tmp_path / "hard").exists()


def test_other_threads_go_on() -> None:
    layout = lss.build(SMALL)
    done = threading.Event()

    def simulate() -> None:
        lss.simulate(layout, laps=60, progress=False)
        done.set()

    work = threading.Thread(target=simulate)
    count = 0
    work.start()
    while not done.is_set():
        count += 1
        time.sleep(1e-3)
    work.join()
    # A thread that holds the lock would let this one on only when it is done.
    assert count > 10


def test_progress_goes_to_a_callable_and_its_exception_stops_the_work() -> None:
    told: list[tuple[float, float | None, str]] = []
    lss.simulate(lss.build(SMALL), laps=60, progress=lambda *step: told.append(step))
    assert told and all(total == 1.0 and 0.0 <= done <= 1.0 for done, total, _ in told)
    assert "lap" in told[-1][2]

    class Enough(Exception):
        pass

    def stop(done: float, total: float | None, words: str) -> None:
        raise Enough

    with pytest.raises(Enough):
        lss.build(HARD, nodes=10**9, progress=stop)
    with pytest.raises(TypeError, match="callable"):
        lss.build(SMALL, progress=True)  # type: ignore[arg-type]


@pytest.mark.skipif(sys.platform == "win32", reason="there is no pseudo-terminal")
def test_a_bar_moves_on_a_terminal_alone() -> None:
    import fcntl
    import pty
    import struct
    import termios

    pytest.importorskip("tqdm")
    code = "import lss, conftest; lss.simulate(lss.build(conftest.SMALL), laps=30)"
    at = Path(__file__).parent
    ran = subprocess.run([sys.executable, "-c", code], cwd=at, capture_output=True, check=True)
    assert ran.stderr == b""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    child = subprocess.Popen([sys.executable, "-c", code], cwd=at, stderr=theirs)
    os.close(theirs)
    said = b""
    try:
        while part := os.read(ours, 4096):
            said += part
    except OSError:
        pass  # The other end is closed.
    os.close(ours)
    assert child.wait() == 0
    assert b"recording" in said
    # The bar is gone in the end.
    assert said.rstrip(b"\r").rsplit(b"\r", 1)[-1].strip() == b""
