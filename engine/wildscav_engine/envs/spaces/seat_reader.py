"""Reads the observations of the same seats in all matches of a batch."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import ArrayTable
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.features import allocate_row_workspace, write_rows
from wildscav_engine.envs.spaces.flattening import Flattener
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
    from wildscav_engine.simulation.state import State


class SeatReader:
    """Reads the observations of S seats in each of B matches, and their rewards and events.

    Attributes:
        layout: The layout of the rows that ``read`` returns.
        done: (B, S) whether the episode of each seat has ended; updated by ``read``.
    """

    def __init__(self, config: EnvConfig, seats: Sequence[int], matches: int) -> None:
        """Create a reader.

        Args:
            config: The options that determine the observations and rewards.
            seats: The numbers of the seats.
            matches: The number of matches.
        """
        self.layout = layout_of(config)
        self._sensors = SensorReader(config.read_sensors(), seats, config.threads)
        self._flattener = Flattener(readings_space(config), config.version) if config.flat else None
        terms = RewardSum(config.reward_weights).term_arrays
        self._weights = terms.weight  # of matches that start from now on
        workspace = allocate_row_workspace(matches, len(config.seats), seats, self.layout.start, terms)
        self.done, self._is_new = workspace.done, workspace.is_new
        self._weights_of_matches = workspace.weight
        # The facts after one step are those before the next, so the two arrays swap roles.
        self._workspace, self._next_workspace = (
            ArrayTable(workspace),
            ArrayTable(workspace._replace(before=workspace.after, after=workspace.before)),
        )
        self._tables: tuple[ArrayTable, ...] = ()
        self._state: State | None = None

    def begin(self, batch: "Batch", rows: Sequence[int]) -> None:
        """Note that some rows of the batch contain new matches."""
        self._sensors.set_maps(batch.maps)
        if batch.state is not self._state:
            self._state = batch.state
            parts = (*batch.state, batch.seen)
            self._tables = tuple(ArrayTable(part) for part in parts)
        self._weights_of_matches[list(rows)] = self._weights
        self.done[list(rows)] = False
        self._is_new[list(rows)] = True

    def set_rewards(self, weights: Mapping[str, float]) -> None:
        """Set the weights of the same reward terms for the matches that start from now on."""
        self._weights = RewardSum(weights).term_arrays.weight

    def read(
        self, batch: "Batch", view: Callable[[int], MatchInBatch]
    ) -> tuple[Observation, NDArray[np.float32]]:
        """Return the observations, and the rows with rewards and events since the last call.

        Args:
            batch: The matches.
            view: Returns the view of a match by its index.

        Returns:
            The observations by name (B, S, …), or (B, S, n) if they are flat; and (B, S, width) rows. The
            arrays are not reused.
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
        rows = np.empty((*self.done.shape, self.layout.width), np.float32)
        found: Readings = {name: rows[..., first:last] for name, first, last in self.layout.groups}
        self._sensors.begin(batch, view, found)
        _ = batch.seen  # updates the arrays to which the table points
        agents, supplies, matches, seen = (table.addresses for table in self._tables)
        write_rows(agents, supplies, matches, seen, self._workspace.addresses, rows)
        self._workspace, self._next_workspace = self._next_workspace, self._workspace
        if self._flattener is None:
            return found, rows
        self.finish_reading()
        return self._flattener.flatten(found, axes=2), rows

    def finish_reading(self) -> None:
        """Complete the images of the last observations."""
        self._sensors.finish()
