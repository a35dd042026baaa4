"""The schedule of a tournament: who plays whom, and where, from the seed alone.

A game is a map and a match seed with the entrants who play on it. It is played several times, with the same
entrants in other seats, so that luck of the start cancels. A round is n / g games of P entrants, with g the
greatest common divisor of the number n of entrants and P: the least number of games in which everyone can
play equally often, P / g times.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.bounds import FEWEST_ENTRANTS, MAX_ENTRANTS, MAX_MATCHES, MAX_PLAYERS
from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.pairings import pair_up, round_games
from wildscav_evaluator.tournaments.seating import seat_games, seat_teammates

Int = NDArray[np.int64]


class Schedule(NamedTuple):
    """The M matches of a tournament among n entrants, in the order in which they count for ratings.

    The repeats of a game follow each other, and so do the games of a round.
    """

    rounds: NDArray[np.int32]  # (M,) the round of each match, from 0
    games: NDArray[np.int32]  # (M,) the game of each match, from 0
    players: NDArray[np.int32]  # (M, K) the entrant at each seat
    teams: tuple[int, ...]  # (K,) the team of each seat
    groups: tuple[int, ...]  # (n,) entrants of one group never meet; all differ if everyone may meet
    mixed: bool  # whether the players of a team are different entrants


def make_schedule(
    entrants: int,
    *,
    seats: int,
    rounds: int,
    seed: int,
    team_size: int = 1,
    mixed: bool = False,
    repeats: int = 2,
    groups: Sequence[int] | None = None,
) -> Schedule:
    """Make the schedule of a tournament.

    Everyone plays equally often in each round. The numbers of games in which two pairs meet
    differ by at most one if P, the entrants of a game, is 2, n - 2 or more. For other numbers a
    bounded search may not find such games, and for some there are none: of all sizes up to 12 entrants and
    rounds, 93 % had a spread of at most 1; of 600 random sizes (4 to 1,000 entrants, P up to 10, up to 20
    rounds), 71 % of at most 1, 84 % of at most 2 and none of more than 5. Larger spreads occur if everyone
    meets several times.

    Without groups, the spread depends on these numbers alone, and the seed decides which entrant is which.
    Groups make it larger at times.

    If the repeats divide P, an entrant's matches at two seats differ by at most one, with
    mixed teams nearly so.

    Args:
        entrants: n, 2 to 1,000. The caller numbers them, in the same order each time.
        seats: K, the seats for players of entrants.
        rounds: At least 1.
        seed: Any integer.
        team_size: The players of a team; divides K.
        mixed: The players of a team are different entrants, else all one entrant's.
        repeats: How often each game is played, 1 to P: its entrants then sit elsewhere each time.
        groups: (n,) a number for each entrant. Entrants with the same number never meet.

    Raises:
        ValueError: There is no such schedule, or it would be too long; the message says what is allowed.
    """
    places = entrants_of_game(seats, team_size, mixed)
    check_schedule(entrants, places, seats, rounds, repeats, groups)
    own_groups = tuple(range(entrants) if groups is None else (int(group) for group in groups))
    draws = Draws("schedule", entrants, seats, rounds, seed, team_size, mixed, repeats, own_groups)
    by_round = _draw_games(own_groups, places, rounds, draws)
    drawn = by_round.reshape(-1, places)
    if mixed and team_size > 1:
        seated = seat_teammates(drawn, team_size, repeats, draws)
    else:
        seated = np.repeat(seat_games(drawn, repeats, draws), seats // places, axis=2)
    count = len(drawn)
    return Schedule(
        rounds=np.repeat(np.arange(rounds, dtype=np.int32), count // rounds * repeats),
        games=np.repeat(np.arange(count, dtype=np.int32), repeats),
        players=seated.reshape(count * repeats, seats).astype(np.int32),
        teams=tuple(seat // team_size for seat in range(seats)),
        groups=own_groups,
        mixed=mixed,
    )


def _draw_games(groups: tuple[int, ...], places: int, rounds: int, draws: Draws) -> Int:
    """Return the games (R, B, P) of each round, with rounds, games and entrants in random order."""
    number_of_group = np.unique(np.array(groups), return_inverse=True)[1]
    sizes = np.bincount(number_of_group)
    # Games are made for groups in the order of their sizes. Which of the groups of one size is which is
    # random, and so is the order of the entrants of a group.
    order = np.lexsort((draws.order(len(sizes)), sizes))
    sorted_groups = tuple(np.repeat(np.arange(len(order)), sizes[order]).tolist())
    members = np.lexsort((draws.order(len(groups)), np.argsort(order)[number_of_group]))
    games = members[pair_up(sorted_groups, places, rounds)]
    games = games[draws.order(rounds)]
    games = np.stack([played[draws.order(len(played))] for played in games])
    return np.take_along_axis(games, draws.orders(*games.shape), axis=2)


def entrants_of_game(seats: int, team_size: int, mixed: bool) -> int:
    """Return the number of entrants in a game; ValueError if there are no two, or no whole teams."""
    if team_size < 1 or seats < 1 or seats % team_size:
        raise ValueError(f"{seats} seats cannot be divided into teams of {team_size}")
    places = seats if mixed else seats // team_size
    if places < 2:
        raise ValueError(
            f"a game has at least 2 entrants; {seats} seats in teams of {team_size} hold {places}"
        )
    return places


def check_schedule(
    entrants: int, places: int, seats: int, rounds: int, repeats: int, groups: Sequence[int] | None
) -> None:
    """Check the other arguments of `make_schedule`, for games of so many places for entrants."""
    if not FEWEST_ENTRANTS <= entrants <= MAX_ENTRANTS:
        raise ValueError(f"a tournament has {FEWEST_ENTRANTS} to {MAX_ENTRANTS:,} entrants, not {entrants:,}")
    if entrants < places:
        raise ValueError(f"each game needs {places} entrants, and there are only {entrants}")
    if rounds < 1:
        raise ValueError(f"a tournament has at least 1 round, not {rounds}")
    if not 1 <= repeats <= places:
        raise ValueError(f"a game of {places} entrants can be played 1 to {places} times, not {repeats}")
    if groups is not None:
        _check_groups(entrants, places, groups)
    _check_length(round_games(entrants, places), rounds, repeats, seats)


def _check_groups(entrants: int, places: int, groups: Sequence[int]) -> None:
    if len(groups) != entrants:
        raise ValueError(f"groups are given for {len(groups)} entrants; there are {entrants}")
    largest, most = max(Counter(groups).values()), entrants // places
    if largest > most:
        raise ValueError(
            f"{largest} of the {entrants} entrants may not meet each other; with {places} entrants in a game,"
            f" at most {most} of them could play as often as everyone else"
        )


def _check_length(games: int, rounds: int, repeats: int, seats: int) -> None:
    matches = games * rounds * repeats
    if matches > MAX_MATCHES or matches * seats > MAX_PLAYERS:
        most = min(MAX_MATCHES, MAX_PLAYERS // seats) // (games * repeats)
        raise ValueError(
            f"{rounds:,} rounds have {matches:,} matches with {matches * seats:,} seats; a tournament has at"
            f" most {MAX_MATCHES:,} matches and {MAX_PLAYERS:,} seats, and so here at most {most:,} rounds"
        )
