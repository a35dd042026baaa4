"""A new season's folder: complete, private where it must be, and never half made."""

import subprocess
from pathlib import Path

import pytest

from wildscav.errors import UserError
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
