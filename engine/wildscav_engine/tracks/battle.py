"""Supply battle: gather supplies in competition with others, who can be shot for what they carry."""

from typing import TYPE_CHECKING, ClassVar

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
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

DEFAULT_SUPPLIES = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), radius=100.0),), spacing=5.0)


class Battle(Track):
    """Scored by the supplies that a seat's team carries at the end. Dead agents respawn."""

    name: ClassVar[str] = "battle"
    title: ClassVar[str] = "Supply battle"
    fields = frozenset(Field)
    has_supplies: ClassVar[bool] = True
    rewards: ClassVar[dict[str, float]] = {"supply_found": 1.0, "kill": 1.0, "death": -1.0}
    robot: ClassVar[str] = "fighter"
    learners: ClassVar[int] = 10
    opponents: ClassVar[int] = 9
    time_limit: ClassVar[float] = 300.0
    sensors: ClassVar[Sensors] = PAPER_DEPTH | SUPPLIES_SEEN | AGENTS_SEEN
    metrics = (
        Metric("supplies", "supplies", "", lower_is_better=False),
        Metric("kills", "kills", "", lower_is_better=False),
        Metric("deaths", "deaths", "", lower_is_better=True),
    )

    def supplies(self, spec: MatchSpec) -> SupplyConfig:
        """Return the supplies of the spec, else of the map, else one wave over the whole map."""
        return spec.supplies or spec.map.config.supplies or DEFAULT_SUPPLIES

    def measure(self, match: "MatchView", seat: int) -> dict[str, float]:
        """Return the supplies that the team carries, and the seat's kills and deaths."""
        agents = match.state.agents
        return {
            "supplies": carried_by_team(match, seat),
            "kills": float(agents.kills[0, seat]),
            "deaths": float(agents.deaths[0, seat]),
        }
