"""What can be a schedule, and what to say of what cannot."""

from collections import Counter
from collections.abc import Sequence

from wildscav_evaluator.bounds import FEWEST_ENTRANTS, MOST_ENTRANTS, MOST_MATCHES, MOST_PLAYERS
from wildscav_evaluator.tournaments.pairings import round_games


def entrants_of_game(seats: int, team_size: int, mixed: bool) -> int:
    """Return the number of entrants in a game.

    Raises:
        ValueError: The seats cannot be divided so, or a game would have less than two entrants.
    """
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
    """Check the other arguments of `make_schedule`, for games of so many places for entrants.

    Raises:
        ValueError: There is no such schedule, or it would be too long.
    """
    if not FEWEST_ENTRANTS <= entrants <= MOST_ENTRANTS:
        raise ValueError(
            f"a tournament has {FEWEST_ENTRANTS} to {MOST_ENTRANTS:,} entrants, not {entrants:,}"
        )
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
    if matches > MOST_MATCHES or matches * seats > MOST_PLAYERS:
        most = min(MOST_MATCHES, MOST_PLAYERS // seats) // (games * repeats)
        raise ValueError(
            f"{rounds:,} rounds have {matches:,} matches with {matches * seats:,} seats; a tournament has at"
            f" most {MOST_MATCHES:,} matches and {MOST_PLAYERS:,} seats, and so here at most {most:,} rounds"
        )
