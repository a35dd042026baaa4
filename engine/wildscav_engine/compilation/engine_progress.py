"""Progress of the engine's preparation, which on first use includes compiling it."""

import contextlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from wildscav_engine.compilation.notice import QUIET, Progress, progress_callback

PREPARING = "preparing the engine (the first time this compiles it, which takes up to two minutes)"
COMPILING = "compiling the engine for this machine, once"
MAKING = "making maps, which are kept for the next time"


Console = Any  # one of Rich, which the engine itself does not need


@contextmanager
def preparing(console: Console, *, is_said: bool = False) -> Iterator[None]:
    """Show the progress of preparing the engine: live in a terminal, else as a line if it takes a while.

    In a terminal, processes that are started meanwhile print no such line, because it would break the
    display. If ``is_said``, no line is printed either: something else, such as a log, reports it.
    """
    with contextlib.ExitStack() as stack:
        if is_said or console.is_terminal:
            stack.enter_context(silence())
        if console.is_terminal:
            stack.enter_context(_status(console))
        yield


@contextmanager
def _status(console: Console) -> Iterator[None]:
    with console.status(PREPARING) as status:

        def show(progress: Progress) -> None:
            functions = "function" if progress.kernels == 1 else "functions"
            done = progress.maps or f"{progress.kernels} {functions}, {progress.seconds:.0f} s"
            status.update(f"{MAKING if progress.maps else COMPILING}: {done}")

        with progress_callback(show):
            yield


@contextmanager
def silence() -> Iterator[None]:
    """Let the processes that are started meanwhile print nothing about compiling."""
    before = os.environ.get(QUIET)
    os.environ[QUIET] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[QUIET]
        else:
            os.environ[QUIET] = before
