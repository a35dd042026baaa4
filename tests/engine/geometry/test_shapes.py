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
    solids_of,
    stack,
)
from wildscav_engine.geometry.world import Kind, Solid

Point = tuple[float, float, float]
HERE = pose(10.0, 20.0, 0.0)
UNEVEN = np.array([(0.0, 1.0), (0.54, 0.64), (0.45, -0.77), (-0.24, -0.94), (-0.54, 0.64)])
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
    (Kind.ROCK, 4.0, 4.0, UNEVEN, FRUSTUM),
]


def check_same(one: Solid, other: Solid) -> None:
    """Check that two solids are the same but for the order of their planes."""
    assert one.kind == other.kind
    assert one.low == pytest.approx(other.low)
    assert one.high == pytest.approx(other.high)
    planes = [np.array(sorted(map(tuple, solid.planes.round(6) + 0.0))) for solid in (one, other)]
    assert planes[0] == pytest.approx(planes[1], abs=1e-9)


def is_inside(solid: Solid, x: float, y: float, z: float) -> bool:
    planes = solid.planes
    return bool(np.all(planes[:, 0] * x + planes[:, 1] * y + planes[:, 2] * z <= planes[:, 3] + 1e-9))


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


LOW, HIGH = (-4.0, 3.0, -5.0), (4.0, 7.2, 5.0)
BOX = box(Kind.WALL, HERE, (-1.0, 0.0, -2.0), (1.0, 3.0, 2.0))
TURNED_BOX = box(Kind.WALL, Pose(0.0, 0.0, 0.6, 0.8), (-1.0, 0.0, 0.0), (1.0, 1.0, 5.0))  # 3-4-5


@pytest.mark.parametrize(
    ("solid", "inside", "outside"),
    [
        (BOX, [(10.9, 2.9, 18.1)], [(11.1, 1.0, 20.0), (10.0, 3.1, 20.0), (10.0, 1.0, 17.9)]),
        (TURNED_BOX, [(2.9, 0.5, 3.9)], [(-2.9, 0.5, 3.9)]),
        (
            pitched_roof(Kind.ROOF, HERE, LOW, HIGH, 0.2, (0.0, 0.0)),
            # Below the ridge, which runs along; the eaves are an upright band; and half way between.
            [(10.0, 7.1, 24.9), (13.9, 3.1, 20.0), (12.0, 5.1, 20.0)],
            [(12.0, 5.3, 20.0), (14.1, 3.1, 20.0)],
        ),
        (
            pitched_roof(Kind.ROOF, HERE, LOW, HIGH, 0.2, (0.0, 4.0)),
            # Below the ridge, which ends 4 m before the front, but not before the back; and half way down.
            [(10.0, 7.1, 20.9), (10.0, 7.1, 15.1), (10.0, 5.1, 23.0)],
            [(10.0, 5.3, 23.0)],
        ),
        (
            lean_to(Kind.ROOF, HERE, LOW, (4.0, 4.2, 5.0), 0.2),
            [(10.0, 4.1, 15.1), (10.0, 3.65, 20.0)],  # it falls to its front
            [(10.0, 3.75, 20.0), (10.0, 3.25, 25.0)],
        ),
    ],
    ids=["a box", "a turned box", "a gable roof", "a hip roof", "a lean-to"],
)
def test_what_lies_inside(solid: Solid, inside: list[Point], outside: list[Point]) -> None:
    assert all(is_inside(solid, *point) for point in inside)
    assert not any(is_inside(solid, *point) for point in outside)


def test_a_box_reaches_from_its_least_to_its_greatest_corner() -> None:
    assert len(BOX.planes) == 6
    assert (BOX.low.tolist(), BOX.high.tolist()) == ([9.0, 0.0, 18.0], [11.0, 3.0, 22.0])
    assert TURNED_BOX.high.tolist() == pytest.approx([3.8, 1.0, 4.6])


def test_normals_are_unit_vectors_that_point_outwards() -> None:
    solid = pitched_roof(Kind.ROOF, pose(1.0, 2.0, 33.0), (-4.0, 3.0, -5.0), (4.0, 6.0, 5.0), 0.2, (0.0, 0.0))

    assert np.sqrt((solid.planes[:, :3] ** 2).sum(axis=1)) == pytest.approx(np.ones(7), abs=1e-15)
    assert is_inside(solid, 1.0, 4.0, 2.0)


def test_many_boxes_at_once_are_as_one_by_one() -> None:
    where = pose(3.0, -8.0, 77.0)
    corners = [(-1.0, 0.0, -2.0, 3.0, 2.5, 4.0), (0.5, 1.0, -1.0, 0.6, 1.1, 9.0)]

    for solid, corner in zip(boxes([Kind.WALL] * 2, where, corners), corners, strict=True):
        check_same(solid, box(Kind.WALL, where, corner[:3], corner[3:]))


@pytest.mark.parametrize("rings", [PRISM, FRUSTUM, PYRAMID, SPINDLE, CROWN])
@pytest.mark.parametrize("outline", [*(polygon(sides, 10.0) for sides in (3, 6, 7)), UNEVEN])
def test_a_stack_is_convex_and_has_all_its_corners_on_its_surface(
    rings: list[tuple[float, float]], outline: NDArray[np.float64]
) -> None:
    solid = stack(Kind.CROWN, 0.0, 0.0, outline, rings)
    corners = np.array([(x * scale, y, z * scale) for y, scale in rings for x, z in outline])
    away = corners @ solid.planes[:, :3].T - solid.planes[:, 3]

    assert away.max() < 1e-12
    assert np.abs(away).min(axis=1).max() < 1e-12


def test_all_at_once_are_as_one_by_one() -> None:
    stacks = allocate_ring_stacks(len(SHAPES) + 2)  # room for two that are not asked for
    for row, (kind, x, z, outline, rings) in enumerate(SHAPES):
        stacks.kind[row], stacks.axis[row] = kind, (x, z)
        stacks.sides[row], stacks.outline[row, : len(outline)] = len(outline), outline
        stacks.levels[row], stacks.rings[row, : len(rings)] = len(rings), rings

    solids = solids_of(stacks, len(SHAPES))

    assert len(solids) == len(SHAPES)
    for solid, shape in zip(solids, SHAPES, strict=True):
        check_same(solid, stack(*shape))


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
