"""A season that a real conductor plays, with real agents: it is watched, audited, and ended."""

import json
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from tests.evaluator.sample_agents import WALKER
from tests.leaderboard.agents import write_agent
from tests.leaderboard.auditing.conftest import Run
from tests.leaderboard.made_once import made_once
from tests.leaderboard.real_conductor import LONGEST, conduct
from tests.leaderboard.seasons_made import make_season, submitted, team_with_member
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.validators import now
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.models import FINAL, FINISHED, LADDER, PLAYING, Match
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import PUBLISHED, Season
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.state import FINALIZED, read_state
from wildscav_leaderboard.spectating.live import LiveMatches, key_of

pytestmark = [pytest.mark.slow, pytest.mark.long]
SUITE_MATCHES = 4
SEEN = "seen.json"  # of each match that was seen while it was played: how many moments
TEAMS = ("foxes", "owls")
SLOW = """
    def act(self, observation):
        time.sleep(0.05)
        return Action(walk_direction=90.0, walk_speed=8.0)
"""
WILDSCAV = str(Path(sys.executable).parent / "wildscav")


def is_shown(session: Session) -> bool:
    """Return whether everything is played and on the boards."""
    boards = [read_board(session, track) for track in ("navigation", "battle")]
    rows = [row for board in boards if board is not None for row in board.rows if row.submission is not None]
    is_over = set(session.scalars(select(Match.state))) == {FINISHED}
    return is_over and len(rows) == 4 and all(row.rank and row.matches == row.planned for row in rows)


def conduct_season(folder: Path) -> None:
    """Have a season with two submissions on two tracks played, and write down what was seen meanwhile."""
    season = make_season(folder / "season", "matches = 2\nwaiting = 2", current=True)
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        for team, body in zip(TEAMS, (SLOW, WALKER), strict=True):
            team_with_member(session, team)
            agent = write_agent(folder / "agents", team, body, '["navigation", "battle"]')
            submitted(session, season, team, agent, now())
    live, seen = LiveMatches(season.live), dict[int, int]()

    def until(session: Session) -> bool:
        for match in session.scalars(select(Match).filter_by(state=PLAYING)):
            file = live.path(key_of(match.id))
            with suppress(FileNotFoundError):
                seen[match.id] = file.read_bytes().count(b"\n")
        return is_shown(session)

    conduct(database, season, until)
    database.close()
    (folder / SEEN).write_text(json.dumps(seen))


@pytest.fixture
def season(shared: Path, tmp_path: Path) -> Season:
    """A copy of the season, which is played once for all processes of the tests."""
    shutil.copytree(made_once(shared / "conducted", conduct_season), tmp_path / "copy")
    return Season.open(tmp_path / "copy" / "season")


@pytest.fixture
def database(season: Season) -> Iterator[Database]:
    opened = season.database()
    yield opened
    opened.close()


def test_matches_of_a_ladder_were_seen_while_they_were_played_and_no_others(
    season: Season, database: Database
) -> None:
    seen = json.loads((season.folder.parent / SEEN).read_text())
    with database.reading() as session:
        assert {session.get_one(Match, int(number)).kind for number in seen} == {LADDER}
    assert any(seen.values())
    assert list(season.live.iterdir()) == []


def test_what_a_real_conductor_played_holds(
    season: Season, database: Database, tmp_path: Path, audit: Run
) -> None:
    export(season, database, tmp_path / "export")
    with database.reading() as session:
        ladder = session.scalar(select(func.count()).where(Match.track == "battle", Match.state == FINISHED))

    with served(create_app(season, database)) as address:
        reports = [audit(address), audit(tmp_path / "export"), audit(address)]
    for report in reports:
        assert report.findings == []
        counts = {(check.track, check.what): check.checked for check in report.checks}
        hidden = {(check.track, check.what): sum(check.unchecked.values()) for check in report.checks}
        assert hidden["navigation", "results of matches"] == SUITE_MATCHES
        assert counts["battle", "records played again"] == ladder
    seen = {check.track: check.checked for check in reports[2].checks if "earlier audit" in check.what}
    assert seen == {"navigation": SUITE_MATCHES, "battle": ladder}


def final_matches(session: Session) -> int:
    """Return how many of the matches that decide the suite have been played."""
    return session.scalar(select(func.count()).where(Match.kind == FINAL, Match.state == FINISHED)) or 0


MOMENTS: dict[str, Callable[[Session], Any]] = {
    "the deciding matches are played": final_matches,
    "it publishes": lambda session: read_state(session, FINALIZED),
}


def test_its_end_may_be_killed_at_any_moment(season: Season, database: Database) -> None:
    line = [WILDSCAV, "season", "finalize", str(season.folder), "--now", "--yes"]
    conductor = Conductor(season, database)
    thread = threading.Thread(target=conductor.run)
    thread.start()
    try:
        for moment in MOMENTS:
            with subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                try:
                    wait_for(database, moment)
                finally:
                    process.kill()
        done = subprocess.run(line, capture_output=True, text=True, timeout=600)
    finally:
        conductor.stop()
        thread.join()
    assert done.returncode == 0, done.stderr
    with database.reading() as session:
        acts = session.scalars(select(AuditEntry.act).order_by(AuditEntry.id)).all()
        assert [act for act in acts if act != "finalize again"] == ["finalize", "decide"]
        assert final_matches(session) == len(TEAMS) * len(season.final_matches["navigation"])
        board = read_board(session, "navigation")
        assert board is not None
        assert {row.team for row in board.rows} == set(TEAMS)
    assert (season.folder / PUBLISHED / "season.json").is_file()


def wait_for(database: Database, moment: str) -> None:
    """Wait for a moment of the end of a season."""
    end = time.monotonic() + LONGEST
    while time.monotonic() < end:
        with database.reading() as session:
            if MOMENTS[moment](session):
                return
        time.sleep(0.05)
    raise TimeoutError(moment)
