"""The command `wildscav` in the process of the tests: another one would import for seconds what is here."""

import os
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from io import StringIO
from pathlib import Path
from subprocess import PIPE, CompletedProcess, Popen
from tempfile import TemporaryFile
from typing import IO

import pytest

from wildscav.cli import main
from wildscav.terminal.console import console, error_console

Done = CompletedProcess[str]
Run = Callable[..., Done]


def run_command(
    *arguments: object, cwd: Path | None = None, columns: int = 80, stdin: str = "", **env: str
) -> Done:
    """Run a command as a user does, and return its exit code and what it and its processes printed.

    Args:
        arguments: Of the command, without ``wildscav``.
        cwd: The working directory; this one if None.
        columns: The width of the terminal.
        stdin: What is typed.
        env: More variables of the environment.
    """
    given = [str(one) for one in arguments]
    with TemporaryFile("w+") as out, TemporaryFile("w+") as err, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["wildscav", *given])
        patch.setattr(sys, "stdin", StringIO(stdin))
        for name, value in env.items():
            patch.setenv(name, value)
        patch.setenv("COLUMNS", str(columns))  # for what prints with a console of its own
        for one in (console, error_console):
            patch.setattr(one, "width", columns)
        if cwd is not None:
            patch.chdir(cwd)
        with ExitStack() as stack:
            stack.enter_context(_into("stdout", 1, out))
            stack.enter_context(_into("stderr", 2, err))
            code = _exit_code()
        out.seek(0)
        err.seek(0)
        return CompletedProcess(given, code, out.read(), err.read())


@contextmanager
def running(*arguments: object, until: str) -> Iterator[tuple[str, "Popen[str]"]]:
    """Run a command in a process of its own; yield what its first line has of a pattern, and the process."""
    command = [sys.executable, "-m", "wildscav.cli.main", *map(str, arguments)]
    env = {**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"}
    with Popen(command, stdout=PIPE, stderr=PIPE, text=True, env=env) as process:
        try:
            assert process.stdout is not None
            found = re.search(until, process.stdout.readline())
            assert found, process.stderr and process.stderr.read()
            yield found[1], process
        finally:
            process.kill()


def _exit_code() -> int:
    try:
        main.main()
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException:  # noqa: BLE001 (as the interpreter does)
        traceback.print_exc()
        return 1
    return 0


@contextmanager
def _into(name: str, descriptor: int, file: IO[str]) -> Iterator[None]:
    """Let a stream and its descriptor lead into a file."""
    before, kept = getattr(sys, name), os.dup(descriptor)
    before.flush()
    os.dup2(file.fileno(), descriptor)
    try:
        with open(descriptor, "w", encoding="utf-8", buffering=1, closefd=False) as stream:
            setattr(sys, name, stream)
            yield
    finally:
        setattr(sys, name, before)
        os.dup2(kept, descriptor)
        os.close(kept)
