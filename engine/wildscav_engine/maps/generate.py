"""From a config and a seed to a map: laid out, indexed, explored, and its places chosen."""

import numpy as np

from wildscav_engine.ahead import compile_ahead
from wildscav_engine.geometry.world import build_world
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.layout import lay_out
from wildscav_engine.maps.locations import choose_places
from wildscav_engine.maps.terrain import water_of_cells
from wildscav_engine.maps.walk import build_graph
from wildscav_engine.spec import MapConfig, MapSpec


def generate_map(config: MapConfig, seed: int) -> GameMap:
    """Make a map. The same config and seed give the same bytes on any machine.

    Args:
        config: What kind of map.
        seed: Which of them, 0 to 2⁶⁴ - 1.

    Returns:
        The map.

    Raises:
        MapError: The config asks for more than this map has room for, or leaves no place to stand.
    """
    spec = MapSpec(config=config, seed=seed)
    compile_ahead()
    terrain, solids, solid_house, houses = lay_out(config, seed)
    water = water_of_cells(terrain.heights, terrain.water_level)
    world = build_world(terrain.corner, terrain.heights, water, solids, np.zeros((0, 3)))
    graph = build_graph(world)
    owners = np.array(solid_house, np.int16)
    places = choose_places(graph, houses, owners, seed)
    if len(places.ground) == 0 and config.base:
        raise MapError(f"base is {config.base}: it leaves no open, dry ground to stand on")
    if len(places.ground) == 0:
        raise MapError(
            f"seed {seed} leaves no open, dry ground to stand on in a map of {config.size} m with water "
            f"{config.water}, relief {config.relief} and vegetation {config.vegetation}; try less of them"
        )
    return GameMap(
        spec=spec,
        world=world._replace(spawns=places.ground),
        houses=houses,
        indoor=places.indoor,
        outdoor=np.concatenate([places.ground, places.high]),
        solid_house=owners,
        reachable_share=graph.ground_share,
    )
