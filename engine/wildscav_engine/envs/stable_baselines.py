"""Many matches as one vector environment of Stable-Baselines3, which has its own kind."""

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

    Row i of it, with the seed s, is the single environment with the seed s + i. Wrap it in a ``VecMonitor``
    to see returns.
    """

    def __init__(self, track: str, num_envs: int, **options: Unpack[EnvOptions]) -> None:
        """Choose what is played.

        Args:
            track: A name in ``tracks.TRACKS``.
            num_envs: How many matches there are.
            options: As ``EnvOptions`` has them.

        Raises:
            ValueError: An option is wrong.
        """
        self.vector = VectorArena(track, num_envs, autoreset_mode="SameStep", **options)
        self._actions: NDArray[Any] | None = None
        super().__init__(num_envs, self.vector.single_observation_space, self.vector.single_action_space)

    def reset(self) -> Any:
        """Begin new episodes: those of the seeds that were given to ``seed``, if any were."""
        # Its own options are one dictionary for every environment; those of the vector are shared.
        observation, _ = self.vector.reset(seed=list(self._seeds), options=self._options[0])
        self._reset_seeds()
        self._reset_options()
        return observation

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take what everybody does next."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Play one step; whoever ends begins anew, and its last observation is in its infos.

        Infos hold ``events``, ``reward_terms`` and ``metrics`` by name, as those of a single environment do.
        """
        observation, rewards, terminated, truncated, infos = self.vector.step(self._actions)
        done = terminated | truncated
        told = self._by_name(infos)
        last = self._by_name(infos["final_info"]) if done.any() else told
        for row in np.flatnonzero(done).tolist():
            told[row] = last[row] | {
                "terminal_observation": infos["final_obs"][row],
                "TimeLimit.truncated": bool(truncated[row] and not terminated[row]),
            }
        return observation, rewards.astype(np.float32), done, told

    def _by_name(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        """Return what each environment tells besides, by name even if observations are flat."""
        arena = self.vector.arena
        told: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for key, names in (("events", EVENTS), ("reward_terms", arena.terms), ("metrics", arena.metrics)):
            values = infos[key]
            if not arena.config.flat:
                values = np.stack([values[name] for name in names], axis=1) if names else np.empty((0, 0))
            for info, row in zip(told, values.tolist(), strict=bool(names)):
                info[key] = dict(zip(names, row, strict=True))
        return told

    def close(self) -> None:
        """End the viewer's recording, if there is one."""
        self.vector.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return the pictures of all environments."""
        return self.vector.render() or ()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, which all environments share, once for each."""
        return [getattr(self.vector, attr_name)] * len(self._get_indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: the environments have nothing that could be set in some of them.

        Raises:
            NotImplementedError: Always.
        """
        raise NotImplementedError(f"{attr_name} cannot be set: give options when the environment is made")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **options: Any) -> list[Any]:
        """Call a method of the vector that takes a row first, for each of the rows."""
        method = getattr(self.vector, method_name)
        return [method(row, *args, **options) for row in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:  # noqa: ARG002
        """Return False for each: the matches are no environments that could be wrapped."""
        return [False] * len(list(self._get_indices(indices)))
