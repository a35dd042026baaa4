"""The solids that houses, trees and rocks are made of."""

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import (
    Pose,
    allocate_ring_stacks,
    box,
    boxes,
    lean_to,
    pitched_roof,
    polygon,
    pose,
    rounded_polygon,
    solids_of,
    stack,
)
from wildscav_engine.geometry.world import Kind, Solid

HERE = pose(10.0, 20.0, 0.0)
PRISM = [(0.0, 1.0), (3.0, 1.0)]
FRUSTUM = [(0.0, 1.0), (3.0, 0.5)]
PYRAMID = [(1.0, 2.0), (3.0, 0.0)]
SPINDLE = [(0.0, 0.0), (1.0, 1.0), (3.0, 0.0)]
CROWN = [(0.0, 0.5), (1.0, 1.0), (2.0, 0.7), (3.0, 0.0)]
SHAPES = [
    (Kind.TRUNK, 1.0, 2.0, polygon(5, 10.0), PRISM),
    (Kind.TRUNK, -3.0, 0.5, polygon(8, 33.0), FRUSTUM),
    (Kind.CROWN, 0.0, 0.0, polygon(3, 0.0), PYRAMID),
    (Kind.BUSH, 7.0, -7.0, polygon(6, 0.0), SPINDLE),
    (Kind.CROWN, 9.0, 9.0, polygon(7, 0.0), CROWN),
    (Kind.ROCK, 4.0, 4.0, rounded_polygon([0.0, 50.0, 140.0, 200.0, 310.0], across=0.7), FRUSTUM),
]


def is_inside(solid: Solid, x: float, y: float, z: float) -> bool:
    planes = solid.planes
    return bool(np.all(planes[:, 0] * x + planes[:, 1] * y + planes[:, 2] * z <= planes[:, 3] + 1e-9))


def corners_of(outline: NDArray[np.float64], rings: list[tuple[float, float]]) -> NDArray[np.float64]:
    return np.array([(x * scale, y, z * scale) for y, scale in rings for x, z in outline])


@pytest.mark.parametrize(
    ("yaw", "place"),
    [
        (0.0, (12.0, 21.0)),  # looking north: across is east, along is north
        (90.0, (11.0, 18.0)),  # looking east: across is south
        (180.0, (8.0, 19.0)),
        (-90.0, (9.0, 22.0)),
    ],
)
def test_across_is_to_the_right_of_along(yaw: float, place: tuple[float, float]) -> None:
    where = pose(10.0, 20.0, yaw)

    assert where.outside(2.0, 1.0) == place
    assert where.inside(*place) == (2.0, 1.0)


def test_a_box_is_what_lies_between_its_corners() -> None:
    solid = box(Kind.WALL, HERE, (-1.0, 0.0, -2.0), (1.0, 3.0, 2.0))

    assert len(solid.planes) == 6
    assert solid.low.tolist() == [9.0, 0.0, 18.0]
    assert solid.high.tolist() == [11.0, 3.0, 22.0]
    assert is_inside(solid, 10.9, 2.9, 18.1)
    assert not is_inside(solid, 11.1, 1.0, 20.0)
    assert not is_inside(solid, 10.0, 3.1, 20.0)
    assert not is_inside(solid, 10.0, 1.0, 17.9)


def test_a_box_turns_with_its_pose() -> None:
    # 3-4-5: looking along (0.6, 0.8).
    solid = box(Kind.WALL, Pose(0.0, 0.0, 0.6, 0.8), (-1.0, 0.0, 0.0), (1.0, 1.0, 5.0))

    assert is_inside(solid, 2.9, 0.5, 3.9)
    assert not is_inside(solid, -2.9, 0.5, 3.9)
    assert solid.high.tolist() == pytest.approx([3.8, 1.0, 4.6])


def test_normals_are_unit_vectors_that_point_outwards() -> None:
    solid = pitched_roof(Kind.ROOF, pose(1.0, 2.0, 33.0), (-4.0, 3.0, -5.0), (4.0, 6.0, 5.0), 0.2, (0.0, 0.0))

    assert np.sqrt((solid.planes[:, :3] ** 2).sum(axis=1)) == pytest.approx(np.ones(7), abs=1e-15)
    assert is_inside(solid, 1.0, 4.0, 2.0)


def test_a_roof_falls_from_its_ridge_to_its_eaves() -> None:
    solid = pitched_roof(Kind.ROOF, HERE, (-4.0, 3.0, -5.0), (4.0, 7.2, 5.0), 0.2, (0.0, 0.0))

    assert is_inside(solid, 10.0, 7.1, 24.9)  # below the ridge, which runs along
    assert is_inside(solid, 13.9, 3.1, 20.0)  # the eaves are an upright band
    assert is_inside(solid, 12.0, 5.1, 20.0)  # half way between
    assert not is_inside(solid, 12.0, 5.3, 20.0)
    assert not is_inside(solid, 14.1, 3.1, 20.0)


def test_a_hip_roof_falls_to_its_ends_too() -> None:
    solid = pitched_roof(Kind.ROOF, HERE, (-4.0, 3.0, -5.0), (4.0, 7.2, 5.0), 0.2, (0.0, 4.0))

    assert is_inside(solid, 10.0, 7.1, 20.9)  # below the ridge, which ends 4 m before the front
    assert is_inside(solid, 10.0, 7.1, 15.1)  # but not before the back
    assert is_inside(solid, 10.0, 5.1, 23.0)  # half way down
    assert not is_inside(solid, 10.0, 5.3, 23.0)


def test_a_lean_to_falls_to_its_front() -> None:
    solid = lean_to(Kind.ROOF, HERE, (-4.0, 3.0, -5.0), (4.0, 4.2, 5.0), 0.2)

    assert is_inside(solid, 10.0, 4.1, 15.1)
    assert is_inside(solid, 10.0, 3.65, 20.0)
    assert not is_inside(solid, 10.0, 3.75, 20.0)
    assert not is_inside(solid, 10.0, 3.25, 25.0)


def test_many_boxes_at_once_are_as_one_by_one() -> None:
    where = pose(3.0, -8.0, 77.0)
    corners = [(-1.0, 0.0, -2.0, 3.0, 2.5, 4.0), (0.5, 1.0, -1.0, 0.6, 1.1, 9.0)]

    for solid, (*low, right, top, front) in zip(boxes([Kind.WALL] * 2, where, corners), corners, strict=True):
        single = box(Kind.WALL, where, (low[0], low[1], low[2]), (right, top, front))
        assert solid.low == pytest.approx(single.low)
        assert solid.high == pytest.approx(single.high)
        assert np.array(sorted(map(tuple, solid.planes.round(9) + 0.0))) == pytest.approx(
            np.array(sorted(map(tuple, single.planes.round(9) + 0.0)))
        )


@pytest.mark.parametrize(
    "rings",
    [
        [(0.0, 1.0), (3.0, 1.0)],  # a prism
        [(0.0, 1.0), (3.0, 0.5)],  # a frustum
        [(0.0, 1.0), (3.0, 0.0)],  # a pyramid
        [(0.0, 0.0), (1.0, 1.0), (3.0, 0.0)],  # a spindle
        [(0.0, 0.5), (1.0, 1.0), (2.0, 0.7), (3.0, 0.0)],  # a crown
    ],
)
@pytest.mark.parametrize("sides", [3, 6, 7])
def test_a_stack_has_all_its_corners_on_its_surface(rings: list[tuple[float, float]], sides: int) -> None:
    outline = polygon(sides, 10.0)
    solid = stack(Kind.CROWN, 0.0, 0.0, outline, rings)
    x, y, z = corners_of(outline, rings).T

    n_x, n_y, n_z, offset = solid.planes.T[:, :, None]
    away = n_x * x + n_y * y + n_z * z - offset

    assert away.max() < 1e-12
    assert np.abs(away).min(axis=0).max() < 1e-12


def test_an_irregular_outline_makes_a_convex_solid() -> None:
    outline = rounded_polygon([0.0, 50.0, 140.0, 200.0, 310.0], across=0.7)
    rings = [(-0.6, 1.0), (0.5, 0.85), (1.0, 0.4)]
    solid = stack(Kind.ROCK, 0.0, 0.0, outline, rings)
    x, y, z = corners_of(outline, rings).T

    n_x, n_y, n_z, offset = solid.planes.T[:, :, None]

    assert (n_x * x + n_y * y + n_z * z - offset).max() < 1e-12
    assert len(solid.planes) == 2 * 5 + 2


def test_all_at_once_are_as_one_by_one() -> None:
    stacks = allocate_ring_stacks(len(SHAPES) + 2)  # room for two that are not asked for
    for row, (kind, x, z, outline, rings) in enumerate(SHAPES):
        stacks.kind[row], stacks.axis[row] = kind, (x, z)
        stacks.sides[row], stacks.outline[row, : len(outline)] = len(outline), outline
        stacks.levels[row], stacks.rings[row, : len(rings)] = len(rings), rings

    solids = solids_of(stacks, len(SHAPES))

    assert len(solids) == len(SHAPES)
    for solid, shape in zip(solids, SHAPES, strict=True):
        alone = stack(*shape)
        assert solid.kind == alone.kind
        assert solid.low == pytest.approx(alone.low)
        assert solid.high == pytest.approx(alone.high)
        assert planes_in_order(solid.planes) == pytest.approx(planes_in_order(alone.planes), abs=1e-9)


def planes_in_order(planes: np.ndarray) -> np.ndarray:
    return np.array(sorted(map(tuple, planes.round(6) + 0.0)))


@pytest.mark.parametrize(
    ("rings", "planes"),
    [
        (PRISM, 5 + 2),  # five sides, a bottom and a top
        (PYRAMID, 5 + 1),  # a tip has no top
        (SPINDLE, 2 * 5),  # nor a bottom
        (CROWN, 3 * 5 + 1),
    ],
)
def test_a_tip_has_no_cap(rings: list[tuple[float, float]], planes: int) -> None:
    stacks = allocate_ring_stacks(1)
    stacks.kind[0], stacks.sides[0], stacks.outline[0, :5] = Kind.ROCK, 5, polygon(5, 0.0)
    stacks.levels[0], stacks.rings[0, : len(rings)] = len(rings), rings

    (solid,) = solids_of(stacks, 1)

    assert len(solid.planes) == planes
