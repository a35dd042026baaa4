"""Compiling as the notice hears of it, in the process of the tests and without a compiler."""

import threading

import pytest

from wildscav_engine.compilation import notice

PATIENCE = 60.0  # s


def compile_five(patch: pytest.MonkeyPatch) -> None:
    """Let five kernels be compiled, until after the first report of that."""
    reported, report = threading.Event(), notice._Reporter.report

    def note(reporter: notice._Reporter, progress: notice.Progress) -> None:
        report(reporter, progress)
        reported.set()

    patch.setattr(notice._Reporter, "report", note)
    notice.notice.begin(5)
    assert reported.wait(PATIENCE)
    notice.notice.end()
