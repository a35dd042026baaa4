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

    @property
    def name(self) -> str:
        """The word for it in specs, commands and files."""
        ...

    @property
    def title(self) -> str:
        """What a person reads."""
        ...

    @property
    def fields(self) -> frozenset[Field]:
        """The action set; other fields of an action are ignored."""
        ...

    @property
    def metrics(self) -> tuple[Metric, ...]:
        """What is measured; the first is the score."""
        ...

    @property
    def has_target(self) -> bool:
        """Whether reaching the target ends the match."""
        ...

    @property
    def has_supplies(self) -> bool:
        """Whether there are supply boxes."""
        ...

    def supplies(self, spec: MatchSpec) -> SupplyConfig | None:
        """Return where supplies lie, None for a track without any."""
        ...

    def measure(self, match: "Match", seat: int) -> Mapping[str, float]:
        """Return a seat's value of every metric, for a match that is over (or as it stands)."""
        ...
