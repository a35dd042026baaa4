"""How many matches a rank needs, in simulated tournaments."""

from typing import Annotated

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_evaluator.ratings.fit import ELO, fit

# Entrants, each so many points of Elo above the next; the matches of each that are tried, four in a match.
TEAMS, GAPS, MATCHES = 10, (50, 100, 200), (12, 24, 48, 100, 200, 400, 800, 1600)
OFTEN = 0.9  # share of the seasons in which a rank must be right


def main(
    tournaments: Annotated[int, typer.Option(help="Simulated tournaments of each field.")] = 100,
    json_file: JsonFile = None,
) -> None:
    """Print how many matches each entrant needs until ranks are right."""
    figures = [figure for gap in GAPS for figure in _needed(gap, tournaments)]
    publish(f"Ratings: matches that a rank needs, in {tournaments} tournaments", figures, json_file)


def _needed(gap: int, seasons: int) -> list[Figure]:
    """Return how many matches each of ten entrants needs until a rank is right often enough."""
    strengths = [gap / ELO * step for step in range(TEAMS, 0, -1)]
    needed: dict[str, int] = {}
    for matches in MATCHES:
        plan = {"games": matches * TEAMS // 8, "seats": 4, "repeats": 2}
        fits = [fit(simulated_tournament(strengths, seed, **plan)) for seed in range(seasons)]
        right = np.equal([np.argsort(-one.ratings) for one in fits], range(TEAMS))
        for what, share in (("the first leads", right[:, 0].mean()), ("a rank is right", right.mean())):
            if share >= OFTEN:
                needed.setdefault(what, matches)
        if len(needed) == 2:
            break
    return [Figure(f"{TEAMS} entrants, {gap} points apart: {one}", needed[one], "matches") for one in needed]


if __name__ == "__main__":
    typer.run(main)
