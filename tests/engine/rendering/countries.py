"""Generated maps with their triangles, and the comparison of images with brute force."""

import math
from collections.abc import Sequence

import numpy as np
from tests.engine.rendering.brute_force import Surface, disagreements, surface_of
from tests.engine.rendering.views import NOTHING_MOVES, View, directions, seen_by

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.trace import Scene
from wildscav_engine.rendering.tracing.solids import Solids
from wildscav_engine.specs.map_spec import MapConfig

EDGES = 0.02  # greatest share of an image's rays that may run so close to an edge that either side is right
SIZES = [(1, 1), (1, 7), (7, 1), (38, 22), (64, 36), (65, 37)]
COUNTRIES = {
    "houses and trees": (MapConfig(size=60, houses=2, vegetation=0.8), 11),
    "lakes": (MapConfig(size=80, houses=1, water=0.35, vegetation=0.5), 3),
    "cliffs": (MapConfig(size=100, houses=1, relief=2.0, ruggedness=1.0, vegetation=0.3), 5),
    "streets": (MapConfig(size=120, houses=6, density="high", storeys=(2, 3), vegetation=0.2), 7),
}


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
