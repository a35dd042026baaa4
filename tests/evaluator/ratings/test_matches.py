"""What a rated match may be, and which results of pairs follow from its places."""

import pytest

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
