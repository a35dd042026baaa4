"""A new season's folder is complete and private; errors in its settings name what is wrong and allowed."""

import re
import subprocess
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season
from typer.testing import CliRunner

from wildscav.errors import UserError
from wildscav_leaderboard.cli.season.app import app
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, RULES_FILE, make_season_folder
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE, Quotas, SeasonSettings, SettingsError


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        (
            '[tracks.navigation]\nmode = "suite"\nsuite = "tiny.toml"',
            '[tracks.navigation]\nmode = "suite"\nsuite = "oficial"',
            "tracks.navigation.suite: there is no suite 'oficial' (did you mean 'official'?); the suites",
        ),
        ("[tracks.navigation]", "[tracks.navigaton]", "tracks: 'navigaton' is none of navigation, "),
        (
            "[tracks.battle]",
            "[tracks.royale]",
            "tracks.royale.suite: the suite tiny.toml has no matches of royale;",
        ),
        (
            'mode = "ladder"',
            'mode = "lader"',
            "tracks.battle.mode: is 'lader'; input should be 'suite' or 'ladder'",
        ),
        ("per_day = 3", "per_day = 0", "quotas.per_day: is 0; input should be greater than or equal to 1"),
        (
            "[quotas]",
            '[play]\ntracks = ["royale"]\n[quotas]',
            "play.tracks: 'royale' is none of navigation, battle",
        ),
        ("[quotas]", '[play]\nwho = "all"\n[quotas]', "play.who: is 'all'; input should be 'accounts' or "),
        ("[quotas]", "[play]\ntables = 0\n[quotas]", "play.tables: is 0; input should be greater than or "),
        (
            "[quotas]",
            '[model]\nurl = "http://host/v1"\nname = "tiny"\nkey_file = "key"\n[quotas]',
            "model.key_file must be an absolute path",
        ),
        ("seats = 2", "seat = 2", "tracks.battle.seat: is not a setting (did you mean 'seats'"),
        ("[quotas]", "[deadlines]\nmatch = 300\n[quotas]", "deadlines: match is no setting any more: "),
        (
            'mode = "ladder"',
            'mode = "ladder"\nwall_clock = 2',
            "tracks.battle.wall_clock: a match cannot end within 2 s: the budgets of its 40 steps",
        ),
        (
            'mode = "suite"',
            'mode = "suite"\nseats = 3',
            "tracks.navigation.seats: it means nothing in mode suite: leave it out",
        ),
        (
            'mode = "ladder"',
            'mode = "ladder"\nrounds = 2',
            "tracks.battle.rounds: it means nothing in mode ladder: leave it out",
        ),
        (
            "[execution]",
            '[execution]\naddress = "head:6379"',
            "execution.address: it is of a Ray cluster, so it needs executor",
        ),
        ('robots = ["fighter"]', 'robots = ["figter"]', "tracks.battle.robots: 'figter' is none of "),
    ],
)
def test_a_typo_is_explained(tmp_path: Path, right: str, wrong: str, said: str) -> None:
    folder = make_season(tmp_path / "season").folder
    path = folder / SETTINGS_FILE
    text = path.read_text()
    assert right in text
    path.write_text(text.replace(right, wrong, 1))

    with pytest.raises(SettingsError) as error:
        Season.open(folder)
    assert str(error.value).startswith(f"{path}: {said}")


def test_a_track_may_have_a_longest_time(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season", "wall_clock = 24")

    assert season.limits("battle").wall_clock == 24
    assert season.bound("battle") == 30 + 24  # to join, and as long as it may last
    assert season.bound("navigation") == 30 + 4 + 30  # 40 steps of 0.1 s, and one bank


@pytest.fixture
def spring(tmp_path: Path) -> Season:
    commitments = make_season_folder(tmp_path / "spring", None, None, 30)
    season = Season.open(tmp_path / "spring")
    assert commitments == (season.seed.commitment, season.final_seed.commitment)
    return season


def test_a_new_season_has_two_private_secrets_whose_commitments_sha256sum_can_check(spring: Season) -> None:
    assert spring.seed.commitment != spring.final_seed.commitment
    for name in (SECRET_FILE, FINAL_SECRET_FILE):
        assert (spring.folder / name).stat().st_mode & 0o777 == 0o600
    done = subprocess.run(["sha256sum", "--check", "--strict", COMMITMENTS_FILE], cwd=spring.folder)
    assert done.returncode == 0


def test_a_new_season_has_a_template_of_rules_that_names_settings(spring: Season) -> None:
    rules = (spring.folder / RULES_FILE).read_text("utf-8")
    assert rules.startswith("# Rules of Spring\n")
    named = set(re.findall(r"\[`(\w+)`\]", rules))
    assert {"opens", "freezes", "closes", "per_day", "active", "archive", "members"} == named
    assert named <= SeasonSettings.model_fields.keys() | Quotas.model_fields.keys()


def test_the_final_matches_are_others_than_those_of_the_season(spring: Season) -> None:
    for track, matches in spring.suite_matches.items():
        seeds = {match.seed for match in matches}
        assert len(spring.final_matches[track]) == len(matches)
        assert seeds.isdisjoint(match.seed for match in spring.final_matches[track])


def test_the_comments_of_new_settings_stand_below_each_other(tmp_path: Path) -> None:
    make_season_folder(tmp_path / "a", "a-fairly-long-name", 'One # "two"', 30)
    lines = (tmp_path / "a" / SETTINGS_FILE).read_text().splitlines()[3:9]
    assert {line.rindex("# ") for line in lines} == {38}
    assert Season.open(tmp_path / "a").settings.title == 'One # "two"'


def test_there_is_time_to_read_the_settings_before_the_season_opens(spring: Season) -> None:
    settings, now = spring.settings, datetime.now(UTC)
    assert now < settings.opens <= now + timedelta(days=1)
    assert settings.closes - settings.opens == timedelta(days=30)


def test_nobody_is_told_to_replace_a_secret_whose_commitment_is_published(spring: Season) -> None:
    (spring.folder / FINAL_SECRET_FILE).unlink()
    with pytest.raises(UserError, match=r"final-secret\.txt is missing: put it back from a backup, since"):
        Season.open(spring.folder)


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
