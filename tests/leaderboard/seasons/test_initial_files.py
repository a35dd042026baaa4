"""A new season's folder: complete, private where it must be, and never half made."""

import subprocess
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wildscav.errors import UserError
from wildscav_leaderboard.cli.season.app import app
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, make_season_folder


def test_a_new_season_has_two_private_secrets_whose_commitments_sha256sum_can_check(tmp_path: Path) -> None:
    first, final = make_season_folder(tmp_path / "spring", None, None, 30)

    season = Season.open(tmp_path / "spring")
    assert (season.seed.commitment, season.final_seed.commitment) == (first, final)
    assert first != final
    for name in (SECRET_FILE, FINAL_SECRET_FILE):
        assert (season.folder / name).stat().st_mode & 0o777 == 0o600
    done = subprocess.run(["sha256sum", "--check", "--strict", COMMITMENTS_FILE], cwd=season.folder)
    assert done.returncode == 0


def test_the_final_matches_are_others_than_those_of_the_season(tmp_path: Path) -> None:
    make_season_folder(tmp_path / "spring", None, None, 30)
    season = Season.open(tmp_path / "spring")
    for track, matches in season.suite_matches.items():
        seeds = {match.seed for match in matches}
        assert len(season.final_matches[track]) == len(matches)
        assert seeds.isdisjoint(match.seed for match in season.final_matches[track])


def test_there_is_time_to_read_the_settings_before_the_season_opens(tmp_path: Path) -> None:
    make_season_folder(tmp_path / "spring", None, None, 30)
    settings, now = Season.open(tmp_path / "spring").settings, datetime.now(UTC)
    assert now < settings.opens <= now + timedelta(days=1)
    assert settings.closes - settings.opens == timedelta(days=30)


def test_nobody_is_told_to_replace_a_secret_whose_commitment_is_published(tmp_path: Path) -> None:
    make_season_folder(tmp_path / "spring", None, None, 30)
    (tmp_path / "spring" / FINAL_SECRET_FILE).unlink()
    with pytest.raises(UserError, match=r"final-secret\.txt is missing: put it back from a backup, since"):
        Season.open(tmp_path / "spring")


def test_what_is_to_be_typed_is_quoted_for_the_shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    said = CliRunner().invoke(app, ["init", "Spring Cup"]).output
    assert said.splitlines()[-1].endswith("wildscav season serve 'Spring Cup'")


@pytest.mark.parametrize("name", ["A", "two words", "-x"])
def test_a_name_that_is_not_allowed_leaves_no_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match="--name"):
        make_season_folder(tmp_path / "spring", name, None, 30)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="not an empty folder"):
        make_season_folder(tmp_path, "spring", None, 30)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
