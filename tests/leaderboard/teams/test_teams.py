"""Who is of which team: whoever has its key. No two have titles that people take for the same."""

from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import NOON, changed, make_account, make_season

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError, RefusalError
from wildscav_leaderboard.seasons.settings import Quotas
from wildscav_leaderboard.teams.service import (
    join_team,
    leave_team,
    make_team,
    members_of,
    new_team_key,
    own_team,
)


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return changed(make_season(tmp_path / "season"), quotas=Quotas(members=2))


def test_a_team_takes_whoever_has_its_key_until_it_is_full(database: Database, season: Season) -> None:
    with database.writing() as session:
        ada, bob, eve = (make_account(session, name) for name in ("ada", "bob", "eve"))
        foxes, key = make_team(session, ada, "foxes", "", NOON)
        assert join_team(session, season.settings, bob, key, NOON) is foxes
        assert members_of(session, foxes) == ["ada", "bob"]
        with pytest.raises(RefusalError, match="the team foxes is full: it may have 2 members"):
            join_team(session, season.settings, eve, key, NOON)
        leave_team(session, ada)
        assert join_team(session, season.settings, eve, key, NOON) is foxes
        assert members_of(session, foxes) == ["bob", "eve"]


def test_a_new_key_takes_the_place_of_the_old_one(database: Database, season: Season) -> None:
    with database.writing() as session:
        foxes, old = make_team(session, make_account(session, "ada"), "foxes", "", NOON)
        new = new_team_key(foxes)
        bob = make_account(session, "bob")
        with pytest.raises(ForbiddenError, match="this key is of no team"):
            join_team(session, season.settings, bob, old, NOON)
        assert join_team(session, season.settings, bob, new, NOON) is foxes


def test_nobody_is_of_two_teams(database: Database, season: Season) -> None:
    with database.writing() as session:
        ada = make_account(session, "ada")
        with pytest.raises(ForbiddenError, match="you are a member of no team: make one, or join one"):
            own_team(session, ada)
        with pytest.raises(RefusalError, match="you are a member of no team"):
            leave_team(session, ada)
        _, key = make_team(session, make_account(session, "bob"), "owls", "", NOON)
        foxes, _ = make_team(session, ada, "foxes", "", NOON)
        with pytest.raises(RefusalError, match="you are a member of the team foxes: leave it first"):
            join_team(session, season.settings, ada, key, NOON)
        with pytest.raises(RefusalError, match="you are a member of the team foxes: leave it first"):
            make_team(session, ada, "hares", "", NOON)
        assert own_team(session, ada) is foxes


def founded(database: Database, titles: list[str]) -> None:
    with database.writing() as session:
        for number, title in enumerate(titles):
            make_team(session, make_account(session, f"captain-{number}"), f"team-{number}", title, NOON)


ALIKE = (
    "TEAM HOMING",
    "Team  Homing",  # two spaces
    "Теаm Ноming",  # noqa: RUF001 (five letters of Cyrillic)
    "Тeam H\u03bfming",  # noqa: RUF001 (a letter of Cyrillic, a letter of Greek)
    "Team H0ming",
    "Tearn Homing",
    "Team Hom1ng",
    "Ｔｅａｍ Ｈｏｍｉｎｇ",  # noqa: RUF001
    "Team\u3164 Homing",  # a letter that nobody sees
)


def test_a_title_that_looks_like_another_one_is_refused(database: Database) -> None:
    founded(database, ["Team Homing"])
    with database.writing() as session:
        other = make_account(session, "other")
        for title in ALIKE:
            with pytest.raises(RefusalError, match="the team 'Team Homing' looks the same: choose another"):
                make_team(session, other, "team-other", title, NOON)


def test_titles_that_people_can_tell_apart_are_allowed(database: Database) -> None:
    founded(database, ["Team Homing", "Team Homing 2", "Équipe", "Equipe", "Совы", "Σοφία", "梟"])
