"""Episodes as arrays: what some seats of a match observed, did and got, step by step."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Dict, Space
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import OUTCOME, Part
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.envs.spaces.observation import observation_space, part_of
from wildscav_engine.envs.spaces.played_actions import played_encoder, played_space
from wildscav_engine.envs.spaces.seat_reader import SeatReader
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.track import measured


class Episode(NamedTuple):
    """An episode of T steps, of one agent or of a team."""

    observations: Any  # (T + 1, …), by name unless flat; by agent and name for a team
    actions: Any  # (T, …), likewise
    rewards: NDArray[np.float64]  # (T,) of all its agents together
    terminations: NDArray[np.bool_]  # (T,)
    truncations: NDArray[np.bool_]  # (T,)
    infos: Mapping[str, Any] | None  # for a team: rewards by agent (T + 1,), and who is active (T + 1,)
    about: Mapping[str, Any]  # its seat, its agent, its map, and the metrics of the match


class Spaces(NamedTuple):
    """The spaces of a data set's observations and actions."""

    observation: Space[Any]
    action: Space[Any]


def spaces_of(config: EnvConfig, *, together: bool) -> Spaces:
    """Return the spaces of episodes, which the learners of a match share if they are together."""
    spaces = Spaces(observation_space(config), played_space(config))
    if not together:
        return spaces
    agents = [agent_name(place) for place in range(config.agents)]
    return Spaces(*(Dict(dict.fromkeys(agents, space)) for space in spaces))


def agent_name(place: int) -> str:
    """Return the name of a learner of a team, as in the environments for several."""
    return f"agent_{place}"


class Watcher:
    """Watches some seats of one match while it is played."""

    def __init__(self, config: EnvConfig, batch: Batch, seats: Sequence[int]) -> None:
        """Read the first observations.

        Args:
            config: An environment with as many learners as there are seats to watch.
            batch: The match, before its first step.
            seats: The seats, in ascending order.
        """
        self.seats, self._batch = list(seats), batch
        self._reader = SeatReader(config, seats, 1)
        self._reader.begin(batch, [0])
        self._view = MatchInBatch(batch, 0)
        self._encode = played_encoder(config)
        self._outcome = self._reader.layout.first(Part.OUTCOME)
        self._observations: list[Any] = []
        self._actions: list[Any] = []
        self._outcomes: list[NDArray[np.float32]] = []  # (S, 3) terminated, truncated, reward
        self._active: list[NDArray[np.bool_]] = []  # (S,) before each step
        self._look()

    def _look(self) -> NDArray[np.float32]:
        observation, rows = self._reader.read(self._batch, lambda _: self._view)
        self._observations.append(part_of(observation, 0))
        return np.asarray(rows[0])

    def step(self, actions: NDArray[np.float32]) -> NDArray[np.float32]:
        """Play a step, and return the (A, FIELDS) actions as played."""
        yaws = self._batch.state.agents.yaw[0, self.seats].copy()
        active = ~self._reader.done[0]
        played: NDArray[np.float32] = self._batch.step(actions[np.newaxis])[0]
        rows = self._look()
        self._actions.append(self._encode(played[self.seats], yaws))
        self._outcomes.append(rows[:, self._outcome : self._outcome + len(OUTCOME)])
        self._active.append(active)
        return played

    @property
    def over(self) -> bool:
        """Whether the episodes of all seats have ended."""
        return bool(self._reader.done.all())

    def alone(self, about: Mapping[str, Any]) -> list[Episode]:
        """Return an episode of each seat."""
        return [self._of_seat(place, about) for place in range(len(self.seats))]

    def _of_seat(self, place: int, about: Mapping[str, Any]) -> Episode:
        active = np.stack(self._active)[:, place]
        steps = int(active.sum())
        outcome = np.stack(self._outcomes[:steps])[:, place].astype(np.float64)
        return Episode(
            observations=_stacked([part_of(one, place) for one in self._observations[: steps + 1]]),
            actions=_stacked([part_of(one, place) for one in self._actions[:steps]]),
            rewards=outcome[:, 2],
            terminations=outcome[:, 0] != 0.0,
            truncations=outcome[:, 1] != 0.0,
            infos=None,
            about={**about, **self._about(self.seats[place])},
        )

    def together(self, about: Mapping[str, Any]) -> Episode:
        """Return one episode of all seats, with their rewards and who is active in ``infos``."""
        places = range(len(self.seats))
        active = np.stack(self._active)  # (T, S)
        outcome = np.stack(self._outcomes).astype(np.float64)
        rewards = np.where(active, outcome[..., 2], 0.0)
        ends = np.zeros(len(active), np.bool_)
        ends[-1] = self.over
        was_truncated = bool((outcome[..., 1] * active).any())
        after = np.vstack([active, ~self._reader.done])
        before = np.vstack([np.zeros((1, len(self.seats))), rewards])
        return Episode(
            observations={
                agent_name(n): _stacked([part_of(one, n) for one in self._observations]) for n in places
            },
            actions={agent_name(n): _stacked([part_of(one, n) for one in self._actions]) for n in places},
            rewards=rewards.sum(axis=1),
            terminations=ends & (not was_truncated),
            truncations=ends & was_truncated,
            infos={
                "rewards": {agent_name(n): before[:, n] for n in places},
                "active": {agent_name(n): after[:, n] for n in places},
            },
            about={**about, **self._about(self.seats[0])},
        )

    def _about(self, seat: int) -> dict[str, Any]:
        metrics = {name: float(value) for name, value in measured(self._view, seat).items()}
        return {"seat": seat, "metrics": metrics}


def _stacked(rows: Sequence[Any]) -> Any:
    """Return observations or actions of all steps: an array, or arrays by name."""
    if isinstance(rows[0], dict):
        return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    return np.stack(rows)
