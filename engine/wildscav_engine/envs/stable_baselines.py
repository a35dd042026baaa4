"""Many matches as one vector environment for Stable-Baselines3, which has its own interface."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.spaces.columns import EVENTS
from wildscav_engine.envs.vector import VectorArena


class StableVector(VecEnv):
    """N matches with one learner each, played as one batch.

    With the seed s, row i plays the same episodes as the single environment with the seed s + i. Wrap it in a
    ``VecMonitor`` to log returns.
    """

    _actions: Any = None

    def __init__(self, track: str, num_envs: int, **options: Unpack[EnvOptions]) -> None:
        """Create the environments.

        Args:
            track: A name in ``tracks.TRACKS``.
            num_envs: The number of matches.
            options: The fields of ``EnvOptions``.

        Raises:
            ValueError: An option is invalid.
        """
        self.vector = VectorArena(track, num_envs, autoreset_mode="SameStep", **options)
        super().__init__(num_envs, self.vector.single_observation_space, self.vector.single_action_space)
        self.metadata["render_fps"] = self.vector.metadata["render_fps"]  # for videos

    def reset(self) -> Any:
        """Start new episodes, with the seeds given to ``seed`` if there are any."""
        observation, _ = self.vector.reset(seed=list(self._seeds))
        self._reset_seeds()
        return observation

    def set_options(self, options: Any = None) -> None:
        """Change options from the next episode of each environment on, until they are changed again.

        Args:
            options: The fields of ``EpisodeOptions`` as a dictionary; or a list of one, or None, for each
                environment.

        Raises:
            ValueError: An option cannot change, its value is invalid, or the list has another length; nothing
                has changed.
        """
        if not isinstance(options, list):
            return self.vector.set_options(**(options or {}))
        if len(options) != self.num_envs:
            raise ValueError(f"{len(options)} sets of options are given for {self.num_envs} environments")
        self.vector.arena.set_each({row: one or {} for row, one in enumerate(options)})
        return None

    def step_async(self, actions: NDArray[Any]) -> None:
        """Store the next actions."""
        self._actions = actions

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse, because the environments have no attributes of their own."""
        raise NotImplementedError(f"{attr_name} cannot be set: pass options when creating the environment")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:  # noqa: ARG002
        """Return False for each environment, because the matches are not wrapped environments."""
        return [False] * len(list(self._get_indices(indices)))

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Play one step. Environments whose episode ends are reset, with the last observation in the infos.

        Infos hold ``events``, ``reward_terms`` and ``metrics`` by name, as in single environments.
        """
        observation, rewards, terminated, truncated, infos = self.vector.step(self._actions)
        done = terminated | truncated
        named = self._by_name(infos)
        last = self._by_name(infos["final_info"]) if done.any() else named
        for row in np.flatnonzero(done).tolist():
            named[row] = last[row] | {
                "terminal_observation": infos["final_obs"][row],
                "TimeLimit.truncated": bool(truncated[row] and not terminated[row]),
            }
        return observation, rewards.astype(np.float32), done, named

    def _by_name(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        """Return the infos of each environment by name, even if observations are flat."""
        arena = self.vector.arena
        named: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for key, names in (("events", EVENTS), ("reward_terms", arena.terms), ("metrics", arena.metrics)):
            values = infos[key]
            if not arena.config.flat:
                values = np.stack([values[name] for name in names], axis=1) if names else np.empty((0, 0))
            for info, row in zip(named, values.tolist(), strict=bool(names)):
                info[key] = dict(zip(names, row, strict=True))
        return named

    def close(self) -> None:
        """Close the recording of the live view, if there is one."""
        self.vector.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return the images of all environments."""
        return self.vector.render() or ()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, which all environments share, once per environment."""
        return [getattr(self.vector, attr_name)] * len(self._get_indices(indices))

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **options: Any) -> list[Any]:
        """Call a method of the vector environment for each row, which is its first argument."""
        method = getattr(self.vector, method_name)
        return [method(row, *args, **options) for row in self._get_indices(indices)]
