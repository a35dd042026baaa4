"""Self-play: copies of the policy from earlier in its training, beside robots and submissions, as opponents.

A league draws who fills each opponent's seat in the next episode, the more often the less the learner wins
against it (prioritized fictitious self-play, ``wildscav_engine.envs.league``). Everything that the draws
depend on is in the state, so that a run continues from it bit for bit.
"""

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from wildscav_engine.envs import League
from wildscav_engine.envs.league.table import LeagueTable
from wildscav_training.learning.opposition import Opposition
from wildscav_training.opponents import submission

COPIES = 20  # of the policy that join the league in a run, evenly over its rollouts, at most one after each
LATEST = 0.5  # share of the seats of copies that go to the newest
READY = 0.7  # win rate against a robot from which on the next level joins
GAMES = 50  # against a robot before that
APART = 2**20  # between the seeds of the copies of two runs

Draw = Callable[[Tensor, torch.Generator], Tensor]  # from scores (N, C) to actions (N, D)


class Copy:
    """A copy of the policy that learns no more. Its random numbers are its own.

    Attributes:
        network: From rows (N, n) to scores (N, C).
        random: What its actions are drawn with.
    """

    def __init__(self, network: Any, draw: Draw, shape: Sequence[int], seed: int) -> None:
        """Copy a policy."""
        self.network = deepcopy(network).requires_grad_(requires_grad=False)
        self.random = torch.Generator().manual_seed(seed)
        self._draw, self._shape = draw, tuple(shape)

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def __call__(self, observations: NDArray[np.float32]) -> NDArray[np.int64]:
        """Return the actions (N, …) of N seats by their observations (N, n)."""
        scores = self.network(torch.tensor(observations))
        return np.asarray(self._draw(scores, self.random).numpy().reshape(-1, *self._shape))


class SelfPlay:
    """The opponents of a run: who they are now, and who joins them."""

    def __init__(self, opposition: Opposition | None, seed: int) -> None:
        """Create the league of a run; without opposition, the environment's own opponents play.

        Raises:
            UserError: A submission cannot be loaded.
        """
        self._given, self._seed = opposition, seed
        self.league = League()
        if opposition is None:
            return
        self._submissions = {player.name: player for player in map(submission, opposition.submissions)}
        robots = [levels[0] for levels in opposition.robots]
        self.league = League(robots=robots, **_shares(opposition))
        for name, player in self._submissions.items():
            self.league.add(player, name)

    @property
    def options(self) -> dict[str, Any]:
        """The options of the environment that seat the opponents."""
        return {} if self._given is None else {"opponents": (self.league,) * self._given.seats}

    @property
    def has_memory(self) -> bool:
        """Whether an opponent has a memory of its own, which cannot be saved."""
        return self._given is not None and bool(self._given.submissions)

    def begin(self, policy: Any, draw: Draw, shape: Sequence[int]) -> None:
        """Take the policy in before it has learned anything; see ``Copy`` for the arguments."""
        self._draw, self._shape = draw, shape
        if self._given is not None and self._given.plays_itself:
            self._join(policy)

    def _join(self, policy: Any) -> None:
        number = sum(name not in self._submissions for name in self.league.sources)
        self.league.add(self._copy(policy, number), f"self-{number}")

    def _copy(self, policy: Any, number: int) -> Copy:
        return Copy(policy, self._draw, self._shape, self._seed * APART + number)

    def after_rollout(self, rollouts: int, total: int, policy: Any) -> dict[str, float]:
        """Let a copy of the policy or the next level of a robot join; return the win rates."""
        if self._given is None:
            return {}
        if self._given.plays_itself and rollouts * COPIES // total > (rollouts - 1) * COPIES // total:
            self._join(policy)
        for levels in self._given.robots:
            self._raise_level(levels)
        fixed = {name: one for name, one in self.league.results.items() if not name.startswith("self-")}
        return {f"win rate/{name}": one.win_rate for name, one in fixed.items()}

    def _raise_level(self, levels: Sequence[str]) -> None:
        """Add the next level of a robot if the learner beats the present one."""
        met = [level for level in levels if level in self.league.results]
        results = self.league.results[met[-1]]
        if len(met) < len(levels) and results.games >= GAMES and results.win_rate >= READY:
            self.league.add_robot(levels[len(met)])

    def state(self) -> dict[str, Any]:
        """Return everything that future opponents depend on: tensors, numbers and lists of them."""
        copies = {name: one for name, one in self.league.sources.items() if isinstance(one, Copy)}
        return {
            "table": self.league.table.model_dump_json(),
            "copies": {name: one.network.state_dict() for name, one in copies.items()},
            "random": {name: one.random.get_state() for name, one in copies.items()},
        }

    def restore(self, state: Mapping[str, Any], policy: Any) -> None:
        """Continue from what ``state`` returned. Environments must be made anew afterwards."""
        if self._given is None:
            return
        sources: dict[str, Any] = dict(self._submissions)
        for number, (name, weights) in enumerate(state["copies"].items()):
            one = self._copy(policy, number)
            one.network.load_state_dict(weights)
            one.random.set_state(state["random"][name])
            sources[name] = one
        self.league = League.of(LeagueTable.model_validate_json(state["table"]), sources)


def _shares(opposition: Opposition) -> dict[str, Any]:
    """Return the settings of the league, in which robots, submissions and the policy itself get shares.

    Copies of the policy fill half of the seats if it is named; the others share the rest by their number.
    """
    robots, submissions = len(opposition.robots), len(opposition.submissions)
    others = robots + submissions
    copies = 0.0 if not opposition.plays_itself else 0.5 if others else 1.0
    return {
        "robot_share": (1.0 - copies) * robots / others if others else 0.0,
        "latest_share": LATEST * copies,
        "capacity": COPIES + 2 + submissions,  # nobody is dropped
    }
