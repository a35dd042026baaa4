"""Time to make the schedule of a tournament, and how evenly pairs meet in it."""

import time
from typing import Annotated

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish

from wildscav_evaluator.tournaments.meetings import count_meetings
from wildscav_evaluator.tournaments.pairings import pair_up
from wildscav_evaluator.tournaments.schedule import Schedule, make_schedule

# Entrants, entrants in a game, rounds.
SIZES = (
    (4, 2, 3),
    (8, 4, 7),
    (10, 4, 6),
    (12, 4, 11),
    (20, 10, 10),
    (30, 5, 10),
    (100, 4, 20),
    (100, 10, 10),
    (250, 10, 10),
    (999, 10, 2),
    (1000, 2, 20),
    (1000, 4, 20),
    (1000, 10, 10),
    (1000, 10, 20),
    (1000, 100, 2),
)


def main(
    rounds: Annotated[int, typer.Option(help="How often each schedule is made; the fastest counts.")] = 3,
    json_file: JsonFile = None,
) -> None:
    """Print for tournaments of several sizes how long it takes to make the schedule, and its spread."""
    figures = []
    for entrants, seats, length in SIZES:
        schedule, seconds = _fastest(entrants, seats, length, rounds)
        name = f"{entrants:,} entrants, {seats} in a game, {length} rounds"
        first = schedule.players[::2].astype(np.int64)  # of the two repeats of a game
        met = count_meetings(first, entrants)[np.triu_indices(entrants, 1)]
        seated = np.zeros((entrants, seats), np.int64)
        np.add.at(seated, (schedule.players, np.arange(seats)), 1)
        note = (
            f"{len(schedule.games):,} matches; pairs meet in {met.min()} to {met.max()} games, and"
            f" entrants have a seat in {seated.min()} to {seated.max()} matches"
        )
        figures.append(Figure(name, 1000.0 * seconds, "ms", note))
    publish("Schedules of tournaments (processor time)", figures, json_file)


def _fastest(entrants: int, seats: int, length: int, rounds: int) -> tuple[Schedule, float]:
    """Return a schedule, and the least processor seconds that making it took."""
    durations = []
    for _ in range(rounds):
        pair_up.cache_clear()  # it keeps the games of the last sizes
        start = time.process_time()
        schedule = make_schedule(entrants, seats=seats, rounds=length, seed=1)
        durations.append(time.process_time() - start)
    return schedule, min(durations)


if __name__ == "__main__":
    typer.run(main)
