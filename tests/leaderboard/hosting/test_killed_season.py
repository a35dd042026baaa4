"""Whatever is killed at whatever moment: nothing is lost, nothing is done twice, nothing is stuck."""

import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path

import httpx
import pytest
from sqlalchemy import func, select
from tests.leaderboard.agents import write_agent
from tests.leaderboard.conductor.season_promises import check_always, check_quiet
from tests.leaderboard.postgresql import PostgreSQL, missing, postgresql_server
from tests.leaderboard.seasons_made import make_season, team_with_member
from tests.ports import free_ports

from wildscav_leaderboard.accounts.service import new_token
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.conductor.validators import now
from wildscav_leaderboard.database.connection import Database, DatabaseError
from wildscav_leaderboard.matches.models import FINISHED, PLAYING, WAITING, Match, MatchResult
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.packing import pack

pytestmark = [pytest.mark.slow, pytest.mark.long]
MORE = """
matches = 2
waiting = 4

[deadlines]
attempts = 10

[web]
port = {port}
requests_per_minute = 100000
"""
PATIENCE = 600.0  # s
QUIET = 3600.0  # s until everything has ended after the last kill


def until(condition: Callable[[], bool], otherwise: str, longest: float = PATIENCE) -> None:
    """Wait for something.

    Args:
        otherwise: What is wrong if it does not come.
    """
    end = time.monotonic() + longest
    while not condition():
        assert time.monotonic() < end, otherwise
        time.sleep(0.5)


@contextmanager
def served(season: Season, url: str) -> Iterator[dict[str, int]]:
    """Serve a season until the end of the block by a process for each part; give their numbers."""
    environment = os.environ | {"WILDSCAV_SEASON_DATABASE": url, "WILDSCAV_QUIET": "1"}
    command = [str(Path(sys.executable).with_name("wildscav")), "season", "serve", str(season.folder)]
    with ExitStack() as stack:
        processes = {}
        for part in ("web", "conductor"):
            log = stack.enter_context((season.folder.parent / f"{part}.log").open("wb"))
            started = subprocess.Popen([*command, f"--{part}"], env=environment, stdout=log, stderr=log)
            processes[part] = started.pid
            stack.callback(started.wait, 60)
            stack.callback(started.terminate)
        yield processes


def children(process: int) -> list[int]:
    """Return the processes of Python that one of ours has started, but not its tracker of resources."""
    found: list[int] = []
    for task in Path(f"/proc/{process}/task").glob("*"):
        with suppress(OSError):
            found += map(int, (task / "children").read_text().split())
    return [one for one in found if b"spawn_main" in command_of(one)]


def command_of(process: int) -> bytes:
    with suppress(OSError):
        return Path(f"/proc/{process}/cmdline").read_bytes()
    return b""


def kill(kind: str, parts: dict[str, int], server: PostgreSQL | None, chance: random.Random) -> bool:
    """Kill a process of a kind, if there is one."""
    if kind == "database" and server is not None:
        server.stop("immediate")
        time.sleep(chance.uniform(0.0, 2.0))
        server.start()
        return True
    found = children(parts["web" if kind == "web" else "conductor"])
    if kind == "worker":
        # Not the agents: one that is killed has failed by its own fault, as far as anyone can see.
        found = [one for part in found for one in children(part)]
    with suppress(ProcessLookupError, IndexError):
        os.kill(chance.choice(found), signal.SIGKILL)
        return True
    return False


def is_quiet(database: Database, season: Season) -> bool:
    with suppress(DatabaseError), database.reading() as session:
        left = select(func.count()).where(Submission.state.in_(states.ON_THE_WAY))
        matches = select(func.count()).where(Match.state.in_((WAITING, PLAYING)))
        board = read_board(session, "navigation")
        is_shown = board is not None and all(row.rank is not None for row in board.rows)
        is_over = is_shown and not session.scalar(left) and not session.scalar(matches)
        return is_over and plan_ladders(session, season, now()) == 0  # what it plans here is not stored
    return False  # the database was killed just now


def is_taken(client: httpx.Client, archive: Path, token: str) -> bool:
    """Hand an archive in, as a patient client does until the season says that it is there."""
    headers = {"Authorization": f"Bearer {token}"}
    with suppress(httpx.HTTPError):
        answer = client.post("/api/v1/submissions", content=archive.read_bytes(), headers=headers)
        # It was stored before, and the answer was lost.
        return answer.status_code == 201 or "has the same content" in answer.text
    return False


def is_answered(client: httpx.Client) -> bool:
    with suppress(httpx.HTTPError):
        return client.get("/ready").status_code == client.get("/boards/navigation").status_code == 200
    return False


@pytest.mark.parametrize(
    "kind",
    ["sqlite", pytest.param("postgresql", marks=pytest.mark.skipif(bool(missing()), reason=missing()))],
)
def test_web_conductor_workers_and_database_are_killed(tmp_path: Path, kind: str) -> None:
    chance = random.Random(kind)  # noqa: S311 (no secret)
    port, archive = free_ports(), tmp_path / "walker.tar.gz"
    season = make_season(tmp_path / "season", MORE.format(port=port), current=True)
    pack(write_agent(tmp_path, "walker", tracks='["navigation", "battle"]'), archive)
    with ExitStack() as stack:
        server = stack.enter_context(postgresql_server()) if kind == "postgresql" else None
        database = Database(season.database_url if server is None else server.new_database())
        stack.callback(database.close)
        database.upgrade()
        with database.writing() as session:
            token = new_token(session, team_with_member(session, "foxes")[1], "storm", now())
        url = database.url.render_as_string(hide_password=False)
        parts = stack.enter_context(served(season, url))
        client = stack.enter_context(httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60))
        until(partial(is_answered, client), f"the season did not answer: see {tmp_path}")
        taken = partial(is_taken, client, archive, token)
        handing_in = threading.Thread(target=until, args=(taken, "the submission is not taken"))
        handing_in.start()
        stack.callback(handing_in.join)
        kinds = ["web", "conductor", "worker", *(["database"] if server else [])]
        for one in chance.sample(kinds, len(kinds)):
            time.sleep(chance.uniform(0.5, 3.0))
            until(partial(kill, one, parts, server, chance), f"there was no {one} to be killed")
        handing_in.join()
        until(taken, "what was stored is not known")  # as if its answer had been lost
        until(partial(is_quiet, database, season), f"the season is stuck: see {tmp_path}", QUIET)
        with database.reading() as session:
            check_always(session, season)
            check_quiet(session, season)
            assert [one.state for one in session.scalars(select(Submission))] == [states.ACTIVE]
            assert set(session.scalars(select(Match.state))) == {FINISHED}
            for result in session.scalars(select(MatchResult)):
                path = season.match_folder(result.match_id) / result.row["record"]
                assert record_digest(path.read_bytes()) == result.record
        until(partial(is_answered, client), f"the season did not answer: see {tmp_path}")
