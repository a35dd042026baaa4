"""Compiling as the notice hears of it, in the process of the tests and without a compiler."""

import threading
import time
from collections.abc import Callable

import pytest

from wildscav_engine.compilation import notice

PATIENCE = 60.0  # s


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
