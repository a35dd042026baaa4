"""Navigation: walk from a random start to a random target as fast as possible."""

from typing import TYPE_CHECKING

import numpy as np

from wildscav_engine.rules import FRAME
from wildscav_engine.spec import MatchSpec
from wildscav_engine.tracks.base import MOVES, Metric

if TYPE_CHECKING:
    from wildscav_engine.match import Match

PUNISHED_SPEED = 10.0  # m/s: a target not reached costs twice the time that the way left takes at this speed


class Navigation:
    """The target reached within the time limit: used time. Not reached: plus 2 · distance left / 10 s.

    With several agents it is a race: the first at the target ends the match for all. Whoever is there in the
    same frame has reached it, too.
    """

    name = "navigation"
    title = "Navigation"
    fields = MOVES
    has_target = True
    has_supplies = False
    metrics = (
        Metric("time", "used + punish time", "s", lower_is_better=True),
        Metric("used_time", "used time", "s", lower_is_better=True),
        Metric("punish_time", "punish time", "s", lower_is_better=True),
        Metric("success", "success rate", "", lower_is_better=False),
    )

    def supplies(self, spec: MatchSpec) -> None:
        """Return None: there are no supplies."""

    def measure(self, match: "Match", seat: int) -> dict[str, float]:
        """Return used and punish time, their sum, and whether this seat reached the target."""
        reached = bool(match.state.agents.reached[0, seat])
        used = match.frame * FRAME
        way = match.state.matches.target[0] - match.state.agents.position[0, seat]
        distance = float(np.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]))
        punish = 0.0 if reached else 2.0 * distance / PUNISHED_SPEED
        return {
            "time": used + punish,
            "used_time": used,
            "punish_time": punish,
            "success": float(reached),
        }
