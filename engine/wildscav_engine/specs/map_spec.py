"""Everything that a map is a function of."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from wildscav_engine.specs.base import Seed, Spec
from wildscav_engine.specs.supply_config import Ascending, SupplyConfig

Storeys = Annotated[int, Field(ge=1, le=4)]
Side = Annotated[float, Field(gt=0, le=2000)]  # m


class Placement(Spec):
    """An object, or an area of vegetation or rocks, that is placed on a map by hand."""

    kind: Literal["house", "block", "tree", "bush", "rock"]  # trees, bushes and rocks may fill an area
    location: tuple[float, float]  # x, z in m, of its center
    area: tuple[Side, Side] | None = None  # m; a block needs one; None: one plant or rock, or a drawn size
    orientation: Annotated[float, Field(ge=-360, le=360)] = 0.0  # degrees, the yaw of its front
    storeys: Storeys | None = None  # of a house; None: drawn by the generator
    height: Annotated[float, Field(gt=0, le=30)] = 2.0  # m, of a block
    density: Annotated[float, Field(gt=0, le=1)] = 0.5  # of trees, bushes and rocks in an area; 1: densest


Pieces = Annotated[Literal["all", "seen", "unseen"], Field(exclude_if=lambda pieces: pieces == "all")]
Share = Annotated[float, Field(ge=0, le=1)]


class Country(Spec):
    """Country that must be seen to be crossed: wards behind barriers, with few ways through.

    Each of the four kinds of barriers has a weight: its share of the wards if the weights add up to 1.
    """

    ward: Annotated[int, Field(ge=20, le=100)] = 26  # m, approximate side of a ward
    loops: Share = 0.1  # of the barriers that could stay closed: with a way through, so that ways form loops
    walls: Share = 1.0  # gardens and yards: walls of 2.5 m with gates
    thickets: Share = 1.0  # woods: hedges and trees too dense to walk through, with gaps
    canyons: Share = 1.0  # ridges of rock of 5 to 8 m, with passes
    terraces: Share = 1.0  # ground on three levels with cliffs of 4 or 8 m between them, and ramps
    towns: Annotated[int, Field(ge=0, le=16)] = 1  # number: walled, level, with narrow streets and dead ends
    hidden_targets: bool = True  # upstairs, in back rooms, at dead ends; ways of 1.5 straight lines at least

    @model_validator(mode="after")
    def _has_barriers(self) -> Self:
        if self.walls + self.thickets + self.canyons + self.terraces == 0:
            raise ValueError("walls, thickets, canyons and terraces are all 0: one of them must be above 0")
        return self


Barriers = Annotated[Country | None, Field(exclude_if=lambda country: country is None)]
Digest = Annotated[str, Field(pattern="^[0-9a-f]{32}$")]


class MapConfig(Spec):
    """The settings of the map generator. Together with a seed, they determine exactly one map."""

    size: Annotated[int, Field(ge=40, le=2000, multiple_of=2)] = 100  # m, length of each side
    relief: Annotated[float, Field(ge=0, le=2)] = 1.0  # 0 flat, 1 hills, 2 mountains
    ruggedness: Annotated[float, Field(ge=0, le=1)] = 0.4  # 0 smooth downs and plains, 1 ridges and cliffs
    water: Annotated[float, Field(ge=0, le=0.4)] = 0.08  # approximate share of the area under lakes
    houses: Annotated[int, Field(ge=0, le=200)] = 4  # in addition to those placed by hand
    density: Literal["low", "high"] = "low"  # scattered houses, or houses close together along streets
    storeys: Annotated[tuple[Storeys, Storeys], Ascending] = (1, 2)  # of houses: the fewest and the most
    vegetation: Annotated[float, Field(ge=0, le=1)] = 0.4  # 0 bare, 1 dense woods
    country: Barriers = None  # with few ways through, and targets that are hard to get at; None: open country
    # So that maps for testing can hold pieces that no map for training holds:
    pieces: Pieces = "all"  # types of houses and plans of towns: all, or those of one of two halves
    placements: Annotated[tuple[Placement, ...], Field(max_length=1000)] = ()  # objects at given locations
    base: Digest | None = None  # an imported height map or mesh to build on; None: generated terrain
    supplies: SupplyConfig | None = None  # of matches whose own spec has none; None: the track's default


class MapSpec(Spec):
    """One map."""

    config: MapConfig = MapConfig()
    seed: Seed = 0
