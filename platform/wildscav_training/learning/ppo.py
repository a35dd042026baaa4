"""Proximal policy optimization in one file, on a batch of matches: read it from top to bottom.

Schulman et al., "Proximal Policy Optimization Algorithms", 2017. A learner is one row of numbers in and one
choice per dimension of the action space out. T is the length of a rollout, N the number of learners in all
matches, D the number of dimensions and C the number of all their choices.
"""

import time
from collections.abc import Mapping, Sequence
from copy import deepcopy
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from wildscav_engine.envs.batched import BatchedArena, Outcome
from wildscav_engine.envs.curriculum import SharedCurriculum
from wildscav_training.learning.environment import APART, ROOM, make_env, mean_of, sizes_of
from wildscav_training.learning.self_play import SelfPlay
from wildscav_training.learning.settings import TrainingSettings
from wildscav_training.learning.start import put_layers

DIVERGENCE = 0.01  # of a policy from the one before, wished for where its weight is not 0
VALUE_FIRST = 10  # rollouts in which only the value learns, if the policy starts from another one ...
MOST_FIRST = 4  # ... but at most one in so many of the run


class Rollout(NamedTuple):
    """What was played between two updates."""

    observation: Tensor  # (T, N, n)
    action: Tensor  # (T, N, D) int64
    scores: Tensor  # (T, N, C) by which the actions were drawn
    value: Tensor  # (T, N) as predicted
    reward: Tensor  # (T, N)
    ended: Tensor  # (T, N) 1 where the step ended the episode
    active: Tensor  # (T, N) whether the learner still played; one may leave a match before the others


# --- The networks ---------------------------------------------------------------------------------------


def make_network(inputs: int, hidden: Sequence[int], outputs: int, gain: float) -> Any:
    """Return fully connected layers with tanh between them.

    The gain scales the last layer's first weights: with a small one, a policy first tries everything.
    """
    widths = [inputs, *hidden, outputs]
    modules: list[Any] = []
    for layer, (before, after) in enumerate(pairwise(widths)):
        linear = nn.Linear(before, after)
        is_last = layer == len(hidden)
        nn.init.orthogonal_(linear.weight, gain if is_last else 2.0**0.5)
        nn.init.zeros_(linear.bias)
        modules += [linear] if is_last else [linear, nn.Tanh()]
    return nn.Sequential(*modules)


# --- The distribution of actions: one choice in each dimension ------------------------------------------


class Choices:
    """The choices of an action space, by their scores (logits)."""

    def __init__(self, sizes: Sequence[int]) -> None:
        """Create it for the number of choices in each dimension, (D,)."""
        self.sizes = list(sizes)
        self._first = torch.tensor([0, *self.sizes[:-1]]).cumsum(0)  # (D,) the first choice of each dimension

    def log_probabilities(self, scores: Tensor) -> Tensor:
        """Return (…, C) the logarithms of the probabilities of all choices."""
        return torch.cat([torch.log_softmax(part, -1) for part in scores.split(self.sizes, -1)], -1)

    def log_probability(self, logarithms: Tensor, action: Tensor) -> Tensor:
        """Return (…) that of actions (…, D), given those of all choices."""
        return logarithms.gather(-1, action + self._first).sum(-1)

    def draw(self, scores: Tensor, random: torch.Generator) -> Tensor:
        """Return (…, D) actions drawn with their probabilities: Gumbel noise makes the maximum a sample."""
        noise = -torch.log(-torch.log(torch.rand(scores.shape, generator=random).clamp(1e-20, 1.0 - 1e-7)))
        return self.best(scores + noise)

    def best(self, scores: Tensor) -> Tensor:
        """Return (…, D) the likeliest actions."""
        return torch.stack([part.argmax(-1) for part in scores.split(self.sizes, -1)], -1)


def entropy_of(logarithms: Tensor) -> Tensor:
    """Return (…) the entropy of the distribution."""
    return -(logarithms.exp() * logarithms).sum(-1)


def divergence_of(before: Tensor, now: Tensor) -> Tensor:
    """Return (…) the Kullback-Leibler divergence of a distribution from the one before."""
    return (before.exp() * (before - now)).sum(-1)


# --- Advantages -----------------------------------------------------------------------------------------


def advantages(played: Rollout, next_value: Tensor, gamma: float, gae_lambda: float) -> Tensor:
    """Return (T, N) how much better each action was than expected: generalized advantage estimation.

    Schulman et al., "High-Dimensional Continuous Control Using Generalized Advantage Estimation", 2016.

    Args:
        next_value: (N,) the value of the observation after its last step.
        gamma: Of the reward one step later.
        gae_lambda: From 0 (the value after one step is believed) to 1 (only rewards are).
    """
    result = torch.zeros_like(played.reward)
    later = torch.zeros_like(next_value)
    for step in reversed(range(len(played.reward))):
        goes_on = 1.0 - played.ended[step]
        surprise = played.reward[step] + gamma * next_value * goes_on - played.value[step]
        later = surprise + gamma * gae_lambda * goes_on * later
        result[step], next_value = later, played.value[step]
    return result


# --- The algorithm --------------------------------------------------------------------------------------


class PPO:
    """A learner in training. ``iterate`` plays a rollout and learns from it.

    Attributes:
        steps: Steps of all learners so far.
        policy, value: The networks.
        curriculum: The stages of the run.
        opponents: Who plays against it, copies of itself among them.
    """

    def __init__(self, settings: TrainingSettings) -> None:
        """Create the environment and a policy that knows nothing.

        Raises:
            UserError: The environment cannot be made, or has actions or observations of another kind.
        """
        self.settings, self._given = settings, settings.hyperparameters
        self.curriculum = SharedCurriculum(len(settings.curriculum) + 1, self._given.matches)
        self.opponents = SelfPlay(settings.opposition, settings.seed)
        self._make_env()
        self.choices = Choices(sizes_of(self.env))
        torch.manual_seed(settings.seed)
        self._random = torch.Generator().manual_seed(settings.seed)
        inputs, hidden = int(self.env.single_observation_space.shape[0]), self._given.layers  # type: ignore[index]
        self.policy = make_network(inputs, hidden, sum(self.choices.sizes), gain=0.01)
        self.value = make_network(inputs, hidden, 1, gain=1.0)
        if settings.start is not None:
            put_layers(settings.start.layers(), self.policy)
        self.opponents.begin(self.policy, self.choices.draw, self.env.single_action_space.shape or ())
        self._weights = [*self.policy.parameters(), *self.value.parameters()]
        self._adam = torch.optim.Adam(self._weights, lr=self._given.learning_rate, eps=1e-5, fused=True)
        self._divergence = self._given.kl_coeff
        self.steps = self.rollouts = 0
        self.total = self._given.rollouts(settings.steps, self.env.num_agents)
        self._begin_stage()

    def iterate(self) -> dict[str, float]:
        """Play a rollout, learn from it, and return figures about both by name."""
        started = time.process_time()
        played, next_value, figures = self._play()
        share_left = 1.0 - self.rollouts / self.total if self._given.anneal else 1.0
        self._adam.param_groups[0]["lr"] = self._given.learning_rate * max(share_left, 0.0)
        figures |= self._learn(played, next_value)
        self.rollouts += 1
        figures["steps_per_cpu_second"] = len(played.reward.reshape(-1)) / (time.process_time() - started)
        figures |= self.opponents.after_rollout(self.rollouts, self.total, self.policy)
        if self.curriculum.advance():
            self._make_env()
            self._begin_stage()
        return {**figures, "stage": float(self.curriculum.stage)}

    def _make_env(self) -> None:
        start_range = (*self.settings.curriculum, None)[self.curriculum.stage]
        self.env = make_env(self.settings, self._given.matches, start_range, **self.opponents.options)

    def _begin_stage(self, part: int = 0) -> None:
        first = self.settings.seed * APART + self.curriculum.stage * ROOM + part
        self._seen = rows_of(self.env.reset(seed=first))
        self._returns = np.zeros(len(self._seen))  # (N,) of the episodes that are being played

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def _play(self) -> tuple[Rollout, Tensor, dict[str, float]]:
        """Play a rollout; return it, the value (N,) of what follows, and figures about its episodes."""
        parts: list[tuple[Tensor, ...]] = []
        ended: list[Mapping[str, float]] = []
        for _ in range(self._given.rollout):
            active = torch.from_numpy(~self.env.arena.done.reshape(-1))
            scores = self.policy(self._seen)
            action, value = self.choices.draw(scores, self._random), self.value(self._seen).squeeze(-1)
            outcome = self.env.step(in_space(action, self.env))
            reward, over = self._rewards(outcome, active)
            parts.append((self._seen, action, scores, value, reward, over, active))
            self._seen = rows_of(outcome.observation)
            ended += self._count(outcome, active)
        self.steps += sum(int(part[-1].sum()) for part in parts)
        next_value = self.value(self._seen).squeeze(-1)
        return Rollout(*map(torch.stack, zip(*parts, strict=True))), next_value, mean_of(ended)

    def _rewards(self, outcome: Outcome, active: Tensor) -> tuple[Tensor, Tensor]:
        """Return (N,) the rewards of a step, and (N,) where it ended an episode.

        Time being up is no fault of the learner: the value of what would have followed is added.
        """
        reward = torch.from_numpy(outcome.rewards.astype(np.float32).reshape(-1)) * active
        truncated = (outcome.truncated & ~outcome.terminated).reshape(-1)
        if truncated.any() and outcome.final is not None:
            follows = self.value(rows_of(outcome.final.observation)[truncated]).squeeze(-1)
            reward[torch.from_numpy(truncated)] += self._given.gamma * follows
        over = (outcome.terminated | outcome.truncated).reshape(-1)
        return reward, torch.from_numpy(over.astype(np.float32))

    def _count(self, outcome: Outcome, active: Tensor) -> list[Mapping[str, float]]:
        """Add up rewards, and return the return and the metrics of each learner whose match has ended."""
        self._returns += outcome.rewards.reshape(-1) * active.numpy()
        ended = list(outcome.ended)
        if not ended:
            return []
        by_match = self._returns.reshape(self.env.num_matches, -1)
        returns, by_match[ended] = by_match[ended].reshape(-1), 0.0
        names = self.env.arena.metrics
        rows = outcome.metrics.reshape(len(returns), len(names))
        if "success" in names:
            by_learner = outcome.metrics[:, :, names.index("success")]  # who may share a success
            self.curriculum.record_rows(ended, by_learner.mean(axis=1).tolist())
        return [
            {"return": float(total), **dict(zip(names, row, strict=True))}
            for total, row in zip(returns, rows.tolist(), strict=True)
        ]

    def _learn(self, played: Rollout, next_value: Tensor) -> dict[str, float]:
        """Learn from a rollout in several epochs of minibatches, and return the mean losses."""
        gains = advantages(played, next_value, self._given.gamma, self._given.gae_lambda)
        chosen = torch.nonzero(played.active.reshape(-1)).squeeze(-1)
        flat = Rollout(*(part.flatten(0, 1)[chosen] for part in played))
        gain, wanted = gains.reshape(-1)[chosen], (gains + played.value).reshape(-1)[chosen]
        before = self.choices.log_probabilities(flat.scores)
        likely = self.choices.log_probability(before, flat.action)
        fixed = (flat.observation, flat.action, likely, before, gain, wanted)
        figures: list[dict[str, float]] = []
        for _ in range(self._given.epochs):
            order = torch.randperm(len(gain), generator=self._random)
            shuffled = [part[order].split(self._given.minibatch) for part in fixed]
            for minibatch in zip(*shuffled, strict=True):
                loss, figure = self._loss(*minibatch)
                self._adam.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(self._weights, self._given.gradient_norm)
                self._adam.step()
                figures.append(figure)
        means = mean_of(figures[-len(figures) // self._given.epochs :])  # of the last epoch
        self._adapt(means["divergence"])
        return means

    def _loss(
        self, seen: Tensor, action: Tensor, likely: Tensor, before: Tensor, gain: Tensor, wanted: Tensor
    ) -> tuple[Tensor, dict[str, float]]:
        """Return the loss of a minibatch, and its parts by name.

        Args:
            seen: (M, n) observations.
            action: (M, D).
            likely: (M,) logarithm of their probabilities when they were drawn.
            before: (M, C) logarithms of all probabilities then.
            gain: (M,) advantages.
            wanted: (M,) what the values should have been.
        """
        now = self.choices.log_probabilities(self.policy(seen))
        ratio = (self.choices.log_probability(now, action) - likely).exp()
        gain = (gain - gain.mean()) / (gain.std(correction=0) + 1e-8)
        bounded = ratio.clamp(1.0 - self._given.clip, 1.0 + self._given.clip)
        policy = -torch.minimum(ratio * gain, bounded * gain).mean()
        value = (self.value(seen).squeeze(-1) - wanted).square().mean()
        entropy, divergence = entropy_of(now).mean(), self._divergence_from(before, now)
        loss = self._given.value * value
        if not self._is_policy_kept:
            loss = loss + policy - self._given.entropy * entropy + self._divergence * divergence
        figures = {"policy_loss": policy, "value_loss": value, "entropy": entropy, "divergence": divergence}
        return loss, {name: float(figure.detach()) for name, figure in figures.items()}

    def _divergence_from(self, before: Tensor, now: Tensor) -> Tensor:
        """Return the mean divergence; without a weight, it is only a figure and needs no gradient."""
        with torch.set_grad_enabled(self._divergence > 0.0):
            return divergence_of(before, now).mean()

    @property
    def _is_policy_kept(self) -> bool:
        """Whether only the value learns: judged by a value that knows nothing, a good policy gets worse."""
        return self.settings.start is not None and self.rollouts < min(VALUE_FIRST, self.total // MOST_FIRST)

    def _adapt(self, divergence: float) -> None:
        """Weight the divergence more where it was large, and less where it was small; 0 stays 0."""
        if divergence > 2.0 * DIVERGENCE:
            self._divergence *= 1.5
        elif divergence < 0.5 * DIVERGENCE:
            self._divergence *= 0.5

    # --- Checkpoints and weights ------------------------------------------------------------------------

    def state(self) -> dict[str, Any]:
        """Return everything that the next iteration depends on: tensors, numbers and lists of them."""
        rows = () if self.opponents.has_memory else range(self.env.num_matches)
        matches = [self.env.get_state(row) for row in rows]
        return {
            "policy": self.policy.state_dict(),
            "value": self.value.state_dict(),
            "adam": self._adam.state_dict(),
            "random": self._random.get_state(),
            "divergence": self._divergence,
            "counts": [self.steps, self.rollouts],
            "curriculum": self.curriculum.state(),
            "opponents": self.opponents.state(),
            "matches": [torch.frombuffer(bytearray(match), dtype=torch.uint8) for match in matches],
            "seen": self._seen,
            "returns": torch.from_numpy(self._returns),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from what ``state`` returned, as if there had been no interruption."""
        state = deepcopy(state)  # Adam would share tensors with it
        self.policy.load_state_dict(state["policy"])
        self.value.load_state_dict(state["value"])
        self._adam.load_state_dict(state["adam"])
        self._random.set_state(state["random"])
        self._divergence = float(state["divergence"])
        self.steps, self.rollouts = map(int, state["counts"])
        self.curriculum.restore(state["curriculum"])
        self.opponents.restore(state["opponents"], self.policy)
        self._make_env()
        if not state["matches"]:  # opponents with a memory: the matches begin anew, and are other ones
            return self._begin_stage(self.rollouts * self.env.num_matches % ROOM)
        for row, match in enumerate(state["matches"]):
            self.env.set_state(row, match.numpy().tobytes())
        self.env.arena.opponents.count_all()
        # A reading after set_state has no events, so the observation itself is in the state, too.
        self._seen, self._returns = state["seen"], state["returns"].numpy().copy()
        return None


# --- From and to the environment ---------------------------------------------------------------------------


def rows_of(observation: Any) -> Tensor:
    """Return the observations (B, L, n) of all learners as (N, n).

    It is a copy in PyTorch's own memory: the bits of a product depend on how its factors are aligned.
    """
    return torch.tensor(observation.reshape(-1, observation.shape[-1]))


def in_space(action: Tensor, env: BatchedArena) -> NDArray[np.int64]:
    """Return actions (N, D) as the environment takes them: (B, L, …)."""
    shape = (env.num_matches, env.num_agents, *(env.single_action_space.shape or ()))
    return np.asarray(action.numpy().reshape(shape))
