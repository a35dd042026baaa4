"""Rulings on who meets whom on a season's ladder."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_evaluator.seats import submission_seats
from wildscav_evaluator.suites.suite_file import find_suite
from wildscav_leaderboard.boards.matchmaking import Candidate, choose_entrants, ladder_match

ENOUGH = 6  # matches
FIGHTER = Candidate("robot:fighter", None, 1500.0, 0)


def submission(name: str, team: int, rating: float = 1500.0, matches: int = 0) -> Candidate:
    return Candidate(name, team, rating, matches)


candidates = st.lists(
    st.builds(
        submission, st.uuids().map(str), st.integers(1, 6), st.floats(500.0, 2500.0), st.integers(0, 9)
    ),
    unique_by=lambda one: one.name,
    max_size=12,
)


def names(chosen: Sequence[Candidate] | None) -> set[str]:
    assert chosen is not None
    return {one.name for one in chosen}


@given(candidates, st.integers(2, 4), st.text(max_size=5))
def test_submissions_of_one_team_never_meet_and_nobody_meets_itself(
    found: list[Candidate], seats: int, key: str
) -> None:
    chosen = choose_entrants([*found, FIGHTER], seats, ENOUGH, key)
    if chosen is not None:
        assert len(names(chosen)) == len(chosen) == seats
        teams = [one.team for one in chosen if one.team is not None]
        assert len(set(teams)) == len(teams)


@given(candidates, st.integers(2, 4), st.text(max_size=5), st.randoms())
def test_the_order_in_which_submissions_are_stored_changes_nothing(
    found: list[Candidate], seats: int, key: str, random: object
) -> None:
    shuffled = list(found)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert choose_entrants(found, seats, ENOUGH, key) == choose_entrants(shuffled, seats, ENOUGH, key)


@given(candidates, st.integers(2, 4), st.text(max_size=5))
def test_a_game_is_for_whoever_needs_it_most(found: list[Candidate], seats: int, key: str) -> None:
    chosen = choose_entrants([*found, FIGHTER], seats, ENOUGH, key)
    if chosen is not None:
        assert chosen[0].matches < ENOUGH
    # With a robot, two seats can always be filled.
    if seats == 2 and any(one.matches < ENOUGH for one in found):
        assert chosen is not None
        assert chosen[0].matches == min(one.matches for one in found)


def test_a_new_submission_comes_before_those_that_played_more() -> None:
    found = [submission("old", 1, matches=4), submission("older", 2, matches=5), submission("new", 3)]
    chosen = choose_entrants(found, 2, ENOUGH, "")
    assert chosen is not None
    assert chosen[0].name == "new"


def test_it_meets_anyone_whose_rating_is_near_its_own_and_nobody_who_is_far_away() -> None:
    near = [submission(f"near {number}", number, 1400.0 + 100.0 * number, 9) for number in range(2, 5)]
    far = [submission("weak", 6, 950.0, 1), submission("strong", 7, 2100.0, 1)]
    found = [submission("new", 1), *near, *far]
    met = Counter(name for key in range(60) for name in names(choose_entrants(found, 2, ENOUGH, str(key))))
    assert set(met) == {"new", *names(near)}
    assert min(met.values()) >= 10, "how near they are does not matter"
    assert names(choose_entrants([submission("new", 1), *far], 2, ENOUGH, "")) == {"new", "weak"}


def test_who_is_settled_needs_no_more_matches_and_who_never_is_stops_at_the_most() -> None:
    settled = [replace(submission("a", 1, matches=2), is_settled=True), FIGHTER]
    assert choose_entrants(settled, 2, ENOUGH, "") is None
    assert names(choose_entrants([*settled, submission("b", 2, matches=4)], 2, ENOUGH, "")) > {"b"}
    assert choose_entrants([*settled, submission("b", 2, matches=ENOUGH)], 2, ENOUGH, "") is None


def test_nobody_plays_when_all_have_played_enough() -> None:
    found = [submission("a", 1, matches=ENOUGH), submission("b", 2, matches=ENOUGH)]
    assert choose_entrants([*found, FIGHTER], 2, ENOUGH, "") is None


def test_a_lonely_submission_meets_a_robot_and_waits_if_there_is_none() -> None:
    assert names(choose_entrants([submission("a", 1), FIGHTER], 2, ENOUGH, "")) == {"a", "robot:fighter"}
    assert choose_entrants([submission("a", 1), submission("b", 1)], 2, ENOUGH, "") is None


def played_out(found: list[Candidate], seats: int) -> Counter[str]:
    """Make games until nobody needs one; return everyone's matches."""
    known = {one.name: one for one in found}
    for game in range(1000):
        chosen = choose_entrants(list(known.values()), seats, ENOUGH, str(game))
        if chosen is None:
            break
        for one in chosen:
            known[one.name] = replace(one, matches=one.matches + 2)
    return Counter({name: one.matches for name, one in known.items()})


@pytest.mark.parametrize("seats", [2, 3, 4])
def test_a_ladder_comes_to_rest_when_everyone_has_played_enough_and_hardly_more(seats: int) -> None:
    found = [submission(f"s{number}", number, rating=1450.0 + number) for number in range(10)]
    played = played_out([*found, FIGHTER], seats)
    for one in found:
        assert ENOUGH <= played[one.name] <= 3 * ENOUGH
    assert sum(played[one.name] for one in found) <= 1.6 * ENOUGH * len(found)


def test_robots_play_too_so_that_they_anchor_the_scale() -> None:
    found = [submission(f"s{number}", number, rating=1490.0 + number) for number in range(3)]
    assert played_out([*found, FIGHTER], 2)[FIGHTER.name] > 0


def test_a_game_is_played_twice_on_one_map_with_the_seats_exchanged() -> None:
    suite, who = find_suite("quick"), ["a", "b", "robot:fighter"]
    (first, seats), (second, others) = (ladder_match(suite, "battle", 5, turn, who) for turn in (6, 7))
    assert (first.map, first.seed, first.rules) == (second.map, second.seed, second.rules)
    assert sorted(seats.values()) == sorted(others.values()) == sorted(who)
    assert all(seats[seat] != others[seat] for seat in seats)
    for spec, taken in ((first, seats), (second, others)):
        assert {seat for seat, name in taken.items() if name in ("a", "b")} == {*submission_seats(spec.seats)}


def test_no_two_games_are_alike_even_when_the_suite_is_used_up() -> None:
    suite = find_suite("quick")
    settings = suite.tracks["battle"]
    games = 2 * settings.maps * settings.episodes + 1
    drawn = [ladder_match(suite, "battle", 5, 2 * game, ["a", "b"])[0] for game in range(games)]
    assert len({(spec.map.model_dump_json(), spec.seed) for spec in drawn}) == games
