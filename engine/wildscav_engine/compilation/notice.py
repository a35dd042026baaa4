"""Whoever waits for kernels to be compiled is told so, whatever called them.

With nothing compiled the first step takes the better part of a minute. A line on stderr says so once it has
taken a moment, and another one when it is done; in a terminal, lines in between tell how far it is. Of many
processes that compile at once, such as the workers of one command, only one speaks. ``WILDSCAV_QUIET=1``
silences all of them. A program that has something better to show, such as a progress bar, takes the figures.
"""

import atexit
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from wildscav_engine.compilation.cache_folders import cache_root
from wildscav_engine.compilation.locks import Lock

QUIET = "WILDSCAV_QUIET"
MOMENT = 2.0  # s; what takes no longer is worth no word
PAUSE = 10.0  # s between the lines in a terminal
REST = 2.0  # s without compiling, after which it counts as done
TICK = 0.2  # s between looks at how far it is


class Progress(NamedTuple):
    """How far the compiling is."""

    kernels: int  # compiled here, or under way
    seconds: float  # since it began
    is_done: bool


class Notice:
    """Watches the compiling of this process, and tells of it."""

    def __init__(self) -> None:
        self.tell: Callable[[Progress], None] | None = None  # instead of the lines
        self._lock = threading.Lock()
        self._teller: threading.Thread | None = None
        self._active = 0  # calls that wait for compiled code, one in another
        self._kernels = 0
        self._began = self._last = 0.0  # s, when this compiling began, and when it last went on
        self._ends = threading.Event()

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Count as compiling if ``begin`` is called within."""
        with self._lock:
            self._active += 1
        try:
            yield
        finally:
            with self._lock:
                self._active -= 1
                self._last = time.monotonic()

    def begin(self, kernels: int = 1) -> None:
        """Note that so many kernels have to be compiled, or that another process is at it."""
        with self._lock:
            self._kernels += kernels
            self._last = time.monotonic()
            if self._teller is None:
                self._kernels, self._began = kernels, self._last
                self._ends.clear()
                self._teller = threading.Thread(target=self._watch, name="wildscav-notice", daemon=True)
                self._teller.start()

    def end(self) -> None:
        """Say the last word now, if there is one."""
        teller = self._teller
        if teller is not None:
            self._ends.set()
            teller.join()

    def _watch(self) -> None:
        words = _Words(self.tell)
        while not self._is_over():
            words.say(self._progress(is_done=False))
            self._ends.wait(TICK)
        words.say(self._progress(is_done=True))

    def _is_over(self) -> bool:
        with self._lock:
            has_rested = not self._active and time.monotonic() - self._last > REST
            if has_rested or self._ends.is_set():
                self._teller = None
            return self._teller is None

    def _progress(self, *, is_done: bool) -> Progress:
        now = self._last if is_done or not self._active else time.monotonic()
        return Progress(self._kernels, now - self._began, is_done)

    def forget(self) -> None:
        """Begin anew, in a forked process: the thread that told is not in it."""
        self.__init__()  # type: ignore[misc]


class _Words:
    """What is said of one compiling, to stderr or to whoever asked for the figures."""

    def __init__(self, tell: Callable[[Progress], None] | None) -> None:
        self._tell = tell
        self._lock = Lock(cache_root() / f"telling-{_session()}.lock")
        self._is_silent = bool(os.environ.get(QUIET)) or sys.stderr is None
        self._said_at: float | None = None  # s since the beginning, of the last line

    def say(self, progress: Progress) -> None:
        """Say what there is to say by now."""
        if self._tell is not None:
            self._tell(progress)
        elif not self._is_silent:
            self._speak(progress)

    def _speak(self, progress: Progress) -> None:
        if progress.is_done:
            if self._said_at is not None:
                _print(f"compiled, after {progress.seconds:.0f} s")
                self._lock.release(removing=True)
        elif self._said_at is None:
            if progress.seconds >= MOMENT:
                self._begin(progress)
        elif sys.stderr.isatty() and progress.seconds >= self._said_at + PAUSE:
            self._said_at = progress.seconds
            _print(f"{progress.kernels} kernels, {progress.seconds:.0f} s")

    def _begin(self, progress: Progress) -> None:
        self._is_silent = not self._lock.take()  # another process of this command says it
        if not self._is_silent:
            self._said_at = progress.seconds
            _print("compiling the engine for this machine; this takes up to a minute, once")


def _print(text: str) -> None:
    try:
        sys.stderr.write(f"wildscav: {text}\n")
        sys.stderr.flush()
    except (OSError, ValueError):  # nobody reads it any more
        return


def _session() -> int:
    return os.getsid(0) if hasattr(os, "getsid") else os.getppid()


notice = Notice()
atexit.register(notice.end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=notice.forget)


@contextmanager
def telling(tell: Callable[[Progress], None]) -> Iterator[None]:
    """Take the figures of what is compiled meanwhile, several times a second, instead of lines on stderr."""
    before, notice.tell = notice.tell, tell
    try:
        yield
    finally:
        notice.tell = before
