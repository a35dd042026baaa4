"""No two teams have titles that people take for the same."""

import pytest
from tests.leaderboard.seasons_made import NOON, make_account

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.teams.service import make_team


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
