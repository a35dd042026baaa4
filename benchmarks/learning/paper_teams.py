"""The paper's experiments with teams on map 101: four agents gather supplies, or search for a hidden target.

    python -m benchmarks.learning.paper_teams --seeds 0,1,2

trains and measures what is not yet in the folder of results, and prints the tables of all runs there,
beside the paper's figures and agents without training. With ``--seeds ''`` it trains nothing.

An episode of gathering has 600 steps of 15 frames (3 minutes), and one of capture at most 400.
"""

import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import torch
import typer
from benchmarks.learning.paper import EPISODES, FRAMES, POINT_EPISODES, RESULTS, play_out, trained
from benchmarks.learning.paper_table import team_table
from benchmarks.learning.result_files import add, numbers
from numpy.typing import NDArray

from wildscav_engine.envs import SeatController
from wildscav_engine.envs.batched import BatchedArena
from wildscav_engine.simulation.batch import Batch
from wildscav_training.learning.environment import make_env, sizes_of
from wildscav_training.learning.evaluation import FIRST
from wildscav_training.learning.ppo import Choices, in_space, rows_of
from wildscav_training.learning.settings import TrainingSettings, preset_settings
from wildscav_training.opponents import Oracle, submission

TEAMS = RESULTS.parent / "paper-teams"
MAP, AGENTS = 101, 4
TIME_LIMITS = {"gathering": 180.0, "capture": 120.0}  # s
STEPS = {"gathering": 600_000, "capture": 400_000}  # of training, of all agents together
OF_CURVE = {"gathering": "boxes", "capture": "success"}
# Agents without training: how many frames each of their steps lasts, and in how many episodes they play.
OTHERS: dict[str, dict[str, tuple[int, int]]] = {
    "gathering": {"homing": (5, 40), "scavenger": (5, 40)},
    "capture": {"homing": (5, 200), "oracle": (1, 200)},
}


def settings_of(task: str, seed: int) -> TrainingSettings:
    """Return the run of a task: the preset "tuned" with the paper's episodes."""
    options = {"map": MAP, "time_limit": TIME_LIMITS[task], "frames_per_action": FRAMES}
    hyperparameters, options = preset_settings("tuned", task, options)
    return TrainingSettings(task, options, STEPS[task], seed, hyperparameters)


def numbers_of(batch: Batch, match: int, boxes: int) -> dict[str, int]:
    """Return what a team achieved in a match that has ended, and that had so many boxes at its start."""
    state = batch.state
    return {
        "boxes": int(boxes) - int(np.count_nonzero(state.supplies.quantity[match])),
        "supplies": int(state.agents.picked_up[match].sum()),
        "success": int(state.agents.reached[match].any()),
        "length": int(np.ceil(state.matches.frame[match] / FRAMES)),
    }


def boxes_of(batch: Batch) -> NDArray[np.int64]:
    """Return (B,) the number of boxes in each match now."""
    return np.count_nonzero(batch.state.supplies.quantity, axis=1)


def test_env(settings: TrainingSettings, episodes: int) -> BatchedArena:
    """Return test episodes, which stay as they are when they have ended until the next step."""
    env = make_env(settings, episodes, None, autoreset_mode="NextStep", split="test")
    env.reset(seed=FIRST)
    return env


@torch.no_grad()  # type: ignore[untyped-decorator]
def played(policy: Any, settings: TrainingSettings, episodes: int, choose: str) -> dict[str, list[int]]:
    """Let a policy play test episodes with all agents of the team; return the numbers (E,) by name."""
    env = test_env(settings, episodes)
    choices, random = Choices(sizes_of(env)), torch.Generator().manual_seed(0)
    batch: Any = env.arena.batch
    boxes = boxes_of(batch)
    seen = rows_of(env.arena.read().observation)
    found: dict[int, dict[str, int]] = {}
    while len(found) < episodes:
        scores = policy(seen)
        action = choices.best(scores) if choose == "deterministic" else choices.draw(scores, random)
        outcome = env.step(in_space(action, env))
        seen = rows_of(outcome.observation)
        for match in outcome.ended:
            found.setdefault(match, numbers_of(batch, match, boxes[match]))
    return joined([found[match] for match in range(episodes)])


def agents_played(
    agent: SeatController, settings: TrainingSettings, frames: int, episodes: int
) -> dict[str, list[int]]:
    """Let an agent, whose own steps have some frames, play test episodes in all seats of the team."""
    made: Any = test_env(settings, episodes).arena.batch
    boxes = boxes_of(made)
    batch = play_out(agent, made, frames)
    return joined([numbers_of(batch, match, boxes[match]) for match in range(episodes)])


def joined(episodes: list[dict[str, int]]) -> dict[str, list[int]]:
    """Return the numbers of episodes as lists by name."""
    return {name: [episode[name] for episode in episodes] for name in episodes[0]}


def untrained(settings: TrainingSettings) -> dict[str, Any]:
    """Play the test episodes with agents that were not trained."""
    choices = sum(sizes_of(make_env(settings, 1, None)))
    scores = {"random": played(lambda rows: torch.zeros(len(rows), choices), settings, EPISODES, "sampled")}
    for name, (frames, episodes) in OTHERS[settings.track].items():
        agent = Oracle() if name == "oracle" else submission(name)
        scores[name] = agents_played(agent, settings, frames, episodes)
    return {"task": settings.track, "scores": scores}


def trained_team(settings: TrainingSettings) -> dict[str, Any]:
    """Train the policy of a team and measure it."""
    task = settings.track
    return {"task": task} | trained(settings, played, OF_CURVE[task], (POINT_EPISODES, EPISODES))


def main(
    tasks: Annotated[str, typer.Option(help="gathering, capture or both.")] = "gathering,capture",
    seeds: Annotated[str, typer.Option(help="Seeds of the runs.")] = "0",
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = TEAMS,
) -> None:
    """Train what is missing, and print the tables."""
    torch.set_num_threads(1)
    for task in tasks.split(","):
        made = [(out / f"{task}-seed-{seed}.json", trained_team, seed) for seed in numbers(seeds)]
        for path, measure, seed in [*made, (out / f"{task}-untrained.json", untrained, 0)]:
            add(path, partial(measure, settings_of(task, seed)))
    sys.stdout.write(team_table(out))


if __name__ == "__main__":
    typer.run(main)
