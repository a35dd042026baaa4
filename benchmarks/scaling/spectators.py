"""Spectators of one live match of a season: all follow its stream, as its page does.

The match is played in a process of its own, at the pace of the game, and its news go through files to the web
server, as a worker and the conductor have it. One spectator of ten reads what it is sent.
"""

import asyncio
import multiprocessing
import re
import tempfile
import time
import zlib
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median, quantiles

from benchmarks.report import children_of, free_port, processor_time
from benchmarks.services.large_season import Size, make_large_season
from benchmarks.services.service import served, wait_for
from sqlalchemy import delete

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.run_job import SNAPSHOT_INTERVAL
from wildscav_evaluator.matches.snapshots import HEARTBEAT_INTERVAL, WatchedMatch
from wildscav_leaderboard.matches.models import PLAYING, MatchResult
from wildscav_leaderboard.matches.models import Match as StoredMatch
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_leaderboard.spectating.streams import OF_ONE

READ = 10  # spectators, of which one reads what it is sent
SIZE = Size(10, 90, 100)
SEATS = ("fighter",) * 4
JOIN, SECONDS = 4.0, 8.0  # s in which all come, and for which is measured
NEWEST = re.compile(rb'"samples":\{"frames":\[([\d,]+)\]')


def play(live: Path, spec: MatchSpec, pipe: Connection) -> None:
    """Play the match at its pace, and write its news; then send when each frame was played and was due."""
    match, writer, snapshots = WatchedMatch(spec), LiveMatches(live), []
    pipe.send("ready")
    started = told = time.perf_counter()
    times: dict[int, tuple[float, float]] = {}
    while (due := started + SNAPSHOT_INTERVAL * match.step_number) < started + JOIN + SECONDS:
        time.sleep(max(0.0, due - time.perf_counter()))
        match.step()
        times[match.frame] = (time.perf_counter(), due)
        snapshots.append(match.happenings.take())
        if time.perf_counter() > told + HEARTBEAT_INTERVAL:
            writer.add(key_of(SIZE.matches), spec, SEATS, snapshots)
            told, snapshots = time.perf_counter(), []
    pipe.send(times)


class Spectators:
    """What all spectators were sent after all had come."""

    def __init__(self, port: int) -> None:
        self.port, self.begun = port, time.perf_counter() + JOIN
        self.end = self.begun + SECONDS
        self.came: list[tuple[int, float]] = []  # frames, and when somebody read of them
        self.joined: list[float] = []  # s until the beginning was there
        self.bytes = 0

    async def watch(self, number: int, count: int) -> None:
        """Watch as one of them."""
        await asyncio.sleep(0.5 + (JOIN - 1.0) * number / count)
        here = (f"127.0.0.{2 + number // OF_ONE}", 0)
        asked = time.perf_counter()
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port, local_addr=here, limit=1 << 22)
        path = f"/api/v1/matches/{SIZE.matches}/live"
        writer.write(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n".encode())
        await reader.readuntil(b"\r\n\r\n")
        unpacked = zlib.decompressobj(zlib.MAX_WBITS | 16) if number % READ == 0 else None
        while time.perf_counter() < self.end:
            size = int(await reader.readline(), 16)
            part = (await reader.readexactly(size + 2))[:-2]
            now = time.perf_counter()
            if asked is not None and size > 10:  # more than how a compressed stream begins
                self.joined.append(now - asked)
                asked = None
            if now > self.begun:
                self.bytes += size
            if unpacked is not None:
                self._note(unpacked.decompress(part), now)
        writer.close()

    def _note(self, text: bytes, now: float) -> None:
        frame = 0
        for news in NEWEST.finditer(text):
            frame = 0
            for difference in news[1].split(b","):
                frame += int(difference)
                self.came.append((frame, now))


def spectators(count: int) -> dict[str, float]:
    """Measure spectators of a battle of four, with a stream each."""
    with tempfile.TemporaryDirectory() as folder:
        season = make_large_season(Path(folder) / "season", free_port(), SIZE)
        spec = _play_last(season)
        port = season.settings.web.port
        with served(season, "web") as web:
            wait_for(f"http://127.0.0.1:{port}/ready")
            (server,) = children_of(web.pid)
            here, there = multiprocessing.Pipe()
            context = multiprocessing.get_context("spawn")
            player = context.Process(target=play, args=(season.live, spec, there))
            player.start()
            here.recv()  # the map is made
            watching, used = asyncio.run(_watch(port, server, count))
            times = here.recv()
            player.join()
    return _figures(watching, times, used, count)


def _play_last(season: Season) -> MatchSpec:
    """Let the last match of the season be played; return a longer one on its map."""
    database = season.database()
    with database.writing() as session:
        session.execute(delete(MatchResult).filter_by(match_id=SIZE.matches))
        stored = session.get_one(StoredMatch, SIZE.matches)
        stored.state = PLAYING
        spec = MatchSpec.model_validate(stored.spec)
    database.close()
    return spec.model_copy(update={"time_limit": 600.0, "seats": SEATS})


async def _watch(port: int, server: int, count: int) -> tuple[Spectators, float]:
    watching = Spectators(port)
    used = asyncio.create_task(_processor_time(server))
    await asyncio.gather(*(watching.watch(number, count) for number in range(count)))
    return watching, await used


async def _processor_time(server: int) -> float:
    """Return the share of a core that the web server uses once all have come."""
    await asyncio.sleep(JOIN)
    before, started = processor_time(server), time.perf_counter()
    await asyncio.sleep(SECONDS - 0.5)
    return (processor_time(server) - before) / (time.perf_counter() - started)


def _figures(
    watching: Spectators, times: dict[int, tuple[float, float]], used: float, count: int
) -> dict[str, float]:
    late = [played - due for played, due in times.values()]
    played = {frame: moment for frame, (moment, _) in times.items() if moment > watching.begun}
    delays = [now - played[frame] for frame, now in watching.came if frame in played]
    return {
        "step_late_95": quantiles(late, n=20)[-1],
        "step_late_most": max(late),
        "join": median(watching.joined),
        "delay": median(delays),
        "delay_95": quantiles(delays, n=20)[-1],
        "delay_most": max(delays),
        "bytes_a_second": watching.bytes / count / SECONDS,
        "server_core": used,
        "server_milliseconds": 1000.0 * used / count,  # a second, for each spectator
    }
