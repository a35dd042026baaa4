"""Seasons of a ladder among entrants of known strength, with luck, and without playing any match."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from tests.leaderboard.seasons_made import NOON

from wildscav_evaluator.output.results import CURRENT_VERSIONS, KeptLimits, metric_infos
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.seats import ROBOT_ENTRANT
from wildscav_leaderboard.boards.documents import Conditions, Entry, LadderBoard
from wildscav_leaderboard.boards.ladder_board import Enough, Played, Rating, ladder_board, ratings_of
from wildscav_leaderboard.boards.ladders import placed_match
from wildscav_leaderboard.boards.matchmaking import REPEATS, Candidate, choose_entrants

CONDITIONS = Conditions(
    versions=CURRENT_VERSIONS,
    suite="official",
    rounds=1,
    commitment="ab" * 32,
    sandbox="oci",
    limits=KeptLimits(),
)
ROBOTS = {"robot:fighter": 0.0, "robot:gatherer": -1.0, "robot:walker": -2.0}
AHEAD = 4  # games that are made before the results of earlier ones arrive


def play_ladder(
    strengths: Mapping[str, float], seed: int, enough: Enough, *, seats: int = 4, luck: float = 0.5
) -> tuple[RatedMatch, ...]:
    """Return the matches of a ladder that ends when everyone has played enough.

    Args:
        strengths: Natural logarithms of odds, by entrant. Each is of a team of its own, unless it is a robot.
        seed: Of all luck.
        enough: When an entrant has played enough.
        seats: Entrants in a match.
        luck: Standard deviation of the luck of the map and of the start, the same in all matches of a game.
    """
    generator = np.random.default_rng(seed)
    planned, matches = Counter[str](), list[RatedMatch]()
    ratings: dict[str, Rating] = {}
    game = 0
    while True:
        if game % AHEAD == 0:
            ratings = ratings_of(Played(tuple(matches)), enough.interval)
        found = [
            Candidate(
                name,
                None if name.startswith(ROBOT_ENTRANT) else number,
                ratings.get(name, Rating()).mean,
                planned[name],
                ratings.get(name, Rating()).is_settled,
            )
            for number, name in enumerate(strengths)
        ]
        chosen = choose_entrants(found, seats, enough.matches, f"{seed}/{game}")
        if chosen is None:
            return tuple(matches)
        names = [one.name for one in chosen]
        for _ in range(REPEATS):
            planned.update(names)
        strength = np.array([strengths[name] for name in names])
        matches += _game(names, strength, game, generator, luck)
        game += 1


def _game(
    names: Sequence[str], strength: np.ndarray, game: int, generator: np.random.Generator, luck: float
) -> list[RatedMatch]:
    """Return the matches of a game: a race of performances, in which the starts are exchanged."""
    on_map, starts = generator.normal(0.0, luck, size=(2, len(names)))
    found = []
    for turn in range(REPEATS):
        start = np.roll(starts, turn * len(names) // REPEATS)
        performance = strength + on_map + start + generator.gumbel(size=len(names))
        places = 1 + np.argsort(np.argsort(-performance))
        found.append(placed_match(REPEATS * game + turn, list(zip(names, places.tolist(), strict=True))))
    return found


def board_of(strengths: Mapping[str, float], matches: tuple[RatedMatch, ...], enough: Enough) -> LadderBoard:
    """Return the board of a ladder on which every submission is of a team of its own."""
    entrants = [Entry(name, number, name, team=name) for number, name in enumerate(strengths, 1)]
    entrants = [
        replace(one, submission=None, name=one.name.removeprefix(ROBOT_ENTRANT), team="")
        if one.name.startswith(ROBOT_ENTRANT)
        else one
        for one in entrants
    ]
    return ladder_board("battle", CONDITIONS, metric_infos("battle"), entrants, Played(matches), enough, NOON)


def is_lottery(board: LadderBoard, twins: Sequence[str]) -> bool:
    """Return whether a board tells identical submissions apart that are better than everyone else."""
    return any(row.rank is not None and row.rank > 1 for row in board.rows if row.team in twins)
