"""Whoever waits for kernels to be compiled is told so, once, and nobody else is."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from tests.engine.compilation.compiling import compile_five

from wildscav_engine.compilation import notice
from wildscav_engine.compilation.kernel import PLAIN

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")

# Without patience, so that a few small kernels are worth a word.
USE = """
from wildscav_engine.compilation import notice
notice.MOMENT = notice.PAUSE = 0.0
notice.TICK = 0.01
from wildscav_engine.arithmetic.elementary_functions import sine
sine(90.0)
"""
BEGINS = "wildscav: compiling parts of the engine that this machine has not used yet, for up to a minute"


def start(code: str, cache: Path, stderr: int = subprocess.PIPE, **settings: str) -> "subprocess.Popen[str]":
    environment = {name: value for name, value in os.environ.items() if name != "WILDSCAV_QUIET"}
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env={**environment, "WILDSCAV_CACHE_DIR": str(cache), **settings},
        stderr=stderr,
        text=True,
    )


def said_by(process: "subprocess.Popen[str]") -> list[str]:
    _, said = process.communicate()
    assert process.returncode == 0
    return said.splitlines()


@pytest.mark.slow
def test_of_processes_that_compile_one_says_so_and_that_it_is_done(tmp_path: Path) -> None:
    both = [said_by(process) for process in [start(USE, tmp_path) for _ in range(2)]]
    (begins, ends) = max(both, key=len)
    assert (begins, [lines.count(BEGINS) for lines in both].count(1)) == (BEGINS, 1)
    assert ends.startswith("wildscav: compiled, after ")
    assert said_by(start(USE, tmp_path)) == []  # it is kept
    assert not list(tmp_path.rglob("telling-*.lock"))


@pytest.mark.parametrize(
    ("quiet", "moment"), [("1", 0.0), ("", 1e9)], ids=["nobody wants to hear it", "it takes but a moment"]
)
def test_nothing_is_said_where(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    quiet: str,
    moment: float,
) -> None:
    monkeypatch.setattr(notice, "MOMENT", moment)
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("WILDSCAV_QUIET", quiet)
    compile_five(monkeypatch)
    assert capsys.readouterr().err == ""


def test_a_program_can_take_the_figures_instead(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told: list[notice.Progress] = []
    with notice.progress_callback(told.append):
        compile_five(monkeypatch)
    assert (told[-1].kernels, told[-1].is_done) == (5, True)
    assert capsys.readouterr().err == ""


def test_in_a_terminal_lines_tell_how_far_it_is(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    process = start(USE, tmp_path, stderr=theirs)
    process.wait()
    os.close(theirs)
    lines = os.read(ours, 100_000).decode().splitlines()
    os.close(ours)
    assert lines[0] == BEGINS
    assert len(lines) > 2
    assert all(" kernels, " in line for line in lines[1:-1])
