"""How the teams of a match are placed."""

from tests.evaluator.tournaments.results_by_hand import results_of, seat

from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.tournaments.rated_matches import rated_matches


def test_the_team_with_the_better_score_has_the_better_place_and_equal_scores_tie() -> None:
    seats = [seat(0, "ada", supplies=3.0), seat(1, "bob", supplies=7.0), seat(2, "cy", supplies=3.0)]
    (match,) = rated_matches(results_of("battle", {0: seats}), repeats=2)
    assert match == RatedMatch(0, (("ada",), ("bob",), ("cy",)), (2, 1, 2))


def test_a_royale_is_won_by_the_last_one_standing_and_not_by_the_richest() -> None:
    seats = [
        seat(0, "rich", points=120.0, placement=2.0, supplies=120.0),
        seat(1, "alive", points=100.0, placement=1.0, supplies=0.0),
    ]
    (match,) = rated_matches(results_of("royale", {0: seats}), repeats=2)
    assert match.places == (2, 1)


def test_in_a_race_the_shorter_time_wins() -> None:
    seats = [seat(0, "slow", time=60.0), seat(1, "fast", time=20.0)]
    (match,) = rated_matches(results_of("capture", {0: seats}), repeats=2)
    assert match.places == (2, 1)


def test_the_seats_of_an_entrant_are_one_team() -> None:
    seats = [seat(0, "ada", team=0, supplies=4.0), seat(2, "bob", team=1, supplies=5.0)]
    seats += [seat(1, "bob", team=1, supplies=5.0), seat(3, "ada", team=0, supplies=4.0)]
    (match,) = rated_matches(results_of("battle", {0: seats}), repeats=2)
    assert match == RatedMatch(0, (("ada",), ("bob",)), (2, 1))


def test_a_mixed_team_has_all_its_members_in_one_place() -> None:
    seats = [
        seat(0, "ada", team=0, supplies=9.0),
        seat(1, "bob", team=0, supplies=9.0),
        seat(2, "cy", team=1, supplies=2.0),
        seat(3, "dan", team=1, supplies=2.0),
    ]
    (match,) = rated_matches(results_of("battle", {5: seats}), repeats=2)
    assert match == RatedMatch(2, (("ada", "bob"), ("cy", "dan")), (1, 2))


def test_a_match_that_the_platform_broke_rates_nobody() -> None:
    seats = [seat(0, "ada", supplies=3.0), seat(1, "bob", supplies=7.0)]
    assert len(list(rated_matches(results_of("battle", {0: seats, 1: []}), repeats=2))) == 1
