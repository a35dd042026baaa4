"""A season that a real conductor plays, with real agents, is audited while it runs and as files."""

from pathlib import Path

import pytest
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from tests.leaderboard.agents import write_agent
from tests.leaderboard.auditing.conftest import Run
from tests.leaderboard.real_conductor import conduct
from tests.leaderboard.seasons_made import make_season, submitted, team_with_member
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.conductor.validators import now
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.models import FINISHED, Match
from wildscav_leaderboard.publishing.export import export

SUITE_MATCHES = 4


def is_shown(session: Session) -> bool:
    """Return whether everything is played and on the boards."""
    boards = [read_board(session, track) for track in ("navigation", "battle")]
    rows = [row for board in boards if board is not None for row in board.rows if row.submission is not None]
    is_over = set(session.scalars(select(Match.state))) == {FINISHED}
    return is_over and len(rows) == 4 and all(row.rank and row.matches == row.planned for row in rows)


@pytest.mark.slow
def test_what_a_real_conductor_played_holds(tmp_path: Path, audit: Run) -> None:
    season = make_season(tmp_path / "season", "matches = 2\nwaiting = 2", current=True)
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        for team in ("foxes", "owls"):
            team_with_member(session, team)
            folder = write_agent(tmp_path / "agents", team, tracks='["navigation", "battle"]')
            submitted(session, season, team, folder, now())
    conduct(database, season, is_shown)
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
    database.close()
