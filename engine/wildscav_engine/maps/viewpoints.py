"""Viewpoints on a map: the standing height at a place, and a good viewpoint to start with."""

from typing import NamedTuple

import numpy as np

from wildscav_engine.arithmetic.elementary_functions import arctangent
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.specs.body import BODY_HEIGHT, EYE_HEIGHT

AWAY = 1.1, 9.0  # times the greater side of a house, plus m: the best distance to view it from
CORNER_ON = 35.0  # degrees off its front
ON_GROUND = 0.1  # m; places higher above the ground are on a roof or a rock


class Viewpoint(NamedTuple):
    """An eye position and a viewing direction."""

    eye: tuple[float, float, float]  # m
    yaw: float  # degrees, 0 faces +z, clockwise from above
    pitch: float  # degrees, positive looks down


def standing_height(world: World, x: float, z: float) -> float:
    """Return the height in m of the lowest place at (x, z) where a body fits.

    This is the ground, the ground floor of a house or the surface of a lake; at a wall or a trunk, its top.
    """
    height = max(ground_at(world, x, z).height, water_at(world, x, z))
    for low, high in sorted(_solids_at(world, x, z)):
        if low < height + BODY_HEIGHT:
            height = max(height, high)
    return float(height)


def _solids_at(world: World, x: float, z: float) -> list[tuple[float, float]]:
    """Return the bottom and top in m of each solid on the vertical line through (x, z)."""
    rows, columns = world.water.shape
    cell = cell_of(world.corner[1], z, rows) * columns + cell_of(world.corner[0], x, columns)
    spans = []
    for solid in world.cell_solids[world.cell_start[cell] : world.cell_start[cell + 1]]:
        faces = world.faces[world.solid_start[solid] : world.solid_start[solid + 1]]
        room = faces[:, 3] - faces[:, 0] * x - faces[:, 2] * z  # of n_y · y <= room
        up = faces[:, 1]
        if (room[up == 0.0] < 0.0).any():
            continue
        high = (room[up > 0.0] / up[up > 0.0]).min()
        low = (room[up < 0.0] / up[up < 0.0]).max()
        if low < high:
            spans.append((float(low), float(high)))
    return spans


def viewpoint_of(game_map: GameMap) -> Viewpoint:
    """Return a viewpoint on open ground with a clear view of a house; without houses, one over the map."""
    for house in sorted(game_map.houses, key=lambda house: np.hypot(*house.center)):
        found = _view_of(game_map, house)
        if found is not None:
            return found
    south = -game_map.config.size / 4
    return Viewpoint((0.0, standing_height(game_map.world, 0.0, south) + EYE_HEIGHT, south), 0.0, 5.0)


def _view_of(game_map: GameMap, house: House) -> Viewpoint | None:
    """Return the best viewpoint of a house on open ground, None if it is hidden from all."""
    places = game_map.outdoor
    across, along = house.pose.inside(places[:, 0], places[:, 2])
    best = AWAY[0] * max(house.size) + AWAY[1]
    off = np.degrees(np.arctan2(np.abs(across), along))
    awkward = np.abs(np.hypot(across, along) - best) / best + np.abs(off - CORNER_ON) / 45.0
    for place in np.argsort(awkward, kind="stable")[:200]:
        x, y, z = places[place].tolist()
        on_ground = y - ground_at(game_map.world, x, z).height < ON_GROUND
        view = _towards((x, y, z), house)
        if on_ground and _sees(game_map, view, house):
            return view
    return None


def _towards(place: tuple[float, float, float], house: House) -> Viewpoint:
    """Return the viewpoint of a person at a place looking at the middle of a house."""
    x, y, z = place
    east, north = house.center[0] - x, house.center[1] - z
    down = y + EYE_HEIGHT - house.ground - house.storeys * house.storey_height / 2
    return Viewpoint(
        (x, y + EYE_HEIGHT, z), arctangent(east, north), arctangent(down, float(np.hypot(east, north)))
    )


def _sees(game_map: GameMap, view: Viewpoint, house: House) -> bool:
    """Return whether the first solid at the centre of a view belongs to a house."""
    (x, y, z), (east, north) = view.eye, house.center
    way = np.array([east - x, house.ground + house.storeys * house.storey_height / 2 - y, north - z])
    distance = float(np.linalg.norm(way))
    dx, dy, dz = (way / distance).tolist()
    hit = raycast(game_map.world, x, y, z, dx, dy, dz, distance)
    return hit.solid >= 0 and game_map.houses[game_map.solid_house[hit.solid]] is house
