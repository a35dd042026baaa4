"""A view of one match of a batch, for sensors and tracks."""

from typing import Any, TypeVar

from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.state import State
from wildscav_engine.simulation.systems.visibility import Seen

Arrays = TypeVar("Arrays")


def _some(arrays: Arrays, part: slice) -> Arrays:
    """Return some rows of all arrays of a NamedTuple, as views."""
    fields: Any = arrays
    rows: Arrays = type(fields)(*(array[part] for array in fields))
    return rows


class MatchInBatch:
    """The present state of one match of a batch, as a ``MatchView``."""

    def __init__(self, batch: Batch, row: int) -> None:
        """Create a view of a row, which becomes invalid when the row is restarted."""
        part = slice(row, row + 1)
        agents, supplies, matches = batch.state
        self.spec = batch.specs[row]
        self.game_map = batch.maps[row]
        self.track = batch.track
        self.seats = len(self.spec.seats)
        self.state = State(_some(agents, part), _some(supplies, part), _some(matches, part))
        self._batch, self._part = batch, part

    @property
    def seen(self) -> Seen:
        """What each agent of the match sees now."""
        return _some(self._batch.seen, self._part)

    @property
    def frame(self) -> int:
        """The number of frames played."""
        return int(self.state.matches.frame[0])

    @property
    def over(self) -> bool:
        """Whether the match has ended."""
        return bool(self.state.matches.over[0])
