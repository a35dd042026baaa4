"""What a command shows while the engine is compiled: one thing at a time, where its user looks."""

import io
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.engine.compilation.compiling import compile_five

from wildscav.terminal.console import PlainConsole
from wildscav_engine.compilation import notice
from wildscav_engine.compilation.engine_progress import preparing

Prepared = tuple[str, list[str | None], list[str]]
Prepare = Callable[..., Prepared]


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Few kernels are worth a word, and nobody wants quiet."""
    monkeypatch.setattr(notice, "MOMENT", 0.0)
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("WILDSCAV_QUIET", raising=False)


@pytest.fixture
def prepare(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Prepare:
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
