"""Where and when supply boxes appear, and what they hold."""

from typing import Annotated, Any

from pydantic import AfterValidator, Field, SerializerFunctionWrapHandler, ValidationInfo, model_serializer

from wildscav_engine.specs.base import Spec

Percent = Annotated[float, Field(ge=0, le=100)]


def ascending(pair: tuple[int, int], info: ValidationInfo) -> tuple[int, int]:
    """Check the least and the greatest of a range."""
    if pair[0] > pair[1]:
        raise ValueError(f"{info.field_name} is {pair}: the first number must not be above the second")
    return pair


Ascending = AfterValidator(ascending)
# Least and greatest.
Quantities = Annotated[tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(le=1000)]], Ascending]


class SupplyWave(Spec):
    """Supply boxes that appear at the same time, most densely around a center."""

    time: Annotated[float, Field(ge=0, le=86_400)] = 0.0  # s; 0 is the start of the match
    center: tuple[float, float] | None = None  # x, z in m; None: a random indoor location
    radius: Annotated[float, Field(ge=1, le=1000)] = 50.0  # m, standard deviation of the heat map
    outdoor_richness: Annotated[float, Field(ge=0, le=50)] = 20.0  # % of outdoor grid points, at the center
    indoor_richness: Percent = 70.0  # % of the indoor points, which are 5 m apart


class HotSpot(Spec):
    """A rich place that moves: at regular times, the same number of boxes appears around another place."""

    start: Annotated[float, Field(ge=0, le=86_400)] = 0.0  # s, when the first boxes appear
    interval: Annotated[float, Field(ge=1, le=86_400)] = 60.0  # s, after which it moves
    places: Annotated[int, Field(ge=1, le=200)] = 10  # that it visits one after another
    radius: Annotated[float, Field(ge=1, le=100)] = 8.0  # m, standard deviation of the heat map
    boxes: Annotated[int, Field(ge=1, le=200)] = 12  # at each place, as far as there is open ground for them
    quantity: Quantities = (10, 30)  # supplies in a box


class SupplyConfig(Spec):
    """Where supply boxes are and how many supplies they hold."""

    waves: tuple[SupplyWave, ...] = (SupplyWave(center=(0.0, 0.0)),)
    spacing: Annotated[float, Field(ge=1, le=100)] = 10.0  # m, between the points of the outdoor grid
    outdoor_quantity: Quantities = (1, 5)
    indoor_quantity: Quantities = (10, 50)
    hot_spot: HotSpot | None = None  # in addition to the waves; None: there is none

    @model_serializer(mode="wrap")
    def _omit_no_hot_spot(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit ``hot_spot`` if there is none, so that records and digests of other specs do not change."""
        fields: dict[str, Any] = serialize(self)
        if self.hot_spot is None:
            fields.pop("hot_spot", None)
        return fields
