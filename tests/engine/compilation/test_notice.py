"""Whoever waits for kernels to be compiled is told so, once and where they look, and nobody else is."""

import io
import os
import pty
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav.terminal.console import PlainConsole
from wildscav_engine.compilation import notice
from wildscav_engine.compilation.engine_progress import preparing
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
PATIENCE = 60.0  # s
BEGINS = "wildscav: compiling parts of the engine that this machine has not used yet, for up to two minutes"


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


def compile_five(patch: pytest.MonkeyPatch, is_shown: Callable[[], bool] = lambda: True) -> None:
    """Let five kernels be compiled, until after the first report of that has been shown."""
    reported, report = threading.Event(), notice._Reporter.report

    def note(reporter: notice._Reporter, progress: notice.Progress) -> None:
        report(reporter, progress)
        reported.set()

    notice.notice.end()  # of what other tests compiled just before
    patch.setattr(notice._Reporter, "report", note)
    notice.notice.begin(5)
    assert reported.wait(PATIENCE)
    deadline = time.monotonic() + PATIENCE
    while not is_shown():
        assert time.monotonic() < deadline
        time.sleep(0.01)
    notice.notice.end()


@pytest.mark.slow
def test_of_processes_that_compile_one_says_so_and_that_it_is_done(tmp_path: Path) -> None:
    both = [said_by(process) for process in [start(USE, tmp_path) for _ in range(2)]]
    (begins, ends) = max(both, key=len)
    assert (begins, [lines.count(BEGINS) for lines in both].count(1)) == (BEGINS, 1)
    assert ends.startswith("wildscav: compiled, after ")
    assert said_by(start(USE, tmp_path)) == []  # it is kept
    assert not list(tmp_path.rglob("telling-*.lock"))


def test_in_a_terminal_lines_tell_how_far_it_is(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    process = start(USE, tmp_path, stderr=theirs)
    process.wait()
    os.close(theirs)
    lines = os.read(ours, 100_000).decode().splitlines()
    os.close(ours)
    assert lines[0] == BEGINS
    assert len(lines) > 2
    assert all(re.search(r" kernels?, ", line) for line in lines[1:-1])


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Few kernels are worth a word, and nobody wants quiet."""
    monkeypatch.setattr(notice, "MOMENT", 0.0)
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv(notice.QUIET, raising=False)


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize(
    ("quiet", "moment"), [("1", 0.0), ("", 1e9)], ids=["nobody wants to hear it", "it takes but a moment"]
)
def test_nothing_is_said_where(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], quiet: str, moment: float
) -> None:
    monkeypatch.setattr(notice, "MOMENT", moment)
    monkeypatch.setenv(notice.QUIET, quiet)
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


Prepared = tuple[str, list[str | None], list[str]]
Prepare = Callable[..., Prepared]


@pytest.fixture
def prepare(impatient: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Prepare:
    """Compile; return what the console showed, who was to be quiet during that and afterwards, and stderr."""

    def run(*, is_terminal: bool, is_said: bool = False) -> Prepared:
        file = io.StringIO()
        console = PlainConsole(file=file, force_terminal=is_terminal, width=100)
        with preparing(console, is_said=is_said):
            quiet = [os.environ.get("WILDSCAV_QUIET")]
            compile_five(monkeypatch, lambda: not is_terminal or "functions" in file.getvalue())
        quiet.append(os.environ.get("WILDSCAV_QUIET"))
        return file.getvalue(), quiet, capsys.readouterr().err.splitlines()

    return run


def test_a_terminal_shows_how_far_the_compiling_is_and_nothing_writes_into_that(prepare: Prepare) -> None:
    shown, quiet, lines = prepare(is_terminal=True)
    assert re.search(r"compiling the engine for this machine, once: 5 functions, \d+ s", shown)
    assert lines == []
    assert quiet == ["1", None]


def test_elsewhere_a_line_on_stderr_says_it(prepare: Prepare) -> None:
    shown, quiet, lines = prepare(is_terminal=False)
    assert [line.split()[1] for line in lines] == ["compiling", "compiled,"]
    assert shown == ""
    assert quiet == [None, None]


@pytest.mark.parametrize("before", [None, "yes"], ids=["loud before", "quiet before"])
def test_where_a_log_says_it_nothing_else_does(
    monkeypatch: pytest.MonkeyPatch, prepare: Prepare, before: str | None
) -> None:
    if before is not None:
        monkeypatch.setenv("WILDSCAV_QUIET", before)
    assert prepare(is_terminal=False, is_said=True) == ("", ["1", before], [])
