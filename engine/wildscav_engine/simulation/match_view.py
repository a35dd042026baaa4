"""The view of a match that sensors and tracks read: a single match, or one match of a batch."""

from typing import Protocol

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.state import State
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.specs.match_spec import MatchSpec


class MatchView(Protocol):
    """The present state of a match."""

    @property
    def spec(self) -> MatchSpec:
        """The spec of the match."""

    @property
    def game_map(self) -> GameMap:
        """Its map."""

    @property
    def seats(self) -> int:
        """The number of seats."""

    @property
    def state(self) -> State:
        """The state, with a leading axis of length one."""

    @property
    def seen(self) -> Seen:
        """What each agent sees now, with a leading axis of length one."""

    @property
    def frame(self) -> int:
        """The number of frames played."""
