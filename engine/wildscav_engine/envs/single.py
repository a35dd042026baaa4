"""The Gymnasium environment for one learner."""

from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Self, Unpack

import gymnasium
from gymnasium.spaces import Space

from wildscav_engine.envs.arena import Arena, ArenaOutput, Changeable
from wildscav_engine.envs.infos import Infos
from wildscav_engine.envs.rendering.render import Renderer
from wildscav_engine.envs.saving import load, save
from wildscav_engine.envs.settings.config import EnvConfig, options_of, read_config
from wildscav_engine.envs.settings.episodes import Episodes, read_seed
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.spaces.observation import Observation, observation_space
from wildscav_engine.specs.rules import FRAMES_PER_SECOND

RENDER_MODES = ["rgb_array", "depth_array", "human", "rerun"]


class OneMatch(Changeable):
    """An environment of one match, whose state can be saved."""

    _episodes: Episodes | None
    _renderer: Renderer

    def get_state(self) -> bytes:
        """Return the state of the match and of the sequence of episodes as bytes.

        Raises:
            RuntimeError: No episode has started.
        """
        if self._episodes is None:
            raise RuntimeError("there is no episode: reset the environment first")
        return save(self.arena, 0, self._episodes)

    def set_state(self, data: bytes) -> tuple[Any, dict[str, Any]]:
        """Restore the state of an environment with the same options; return its observations and infos.

        Raises:
            StateError: The bytes are not a state of an environment, are damaged, or have another version.
            MatchSetupError: The match has another track, other rules or other seats.
        """
        self._episodes = load(self.arena, 0, data)
        return self._begin()

    def _restart(self, seed: int | None, first_seed: int, options: Mapping[str, Any] | None) -> None:
        """Start the next episode, or the first one of a seed; of ``first_seed`` if there was none before."""
        episodes = self._episodes
        if seed is not None or episodes is None:
            episodes = Episodes(first_seed if seed is None else seed)
        self.arena.start({0: episodes}, {0: options})
        self._episodes = episodes

    def _begin(self) -> tuple[Any, dict[str, Any]]:
        """Show a match that was begun or restored, and return what it looks like."""
        output = self.arena.read()
        self._renderer.begin(self.arena)
        return self._begun(output)

    def _begun(self, output: ArenaOutput) -> tuple[Any, dict[str, Any]]:
        """Return the observations and infos at the beginning."""
        raise NotImplementedError

    def fork(self) -> Self:
        """Return an independent environment in the same state.

        With the same actions, both continue identically. The copy has no render mode, and copies of reward
        functions and observers that are objects: their memory is no part of the state.
        """
        options = options_of(self.config)
        own = deepcopy({name: options[name] for name in ("reward_functions", "observers")})
        other = type(self)(self.config.track, **{**options, **own, "render_mode": None})  # type: ignore[call-arg]
        other.set_state(self.get_state())
        return other

    def close(self) -> None:
        """Close the window or the recording of the live view, if there is one."""
        self._renderer.close()


class SingleEnv(OneMatch, gymnasium.Env[Observation, Any]):
    """A match with one learner, in seat 0; robots fill the other seats."""

    metadata: dict[str, Any] = {"render_modes": RENDER_MODES}  # noqa: RUF012

    def __init__(self, track: str, **options: Unpack[EnvOptions]) -> None:
        """Create an environment of a track with the fields of ``EnvOptions``; ValueError if one is wrong."""
        self.config = single_agent_config(track, options)
        self.metadata = pictures_of(self.config)
        self.render_mode = self.config.render_mode
        self.observation_space: Space[Any] = observation_space(self.config)
        self.arena = Arena(self.config, part=(0, 0))
        self.action_space = self.arena.mode.space
        self._episodes = None
        self._renderer = Renderer(self.config)
        self._infos = Infos(self.arena)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start the next episode, or the first episode of a seed.

        Args:
            seed: 0 or more; determines all following episodes.
            options: ``start``, ``start_range``, ``target`` and ``map`` of this episode only.

        Raises:
            ValueError: The seed or an option is invalid; nothing has changed.
        """
        number = None if seed is None else read_seed(seed)
        self._restart(number, self.np_random_seed, options)
        super().reset(seed=number)
        return self._begin()

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Play one step; ActionError if the action is not in the space, RuntimeError without an episode."""
        arena = self.arena
        if arena.batch is None or arena.ended:
            raise RuntimeError("there is no episode, or it has ended: reset the environment first")
        arena.mode.decode(action, arena.batch.state.agents.yaw[0], arena.actions[0], ())
        observation, rows = arena.step()
        terminated, truncated, reward, counts, terms = arena.outcome(rows[0, 0])
        measured = [*arena.measure(0, 0).values()] if arena.ended else ()
        info: Any = self._infos.of(counts, terms, measured)
        self._renderer.show(arena)
        return observation, reward, terminated, truncated, info

    def render(self) -> Any:
        """Return an image as the render mode demands: (height, width, 3) uint8, or (height, width) m.

        With ``human``, return None: the viewer is updated in every step.
        """
        return self._renderer.render(self.arena)

    def _begun(self, output: ArenaOutput) -> tuple[Observation, dict[str, Any]]:
        *_, counts, terms = self.arena.outcome(output.rows[0, 0])
        return output.observation, {**self._infos.of(counts, terms)}


def pictures_of(config: EnvConfig) -> dict[str, Any]:
    """Return what the metadata of an environment say about its pictures, one a step."""
    return {"render_modes": RENDER_MODES, "render_fps": FRAMES_PER_SECOND / config.frames_per_action}


def single_agent_config(track: str, options: Mapping[str, Any]) -> EnvConfig:
    """Return the options of an environment with one learner; robots replace further learners of a preset."""
    config = read_config(track, options)
    if config.agents > 1 and "agents" not in options:
        from wildscav_engine.tracks import TRACKS

        mates = (TRACKS[track].robot,) * (config.agents - 1)
        config = read_config(track, {"teammates": mates, **options, "agents": 1})
    if config.agents != 1:
        raise ValueError(f"agents is {config.agents}, must be 1; use parallel_env for several")
    return config
