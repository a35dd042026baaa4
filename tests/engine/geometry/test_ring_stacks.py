"""Many stacks at once: each is as ``shapes.stack`` makes it alone."""

import numpy as np
import pytest

from wildscav_engine.geometry.ring_stacks import allocate_ring_stacks, solids_of
from wildscav_engine.geometry.shapes import polygon, rounded_polygon, stack
from wildscav_engine.geometry.world import Kind

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
