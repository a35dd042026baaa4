"""How quickly a season is served that has 1,000 submissions and 100,000 results, while its conductor runs.

For comparison, a bare FastAPI application with one route is served with the same settings.
"""

import asyncio
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import httpx
import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, children_of, free_port, processor_time, publish
from benchmarks.services import large_season
from sqlalchemy import func, select

from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.conductor.conductor import now
from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.seasons.folder import Season

PAGES = {
    "board page": "/boards/navigation",
    "board page of a ladder": "/boards/battle",
    "board in the API": "/api/v1/boards/navigation",
    "home page": "/",
    "match page": "/matches/95000",
    "submission page": "/submissions/500",
}
CONNECTIONS = 8
RATE = 50.0  # requests a second at which latencies are measured
START = 600.0  # s
HELLO = """
import sys, uvicorn
from fastapi import FastAPI
from fastapi.responses import HTMLResponse
app = FastAPI()
@app.get("/", response_class=HTMLResponse)
def hello() -> str:
    return "hello"
given = {"port": int(sys.argv[1]), "log_level": "warning", "access_log": False, "server_header": False}
uvicorn.run(app, host="127.0.0.1", **given)
"""


@dataclass
class Load:
    """What a server did under a load."""

    latencies: list[float] = field(default_factory=list)  # s
    seconds: float = 0.0
    failures: int = 0  # answers that were not 200
    size: int = 0  # bytes of a body

    @property
    def rate(self) -> float:
        """Requests a second."""
        return len(self.latencies) / self.seconds

    def percentile(self, share: float) -> float:
        """Return a percentile of the latencies, ms."""
        return 1000.0 * float(np.percentile(self.latencies, share))


def ask(port: int, path: str, *, seconds: float, connections: int, rate: float | None) -> Load:
    """Ask a server on this machine for a page for some time; each connection waits for its answer.

    Latencies count from when each request was due by the rate a second; None for as many as possible.
    """
    return asyncio.run(_ask(port, path, seconds, connections, rate))


async def _ask(port: int, path: str, seconds: float, connections: int, rate: float | None) -> Load:
    load = Load()
    request = f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
    begun = time.perf_counter()
    due = iter(range(10**9))

    async def go_on() -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 22)
        try:
            while True:
                start = begun + next(due) / rate if rate else time.perf_counter()
                if max(start, time.perf_counter()) >= begun + seconds:
                    return
                await asyncio.sleep(max(0.0, start - time.perf_counter()))
                writer.write(request)
                status, body = await read_answer(reader)
                load.size = len(body)
                load.latencies.append(time.perf_counter() - start)
                load.failures += status != 200
        finally:
            writer.close()

    await asyncio.gather(*(go_on() for _ in range(connections)))
    load.seconds = time.perf_counter() - begun
    return load


async def read_answer(reader: asyncio.StreamReader) -> tuple[int, bytes]:
    """Read an answer; return its status and its body."""
    head = await reader.readuntil(b"\r\n\r\n")
    size = int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])
    return int(head.split(b" ", 2)[1]), await reader.readexactly(size)


def main(
    seconds: Annotated[float, typer.Option(help="For each page and load.")] = 10.0,
    folder: Annotated[Path | None, typer.Option(help="Keep the season here, and use it again.")] = None,
    json_file: JsonFile = None,
) -> None:
    """Print latencies and rates of pages."""
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(TemporaryDirectory()))
        season = _season(place)
        figures = _refreshing(season)
        port = season.settings.web.port
        stack.enter_context(served(season, "conductor"))
        web = stack.enter_context(served(season, "web"))
        peer = stack.enter_context(_hello())
        wait_for(f"http://127.0.0.1:{port}/ready")
        wait_for(f"http://127.0.0.1:{peer}/")
        _wait_for_conductor(season)
        (server,) = children_of(web.pid)
        hello = ask(peer, "/", seconds=seconds, connections=CONNECTIONS, rate=None)
        figures.append(Figure("bare FastAPI route: sustained", hello.rate, "requests/s"))
        for name, path in PAGES.items():
            figures += _page(name, port, path, seconds, hello, server)
    publish("A season of 1,000 submissions and 100,000 results in SQLite", figures, json_file)


def _season(place: Path) -> Season:
    """Return the season; make it if it is not there."""
    folder, part = place / "season", place / "season.part"
    if not folder.exists():
        shutil.rmtree(part, ignore_errors=True)  # of a run that was interrupted
        large_season.make_large_season(part, free_port())
        part.rename(folder)
    return Season.open(folder)


def _refreshing(season: Season) -> list[Figure]:
    """Measure how long the boards take; they are computed here for the first time."""
    database = season.database()
    figures = []
    for name in ("of everything", "when nothing is new"):
        begun = time.process_time()
        with database.writing() as session:
            refresh(session, season, now())
        figures.append(Figure(f"boards, {name}: processor time", time.process_time() - begun, "s"))
    with database.reading() as session:
        results = session.scalar(select(func.count()).select_from(MatchResult)) or 0
        board = read_board(session, "navigation")
    if board is None or len(board.rows) != large_season.LARGE.submissions // large_season.PER_TEAM:
        raise RuntimeError("the board lacks rows")
    database.close()
    return [Figure("results", results, ""), *figures]


def _page(name: str, port: int, path: str, seconds: float, hello: Load, server: int) -> list[Figure]:
    ask(port, path, seconds=1.0, connections=1, rate=None)  # first come caches
    steady = ask(port, path, seconds=seconds, connections=CONNECTIONS, rate=RATE)
    before = processor_time(server)
    most = ask(port, path, seconds=seconds, connections=CONNECTIONS, rate=None)
    used = 1000.0 * (processor_time(server) - before) / len(most.latencies)
    if steady.failures or most.failures:
        raise RuntimeError(f"{path} was not answered")
    ratio, size = f"{most.rate / hello.rate:.2f} of the bare route", f"{most.size:,} bytes"
    return [
        Figure(f"{name}: median at {RATE:.0f} requests/s", steady.percentile(50), "ms", size),
        Figure(f"{name}: 99th percentile", steady.percentile(99), "ms"),
        Figure(f"{name}: sustained", most.rate, "requests/s", ratio),
        Figure(f"{name}: processor time", used, "ms"),
    ]


@contextmanager
def served(season: Season, part: str) -> Iterator[subprocess.Popen[bytes]]:
    """Serve a part of a season, ``web`` or ``conductor``, in processes of its own."""
    program = Path(sys.executable).with_name("wildscav")
    command = [str(program), "season", "serve", str(season.folder), f"--{part}"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.terminate()


@contextmanager
def _hello() -> Iterator[int]:
    port = free_port()
    with subprocess.Popen([sys.executable, "-c", HELLO, str(port)]) as process:
        try:
            yield port
        finally:
            process.send_signal(signal.SIGTERM)


def wait_for(address: str) -> None:
    """Wait until a server answers."""
    until = time.monotonic() + START
    while time.monotonic() < until:
        try:
            if httpx.get(address, timeout=10).status_code == 200:
                return
        except httpx.HTTPError:
            time.sleep(0.2)
    raise TimeoutError(f"{address} does not answer")


def _wait_for_conductor(season: Season) -> None:
    database, until = season.database(), time.monotonic() + START
    while time.monotonic() < until:
        with database.reading() as session:
            if holder_of(session, now()) is not None:
                database.close()
                return
        time.sleep(0.5)
    raise TimeoutError("nobody conducts the season")


if __name__ == "__main__":
    typer.run(main)
