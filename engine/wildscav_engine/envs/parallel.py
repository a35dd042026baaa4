"""Several learners: PettingZoo environments."""

from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from gymnasium.spaces import Box, Space
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec

from wildscav_engine.envs.arena import Arena, Reading
from wildscav_engine.envs.batched import several_config
from wildscav_engine.envs.infos import info_of
from wildscav_engine.envs.registry import register_several
from wildscav_engine.envs.rendering.render import Picture
from wildscav_engine.envs.saving import load, save
from wildscav_engine.envs.settings.episodes import Episodes
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.single import RENDER_MODES, STEPS_PER_SECOND
from wildscav_engine.envs.spaces.columns import Part
from wildscav_engine.envs.spaces.global_state import global_state, global_state_space
from wildscav_engine.envs.spaces.masks import flat_mask, flat_space
from wildscav_engine.envs.spaces.observation import Observation, observation_space, part_of

if TYPE_CHECKING:
    from pettingzoo import AECEnv

VERSION = 0
register_several()


class ParallelArena(ParallelEnv[str, Observation, Any]):
    """A match whose learners act all at once; ``agent_0`` sits in seat 0, and so on.

    Whoever is out for good gets its last values and leaves ``agents``. Whoever will come back stays:
    ``alive`` in the group ``body`` of its observation says 0, and the action mask in its infos allows one
    action.
    """

    def __init__(self, track: str, **options: Unpack[EnvOptions]) -> None:
        """Choose what is played.

        Args:
            track: A name in ``tracks.TRACKS``.
            options: As ``EnvOptions`` has them; ``agents`` are the learners.

        Raises:
            ValueError: An option is wrong.
        """
        self.config, self._options = several_config(track, options), options
        self.metadata = {
            "name": f"wildscav_{track}_v{VERSION}",
            "render_modes": RENDER_MODES,
            "render_fps": STEPS_PER_SECOND,
            "is_parallelizable": True,
        }
        self.render_mode = self.config.render_mode
        self.possible_agents = [f"agent_{seat}" for seat in range(self.config.agents)]
        self.agents: list[str] = []
        self.arena = Arena(self.config)
        self.observation_spaces: dict[str, Space[Any]] = {
            agent: observation_space(self.config) for agent in self.possible_agents
        }
        space = flat_space(self.arena.mode.space) if self.config.flat else self.arena.mode.space
        self.action_spaces: dict[str, Space[Any]] = dict.fromkeys(self.possible_agents, space)
        self.state_space: Box = global_state_space(self.config)
        self._seats = {agent: seat for seat, agent in enumerate(self.possible_agents)}
        self._rows = [self.arena.actions[:, seat] for seat in range(self.config.agents)]
        self._alive = self.arena.layout.first(Part.BODY)
        self._episodes: Episodes | None = None
        self._picture = Picture(self.config)

    def observation_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent's observations, the same object every time."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space[Any]:
        """Return the space of an agent's actions, the same object every time."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin the next episode; that of a seed if one is given.

        Args:
            seed: 0 or more. The episodes after it are a function of it.
            options: ``start``, ``target`` and ``map`` of this episode alone; others are ignored.

        Raises:
            ValueError: An option is wrong.
        """
        if seed is not None or self._episodes is None:
            self._episodes = self.arena.episodes(seeding.np_random(seed)[1] if seed is None else seed)
        self.arena.restart([0], [self._episodes.next(options)])
        self.agents = list(self.possible_agents)
        reading = self.arena.read()
        self._picture.begin(self.arena)
        infos = {agent: self._info(reading, agent, ended=False) for agent in self.agents}
        return self._observations(reading), infos

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]
    ]:
        """Play one step.

        Args:
            actions: One for each of ``agents``.

        Raises:
            ActionError: An action is not of the action space.
            ValueError: An agent has none, or one that is not in the match has.
        """
        if not self.agents:
            return {}, {}, {}, {}, {}
        self._choose(actions)
        reading = self.arena.step()
        rewards, terminated, truncated, infos = {}, {}, {}, {}
        for agent in self.agents:
            row = reading.rows[0, self._seats[agent]]
            terminated[agent], truncated[agent], rewards[agent] = self.arena.standing(row)
            infos[agent] = self._info(reading, agent, ended=terminated[agent] or truncated[agent])
        observations = self._observations(reading)
        self.agents = [agent for agent in self.agents if not (terminated[agent] or truncated[agent])]
        if self.render_mode == "human":
            self._picture.show(self.arena)
        return observations, rewards, terminated, truncated, infos

    def _choose(self, actions: dict[str, Any]) -> None:
        if actions.keys() != set(self.agents):
            raise ValueError(
                f"actions are given for {', '.join(sorted(actions)) or 'nobody'}; "
                f"those who act are {', '.join(self.agents)}"
            )
        arena = self.arena
        arena.actions[:] = 0.0
        batch = arena.batch
        if batch is None:
            raise RuntimeError("there is no episode: reset the environment first")
        yaws = batch.state.agents.yaw[0]
        for agent, action in actions.items():
            seat = self._seats[agent]
            arena.mode.decode_one(action, yaws[seat : seat + 1], self._rows[seat])

    def _observations(self, reading: Reading) -> dict[str, Observation]:
        return {agent: part_of(reading.observation, (0, self._seats[agent])) for agent in self.agents}

    def _info(self, reading: Reading, agent: str, *, ended: bool) -> dict[str, Any]:
        seat = self._seats[agent]
        row = reading.rows[0, seat]
        info: dict[str, Any] = {**info_of(self.arena, 0, seat, row, ended=ended)}
        mask = self.arena.mode.mask(bool(row[self._alive]))
        if self.config.flat:
            mask = flat_mask(mask)
        if mask is not None:
            info["action_mask"] = mask
        return info

    def get_state(self) -> bytes:
        """Return the match, and which episode comes next, as bytes.

        Raises:
            RuntimeError: No episode has begun.
        """
        if self._episodes is None:
            raise RuntimeError("there is no episode: reset the environment first")
        return save(self.arena, 0, self._episodes)

    def set_state(self, data: bytes) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Go on from a state of an environment with the same options, and return what is told there.

        Raises:
            StateError: The bytes are no state of an environment, damaged, or of another version.
            MatchSetupError: The match is of another track, or of other rules or seats.
        """
        self._episodes = load(self.arena, 0, data)
        reading = self.arena.read()
        done = self.arena.done[0]
        self.agents = [agent for agent, seat in self._seats.items() if not done[seat]]
        self._picture.begin(self.arena)
        infos = {agent: self._info(reading, agent, ended=False) for agent in self.agents}
        return self._observations(reading), infos

    def fork(self) -> "ParallelArena":
        """Return an environment in the same state that goes its own way: with the same actions, the same way.

        It shows nothing, whatever this one shows.
        """
        other = ParallelArena(self.config.track, **(self._options | {"render_mode": None}))
        other.set_state(self.get_state())
        return other

    def state(self) -> NDArray[np.float32]:
        """Return all that matters of the whole match, robots included, as ``spaces/global_state.py`` says."""
        if self.arena.batch is None:
            raise RuntimeError("there is no episode: reset the environment first")
        return global_state(self.arena.batch.state)

    def render(self) -> Any:
        """Return the picture that the render mode says, of the first agent or from above."""
        return self._picture.render(self.arena)

    def close(self) -> None:
        """End the viewer's recording, if there is one."""
        self._picture.close()


def parallel_env(track: str, **options: Unpack[EnvOptions]) -> ParallelArena:
    """Return a PettingZoo parallel environment.

    Args:
        track: A name in ``tracks.TRACKS``.
        options: As ``EnvOptions`` has them; ``agents`` are the learners.

    Raises:
        ValueError: An option is wrong.
    """
    return ParallelArena(track, **options)


def aec_env(track: str, **options: Unpack[EnvOptions]) -> "AECEnv[str, Observation, Any]":
    """Return the same match with learners that act one after another, by PettingZoo's own conversion.

    Raises:
        ValueError: An option is wrong.
    """
    return parallel_to_aec(parallel_env(track, **options))
