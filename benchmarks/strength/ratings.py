"""Time to rate entrants, how often ratings separate identical ones, and how many matches a rank needs."""

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_evaluator.ratings.bands import rank_entrants, significantly_better
from wildscav_evaluator.ratings.fit import ELO, fit
from wildscav_evaluator.ratings.head_to_head import head_to_head
from wildscav_evaluator.ratings.ladder import ladder
from wildscav_evaluator.ratings.picture import draw_standings
from wildscav_evaluator.ratings.standings import rate

SIZES = ((8, 100, 4), (50, 500, 8), (200, 1000, 8), (1000, 5000, 8))  # entrants, games, entrants in a game
# The name of a field, its strengths, and its games, seats and repeats.
FIELDS: tuple[tuple[str, list[float], dict[str, int]], ...] = (
    ("2 identical, 6 games", [0.0] * 2, {"games": 6, "seats": 2, "repeats": 1}),
    ("2 identical, 12 games", [0.0] * 2, {"games": 12, "seats": 2, "repeats": 2}),
    ("8 identical, 30 games of 4", [0.0] * 8, {"games": 30, "seats": 4, "repeats": 2}),
    ("8 identical, 12 games of 8", [0.0] * 8, {"games": 12, "seats": 8, "repeats": 4}),
    ("30 identical, 300 games of 8", [0.0] * 30, {"games": 300, "seats": 8, "repeats": 2}),
    (
        "twins among 8, 40 games of 4",
        [1.5, 1.5, 0.8, 0.3, 0.0, -0.5, -1.0, -2.0],
        {"games": 40, "seats": 4, "repeats": 2},
    ),
    (
        "8 of which each beats the next in 2 of 3, 100 games of 4",
        [0.7 * step for step in range(8, 0, -1)],
        {"games": 100, "seats": 4, "repeats": 4},
    ),
)

# Entrants, each so many points of Elo above the next; the matches of each that are tried, four in a match.
TEAMS, GAPS, MATCHES = 10, (50, 100, 200), (12, 24, 48, 100, 200, 400, 800, 1600)
OFTEN = 0.9  # share of the seasons in which a rank must be right


def main(
    tournaments: Annotated[int, typer.Option(help="Simulated tournaments of each field.")] = 200,
    json_file: JsonFile = None,
) -> None:
    """Print how long ratings take, and how often entrants are told apart, in simulated tournaments."""
    rate(simulated_tournament([0.0] * 4, 0))  # imports what is imported late
    figures = [figure for size in SIZES for figure in _times(*size)]
    figures += [figure for field in FIELDS for figure in _separated(*field, tournaments)]
    figures += [figure for gap in GAPS for figure in _needed(gap, tournaments // 2)]
    publish(
        f"Ratings: processor time, and who is told apart in {tournaments} tournaments", figures, json_file
    )


def _times(entrants: int, games: int, seats: int) -> list[Figure]:
    strengths = np.random.default_rng(0).normal(0.0, 1.5, entrants).tolist()
    matches = simulated_tournament(strengths, 0, games=games, seats=seats, repeats=2)
    fitted, standings = fit(matches), rate(matches)
    with TemporaryDirectory() as folder:
        picture = Path(folder) / "standings.png"
        steps: tuple[tuple[str, Callable[[], Any]], ...] = (
            ("fit and bootstrap", lambda: fit(matches)),
            ("ranks and bands", lambda: rank_entrants(fitted)),
            ("ladder", lambda: ladder(matches)),
            ("head to head", lambda: head_to_head(matches)),
            ("picture", lambda: draw_standings(standings, "simulated", picture)),
        )
        return [
            Figure(f"{entrants:,} entrants, {len(matches):,} matches: {name}", 1000.0 * _seconds(step), "ms")
            for name, step in steps
        ]


def _seconds(step: Callable[[], Any]) -> float:
    start = time.process_time()
    step()
    return time.process_time() - start


def _separated(name: str, strengths: list[float], plan: dict[str, int], tournaments: int) -> list[Figure]:
    """Return how often identical entrants, and what part of the pairs of different ones, are told apart."""
    true = np.array(strengths)
    same, stronger = np.equal.outer(true, true), np.greater.outer(true, true)
    false, found = [], []
    for seed in range(tournaments):
        better = significantly_better(fit(simulated_tournament(strengths, seed, **plan)))
        false.append((better & ~stronger).any())
        found.append(better[stronger].mean() if stronger.any() else 0.0)
    figures = []
    if same.sum() > len(true):
        figures.append(Figure(f"{name}: tournaments with a false separation", 100.0 * np.mean(false), "%"))
    if stronger.any():
        figures.append(Figure(f"{name}: different pairs told apart", 100.0 * np.mean(found), "%"))
    return figures


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
