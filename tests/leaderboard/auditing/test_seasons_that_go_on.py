"""A season holds as well after it was finalized again, or goes on after an upgrade."""

import shutil
from datetime import timedelta
from pathlib import Path

from sqlalchemy import select
from tests.leaderboard.auditing.conftest import Run
from tests.leaderboard.auditing.tampering import Published
from tests.leaderboard.database.first_schema import take_back_to_first
from tests.leaderboard.played_seasons import enter
from tests.leaderboard.seasons_made import NOON, team_with_member

from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import WAITING, Match
from wildscav_leaderboard.matches.service import next_matches
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.organizing.acts import disqualify_team
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import edition_numbers

LADDER_MATCHES = 6


def test_a_season_that_is_finalized_again_holds_without_the_team_that_was_disqualified(
    after_opening: Path, played: tuple[Season, Database], audit: Run, tmp_path: Path
) -> None:
    before, (season, database) = Published(after_opening), played
    team = before.board("navigation")["rows"][0]["team"]
    late = season.settings.closes + timedelta(days=2)
    with database.writing() as session:
        disqualify_team(Doing(session, season, "anna", late), team, reason="two teams of one person")
        assert finalizing.finalize_again(session, season, "anna", late)
    export(season, database, tmp_path / "again")

    after = Published(tmp_path / "again")
    for track in ("navigation", "battle"):
        teams = [{row["team"] for row in one.board(track)["rows"]} for one in (before, after)]
        assert teams[0] - teams[1] == {team}, track
        named = {line["submission"]["team"] for line in after.lines(track) if "submission" in line}
        assert named == teams[1] - {""}, track
    assert audit(after).findings == []


def test_a_season_of_the_first_schema_goes_on_where_it_was(
    before_the_end: Path, audit: Run, tmp_path: Path
) -> None:
    season = Season.open(Path(shutil.copytree(before_the_end, tmp_path / "season")))
    tracks, later = ("navigation", "battle"), NOON + timedelta(hours=5)
    database = season.database()
    with database.writing() as session:
        team_with_member(session, "newts")
        enter(session, season, "newts", tmp_path / "agents", 60)
        refresh(session, season, later)
        before = [read_board(session, track) for track in tracks]
        waiting = list(session.scalars(select(Match.id).filter_by(state=WAITING)))
        assert waiting
    database.close()
    take_back_to_first(season.database_url)

    database.upgrade()
    with database.writing() as session:
        assert begin_editions(session, season, later) == [], "nothing has to be judged again"
        assert [one.id for one in next_matches(session, edition_numbers(session), 99)] == waiting
        assert plan_ladders(session, season, later) == 2
        games = select(Match).filter_by(track="battle").order_by(Match.id)
        assert [one.number for one in session.scalars(games)] == list(range(LADDER_MATCHES + 2))
        refresh(session, season, later)
        after = [read_board(session, track) for track in tracks]
        assert [one and one.rows for one in after] == [one and one.rows for one in before]
    export(season, database, tmp_path / "export")
    database.close()
    report = audit(tmp_path / "export", replay=0)
    assert report.findings == []
    counts = {(check.track, check.what): check.checked for check in report.checks}
    assert counts["battle", "results of matches"] == LADDER_MATCHES
