"""The paper's experiment with a single agent in navigation: training on each of its six maps, and the table.

    python -m benchmarks.learning.paper --maps 103,104 --seeds 0,1,2

trains and measures what is not yet in the folder of results, one run after the other, and prints the table of
all runs there, beside the paper's figures and agents without training. More seeds add to what is there. With
``--maps ''`` it only prints the table. The results of a run are written when it has ended; an interrupted one
begins anew. ``wildscav train`` with the options of ``settings_of`` gives the same weights.

An episode has at most 400 steps of 15 frames. Starts and targets are anywhere on the map.
"""

import statistics
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import torch
import typer
from benchmarks.learning.paper_table import draw, table
from benchmarks.learning.result_files import add, numbers
from benchmarks.report import machine
from numpy.typing import NDArray

from wildscav_engine.envs import SeatController
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.rules import FRAME
from wildscav_training.learning.environment import make_env, sizes_of
from wildscav_training.learning.evaluation import FIRST, play_episodes
from wildscav_training.learning.ppo import PPO
from wildscav_training.learning.settings import TrainingSettings, preset_settings
from wildscav_training.opponents import Oracle, submission

RESULTS = Path(__file__).parent / "results" / "paper"
FRAMES, TIME_LIMIT = 15, 120.0  # of a step; s, 400 steps
STEPS = {103: 200_000, 104: 200_000, 101: 150_000, 102: 150_000, 14: 300_000, 8: 300_000}  # of training
EPISODES = 200  # of each score
POINT_EPISODES = 50  # of each point
EARLY, POINTS = (0, 1, 2, 3), 6  # of a learning curve: after so many rollouts, and so many evenly
WAYS = ("sampled", "deterministic")

# From a policy, its run, a number of episodes and the way to choose actions to the episodes' numbers by name.
Play = Callable[[Any, TrainingSettings, int, str], Mapping[str, Sequence[float]]]


class Episodes(NamedTuple):
    """Episodes of one agent on one map."""

    success: list[int]  # (E,) 1 where the target was reached
    length: list[int]  # (E,) steps of 15 frames


def settings_of(map_number: int, seed: int) -> TrainingSettings:
    """Return the run of a map: the preset "tuned" with the paper's episodes."""
    options = {"map": map_number, "time_limit": TIME_LIMIT, "frames_per_action": FRAMES}
    hyperparameters, options = preset_settings("tuned", "navigation", options)
    return TrainingSettings("navigation", options, STEPS[map_number], seed, hyperparameters)


def played(policy: Any, settings: TrainingSettings, episodes: int, choose: str) -> Episodes:
    """Let a policy play test episodes."""
    names, metrics = play_episodes(policy, settings, episodes, "test", choose)
    return episodes_of(metrics[:, names.index("success")], metrics[:, names.index("used_time")])


def episodes_of(success: NDArray[Any], seconds: NDArray[Any]) -> Episodes:
    """Return episodes by their successes and times (E,)."""
    length = np.ceil(seconds / (FRAMES * FRAME) - 1e-6)
    return Episodes(success.astype(int).tolist(), length.astype(int).tolist())


def played_numbers(policy: Any, settings: TrainingSettings, episodes: int, choose: str) -> dict[str, Any]:
    """Return the numbers of test episodes by name."""
    return played(policy, settings, episodes, choose)._asdict()


def untrained(settings: TrainingSettings) -> dict[str, Any]:
    """Play the test episodes with agents that were not trained."""
    choices = sum(sizes_of(make_env(settings, 1, None)))
    chance = played(lambda rows: torch.zeros(len(rows), choices), settings, EPISODES, "sampled")
    found = {
        "random": chance,
        "homing": agent_played(submission("homing"), settings, 5),
        "oracle": agent_played(Oracle(), settings, 1),  # it stops at every corner, so its steps are short
    }
    return {"map": settings.options["map"], "scores": {name: one._asdict() for name, one in found.items()}}


def agent_played(agent: SeatController, settings: TrainingSettings, frames: int) -> Episodes:
    """Let an agent, whose own steps have some frames, play the test episodes of a run."""
    env = make_env(settings, EPISODES, None, split="test")
    env.reset(seed=FIRST)
    batch = play_out(agent, env.arena.batch, frames)
    return episodes_of(batch.state.agents.reached[:, 0], batch.state.matches.frame * FRAME)


def play_out(agent: SeatController, made: Any, frames: int) -> Batch:
    """Let an agent, whose own steps have some frames, play all seats of copies of matches; return these."""
    batch = Batch([spec.model_copy(update={"frames_per_action": frames}) for spec in made.specs], made.maps)
    count, per_match = len(made.specs), len(made.specs[0].seats)
    matches, seats = np.divmod(np.arange(count * per_match), per_match)
    agent.begin(batch, matches, seats)
    rows = np.zeros((count, per_match, FIELDS), np.float32)
    while not batch.state.matches.over.all():
        going = ~batch.state.matches.over[matches]
        rows[matches[going], seats[going]] = agent.act(batch, matches[going], seats[going])
        batch.step(rows)
    return batch


def trained(
    settings: TrainingSettings, play: Play, of_curve: str, episodes: tuple[int, int]
) -> dict[str, Any]:
    """Train a policy and measure it; return what JSON can store.

    The curve has the means of one number by its name. There are so many episodes of each of its points, and
    of each score at the end.
    """

    def point() -> tuple[int, float]:
        found = play(learner.policy, settings, episodes[0], "sampled")
        return learner.steps, statistics.fmean(found[of_curve])

    learner = PPO(settings)
    cpu = wall = 0.0
    points = {*EARLY, *(-(-learner.total * place // POINTS) for place in range(1, POINTS + 1))}
    curve = [point()]
    while learner.rollouts < learner.total:
        cpu_start, wall_start = time.process_time(), time.monotonic()
        learner.iterate()
        cpu, wall = cpu + time.process_time() - cpu_start, wall + time.monotonic() - wall_start
        if learner.rollouts in points:
            curve.append(point())
    return {
        "map": settings.options.get("map"),
        "seed": settings.seed,
        "steps": learner.steps,
        "cpu_seconds": round(cpu, 1),
        "wall_seconds": round(wall, 1),
        "machine": {key: value for key, value in machine().items() if key in {"processor", "cores"}},
        "curve": curve,
        "scores": {way: dict(play(learner.policy, settings, episodes[1], way)) for way in WAYS},
    }


def main(
    maps: Annotated[str, typer.Option(help="Numbers of the paper's maps.")] = ",".join(map(str, STEPS)),
    seeds: Annotated[str, typer.Option(help="Seeds of the runs.")] = "0",
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = RESULTS,
    picture: Annotated[Path | None, typer.Option(help="File for the learning curves.")] = None,
) -> None:
    """Train what is missing, and print the table."""
    torch.set_num_threads(1)
    for seed in numbers(seeds):
        for number in numbers(maps):
            run = (settings_of(number, seed), played_numbers, "success", (POINT_EPISODES, EPISODES))
            add(out / f"{number:03}-seed-{seed}.json", partial(trained, *run))
    for number in numbers(maps):
        add(out / f"{number:03}-untrained.json", partial(untrained, settings_of(number, 0)))
    sys.stdout.write(table(out))
    if picture is not None:
        draw(out, picture)


if __name__ == "__main__":
    typer.run(main)
