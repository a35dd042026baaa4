"""The algorithms of RLlib as learners of ``wildscav train``."""

import time
from collections.abc import Mapping
from typing import Any

import torch
from ray.rllib.algorithms.appo import APPOConfig
from ray.rllib.algorithms.impala import IMPALAConfig
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core import DEFAULT_MODULE_ID
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from torch import nn

from wildscav_training.learning.algorithms import Hyperparameters
from wildscav_training.learning.curriculum import Curriculum
from wildscav_training.learning.environment import mean_of
from wildscav_training.learning.learner_rows import LearnerRows, successes
from wildscav_training.learning.rllib_env import ENTRY, share_of
from wildscav_training.learning.settings import TrainingSettings

PATIENCE = 0.1  # s that the learner waits for rollouts; without waiting it would ask all the time
DELAYED = ("rllib-appo", "rllib-impala")  # RLlib gives new weights to those that play an update too late
# What RLlib calls the figures of an update, and what they are called here: the first that there is.
FIGURES = {
    "policy_loss": ("mean_pi_loss", "policy_loss"),
    "value_loss": ("mean_vf_loss", "vf_loss"),
    "entropy": ("entropy",),
    "divergence": ("mean_kl_loss",),
}


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


def figures_of(learned: Mapping[str, Any]) -> dict[str, float]:
    """Return the figures of an update by our names, from what RLlib reports of it."""
    found = {ours: next((name for name in names if name in learned), None) for ours, names in FIGURES.items()}
    return {ours: float(learned[name]) for ours, name in found.items() if name is not None}


def config_of(
    settings: TrainingSettings, shared: TrainingSettings, learners: int, rollout: int, steps: int
) -> Any:
    """Return RLlib's settings of a run.

    Args:
        settings: The run.
        shared: The share of each process that plays, see ``share_of``.
        learners: Of all matches that such a process plays.
        rollout: Steps of all learners between two updates.
        steps: Steps that have been learned from; the learning rate falls over those that are left.
    """
    given = settings.hyperparameters
    config, own = _ALGORITHMS[settings.algorithm](given, rollout)
    config.environment(ENTRY, env_config={"settings": shared}, disable_env_checking=True)
    config.env_runners(
        num_env_runners=settings.workers,
        num_envs_per_env_runner=learners,
        gym_env_vectorize_mode="vector_entry_point",
        rollout_fragment_length=given.rollout,
    )
    config.learners(num_learners=0, num_gpus_per_learner=0)
    config.rl_module(
        model_config=DefaultModelConfig(
            fcnet_hiddens=list(given.layers), fcnet_activation="tanh", vf_share_layers=False
        )
    )
    config.debugging(seed=settings.seed, log_level="ERROR")
    config.reporting(min_time_s_per_iteration=0, min_sample_timesteps_per_iteration=rollout)
    now = given.learning_rate * max(0.0, 1.0 - steps / settings.steps)
    config.training(
        lr=[[0, now], [max(1, settings.steps - steps), 0.0]] if given.anneal else given.learning_rate,
        gamma=given.discount,
        train_batch_size_per_learner=rollout,
        entropy_coeff=given.entropy,
        vf_loss_coeff=given.value,
        grad_clip=given.gradient_norm,
        grad_clip_by="global_norm",
        **own,
    )
    return config


def _ppo(given: Hyperparameters, rollout: int) -> tuple[Any, dict[str, Any]]:
    return PPOConfig(), {
        "lambda_": given.trace,
        "clip_param": given.clip,
        "minibatch_size": min(given.minibatch, rollout),
        "num_epochs": given.epochs,
        "use_kl_loss": given.divergence > 0.0,
        "kl_coeff": given.divergence,
    }


def _appo(given: Hyperparameters, _: int) -> tuple[Any, dict[str, Any]]:
    """Each pass learns from a whole rollout, since parts of it would cut the traces that it corrects.

    Its own buffer of rollouts learns while nobody waits, from what a checkpoint does not hold: a queue of
    one after the other does the same in the open. The target network follows after each rollout.
    """
    return APPOConfig(), {
        "clip_param": given.clip,
        "num_epochs": given.epochs,
        "use_kl_loss": given.divergence > 0.0,
        "kl_coeff": given.divergence,
        "use_circular_buffer": False,
        "target_network_update_freq": 0,
        "timeout_s_sampler_manager": PATIENCE,
    }


def _impala(_: Hyperparameters, __: int) -> tuple[Any, dict[str, Any]]:
    return IMPALAConfig(), {"timeout_s_sampler_manager": PATIENCE}


_ALGORITHMS = {"rllib-ppo": _ppo, "rllib-appo": _appo, "rllib-impala": _impala}
