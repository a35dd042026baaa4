"""Spectators of one live match of a season: all ask the web server for what is new, as its page does."""

import asyncio
import json
import tempfile
import time
from pathlib import Path
from statistics import median, quantiles

from benchmarks.services.large_season import Size, make_large_season
from benchmarks.services.load import read_answer
from benchmarks.services.service import children_of, free_port, processor_time, served, wait_for
from sqlalchemy import delete

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.run_job import HEARTBEAT_INTERVAL, SNAPSHOT_INTERVAL
from wildscav_evaluator.matches.snapshots import snapshot_of
from wildscav_leaderboard.matches.models import PLAYING, MatchResult
from wildscav_leaderboard.matches.models import Match as StoredMatch
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating.live import LiveMatches, key_of
from wildscav_stage.scene.document import values_of

POLL = 0.4  # s between an answer and the next question of a page (``POLL`` in the viewer's loading.ts)
OF_ONE_ADDRESS = 150  # spectators; the server takes 200 connections of each
SIZE = Size(10, 90, 100)
SEATS = ("fighter",) * 4
WARM_UP, SECONDS = 3.0, 8.0


class Spectators:
    """What all spectators saw after warming up."""

    def __init__(self, port: int, match: int) -> None:
        self.port, self.path = port, f"/api/v1/matches/{match}/trails?after="
        self.begun = time.perf_counter() + WARM_UP
        self.end = self.begun + SECONDS
        self.played: dict[int, float] = {}  # when each frame was played
        self.answers: list[float] = []  # s
        self.delays: list[float] = []  # s from the moment of a sample until it is there

    async def watch(self, number: int, count: int) -> None:
        """Watch as one of them."""
        await asyncio.sleep(POLL * number / count)
        here = (f"127.0.0.{2 + number // OF_ONE_ADDRESS}", 0)
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port, local_addr=here, limit=1 << 22)
        cursor = ""
        while time.perf_counter() < self.end:
            asked = time.perf_counter()
            writer.write(f"GET {self.path}{cursor} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
            status, body = await read_answer(reader)
            if status == 200:  # 202 before the first heartbeat
                document = json.loads(body)
                cursor = document["cursor"]
                self._note(asked, values_of(document["samples"]["frames"]))
            await asyncio.sleep(POLL)
        writer.close()

    def _note(self, asked: float, frames: list[int]) -> None:
        now = time.perf_counter()
        if asked > self.begun:
            self.answers.append(now - asked)
            self.delays += [now - self.played[frame] for frame in frames if self.played[frame] > self.begun]

    async def play(self, live: LiveMatches, key: str, spec: MatchSpec) -> None:
        """Play the match at its pace, and write what spectators see, as a worker and the conductor do."""
        match, snapshots = Match(spec), []
        started = told = time.perf_counter()
        while time.perf_counter() < self.end:
            match.step(no_actions(len(SEATS)))
            snapshots.append(snapshot_of(match))
            self.played[match.frame] = time.perf_counter()
            if time.perf_counter() > told + HEARTBEAT_INTERVAL:
                live.add(key, spec, SEATS, snapshots)
                told, snapshots = time.perf_counter(), []
            await asyncio.sleep(started + SNAPSHOT_INTERVAL * match.step_number - time.perf_counter())


def spectators(count: int) -> dict[str, float]:
    """Measure spectators of a battle of four, with a connection each."""
    with tempfile.TemporaryDirectory() as folder:
        season, _, _ = make_large_season(Path(folder) / "season", free_port(), SIZE)
        spec = _play_last(season)
        port = season.settings.web.port
        with served(season, "web") as web:
            wait_for(f"http://127.0.0.1:{port}/ready")
            (server,) = children_of(web.pid)
            return asyncio.run(_measure(season, spec, server, count))


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


async def _measure(season: Season, spec: MatchSpec, server: int, count: int) -> dict[str, float]:
    watching = Spectators(season.settings.web.port, SIZE.matches)
    tasks = [watching.watch(number, count) for number in range(count)]
    playing = watching.play(LiveMatches(season.live), key_of(SIZE.matches), spec)
    used = asyncio.create_task(_processor_time(server))
    await asyncio.gather(playing, *tasks)
    return {
        "answer": median(watching.answers),
        "answer_95": quantiles(watching.answers, n=20)[-1],
        "delay": median(watching.delays),
        "answers_a_second": len(watching.answers) / SECONDS,
        "server_milliseconds": 1000 * await used * SECONDS / len(watching.answers),
    }


async def _processor_time(server: int) -> float:
    """Return the share of a core that the web server uses after warming up."""
    await asyncio.sleep(WARM_UP)
    before, started = processor_time(server), time.perf_counter()
    await asyncio.sleep(SECONDS - 0.5)
    return (processor_time(server) - before) / (time.perf_counter() - started)
