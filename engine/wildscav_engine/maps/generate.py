"""Generating a map from a config and a seed: lay it out, index it, explore it and choose its places."""

import numpy as np

from wildscav_engine.compilation.precompile import compile_ahead
from wildscav_engine.geometry.world import World, build_world
from wildscav_engine.maps.country.hiding import Hidden, hide_targets
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.ground.terrain import water_of_cells
from wildscav_engine.maps.layout import Layout, lay_out
from wildscav_engine.maps.locations import Places, choose_places, houses_cut_off
from wildscav_engine.maps.settlements.sites import Site
from wildscav_engine.maps.walk import NavGraph, build_graph
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

LAYOUTS = 8  # attempts to place the houses so that all of their rooms can be entered


def generate_map(config: MapConfig, seed: int) -> GameMap:
    """Make a map. The same config and seed give the same bytes on any machine.

    Args:
        config: The kind of map.
        seed: Which map of this kind, 0 to 2⁶⁴ - 1.

    Returns:
        The map.

    Raises:
        MapError: The config asks for more than fits on this map, or leaves no place to stand.
    """
    spec = MapSpec(config=config, seed=seed)
    compile_ahead()
    layout, world, graph, places = _with_open_houses(config, seed)
    owners = np.array(layout.solid_house, np.int16)
    if len(places.ground) == 0 and config.base:
        raise MapError(f"base is {config.base}: it leaves no open, dry ground to stand on")
    if len(places.ground) == 0:
        raise MapError(
            f"seed {seed} leaves no open, dry ground to stand on in a map of {config.size} m with water "
            f"{config.water}, relief {config.relief} and vegetation {config.vegetation}; try less of them"
        )
    hidden = _hidden_targets(layout, graph, places, seed)
    return GameMap(
        spec=spec,
        world=world._replace(spawns=places.ground),
        houses=layout.houses,
        indoor=places.indoor,
        outdoor=np.concatenate([places.ground, places.high]),
        solid_house=owners,
        reachable_share=graph.ground_share,
        targets=hidden.places,
        detours=hidden.detours,
    )


def _hidden_targets(layout: Layout, graph: NavGraph, places: Places, seed: int) -> Hidden:
    """Return where targets are hidden; nowhere in open country."""
    plan = layout.country
    if plan is None or not plan.country.hidden_targets:
        return Hidden(np.zeros((0, 3)), np.zeros((0, 0), np.float32))
    return hide_targets(graph, plan, layout.terrain, layout.houses, places.indoor, places.ground, seed)


def _with_open_houses(config: MapConfig, seed: int) -> tuple[Layout, World, NavGraph, Places]:
    """Lay out and explore a map; if a room cannot be entered, lay it out again with that house elsewhere.

    Only exploring the map shows this. It is very rare: a cliff around a house has to be steep and close.

    Raises:
        MapError: A house is cut off in every layout.
    """
    avoided: list[Site] = []
    for _ in range(LAYOUTS):
        layout = lay_out(config, seed, avoided)
        terrain = layout.terrain
        water = water_of_cells(terrain.heights, terrain.water_level)
        world = build_world(terrain.corner, terrain.heights, water, layout.solids, np.zeros((0, 3)))
        graph = build_graph(world)
        places = choose_places(graph, layout.houses, np.array(layout.solid_house, np.int16), seed)
        first_random = len(layout.sites) - config.houses
        cut_off = [
            number for number in houses_cut_off(layout.houses, places.indoor) if number >= first_random
        ]
        if not cut_off or len(places.ground) == 0:
            return layout, world, graph, places
        avoided += [layout.sites[number] for number in cut_off]
    raise MapError(
        f"houses is {config.houses}: with seed {seed} and relief {config.relief}, no way leads into some of "
        "them; try fewer houses, less relief or another seed"
    )
