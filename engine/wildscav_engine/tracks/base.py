"""What every track is: its action set, how it is set up, and what it measures."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol

from wildscav_engine.actions import Field
from wildscav_engine.spec import MatchSpec, SupplyConfig

if TYPE_CHECKING:
    from wildscav_engine.match import Match

MOVES = frozenset({Field.WALK_DIRECTION, Field.WALK_SPEED, Field.TURN, Field.LOOK, Field.JUMP})


class Metric(NamedTuple):
    """One figure of a seat's result."""

    name: str
    title: str
    unit: str
    lower_is_better: bool


class Track(Protocol):
    """A kind of match."""

    name: str
    title: str
    fields: frozenset[Field]  # the action set; other fields of an action are ignored
    metrics: tuple[Metric, ...]  # the first is the score
    has_target: bool  # whether reaching the target ends the match

    def supplies(self, spec: MatchSpec) -> SupplyConfig | None:
        """Return where supplies lie, None for a track without any."""
        ...

    def measure(self, match: "Match", seat: int) -> Mapping[str, float]:
        """Return a seat's value of every metric, for a match that is over (or as it stands)."""
        ...
