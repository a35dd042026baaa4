"""The PettingZoo environments for several learners."""

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from gymnasium.spaces import Box, MultiDiscrete, Space
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec

from wildscav_engine.envs.arena import Arena, ArenaOutput
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.infos import Infos
from wildscav_engine.envs.registry import register_several
from wildscav_engine.envs.rendering.render import Renderer
from wildscav_engine.envs.settings.episodes import read_seed
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.single import OneMatch, pictures_of
from wildscav_engine.envs.spaces.action_mode import check_names
from wildscav_engine.envs.spaces.columns import Part
from wildscav_engine.envs.spaces.global_state import global_state, global_state_space
from wildscav_engine.envs.spaces.observation import Observation, observation_space, part_of

if TYPE_CHECKING:
    from pettingzoo import AECEnv

register_several()

PROBE = {"options": 1}  # what PettingZoo's own tests reset every environment with


class ParallelArena(OneMatch, ParallelEnv[str, Observation, Any]):
    """A match whose learners act simultaneously; ``agent_0`` has seat 0, and so on.

    An eliminated agent gets its last values and leaves ``agents``. A dead agent that will respawn stays:
    ``alive`` in the group ``body`` of its observation is 0, and the action mask in its infos allows one
    action.
    """

    def __init__(self, track: str, **options: Unpack[EnvOptions]) -> None:
        """Create an environment of a track, with the fields of ``EnvOptions``; ValueError if one is invalid.

        ``agents`` is the number of learners.
        """
        self.config = multi_agent_config(track, options)
        self.metadata = {
            "name": f"wildscav_{track}_v{self.config.version}",
            **pictures_of(self.config),
            "is_parallelizable": True,
        }
        self.render_mode = self.config.render_mode
        self.possible_agents = [f"agent_{seat}" for seat in range(self.config.agents)]
        self.agents: list[str] = []
        self.arena = Arena(self.config, part=0)
        self.observation_spaces: dict[str, Space[Any]] = {
            agent: observation_space(self.config) for agent in self.possible_agents
        }
        space = flat_space(self.arena.mode.space) if self.config.flat else self.arena.mode.space
        self.action_spaces: dict[str, Space[Any]] = dict.fromkeys(self.possible_agents, space)
        self.state_space: Box = global_state_space(self.config)
        self._seats = {agent: seat for seat, agent in enumerate(self.possible_agents)}
        self._alive = self.arena.layout.first(Part.BODY)
        self._episodes = None
        self._renderer = Renderer(self.config)
        self._infos = Infos(self.arena)

    def observation_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent's observations, the same object every time."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent's actions, the same object every time."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Start the next episode, or the first one of a seed, as ``SingleEnv.reset`` does."""
        if options == PROBE:
            options = None
        number = None if seed is None else read_seed(seed)
        self._restart(number, seeding.np_random(None)[1], options)
        return self._begin()

    def _begun(self, output: ArenaOutput) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        done = self.arena.done[0]
        self.agents = [agent for agent, seat in self._seats.items() if not done[seat]]
        rows = output.rows[0]
        infos = {agent: self._info(rows[self._seats[agent]], agent, ended=False) for agent in self.agents}
        return self._observations(output), infos

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]
    ]:
        """Play one step, with one action for each of ``agents``.

        Raises:
            ActionError: An action is not in the action space, is missing, or is for an agent that is not in
                the match.
        """
        if not self.agents:
            return {}, {}, {}, {}, {}
        self._set_actions(actions)
        output = self.arena.step()
        rewards, terminated, truncated, infos = {}, {}, {}, {}
        for agent in self.agents:
            row = output.rows[0, self._seats[agent]]
            terminated[agent], truncated[agent], rewards[agent], *_ = self.arena.outcome(row)
            infos[agent] = self._info(row, agent, ended=terminated[agent] or truncated[agent])
        observations = self._observations(output)
        self.agents = [agent for agent in self.agents if not (terminated[agent] or truncated[agent])]
        self._renderer.show(self.arena)
        return observations, rewards, terminated, truncated, infos

    def _set_actions(self, actions: dict[str, Any]) -> None:
        check_names(actions, self.agents)
        arena = self.arena
        arena.actions[:, : arena.config.agents] = 0.0
        batch = arena.batch
        if batch is None:
            raise RuntimeError("there is no episode: reset the environment first")
        yaws = batch.state.agents.yaw[0]
        for agent, action in actions.items():
            seat = self._seats[agent]
            arena.mode.decode(action, yaws[seat : seat + 1], arena.actions[:, seat], ())

    def _observations(self, output: ArenaOutput) -> dict[str, Observation]:
        return {agent: part_of(output.observation, self._seats[agent]) for agent in self.agents}

    def _info(self, row: NDArray[np.float32], agent: str, *, ended: bool) -> dict[str, Any]:
        measured = [*self.arena.measure(0, self._seats[agent]).values()] if ended else ()
        *_, counts, terms = self.arena.outcome(row)
        info: dict[str, Any] = {**self._infos.of(counts, terms, measured)}
        mask = self.arena.mode.mask(bool(row[self._alive]))
        if self.config.flat:
            mask = flat_mask(mask)
        if mask is not None:
            info["action_mask"] = mask
        return info

    def state(self) -> NDArray[np.float32]:
        """Return the state of the whole match, including robots; see ``spaces/global_state.py``."""
        if self.arena.batch is None:
            raise RuntimeError("there is no episode: reset the environment first")
        return global_state(self.arena.batch.state)

    def render(self) -> Any:
        """Return an image as the render mode demands, of what the first agent sees or from above."""
        return self._renderer.render(self.arena)


def parallel_env(track: str, **options: Unpack[EnvOptions]) -> ParallelArena:
    """Return a PettingZoo parallel environment; see ``ParallelArena``."""
    return ParallelArena(track, **options)


def aec_env(track: str, **options: Unpack[EnvOptions]) -> "AECEnv[str, Observation, Any]":
    """Return the same environment with agents that act one after another, by PettingZoo's conversion."""
    return parallel_to_aec(parallel_env(track, **options))


class FlatMaskDiscrete(MultiDiscrete):
    """A MultiDiscrete whose ``sample`` also accepts a mask in one row, as flat environments provide it."""

    def sample(self, mask: Any = None, probability: Any = None) -> NDArray[Any]:
        """Return a random choice among those that a mask allows.

        Args:
            mask: (all choices,) int8, 1 where a choice is allowed; or a tuple with a row per field.
            probability: As in Gymnasium.
        """
        if isinstance(mask, np.ndarray) and mask.ndim == 1 and len(mask) == self.nvec.sum():
            mask = tuple(np.split(mask, np.cumsum(self.nvec)[:-1]))
        return super().sample(mask, probability)


def flat_space(space: Space[Any]) -> Space[Any]:
    """Return an action space that accepts the masks of a flat environment."""
    return FlatMaskDiscrete(space.nvec) if isinstance(space, MultiDiscrete) else space


def flat_mask(mask: Any) -> NDArray[np.int8] | None:
    """Return the action mask of an action mode as one row; None for a Dict, which has none."""
    if isinstance(mask, tuple):
        return np.concatenate(mask)
    return mask if isinstance(mask, np.ndarray) else None
