"""A season that a real conductor plays, with real agents: it is watched, audited, and ended."""

import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from tests.evaluator.sample_agents import WALKER
from tests.leaderboard.agents import write_agent
from tests.leaderboard.auditing.conftest import Run
from tests.leaderboard.real_conductor import LONGEST, conduct
from tests.leaderboard.seasons_made import make_season, opened, submitted, team_with_member
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
SLOW = """
    def act(self, observation):
        time.sleep(0.05)
        return Action(walk_direction=90.0, walk_speed=8.0)
"""


def is_shown(session: Session) -> bool:
    """Return whether everything is played and on the boards."""
    boards = [read_board(session, track) for track in ("navigation", "battle")]
    rows = [row for board in boards if board is not None for row in board.rows if row.submission is not None]
    is_over = set(session.scalars(select(Match.state))) == {FINISHED}
    return is_over and len(rows) == 4 and all(row.rank and row.matches == row.planned for row in rows)


def conduct_season(folder: Path) -> tuple[Season, dict[int, int]]:
    """Have a season with two submissions on two tracks played.

    Return it, and of each match that was seen while it was played, how many moments.
    """
    season = make_season(folder / "season", "matches = 2\nwaiting = 2", current=True)
    live, seen = LiveMatches(season.live), dict[int, int]()

    def until(session: Session) -> bool:
        for match in session.scalars(select(Match).filter_by(state=PLAYING)):
            with suppress(FileNotFoundError):
                seen[match.id] = live.path(key_of(match.id)).read_bytes().count(b"\n")
        return is_shown(session)

    with opened(season) as database:
        with database.writing() as session:
            for team, body in zip(("foxes", "owls"), (SLOW, WALKER), strict=True):
                team_with_member(session, team)
                agent = write_agent(folder / "agents", team, body, '["navigation", "battle"]')
                submitted(session, season, team, agent, now())
        conduct(database, season, until)
    return season, seen


def test_what_a_real_conductor_played_was_seen_and_holds_and_its_end_may_be_killed(
    tmp_path: Path, audit: Run
) -> None:
    season, seen = conduct_season(tmp_path)
    with opened(season) as database:
        with database.reading() as session:
            assert {session.get_one(Match, number).kind for number in seen} == {LADDER}
            over = select(func.count()).where(Match.track == "battle", Match.state == FINISHED)
            ladder = session.scalar(over)
        assert any(seen.values())
        assert list(season.live.iterdir()) == []
        export(season, database, tmp_path / "export")
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
    with opened(season) as database:
        kill_its_end(season, database)


def final_matches(session: Session) -> int:
    """Return how many of the matches that decide the suite have been played."""
    return session.scalar(select(func.count()).where(Match.kind == FINAL, Match.state == FINISHED)) or 0


def kill_its_end(season: Season, database: Database) -> None:
    """End a season by a command that is killed while it waits, and while it publishes, and is run again."""
    program = str(Path(sys.executable).with_name("wildscav"))
    line = [program, "season", "finalize", str(season.folder), "--now", "--yes"]
    conductor = Conductor(season, database)
    thread = threading.Thread(target=conductor.run)
    thread.start()
    try:
        for moment in (final_matches, lambda session: read_state(session, FINALIZED)):
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
        assert final_matches(session) == 2 * len(season.final_matches["navigation"])
        board = read_board(session, "navigation")
    assert board is not None
    assert {row.team for row in board.rows} == {"foxes", "owls"}
    assert (season.folder / PUBLISHED / "season.json").is_file()


def wait_for(database: Database, moment: Callable[[Session], object]) -> None:
    """Wait for a moment of the end of a season."""
    end = time.monotonic() + LONGEST
    while time.monotonic() < end:
        with database.reading() as session:
            if moment(session):
                return
        time.sleep(0.05)
    raise TimeoutError(moment)
