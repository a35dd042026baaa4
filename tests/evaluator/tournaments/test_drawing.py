"""The matches of a tournament: the suite's games, each played again with its entrants in other seats."""

from collections import Counter

import pytest

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_evaluator.output.results import TournamentSettings
from wildscav_evaluator.suites.quick import QUICK
from wildscav_evaluator.suites.suite import Suite
from wildscav_evaluator.tournaments.drawing import (
    TournamentMatch,
    tournament_match_count,
    tournament_matches,
)

SIX = ["ada", "bob", "cy", "dan", "eve", "robot:fighter"]


def drawn(
    *, track: str = "battle", seed: int = 0, rounds: int = 2, entrants: list[str] = SIX, **settings: object
) -> tuple[TournamentMatch, ...]:
    return tournament_matches(
        QUICK, track, seed, rounds, TournamentSettings.model_validate({"seats": 3} | settings), entrants
    )


def test_a_game_is_played_again_on_the_same_map_and_seed_with_other_seats() -> None:
    matches = drawn()
    assert [match.game for match in matches] == [index // 2 for index in range(len(matches))]
    for first, second in zip(matches[::2], matches[1::2], strict=True):
        assert (first.spec.map, first.spec.seed) == (second.spec.map, second.spec.seed)
        assert set(first.entrants.values()) == set(second.entrants.values())
        assert all(first.entrants[seat] != second.entrants[seat] for seat in first.entrants)
    seeds = {match.spec.seed for match in matches}
    assert len(seeds) == len(matches) // 2, "every game has a seed of its own"


def test_a_robot_that_is_an_entrant_plays_in_the_engine_under_a_name_of_its_own() -> None:
    for match in drawn(robots=("fighter",)):
        for seat, name in match.entrants.items():
            assert match.spec.seats[seat] == ("fighter" if name == "robot:fighter" else SUBMISSION)
            assert match.names[seat] == name
        (other,) = set(range(4)) - match.entrants.keys()
        assert (match.spec.seats[other], match.names[other]) == ("fighter", "fighter 1")


def test_a_team_is_one_entrant_unless_teams_are_mixed() -> None:
    for mixed, distinct in ((False, 1), (True, 2)):
        for match in drawn(seats=4, team_size=2, mixed=mixed):
            teams: dict[int, set[str]] = {}
            for seat, name in match.entrants.items():
                teams.setdefault(match.spec.team_of_seats[seat], set()).add(name)
            assert [len(team) for team in teams.values()] == [distinct, distinct]


def test_robots_beside_the_entrants_have_teams_of_their_own() -> None:
    for track, sizes in (("battle", [1, 1, 2, 2]), ("capture", [2, 2, 2])):
        for match in drawn(track=track, seats=4, team_size=2, robots=("walker", "walker")):
            assert sorted(Counter(match.spec.team_of_seats).values()) == sizes


def test_entries_of_one_submission_never_meet_unless_they_may() -> None:
    entries = ["ada@1", "ada@2", "bob", "cy"]
    together = [
        {"ada@1", "ada@2"} <= set(match.entrants.values())
        for meet_own in (False, True)
        for match in drawn(entrants=entries, seats=2, rounds=9, meet_own=meet_own)
    ]
    half = len(together) // 2
    assert not any(together[:half])
    assert any(together[half:])


def test_the_number_of_matches_does_not_depend_on_the_seed() -> None:
    settings = TournamentSettings(seats=3)
    assert {len(drawn(seed=seed)) for seed in range(4)} == {tournament_match_count(2, settings, SIX)}


def test_another_seed_gives_other_games_and_other_opponents() -> None:
    one, other = drawn(seed=1), drawn(seed=2)
    assert [match.spec for match in one] != [match.spec for match in other]
    assert [match.entrants for match in one] != [match.entrants for match in other]
    assert drawn(seed=1) == one


def test_too_many_entries_of_one_submission_are_refused_with_the_option_that_lets_them_meet() -> None:
    entries = ["ada@1", "ada@2", "bob"]
    with pytest.raises(UserError, match=r"2 of the 3 entrants may not meet .*; --meet-own lets entries"):
        drawn(entrants=entries, seats=2)
    assert drawn(entrants=entries, seats=2, meet_own=True)
    with pytest.raises(UserError, match=r"such a tournament is not possible: [^;]*entrants[^;]*$"):
        drawn(entrants=["ada", "bob"])


def test_a_suite_whose_matches_fix_the_seats_is_refused() -> None:
    def draw(dice: object) -> object:
        return (
            QUICK.tracks["battle"]
            .draw(dice)
            .model_copy(  # type: ignore[arg-type]
                update={"starts": ((0.0, 0.0, 0.0),) * 6}
            )
        )

    tracks = {"battle": QUICK.tracks["battle"]._replace(draw=draw)}  # type: ignore[arg-type]
    fixed = Suite(name="fixed", title="", map_config=QUICK.map_config, tracks=tracks)
    with pytest.raises(UserError, match=r"suite fixed .* with 3 seats .* starts has 6 entries"):
        tournament_matches(fixed, "battle", 0, 1, TournamentSettings(seats=3), SIX)
