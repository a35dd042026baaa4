"""One learner: a Gymnasium environment."""

from collections.abc import Mapping
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.spaces import Space
from numpy.typing import NDArray

from wildscav_engine.envs.arena import Arena, Reading
from wildscav_engine.envs.infos import info_of
from wildscav_engine.envs.rendering.render import Picture
from wildscav_engine.envs.saving import load, save
from wildscav_engine.envs.settings.config import EnvConfig, read_config
from wildscav_engine.envs.settings.episodes import Episodes
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.spaces.observation import Observation, observation_space, part_of

RENDER_MODES = ["rgb_array", "depth_array", "human"]
STEPS_PER_SECOND = 10  # of frames held for five


class SingleEnv(gymnasium.Env[Observation, Any]):
    """A match with one learner, in seat 0; robots fill the other seats."""

    metadata: dict[str, Any] = {"render_modes": RENDER_MODES, "render_fps": STEPS_PER_SECOND}  # noqa: RUF012

    def __init__(self, track: str, **options: Unpack[EnvOptions]) -> None:
        """Choose what is played.

        Args:
            track: A name in ``tracks.TRACKS``.
            options: As ``EnvOptions`` has them.

        Raises:
            ValueError: An option is wrong.
        """
        self.config, self._options = single_config(track, options), options
        self.render_mode = self.config.render_mode
        self.observation_space: Space[Any] = observation_space(self.config)
        self._arena = Arena(self.config)
        self.action_space = self._arena.mode.space
        self._episodes: Episodes | None = None
        self._picture = Picture(self.config)
        self._own = self._arena.actions[:, 0]

    @property
    def arena(self) -> Arena:
        """What is played in."""
        return self._arena

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin the next episode; that of a seed if one is given.

        Args:
            seed: 0 or more. The episodes after it are a function of it.
            options: ``start``, ``target`` and ``map`` of this episode alone.

        Raises:
            ValueError: An option is wrong.
        """
        super().reset(seed=seed)
        if self._episodes is None or seed is not None:
            self._episodes = self._arena.episodes(self.np_random_seed if seed is None else seed)
        self._arena.restart([0], [self._episodes.next(options)])
        reading = self._arena.read()
        self._picture.begin(self._arena)
        return _of_first(reading), {**info_of(self._arena, 0, 0, reading.rows[0, 0], ended=False)}

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Play one step.

        Raises:
            ActionError: The action is not of the action space.
            RuntimeError: No episode has begun, or it has ended.
        """
        arena = self._arena
        if arena.batch is None or arena.done[0, 0]:
            raise RuntimeError("there is no episode, or it has ended: reset the environment first")
        arena.mode.decode_one(action, arena.batch.state.agents.yaw[0, :1], self._own)
        reading = arena.step()
        row: NDArray[np.float32] = reading.rows[0, 0]
        terminated, truncated, reward = arena.standing(row)
        info: dict[str, Any] = {**info_of(arena, 0, 0, row, ended=terminated or truncated)}
        if self.render_mode == "human":
            self._picture.show(arena)
        return _of_first(reading), reward, terminated, truncated, info

    def get_state(self) -> bytes:
        """Return the match, and which episode comes next, as bytes.

        Raises:
            RuntimeError: No episode has begun.
        """
        if self._episodes is None:
            raise RuntimeError("there is no episode: reset the environment first")
        return save(self._arena, 0, self._episodes)

    def set_state(self, data: bytes) -> tuple[Observation, dict[str, Any]]:
        """Go on from a state of an environment with the same options, and return what is told there.

        Raises:
            StateError: The bytes are no state of an environment, damaged, or of another version.
            MatchSetupError: The match is of another track, or of other rules or seats.
        """
        self._episodes = load(self._arena, 0, data)
        reading = self._arena.read()
        self._picture.begin(self._arena)
        return _of_first(reading), {**info_of(self._arena, 0, 0, reading.rows[0, 0], ended=False)}

    def fork(self) -> "SingleEnv":
        """Return an environment in the same state that goes its own way: with the same actions, the same way.

        It shows nothing, whatever this one shows.
        """
        other = SingleEnv(self.config.track, **(self._options | {"render_mode": None}))
        other.set_state(self.get_state())
        return other

    def render(self) -> Any:
        """Return the picture that the render mode says: (height, width, 3) uint8, or (height, width) m.

        ``human`` returns nothing: its viewer follows every step by itself.
        """
        return self._picture.render(self._arena)

    def close(self) -> None:
        """End the viewer's recording, if there is one."""
        self._picture.close()


def single_config(track: str, options: Mapping[str, Any]) -> EnvConfig:
    """Return the options of an environment with one learner; robots take the place of the others of a preset.

    Raises:
        ValueError: An option is wrong, or there are several learners.
    """
    config = read_config(track, options)
    if config.agents > 1 and "agents" not in options:
        from wildscav_engine.tracks import TRACKS

        mates = (TRACKS[track].robot,) * (config.agents - 1)
        config = read_config(track, {"teammates": mates, **options, "agents": 1})
    if config.agents != 1:
        raise ValueError(f"agents is {config.agents}: here there is one; parallel_env has several")
    return config


def _of_first(reading: Reading) -> Observation:
    return part_of(reading.observation, (0, 0))
