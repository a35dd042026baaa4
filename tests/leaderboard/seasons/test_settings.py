"""Errors in season.toml name the file, the setting, what is wrong, and what is allowed."""

from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE, SettingsError


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
