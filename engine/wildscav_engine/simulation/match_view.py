"""What sensors and tracks read of a match: a match on its own, or one row of a batch."""

from typing import Protocol

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.state import State
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.specs.match_spec import MatchSpec


class MatchView(Protocol):
    """A match as it stands now."""

    @property
    def spec(self) -> MatchSpec:
        """The match."""

    @property
    def game_map(self) -> GameMap:
        """Its map."""

    @property
    def seats(self) -> int:
        """How many seats there are."""

    @property
    def state(self) -> State:
        """The state, with a leading axis of length one."""

    @property
    def seen(self) -> Seen:
        """What every agent sees now, with a leading axis of length one."""

    @property
    def frame(self) -> int:
        """Frames played so far."""
