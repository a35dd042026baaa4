"""What a command shows while the engine is compiled: one thing at a time, where its user looks."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from wildscav_engine.compilation.kernel import PLAIN

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")

# Compiles a few small kernels, without patience, so that they are worth a word. Prints what was shown on the
# console, and whether processes that are started meanwhile, and afterwards, are told to be quiet.
USE = """
import io, json, os, sys
from wildscav_engine.compilation import notice
notice.MOMENT = notice.PAUSE = 0.0
notice.TICK = 0.01
from wildscav.terminal.console import PlainConsole
from wildscav_engine.compilation.engine_progress import preparing
from wildscav_engine.arithmetic.elementary_functions import sine

is_terminal, is_said = json.loads(sys.argv[1])
console = PlainConsole(file=io.StringIO(), force_terminal=is_terminal, width=100)
quiet = []
with preparing(console, is_said=is_said):
    quiet.append(os.environ.get("WILDSCAV_QUIET"))
    sine(90.0)
    notice.notice.end()
quiet.append(os.environ.get("WILDSCAV_QUIET"))
print(json.dumps([console.file.getvalue(), quiet]))
"""


def prepare(
    cache: Path, *, is_terminal: bool, is_said: bool = False, **settings: str
) -> tuple[str, list[str | None], list[str]]:
    """Return what the console showed, who was to be quiet during that and afterwards, and what stderr got."""
    environment = {name: value for name, value in os.environ.items() if name != "WILDSCAV_QUIET"}
    done = subprocess.run(
        [sys.executable, "-c", USE, json.dumps([is_terminal, is_said])],
        env={**environment, "WILDSCAV_CACHE_DIR": str(cache), **settings},
        capture_output=True,
        text=True,
        check=True,
    )
    shown, quiet = json.loads(done.stdout)
    return shown, quiet, done.stderr.splitlines()


def test_a_terminal_shows_how_far_the_compiling_is_and_nothing_writes_into_that(tmp_path: Path) -> None:
    shown, quiet, lines = prepare(tmp_path, is_terminal=True)
    assert re.search(r"compiling the engine for this machine, once: 5 functions, \d+ s", shown)
    assert lines == []
    assert quiet == ["1", None]


def test_elsewhere_a_line_on_stderr_says_it(tmp_path: Path) -> None:
    shown, quiet, lines = prepare(tmp_path, is_terminal=False)
    assert [line.split()[1] for line in lines] == ["compiling", "compiled,"]
    assert shown == ""
    assert quiet == [None, None]


@pytest.mark.parametrize("quiet", [{}, {"WILDSCAV_QUIET": "yes"}], ids=["loud before", "quiet before"])
def test_where_a_log_says_it_nothing_else_does(tmp_path: Path, quiet: dict[str, str]) -> None:
    before = quiet.get("WILDSCAV_QUIET")
    assert prepare(tmp_path, is_terminal=False, is_said=True, **quiet) == ("", ["1", before], [])
