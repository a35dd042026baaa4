"""The meshes of a world: its solids, the ground that agents walk on, and water over wet cells."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world

from wildscav_engine.geometry.shapes import polygon, stack
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, build_world
from wildscav_engine.maps.export.mesh import Mesh, solids_mesh, terrain_mesh, water_mesh


def normals(mesh: Mesh) -> NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]].astype(np.float64) for corner in range(3))
    return np.cross(b - a, c - a)


def test_each_triangle_knows_its_solid_and_its_kind() -> None:
    crown = stack(Kind.CROWN, 0.0, 0.0, polygon(6, 0.0), [(0.0, 1.0), (2.0, 1.0)])
    world = flat_world(solids=[box((0, 0, 0), (1, 1, 1)), crown])
    everything, second, nothing = solids_mesh(world), solids_mesh(world, [1]), solids_mesh(flat_world())

    assert everything.kinds.tolist() == [Kind.WALL] * 12 + [Kind.CROWN] * 20
    assert everything.solids.tolist() == [0] * 12 + [1] * 20
    assert set(second.solids.tolist()) == {1}
    assert second.triangles.max() == len(second.vertices) - 1
    assert (nothing.vertices.shape, nothing.triangles.shape) == ((0, 3), (0, 3))


def test_the_terrain_mesh_is_the_surface_that_agents_walk_on() -> None:
    heights = np.random.default_rng(1).uniform(0, 5, (11, 11))
    world = build_world((-10.0, -10.0), heights, np.full((10, 10), -np.inf), [], np.zeros((1, 3)))
    mesh = terrain_mesh(world)

    for x, y, z in mesh.vertices[mesh.triangles].astype(np.float64).mean(axis=1):
        assert ground_at(world, x, z).height == pytest.approx(y, abs=1e-5)
    assert len(mesh.triangles) == 200
    assert np.all(normals(mesh)[:, 1] > 0)
    assert set(mesh.kinds.tolist()) == {Kind.TERRAIN}


def test_water_lies_level_over_wet_cells_only() -> None:
    world = flat_world(20)
    world.water[2, 3] = 0.5
    world.water[7, 7] = -1.0  # below the ground: dry
    mesh = water_mesh(world)

    assert mesh.vertices.min(axis=0).tolist() == [-4.0, 0.5, -6.0]
    assert mesh.vertices.max(axis=0).tolist() == [-2.0, 0.5, -4.0]
    assert len(mesh.triangles) == 2
    assert np.all(normals(mesh)[:, 1] > 0)
