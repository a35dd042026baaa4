"""``wildscav season finalize``: seasons end whole, whatever happens meanwhile."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.cli import main
from wildscav_leaderboard.seasons.folder import PUBLISHED


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
