"""What the web site publishes for audits is what an export has, and can be audited over the network."""

from collections.abc import Iterator
from datetime import timedelta

import httpx
import pytest
from sqlalchemy import select
from tests.leaderboard.played_seasons import end_season
from tests.leaderboard.spectating.served import served

from wildscav.errors import UserError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.suites.seeds import new_secret
from wildscav_leaderboard.auditing.audit import Audit
from wildscav_leaderboard.auditing.memory import Memory
from wildscav_leaderboard.auditing.record_checks import Wanted
from wildscav_leaderboard.auditing.report import Report
from wildscav_leaderboard.boards.models import Board
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.models import LADDER, Match, MatchResult
from wildscav_leaderboard.publishing.export import IN_FOLDER, export
from wildscav_leaderboard.publishing.service import published_season
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, Season
from wildscav_leaderboard.visibility import PUBLIC


@pytest.fixture(scope="module")
def site(played: tuple[Season, Database]) -> Iterator[str]:
    with served(create_app(*played)) as address:
        yield address


def audited(address: str, season: Season, **wanted: object) -> Report:
    cache = season.folder.parent / "cache"
    return Audit(Wanted(**wanted), LocalExecutor(1), cache).run(address)  # type: ignore[arg-type]


def test_the_lines_of_a_track_are_those_of_an_export(site: str, played: tuple[Season, Database]) -> None:
    season, database = played
    folder = season.folder.parent / "exported"
    export(season, database, folder)
    for track in season.settings.tracks:
        answer = httpx.get(f"{site}/api/v1/audit/tracks/{track}.ndjson", timeout=60.0)
        assert answer.headers["content-type"].startswith("application/x-ndjson")
        assert answer.text == (folder / f"tracks/{track}.ndjson").read_text("utf-8")


def test_a_season_is_audited_before_and_after_its_end(site: str, played: tuple[Season, Database]) -> None:
    season, database = played
    report = audited(site, season)
    assert report.findings == []
    assert any(check.unchecked for check in report.checks)
    assert audited(site, season).findings == []  # what was hidden is remembered by its records

    end_season(database, season)
    report = audited(f"{site}/", season)
    assert report.findings == []
    assert not any(check.unchecked for check in report.checks)


def test_a_past_that_moves_is_noticed_by_the_next_audit(site: str, played: tuple[Season, Database]) -> None:
    season, database = played
    before = audited(site, season, track="battle", records=0)
    with database.writing() as session:
        ladder = session.scalars(select(Match).filter_by(kind=LADDER).order_by(Match.id)).first()
        assert ladder is not None
        result = session.get_one(MatchResult, ladder.id)
        right = result.record
        result.record = "ab" * 16
    try:
        report = audited(site, season, track="battle", records=0)
    finally:
        with database.writing() as session:
            session.get_one(MatchResult, ladder.id).record = right
    assert before.holds
    assert {one.match for one in report.findings} == {ladder.id}
    assert "no longer what was published of it at an earlier audit" in str(report.findings[0])
    seen = [one for one in report.checks if one.what == "results as an earlier audit saw them"]
    assert [one.checked for one in seen] == [6] * len(seen)


def test_a_commitment_that_is_exchanged_is_noticed_by_the_next_audit(
    site: str, played: tuple[Season, Database]
) -> None:
    season, database = played
    audited(site, season, track="battle", records=0)
    cache, address = season.folder.parent / "cache" / "seen", f"{site}/api/v1/audit/season.json"
    (season.folder / FINAL_SECRET_FILE).rename(season.folder / "away.txt")
    (season.folder / FINAL_SECRET_FILE).write_bytes(new_secret())
    try:
        with database.reading() as session:
            published = published_season(session, Season.open(season.folder), IN_FOLDER)
        (finding,) = Memory(cache, address, published).changed_season(published)
    finally:
        (season.folder / "away.txt").rename(season.folder / FINAL_SECRET_FILE)
    assert finding.field == "final_secret.commitment"
    assert finding.expected == season.final_seed.commitment


def test_a_board_that_changes_between_two_downloads_is_downloaded_again(
    site: str, played: tuple[Season, Database], monkeypatch: pytest.MonkeyPatch
) -> None:
    from wildscav_leaderboard.auditing import audit

    season, database = played
    read, moved = audit.read_lines, []

    def read_and_move(*arguments: object) -> object:
        file = read(*arguments)  # type: ignore[arg-type]
        if not moved:
            with database.writing() as session:
                board = session.get_one(Board, ("battle", PUBLIC))
                later = (board.updated + timedelta(seconds=1)).isoformat()
                board.document = {**board.document, "updated": later}
            moved.append(later)
        return file

    monkeypatch.setattr(audit, "read_lines", read_and_move)
    assert audited(site, season, track="battle", records=0).findings == []
    assert moved


def test_a_site_without_a_season_has_nothing_to_audit(site: str, played: tuple[Season, Database]) -> None:
    with pytest.raises(UserError, match="publishes nothing for audits"):
        audited(f"{site}/static/", played[0])
