"""PPO and A2C of Stable-Baselines3 as learners of ``wildscav train``."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from stable_baselines3 import A2C, PPO
from torch import nn

from wildscav_engine.envs.stable_baselines import MatchesVecEnv
from wildscav_training.learning.curriculum import Curriculum
from wildscav_training.learning.environment import mean_of
from wildscav_training.learning.learner_rows import LearnerRows, successes
from wildscav_training.learning.settings import TrainingSettings

# What Stable-Baselines3 calls the figures of an update, and what they are called here.
FIGURES = {
    "train/policy_gradient_loss": "policy_loss",
    "train/policy_loss": "policy_loss",
    "train/value_loss": "value_loss",
    "train/approx_kl": "divergence",
}


class StableLearner:
    """A model of Stable-Baselines3 in training; see ``ppo.PPO`` for what its parts are for.

    Attributes:
        steps: Steps of all learners so far.
        policy: From rows (N, n) to scores (N, C).
    """

    def __init__(self, settings: TrainingSettings) -> None:
        """Create the environment and a policy that knows nothing.

        Raises:
            UserError: The environment cannot be made, or is not one that the algorithm learns.
        """
        self.settings, self._given = settings, settings.hyperparameters
        self.curriculum = Curriculum(settings.curriculum)
        self.env = LearnersVecEnv(settings, self.curriculum)
        self.steps = self.rollouts = 0
        self.total = self._given.rollouts(settings.steps, self.env.rows.env.num_agents)
        self.model = self._model()
        self.policy = nn.Sequential(*self.model.policy.mlp_extractor.policy_net, self.model.policy.action_net)

    def _model(self) -> Any:
        given = self._given
        shared: dict[str, Any] = {
            "learning_rate": lambda _: self._rate(),
            "n_steps": given.rollout,
            "gamma": given.discount,
            "gae_lambda": given.trace,
            "ent_coef": given.entropy,
            "vf_coef": given.value,
            "max_grad_norm": given.gradient_norm,
            "policy_kwargs": {"net_arch": {"pi": list(given.layers), "vf": list(given.layers)}},
            "seed": self.settings.seed,
            "device": "cpu",
        }
        if self.settings.algorithm == "a2c":
            return A2C("MlpPolicy", self.env, **shared)
        own = {"batch_size": given.minibatch, "n_epochs": given.epochs, "clip_range": given.clip}
        return PPO("MlpPolicy", self.env, **own, **shared)

    def _rate(self) -> float:
        share_left = 1.0 - self.rollouts / self.total if self._given.anneal else 1.0
        return self._given.learning_rate * max(share_left, 0.0)

    def iterate(self) -> dict[str, float]:
        """Play a rollout, learn from it, and return figures about both by name."""
        started = time.process_time()
        played = self.env.num_envs * self._given.rollout
        # What log_interval=None leaves out is printing. It counts its steps on from those of the last call.
        self.model.learn(played, log_interval=None, reset_num_timesteps=False)
        self.steps, self.rollouts = self.model.num_timesteps, self.rollouts + 1
        figures = mean_of(self.env.take_ended())
        learned = self.model.logger.name_to_value
        figures |= {ours: float(learned[name]) for name, ours in FIGURES.items() if name in learned}
        figures["entropy"] = -float(learned["train/entropy_loss"])
        figures["steps_per_cpu_second"] = played / (time.process_time() - started)
        if self.curriculum.advance():
            self.env.begin()
            self._see(self.env.reset(), np.ones(self.env.num_envs, np.bool_))
        return {**figures, "stage": float(self.curriculum.stage)}

    def _see(self, seen: Any, starts: Any) -> None:
        """Set what the model continues from; it keeps both to itself."""
        self.model._last_obs, self.model._last_episode_starts = seen, starts  # noqa: SLF001

    def state(self) -> dict[str, Any]:
        """Return everything that the next iteration depends on: tensors, numbers and lists of them."""
        _, keys, place, *_ = np.random.get_state()  # noqa: NPY002 - the one that the library draws from
        rows = self.env.rows
        return {
            "parameters": self.model.get_parameters(),
            "random": torch.get_rng_state(),
            "order": [torch.from_numpy(np.asarray(keys, np.int64)), int(place)],
            "counts": [self.steps, self.rollouts, int(self.model._n_updates)],  # noqa: SLF001
            "curriculum": self.curriculum.state(),
            "matches": [torch.frombuffer(bytearray(match), dtype=torch.uint8) for match in rows.state()],
            "seen": torch.from_numpy(self.model._last_obs),  # noqa: SLF001
            "starts": torch.from_numpy(np.asarray(self.model._last_episode_starts)),  # noqa: SLF001
            "returns": torch.from_numpy(rows.returns),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from what ``state`` returned, as if there had been no interruption."""
        self.curriculum.restore(state["curriculum"])
        self.env.begin()
        self.model.set_parameters(state["parameters"])
        self.steps, self.rollouts, updates = map(int, state["counts"])
        self.model.num_timesteps, self.model._n_updates = self.steps, updates  # noqa: SLF001
        matches = [match.numpy().tobytes() for match in state["matches"]]
        self.env.rows.restore(matches, state["returns"].numpy())
        self._see(state["seen"].numpy().copy(), state["starts"].numpy().copy())
        torch.set_rng_state(state["random"])
        keys, place = state["order"]
        np.random.set_state(("MT19937", keys.numpy().astype(np.uint32), place, 0, 0.0))  # noqa: NPY002


class LearnersVecEnv(MatchesVecEnv):
    """The learners of all matches as environments of Stable-Baselines3."""

    def __init__(self, settings: TrainingSettings, curriculum: Curriculum) -> None:
        """Make the environment of the curriculum's present stage."""
        self._settings, self._curriculum = settings, curriculum
        self._ended: list[dict[str, float]] = []
        self.begin()
        env = self.rows.env
        super().__init__(self.rows.count, env.single_observation_space, env.single_action_space)

    def begin(self) -> None:
        """Make the environment anew, for another stage; ``reset`` starts its episodes."""
        self.rows = LearnerRows(self._settings, self._curriculum.start_range)

    def take_ended(self) -> list[dict[str, float]]:
        """Return the return and the metrics of each episode that has ended since the last call."""
        ended, self._ended = self._ended, []
        return ended

    def reset(self) -> Any:
        """Start new episodes."""
        return self.rows.reset(self._curriculum.stage)

    def step_wait(self) -> tuple[Any, Any, Any, list[dict[str, Any]]]:
        """Play one step. Where an episode ends, the next begins, and infos have the last observation."""
        outcome = self.rows.step(self._actions)
        self._ended += outcome.ended
        self._curriculum.record(successes(outcome.ended))
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        done = outcome.terminated | outcome.truncated
        for row in np.flatnonzero(done).tolist():
            infos[row] = {
                "terminal_observation": outcome.last[row],  # type: ignore[index] # a match has ended
                "TimeLimit.truncated": bool(outcome.truncated[row] and not outcome.terminated[row]),
            }
        return outcome.seen, outcome.rewards, done, infos

    def close(self) -> None:
        """Do nothing: there is nothing to close."""

    def seed(self, seed: int | None = None) -> Sequence[int | None]:  # noqa: ARG002
        """Do nothing: the seed of the run decides about episodes."""
        return [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, once for each row."""
        return [getattr(self.rows.env, attr_name, None)] * len(list(self._get_indices(indices)))

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **options: Any) -> list[Any]:
        """Refuse, because rows have no methods of their own.

        Raises:
            NotImplementedError: Always.
        """
        raise NotImplementedError(f"{method_name} cannot be called")
