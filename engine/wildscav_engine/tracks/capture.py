"""Target capture: a team looks for a hidden target; the first of them who gets there wins for all."""

from typing import TYPE_CHECKING, ClassVar

from wildscav_engine.simulation.track import MOVES, Track
from wildscav_engine.tracks.navigation import Navigation, time_to_target

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView


class Capture(Track):
    """Scored as navigation is, with the teammate who is nearest to the target at the end.

    Nobody is told where the target is. Whoever comes as near to it as ``target_sight`` finds it, for the
    whole team. All seats are one team unless the spec makes it a race of several.
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

    def teams(self, seats: int) -> tuple[int, ...]:
        """Return one team for all."""
        return (0,) * seats

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return used and punish time, their sum, and whether this seat's team reached the target."""
        team = match.spec.team_of_seats
        return time_to_target(match, [mate for mate in range(match.seats) if team[mate] == team[seat]])
