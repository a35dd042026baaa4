"""Pace: how fast a seat walked on the average."""

from typing import ClassVar

from wildscav_engine.simulation.match_view import MatchView
from wildscav_engine.simulation.track import Measure, Metric
from wildscav_engine.specs.rules import FRAME


class Pace(Measure):
    """The way walked over the time played."""

    metric: ClassVar[Metric] = Metric("pace", "pace", "m/s", lower_is_better=False)

    def measure(self, match: MatchView, seat: int) -> float:
        """Return m/s."""
        return float(match.state.agents.walked[0, seat]) / max(FRAME, match.frame * FRAME)
