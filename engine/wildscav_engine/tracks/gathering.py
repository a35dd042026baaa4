"""Supply gathering: collect as many supplies as possible within the time limit."""

from typing import TYPE_CHECKING

from wildscav_engine.actions import Field
from wildscav_engine.spec import MatchSpec, SupplyConfig, SupplyWave
from wildscav_engine.tracks.base import MOVES, Metric

if TYPE_CHECKING:
    from wildscav_engine.match import Match


class Gathering:
    """The supplies that a seat carries at the end."""

    name = "gathering"
    title = "Supply gathering"
    fields = MOVES | {Field.PICK_UP}
    has_target = False
    has_supplies = True
    metrics = (Metric("supplies", "supplies", "", lower_is_better=False),)

    def supplies(self, spec: MatchSpec) -> SupplyConfig:
        """Return the spec's supplies, or the map's, or one wave around the middle of the map."""
        return (
            spec.supplies
            or spec.map.config.supplies
            or SupplyConfig(
                waves=(SupplyWave(center=(0.0, 0.0), radius=max(10.0, spec.map.config.size / 4)),),
                spacing=5.0,
            )
        )

    def measure(self, match: "Match", seat: int) -> dict[str, float]:
        """Return the supplies carried."""
        return {"supplies": float(match.state.agents.supplies[0, seat])}
