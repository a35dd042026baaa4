"""Who is of which team: whoever has its key, and one team at a time."""

from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import NOON, make_account, make_season

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError, RefusalError
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
    made = make_season(tmp_path / "season")
    quotas = made.settings.quotas.model_copy(update={"members": 2})
    return Season(made.folder, made.settings.model_copy(update={"quotas": quotas}))


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
