"""A training run from its first step to its score, with checkpoints on the way."""

import time
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from tensorboardX import SummaryWriter

from wildscav_engine.storage.files import part_of
from wildscav_training.learning.checkpoints import RESULT, WEIGHTS, RunFolder, write_json
from wildscav_training.learning.evaluation import WAYS, Score, evaluate
from wildscav_training.learning.ppo import PPO
from wildscav_training.learning.settings import TrainingSettings

EVERY = 60.0  # s between two checkpoints
# Gets figures of an iteration, where a run is `continued`, or how many matches are `measured`.
Report = Callable[[Mapping[str, float]], None]


class Result(NamedTuple):
    """What a run reached, and what it took."""

    seed: int
    steps: int
    cpu_seconds: float  # of training, in all sittings
    wall_seconds: float
    scores: list[Score]

    def as_json(self) -> dict[str, Any]:
        """Return the result as values for JSON."""
        scores = [{**score._asdict(), "metrics": dict(score.metrics)} for score in self.scores]
        return {**self._asdict(), "scores": scores}


def train(settings: TrainingSettings, folder: Path, report: Report, *, resume: bool, episodes: int) -> Result:
    """Train and measure a policy in a folder, which must be new or empty, or raise a UserError.

    With ``resume``, the folder may have a run of the same settings, which continues.
    """
    # More threads only slow networks of this size down, and bits would depend on their number.
    torch.set_num_threads(1)
    place = RunFolder(folder)
    place.begin(settings, resume=resume)
    learner = PPO(settings)
    spent = (0.0, 0.0)
    if place.has_checkpoint:
        spent = _continue(learner, place)
        report({"continued": learner.steps})
    cpu, wall = _learn(learner, place, report, spent)
    _save_layers(folder / WEIGHTS, learner.policy)

    def tell(matches: int) -> None:
        report({"measured": matches, "to_measure": len(WAYS) * episodes})

    tell(0)  # the weights are written
    scores = evaluate(learner.policy, settings, episodes, tell)
    result = Result(settings.seed, learner.steps, round(cpu, 1), round(wall, 1), scores)
    write_json(folder / RESULT, result.as_json())
    return result


def _continue(learner: PPO, place: RunFolder) -> tuple[float, float]:
    """Restore a learner, and return the processor time and the time that were spent on it, s."""
    state = place.load()
    learner.restore(state["learner"])
    place.forget_figures_after(learner.steps)
    cpu, wall = state["spent"]
    return cpu, wall


def _learn(learner: PPO, place: RunFolder, report: Report, spent: tuple[float, float]) -> tuple[float, float]:
    """Iterate to the end; return the processor time and the time spent in all sittings, s."""
    cpu_start, wall_start = time.process_time() - spent[0], time.monotonic() - spent[1]

    def now() -> tuple[float, float]:
        return time.process_time() - cpu_start, time.monotonic() - wall_start

    saved = time.monotonic()
    # Figures after the checkpoint are hidden, since they come again.
    board = SummaryWriter(str(place.path / "tensorboard"), purge_step=learner.steps + 1)
    with closing(board):
        while learner.rollouts < learner.total:
            figures = learner.iterate()
            figures = {"steps": learner.steps, "cpu_seconds": now()[0], **figures}
            place.append_figures(figures)
            for name, value in figures.items():
                board.add_scalar(name, value, learner.steps)
            report(figures)
            is_last = learner.rollouts == learner.total
            if is_last or time.monotonic() - saved > EVERY:
                place.save({"learner": learner.state(), "spent": list(now())})
                saved = time.monotonic()
    return now()


def _save_layers(path: Path, policy: Any) -> None:
    """Write the weights (outputs, inputs) and the biases (outputs,) of a policy's layers."""
    linear = [module for module in policy if isinstance(module, torch.nn.Linear)]
    arrays = {f"weight_{layer}": module.weight.detach().numpy() for layer, module in enumerate(linear)}
    arrays |= {f"bias_{layer}": module.bias.detach().numpy() for layer, module in enumerate(linear)}
    with part_of(path) as part, part.open("wb") as file:
        np.savez(file, **arrays)
