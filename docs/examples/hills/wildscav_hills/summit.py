"""Summit: stand as high as possible when the time is up."""

from typing import ClassVar

from wildscav_engine.simulation.match_view import MatchView
from wildscav_engine.simulation.track import MOVES, PAPER_DEPTH, Metric, Sensors, Track


class Summit(Track):
    """The height above the sea at the end; the way walked is told."""

    name: ClassVar[str] = "summit"
    title: ClassVar[str] = "Summit"
    fields = MOVES
    rewards: ClassVar[dict[str, float]] = {"walked": 0.1}
    robot: ClassVar[str] = "walker"
    learners: ClassVar[int] = 2
    opponents: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    sensors: ClassVar[Sensors] = PAPER_DEPTH | {"odometer": {}}
    metrics = (
        Metric("height", "height", "m", lower_is_better=False),
        Metric("walked", "way walked", "m", lower_is_better=True),
    )

    def measure(self, match: MatchView, seat: int) -> dict[str, float]:
        """Return where the seat stands, and how far it walked."""
        agents = match.state.agents
        return {
            "height": float(agents.position[0, seat, 1]),
            "walked": float(agents.walked[0, seat]),
        }
