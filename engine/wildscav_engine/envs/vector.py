"""Many single environments as one Gymnasium vector environment, played as one batch."""

from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from wildscav_engine.envs.arena import Arena, ArenaOutput
from wildscav_engine.envs.batched import Autoreset, ManyMatches, Outcome
from wildscav_engine.envs.infos import Infos
from wildscav_engine.envs.rendering.render import Renderer
from wildscav_engine.envs.settings.episodes import read_mask, read_seeds
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.single import pictures_of, single_agent_config
from wildscav_engine.envs.spaces.columns import EVENTS
from wildscav_engine.envs.spaces.observation import Observation, observation_space, part_of

VectorInfos = dict[str, Any]


class VectorArena(ManyMatches, VectorEnv[Observation, Any, NDArray[Any]]):
    """N matches with one learner each.

    With the seed s, row i plays the same episodes as the single environment with the seed s + i.
    """

    def __init__(
        self,
        track: str,
        num_envs: int = 1,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **options: Unpack[EnvOptions],
    ) -> None:
        """Create the environments.

        Args:
            track: A name in ``tracks.TRACKS``.
            num_envs: The number of matches.
            autoreset_mode: When a match that has ended is reset.
            options: The fields of ``EnvOptions``.

        Raises:
            ValueError: An option is invalid.
        """
        self.config = single_agent_config(track, options)
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}, must be at least 1")
        self.num_envs, self.autoreset_mode = num_envs, AutoresetMode(autoreset_mode)
        self.render_mode = self.config.render_mode
        self.metadata = {**pictures_of(self.config), "autoreset_mode": self.autoreset_mode}
        self.arena = Arena(self.config, num_envs, (slice(None), 0))
        self.single_observation_space = observation_space(self.config)
        self.single_action_space = self.arena.mode.space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._autoreset = Autoreset(self.arena, self.autoreset_mode, (num_envs,))
        self._renderer = Renderer(self.config)
        self._infos_of_one = Infos(self.arena)
        self._all_rows = np.ones(num_envs, np.bool_)
        self._all_rows.flags.writeable = False
        self._no_rows = np.zeros(num_envs, np.bool_)
        self._no_rows.flags.writeable = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, VectorInfos]:
        """Start new episodes.

        Args:
            seed: The seed of the first environment, from which the others count on; or a list of all seeds.
            options: ``reset_mask``, (N,) bool, the environments to reset; the options of a single one; and
                ``each``, a list with such options for each row.

        Raises:
            ValueError: A seed, the mask or an option is invalid; nothing has changed.
        """
        seeds = read_seeds(seed, self.num_envs)
        given, mask = options, None
        if isinstance(options, Mapping):
            given, mask = {**options}, options.get("reset_mask")
            given.pop("reset_mask", None)
        chosen = self._all_rows if mask is None else read_mask(mask, self.num_envs, "reset_mask")
        first_seed = (self.np_random_seed or 0) if seeds[0] is None else seeds[0]
        output = self._autoreset.reset(seeds, first_seed, chosen, given, ("reset_mask",))
        super().reset(seed=seeds[0])
        self._show()
        return output.observation, self._infos(output.rows, (), np.zeros((0, 1, 0)), chosen)

    def step(
        self, actions: Any
    ) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], VectorInfos]:
        """Play one step in every environment; ActionError if an action is not in the action space.

        Raises RuntimeError if there is no match yet, or one has ended and nothing resets it.
        """
        outcome = self._autoreset.step(actions)
        infos = self._infos(outcome.rows, outcome.ended, outcome.metrics, self._all_rows)
        if outcome.final is not None:
            infos = self._with_final(infos, outcome, outcome.final)
        self.arena.finish_reading()
        self._show()
        return (
            outcome.observation,
            outcome.rewards[:, 0],
            outcome.terminated[:, 0],
            outcome.truncated[:, 0],
            infos,
        )

    def _infos(
        self,
        rows: NDArray[np.float32],
        ended: tuple[int, ...],
        metrics: NDArray[np.float64],
        chosen: NDArray[np.bool_],
    ) -> VectorInfos:
        """Return the infos of the single environments, each value as an array with a mask."""
        arena = self.arena
        counts = arena.events(rows)[:, 0].astype(np.int64)
        terms = arena.reward_terms(rows)[:, 0].astype(np.float64)
        if chosen is not self._all_rows:
            counts, terms = counts * chosen[:, np.newaxis], terms * chosen[:, np.newaxis]
        measured = np.zeros((self.num_envs, len(arena.metrics)))
        if ended:
            measured[list(ended)] = metrics[:, 0]
        return {
            "events": self._masked(EVENTS, counts, chosen),
            "_events": chosen,
            "reward_terms": self._masked(arena.terms, terms, chosen),
            "_reward_terms": chosen,
            "metrics": self._masked(arena.metrics, measured, chosen),
            "_metrics": chosen,
        }

    def _masked(self, names: tuple[str, ...], values: NDArray[Any], chosen: NDArray[np.bool_]) -> Any:
        """Return the columns of (N, len(names)) values by name, each with its mask; the values if flat."""
        if self.config.flat:
            return values
        masked: VectorInfos = {}
        for name, column in zip(names, values.T, strict=True):
            masked[name] = column
            masked[f"_{name}"] = chosen
        return masked

    def _with_final(self, infos: VectorInfos, outcome: Outcome, final: ArenaOutput) -> VectorInfos:
        """Return the infos of new episodes, with the last observations and infos of the previous ones."""
        mask = self._no_rows.copy()
        mask[list(outcome.ended)] = True
        observations = np.full(self.num_envs, None, object)
        for row in outcome.ended:
            observations[row] = part_of(final.observation, row)
        ended: VectorInfos = {}
        for place, row in enumerate(outcome.ended):
            *_, counts, terms = self.arena.outcome(outcome.rows[row, 0])
            info = self._infos_of_one.of(counts, terms, outcome.metrics[place, 0].tolist())
            ended = self._add_info(ended, {**info}, row)
        for name in ("events", "reward_terms", "metrics"):
            if self.config.flat:
                infos[name] = np.where(mask[:, np.newaxis], infos[name].dtype.type(0), infos[name])
                continue
            for key, values in infos[name].items():
                if not key.startswith("_"):
                    infos[name][key] = np.where(mask, values.dtype.type(0), values)
        return infos | {
            "final_obs": observations,
            "_final_obs": mask,
            "final_info": ended,
            "_final_info": mask,
        }

    def _show(self) -> None:
        self._renderer.begin(self.arena)

    def render(self) -> tuple[Any, ...] | None:
        """Return the images of all environments; for people, a window shows the first one."""
        if self.render_mode not in {"rgb_array", "depth_array"}:
            return None
        return tuple(self._renderer.render(self.arena, row) for row in range(self.num_envs))

    def close_extras(self, **_options: Any) -> None:
        """Close the window or the recording of the live view, if there is one."""
        self._renderer.close()
