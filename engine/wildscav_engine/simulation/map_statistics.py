"""Statistics of a map: its size, houses, water, plants, locations and supplies."""

from collections import Counter

import numpy as np

from wildscav_engine.geometry.world import CELL, Kind
from wildscav_engine.maps.export.mesh import solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap

SUPPLY_SEED = 0  # seed of the match whose supplies are counted


def map_statistics(game_map: GameMap) -> dict[str, str]:
    """Return a map's statistics by name, as text."""
    config, world = game_map.config, game_map.world
    rows, columns = world.water.shape
    storeys = Counter(house.storeys for house in game_map.houses)
    meshes = [solids_mesh(world), terrain_mesh(world), water_mesh(world)]
    statistics = {
        "size": f"{columns * CELL:g} × {rows * CELL:g} m",
        "seed": str(game_map.spec.seed),
        "digest": game_map.digest,
        "generator version": str(GENERATOR_VERSION),
        "houses": _houses(len(game_map.houses), storeys, config.density),
        "rooms": str(sum(len(house.rooms) for house in game_map.houses)),
        "ground": f"{world.heights.min():.1f} to {world.heights.max():.1f} m high",
        "water": f"{100 * _share_of_water(game_map):.1f} % of the area",
        "plants and rocks": ", ".join(
            f"{_count(game_map, kind)} {name}"
            for kind, name in ((Kind.TRUNK, "trees"), (Kind.BUSH, "bushes"), (Kind.ROCK, "rocks"))
        ),
        "solids": f"{len(world.solid_kind):,} with {len(world.faces):,} faces",
        "triangles": f"{sum(len(mesh.triangles) for mesh in meshes):,}",
        "locations": f"{len(game_map.indoor):,} indoor, {len(game_map.outdoor):,} outdoor",
        "supplies": _supplies(game_map),
    }
    share = getattr(game_map, "reachable_share", None)
    return statistics if share is None else statistics | {"ground that can be walked": f"{100 * share:.1f} %"}


def _houses(houses: int, storeys: Counter[int], density: str) -> str:
    if not houses:
        return "none"
    by_storeys = ", ".join(
        f"{count} of {number} {'storey' if number == 1 else 'storeys'}"
        for number, count in sorted(storeys.items())
    )
    return f"{houses} ({by_storeys}), density {density}"


def _share_of_water(game_map: GameMap) -> float:
    """Return the share of the area under water, sampled at the centers of the cells."""
    heights = game_map.world.heights
    # The center of a cell lies on the diagonal that its two triangles share.
    center = (heights[:-1, :-1] + heights[1:, 1:]) / 2
    return float(np.mean(game_map.world.water > center))


def _count(game_map: GameMap, kind: Kind) -> int:
    return int(np.count_nonzero(game_map.world.solid_kind == kind))


def _supplies(game_map: GameMap) -> str:
    """Describe the supplies of a match of the gathering track."""
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.match_spec import MatchSpec

    match = Match(MatchSpec(track="gathering", map=game_map.spec, seed=SUPPLY_SEED), game_map)
    quantity = match.state.supplies.quantity[0]
    return f"{np.count_nonzero(quantity):,} boxes with {quantity.sum():,} in a match of gathering"
