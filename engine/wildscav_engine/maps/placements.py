"""The placements of a config: houses, blocks, trees, bushes and rocks at given locations."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import Pose, allocate_ring_stacks, box, pose, solids_of
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.ground.terrain import LEVEL_MARGIN, Terrain, distance_to_footprint, room_of_join
from wildscav_engine.maps.house import HousePlan, draw_plan
from wildscav_engine.maps.settlements.footprints import Site, footprints_of, gap_between, heights_under
from wildscav_engine.maps.settlements.plots import EDGE_MARGIN, SHARED_LEVEL, SHORE_MARGIN
from wildscav_engine.maps.settlements.streets import height_at
from wildscav_engine.maps.vegetation.growing_ground import (
    BUSHES,
    ROCKS,
    TREES,
    Fields,
    GrowingGround,
    land_of,
    shores,
)
from wildscav_engine.maps.vegetation.planting import conifers
from wildscav_engine.maps.vegetation.scatter import Spots, allocate_spots, place_one, scatter
from wildscav_engine.maps.vegetation.species import PARTS, grow
from wildscav_engine.specs.map_spec import MapConfig, Placement

NUMBER = 10_000  # of the first placed house; random ones are numbered from 0
LEAST_GAP = 1.5  # m between two houses, so that bodies can walk between them
STEEPEST_GROUND = 8.0  # m, greatest difference of natural heights under a house
ROOT = 0.6  # m that a block reaches into the lowest ground under it
PLANT_MARGIN = 0.5  # m between the axis of a single plant and the edge of the map
YARD = 3.0  # m around a house that an area of plants leaves free, in addition to the usual margin
CATEGORIES = {"tree": TREES, "bush": BUSHES, "rock": ROCKS}
THICKEST = {"tree": 0.04, "bush": 0.1, "rock": 0.06}  # per m², of an area with density 1
# The first key of the plants of the first placement, and how many keys each placement has.
FIRST_KEY, KEYS = 2**28, 2**18


def fixed_houses(config: MapConfig, seed: int, terrain: Terrain) -> tuple[list[HousePlan], list[Site]]:
    """Draw the placed houses of a config.

    Args:
        terrain: Before any ground is levelled.

    Returns:
        The plan and the site of each, in their order.

    Raises:
        MapError: A house does not fit at its location.
    """
    plans: list[HousePlan] = []
    sites: list[Site] = []
    numbers: list[int] = []
    for number, placed in _of_kinds(config, "house"):
        plan, site = _draw_house(config, seed, number, placed)
        _check_inside(config, number, site.pose, site.size, EDGE_MARGIN)
        _check_apart(number, site, numbers, sites)
        sites.append(site._replace(ground=_level(number, site, sites, terrain)))
        plans.append(plan)
        numbers.append(number)
    return plans, sites


def _of_kinds(config: MapConfig, *kinds: str) -> Iterator[tuple[int, Placement]]:
    return ((number, placed) for number, placed in enumerate(config.placements) if placed.kind in kinds)


def _draw_house(config: MapConfig, seed: int, number: int, placed: Placement) -> tuple[HousePlan, Site]:
    """Return the plan of a house, and its site, whose height is determined later."""
    storeys = (placed.storeys, placed.storeys) if placed.storeys else config.storeys
    try:
        plan = draw_plan(seed, NUMBER + number, storeys, area=placed.area)
    except MapError as error:
        raise MapError(f"placements.{number}.{error}") from None
    return plan, Site(pose(*placed.location, placed.orientation), placed.orientation, plan.size, 0.0)


def _check_inside(
    config: MapConfig, number: int, where: Pose, size: tuple[float, float], margin: float
) -> None:
    """Raise MapError if a rectangle leaves the map; the message says where its middle could be."""
    half = config.size / 2.0 - margin
    x_limit = half - (abs(where.cosine) * size[0] + abs(where.sine) * size[1]) / 2.0
    z_limit = half - (abs(where.sine) * size[0] + abs(where.cosine) * size[1]) / 2.0
    if abs(where.x) <= x_limit and abs(where.z) <= z_limit:
        return
    extent = f"{size[0]:.1f} × {size[1]:.1f} m this way round"
    if min(x_limit, z_limit) < 0.0:
        raise MapError(
            f"placements.{number}.area: {extent} do not fit on a map of {config.size} m; "
            f"a side can be 0 to {2.0 * half:.0f} m"
        )
    of_size = f"with {extent} " if max(size) > 0.0 else ""
    # Rounded inwards, so that all values in the stated range work.
    x_limit, z_limit = np.floor(100.0 * x_limit) / 100.0, np.floor(100.0 * z_limit) / 100.0
    raise MapError(
        f"placements.{number}.location is {(where.x, where.z)}: outside the map; {of_size}"
        f"x can be {-x_limit:.2f} to {x_limit:.2f} and z {-z_limit:.2f} to {z_limit:.2f}"
    )


def _check_apart(number: int, site: Site, numbers: Sequence[int], sites: Sequence[Site]) -> None:
    mine = np.array(site.footprint)
    for other, footprint in zip(numbers, footprints_of(sites), strict=True):
        gap = gap_between(mine, footprint)
        if gap == 0.0:
            raise MapError(f"placements.{number}: overlaps placements.{other}")
        if gap < LEAST_GAP:
            raise MapError(
                f"placements.{number}: is {gap:.2f} m from placements.{other}; "
                f"two houses are at least {LEAST_GAP} m apart"
            )


def _level(number: int, site: Site, sites: Sequence[Site], terrain: Terrain) -> float:
    """Return the ground level in m for a placed house; near others it equals theirs, or nearly so."""
    footprint = np.array(site.footprint)
    lowest, highest, mean = heights_under(terrain, footprint)
    least = terrain.water_level + SHORE_MARGIN
    if lowest < least:
        raise MapError(
            f"placements.{number}.location is {(site.pose.x, site.pose.z)}: the house would stand in water; "
            f"its lowest ground is at {lowest:.2f} m, must be at {least:.2f} m or more"
        )
    if highest - lowest > STEEPEST_GROUND:
        raise MapError(
            f"placements.{number}.location is {(site.pose.x, site.pose.z)}: too steep for a house; "
            f"the ground differs by {highest - lowest:.1f} m, can differ by 0 to {STEEPEST_GROUND:.0f} m"
        )
    least, most = -np.inf, np.inf
    for other, row in zip(sites, footprints_of(sites), strict=True):
        gap = gap_between(footprint, row)
        room = 0.0 if gap < SHARED_LEVEL else room_of_join(gap - 2.0 * LEVEL_MARGIN)
        least, most = max(least, other.ground - room), min(most, other.ground + room)
    if least > most:
        raise MapError(
            f"placements.{number}.location is {(site.pose.x, site.pose.z)}: the houses around it stand too "
            f"high and too low for one between them, which would have to be at {least:.1f} m or more for one "
            f"of them and at {most:.1f} m or less for another"
        )
    return float(min(max(mean, least), most))


def placed_solids(config: MapConfig, seed: int, terrain: Terrain) -> list[Solid]:
    """Return the solids of the placed blocks, trees, bushes and rocks of a config.

    Args:
        terrain: With levelled ground.

    Raises:
        MapError: Something is placed outside the map, in water, in a house, or without the area it needs.
    """
    blocks = [_block(config, number, placed, terrain) for number, placed in _of_kinds(config, "block")]
    plants = list(_of_kinds(config, *CATEGORIES))
    if not plants:
        return blocks
    wanted = [1 if placed.area is None else _count(placed, placed.area) for _, placed in plants]
    spots = allocate_spots(config.size, sum(wanted))
    found = _place_plants(config, seed, terrain, list(zip(plants, wanted, strict=True)), spots)
    stacks = allocate_ring_stacks(PARTS * found)
    return blocks + solids_of(stacks, grow(spots.rows, found, stacks))


def _count(placed: Placement, area: tuple[float, float]) -> int:
    return max(1, min(KEYS, int(THICKEST[placed.kind] * placed.density * area[0] * area[1] + 0.5)))


def _block(config: MapConfig, number: int, placed: Placement, terrain: Terrain) -> Solid:
    """Return a box with the given height above the ground in its middle; it reaches into all ground below."""
    if placed.area is None:
        raise MapError(f"placements.{number}.area: a block needs one, 0 to {config.size} m across and along")
    where = pose(*placed.location, placed.orientation)
    _check_inside(config, number, where, placed.area, 0.0)
    across, along = placed.area[0] / 2.0, placed.area[1] / 2.0
    lowest = heights_under(terrain, np.array((*where, across, along)))[0]
    ground = height_at(terrain, where.x, where.z)
    low, high = (-across, lowest - ROOT, -along), (across, ground + placed.height, along)
    return box(Kind.WALL, where, low, high)


def _place_plants(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    plants: list[tuple[tuple[int, Placement], int]],
    spots: Spots,
) -> int:
    """Place single plants, then fill areas around them; return the number of plants."""
    houses = [
        (number, _draw_house(config, seed, number, placed)[1])
        for number, placed in _of_kinds(config, "house")
    ]
    land = _land(config, seed, terrain, footprints_of([site for _, site in houses]))
    found = 0
    for (number, placed), _ in plants:
        if placed.area is None:
            _check_single(config, number, placed, terrain, houses)
            key, (x, z) = FIRST_KEY + number * KEYS, placed.location
            place_one(np.uint64(seed), key, CATEGORIES[placed.kind], x, z, land, spots, found)
            found += 1
    for (number, placed), wanted in plants:
        if placed.area is not None:
            where = pose(*placed.location, placed.orientation)
            _check_inside(config, number, where, placed.area, 0.0)
            area = np.array((*where, placed.area[0] / 2.0, placed.area[1] / 2.0))
            key, category = FIRST_KEY + number * KEYS, CATEGORIES[placed.kind]
            found = scatter(np.uint64(seed), key, category, wanted, area, land, spots, found)
    return found


def _land(config: MapConfig, seed: int, terrain: Terrain, houses: NDArray[np.float64]) -> GrowingGround:
    """Return the ground where areas may be filled: everywhere except in water, at houses and at blocks."""
    blocks = [
        (*pose(*placed.location, placed.orientation), placed.area[0] / 2.0, placed.area[1] / 2.0)
        for _, placed in _of_kinds(config, "block")
        if placed.area
    ]
    yards = houses.copy()
    yards[:, 4:] += YARD
    woods = conifers(config, seed, terrain)
    fields = Fields(np.ones((len(CATEGORIES), *woods.shape)), woods, shores(terrain, len(woods)))
    taken = np.array(blocks, np.float64).reshape(-1, 6)
    return land_of(terrain, yards, taken, np.zeros((0, 2)), np.zeros((0, 4)), fields)


def _check_single(
    config: MapConfig, number: int, placed: Placement, terrain: Terrain, houses: list[tuple[int, Site]]
) -> None:
    """Raise MapError if a single plant has no ground to stand on."""
    x, z = placed.location
    _check_inside(config, number, pose(x, z, 0.0), (0.0, 0.0), PLANT_MARGIN)
    ground = height_at(terrain, x, z)
    if ground < terrain.water_level:
        raise MapError(
            f"placements.{number}.location is {(x, z)}: in water; its ground is at {ground:.2f} m, "
            f"must be at {terrain.water_level:.2f} m or more"
        )
    for other, site in houses:
        if distance_to_footprint(np.array(site.footprint), x, z) < PLANT_MARGIN:
            raise MapError(f"placements.{number}: stands in the house of placements.{other}")
