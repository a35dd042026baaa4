"""The arena: matches × learners as arrays. All environments are thin wrappers around it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.opponents.manager import OpponentManager
from wildscav_engine.envs.settings.config import EnvConfig, change_config
from wildscav_engine.envs.settings.episodes import Episodes, Plan, next_episodes, read_rows
from wildscav_engine.envs.settings.options import EpisodeOptions
from wildscav_engine.envs.spaces.action_mode import Axes
from wildscav_engine.envs.spaces.actions import action_mode
from wildscav_engine.envs.spaces.columns import EVENTS, Part
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.envs.spaces.observation import Observation
from wildscav_engine.envs.spaces.seat_reader import SeatReader
from wildscav_engine.maps.pools import MapPool
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.state import State
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks import TRACKS

OF_POOL = {"map", "level", "split", "random_maps", "unseen"}  # the options that choose the maps


class ArenaOutput(NamedTuple):
    """The output for all learners after a step or a restart, in arrays that are not reused."""

    observation: Observation  # the arena's part of (B, L, …) by name, or of (B, L, n) if flat
    rows: NDArray[np.float32]  # (B, L, width) as ``Layout`` says


class Arena:
    """B matches with L learners each; its opponents fill the other seats."""

    def __init__(self, config: EnvConfig, matches: int = 1, part: Any = ()) -> None:
        """Create an arena without matches; ``start`` adds them.

        Args:
            part: The index of what observations keep of the axes (B, L), such as (0, 0) for a single learner.
        """
        self.config, self.matches, self.track = config, matches, TRACKS[config.track]
        self._plans = [Plan(config)] * matches  # of the next episodes
        self.mode = action_mode(config)
        self.learners = range(config.agents)
        slow = self.track.slow_metrics if config.all_metrics else ()
        self.metrics = tuple(metric.name for metric in self.track.metrics + slow)
        self.terms = (*config.reward_weights, *config.reward_functions)
        self.opponents = OpponentManager(config, matches)
        self.batch: Batch | None = None
        self._views: dict[int, MatchInBatch] = {}
        self._state: State | None = None
        self.actions = np.zeros((matches, len(config.seats), FIELDS), np.float32)
        self._reader = SeatReader(config, self.learners, matches, part)
        self.layout, self.done = self._reader.layout, self._reader.done  # (B, L), updated by every step
        parts = (Part.OUTCOME, Part.EVENTS, Part.TERMS)
        self._outcome, self._events, self._terms = map(self.layout.first, parts)

    @property
    def template(self) -> MatchSpec:
        """The spec of new matches, apart from seed and map; of the first row if rows differ."""
        return self._plans[0].template

    @property
    def pool(self) -> MapPool:
        """The maps on which new matches are played; those of the first row if rows differ."""
        return self._plans[0].pool

    def set_options(self, changes: Mapping[str, Any], rows: Sequence[int] | None = None) -> EnvConfig:
        """Change options of the matches that start from now on, in some rows or all, and return the arena's.

        Only changes of all rows are changes of the arena's own options.
        """
        chosen = range(self.matches) if rows is None else read_rows(rows, self.matches)
        config = self.config
        if rows is None or not chosen:  # without a row, nothing else checks the changes
            config = change_config(config, changes)
        self.set_each(dict.fromkeys(chosen, changes))
        if rows is None:
            self.config = config
        return self.config

    def set_each(self, changes: Mapping[int, Mapping[str, Any]]) -> None:
        """Change options of the matches that start from now on, by row.

        Raises:
            ValueError: An option cannot change, or its value is invalid; nothing has changed.
        """

        def changed(plan: Plan, own: Mapping[str, Any]) -> Plan:
            return Plan(change_config(plan.config, own), None if own.keys() & OF_POOL else plan.pool)

        for row, plan in self._made_once(changes, changed).items():
            self._plans[row] = plan
            self._reader.set_rewards(row, plan.config.reward_weights)

    def _made_once(self, changes: Mapping[int, Any], make: Callable[[Plan, Any], Plan]) -> dict[int, Plan]:
        """Return a plan of each row with its changes; those with the same plan and changes share one."""
        made: dict[tuple[int, int], Plan] = {}
        found = {}
        for row, own in changes.items():
            key = id(self._plans[row]), id(own)
            if key not in made:
                made[key] = make(self._plans[row], own)
            found[row] = made[key]
        return found

    def start(self, sequences: Mapping[int, Episodes], options: Mapping[int, Any] | None = None) -> None:
        """Start the next episode of each row's sequence; the first call must be for all rows.

        If it fails, nothing has changed: neither the matches nor which episode is the next one.

        Args:
            options: The options of a reset by row, for these episodes only; see ``config_of_episode``.
        """
        rows, given = list(sequences), options or {}
        plans = self._made_once({row: given.get(row) for row in rows}, Plan.once)
        episodes = next_episodes(sequences.values(), list(plans.values()))
        specs = self.opponents.choose(rows, [episode.spec for episode in episodes])
        maps = [episode.game_map for episode in episodes]
        if self.batch is None:
            self.batch = Batch(specs, maps)
        else:
            self.batch.restart(rows, specs, maps)
        self._update_after_restart(rows)
        for each in sequences.values():
            each.number += 1

    def _update_after_restart(self, rows: Sequence[int]) -> None:
        """Update everything that depends on the matches in some rows, which are new."""
        batch = self._batch
        if batch.state is not self._state:
            self._state, self._views = batch.state, {}
        for row in rows:
            self._views.pop(row, None)
        self._reader.begin(batch, rows)
        self.opponents.begin(batch, rows)

    @property
    def _batch(self) -> Batch:
        if self.batch is None:
            raise RuntimeError("there is no match yet: reset the environment first")
        return self.batch

    def get_state(self, match: int) -> bytes:
        """Return one match as bytes; see ``Batch.get_state``."""
        return self._batch.get_state(match)

    def set_state(self, match: int, data: bytes, players: Sequence[str] | None = None) -> None:
        """Restore a match with the players that ``OpponentManager.names`` named; no events are read next."""
        if self.batch is None:
            self.start({row: Episodes(row) for row in range(self.matches)})
        found = self.opponents.find(players)
        self._batch.set_state(match, data)
        self.opponents.take(match, found)
        self._update_after_restart([match])

    def set_actions(self, actions: Any, axes: Axes) -> None:
        """Set the actions of all learners, as Gymnasium batches them, with the axes (B, L) or (B × L,)."""
        count, yaws = self.config.agents, self._batch.state.agents.yaw
        rows = self.actions[:, :count].reshape(-1, FIELDS)  # a copy if there are other seats
        self.mode.decode(actions, yaws[:, :count].reshape(-1), rows, axes)
        if count < self.actions.shape[1]:
            self.actions[:, :count] = rows.reshape(self.matches, count, FIELDS)

    def step(self) -> ArenaOutput:
        """Play one step with the actions that were set, and return the output."""
        self.play()
        return self.read()

    def play(self, skip: Sequence[int] = ()) -> None:
        """Play one step with the actions that were set, in all matches except those to be restarted."""
        batch = self._batch
        if self.opponents.acts:
            self.opponents.act(batch, self.view, self.actions, skip)
        if skip:
            batch.state.matches.over[list(skip)] = True
        batch.play(self.actions, self.config.threads)

    def read(self) -> ArenaOutput:
        """Return the output for all learners, with events and rewards since the last call."""
        output = self.begin_reading()
        self.finish_reading()
        return output

    def begin_reading(self) -> ArenaOutput:
        """Do the same, but images may be incomplete until ``finish_reading``; see ``SeatReader``."""
        observation, rows = self._reader.begin_reading(self._batch, self.view)
        if self.opponents.reports:
            self.opponents.report(self.done, self.view)
        return ArenaOutput(observation, rows)

    def finish_reading(self) -> None:
        """Complete the images of the last observation; it does nothing if they are."""
        self._reader.finish_reading()

    def view(self, match: int) -> MatchInBatch:
        """Return the view of one match, for code that reads matches one by one."""
        if match not in self._views:
            self._views[match] = MatchInBatch(self._batch, match)
        return self._views[match]

    @property
    def outcomes(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.float64]]:
        """Whether each episode terminated or was truncated, and the rewards of the step: new (B, L)."""
        reader = self._reader
        return reader.terminated.copy(), reader.truncated.copy(), reader.rewards.copy()

    @property
    def ended(self) -> int:
        """The number of matches in which the episodes of all learners have ended."""
        return self._reader.ended

    def outcome(self, row: NDArray[np.float32]) -> tuple[bool, bool, float, list[float], list[float]]:
        """Return terminated, truncated, the reward, the events and the reward terms of one learner's row."""
        terminated, truncated, reward, *counts = row[self._outcome :].tolist()
        return terminated != 0.0, truncated != 0.0, reward, counts[: len(EVENTS)], counts[len(EVENTS) :]

    def events(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (…, EVENTS) the events of the step."""
        return rows[..., self._events : self._events + len(EVENTS)]

    def reward_terms(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (…, T) the reward terms of the step."""
        return rows[..., self._terms : self._terms + len(self.terms)]

    def measure(self, match: int, learner: int) -> Mapping[str, float]:
        """Return the current metrics of a learner."""
        view = self.view(match)
        values = self.track.measure(view, learner)
        return {**values, **self.track.measure_slow(view, learner)} if self.config.all_metrics else values


class Changeable:
    """An environment whose options can change."""

    config: EnvConfig
    arena: Arena

    def set_options(self, **changes: Unpack[EpisodeOptions]) -> None:
        """Change options from the next episode on of each match, for instance as a learner gets better.

        Args:
            changes: The fields of ``EpisodeOptions``. Terms of the reward that are not named get the weight
                0; new terms are not possible, because infos have one structure.

        Raises:
            ValueError: An option cannot change, or its value is invalid.
        """
        self.config = self.arena.set_options(changes)
