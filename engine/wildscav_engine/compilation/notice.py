"""Messages to the user while kernels are compiled, whatever code called them, or maps are made.

With nothing compiled, the first step takes the better part of a minute. A line on stderr says so after
``MOMENT`` seconds, and another line says when it is done; in a terminal, lines in between report progress.
Of several processes that compile at once, such as the workers of one command, only one prints.
``WILDSCAV_QUIET=1`` silences all of them. A program with its own display, such as a progress bar, can receive
the progress instead (see ``progress_callback``).
"""

import atexit
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.compilation.caching.locks import Lock

QUIET = "WILDSCAV_QUIET"
MOMENT = 2.0  # s; shorter compilations are not reported
PAUSE = 10.0  # s between the lines in a terminal
REST = 2.0  # s without compiling, after which the compilation counts as done
TICK = 0.2  # s between updates of the progress


class Progress(NamedTuple):
    """The progress of a compilation, or of making maps."""

    kernels: int  # compiled in this process, or being compiled
    seconds: float  # since the compilation began
    is_done: bool
    maps: str = ""  # "made/all" if maps are made


class Notice:
    """Watches compilation in this process and reports its progress."""

    def __init__(self) -> None:
        self.callback: Callable[[Progress], None] | None = None  # replaces the lines
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._active = 0  # nested calls that wait for compiled code
        self._kernels = 0
        self._began = self._last = 0.0  # s, begin of this compilation and last activity
        self._end_requested = threading.Event()

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Mark a call that waits for compiled code; it is compiling if ``begin`` is called within it."""
        with self._lock:
            self._active += 1
        try:
            yield
        finally:
            with self._lock:
                self._active -= 1
                self._last = time.monotonic()

    def begin(self, kernels: int = 1) -> None:
        """Note that some kernels have to be compiled, or (with 0) that another process is compiling one."""
        with self._lock:
            self._kernels += kernels
            self._last = time.monotonic()
            if self._thread is None:
                self._kernels, self._began = kernels, self._last
                self._end_requested.clear()
                self._thread = threading.Thread(target=self._watch, name="wildscav-notice", daemon=True)
                self._thread.start()

    def end(self) -> None:
        """Report the end of the compilation now, if one is being reported."""
        thread = self._thread
        if thread is not None:
            self._end_requested.set()
            thread.join()

    def _watch(self) -> None:
        reporter = _Reporter(self.callback)
        while not self._is_over():
            reporter.report(self._progress(is_done=False))
            self._end_requested.wait(TICK)
        reporter.report(self._progress(is_done=True))

    def _is_over(self) -> bool:
        with self._lock:
            is_idle = not self._active and time.monotonic() - self._last > REST
            if is_idle or self._end_requested.is_set():
                self._thread = None
            return self._thread is None

    def _progress(self, *, is_done: bool) -> Progress:
        now = self._last if is_done or not self._active else time.monotonic()
        return Progress(self._kernels, now - self._began, is_done)

    def reset_after_fork(self) -> None:
        """Start over in a forked process, which does not have the reporting thread."""
        self.__init__()  # type: ignore[misc]


class MapNotice:
    """Reports how many maps of a start are made: often in a terminal or to a callback, else twice."""

    def __init__(self, maps: int) -> None:
        self._maps, self._began = maps, time.monotonic()
        self._printed_at: float | None = None  # s from the beginning to the last line

    def report(self, made: int) -> None:
        """Report the current progress."""
        seconds, is_due = time.monotonic() - self._began, False
        if notice.callback is not None:
            notice.callback(Progress(0, seconds, made == self._maps, f"{made}/{self._maps}"))
        elif self._printed_at is None:
            is_due = seconds >= MOMENT
        else:
            is_due = sys.stderr is not None and sys.stderr.isatty() and seconds >= self._printed_at + PAUSE
        if is_due and made < self._maps:
            self._printed_at = seconds
            self._print(f"made {made} of {self._maps} maps, which are kept for the next time")

    def end(self) -> None:
        """Report the end, if anything was reported before."""
        if self._printed_at is not None:
            self._print(f"made {self._maps} maps, after {time.monotonic() - self._began:.0f} s")

    def _print(self, text: str) -> None:
        if not os.environ.get(QUIET) and sys.stderr is not None:
            _print(text)


class _Reporter:
    """Reports one compilation, to stderr or to a callback."""

    def __init__(self, callback: Callable[[Progress], None] | None) -> None:
        self._callback = callback
        self._lock = Lock(cache_root() / f"telling-{_session()}.lock")
        self._is_silent = bool(os.environ.get(QUIET)) or sys.stderr is None
        self._printed_at: float | None = None  # s from the beginning to the last line

    def report(self, progress: Progress) -> None:
        """Report the current progress."""
        if self._callback is not None:
            self._callback(progress)
        elif not self._is_silent:
            self._print_progress(progress)

    def _print_progress(self, progress: Progress) -> None:
        if progress.is_done:
            if self._printed_at is not None:
                _print(f"compiled, after {progress.seconds:.0f} s")
                self._lock.release(removing=True)
        elif self._printed_at is None:
            if progress.seconds >= MOMENT:
                self._print_first_line(progress)
        elif sys.stderr.isatty() and progress.seconds >= self._printed_at + PAUSE:
            self._printed_at = progress.seconds
            kernels = "kernel" if progress.kernels == 1 else "kernels"
            _print(f"{progress.kernels} {kernels}, {progress.seconds:.0f} s")

    def _print_first_line(self, progress: Progress) -> None:
        self._is_silent = not self._lock.take()  # another process of this command reports it
        if not self._is_silent:
            self._printed_at = progress.seconds
            _print("compiling parts of the engine that this machine has not used yet, for up to two minutes")


def _print(text: str) -> None:
    try:
        sys.stderr.write(f"wildscav: {text}\n")
        sys.stderr.flush()
    except (OSError, ValueError):  # stderr is closed
        return


def _session() -> int:
    return os.getsid(0) if hasattr(os, "getsid") else os.getppid()


notice = Notice()
atexit.register(notice.end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=notice.reset_after_fork)


@contextmanager
def progress_callback(callback: Callable[[Progress], None]) -> Iterator[None]:
    """Pass the progress of compilation to a callback several times a second, instead of printing lines."""
    before, notice.callback = notice.callback, callback
    try:
        yield
    finally:
        notice.callback = before
