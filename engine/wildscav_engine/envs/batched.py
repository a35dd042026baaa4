"""Several learners in each of many matches as arrays, without dictionaries of agents."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from wildscav_engine.envs.arena import Arena, ArenaOutput, Changeable
from wildscav_engine.envs.saving import load, save
from wildscav_engine.envs.settings.config import ONCE, EnvConfig, check_reset, read_config
from wildscav_engine.envs.settings.episodes import Episodes, read_each, read_mask, read_seeds
from wildscav_engine.envs.settings.options import EnvOptions, EpisodeOptions
from wildscav_engine.envs.spaces.action_mode import Axes
from wildscav_engine.envs.spaces.observation import Observation, observation_space
from wildscav_engine.tracks import TRACKS

Flags = NDArray[np.bool_]


class Outcome(NamedTuple):
    """The outcome of a step for all matches and learners."""

    observation: Observation  # by name (B, L, …), or (B, L, n) if flat
    rewards: NDArray[np.float64]  # (B, L)
    terminated: Flags  # (B, L)
    truncated: Flags  # (B, L)
    rows: NDArray[np.float32]  # (B, L, width) the rows of the arena, with events and reward terms
    ended: tuple[int, ...]  # the matches that ended with this step
    metrics: NDArray[np.float64]  # (len(ended), L, M) of the matches that ended
    final: ArenaOutput | None  # the output before matches were reset in the same step


class Autoreset:
    """The autoreset of environments with many matches: it restarts matches that have ended."""

    def __init__(self, arena: Arena, mode: AutoresetMode, axes: Axes) -> None:
        """Wrap an arena without matches; ``axes`` are the leading ones of actions, (B, L) or (B × L,)."""
        self.arena, self.mode, self._axes = arena, mode, axes
        self.ended: Flags = np.zeros(arena.matches, np.bool_)  # (B,) which matches ended with the last step
        self._episodes: list[Episodes] = []
        self._no_metrics = np.zeros((0, len(arena.learners), len(arena.metrics)))

    def reset(
        self,
        seeds: Sequence[int | None],
        first_seed: int,
        mask: Flags | None = None,
        options: Mapping[str, Any] | None = None,
        also: Sequence[str] = (),
    ) -> ArenaOutput:
        """Start the next episode in some rows, or in all.

        Args:
            seeds: (B,) the seeds of the rows; None to continue the present sequence of episodes.
            first_seed: The seed of the first row if there are no episodes yet; the others count on from it.
            mask: (B,) the rows; None for all.
            options: Those of ``config_of_episode`` for all rows, and ``each`` as ``read_each`` says.
        """
        if options is not None:
            check_reset(options, (*ONCE, "each", *also))
        own = dict(enumerate(read_each(options or {}, self.arena.matches)))
        every = range(self.arena.matches)
        rows = every if mask is None or self.arena.batch is None else np.flatnonzero(mask).tolist()
        begun = self._episodes or [Episodes(first_seed + row) for row in every]
        new = {row: Episodes(seed) for row in rows if (seed := seeds[row]) is not None}
        self.arena.start({row: new.get(row, begun[row]) for row in rows}, own)
        self._episodes = [new.get(row, begun[row]) for row in every]
        self.ended[list(rows)] = False
        return self.arena.read()

    def _restart(self, rows: Sequence[int]) -> None:
        self.arena.start({row: self._episodes[row] for row in rows})
        self.ended[list(rows)] = False

    def get_state(self, row: int) -> bytes:
        """Return the state of one match and of its sequence of episodes as bytes."""
        if not self._episodes:
            raise RuntimeError("there is no episode: reset the environment first")
        return save(self.arena, row, self._episodes[row])

    def set_state(self, row: int, data: bytes) -> ArenaOutput:
        """Restore a row from what ``get_state`` returned; ``saving.load`` lists the errors."""
        if not self._episodes:
            self._episodes = [Episodes(other) for other in range(self.arena.matches)]
        self._episodes[row] = load(self.arena, row, data)
        output = self.arena.read()
        self.ended[row] = self.arena.done[row].all()
        return output

    def step(self, actions: Any) -> Outcome:
        """Play one step in every match; images are complete only after ``arena.finish_reading``."""
        arena = self.arena
        arena.set_actions(actions, self._axes)
        restarting: Sequence[int] = ()
        if self.ended.any():
            if self.mode == AutoresetMode.DISABLED:
                raise RuntimeError(f"matches {np.flatnonzero(self.ended).tolist()} have ended: reset them")
            restarting = np.flatnonzero(self.ended).tolist()
        arena.play(skip=restarting)
        if restarting:
            self._restart(restarting)  # after the step, which new matches do not play
        return self._outcome(arena.begin_reading())

    def _outcome(self, output: ArenaOutput) -> Outcome:
        """Return the outcome of a step; in the same-step mode, restart the matches that ended."""
        arena, rows = self.arena, output.rows
        terminated, truncated, rewards = arena.outcomes
        ended: tuple[int, ...] = ()
        metrics, final = self._no_metrics, None
        self.ended[:] = False
        if arena.ended:
            done = arena.done.all(axis=1)
            ended = tuple(np.flatnonzero(done).tolist())
            metrics = self._measure(ended)
            self.ended[:] = done
            if self.mode == AutoresetMode.SAME_STEP:
                final = output
                arena.finish_reading()
                self._restart(ended)
                output = arena.begin_reading()
        return Outcome(output.observation, rewards, terminated, truncated, rows, ended, metrics, final)

    def _measure(self, matches: Sequence[int]) -> NDArray[np.float64]:
        """Return (len(matches), L, M) the metrics of some matches."""
        learners = range(len(self.arena.learners))
        return np.array(
            [[list(self.arena.measure(match, learner).values()) for learner in learners] for match in matches]
        )


class ManyMatches(Changeable):
    """An environment of many matches, whose states can be saved one by one."""

    _autoreset: Autoreset

    def set_options(self, *, rows: Sequence[int] | None = None, **changes: Unpack[EpisodeOptions]) -> None:
        """Change options from the next episode on of each match, in some rows or in all.

        The changes are those of ``Changeable.set_options``; ValueError if one is invalid or a row does not
        exist.
        """
        self.config = self.arena.set_options(changes, rows)

    def get_state(self, row: int) -> bytes:
        """Return one match and its sequence of episodes as bytes, which a single environment can restore."""
        return self._autoreset.get_state(row)

    def set_state(self, row: int, data: bytes) -> Observation:
        """Restore a row from the state of an environment with the same options; return the observations.

        The errors are those of ``OneMatch.set_state``.
        """
        return self._autoreset.set_state(row, data).observation


class BatchedArena(ManyMatches):
    """B matches with L learners each, as arrays with leading axes (B, L).

    The autoreset modes are Gymnasium's: a match is reset when the episodes of all its learners have ended.
    """

    def __init__(
        self,
        track: str,
        matches: int,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        **options: Unpack[EnvOptions],
    ) -> None:
        """Create the environments.

        Args:
            track: A name in ``tracks.TRACKS``.
            matches: The number of matches.
            autoreset_mode: When a match that has ended is reset.
            options: The fields of ``EnvOptions``; ``agents`` is the number of learners in a match.

        Raises:
            ValueError: An option is invalid.
        """
        self.config = multi_agent_config(track, options)
        if matches < 1:
            raise ValueError(f"matches is {matches}, must be at least 1")
        self.num_matches, self.num_agents = matches, self.config.agents
        self.arena = Arena(self.config, matches)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.single_observation_space = observation_space(self.config)
        self.single_action_space = self.arena.mode.space
        self.action_space = batch_space(batch_space(self.arena.mode.space, self.num_agents), matches)
        self._autoreset = Autoreset(self.arena, self.autoreset_mode, (matches, self.num_agents))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        mask: Flags | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> Observation:
        """Start new episodes, and return the observations (B, L, …).

        Args:
            seed: The seed of the first match, from which the others count on; or a list of all seeds. None
                continues the present sequences.
            mask: (B,) bool, which matches to reset; None for all.
            options: ``start``, ``start_range``, ``target`` and ``map`` of these episodes only; and ``each``,
                a list with such options for each row.

        Raises:
            ValueError: A seed, the mask or an option is invalid; nothing has changed.
        """
        seeds = read_seeds(seed, self.num_matches)
        chosen = None if mask is None else read_mask(mask, self.num_matches, "mask")
        first_seed = gymnasium.utils.seeding.np_random(None)[1]
        return self._autoreset.reset(seeds, first_seed, chosen, options).observation

    def step(self, actions: Any) -> Outcome:
        """Play one step in every match with actions (B, L, …); ActionError if they are not in the space."""
        outcome = self._autoreset.step(actions)
        self.arena.finish_reading()
        return outcome


def multi_agent_config(track: str, options: Mapping[str, Any]) -> EnvConfig:
    """Return the options of an environment with several learners; there are no opponents by default."""
    return read_config(track, options, agents=TRACKS[track].learners if track in TRACKS else 1, opponents=())
