"""A season's real web server without a conductor, and competitors who use it by command."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from tests.commands import Run, run_command
from tests.evaluator.results_by_hand import timing_of_a_seat
from tests.leaderboard.agents import write_agent
from tests.leaderboard.results_made import made_result, made_timing
from tests.leaderboard.seasons_made import changed, make_season, opened
from tests.leaderboard.spectating.served import served

from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match as PlayedMatch
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.accounts import service as accounts
from wildscav_leaderboard.accounts.passwords import hashed
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.matches.service import Entrant, PlayedRecord, Seat, add_ladder_match, deliver
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import service as submissions
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.service import make_team

PASSWORD = "a long password"  # noqa: S105
WIDE = 200  # characters of the terminal


@dataclass(frozen=True)
class Site:
    """A season that is served."""

    url: str
    season: Season
    database: Database
    folder: Path

    def token(self, name: str, team: str | None = None) -> str:
        """Make an account, perhaps with a team, and return a token of it."""
        now = datetime.now(UTC)
        with self.database.writing() as session:
            account = accounts.add_account(session, name, hashed(PASSWORD), "competitor", now)
            if team is not None:
                make_team(session, account, team, team.title(), now)
            return accounts.new_token(session, account, "test", now)

    def invitation(self) -> str:
        """Return the key of an invitation."""
        with self.database.writing() as session:
            return accounts.invite(session, "test", datetime.now(UTC))

    def move(self, submission: int, *states: str, **details: Any) -> None:
        """Move a submission through states, as a conductor does; details are of the last one."""
        with self.database.writing() as session:
            found = session.get_one(Submission, submission)
            for state in states:
                given = details if state == states[-1] else {}
                submissions.move(session, found, state, datetime.now(UTC), **given)

    def conducted(self, submission: int, *states: str, **details: Any) -> threading.Thread:
        """Move a submission that is still to be handed in through states, from another thread."""

        def conduct() -> None:
            for _ in range(1200):
                with self.database.reading() as session:
                    if session.get(Submission, submission) is not None:
                        break
                time.sleep(0.05)
            self.move(submission, *states, **details)

        thread = threading.Thread(target=conduct)
        thread.start()
        return thread

    def played(self, submission: int, number: int, log: str = "hello\n") -> int:
        """Let a submission have played a short battle of the ladder against a robot; return the match."""
        spec = MatchSpec(
            track="battle",
            map=MapSpec(config=MapConfig(size=40, houses=0), seed=1),
            seats=("submission", "fighter"),
            time_limit=2.0,
            seed=number,
        )
        now = datetime.now(UTC)
        with self.database.writing() as session:
            entrant = session.get_one(Submission, submission).entrant
            seats = {0: Entrant(entrant, submission), 1: Entrant("robot:fighter", None)}
            match = add_ladder_match(session, "battle", number, spec, seats, now)
            folder = self.season.match_folder(match.id)
            folder.mkdir(parents=True)
            played = PlayedMatch(spec)
            played.play_out()
            write_record(folder / "match.wsr", played, [entrant, "fighter"])
            (folder / "0.log").write_text(log)
            _deliver(session, match, entrant, folder / "match.wsr", now)
            return match.id


def _deliver(session: Any, match: Any, entrant: str, record: Path, now: datetime) -> None:
    seats = [Seat(0, entrant, None), Seat(1, "robot:fighter", None)]
    row, _, _ = made_result(match, seats, (0.0, 0.0))
    first = row.seats[0].model_copy(update={"log": "0.log"})
    row = row.model_copy(update={"record": record.name, "seats": (first, *row.seats[1:])})
    timing = made_timing(match, timing_of_a_seat(latency_p99=0.0125))
    stored = PlayedRecord(record_digest(record.read_bytes()), record.stat().st_size)
    deliver(session, match, None, row, timing, stored, metric_infos("battle")[0], now)


@contextmanager
def season_site(folder: Path, **changes: Any) -> Iterator[Site]:
    """Serve a season, perhaps with other settings than usual."""
    season = changed(make_season(folder / "season", current=True), **changes)
    with opened(season) as database, served(create_app(season, database)) as url:
        yield Site(url, season, database, folder)


@dataclass(frozen=True)
class Competitor:
    """Someone at a terminal, with a folder of settings of their own."""

    run: Run
    folder: Path
    site: Site

    def logged_in(self, name: str, team: str | None = None) -> "Competitor":
        """Log in as a new account."""
        self.told("login", self.site.url, "--token", self.site.token(name, team))
        return self

    def told(self, *words: object, **more: str) -> str:
        """Return what a command that works prints."""
        done = self.run(*words, **more)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def document(self, *words: object) -> Any:
        """Return the document that a command prints."""
        return json.loads(self.told(*words, "--json"))

    def refused(self, *words: object, code: int = 1, **more: str) -> str:
        """Return the line in which a command is refused."""
        done = self.run(*words, **more)
        assert (done.returncode, done.stderr.count("\n")) == (code, 1), done.stderr
        return done.stderr

    def submitted(self, name: str, *options: str, tracks: str = '["battle"]') -> int:
        """Submit a new agent, and return its number."""
        write_agent(self.folder, name, f"    # {name}\n    act = lambda self, seen: Action()\n", tracks)
        return int(self.told("submit", name, *options).split()[1].rstrip(":"))


@pytest.fixture
def competitor(site: Site, compiled: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Competitor:
    """A competitor in an empty folder, who is logged in nowhere."""
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))
    for name in ("WILDSCAV_SEASON", "WILDSCAV_ACCOUNT_TOKEN", "WILDSCAV_PASSWORD"):
        monkeypatch.delenv(name, raising=False)
    return Competitor(partial(run_command, cwd=tmp_path, columns=WIDE), tmp_path, site)
