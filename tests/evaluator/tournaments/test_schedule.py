"""Schedules: everyone plays, meets everyone else and has every seat equally often."""

from collections import Counter
from hashlib import blake2b
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import count_meetings, even_out, spread_of
from wildscav_evaluator.tournaments.pairings import pair_up
from wildscav_evaluator.tournaments.schedule import Schedule, make_schedule
from wildscav_evaluator.tournaments.seating import colour_edges

Int = NDArray[np.int64]


def pair_counts(schedule: Schedule) -> Int:
    """In how many games each two entrants play, with or against each other: (n, n), the diagonal 0."""
    return _pairs_in(_entrants_of_games(schedule), schedule)


def teammate_counts(schedule: Schedule) -> Int:
    """In how many games each two entrants are teammates: (n, n), the diagonal 0."""
    size = schedule.teams.count(0) if schedule.mixed else 1
    return _pairs_in(_entrants_of_games(schedule).reshape(-1, size), schedule)


def seat_counts(schedule: Schedule) -> Int:
    """In how many matches each entrant has each seat: (n, K)."""
    counts = np.zeros((len(schedule.groups), len(schedule.teams)), np.int64)
    np.add.at(counts, (schedule.players, np.arange(len(schedule.teams))), 1)
    return counts


def spread(schedule: Schedule) -> int:
    """By how many games the meetings of two pairs differ at most, among the pairs that may meet."""
    return spread_of(pair_counts(schedule), schedule.groups)


def _entrants_of_games(schedule: Schedule) -> Int:
    """Return the entrants of each game, each named once: (G, P)."""
    first = np.flatnonzero(np.diff(schedule.games, prepend=-1))
    apart = 1 if schedule.mixed else schedule.teams.count(0)
    return schedule.players[first, ::apart].astype(np.int64)


def _pairs_in(games: Int, schedule: Schedule) -> Int:
    counts = count_meetings(games, len(schedule.groups))
    np.fill_diagonal(counts, 0)
    return counts


@st.composite
def settings_of_schedules(draw: st.DrawFn) -> dict[str, Any]:
    """Return arguments of `make_schedule` that are possible."""
    team_size, mixed = draw(st.integers(1, 3)), draw(st.booleans())
    teams = draw(st.integers(1 if mixed and team_size > 1 else 2, 4))
    places = teams * team_size if mixed else teams
    entrants = draw(st.integers(places, places + 12))
    groups = None
    if draw(st.booleans()):
        largest = entrants // places
        sizes = draw(st.lists(st.integers(1, largest), min_size=entrants, max_size=entrants))
        numbered = [number for number, size in enumerate(sizes) for _ in range(size)][:entrants]
        groups = draw(st.permutations(numbered))
    return {
        "entrants": entrants,
        "seats": teams * team_size,
        "rounds": draw(st.integers(1, 4)),
        "seed": draw(st.integers(-(2**70), 2**70)),
        "team_size": team_size,
        "mixed": mixed,
        "repeats": draw(st.integers(1, places)),
        "groups": groups,
    }


def matches_of_games(schedule: Schedule) -> list[np.ndarray[Any, Any]]:
    """Return the players (Q, K) of all matches of each game."""
    return [schedule.players[schedule.games == game] for game in range(schedule.games.max() + 1)]


@given(settings_of_schedules())
def test_every_schedule_is_fair(arguments: dict[str, Any]) -> None:
    schedule = make_schedule(**arguments)
    entrants, repeats, team_size = arguments["entrants"], arguments["repeats"], arguments["team_size"]
    places = arguments["seats"] if arguments["mixed"] else arguments["seats"] // team_size
    group = np.arange(entrants) if arguments["groups"] is None else np.array(arguments["groups"])

    for number in range(arguments["rounds"]):  # after each round, everyone has played equally often
        counts = np.bincount(schedule.players[schedule.rounds == number].reshape(-1), minlength=entrants)
        assert counts.min() == counts.max() > 0
    assert (np.diff(schedule.games) >= 0).all()
    assert (np.bincount(schedule.games) == repeats).all()
    for matches in matches_of_games(schedule):
        playing = set(matches[0].tolist())
        assert (
            len(playing) == len(set(group[list(playing)])) == places
        )  # nobody meets an entry of the same group
        for match in matches:  # the same entrants, in other seats
            assert Counter(match.tolist()) == Counter(matches[0].tolist())
        for seats_of_two in zip(*np.triu_indices(repeats, 1), strict=True):
            first, second = matches[list(seats_of_two)]
            assert (first != second).all() if not arguments["mixed"] else (first != second).any()
        if not arguments["mixed"]:
            assert all(len(set(team)) == 1 for team in matches.reshape(-1, team_size).tolist())

    unevenness = seat_counts(schedule).max() - seat_counts(schedule).min()
    if repeats == places:
        assert unevenness == 0
    elif not arguments["mixed"] and places % repeats == 0:
        assert unevenness <= 1


@pytest.mark.parametrize(
    ("entrants", "seats", "rounds", "uneven"),
    [
        (8, 2, 7, 0),  # everyone has met everyone
        (9, 2, 4, 0),
        (10, 2, 13, 1),
        (7, 3, 1, 0),  # the Fano plane
        (13, 4, 1, 0),  # the projective plane of order 3
        (16, 4, 5, 0),  # the affine plane of order 4
        (25, 5, 4, 1),
        (9, 3, 4, 0),  # the affine plane of order 3
        (8, 4, 7, 0),
        (13, 9, 1, 0),  # the games of the projective plane, of those who were absent
        (10, 9, 3, 0),  # one is absent in turn
        (10, 8, 4, 1),  # two are
        (6, 6, 3, 0),
        (1000, 10, 10, 1),
        (999, 9, 10, 1),
        (997, 10, 2, 1),
    ],
)
def test_pairs_meet_equally_often(entrants: int, seats: int, rounds: int, uneven: int) -> None:
    schedule = make_schedule(entrants, seats=seats, rounds=rounds, seed=4)

    met = pair_counts(schedule)[np.triu_indices(entrants, 1)]
    assert spread(schedule) == met.max() - met.min() == uneven
    assert met.sum() == schedule.games[-1:].sum() * seats * (seats - 1) // 2 + seats * (seats - 1) // 2


@given(st.integers(2, 60), st.integers(1, 12), st.booleans())
def test_in_games_of_two_the_meetings_differ_by_one_at_most(entrants: int, rounds: int, absent: bool) -> None:
    seats = entrants - 2 if absent and entrants > 3 else 2

    assert spread(make_schedule(entrants, seats=seats, rounds=rounds, seed=0, repeats=1)) <= 1


def test_with_two_repeats_the_starts_are_exchanged() -> None:
    schedule = make_schedule(8, seats=4, rounds=2, seed=3)

    for first, second in matches_of_games(schedule):
        assert second.tolist() == [first[2], first[3], first[0], first[1]]


def test_a_team_is_one_submission_and_changes_sides() -> None:
    schedule = make_schedule(4, seats=6, rounds=3, seed=3, team_size=3)

    assert schedule.teams == (0, 0, 0, 1, 1, 1)
    assert spread(schedule) == 0
    assert not teammate_counts(schedule).any()
    for first, second in matches_of_games(schedule):
        assert second.tolist() == [*first[3:], *first[:3]]
        assert len(set(first.tolist())) == 2


def test_mixed_teams_are_of_everyone_with_everyone() -> None:
    """Twelve entrants, two against two: seven rounds are 21 games, with 42 of the 66 pairs as teammates."""
    schedule = make_schedule(12, seats=4, rounds=7, seed=3, team_size=2, mixed=True)

    mates = teammate_counts(schedule)[np.triu_indices(12, 1)]
    assert (mates.sum(), mates.max()) == (42, 1)
    for first, second in matches_of_games(schedule):
        assert sorted(first[:2].tolist()) == sorted(second[2:].tolist())  # teammates stay together
        assert len(set(first.tolist())) == 4


def test_one_team_of_all_players_can_only_be_mixed() -> None:
    schedule = make_schedule(6, seats=3, rounds=5, seed=3, team_size=3, mixed=True, repeats=3)

    assert schedule.teams == (0, 0, 0)
    assert (teammate_counts(schedule) == pair_counts(schedule)).all()
    with pytest.raises(ValueError, match="at least 2 entrants; 3 seats in teams of 3 hold 1"):
        make_schedule(6, seats=3, rounds=5, seed=3, team_size=3)


def test_entries_of_one_submission_never_meet_and_all_others_meet_equally_often() -> None:
    groups = [7, 7, 3, 4, 5, 5, 9, 9]

    schedule = make_schedule(8, seats=2, rounds=12, seed=1, groups=np.array(groups))

    apart = np.array(groups)[:, None] == np.array(groups)[None, :]
    assert not pair_counts(schedule)[apart].any()
    assert pair_counts(schedule)[~apart].min() >= 1
    assert np.bincount(schedule.players[::2].reshape(-1)).tolist() == [12] * 8


def test_the_seed_decides_everything() -> None:
    first, again, other = (make_schedule(12, seats=4, rounds=3, seed=seed) for seed in (5, 5, 6))

    assert first.players.tobytes() == again.players.tobytes()
    assert first.players.tobytes() != other.players.tobytes()
    assert spread(first) == spread(other)


@pytest.mark.parametrize(
    ("arguments", "digest"),
    [
        ({"entrants": 9, "seats": 2, "rounds": 4}, "0d00fd28806fe585"),  # around the circle
        ({"entrants": 12, "seats": 4, "rounds": 5}, "1f8da9cdc5d2e898"),  # by swaps
        ({"entrants": 8, "seats": 4, "rounds": 3, "team_size": 2, "mixed": True}, "73bd09d345e885fa"),
        ({"entrants": 8, "seats": 4, "rounds": 3, "groups": [0, 0, 1, 2, 3, 4, 5, 6]}, "9d82c528d0e21584"),
    ],
)
def test_a_schedule_never_changes(arguments: dict[str, Any], digest: str) -> None:
    """A tournament is checked by its seed, so a change would make old tournaments impossible to check."""
    schedule = make_schedule(seed=2026, **arguments)

    assert blake2b(schedule.players.astype("<i4").tobytes(), digest_size=8).hexdigest() == digest


@pytest.mark.parametrize("groups", [None, [0, 0, 1, 2, 3, 3, 4, 5]])
def test_the_number_of_an_entrant_is_no_advantage(groups: list[int] | None) -> None:
    """Over many seeds, everyone has the first seat of the first match equally often."""
    firsts = Counter(
        int(make_schedule(8, seats=4, rounds=1, seed=seed, groups=groups).players[0, 0])
        for seed in range(800)
    )

    assert all(60 <= firsts[entrant] <= 145 for entrant in range(8))  # 100 expected, four deviations of 9.4


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"entrants": 1}, "2 to 1,000 entrants, not 1"),
        ({"entrants": 10**12}, "2 to 1,000 entrants, not 1,000,000,000,000"),
        ({"entrants": 3}, "each game needs 4 entrants, and there are only 3"),
        ({"seats": 0}, "0 seats cannot be divided into teams of 1"),
        ({"seats": 1}, "a game has at least 2 entrants; 1 seats in teams of 1 hold 1"),
        ({"team_size": 3}, "4 seats cannot be divided into teams of 3"),
        ({"team_size": 0}, "4 seats cannot be divided into teams of 0"),
        ({"rounds": 0}, "at least 1 round, not 0"),
        ({"repeats": 0}, "can be played 1 to 4 times, not 0"),
        ({"repeats": 5}, "can be played 1 to 4 times, not 5"),
        ({"repeats": 3, "team_size": 2}, "a game of 2 entrants can be played 1 to 2 times, not 3"),
        ({"rounds": 3126}, "12,504 matches with 50,016 seats.* at most 3,125 rounds"),
        (
            {"entrants": 1000, "seats": 1000, "rounds": 26},
            "26 rounds have 52 matches.* at most 25 rounds",
        ),
        ({"groups": [0, 1]}, "groups are given for 2 entrants; there are 8"),
        ({"groups": [0, 0, 0, 1, 2, 3, 4, 5]}, "3 of the 8 entrants may not meet.*with 4.*at most 2"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(changed: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {"entrants": 8, "seats": 4, "rounds": 1, "seed": 1, **changed}

    with pytest.raises(ValueError, match=message) as refused:
        make_schedule(**arguments)
    assert "\n" not in str(refused.value)


def test_games_of_hundreds_are_made() -> None:
    games = pair_up(tuple(range(1000)), 400, 3)

    assert games.shape == (3, 5, 400)
    assert (np.sort(games.reshape(3, 2000), axis=1) == np.repeat(np.arange(1000), 2)).all()
    assert (np.diff(np.sort(games, axis=2), axis=2) > 0).all()


def test_swaps_make_meetings_more_even() -> None:
    start = np.stack([np.arange(20).reshape(5, 4)] * 4)  # the same games in all four rounds

    found = even_out(start, range(20), Draws("test"))

    assert spread_of(count_meetings(found, 20), range(20)) == 1  # it was 4
    assert (np.sort(found.reshape(4, 20), axis=1) == np.arange(20)).all()


def test_groups_that_fill_every_game_still_play_equally_often() -> None:
    """Three groups of three in threes: each game has one of each, and in three rounds all of them meet."""
    games = pair_up((0, 0, 0, 1, 1, 1, 2, 2, 2), 3, 3)

    met = count_meetings(games, 9)
    assert (np.sort(games // 3, axis=2) == np.arange(3)).all()
    assert spread_of(met, np.repeat(np.arange(3), 3).tolist()) == 0
    assert met[0, 3] == 1


def test_many_meetings_are_counted_as_few_are(monkeypatch: pytest.MonkeyPatch) -> None:
    games = pair_up(tuple(range(30)), 7, 4)
    listed = count_meetings(games, 30)

    monkeypatch.setattr("wildscav_evaluator.tournaments.meetings.MANY_CELLS", 0)

    assert (count_meetings(games, 30) == listed).all()


@given(st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=60))
def test_no_node_has_two_edges_of_a_colour(edges: list[tuple[int, int]]) -> None:
    left, right = np.array(edges, np.int64).T
    colours = int(max(np.bincount(left).max(), np.bincount(right).max()))

    found = colour_edges(left, right, colours)

    assert found.min() >= 0
    assert found.max() < colours
    for nodes in (left, right):
        assert len(set(zip(nodes.tolist(), found.tolist(), strict=True))) == len(edges)
