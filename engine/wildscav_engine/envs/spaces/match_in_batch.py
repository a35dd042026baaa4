"""One match of a batch, as far as sensors and tracks look at a match."""

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


class RowView:
    """One row of a batch that sensors and tracks read like a match (``MatchView``): as it is now."""

    def __init__(self, batch: Batch, row: int) -> None:
        """Look at a row. The view is of no use any more once the row is restarted."""
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
        """What every agent of it sees now."""
        return _some(self._batch.seen, self._part)

    @property
    def frame(self) -> int:
        """Frames played so far."""
        return int(self.state.matches.frame[0])

    @property
    def over(self) -> bool:
        """Whether the match has ended."""
        return bool(self.state.matches.over[0])
