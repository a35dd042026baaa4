"""Tournaments among entrants of known strength, with luck, and without playing any match."""

from collections.abc import Sequence

import numpy as np

from wildscav_evaluator.ratings.matches import RatedMatch


def simulated_tournament(
    strengths: Sequence[float],
    seed: int,
    games: int = 40,
    seats: int = 4,
    repeats: int = 4,
    luck: float = 0.5,
) -> list[RatedMatch]:
    """Return the matches of a tournament, named by the entrants' indices: "00", "01" and so on.

    A match is a race of performances: strength, plus the luck of the entrant on the map of the game and of
    the start, which are the same in all its repeats, plus the luck of the match, which follows a Gumbel
    distribution, so that places follow Plackett and Luce's model.

    Args:
        strengths: Natural logarithms of odds.
        seed: Of all luck.
        games: The number of games; every entrant plays in as many, up to one.
        seats: Entrants in each match.
        repeats: Matches in each game, with the seats rotated.
        luck: Standard deviation of the luck of the map and of the start.
    """
    generator = np.random.default_rng(seed)
    played = np.zeros(len(strengths))
    matches = []
    for game in range(games):
        chosen = np.argsort(played + generator.random(len(strengths)))[:seats]  # who played least
        played[chosen] += 1
        on_map, starts = generator.normal(0.0, luck, size=(2, seats))
        for repeat in range(repeats):
            performances = (
                np.asarray(strengths)[chosen]
                + on_map
                + np.roll(starts, repeat)
                + generator.gumbel(size=seats)
            )
            places = 1 + np.argsort(np.argsort(-performances))
            teams = tuple((f"{i:02}",) for i in chosen)
            matches.append(RatedMatch(game, teams, tuple(places.tolist())))
    return matches
