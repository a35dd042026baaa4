"""Whoever waits for kernels to be compiled is told so, once, and nobody else is."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from wildscav_engine.compilation.kernel import PLAIN
from wildscav_engine.compilation.notice import Progress

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")

# Without patience, so that a few small kernels are worth a word.
USE = """
from wildscav_engine.compilation import notice
notice.MOMENT = notice.PAUSE = 0.0
notice.TICK = 0.01
from wildscav_engine.arithmetic.elementary_functions import sine
sine(90.0)
"""
PATIENT = USE.replace("notice.MOMENT = notice.PAUSE = 0.0", "notice.MOMENT = 1e9")
TELLING = USE.replace(
    "sine(90", "told = []; context = notice.progress_callback(told.append); context.__enter__(); sine(90"
)
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


def test_of_processes_that_compile_one_says_so_and_that_it_is_done(tmp_path: Path) -> None:
    both = [said_by(process) for process in [start(USE, tmp_path) for _ in range(2)]]
    (begins, ends) = max(both, key=len)
    assert (begins, [lines.count(BEGINS) for lines in both].count(1)) == (BEGINS, 1)
    assert ends.startswith("wildscav: compiled, after ")
    assert said_by(start(USE, tmp_path)) == []  # it is kept
    assert not list(tmp_path.rglob("telling-*.lock"))


@pytest.mark.parametrize(
    ("code", "settings"),
    [(USE, {"WILDSCAV_QUIET": "1"}), (PATIENT, {})],
    ids=["nobody wants to hear it", "it takes but a moment"],
)
def test_nothing_is_said_where(code: str, settings: dict[str, str], tmp_path: Path) -> None:
    assert said_by(start(code, tmp_path, **settings)) == []


def test_a_program_can_take_the_figures_instead(tmp_path: Path) -> None:
    show = (
        "\nnotice.notice.end(); print([tuple(one) for one in told][-1][::2], file=__import__('sys').stderr)"
    )
    assert said_by(start(TELLING + show, tmp_path)) == ["(5, True)"]
    assert Progress._fields[::2] == ("kernels", "is_done")


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
