"""The command line in the process of the tests, which has the engine loaded."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from rich.console import Console

from wildscav.cli.main import main


class Done(NamedTuple):
    """What the command said, and its exit code."""

    returncode: int
    stdout: str
    stderr: str


def command_here(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., Done]:
    """Return what runs a command of wildscav with some arguments, in a folder."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr("wildscav.terminal.console.console", Console(width=200))
    monkeypatch.setattr("wildscav.terminal.console.error_console", Console(width=200, stderr=True))

    def run(*arguments: object) -> Done:
        monkeypatch.setattr(sys, "argv", ["wildscav", name, *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return Done(int(ended.value.code or 0), *capsys.readouterr())

    return run
