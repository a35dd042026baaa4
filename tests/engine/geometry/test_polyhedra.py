"""Corners and triangles of bodies that planes enclose."""

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.shapes import pitched_roof, polygon, pose, stack
from wildscav_engine.geometry.world import Kind

CUBE = np.array(
    [(1, 0, 0, 1), (-1, 0, 0, 0), (0, 1, 0, 1), (0, -1, 0, 0), (0, 0, 1, 1), (0, 0, -1, 0)], float
)
THIRD = 1 / np.sqrt(3)


def volume(corners: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    """In m³, by the divergence theorem: positive if the triangles look outwards."""
    a, b, c = corners[triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def is_closed(triangles: NDArray[np.int64]) -> bool:
    """Whether each edge is run through once in each direction."""
    edges = [(int(t[i]), int(t[(i + 1) % 3])) for t in triangles for i in range(3)]
    return len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)


def test_six_planes_make_a_cube() -> None:
    corners, triangles = polyhedron(CUBE)

    assert sorted(map(tuple, corners)) == [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    assert len(triangles) == 12
    assert is_closed(triangles)
    assert abs(volume(corners, triangles)) == pytest.approx(1.0)


def rock(seed: int) -> NDArray[np.float64]:
    """Return random planes around the origin: up to twenty faces of all shapes."""
    generator = np.random.default_rng(seed)
    normals = generator.normal(size=(20, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return np.concatenate([normals, generator.uniform(0.8, 1.2, (20, 1))], axis=1)


@pytest.mark.parametrize(
    "planes",
    [
        CUBE,
        pitched_roof(Kind.ROOF, pose(0, 0, 30), (-4, 3, -5), (4, 6, 5), 0.2, (2, 0)).planes,
        *map(rock, range(20)),
    ],
)
def test_a_surface_is_closed_and_looks_outwards_and_its_corners_are_where_planes_meet(
    planes: NDArray[np.float64],
) -> None:
    corners, triangles = polyhedron(planes)
    a, b, c = corners[triangles].transpose(1, 0, 2)
    away = corners @ planes[:, :3].T - planes[:, 3]

    assert is_closed(triangles)
    assert (np.sum(np.cross(b - a, c - a) * (a - corners.mean(axis=0)), axis=1) > 0).all()
    assert (np.sum(np.abs(away) < 1e-5, axis=1) >= 3).all()
    assert away.max() < 1e-5


def test_a_corner_that_is_cut_off_becomes_a_triangle() -> None:
    # x + y + z <= 2.5 cuts a tetrahedron of edges 0.5 off the corner (1, 1, 1).
    cut = np.vstack([CUBE, [THIRD, THIRD, THIRD, 2.5 * THIRD]])
    corners, triangles = polyhedron(cut)

    assert len(corners) == 8 - 1 + 3
    assert len(triangles) == 2 * len(corners) - 4  # Euler
    assert volume(corners, triangles) == pytest.approx(1.0 - 0.5**3 / 6)


@pytest.mark.parametrize(
    "plane",
    [(THIRD, THIRD, THIRD, 3.0 * THIRD), (np.sqrt(0.5), 0.0, np.sqrt(0.5), np.sqrt(2.0))],
    ids=["a corner", "an edge"],
)
def test_a_plane_that_only_touches_changes_nothing(plane: tuple[float, ...]) -> None:
    corners, triangles = polyhedron(np.vstack([CUBE, plane]))

    assert (len(corners), len(triangles)) == (8, 12)
    assert volume(corners, triangles) == pytest.approx(1.0)


def test_planes_that_enclose_nothing_give_nothing() -> None:
    corners, triangles = polyhedron(
        np.array([(1, 0, 0, 0), (-1, 0, 0, -1), (0, 1, 0, 1), (0, -1, 0, 0)], float)
    )

    assert corners.shape == (0, 3)
    assert triangles.shape == (0, 3)


@pytest.mark.parametrize("sides", [3, 5, 8])
def test_the_volume_of_a_frustum_is_that_of_the_formula(sides: int) -> None:
    top = 0.5
    solid = stack(Kind.TRUNK, 3.0, -2.0, polygon(sides, 10.0), [(0.0, 1.0), (3.0, top)])
    corners, triangles = polyhedron(solid.planes)

    base = sides / 2 * np.sin(2 * np.pi / sides)
    assert len(corners) == 2 * sides
    assert is_closed(triangles)
    assert volume(corners, triangles) == pytest.approx(base * 3.0 / 3 * (1 + top + top * top))
