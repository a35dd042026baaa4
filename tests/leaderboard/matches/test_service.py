"""Which match is played next, and how matches are listed."""

import pytest
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, SUITE, VOID, WAITING, Match
from wildscav_leaderboard.matches.service import (
    Entrant,
    add_match,
    find_match,
    list_matches,
    next_matches,
    seats_of,
    void,
)
from wildscav_leaderboard.seasons.refusals import NotFoundError

ROBOTS = {1: Entrant("robot:walker", None), 0: Entrant("robot:fighter", None)}


def added(session: Session, track: str, priority: int) -> int:
    """Add a match that waits, and return its number."""
    match = Match(
        kind=SUITE,
        track=track,
        number=priority,
        group_id=1,
        priority=priority,
        state=WAITING,
        spec={},
        created=NOON,
        since=NOON,
    )
    return add_match(session, match, ROBOTS).id


def test_tracks_take_turns_by_priority_and_age(database: Database) -> None:
    with database.writing() as session:
        late, first, second = (added(session, "navigation", priority) for priority in (2, 0, 0))
        battle = added(session, "battle", 5)
        editions = {"navigation": None, "battle": None}
        found = [match.id for match in next_matches(session, editions, 10)]
        assert found == [first, battle, second, late]
        assert [match.id for match in next_matches(session, editions, 2)] == found[:2]
        assert next_matches(session, {"navigation": 1}, 10) == []  # of another edition

        void(find_match(session, first), NOON, "its map is broken")
        assert first not in [match.id for match in next_matches(session, editions, 10)]


def test_matches_are_listed_the_newest_first_by_track_and_state(database: Database) -> None:
    with database.writing() as session:
        one, two, three = (added(session, track, 0) for track in ("navigation", "battle", "navigation"))
        find_match(session, one).state = FINISHED
        void(find_match(session, three), NOON, "given up")
        session.flush()

        assert [match.id for match in list_matches(session)] == [three, two, one]
        assert [match.id for match in list_matches(session, before=three, limit=1)] == [two]
        assert [match.id for match in list_matches(session, track="navigation")] == [three, one]
        for state, number in ((FINISHED, one), (WAITING, two), (VOID, three)):
            assert [match.id for match in list_matches(session, state=state)] == [number]
        assert [seat.entrant for seat in seats_of(session, [two])[two]] == ["robot:fighter", "robot:walker"]
        with pytest.raises(NotFoundError, match="there is no match 99"):
            find_match(session, 99)
