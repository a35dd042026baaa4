"""The tables of people who play against submissions: who may have one, and how each begins and ends."""

import os
import secrets
import select
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from prometheus_client import Counter, Gauge
from prometheus_client.core import Metric

from wildscav.errors import describe
from wildscav_leaderboard.playing.order import SEEDS, Order, Told
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import NotFoundError, RefusalError, TooMuchError
from wildscav_server import leftovers
from wildscav_server.monitoring.logs import Log
from wildscav_stage.playing.links import new_secret
from wildscav_stage.playing.room import NOT_VALID, is_code


class TableCounts:
    """How many tables there are, and how they ended."""

    def __init__(self) -> None:
        self._open = Gauge(
            "wildscav_season_tables",
            "Tables at which people play against submissions in this web process.",
            registry=None,
        )
        self._ended = Counter(
            "wildscav_season_tables_ended",
            "Tables that have ended: over, or failed.",
            ("outcome",),
            registry=None,
        )

    def open(self) -> None:
        """Count a table that was opened."""
        self._open.inc()

    def end(self, *, failed: bool) -> None:
        """Count the end of a table.

        Args:
            failed: Whether it ended because something went wrong.
        """
        self._open.dec()
        self._ended.labels("failed" if failed else "over").inc()

    def collect(self) -> Iterable[Metric]:
        """Return the counts for Prometheus."""
        yield from self._open.collect()
        yield from self._ended.collect()


PROGRAM = (sys.executable, "-m", "wildscav_leaderboard.playing.host")
STARTING, READY, ENDED = "starting", "ready", "ended"  # states of a table
LOOKS = 0.5  # s between two looks at a table's process
CHECKS = 5.0  # s between two checks whether its submission may still be played
START_TIME = 180.0  # s for a table to be ready; the first one after an update compiles the engine
SPARE = 30.0  # s beyond its session, after which a table that did not end by itself is ended
END_TIME = 10.0  # s for a process to end when it is told to
KNOWN = 600.0  # s for which an ended table can say why it ended
BROKEN = "something went wrong here, which the organizers can see in their log"
STOPPING = "the season's web server is stopping"
GONE = "this game is over, or its address is not complete: start another one on the page of a submission"


@dataclass(frozen=True)
class Wish:
    """What somebody wants to play."""

    person: str  # who: an account, or an address
    submission: int
    archive: str
    entrant: str
    title: str
    track: str
    base: str  # URL of the season's page, without a slash at its end


@dataclass
class OpenTable:
    """A person's table."""

    wish: Wish
    secret: str = field(default_factory=new_secret)  # of all its pages
    seat: str = field(default_factory=new_secret)  # of the person's seat
    state: str = STARTING
    code: str = ""  # by which guests come
    why: str = ""  # why it ends or has ended, one line
    failed: bool = False  # whether it ended because something went wrong
    socket: Path = Path()  # on which its site is served once it is ready
    changed_at: float = field(default_factory=time.monotonic)  # s, when its state changed last

    def change_to(self, state: str) -> None:
        """Take another state, and note when."""
        self.state, self.changed_at = state, time.monotonic()

    @property
    def path(self) -> str:
        """The path of the person's page."""
        return f"{self.base_path}play/{self.seat}"

    @property
    def base_path(self) -> str:
        """The path below which all its pages are."""
        return f"/play/{self.secret}/"


class Tables:
    """All tables of a web server. It is a context manager, which ends them.

    Args:
        log: Where the beginning and the end of each table is logged; None logs nothing.
        counts: Where they are counted; None counts for nobody.
    """

    def __init__(self, season: Season, log: Log | None = None, counts: TableCounts | None = None) -> None:
        self._season, self._log, self._counts = season, log, counts or TableCounts()
        self._tables: dict[str, OpenTable] = {}
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._stopping = threading.Event()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all tables, and wait until they have ended."""
        self._stopping.set()
        for thread in self._threads:
            thread.join()

    @property
    def running(self) -> int:
        """How many tables there are at present."""
        return sum(table.state != ENDED for table in self._tables.values())

    def find(self, secret: str) -> OpenTable:
        """Return the table with a secret; it may have ended a short time ago.

        Raises:
            NotFoundError: There is none.
        """
        found = self._tables.get(secret)
        if found is None:
            raise NotFoundError(GONE)
        return found

    def find_by_code(self, text: str) -> OpenTable:
        """Return the table whose guests come by a code that somebody typed.

        Raises:
            NotFoundError: There is none.
        """
        for table in list(self._tables.values()):
            if table.state == READY and not table.why and is_code(text, table.code):
                return table
        raise NotFoundError(NOT_VALID)

    def open(self, wish: Wish, refused: Callable[[], str] = str) -> OpenTable:
        """Open a table for a person, or return the one at which they play the same already.

        Args:
            refused: Returns why the submission may no longer be played; an empty text while it may.

        Raises:
            RefusalError: They have another table.
            TooMuchError: There are too many tables.
        """
        with self._lock:
            self._forget()
            running = [table for table in self._tables.values() if table.state != ENDED]
            own = next((table for table in running if table.wish.person == wish.person), None)
            if own is not None:
                return _same(own, wish)
            most = self._season.settings.play.tables
            if self._stopping.is_set():
                raise TooMuchError(f"{STOPPING}: try again in a minute")
            if len(running) >= most:
                people = "one person" if most == 1 else f"{most} people"
                raise TooMuchError(
                    f"{people} can play at one time, and nobody else: try again in a few minutes"
                )
            table = OpenTable(wish)
            self._tables[table.secret] = table
            # A thread of its own: a process ends when the thread ends that started it.
            thread = threading.Thread(target=self._run, args=(table, refused), daemon=True)
            self._threads = [one for one in self._threads if one.is_alive()] + [thread]
            thread.start()
        return table

    def _forget(self) -> None:
        """Forget the tables that ended long ago."""
        now = time.monotonic()
        for secret, table in list(self._tables.items()):
            if table.state == ENDED and now - table.changed_at > KNOWN:
                del self._tables[secret]

    def _run(self, table: OpenTable, refused: Callable[[], str]) -> None:
        """Run the process of a table to its end."""
        self._say("table_opens", table)
        self._counts.open()
        try:
            with leftovers.temporary_folder("table-") as folder:
                table.socket = folder / "web"
                with _started(self._order(table, folder)) as (process, lines):
                    self._watch(table, process, lines, refused)
        except OSError as error:
            table.failed, table.why = True, BROKEN
            self._say("table_broke", table, reason=describe(error))
        finally:
            table.why = table.why or "the game ended"
            self._counts.end(failed=table.failed)
            table.change_to(ENDED)
            self._say("table_closes", table, why=table.why)

    def _say(self, event: str, table: OpenTable, **values: str) -> None:
        if self._log is not None:
            self._log.info(event, submission=table.wish.submission, track=table.wish.track, **values)

    def _order(self, table: OpenTable, folder: Path) -> Order:
        wish, season = table.wish, self._season
        return Order(
            season=str(season.folder),
            settings=season.settings.model_dump_json(),
            socket=str(table.socket),
            records=str(folder / "records"),
            base=f"{wish.base}{table.base_path}",
            secret=table.seat,
            archive=wish.archive,
            entrant=wish.entrant,
            title=wish.title,
            track=wish.track,
            seed=secrets.randbelow(SEEDS),
        )

    def _watch(
        self, table: OpenTable, process: subprocess.Popen[bytes], lines: "_Lines", refused: Callable[[], str]
    ) -> None:
        """Wait until a table ends, or has to be ended."""
        checked = time.monotonic()
        longest = self._season.settings.play.session + SPARE
        while process.poll() is None and not table.why:
            for line in lines.read(LOOKS):
                self._note(table, line)
            now = time.monotonic()
            if now - checked >= CHECKS:
                checked, table.why = now, table.why or refused()
            if self._stopping.is_set():
                table.why = table.why or STOPPING
            elif now - table.changed_at > (longest if table.state == READY else START_TIME):
                table.failed, table.why = True, table.why or "the game did not answer in time"
        if not table.why:  # it died, perhaps with a last word
            for line in lines.read(0.0):
                self._note(table, line)
        if not table.why:
            table.failed, table.why = True, BROKEN

    def _note(self, table: OpenTable, line: bytes) -> None:
        """Note what the process of a table tells."""
        try:
            told = Told.model_validate_json(line)
        except ValueError:
            return  # a library's remark
        if told.state == "ready":
            table.code = told.code
            if table.state == STARTING:
                table.change_to(READY)
        elif told.state == "ended":
            table.why = told.why
        else:
            table.failed, table.why = True, BROKEN
            self._say("table_broke", table, reason=told.why)


class _Lines:
    """The lines that a process prints."""

    def __init__(self, output: int) -> None:
        self._output, self._rest = output, b""

    def read(self, seconds: float) -> list[bytes]:
        """Return the lines that have come within some seconds at most."""
        ready, _, _ = select.select([self._output], [], [], seconds)
        read = os.read(self._output, 65_536) if ready else b""
        if ready and not read:  # it is closed
            time.sleep(min(seconds, 0.1))
        *lines, self._rest = (self._rest + read).split(b"\n")
        return lines


@contextmanager
def _started(order: Order) -> Iterator[tuple[subprocess.Popen[bytes], _Lines]]:
    """Start the process of a table, and end it after the block."""
    (ordered, ordering), (told, telling) = os.pipe(), os.pipe()
    with os.fdopen(ordering, "wb") as orders, os.fdopen(told, "rb"):
        with os.fdopen(ordered, "rb"), os.fdopen(telling, "wb"):
            process = subprocess.Popen([*PROGRAM, str(os.getpid())], stdin=ordered, stdout=telling)
        try:
            orders.write(order.model_dump_json().encode())
            orders.close()
            yield process, _Lines(told)
        finally:
            process.terminate()
            try:
                process.wait(END_TIME)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _same(own: OpenTable, wish: Wish) -> OpenTable:
    """Return a person's table if it is the one that they want."""
    if (own.wish.submission, own.wish.track) != (wish.submission, wish.track):
        raise RefusalError(
            f"you play {own.wish.track} against {own.wish.title} already: close its page, and try again "
            "half a minute later"
        )
    return own
