"""The algorithms of RLlib as learners of ``wildscav train``."""

import time
from collections.abc import Mapping
from typing import Any

import torch
from ray.rllib.core import DEFAULT_MODULE_ID
from torch import nn

from wildscav.training.curriculum import Curriculum
from wildscav.training.environment import mean_of
from wildscav.training.learner_rows import LearnerRows, successes
from wildscav.training.rllib_config import DELAYED, config_of, figures_of
from wildscav.training.rllib_env import share_of
from wildscav.training.settings import TrainingSettings


class RllibLearner:
    """An algorithm of RLlib in training; see ``ppo.PPO`` for what its parts are for.

    It learns in this process. Matches are played here, too, or by ``settings.workers`` processes of Ray.

    Attributes:
        steps: Steps of all learners so far.
        worker_seconds: Processor time of the processes that play, s.
    """

    def __init__(self, settings: TrainingSettings) -> None:
        """Create a policy that knows nothing; Ray is running.

        Raises:
            UserError: The environment cannot be made, or is not one that the algorithm learns.
        """
        self.settings = settings
        self.curriculum = Curriculum(settings.curriculum)
        self._shared = share_of(settings, settings.workers)
        self._played = LearnerRows(self._shared, self.curriculum.start_range).count  # it also checks options
        self._rollout = self._played * max(1, settings.workers) * settings.hyperparameters.rollout
        self.total = max(1, -(-settings.steps // self._rollout))
        self.steps = self._before = 0  # the latter when this process began
        self.worker_seconds = 0.0
        self._algorithm: Any = None
        self._build()

    def close(self) -> None:
        """Stop RLlib."""
        self._algorithm.stop()

    @property
    def rollouts(self) -> int:
        """Rollouts so far. RLlib plays until it has learned, so an iteration can be more than one."""
        return min(self.steps // self._rollout, self.total)

    @property
    def policy(self) -> Any:
        """The layers of the policy, from rows (N, n) to scores (N, C)."""
        module = self._learner().module[DEFAULT_MODULE_ID]
        parts = (module.encoder.actor_encoder, module.pi)
        linear = [one for part in parts for one in part.modules() if isinstance(one, nn.Linear)]
        layers = [layer for one in linear[:-1] for layer in (one, nn.Tanh())]
        return nn.Sequential(*layers, linear[-1])

    def _learner(self) -> Any:
        """Return RLlib's own learner, which is in this process."""
        return self._algorithm.learner_group.foreach_learner(lambda one: one).result_or_errors[0].get()

    def _build(self) -> None:
        """Create RLlib's algorithm."""
        config = config_of(self.settings, self._shared, self._played, self._rollout, self.steps)
        self._algorithm = config.build_algo()
        self._begin_stage()

    def _on_runners(self, function: Any) -> list[Any]:
        """Call a function with each of RLlib's environment runners, and return the results."""
        group = self._algorithm.env_runner_group
        return list(group.foreach_env_runner(function, local_env_runner=self.settings.workers == 0))

    def _begin_stage(self) -> None:
        start_range, stage = self.curriculum.start_range, self.curriculum.stage

        def begin(runner: Any) -> None:
            torch.set_num_threads(1)
            runner.env.unwrapped.begin(start_range, stage, runner.worker_index)
            runner._needs_initial_reset = True  # noqa: SLF001 - RLlib has no other way

        self._on_runners(begin)

    def iterate(self) -> dict[str, float]:
        """Play a rollout or more, learn from it, and return figures about both by name."""
        started, before = time.process_time() + self.worker_seconds, self.steps
        result = self._algorithm.train()
        reports = self._on_runners(_report)
        ended = [episode for episodes, _ in reports for episode in episodes]
        if self.settings.workers:
            self.worker_seconds = sum(seconds for _, seconds in reports)
        self.steps = self._before + int(result["env_runners"]["num_env_steps_sampled_lifetime"])
        self.curriculum.record(successes(ended))
        learned = result.get("learners", {}).get(DEFAULT_MODULE_ID, {})
        figures = mean_of(ended) | figures_of(learned)
        spent = time.process_time() + self.worker_seconds - started
        figures["steps_per_cpu_second"] = (self.steps - before) / spent
        if self.settings.algorithm in DELAYED:
            self._synchronize()
        if self.curriculum.advance():
            self._begin_stage()
        return {**figures, "stage": float(self.curriculum.stage)}

    def state(self) -> dict[str, Any]:
        """Return what the next iteration learns with: tensors, numbers and lists of them.

        Episodes are not part of it, so a run that continues starts new ones.
        """
        learner = self._learner()
        coefficients = getattr(learner, "curr_kl_coeffs_per_module", None)
        return {
            "module": learner.module[DEFAULT_MODULE_ID].state_dict(),
            "optimizers": [each.state_dict() for _, each in _optimizers(learner)],
            "divergence": None if coefficients is None else float(coefficients[DEFAULT_MODULE_ID]),
            "steps": self.steps,
            "curriculum": self.curriculum.state(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue learning from what ``state`` returned, with new episodes."""
        self.steps = self._before = int(state["steps"])
        self.curriculum.restore(state["curriculum"])
        self._algorithm.stop()
        self._build()
        learner = self._learner()
        learner.module[DEFAULT_MODULE_ID].load_state_dict(state["module"])
        for (_, optimizer), saved in zip(_optimizers(learner), state["optimizers"], strict=True):
            optimizer.load_state_dict(saved)
        if state["divergence"] is not None:
            learner.curr_kl_coeffs_per_module[DEFAULT_MODULE_ID] = torch.tensor(state["divergence"])
        self._synchronize()

    def _synchronize(self) -> None:
        """Give the learner's weights to those that play."""
        algorithm: Any = self._algorithm
        algorithm.env_runner_group.sync_weights(
            from_worker_or_learner_group=algorithm.learner_group, inference_only=True
        )


def _optimizers(learner: Any) -> list[tuple[str, Any]]:
    return list(learner.get_optimizers_for_module(DEFAULT_MODULE_ID))


def _report(runner: Any) -> tuple[list[dict[str, float]], float]:
    """Return the episodes that have ended in a process, and its processor time, s."""
    return runner.env.unwrapped.take_ended(), time.process_time()
