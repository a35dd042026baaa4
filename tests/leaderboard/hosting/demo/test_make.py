"""The demo season is made by the services that a real one uses, and needs no container."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import opened

from wildscav.baselines import ALL_ROUND
from wildscav.errors import UserError
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_leaderboard.accounts.passwords import matches
from wildscav_leaderboard.accounts.service import find_account
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.demo.make import Login, Opening, make_demo, opening_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.service import list_submissions
from wildscav_leaderboard.teams.service import find_team, members_of

Made = tuple[Season, tuple[Login, ...]]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    return make_demo(tmp_path_factory.mktemp("demo") / "season", 8123, "process")


@pytest.fixture(scope="module")
def database(made: Made) -> Iterator[Database]:
    with opened(made[0]) as database:
        yield database


def test_each_baseline_is_the_submission_of_a_team(made: Made, database: Database) -> None:
    season, _ = made
    assert (season.settings.execution.sandbox, season.settings.web.port) == ("process", 8123)
    assert season.settings.registration == "open"
    with database.reading() as session:
        submissions = list_submissions(session)
        assert [one.name for one in reversed(submissions)] == list(ALL_ROUND)
        for one in submissions:
            team = find_team(session, one.name)
            assert (one.team_id, members_of(session, team)) == (team.id, [one.name])
            assert tuple(one.tracks) == tuple(season.settings.tracks)
            assert load_submission(season.archives / one.archive).manifest.name == one.name


def test_people_log_in_with_the_passwords_that_are_shown(made: Made, database: Database) -> None:
    with database.reading() as session:
        for login in made[1]:
            account = find_account(session, login.name)
            assert account is not None
            assert account.role == login.role
            assert matches(login.password, account.password)
    assert [login.role for login in made[1]] == ["organizer", "competitor", "competitor", "competitor"]


def test_a_season_is_worth_a_look_when_its_first_matches_are_played(database: Database) -> None:
    assert opening_of(database, ["navigation"]) == Opening(submissions=3, validated=0, played=0, ahead=0)
    assert not Opening(3, 2, 0, 0).is_ready(0)
    assert not Opening(3, 3, 8, 0, is_shown=False).is_ready(8)
    assert not Opening(3, 3, 7, 20).is_ready(8)
    assert Opening(3, 3, 8, 20).is_ready(8)
    assert Opening(3, 3, 5, 0).is_ready(8)  # there are no more


def test_nothing_is_made_in_a_folder_with_something_in_it(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="not an empty folder"):
        make_demo(tmp_path, 8123, "process")
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
