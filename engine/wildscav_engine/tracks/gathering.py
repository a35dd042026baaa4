"""Supply gathering: collect as many supplies as possible in the time limit, or a given number quickly."""

import functools
from typing import TYPE_CHECKING, ClassVar

from wildscav_engine.simulation.track import (
    MOVES,
    PAPER_DEPTH,
    SUPPLIES_SEEN,
    Metric,
    Sensors,
    Track,
    carried_by_team,
)
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAME
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView


class Gathering(Track):
    """Scored by the supplies that a seat's team carries at the end, with any number of teams.

    With a supply goal in the spec, the first team that carries that many ends the match, and time counts.
    """

    name: ClassVar[str] = "gathering"
    title: ClassVar[str] = "Supply gathering"
    fields = MOVES | {Field.PICK_UP}
    has_supplies: ClassVar[bool] = True
    has_supply_goal: ClassVar[bool] = True
    rewards: ClassVar[dict[str, float]] = {"supply_found": 1.0}
    robot: ClassVar[str] = "gatherer"
    learners: ClassVar[int] = 4
    time_limit: ClassVar[float] = 180.0
    sensors: ClassVar[Sensors] = PAPER_DEPTH | SUPPLIES_SEEN
    metrics = (
        Metric("supplies", "supplies", "", lower_is_better=False),
        Metric("own_supplies", "own supplies", "", lower_is_better=False),
        Metric("time", "time", "s", lower_is_better=True),
    )

    def supplies(self, spec: MatchSpec) -> SupplyConfig:
        """Return the supplies of the spec, else of the map, else one wave around the center of the map."""
        return spec.supplies or spec.map.config.supplies or _around_center(spec.map.config.size)

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the supplies that the team and the seat carry, and the time of the match."""
        return {
            "supplies": carried_by_team(match, seat),
            "own_supplies": float(match.state.agents.supplies[0, seat]),
            "time": match.frame * FRAME,
        }


@functools.lru_cache(maxsize=64)
def _around_center(size: int) -> SupplyConfig:
    return SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), radius=max(10.0, size / 4)),), spacing=5.0)
