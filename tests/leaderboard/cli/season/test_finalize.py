"""``wildscav season finalize``: seasons end whole, whatever happens meanwhile."""

import subprocess
import sys
import threading
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import func, select
from tests.leaderboard.agents import write_agent
from tests.leaderboard.seasons_made import make_season, submitted, team_with_member

from wildscav.cli import main
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.matches.models import FINAL, FINISHED, Match
from wildscav_leaderboard.seasons.folder import PUBLISHED
from wildscav_leaderboard.seasons.models import AuditEntry


def command(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    """Run a command of a season in this process, and return its exit code."""
    monkeypatch.setattr("sys.argv", ["wildscav", "season", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_a_season_that_is_over_is_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    closed = datetime.now(UTC) - timedelta(minutes=1)
    season = make_season(tmp_path / "season", current=True, closes=closed)
    published = season.folder / PUBLISHED
    for _ in range(2):  # and again
        assert command(monkeypatch, "finalize", season.folder) == 0
        assert "its boards are final, and its secrets are opened" in capsys.readouterr().out
        assert not (published / "of an earlier time").exists()
        (published / "of an earlier time").touch()
    assert command(monkeypatch, "finalize", season.folder, "--abort") == 1
    assert [one.name for one in season.folder.glob("*published*")] == [PUBLISHED]
    assert (published / "secret.txt").read_bytes() == (season.folder / "secret.txt").read_bytes()
    assert (published / "final-secret.txt").is_file()


def test_a_season_that_is_open_is_not_ended_by_accident(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    season = make_season(tmp_path / "season", current=True)
    assert command(monkeypatch, "finalize", season.folder) == 1
    assert "--now ends it at once" in capsys.readouterr().err
    assert not (season.folder / PUBLISHED).exists()


@pytest.mark.slow
def test_it_may_be_killed_at_any_moment(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season", current=True)
    database = season.database()
    database.upgrade()
    teams = ("foxes", "owls")
    for team in teams:
        with database.writing() as session:
            team_with_member(session, team)
            submitted(session, season, team, write_agent(tmp_path, team), datetime.now(UTC))
    conductor = Conductor(season, database)
    thread = threading.Thread(target=conductor.run)
    thread.start()
    try:
        wildscav = str(Path(sys.executable).parent / "wildscav")
        line = [wildscav, "season", "finalize", str(season.folder), "--now", "--yes"]
        for seconds in (2.0, 4.0, 6.0, 9.0, 13.0, 18.0):
            with subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
                try:
                    process.wait(seconds)
                except subprocess.TimeoutExpired:
                    process.kill()
        done = subprocess.run(line, capture_output=True, text=True, timeout=600)
    finally:
        conductor.stop()
        thread.join()
    assert done.returncode == 0, done.stderr
    with database.reading() as session:
        acts = session.scalars(select(AuditEntry.act).order_by(AuditEntry.id)).all()
        assert [act for act in acts if act != "finalize again"] == ["finalize", "decide"]
        played = select(func.count()).select_from(Match).filter_by(kind=FINAL, state=FINISHED)
        assert session.scalar(played) == len(teams) * len(season.final_matches["navigation"])
        board = read_board(session, "navigation")
        assert board is not None
        assert {row.team for row in board.rows} == set(teams)
    database.close()
    assert (season.folder / PUBLISHED / "season.json").is_file()
