"""How often identical submissions are told apart on a ladder, and how often the truly best one is first."""

from typing import Annotated

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish
from tests.leaderboard.boards.simulated_ladders import ROBOTS, board_of, is_lottery, play_ladder

from wildscav_leaderboard.boards.documents import LadderBoard
from wildscav_leaderboard.boards.ladder_board import Enough

TWINS = {f"twin{number}": 1.0 for number in range(10)}
TEAMS = {f"team{number}": 2.0 - 0.3 * number for number in range(10)}  # each 52 points above the next
RULES = ((Enough(200.0, 100), 4), (Enough(300.0, 100), 4), (Enough(150.0, 200), 4), (Enough(200.0, 200), 2))


def main(
    seasons: Annotated[int, typer.Option(help="Simulated seasons of each kind.")] = 300,
    json_file: JsonFile = None,
) -> None:
    """Print what the boards of simulated seasons say about twins, and about teams of known strength."""
    figures = []
    for enough, seats in RULES:
        name = f"interval {enough.interval:.0f}, {seats} seats"
        twins = _boards(TWINS, seasons, enough, seats)
        spread = [np.ptp([row.rating for row in board.rows if row.team]) for board in twins]
        matches = [row.matches for board in twins for row in board.rows if row.team]
        apart = 100.0 * np.mean([is_lottery(board, list(TWINS)) for board in twins])
        figures += [
            Figure(f"{name}: seasons in which twins are told apart (5 % are promised)", apart, "%"),
            Figure(f"{name}: from the first to the last twin", float(np.mean(spread)), "points"),
            Figure(f"{name}: matches of a twin", float(np.mean(matches)), "matches"),
        ]
        best = [board.rows[0].team == "team0" for board in _boards(TEAMS, seasons, enough, seats)]
        figures.append(Figure(f"{name}: the best of ten teams leads", 100.0 * np.mean(best), "%"))
    publish(f"Ladders: who is told apart in {seasons} simulated seasons", figures, json_file)


def _boards(strengths: dict[str, float], seasons: int, enough: Enough, seats: int) -> list[LadderBoard]:
    field = strengths | ROBOTS
    return [board_of(field, play_ladder(field, seed, enough, seats=seats), enough) for seed in range(seasons)]


if __name__ == "__main__":
    typer.run(main)
