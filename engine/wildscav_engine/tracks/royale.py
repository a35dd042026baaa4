"""Royale: agents do not respawn, the safe zone shrinks, and the last team standing wins."""

import functools
from typing import TYPE_CHECKING, ClassVar

from wildscav_engine.simulation.systems.elimination import current_placement
from wildscav_engine.simulation.track import (
    AGENTS_SEEN,
    PAPER_DEPTH,
    SUPPLIES_SEEN,
    Metric,
    Sensors,
    Track,
    carried_by_team,
)
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_engine.tracks.battle import Battle

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

WIN = 100.0  # points for the first place
SHARES = (0.6, 0.5, 0.5, 0.4, 0.0)  # each phase's new radius divided by its old one
DAMAGES = (1, 2, 4, 8, 16)  # hp per second outside, in each phase
WAIT, SHRINK = 0.1, 0.08  # of the time limit, in each phase: after nine tenths, the zone is gone


class Royale(Track):
    """Points: from 100 for the first place evenly down to 0 for the last, plus one per supply carried.

    Teams eliminated in the same frame share a placement, and so do those that are left when the time is up.
    """

    name: ClassVar[str] = "royale"
    title: ClassVar[str] = "Royale"
    fields = frozenset(Field)
    has_supplies: ClassVar[bool] = True
    has_zone: ClassVar[bool] = True
    respawns: ClassVar[bool] = False
    rewards: ClassVar[dict[str, float]] = {"outlived": 1.0, "kill": 0.1, "supply_found": 0.1}
    robot: ClassVar[str] = "fighter"
    learners: ClassVar[int] = 10
    opponents: ClassVar[int] = 9
    time_limit: ClassVar[float] = 300.0
    sensors: ClassVar[Sensors] = PAPER_DEPTH | SUPPLIES_SEEN | AGENTS_SEEN | {"zone": {}}
    metrics = (
        Metric("points", "points", "", lower_is_better=False),
        Metric("placement", "placement", "", lower_is_better=True),
        Metric("supplies", "supplies", "", lower_is_better=False),
        Metric("kills", "kills", "", lower_is_better=False),
    )

    def supplies(self, spec: MatchSpec) -> SupplyConfig:
        """Return the supplies that a battle has."""
        return Battle().supplies(spec)

    def zone(self, spec: MatchSpec) -> ZoneConfig:
        """Return the schedule of the spec, or five phases that take nine tenths of the time limit."""
        return spec.zone or _default_zone(spec.time_limit)

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return points, the team's placement and supplies, and the seat's kills."""
        agents, matches = match.state.agents, match.state.matches
        placement = current_placement(
            int(agents.placement[0, seat]), int(matches.teams_left[0]), bool(matches.over[0])
        )
        others = int(matches.teams[0]) - 1
        outlived = (others + 1 - placement) / others if others else 0.0
        supplies = carried_by_team(match, seat)
        return {
            "points": WIN * outlived + supplies,
            "placement": float(placement),
            "supplies": supplies,
            "kills": float(agents.kills[0, seat]),
        }


@functools.lru_cache(maxsize=64)
def _default_zone(time_limit: float) -> ZoneConfig:
    phases = (
        ZonePhase(wait=time_limit * WAIT, shrink=time_limit * SHRINK, share=share, damage=damage)
        for share, damage in zip(SHARES, DAMAGES, strict=True)
    )
    return ZoneConfig(phases=tuple(phases))
