"""The static world of a replay: terrain, water, houses and vegetation as coloured meshes."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Kind, World
from wildscav_engine.maps.export.mesh import Mesh, solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.palette import WATER, of_solids, shaded
from wildscav_engine.rendering.shading.ground import ground_appearance
from wildscav_engine.view.recording import colors, coordinates

# The layers of solids, which can be shown and hidden one by one.
LAYERS = {
    "world/houses/walls": Kind.WALL,
    "world/houses/floors": Kind.FLOOR,
    "world/houses/stairs": Kind.STAIR,
    "world/houses/roofs": Kind.ROOF,
    "world/houses/furniture": Kind.FURNITURE,
    "world/vegetation/trunks": Kind.TRUNK,
    "world/vegetation/crowns": Kind.CROWN,
    "world/vegetation/bushes": Kind.BUSH,
    "world/rocks": Kind.ROCK,
}
EDGE_DEPTH = 3.0  # m of earth below the lowest ground


def static_scene(game_map: GameMap) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the entities of a map and their components."""
    world = game_map.world
    yield "/", rr.ViewCoordinates.RIGHT_HAND_Z_UP
    ground = ground_appearance(world)
    lit = shaded(ground.color.reshape(-1, 3), ground.normal.reshape(-1, 3))
    yield "world/terrain", _mesh(terrain_mesh(world), vertex_colors=lit)
    yield "world/edge", _edge(world)
    water = water_mesh(world)
    if len(water.triangles):
        yield "world/water", _mesh(water, albedo_factor=WATER)
    base = of_solids(world.solid_kind, game_map.solid_house)
    for path, kind in LAYERS.items():
        chosen = np.nonzero(world.solid_kind == kind)[0]
        if len(chosen):
            yield path, _flat_shaded(solids_mesh(world, chosen), base)


def _flat_shaded(mesh: Mesh, base: NDArray[np.float64]) -> rr.Mesh3D:
    """Return a mesh whose triangles have vertices of their own and one colour each, lit by the normal."""
    corners = mesh.vertices[mesh.triangles].astype(np.float64)  # (T, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]
    lit = shaded(base[mesh.solids], normals)
    order = coordinates.triangles(np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))
    return rr.Mesh3D(
        vertex_positions=coordinates.points(corners.reshape(-1, 3)),
        triangle_indices=order,
        vertex_colors=np.repeat(lit, 3, axis=0),
    )


def _edge(world: World) -> rr.Mesh3D:
    """Return the vertical faces of earth at the edges of the map, which make it look like a model."""
    rows, columns = world.heights.shape
    row = np.concatenate(
        [np.zeros(columns), np.arange(rows), np.full(columns, rows - 1), np.arange(rows)[::-1]]
    )
    column = np.concatenate(
        [np.arange(columns), np.full(rows, columns - 1), np.arange(columns)[::-1], np.zeros(rows)]
    )
    x, z = world.corner[0] + CELL * column, world.corner[1] + CELL * row
    top = world.heights[row.astype(np.int64), column.astype(np.int64)]
    bottom = np.full_like(top, world.heights.min() - EDGE_DEPTH)
    vertices = np.concatenate([np.stack([x, level, z], axis=-1) for level in (top, bottom)])
    here = np.arange(len(x) - 1)
    under = here + len(x)
    triangles = np.concatenate(
        [np.stack([here, here + 1, under + 1], axis=-1), np.stack([here, under + 1, under], axis=-1)]
    )
    return rr.Mesh3D(
        vertex_positions=coordinates.points(vertices),
        triangle_indices=triangles,
        vertex_colors=np.repeat(np.array([colors.EARTH, colors.DEEP_EARTH], np.uint8), len(x), axis=0),
    )


def _mesh(mesh: Mesh, **look: Any) -> rr.Mesh3D:
    vertices, triangles = coordinates.points(mesh.vertices), coordinates.triangles(mesh.triangles)
    return rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, **look)
