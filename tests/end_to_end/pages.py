"""The documentation's pages, as tests read them and run their commands."""

import re
import shlex
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
import typer
from tests.commands import run_command

from wildscav.cli import main

ROOT = Path(__file__).parents[2]
APART = ("metrics", "limits", "figures", "missing")  # what stands in them has names of its own


def blocks(page: Path, language: str) -> list[str]:
    """Return the contents of a page's blocks of code in one language, in order."""
    return re.findall(rf"```{language}\n(.*?)```", page.read_text("utf-8"), re.DOTALL)


def run_code(code: str, folder: Path) -> str:
    """Run Python in a folder and in this process, which has much of it imported; return what it prints."""
    with chdir(folder), redirect_stdout(StringIO()) as said:
        exec(compile(code, "page", "exec"), {"__name__": "__main__"})  # noqa: S102
    return said.getvalue()


def run_line(line: str, folder: Path, *more: str) -> str:
    """Run a line that calls `wildscav` in a folder, as a shell does, and return what it prints.

    Matches are played as on a machine with one core: a second worker takes longer to start than the matches
    of most lines take.

    Args:
        line: With commands in `$(…)`, and names with `*`.
        folder: Where it runs.
        more: Further arguments.
    """
    line = re.sub(r"\$\((.*?)\)", lambda found: run_line(found[1], folder).strip(), line)
    words = []
    for word in shlex.split(line, comments=True)[1:]:
        words += sorted(map(str, folder.glob(word))) if "*" in word else [word]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("wildscav_evaluator.executors.local.cores", lambda: 1)
        done = run_command(*words, *more, cwd=folder)
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
    return done.stdout


@cache
def json_documents() -> dict[str, set[str]]:
    """What the help of each command tells of its ``--json``, by the command and what it is about."""
    return dict(_documents(typer.main.get_command(main.app), ""))


def _documents(command: Any, path: str) -> Iterator[tuple[str, set[str]]]:
    for name in command.list_commands(None) if hasattr(command, "list_commands") else ():
        yield from _documents(command.get_command(None, name), f"{path} {name}".strip())
    if any("--json" in parameter.opts for parameter in command.params):
        told = re.findall(r"^With --json(?:, (.+?))?: (.*)$", command.help, re.MULTILINE)
        assert told, f"the help of `wildscav {path}` has no paragraph that begins with `With --json: `"
        for about, fields in told:
            yield f"{path} {about}".strip(), set(re.findall(r"`(\w+)`", fields))


def names(document: object) -> set[str]:
    """Every field of a document of ``--json``."""
    if isinstance(document, dict):
        inner = [names(value) for key, value in document.items() if key not in APART]
        return set(document).union(*inner)
    if isinstance(document, list):
        return set().union(*map(names, document))
    return set()
