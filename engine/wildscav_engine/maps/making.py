"""Making many maps at once: in this process, and in others that put them into the cache on disk.

Threads would gain nothing: much of the work is Python, and after each of many short kernels a thread would
wait for Python's lock. As another process takes a while to start, few or small maps are made here alone.
"""

import json
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from threading import Thread
from types import TracebackType
from typing import IO, TypeVar, cast

from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.compilation.caching.locks import Lock
from wildscav_engine.compilation.notice import MapNotice
from wildscav_engine.maps.cache import folder, load_cached, path_of, store
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.parallel.threads import cores
from wildscav_engine.specs.map_spec import MapSpec

THREAD = "wildscav-maps"  # the name of each thread that serves another process
WORTH = 3.0  # s of work for each further process: twice as long as it takes to start

Choices = Sequence[MapSpec]  # specs to try in turn; the first that can be generated is the map
Made = TypeVar("Made")


def first_made(choices: Choices, make: Callable[[MapSpec], Made]) -> Made:
    """Return what ``make`` returns for the first spec that can be generated.

    Raises:
        MapError: None can; the message is that of the last.
    """
    for spec in choices[:-1]:
        with suppress(MapError):
            return make(spec)
    return make(choices[-1])


def make_maps(maps: Mapping[int, Choices], make: Callable[[int], object]) -> None:
    """Make maps that are not cached: each either here or in another process, which only caches it.

    Of all processes of this machine, only one starts others for this. A person is shown the progress.

    Args:
        maps: The maps by their numbers.
        make: Makes the map of a number.

    Raises:
        MapError: A map that was made here cannot be made. If other processes fail, their maps are not cached.
    """
    left, made, notice = deque(maps), list[int](), MapNotice(len(maps))
    with ExitStack() as processes:
        processes.callback(left.clear)
        for place, number in enumerate(_each(left.popleft)):
            started = time.monotonic()
            make(number)
            made.append(number)
            notice.report(len(made))
            if place == 1:  # the first map may have waited for kernels
                seconds = (time.monotonic() - started) * len(left)
                _start_processes(processes, maps, left, made, seconds)
    notice.end()


def _start_processes(
    processes: ExitStack, maps: Mapping[int, Choices], left: deque[int], made: list[int], seconds: float
) -> None:
    """Start as many processes as are worth it for some seconds of work."""
    lock = Lock(cache_root() / "making.lock")
    processes.callback(lock.release)
    with suppress(OSError):
        for _ in range(min(cores() - 1, int(seconds / WORTH))):
            if lock.take():
                processes.enter_context(_Process(maps, left, made))


class _Process:
    """Another process, which makes the last of the maps that are left, until none are."""

    def __init__(self, maps: Mapping[int, Choices], left: deque[int], made: list[int]) -> None:
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__], stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True
        )
        self._has_begun = False
        self._thread = Thread(target=self._hand_out, args=(maps, left, made), name=THREAD, daemon=True)
        self._thread.start()

    def _hand_out(self, maps: Mapping[int, Choices], left: deque[int], made: list[int]) -> None:
        """Whenever the process asks, having made what it was given, give it the specs of a map."""
        numbers, requests = _each(left.pop), cast(IO[str], self._process.stdin)
        number: int | None = None
        with suppress(OSError):
            while cast(IO[str], self._process.stdout).readline():
                self._has_begun = True
                if number is not None:
                    made.append(number)
                number = next(numbers, None)
                if number is None:
                    return
                specs = [spec.model_dump(mode="json") for spec in maps[number]]
                requests.write(json.dumps(specs) + "\n")
                requests.flush()

    def __enter__(self) -> None:
        """Do nothing; the process runs already."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Wait for the map that the process is making, except after an error; then end it."""
        try:
            if kind is None and self._has_begun:
                self._thread.join()
        finally:
            with suppress(OSError), self._process:
                self._process.kill()
                self._thread.join()
            for part in folder().glob(f".*.{self._process.pid}.part"):
                part.unlink(missing_ok=True)  # of a map that it was writing


def _each(take: Callable[[], int]) -> Iterator[int]:
    """Yield numbers until there are none."""
    with suppress(IndexError):
        while True:
            yield take()


def _cache(spec: MapSpec) -> None:
    """Generate a map for the cache unless it is there; this ends the process if it cannot be cached."""
    if load_cached(spec) is None:
        store(generate_map(spec.config, spec.seed))
        path_of(spec).stat()


def _ask() -> str:
    """Ask for the next map with an empty line; the answer is a line with its specs, or nothing."""
    sys.stdout.write("\n")
    sys.stdout.flush()
    return sys.stdin.readline()


def main() -> None:
    """Cache one map after the other."""
    for line in iter(_ask, ""):
        with suppress(MapError):
            first_made([MapSpec.model_validate(spec) for spec in json.loads(line)], _cache)


if __name__ == "__main__":
    main()
