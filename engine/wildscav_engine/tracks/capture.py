"""Target capture: a team searches for a hidden target; the first member to reach it wins for the team."""

from typing import TYPE_CHECKING, ClassVar

from wildscav_engine.simulation.track import MOVES, Track
from wildscav_engine.tracks.navigation import SPL, Navigation, spl_of, time_to_target

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView


class Capture(Track):
    """Scored like navigation, by the teammate who is nearest to the target at the end.

    The position of the target is hidden. An agent that comes within ``target_sight`` of it finds it for its
    whole team. All seats form one team unless the spec defines several, which then race each other.
    """

    name: ClassVar[str] = "capture"
    title: ClassVar[str] = "Target capture"
    fields = MOVES
    has_target: ClassVar[bool] = True
    hides_target: ClassVar[bool] = True
    rewards: ClassVar[dict[str, float]] = {"target_reached": 1.0}
    robot: ClassVar[str] = "seeker"
    learners: ClassVar[int] = 4
    metrics = Navigation.metrics
    slow_metrics = Navigation.slow_metrics

    def teams(self, seats: int) -> tuple[int, ...]:
        """Return one team for all seats."""
        return (0,) * seats

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the used time, the punish time, their sum, and whether the team reached the target."""
        return time_to_target(match, _teammates(match, seat))

    def measure_slow(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the team's success weighted by the path length of the member who reached the target."""
        return {SPL.name: spl_of(match, _teammates(match, seat))}


def _teammates(match: "MatchView", seat: int) -> list[int]:
    """Return the seats of a seat's team, with itself."""
    team = match.spec.team_of_seats
    return [mate for mate in range(match.seats) if team[mate] == team[seat]]
