"""What RLlib's algorithms are told about a run: what they have in common, and what each has alone."""

from collections.abc import Mapping
from typing import Any

from ray.rllib.algorithms.appo import APPOConfig
from ray.rllib.algorithms.impala import IMPALAConfig
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig

from wildscav.training.hyperparameters import Hyperparameters
from wildscav.training.rllib_env import ENTRY
from wildscav.training.settings import TrainingSettings

PATIENCE = 0.1  # s that the learner waits for rollouts; without waiting it would ask all the time
DELAYED = ("rllib-appo", "rllib-impala")  # RLlib gives new weights to those that play an update too late
# What RLlib calls the figures of an update, and what they are called here: the first that there is.
FIGURES = {
    "policy_loss": ("mean_pi_loss", "policy_loss"),
    "value_loss": ("mean_vf_loss", "vf_loss"),
    "entropy": ("entropy",),
    "divergence": ("mean_kl_loss",),
}


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
