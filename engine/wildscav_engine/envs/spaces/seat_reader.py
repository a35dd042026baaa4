"""Reads the observations of the same seats in all matches of a batch."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.tables.array_tables import ArrayTable
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import Part
from wildscav_engine.envs.spaces.features import allocate_row_workspace, write_rows
from wildscav_engine.envs.spaces.flattening import Flattener, Run, write_flat
from wildscav_engine.envs.spaces.function_reader import FunctionReader
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.envs.spaces.observation import (
    Observation,
    Readings,
    SensorReader,
    layout_of,
    readings_space,
)
from wildscav_engine.tracks.rewards import RewardSum

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch

# The parts of rows that depend on what an agent sees.
OF_SEEN = (Part.SUPPLIES, Part.TO_BOX, Part.TO_ENEMY)


class SeatReader:
    """Reads the observations of S seats in each of B matches, and their rewards and events.

    Attributes:
        layout: The layout of the rows that ``read`` returns.
        done: (B, S) whether the episode of each seat has ended; with the next three updated by ``read``.
        terminated: (B, S) whether it has terminated.
        truncated: (B, S) whether it was truncated by the time limit.
        rewards: (B, S) float64, the rewards since the last call.
        ended: The number of matches in which the episodes of all seats have ended.
    """

    def __init__(self, config: EnvConfig, seats: Sequence[int], matches: int, part: Any = ()) -> None:
        """Create a reader; ``part`` is the index of what observations keep of the axes (B, S)."""
        self.layout = layout_of(config)
        self.ended = 0
        self._seats, self._part, self._threads = tuple(seats), part, config.threads
        self._needs_seen = any(self.layout.first(each) >= 0 for each in OF_SEEN)
        self._groups: list[tuple[str, Any]] = [
            (name, slice(first, last) if part == (0, 0) else (..., slice(first, last)))
            for name, first, last in self.layout.groups
        ]
        self._runs: list[Run] = []  # of flat observations
        if config.flat:
            flattener = Flattener(readings_space(config), config.version)
            self._runs = flattener.runs(self.layout.groups)
            self._flat_shape = (matches, len(seats), *flattener.space.shape)
        terms = RewardSum(config.reward_weights).term_arrays
        self._weights = np.tile(terms.weight, (matches, 1))  # of matches that start from now on
        workspace = allocate_row_workspace(matches, len(config.seats), seats, self.layout.start, terms)
        self.done, self._is_new = workspace.done, workspace.is_new
        self.terminated, self.truncated = workspace.terminated, workspace.truncated
        self.rewards = workspace.rewards
        self._weights_of_matches = workspace.weight
        poses = workspace.eyes, workspace.yaws, workspace.pitches
        sensors = config.read_sensors()
        self._sensors = SensorReader(sensors, seats, poses, config.threads) if sensors else None
        has_functions = config.reward_functions or config.observers
        self._functions = FunctionReader(config, seats, matches, self.layout) if has_functions else None
        # The facts after one step are those before the next, so the two arrays swap roles.
        swapped = workspace._replace(before=workspace.after, after=workspace.before)
        self._workspace, self._next_workspace = ArrayTable(workspace), ArrayTable(swapped)
        self._shape = (*self.done.shape, self.layout.width)

    def begin(self, batch: "Batch", rows: Sequence[int]) -> None:
        """Note that some rows of the batch contain new matches."""
        if self._sensors is not None:
            self._sensors.set_maps(batch.maps)
        if self._functions is not None:
            self._functions.begin(rows)
        self._weights_of_matches[list(rows)] = self._weights[list(rows)]
        self.done[list(rows)] = False
        self._is_new[list(rows)] = True

    def set_rewards(self, match: int, weights: Mapping[str, float]) -> None:
        """Set the weights of the same reward terms for what starts in a row from now on."""
        self._weights[match] = list(weights.values())

    def read(
        self, batch: "Batch", view: Callable[[int], MatchInBatch]
    ) -> tuple[Observation, NDArray[np.float32]]:
        """Return the observations, and (B, S, width) rows with rewards and events since the last call.

        Observations are by name (B, S, …), or (B, S, n) if flat; of these, the part that is kept. No array is
        reused.
        """
        output = self.begin_reading(batch, view)
        self.finish_reading()
        return output

    def begin_reading(
        self, batch: "Batch", view: Callable[[int], MatchInBatch]
    ) -> tuple[Observation, NDArray[np.float32]]:
        """Do the same as ``read``, but images may be incomplete until ``finish_reading``.

        Until then, other threads may be rendering them.
        """
        rows = np.empty(self._shape, np.float32)
        readings: Readings = {}
        if self._needs_seen:
            batch.seen_by(self._seats, self._threads)
        was_done = None if self._functions is None else self.done.copy()
        self.ended = write_rows(batch.table, self._workspace.addresses, rows)
        self._workspace, self._next_workspace = self._next_workspace, self._workspace
        if self._sensors is not None:
            self._sensors.begin(batch, view, readings)
        if self._functions is not None and was_done is not None:
            self._functions.read(batch, was_done, rows, self.rewards, readings)
        if self._runs:
            self.finish_reading()
            flat = np.empty(self._flat_shape, np.float32)
            write_flat(self._runs, rows, readings, flat)
            return flat[self._part], rows
        kept = rows[self._part]
        observation = {name: kept[group] for name, group in self._groups}
        for name, reading in readings.items():
            observation[name] = reading[self._part]
        return observation, rows

    def finish_reading(self) -> None:
        """Complete the images of the last observations."""
        if self._sensors is not None:
            self._sensors.finish()
