"""A season that is served for real, and whose processes are killed at random moments."""

import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import httpx
from sqlalchemy import func, select
from tests.leaderboard.agents import write_agent
from tests.leaderboard.conductor.season_promises import check_always, check_quiet
from tests.leaderboard.postgresql import PostgreSQL
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

PER_TEAM = 5  # submissions
MORE = """
matches = 2
waiting = 4

[deadlines]
attempts = 10

[web]
port = {port}
requests_per_minute = 100000
{database}
"""
START = 600.0  # s for the web server to answer first
QUIET = 3600.0  # s until everything has ended after the last kill


class KilledSeason:
    """A season in a folder, served by a process for the web and one for the conductor.

    Args:
        folder: An empty folder.
        submissions: How many are handed in.
        server: Its PostgreSQL server; None for SQLite.
        chance: Decides what is killed, and when.
    """

    def __init__(self, folder: Path, submissions: int, server: PostgreSQL | None, chance: random.Random):
        self._folder, self._server, self._chance = folder, server, chance
        self._submissions, self._teams = submissions, -(-submissions // PER_TEAM)
        self.port = free_ports()
        more = MORE.format(port=self.port, database="")
        self.season = with_quotas(make_season(folder / "season", more, current=True))
        self._url = self.season.database_url if server is None else server.new_database()
        self.database = Database(self._url)
        self.database.upgrade()
        with self.database.writing() as session:
            members = [team_with_member(session, f"team-{number}")[1] for number in range(self._teams)]
            self._tokens = [new_token(session, member, "storm", now()) for member in members]
        self._served: dict[str, subprocess.Popen[bytes]] = {}

    @contextmanager
    def served(self) -> Iterator[None]:
        """Serve the season until the end of the block."""
        environment = os.environ | {"WILDSCAV_SEASON_DATABASE": self._url, "WILDSCAV_QUIET": "1"}
        program = Path(sys.executable).with_name("wildscav")
        command = [str(program), "season", "serve", str(self.season.folder)]
        with ExitStack() as stack:
            for part in ("web", "conductor"):
                log = stack.enter_context((self._folder / f"{part}.log").open("wb"))
                self._served[part] = subprocess.Popen(
                    [*command, f"--{part}"], env=environment, stdout=log, stderr=log
                )
            try:
                yield
            finally:
                for process in self._served.values():
                    process.terminate()
                for process in self._served.values():
                    process.wait(60)

    def storm(self, rounds: int, pause: float = 3.0) -> None:
        """Hand everything in, and kill something again and again meanwhile.

        Args:
            rounds: How often something of each kind is killed.
            pause: Time between two kills, at most, s.

        Raises:
            AssertionError: The season was quiet before something of each kind was killed.
        """
        kinds = ["web", "conductor", "worker", *(["database"] if self._server else [])]
        self.wait_for_web()
        handing_in = threading.Thread(target=self.hand_everything_in)
        handing_in.start()
        for kind in self._chance.sample(rounds * kinds, rounds * len(kinds)):
            self._pause(pause)
            while not self.kill(kind):
                assert handing_in.is_alive() or not self._is_quiet(), f"there was no {kind} to be killed"
                self._pause(pause)
        handing_in.join()
        self.wait_until_quiet()

    def _pause(self, longest: float) -> None:
        time.sleep(self._chance.uniform(0.5, longest))

    def kill(self, kind: str) -> bool:
        """Kill a process of a kind, if there is one."""
        if kind == "database" and self._server is not None:
            self._server.stop("immediate")
            time.sleep(self._chance.uniform(0.0, 2.0))
            self._server.start()
            return True
        served = self._served["web" if kind == "web" else "conductor"].pid
        parts = [one for one in children(served) if is_part(one)]
        if kind == "worker":
            # Not the agents: one that is killed has failed by its own fault, as far as anyone can see.
            parts = [one for part in parts for one in descendants(part) if is_part(one)]
        if not parts:
            return False
        with suppress(ProcessLookupError):
            os.kill(self._chance.choice(parts), signal.SIGKILL)
        return True

    def hand_everything_in(self) -> None:
        """Hand in everything as a patient client does: again, until the season says that it is there."""
        for number in range(self._submissions):
            team = number % self._teams
            name = f"walker-{number}"
            tracks = '["navigation"]' if number % 5 else '["navigation", "battle"]'
            folder = write_agent(self._folder / "agents", name, tracks=tracks)
            with (folder / "agent.py").open("a") as file:
                file.write(f"\n# the submission {number}\n")
            path = self._folder / f"{name}.tar.gz"
            pack(folder, path)
            while not self._is_taken(path, self._tokens[team]):
                time.sleep(0.5)

    def _is_taken(self, path: Path, token: str) -> bool:
        with suppress(httpx.HTTPError):
            answer = httpx.post(
                f"http://127.0.0.1:{self.port}/api/v1/submissions",
                content=path.read_bytes(),
                headers={"Authorization": f"Bearer {token}"},
                timeout=60,
            )
            # It was stored before, and the answer was lost.
            return answer.status_code == 201 or "has the same content" in answer.text
        return False

    def wait_for_web(self) -> None:
        """Wait until the web server answers, with its database."""
        until = time.monotonic() + START
        while time.monotonic() < until:
            with suppress(httpx.HTTPError):
                if httpx.get(f"http://127.0.0.1:{self.port}/ready", timeout=5).status_code == 200:
                    return
            time.sleep(0.5)
        raise TimeoutError(f"the season did not answer: see {self._folder}")

    def wait_until_quiet(self) -> None:
        """Wait until nothing waits and nothing is played."""
        until = time.monotonic() + QUIET
        while time.monotonic() < until:
            if self._is_quiet():
                return
            time.sleep(1.0)
        raise TimeoutError(f"the season is stuck: see {self._folder}")

    def _is_quiet(self) -> bool:
        moving = (states.SUBMITTED, states.QUEUED, states.BUILDING, states.VALIDATING)
        with suppress(DatabaseError), self.database.reading() as session:
            left = select(func.count()).select_from(Submission).where(Submission.state.in_(moving))
            matches = select(func.count()).select_from(Match).where(Match.state.in_((WAITING, PLAYING)))
            if session.scalar(left) or session.scalar(matches):
                return False
            board = read_board(session, "navigation")
            if board is None or any(row.rank is None for row in board.rows):
                return False
            return plan_ladders(session, self.season, now()) == 0  # what it plans here is not stored
        return False  # the database was killed just now

    def check(self) -> None:
        """Check that nothing is lost, nothing was done twice, and nothing is stuck."""
        self.wait_for_web()
        with self.database.reading() as session:
            check_always(session, self.season)
            check_quiet(session, self.season)
            found = session.scalars(select(Submission)).all()
            assert len(found) == self._submissions
            assert len({one.digest for one in found}) == self._submissions
            assert {one.state for one in found} == {states.ACTIVE}
            assert set(session.scalars(select(Match.state))) == {FINISHED}
            for result in session.scalars(select(MatchResult)):
                path = self.season.match_folder(result.match_id) / result.row["record"]
                assert record_digest(path.read_bytes()) == result.record
        page = httpx.get(f"http://127.0.0.1:{self.port}/boards/navigation", timeout=30)
        assert page.status_code == 200


def with_quotas(season: Season) -> Season:
    """Let every team hand in and keep as much as it wants."""
    path = season.folder / "season.toml"
    text = path.read_text()
    path.write_text(text.replace("per_day = 3", "per_day = 100").replace("active = 2", "active = 100"))
    return Season.open(season.folder)


def children(process: int) -> list[int]:
    """Return the child processes of a process."""
    found: list[int] = []
    for task in Path(f"/proc/{process}/task").glob("*"):
        with suppress(OSError):
            found += map(int, (task / "children").read_text().split())
    return found


def descendants(process: int) -> list[int]:
    """Return all processes that a process started, and those that they started."""
    found = children(process)
    return found + [one for child in found for one in descendants(child)]


def is_part(process: int) -> bool:
    """Return whether a process is one of Python's that ours started, and not its tracker of resources."""
    with suppress(OSError):
        return b"spawn_main" in Path(f"/proc/{process}/cmdline").read_bytes()
    return False
