"""What the conductor does by itself when a date of the season comes."""

import socket
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.leaderboard.seasons_made import NOON, changed, make_season, opened

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.boards.service import Final, decide
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.steps import freeze_when_due
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing.acts import freeze, unfreeze
from wildscav_leaderboard.organizing.status import nodes
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.state import FROZEN, read_state

DUE = NOON + timedelta(days=2)
SECOND = timedelta(seconds=1)


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return changed(make_season(tmp_path / "season"), freezes=DUE)


def acts(database: Database) -> list[tuple[str, str]]:
    with database.reading() as session:
        return [(one.actor, one.act) for one in session.scalars(select(AuditEntry))]


def test_the_boards_freeze_once_at_their_date_and_again_if_it_is_moved(
    database: Database, season: Season
) -> None:
    moved = changed(season, freezes=DUE + timedelta(days=1))
    endless = changed(season, freezes=None)
    for one, now, comes, frozen in (
        (endless, NOON + timedelta(days=365), False, False),
        (season, DUE - SECOND, False, False),
        (season, DUE, True, True),
        (season, DUE, False, True),
        (season, DUE + SECOND, False, True),
        (moved, DUE + SECOND, True, False),
        (moved, DUE + 2 * SECOND, False, False),
        (moved, DUE + timedelta(days=1), True, True),
        (endless, NOON + timedelta(days=365), True, False),
    ):
        with database.writing() as session:
            assert freeze_when_due(session, one, now) is comes
            assert (read_state(session, FROZEN) is not None) is frozen
    assert [act for _, act in acts(database)] == ["freeze", "unfreeze"] * 2
    assert {actor for actor, _ in acts(database)} == {"the conductor"}


def test_what_organizers_unfreeze_or_freeze_stays_so_whatever_date_has_passed(
    database: Database, season: Season
) -> None:
    with database.writing() as session:
        doing = Doing(session, season, "anna", DUE)
        freeze_when_due(session, season, DUE)
        unfreeze(doing)
        assert not freeze_when_due(session, season, DUE + SECOND)
        freeze(doing)
        later = changed(season, freezes=DUE + timedelta(days=1))
        assert not freeze_when_due(session, later, DUE + SECOND)
        assert read_state(session, FROZEN) is not None


def test_final_boards_do_not_freeze_again(database: Database, season: Season) -> None:
    with database.writing() as session:
        freeze_when_due(session, season, DUE)
        decide(session, season, Final({"navigation": frozenset()}, {}), DUE)
    with database.writing() as session:
        assert not freeze_when_due(session, season, DUE + SECOND)
        assert read_state(session, FROZEN) is None


def test_the_conductor_does_it(tmp_path: Path) -> None:
    season = make_season(tmp_path / "now", current=True)
    season = changed(season, freezes=season.settings.opens)
    with opened(season) as database:
        conductor = Conductor(season, database)
        conductor._acquire()
        conductor._sandbox = "process"
        with LocalExecutor(1) as executor:
            conductor.round(executor)
        assert acts(database) == [("the conductor", "freeze")]
        with database.reading() as session:
            (node,) = nodes(session)  # this machine, which no cluster reports
    assert (node["name"], node["running"], node["problem"]) == (socket.gethostname(), 0, "")
