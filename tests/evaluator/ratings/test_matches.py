"""What a rated match may be, and which results of pairs follow from its places."""

import math

import pytest

from wildscav_evaluator.ratings.head_to_head import PairRecord, entrant_records, head_to_head
from wildscav_evaluator.ratings.matches import Pairing, RatedMatch, mean_places, pairings


def test_three_places_are_three_results_of_pairs() -> None:
    match = RatedMatch(0, (("a",), ("b",), ("c",)), (2, 1, 2))

    assert list(pairings(match)) == [Pairing("a", "b", 0.0), Pairing("a", "c", 0.5), Pairing("b", "c", 1.0)]


def test_teammates_are_not_compared() -> None:
    match = RatedMatch(0, (("a", "b"), ("c", "d")), (1, 2))

    assert [(one.first, one.second, one.points) for one in pairings(match)] == [
        ("a", "c", 1.0),
        ("a", "d", 1.0),
        ("b", "c", 1.0),
        ("b", "d", 1.0),
    ]


@pytest.mark.parametrize(
    ("places", "means"),
    [
        ((1, 2, 3), [1.0, 2.0, 3.0]),
        ((1, 1, 3), [1.5, 1.5, 3.0]),
        ((1, 1, 2), [1.5, 1.5, 3.0]),  # whatever the place after a tie is called
        ((1, 1, 1), [2.0, 2.0, 2.0]),
    ],
)
def test_ties_share_the_mean_of_their_places(places: tuple[int, ...], means: list[float]) -> None:
    assert list(mean_places(places)) == means


@pytest.mark.parametrize(
    ("teams", "places", "reason"),
    [
        ((("a",),), (1,), "two or more teams"),
        ((("a",), ()), (1, 2), "two or more teams"),
        ((("a",), ("b", "a")), (1, 2), "named twice"),
        ((("a",), ("b",)), (1,), "as many places"),
        ((("a",), ("b",)), (0, 1), "places from 1"),
        ((("a",), ("b",)), (), "as many places"),
    ],
)
def test_a_match_that_makes_no_sense_is_refused(
    teams: tuple[tuple[str, ...], ...], places: tuple[int, ...], reason: str
) -> None:
    with pytest.raises(ValueError, match=reason):
        RatedMatch(0, teams, places)


MATCHES = [
    RatedMatch(0, (("a",), ("b",), ("c",)), (1, 2, 3)),
    RatedMatch(0, (("b",), ("a",), ("c",)), (1, 1, 3)),
    RatedMatch(1, (("c",), ("a",)), (1, 2)),
]


def test_wins_ties_and_losses_of_each_pair_in_both_orders() -> None:
    records = head_to_head(MATCHES)

    assert records["a", "b"] == PairRecord(wins=1, ties=1, losses=0)
    assert records["b", "a"] == PairRecord(wins=0, ties=1, losses=1)
    assert records["a", "c"] == PairRecord(wins=2, ties=0, losses=1)
    assert records["c", "b"] == PairRecord(wins=0, ties=0, losses=2)
    assert len(records) == 6
    assert records["a", "b"].share == 0.75


def test_entrants_who_never_met_have_no_record() -> None:
    records = head_to_head([RatedMatch(0, (("a", "b"), ("c",)), (1, 2))])

    assert ("a", "b") not in records  # teammates
    assert math.isnan(PairRecord().share)


def test_a_shared_first_place_is_no_win() -> None:
    records = entrant_records(MATCHES)

    a = records["a"]
    assert (a.matches, a.wins, a.shared_wins) == (3, 1, 1)
    assert a.mean_place == pytest.approx((1 + 1.5 + 2) / 3)
    assert a.share == pytest.approx(3.5 / 5)  # against b 1 and 0.5, against c 1, 1 and 0
    assert (records["c"].wins, records["c"].shared_wins, records["c"].mean_place) == (1, 0, 7 / 3)


def test_all_members_of_a_team_have_its_place() -> None:
    records = entrant_records([RatedMatch(0, (("a", "b"), ("c", "d"), ("e",)), (2, 1, 3))])

    assert {name: one.mean_place for name, one in records.items()} == {
        "a": 2.0,
        "b": 2.0,
        "c": 1.0,
        "d": 1.0,
        "e": 3.0,
    }
    assert (records["c"].wins, records["d"].wins) == (1, 1)
    assert records["a"].share == pytest.approx(1 / 3)
