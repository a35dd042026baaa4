"""Images and single rays of generated maps in one format, compared with brute force."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from tests.engine.rendering.brute_force import Met, Surface, disagreements, surface_of

from wildscav_engine.geometry.rays import TERRAIN_HIT, raycast
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import WATER_HIT, Hits, allocate_hits
from wildscav_engine.rendering.images import trace
from wildscav_engine.rendering.trace import Scene
from wildscav_engine.rendering.tracing.solids import Solids, gather_solids
from wildscav_engine.specs.map_spec import MapConfig

NOBODY = -2
NOTHING_MOVES = gather_solids([])
EDGES = 0.02  # greatest share of an image's rays that may run so close to an edge that either side is right
SIZES = [(1, 1), (1, 7), (7, 1), (38, 22), (64, 36), (65, 37)]
COUNTRIES = {
    "houses and trees": (MapConfig(size=60, houses=2, vegetation=0.8), 11),
    "lakes": (MapConfig(size=80, houses=1, water=0.35, vegetation=0.5), 3),
    "cliffs": (MapConfig(size=100, houses=1, relief=2.0, ruggedness=1.0, vegetation=0.3), 5),
    "streets": (MapConfig(size=120, houses=6, density="high", storeys=(2, 3), vegetation=0.2), 7),
}


class View(NamedTuple):
    """One camera."""

    eye: tuple[float, float, float]  # m
    yaw: float = 0.0  # degrees
    pitch: float = 0.0  # degrees, positive looks down
    size: tuple[int, int] = (1, 1)  # width and height in pixels
    field_of_view: float = 60.0  # degrees
    far: float = 100.0  # m
    viewer: int = NOBODY


def directions(view: View) -> NDArray[np.float64]:
    """Return (height * width, 3) unit vectors through the middles of the pixels."""
    yaw, pitch = np.radians(view.yaw), np.radians(view.pitch)
    ahead = np.array([np.sin(yaw) * np.cos(pitch), -np.sin(pitch), np.cos(yaw) * np.cos(pitch)])
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    up = np.cross(ahead, right)
    width, height = view.size
    pixel = 2.0 * np.tan(np.radians(view.field_of_view) / 2) / width
    across = (np.arange(width) + 0.5 - width / 2) * pixel
    above = (height / 2 - np.arange(height) - 0.5) * pixel
    ways = ahead + right * across[None, :, None] + up * above[:, None, None]
    ways /= np.linalg.norm(ways, axis=2)[:, :, None]
    return ways.reshape(-1, 3)


def look(
    scene: Scene, views: Sequence[View], moving: Solids = NOTHING_MOVES, *, with_water: bool = False
) -> Hits:
    """Trace cameras with one field of view together."""
    first = views[0]
    cameras = Cameras(
        np.array([view.eye for view in views], np.float64),
        np.array([view.yaw for view in views], np.float64),
        np.array([view.pitch for view in views], np.float64),
        np.array([view.viewer for view in views], np.int32),
        float(np.tan(np.radians(first.field_of_view) / 2)),
        first.far,
    )
    hits = allocate_hits(len(views), first.size[1], first.size[0])
    for part in hits:
        part.fill(77)  # so that a pixel that is left out shows
    trace(scene, moving, cameras, hits, with_water=with_water)
    return hits


def seen_by(scene: Scene, view: View, moving: Solids = NOTHING_MOVES, *, with_water: bool = False) -> Met:
    """Return what the pixels of one camera show."""
    hits = look(scene, [view], moving, with_water=with_water)
    distance, solid, face = (part.reshape(-1) for part in hits)
    normal = np.zeros((len(solid), 3))
    static = len(scene.solids.kind)
    for own, faces in (
        ((solid >= 0) & (solid < static), scene.solids.faces),
        (solid >= static, moving.faces),
        (solid == TERRAIN_HIT, terrain_normals(scene.world)),
    ):
        normal[own] = faces[face[own], :3]
    normal[solid == WATER_HIT, 1] = 1.0
    return Met(distance.astype(np.float64), solid.astype(np.int64), normal)


def cast(world: World, eye: Sequence[float], ways: NDArray[np.float64], far: float) -> Met:
    """Return what single rays hit."""
    x, y, z = map(float, eye)
    hits = [raycast(world, x, y, z, *map(float, way), far) for way in ways]
    normals = np.zeros((len(ways), 3))
    terrain = terrain_normals(world)
    for ray, (hit, way) in enumerate(zip(hits, ways, strict=True)):
        if hit.solid >= 0:
            normals[ray] = world.faces[hit.face, :3]
        elif hit.solid == TERRAIN_HIT:
            cell = _cell_at(world, x + hit.distance * way[0], z + hit.distance * way[2])
            normals[ray] = terrain[2 * cell + hit.face] if cell >= 0 else np.nan
    return Met(np.array([hit.distance for hit in hits]), np.array([hit.solid for hit in hits]), normals)


def _cell_at(world: World, x: float, z: float) -> int:
    """Return the cell of a point, -1 if it is so near to a border that it may be in either cell."""
    place = (np.array([z, x]) - world.corner[::-1]) / CELL
    if np.abs(place - np.round(place)).min() < 1e-6:
        return -1
    row, column = np.floor(place).astype(int)
    return int(row * world.water.shape[1] + column)


def terrain_normals(world: World) -> NDArray[np.float64]:
    """Return (2 * cells, 3) upward unit normals: of each cell's south-eastern triangle, then the other."""
    south_west, south_east = world.heights[:-1, :-1], world.heights[:-1, 1:]
    north_west, north_east = world.heights[1:, :-1], world.heights[1:, 1:]
    rise = np.array(
        [
            [south_east - south_west, north_east - south_east],
            [north_east - north_west, north_west - south_west],
        ]
    )
    slopes = rise.transpose(2, 3, 0, 1).reshape(-1, 2) / CELL
    normals = np.stack([-slopes[:, 0], np.ones(len(slopes)), -slopes[:, 1]], axis=1)
    unit: NDArray[np.float64] = normals / np.linalg.norm(normals, axis=1)[:, None]
    return unit


class Country:
    """A generated map with its triangles."""

    def __init__(self, game_map: GameMap) -> None:
        self.map = game_map
        self.world = game_map.world
        self.scene = game_map.scene
        self.surface = surface_of(game_map.world)


def check(
    surface: Surface, scene: Scene, view: View, moving: Solids = NOTHING_MOVES, most: float = EDGES
) -> None:
    """Check an image against brute force; a few rays along edges may differ."""
    ways = directions(view)
    answers = seen_by(scene, view, moving)
    faults, along_edges = disagreements(surface, np.array(view.eye), ways, view.far, answers)
    assert not faults, f"{view}: {len(faults)} of {len(ways)} rays, the first {faults[0]}"
    assert along_edges <= max(3, most * len(ways)), f"{view}: {along_edges} rays along edges"


def look_at(eye: Sequence[float], point: Sequence[float]) -> tuple[float, float]:
    """Return the yaw and pitch in degrees from an eye towards a point."""
    x, y, z = (to - at for at, to in zip(eye, point, strict=True))
    return math.degrees(math.atan2(x, z)), -math.degrees(math.atan2(y, math.hypot(x, z)))


def in_the_air(world: World, random: np.random.Generator) -> tuple[float, float, float]:
    """Return a random point above the ground of a map."""
    x, z = random.uniform(world.corner, -world.corner)
    return float(x), ground_at(world, x, z).height + float(random.exponential(4.0)), float(z)
