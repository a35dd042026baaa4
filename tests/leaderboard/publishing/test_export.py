"""What is published: as much as the public boards count, whole, and never what is still hidden."""

import csv
import io
import json
import subprocess
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.leaderboard.played_seasons import enter, play_everything
from tests.leaderboard.seasons_made import NOON, team_with_member

from wildscav.errors import UserError
from wildscav_leaderboard.api.match_views import match_views
from wildscav_leaderboard.boards.documents import SuiteBoard
from wildscav_leaderboard.boards.history import history
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import LADDER, Match
from wildscav_leaderboard.organizing.acts import freeze
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.publishing.service import board_lines
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.state import FINALIZED, write_state
from wildscav_leaderboard.visibility import shown_until

TRACKS = ("navigation", "battle")
Played = tuple[Season, Database]
LATE = NOON + timedelta(days=2)


def test_its_sums_are_those_that_sha256sum_checks(exported: Path) -> None:
    done = subprocess.run(
        ["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=exported, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout


def test_tables_have_a_row_for_each_team_and_each_seat(played: Played, exported: Path) -> None:
    with played[1].reading() as session:
        board = read_board(session, "navigation")
    assert isinstance(board, SuiteBoard)
    rows = list(csv.DictReader(io.StringIO((exported / "boards/navigation.csv").read_text())))
    assert [(row["team"], float(row["time mean"])) for row in rows] == [
        (row.team, row.metrics["time"].mean) for row in board.rows
    ]
    seats = list(csv.DictReader(io.StringIO((exported / "matches/battle.csv").read_text())))
    lines = [json.loads(line) for line in (exported / "tracks/battle.ndjson").read_text().splitlines()]
    assert len(seats) == sum(len(line["match"]["seats"]) for line in lines if "match" in line)


def test_neither_secrets_nor_hidden_records_nor_what_agents_print_is_published(
    played: Played, exported: Path
) -> None:
    season, database = played
    with database.reading() as session:
        ladder = set(session.scalars(select(Match.id).filter_by(kind=LADDER)))
    assert {int(path.stem) for path in exported.rglob("*.wsr")} == ladder
    everything = b"".join(path.read_bytes() for path in exported.rglob("*") if path.is_file())
    assert b"what an agent printed" not in everything
    for name in ("secret.txt", "final-secret.txt"):
        secret = (season.folder / name).read_bytes()
        assert secret.strip() not in everything
        assert secret.hex().encode() not in everything
        assert not (exported / name).exists()


def test_a_folder_with_something_in_it_is_left_alone(played: Played, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="not an empty folder"):
        export(*played, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_an_export_whose_records_are_missing_leaves_nothing_behind(played: Played, tmp_path: Path) -> None:
    season, database = played
    with database.reading() as session:
        number = max(session.scalars(select(Match.id).filter_by(kind=LADDER)))
    record = season.match_folder(number) / "records/match.wsr"
    away = record.rename(record.with_suffix(".away"))
    try:
        with pytest.raises(UserError, match=r"the season cannot be exported: .*No such file"):
            export(season, database, tmp_path / "out")
        assert list(tmp_path.iterdir()) == []
    finally:
        away.rename(record)


def published(database: Database, season: Season) -> dict[str, list[str]]:
    with database.reading() as session:
        return {track: [line.text() for line in board_lines(session, season, track)] for track in TRACKS}


def test_nothing_that_arrives_after_the_freeze_is_published_before_the_end(
    played: Played, exported: Path, tmp_path: Path
) -> None:
    """Needs the export, which was made before."""
    season, database = played
    before = published(database, season)
    with database.writing() as session:
        freeze(Doing(session, season, "anna", LATE))
        team_with_member(session, "newts")
        number = enter(session, season, "newts", tmp_path, 60 * 60)
        earlier = max(session.scalars(select(Match.id).filter_by(kind=LADDER)))
    play_everything(database, season, LATE + timedelta(hours=1))

    assert published(database, season) == before
    with database.reading() as session:
        late = list(session.scalars(select(Match).where(Match.kind == LADDER, Match.id > earlier)))
        assert late, "the ladder went on"
        why = "the public boards are frozen, so it is hidden until the season is finalized"
        for view in match_views(session, late, None):
            assert view.hidden == why
            assert all(seat.metrics is None and seat.status is None for seat in view.seats)
        since = shown_until(session, None)
        assert [history(session, track, [number], since) for track in TRACKS] == [[], []]

    with database.writing() as session:
        write_state(session, FINALIZED, {"at": LATE.isoformat()}, LATE)
    with database.reading() as session:
        assert all(view.seats[0].metrics for view in match_views(session, late, None))
        assert shown_until(session, None) is None
        assert all(history(session, track, [number]) for track in TRACKS)
