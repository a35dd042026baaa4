"""What a config places by hand: houses, blocks, trees, bushes and rocks."""

from collections.abc import Iterator, Sequence

import numpy as np

from wildscav_engine.geometry.shapes import Pose, box, pose
from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.footprints import (
    Site,
    footprint_of_placement,
    footprints_of,
    gap_between,
    heights_under,
)
from wildscav_engine.maps.house import HousePlan, draw_plan
from wildscav_engine.maps.plots import EDGE_MARGIN, SHORE_MARGIN
from wildscav_engine.maps.streets import height_at
from wildscav_engine.maps.terrain import LEVEL_MARGIN, Terrain
from wildscav_engine.spec import MapConfig, Placement

NUMBER = 10_000  # of the first house placed by hand; those of the generator count from 0
LEAST_GAP = 1.5  # m between two houses, so that one walks between them
STEEPEST_GROUND = 8.0  # m, greatest difference of natural heights under a house
ROOT = 0.6  # m that a block reaches into the lowest ground under it


def fixed_houses(config: MapConfig, seed: int, terrain: Terrain) -> tuple[list[HousePlan], list[Site]]:
    """Draw the houses that a config places by hand.

    Args:
        config: Of the map.
        seed: Of the map.
        terrain: Before any ground is levelled.

    Returns:
        The plan and the site of each, in their order.

    Raises:
        MapError: A house does not fit where it is placed.
    """
    plans: list[HousePlan] = []
    sites: list[Site] = []
    numbers: list[int] = []
    for number, placed in _of_kinds(config, "house"):
        storeys = (placed.storeys, placed.storeys) if placed.storeys else config.storeys
        plan = draw_plan(seed, NUMBER + number, storeys)
        where = pose(*placed.location, placed.orientation)
        _check_inside(config, number, where, plan.size, EDGE_MARGIN)
        site = Site(where, placed.orientation, plan.size, 0.0)
        _check_apart(number, site, numbers, sites)
        sites.append(site._replace(ground=_level(number, site, sites, terrain)))
        plans.append(plan)
        numbers.append(number)
    return plans, sites


def _of_kinds(config: MapConfig, *kinds: str) -> Iterator[tuple[int, Placement]]:
    return ((number, placed) for number, placed in enumerate(config.placements) if placed.kind in kinds)


def _check_inside(
    config: MapConfig, number: int, where: Pose, size: tuple[float, float], margin: float
) -> None:
    """Raise MapError where a rectangle leaves the map, and say from where to where its middle could be."""
    half = config.size / 2.0 - margin
    reach_x = (abs(where.cosine) * size[0] + abs(where.sine) * size[1]) / 2.0
    reach_z = (abs(where.sine) * size[0] + abs(where.cosine) * size[1]) / 2.0
    if abs(where.x) + reach_x <= half and abs(where.z) + reach_z <= half:
        return
    what = f"{size[0]:.1f} × {size[1]:.1f} m"
    if max(reach_x, reach_z) > half:
        raise MapError(f"placements.{number}.area: {what} do not fit on a map of {config.size} m")
    raise MapError(
        f"placements.{number}.location is {(where.x, where.z)}: with {what} it reaches over the edge of the map; "
        f"x can be {-(half - reach_x):.2f} to {half - reach_x:.2f}, z {-(half - reach_z):.2f} to {half - reach_z:.2f}"
    )


def _check_apart(number: int, site: Site, numbers: Sequence[int], sites: Sequence[Site]) -> None:
    mine = np.array(site.footprint)
    for other, footprint in zip(numbers, footprints_of(sites), strict=True):
        gap = gap_between(mine, footprint)
        if gap == 0.0:
            raise MapError(f"placements.{number}: overlaps placements.{other}")
        if gap < LEAST_GAP:
            raise MapError(
                f"placements.{number}: is {gap:.2f} m from placements.{other}; houses are {LEAST_GAP} m apart or more"
            )


def _level(number: int, site: Site, sites: Sequence[Site], terrain: Terrain) -> float:
    """Return the level in m for a house placed by hand; near others it is theirs."""
    footprint = np.array(site.footprint)
    lowest, highest, mean = heights_under(terrain.corner, terrain.heights, footprint)
    if lowest < terrain.water_level + SHORE_MARGIN:
        raise MapError(
            f"placements.{number}.location: the house would stand in water; its lowest ground is at {lowest:.2f} m, "
            f"must be at {terrain.water_level + SHORE_MARGIN:.2f} m or higher"
        )
    if highest - lowest > STEEPEST_GROUND:
        raise MapError(
            f"placements.{number}.location: the ground under the house differs by {highest - lowest:.1f} m, "
            f"may differ by 0 to {STEEPEST_GROUND:.0f} m"
        )
    for other, row in zip(sites, footprints_of(sites), strict=True):
        if gap_between(footprint, row) < 2.0 * LEVEL_MARGIN + 0.5:
            return other.ground
    return mean


def placed_solids(config: MapConfig, seed: int, terrain: Terrain) -> list[Solid]:
    """Return the blocks, trees, bushes and rocks that a config places by hand.

    Args:
        config: Of the map.
        seed: Of the map.
        terrain: With levelled ground.

    Returns:
        The solids.

    Raises:
        MapError: Something is placed outside the map, in water, or without the area that it needs.
    """
    return [_block(config, number, placed, terrain) for number, placed in _of_kinds(config, "block")]


def _block(config: MapConfig, number: int, placed: Placement, terrain: Terrain) -> Solid:
    if placed.area is None:
        raise MapError(f"placements.{number}.area: a block needs one, 0 to {config.size} m across and along")
    where = pose(*placed.location, placed.orientation)
    _check_inside(config, number, where, placed.area, 0.0)
    lowest = heights_under(terrain.corner, terrain.heights, np.array(footprint_of_placement(placed)))[0]
    ground = height_at(terrain.corner, terrain.heights, where.x, where.z)
    across, along = placed.area[0] / 2.0, placed.area[1] / 2.0
    low, high = (-across, lowest - ROOT, -along), (across, ground + placed.height, along)
    return box(Kind.WALL, where, low, high)
