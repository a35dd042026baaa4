"""Evaluations by a worker that is started once: each start of one costs three seconds of a core."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext

import pytest

from wildscav_evaluator.executors import local
from wildscav_evaluator.matches.jobs import Wanted
from wildscav_evaluator.matches.workers import Workers


class WarmWorkers(Workers):
    """A worker that compiles the engine once."""

    def __init__(self) -> None:
        super().__init__(1)

    def precompile(self, sensors: Iterable[Wanted] = ()) -> None:
        """Start the worker, if it is not there already."""
        if not self._workers:
            super().precompile(sensors)


@contextmanager
def playing_with(workers: WarmWorkers) -> Iterator[None]:
    """Let commands and sessions that run in this process play with this worker."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(local, "Workers", lambda *_: nullcontext(workers))
        yield
