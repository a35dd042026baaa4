"""Where and when supply boxes appear, and what they hold."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from wildscav_engine.specs.base import Spec

Percent = Annotated[float, Field(ge=0, le=100)]


class SupplyWave(Spec):
    """Supply boxes that appear at the same time, most densely around a center."""

    time: Annotated[float, Field(ge=0, le=86_400)] = 0.0  # s; 0 is the start of the match
    center: tuple[float, float] | None = None  # x, z in m; None: a random indoor location
    radius: Annotated[float, Field(ge=1, le=1000)] = 50.0  # m, standard deviation of the heat map
    outdoor_richness: Annotated[float, Field(ge=0, le=50)] = 20.0  # % of outdoor grid points, at the center
    indoor_richness: Percent = 70.0  # % of the indoor points, which are 5 m apart


class SupplyConfig(Spec):
    """Where supply boxes are and how many supplies they hold."""

    waves: tuple[SupplyWave, ...] = (SupplyWave(center=(0.0, 0.0)),)
    spacing: Annotated[float, Field(ge=1, le=100)] = 10.0  # m, between the points of the outdoor grid
    outdoor_quantity: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(le=1000)]] = (1, 5)
    indoor_quantity: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(le=1000)]] = (10, 50)

    @model_validator(mode="after")
    def _quantities_ascend(self) -> Self:
        for name in ("outdoor_quantity", "indoor_quantity"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} is {(low, high)}: the first number must not be above the second")
        return self
