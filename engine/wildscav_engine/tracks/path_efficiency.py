"""SPL: success weighted by path length.

Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018: the mean over episodes of
success · shortest / max(walked, shortest), where ``shortest`` is the length of the shortest way and
``walked`` that of the agent's.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wildscav_engine.simulation.track import Metric

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

SPL = Metric("spl", "SPL", "", lower_is_better=False)


def spl_of(match: "MatchView", seats: Sequence[int]) -> float:
    """Return the SPL of some seats that search for a target together, 0–1.

    The shortest way is that of the seat that has the shortest one, as with several equal targets in the field
    (Batra et al., "ObjectNav Revisited", 2020). It is compared with the way of the seat that reached the
    target; if several did in the same frame, with the shortest of theirs.

    Args:
        match: The match.
        seats: Those of a team, or a single one.
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
