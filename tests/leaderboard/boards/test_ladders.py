"""A ladder is applied in the order in which its matches were made, and compares what is comparable."""

from collections.abc import Sequence
from contextlib import suppress

import pytest
from sqlalchemy.orm import Session
from tests.leaderboard.boards.simulated_ladders import CONDITIONS
from tests.leaderboard.results_made import made_result
from tests.leaderboard.seasons_made import NOON

from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.results import metric_infos
from wildscav_evaluator.ratings.head_to_head import PairRecord, entrant_records
from wildscav_leaderboard.boards import ladders
from wildscav_leaderboard.boards.ladders import Played, apply_matches, placed_match, played_on
from wildscav_leaderboard.boards.meetings import Ladder, head_to_head, records_on
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.matches.service import (
    Entrant,
    add_ladder_match,
    deliver,
    judge_again,
    seats_of,
    void,
)
from wildscav_leaderboard.seasons.editions import Edition, digest_of
from wildscav_leaderboard.seasons.in_force import enter_edition
from wildscav_leaderboard.seasons.settings import TrackSettings

SCORE = metric_infos("royale")[0]


def edition(rounds: int) -> Edition:
    """An edition of the track; the number of rounds tells it from others."""
    return Edition(
        settings=TrackSettings(mode="ladder"),
        suite_file=None,
        conditions=CONDITIONS.model_copy(update={"rounds": rounds}),
        final_commitment="f",
        matches=1,
        metrics=metric_infos("royale"),
    )


FIRST, SECOND = edition(1), edition(2)
A, B = digest_of(FIRST.conditions), digest_of(SECOND.conditions)


def plan(session: Session, number: int, *entrants: str, under: Edition = FIRST) -> Match:
    enter_edition(session, "royale", under, NOON)
    seats = {seat: Entrant(f"robot:{name}", None) for seat, name in enumerate(entrants)}
    spec = MatchSpec(track="royale", map=MapSpec(seed=1), seats=("fighter",) * len(entrants))
    return add_ladder_match(session, "royale", number, spec, seats, NOON)


def end(session: Session, match: Match, places: Sequence[int] = (1, 2), broken: str = "") -> None:
    """Let a match end: every entrant has its place, and perhaps one of them breaks."""
    seats = seats_of(session, [match.id])[match.id]
    deliver(session, match, None, *made_result(match, seats, places, f"robot:{broken}"), SCORE, NOON)


def test_a_match_that_ends_early_waits_for_those_that_were_made_before_it(database: Database) -> None:
    with database.writing() as session:
        first, second, third = (plan(session, number, "fox", "owl") for number in range(3))
        end(session, second)
        assert apply_matches(session, "royale") == 0
        end(session, first, (2, 1))
        assert apply_matches(session, "royale") == 2
        void(third, NOON, "given up")
        fourth = plan(session, 3, "fox", "owl")
        end(session, fourth)
        assert apply_matches(session, "royale") == 1

        ends = [(2, 1), (1, 2), (1, 2)]
        matches = [
            placed_match(number, [("robot:fox", fox), ("robot:owl", owl)])
            for number, (fox, owl) in zip((0, 1, 3), ends, strict=True)
        ]
        assert played_on(session, "royale", A).matches == tuple(matches)


def test_matches_under_other_conditions_are_another_ladder(database: Database) -> None:
    with database.writing() as session:
        for number, under in enumerate((FIRST, SECOND, FIRST)):
            end(session, plan(session, number, "fox", "owl", under=under))
        assert apply_matches(session, "royale") == 3

        assert [match.game for match in played_on(session, "royale", A).matches] == [0, 1]
        assert len(played_on(session, "royale", B).matches) == 1


def test_a_match_that_an_opponent_broke_is_no_fault_of_ones_own(database: Database) -> None:
    with database.writing() as session:
        end(session, plan(session, 0, "fox", "owl"), broken="owl")
        end(session, plan(session, 1, "fox", "owl", "hare"), (1, 1, 3))
        apply_matches(session, "royale")

        played = played_on(session, "royale", A)
        assert played.faults == {"robot:fox": 0, "robot:owl": 1, "robot:hare": 0}
        assert entrant_records(played.matches)["robot:fox"].wins == 1
        met = head_to_head(session, "royale", A, ["robot:fox", "robot:owl", "robot:hare"])
        assert met["robot:fox", "robot:owl"] == PairRecord(wins=1, ties=1, losses=0)
        assert met["robot:hare", "robot:fox"] == PairRecord(wins=0, ties=0, losses=1)
        assert set(head_to_head(session, "royale", A, ["robot:fox", "robot:owl"])) == {
            ("robot:fox", "robot:owl"),
            ("robot:owl", "robot:fox"),
        }
        against = {"robot:fox": PairRecord(losses=1), "robot:owl": PairRecord(losses=1)}
        assert records_on(session, [Ladder("royale", A)], "robot:hare") == {"royale": against}


def test_a_frozen_board_tells_nothing_of_later_meetings(database: Database) -> None:
    with database.writing() as session:
        for number, places in enumerate(((1, 2), (1, 2), (2, 1))):
            end(session, plan(session, number, "fox", "owl"), places)
        apply_matches(session, "royale")

        against = {"robot:owl": PairRecord(wins=2)}
        assert records_on(session, [Ladder("royale", A, 2)], "robot:fox") == {"royale": against}
        met = head_to_head(session, "royale", A, ["robot:fox", "robot:owl"], 2)
        assert met["robot:owl", "robot:fox"] == PairRecord(losses=2)


def wins(session: Session) -> dict[str, int]:
    records = entrant_records(played_on(session, "royale", A).matches)
    return {name: record.wins for name, record in records.items()}


def test_a_match_that_is_judged_again_counts_once_with_its_later_result(database: Database) -> None:
    with database.writing() as session:
        first, second = (plan(session, number, "fox", "owl") for number in range(2))
        for match in (first, second):
            end(session, match)
        again = judge_again(session, first, NOON)
        assert again is not None
        assert judge_again(session, first, NOON) is None, "it is planned already"
        apply_matches(session, "royale")
        assert wins(session) == {"robot:fox": 2, "robot:owl": 0}, "the old one counts until then"

        end(session, again, (2, 1))
        assert apply_matches(session, "royale") == 2

        assert wins(session) == {"robot:fox": 1, "robot:owl": 1}
        assert session.get_one(Match, first.id).superseded == NOON


def test_what_was_read_of_a_ladder_is_kept_until_matches_are_applied(database: Database) -> None:
    def read() -> Played:
        with database.reading() as session:
            return played_on(session, "royale", A)

    with database.writing() as session:
        first, second, third = (plan(session, number, "fox", "owl") for number in range(3))
        end(session, first)
        apply_matches(session, "royale")
    known = read()
    assert read() is known
    with suppress(KeyboardInterrupt), database.writing() as session:
        assert played_on(session, "royale", A) is known, "with its fit"
        end(session, session.get_one(Match, second.id), (2, 1))
        apply_matches(session, "royale")
        assert len(played_on(session, "royale", A).matches) == 2
        raise KeyboardInterrupt
    assert read() is known, "what was never stored is not kept"

    with database.writing() as session:
        end(session, session.get_one(Match, second.id), (1, 1), broken="owl")
        apply_matches(session, "royale")
    more = read()
    assert more.matches[:1] == known.matches
    assert [match.places for match in more.matches] == [(1, 2), (1, 1)]
    assert (known.faults["robot:owl"], more.faults["robot:owl"]) == (0, 1)

    with database.writing() as session:
        again = judge_again(session, session.get_one(Match, first.id), NOON)
        assert again is not None
        end(session, session.get_one(Match, third.id))
        end(session, again, (2, 1))
        apply_matches(session, "royale")
    assert [match.places for match in read().matches] == [(1, 1), (1, 2), (2, 1)]


def test_many_matches_are_applied_in_several_transactions(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ladders, "AT_ONCE", 2)
    with database.writing() as session:
        planned = [plan(session, number, "fox", "owl") for number in range(6)]
        for match in planned[1:4]:
            void(match, NOON, "given up")
        for match in (planned[0], *planned[4:]):
            end(session, match)
    found = []
    for _ in range(3):
        with database.writing() as session:
            found.append(apply_matches(session, "royale"))
    assert found == [2, 1, 0]


def test_a_ladder_that_begins_anew_is_never_seen_in_part(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ladders, "AT_ONCE", 1)

    def first_meeting() -> PairRecord:
        with database.reading() as session:
            return records_on(session, [Ladder("royale", A, 1)], "robot:fox")["royale"]["robot:owl"]

    with database.writing() as session:
        first, *others = (plan(session, number, "fox", "owl") for number in range(3))
        for match, places in zip((first, *others), ((1, 2), (2, 1), (2, 1)), strict=True):
            end(session, match, places)
            apply_matches(session, "royale")
    assert first_meeting() == PairRecord(wins=1)
    with database.writing() as session:
        again = judge_again(session, session.get_one(Match, first.id), NOON)
        assert again is not None
        end(session, again)
        assert apply_matches(session, "royale") == 3
    assert first_meeting() == PairRecord(losses=1), "the match that is the first one now"
