"""Navigation: walk from a random start to a random target as fast as possible."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from wildscav_engine.simulation.track import MOVES, Metric, Track
from wildscav_engine.specs.rules import FRAME

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

PENALTY_SPEED = 10.0  # m/s: missing the target costs twice the time that the rest takes at this speed
SPL = Metric("spl", "SPL", "", lower_is_better=False)


class Navigation(Track):
    """Scored by the time used; if the target is not reached, plus 2 · distance left / 10 m/s.

    With several teams it is a race: the first agent at the target ends the match for all. Agents that arrive
    in the same frame have also reached it.
    """

    name: ClassVar[str] = "navigation"
    title: ClassVar[str] = "Navigation"
    fields = MOVES
    has_target: ClassVar[bool] = True
    rewards: ClassVar[dict[str, float]] = {"target_reached": 1.0}
    robot: ClassVar[str] = "seeker"
    learners: ClassVar[int] = 2
    metrics = (
        Metric("time", "used + punish time", "s", lower_is_better=True),
        Metric("used_time", "used time", "s", lower_is_better=True),
        Metric("punish_time", "punish time", "s", lower_is_better=True),
        Metric("success", "success rate", "", lower_is_better=False),
    )
    slow_metrics = (SPL,)

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the used time, the punish time, their sum, and whether this seat reached the target."""
        return time_to_target(match, [seat])

    def measure_slow(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the seat's success weighted by its path length."""
        return {SPL.name: spl_of(match, [seat])}


def time_to_target(match: "MatchView", seats: list[int]) -> dict[str, float]:
    """Return the used time, the punish time, their sum and success, for the best of some seats."""
    agents = match.state.agents
    reached = bool(agents.reached[0, seats].any())
    used = match.frame * FRAME
    offsets = match.state.matches.target[0] - agents.position[0, seats]
    distance = min(float(np.sqrt(x * x + y * y + z * z)) for x, y, z in offsets)
    punish = 0.0 if reached else 2.0 * distance / PENALTY_SPEED
    return {
        "time": used + punish,
        "used_time": used,
        "punish_time": punish,
        "success": float(reached),
    }


def spl_of(match: "MatchView", seats: Sequence[int]) -> float:
    """Return the SPL of some seats that search for a target together, 0–1.

    The shortest way is that of the seat that has the shortest one, as with several equal targets in the field
    (Batra et al., "ObjectNav Revisited", 2020). It is compared with the way of the seat that reached the
    target; if several did in the same frame, with the shortest of theirs.
    """
    agents = match.state.agents
    walked = [float(agents.walked[0, seat]) for seat in seats if agents.reached[0, seat]]
    if not walked:
        return 0.0
    shortest = _shortest_way(match, seats)
    longer = max(shortest, min(walked))
    return shortest / longer if longer > 0.0 else 1.0


def _shortest_way(match: "MatchView", seats: Sequence[int]) -> float:
    """Return the length in m of the shortest way from any of the seats' starts to the target."""
    target, reach = match.state.matches.target[0], match.spec.rules.target_distance
    offsets = match.state.agents.start[0, list(seats)] - target
    # In the order of the straight lines, so that most of the others need no search.
    straight = sorted((float(x * x + z * z), seat) for (x, _, z), seat in zip(offsets, seats, strict=True))
    shortest = float("inf")
    for square, seat in straight:
        if square < (shortest + reach) * (shortest + reach):
            start = match.state.agents.start[0, seat]
            shortest = min(shortest, match.game_map.shortest_length(start, target, reach))
    return shortest
