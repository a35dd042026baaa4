from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, Solid, World, build_world, convex_solid
from wildscav_engine.maps.export.mesh import Mesh, solids_mesh, terrain_mesh, water_mesh

BOX_FACES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]


def box(low: tuple[float, float, float], size: tuple[float, float, float], kind: Kind = Kind.WALL) -> Solid:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
    return convex_solid(kind, np.array(low) + corners * size, BOX_FACES)


def prism(sides: int, radius: float, height: float, kind: Kind) -> Solid:
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), np.zeros(sides), radius * np.sin(angle)], axis=1)
    around = [(i, (i + 1) % sides, sides + (i + 1) % sides, sides + i) for i in range(sides)]
    faces = [tuple(range(sides)), tuple(range(sides, 2 * sides)), *around]
    return convex_solid(kind, np.concatenate([ring, ring + np.array([0, height, 0])]), faces)


def rock(generator: np.random.Generator) -> Solid:
    """Return a solid of random planes around a point: up to twenty faces of all shapes."""
    normals = generator.normal(size=(20, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    planes = np.concatenate([normals, generator.uniform(0.8, 1.2, (20, 1))], axis=1)
    return Solid(Kind.ROCK, planes, np.full(3, -5.0), np.full(3, 5.0))


def world_of(solids: list[Solid], heights: NDArray[np.float64] | None = None) -> World:
    heights = np.zeros((11, 11)) if heights is None else heights
    water = np.full((heights.shape[0] - 1, heights.shape[1] - 1), -np.inf)
    return build_world((-10.0, -10.0), heights, water, solids, np.zeros((1, 3)))


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]].astype(np.float64) for corner in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def normals(mesh: Mesh) -> NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]].astype(np.float64) for corner in range(3))
    return np.cross(b - a, c - a)


def is_closed(mesh: Mesh) -> bool:
    """Return whether every edge occurs once in each direction: the surface is closed."""
    edges = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in mesh.triangles for i in range(3))
    return all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items())


def test_a_box_has_its_volume_twelve_triangles_and_eight_corners() -> None:
    mesh = solids_mesh(world_of([box((1, 2, 3), (2, 3, 4))]))

    assert len(mesh.vertices) == 8
    assert len(mesh.triangles) == 12
    assert volume(mesh) == pytest.approx(24)
    assert is_closed(mesh)


@pytest.mark.parametrize("seed", range(20))
def test_a_rock_of_any_planes_is_closed_and_faces_outwards(seed: int) -> None:
    mesh = solids_mesh(world_of([rock(np.random.default_rng(seed))]))
    middles = mesh.vertices[mesh.triangles].mean(axis=1)

    assert is_closed(mesh)
    assert np.all(np.sum(normals(mesh) * middles, axis=1) > 0)  # the point all planes face away from is 0


def test_every_corner_lies_on_three_planes_and_behind_the_others() -> None:
    solid = rock(np.random.default_rng(3))
    mesh = solids_mesh(world_of([solid]))

    distance = mesh.vertices @ solid.planes[:, :3].T - solid.planes[:, 3]

    assert np.all(np.sum(np.abs(distance) < 1e-5, axis=1) >= 3)
    assert distance.max() < 1e-5


def test_a_prism_of_eight_sides_has_the_volume_of_one() -> None:
    mesh = solids_mesh(world_of([prism(8, 0.5, 3.0, Kind.TRUNK)]))

    assert volume(mesh) == pytest.approx(3.0 * 4 * 0.25 * np.sin(np.pi / 4), rel=1e-5)
    assert is_closed(mesh)


def test_a_plane_that_only_touches_an_edge_adds_nothing() -> None:
    touching = np.array([[np.sqrt(0.5), 0.0, np.sqrt(0.5), np.sqrt(2.0)]])

    corners, triangles = polyhedron(np.concatenate([box((0, 0, 0), (1, 1, 1)).planes, touching]))

    assert len(corners) == 8
    assert len(triangles) == 12


def test_each_triangle_knows_its_solid_and_its_kind() -> None:
    world = world_of([box((0, 0, 0), (1, 1, 1)), prism(6, 1.0, 2.0, Kind.CROWN)])

    everything, second = solids_mesh(world), solids_mesh(world, [1])

    assert everything.kinds.tolist() == [Kind.WALL] * 12 + [Kind.CROWN] * 20
    assert everything.solids.tolist() == [0] * 12 + [1] * 20
    assert set(second.solids.tolist()) == {1}
    assert second.triangles.max() == len(second.vertices) - 1


def test_a_world_without_solids_gives_an_empty_mesh() -> None:
    mesh = solids_mesh(world_of([]))

    assert mesh.vertices.shape == (0, 3)
    assert mesh.triangles.shape == (0, 3)


def test_the_terrain_mesh_is_the_surface_that_agents_walk_on() -> None:
    heights = np.random.default_rng(1).uniform(0, 5, (11, 11))
    world = world_of([], heights)
    mesh = terrain_mesh(world)

    for x, y, z in mesh.vertices[mesh.triangles].astype(np.float64).mean(axis=1):
        assert ground_at(world, x, z).height == pytest.approx(y, abs=1e-5)
    assert len(mesh.triangles) == 200
    assert np.all(normals(mesh)[:, 1] > 0)
    assert set(mesh.kinds.tolist()) == {Kind.TERRAIN}


def test_water_lies_level_over_wet_cells_only() -> None:
    heights = np.zeros((11, 11))
    water = np.full((10, 10), -np.inf)
    water[2, 3] = 0.5
    water[7, 7] = -1.0  # below the ground: dry
    mesh = water_mesh(build_world((-10.0, -10.0), heights, water, [], np.zeros((1, 3))))

    assert mesh.vertices.min(axis=0).tolist() == [-4.0, 0.5, -6.0]
    assert mesh.vertices.max(axis=0).tolist() == [-2.0, 0.5, -4.0]
    assert len(mesh.triangles) == 2
    assert np.all(normals(mesh)[:, 1] > 0)


def test_thousands_of_solids_are_meshed() -> None:
    world = world_of([rock(np.random.default_rng(seed)) for seed in range(20)] * 100)

    mesh = solids_mesh(world)

    assert set(mesh.solids.tolist()) == set(range(2000))
