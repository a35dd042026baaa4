"""Files that pages show of matches, rendered once from their records and kept in a folder of bounded size.

They are rendered in processes that do nothing else, as Rerun keeps threads for every recording that a process
has made. What a page needs at once comes from one process; a replay, a poster and a video come from others.
Of each kind, at most so many run at one time, together with those of other servers that share the folder: the
name of the match gives the slot to render in, and a slot is a locked file. So two requests for one file
render it once, too.
"""

import contextlib
import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime, timedelta
from importlib.metadata import version
from pathlib import Path
from typing import Literal, NamedTuple, Self

from wildscav.errors import UserError
from wildscav.terminal.console import counted
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_stage.scene.document import TRAILS_VERSION
from wildscav_stage.scene.map_file import MAP_VERSION

KEY = re.compile(r"[A-Za-z0-9_-]{1,100}")
LIMIT = 2_000_000_000  # bytes
TIME_LIMIT = 900.0  # s for one process
MAX_WAITING = 200  # matches
RETRY_AFTER = timedelta(minutes=5)  # after a failure, a file is rendered again on request
SLOTS = ".slots"
SPEC = ".json"  # ending of a file with the MapSpec of what is rendered from a map alone
QUIET = "-quiet"  # ends the name of a match whose notes an organizer has hidden
PROGRESS = "progress"  # name of a file beside what is rendered, with the share that is done, in percent

State = Literal["waiting", "rendering", "ready", "failed"]


class Product(NamedTuple):
    """One kind of file that is rendered from a record."""

    name: str  # in ``render.RENDERERS``
    ending: str  # of its files' names: it changes when what is rendered changes
    work: str  # products of the same work are rendered together


PRODUCTS = {
    product.name: product
    for product in (
        Product("trails", f"trails-{TRAILS_VERSION}.json.gz", "page"),
        Product("map", f"map-{MAP_VERSION}.gz", "page"),
        Product("replay", f"replay-2-{version('rerun-sdk')}.rrd", "replay"),
        Product("poster", "poster-1.jpg", "poster"),
        Product("video", "video-2.mp4", "video"),
    )
}


class Rendering(NamedTuple):
    """How far a file is."""

    state: State
    detail: str = ""  # one line for a page: why it failed, or what is going on
    path: Path | None = None  # of the file, once it is ready


@dataclass
class Task:
    """Files of one match that are being rendered, or could not be."""

    state: State = "waiting"
    detail: str = ""
    asked_at: datetime | None = None  # the first request for them
    place: Path | None = None  # where they are being rendered


class RenderCache:
    """A folder of files rendered from records. It is a context manager, which stops what it renders.

    Args:
        folder: The folder, which is made.
        limit: Bytes of all files; the least recently used are removed.
        at_once: How many processes of each kind render at one time, for all servers that share the folder.
    """

    def __init__(self, folder: Path, limit: int = LIMIT, at_once: int = 1) -> None:
        self.folder, self.limit, self.at_once = folder, limit, at_once
        self._tasks: dict[str, Task] = {}
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = threading.Lock()
        self._threads: dict[str, ThreadPoolExecutor] = {}
        self._is_closed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop rendering. What is not complete leaves nothing behind."""
        with self._lock:
            self._is_closed = True
            for process in self._running:
                process.kill()
        for threads in self._threads.values():
            threads.shutdown(cancel_futures=True)

    def progress(self, product: str, key: str, source: Path | MapSpec, now: datetime) -> Rendering:
        """Return how far a file is, and have it rendered if nobody has asked for it yet.

        Args:
            product: A name in ``PRODUCTS``.
            key: The stable name of the match: letters, digits, - and _.
            source: The match's record; or of its map a spec, while there is no record yet.

        Raises:
            UserError: There is no such product, or the key is none.
        """
        path = self.folder / self.file_name(product, key)
        work = PRODUCTS[product].work
        name = f"{key}.{work}"
        with self._lock:
            if _touch(path):
                return Rendering("ready", "", path)
            task = self._tasks.get(name)
            if task is None or _is_stale(task, now):
                task = self._begin(work, key, source, now)
            return Rendering(task.state, task.detail or self._what_goes_on(task, name))

    def is_rendering(self, product: str, key: str) -> bool:
        """Return whether a file waits to be rendered here, or is being rendered."""
        with self._lock:
            task = self._tasks.get(f"{key}.{PRODUCTS[product].work}")
            return task is not None and task.state != "failed"

    def is_kept(self, product: str, key: str) -> bool:
        """Return whether a file is ready, without having it rendered or noting that it is used.

        Raises:
            UserError: There is no such product, or the key is none.
        """
        return (self.folder / self.file_name(product, key)).is_file()

    def file_name(self, product: str, key: str) -> str:
        """Return the name of a file in the folder.

        Raises:
            UserError: There is no such product, or the key is none.
        """
        if product not in PRODUCTS:
            raise UserError(f"no file of a match is called {product!r}; there are {', '.join(PRODUCTS)}")
        if not KEY.fullmatch(key):
            raise UserError(
                f"{key!r} is no name of a match: letters, digits, - and _ are allowed, 100 at most"
            )
        return f"{key}.{PRODUCTS[product].ending}"

    def _begin(self, work: str, key: str, source: Path | MapSpec, now: datetime) -> Task:
        """Queue the rendering of a match. The caller holds the lock."""
        waiting = sum(task.state == "waiting" for task in self._tasks.values())
        if self._is_closed or waiting >= MAX_WAITING:
            why = "the server is stopping" if self._is_closed else f"{waiting} matches are waiting already"
            return Task("failed", f"{why}: try again later", now)
        name = f"{key}.{work}"
        task = self._tasks[name] = Task(asked_at=now)
        slot = f"{work}-{zlib.crc32(name.encode()) % self.at_once}"
        if slot not in self._threads:
            self._threads[slot] = ThreadPoolExecutor(1, f"render-{slot}")
        self._threads[slot].submit(self._carry_out, task, work, key, source, slot)
        return task

    def _what_goes_on(self, task: Task, name: str) -> str:
        if task.state == "rendering":
            share = _share_done(task)
            return f"The match is being rendered{f': {share} %' if share else ''} …"
        ahead = sum(other.state in ("waiting", "rendering") for other in _before(self._tasks, name))
        return f"Waiting for {counted(ahead, 'other rendering')} …" if ahead else "Waiting …"

    def _carry_out(self, task: Task, work: str, key: str, source: Path | MapSpec, slot: str) -> None:
        """Render the files of a match, and note how it went. Runs in the thread of the slot."""
        try:
            with _slot(self.folder / SLOTS, slot) as (place, lock):
                # Another server may have made some meanwhile, and others may have been removed.
                products = [name for name, each in PRODUCTS.items() if each.work == work]
                if isinstance(source, MapSpec):
                    products, spec, source = ["map"], source, place / f"map{SPEC}"
                    source.write_text(spec.model_dump_json())
                names = {name: self.file_name(name, key) for name in products}
                wanted = {
                    name: place / file for name, file in names.items() if not (self.folder / file).exists()
                }
                if wanted:
                    task.state, task.place = "rendering", place
                    self._render(source, wanted, lock)
                for rendered in wanted.values():
                    self._take_in(rendered)
        except (UserError, OSError) as error:
            reason = error.strerror or str(error) if isinstance(error, OSError) else str(error)
            with self._lock:
                task.state, task.detail = "failed", reason
            return
        with self._lock:
            self._tasks.pop(f"{key}.{work}", None)

    def _render(self, record: Path, wanted: dict[str, Path], lock: int) -> None:
        """Run the process that renders files, given by their products.

        Raises:
            UserError: It failed; the message is one line for a page.
        """
        program = [sys.executable, "-m", "wildscav_leaderboard.spectating.render"]
        targets = [f"{product}={target}" for product, target in wanted.items()]
        with self._lock:
            if self._is_closed:
                raise UserError("the server is stopping: try again later")
            # It inherits the lock, so that nobody takes the slot before it has ended, whatever ends this one.
            process = subprocess.Popen(
                [*program, str(record), str(os.getpid()), *targets],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                pass_fds=(lock,),
            )
            self._running.add(process)
        try:
            _, said = process.communicate(timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            raise UserError(f"it was not rendered within {TIME_LIMIT / 60:g} minutes") from None
        finally:
            process.kill()
            process.communicate()
            with self._lock:
                self._running.discard(process)
        if process.returncode:
            raise UserError(_reason(process.returncode, said, record))

    def _take_in(self, rendered: Path) -> None:
        """Put a complete file into the cache, in place of those that were not used for the longest time.

        Raises:
            UserError: It is larger than the whole cache.
        """
        size = rendered.stat().st_size
        if size > self.limit:
            raise UserError(f"it has {size:,} bytes, and {self.limit:,} are allowed for all matches together")
        self._make_room(size)
        _touch(rendered)
        rendered.replace(self.folder / rendered.name)

    def _make_room(self, size: int) -> None:
        """Remove the least recently used files until there is room for some bytes."""
        with self._lock:
            kept = sorted(_files(self.folder), key=lambda each: each[1].st_mtime_ns)
            total = size + sum(stat.st_size for _, stat in kept)
            for path, stat in kept:
                if total <= self.limit:
                    break
                path.unlink(missing_ok=True)
                total -= stat.st_size


def _touch(path: Path) -> bool:
    """Note that a file is used; return whether it exists."""
    # The system's own stamp is as coarse as its ticks, and does not order what is quicker.
    used = time.time_ns()
    try:
        os.utime(path, ns=(used, used))
    except FileNotFoundError:
        return False
    return True


def _share_done(task: Task) -> str:
    """Return how much of a task is done in percent, if its renderer tells; else an empty text."""
    try:
        return "" if task.place is None else (task.place / PROGRESS).read_text("ascii")
    except FileNotFoundError:
        return ""


def _is_stale(task: Task, now: datetime) -> bool:
    return task.state == "failed" and task.asked_at is not None and now - task.asked_at >= RETRY_AFTER


def _before(tasks: dict[str, Task], name: str) -> Iterator[Task]:
    """Yield the tasks that were asked for before one."""
    for other, task in tasks.items():
        if other == name:
            return
        yield task


def _files(folder: Path) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield the files of a cache with their sizes and times; another server may remove some meanwhile."""
    for path in folder.iterdir():
        with contextlib.suppress(FileNotFoundError):
            if path.is_file():
                yield path, path.stat()


@contextlib.contextmanager
def _slot(folder: Path, name: str) -> Iterator[tuple[Path, int]]:
    """Wait for a slot, and give its empty folder and the descriptor of its lock."""
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / name
    with (folder / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        shutil.rmtree(place, ignore_errors=True)  # what a crash may have left
        place.mkdir()
        try:
            yield place, lock.fileno()
        finally:
            shutil.rmtree(place, ignore_errors=True)


def _reason(code: int, said: str, record: Path) -> str:
    """Return in one line why rendering failed, without the paths of the server."""
    if code < 0:
        return f"the renderer was ended by {signal.Signals(-code).name}"
    lines = said.strip().splitlines()
    last = lines[-1] if lines else f"the renderer ended with exit code {code}"
    return last.replace(str(record), "the record")
