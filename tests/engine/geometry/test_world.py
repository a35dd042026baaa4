"""The arrays of a world: planes of solids, and the grid that finds them."""

import numpy as np
import pytest
from tests.builders import box, flat_world

from wildscav_engine.geometry.world import ARM, Kind, World, build_world, cell_of, convex_solid

TETRAHEDRON = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4)], float)
THIRD = 1 / np.sqrt(3)


@pytest.mark.parametrize(
    ("coordinate", "cell"),
    [(-20.0, 0), (-18.01, 0), (-18.0, 1), (0.0, 10), (19.9, 19), (20.0, 19), (-99.0, 0)],
)
def test_cells_are_2_m_wide_and_end_at_the_edge(coordinate: float, cell: int) -> None:
    assert cell_of(-20.0, coordinate, 20) == cell


@pytest.mark.parametrize("order", [(1, 2, 3), (1, 3, 2), (3, 2, 1)])
def test_normals_look_outwards_whichever_way_a_face_runs(order: tuple[int, int, int]) -> None:
    solid = convex_solid(Kind.ROCK, TETRAHEDRON, [(0, 1, 2), (0, 1, 3), (0, 2, 3), order])

    expected = [(0, 0, -1, 0), (0, -1, 0, 0), (-1, 0, 0, 0), (THIRD, THIRD, THIRD, 4 * THIRD)]
    assert solid.planes == pytest.approx(np.array(expected), abs=1e-12)
    assert (solid.low.tolist(), solid.high.tolist()) == ([0, 0, 0], [4, 4, 4])


def test_a_body_keeps_its_radius_from_walls_and_its_height_from_ceilings() -> None:
    world = flat_world(
        40, [convex_solid(Kind.ROCK, TETRAHEDRON, [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])]
    )

    slanting = 0.45 * np.sqrt(2 / 3)  # looks up: only the cylinder's width counts
    assert world.face_reach == pytest.approx([0.45, 1.78, 0.45, slanting])


def listed(world: World, row: int, column: int) -> list[int]:
    """The solids of a cell, in order."""
    cell = row * world.water.shape[1] + column
    return world.cell_solids[world.cell_start[cell] : world.cell_start[cell + 1]].tolist()


SOLIDS = [
    box((0.5, 5, 0.5), (1.5, 6, 1.5)),  # in one cell, high up
    box((-1, 0, -1), (1, 1, 1)),  # in four
    box((0.5, -1, 0.5), (30, 0.5, 1.5)),  # from there eastwards, beyond the edge
]


def test_a_cell_lists_what_its_box_touches_from_the_lowest_upwards() -> None:
    world = flat_world(40, SOLIDS)

    assert listed(world, 10, 10) == [2, 1, 0]
    assert listed(world, 9, 9) == [1]
    assert listed(world, 9, 10) == [1]
    assert listed(world, 10, 19) == [2]
    assert listed(world, 11, 10) == []
    assert world.cell_start[-1] == len(world.cell_solids) == 1 + 4 + 10


def test_no_solid_is_missing_from_a_cell_and_none_is_there_in_vain() -> None:
    dice = np.random.default_rng(4)
    places = dice.uniform((-22, -2, -22), (20, 8, 20), (40, 3))
    sizes = dice.uniform(0.1, 7, (40, 3))
    solids = [box(place, place + size) for place, size in zip(places, sizes, strict=True)]
    world = flat_world(40, solids)
    # Boxes that reach beyond the map are listed in its outermost cells, too.
    low, high = (np.clip((corners + 20.0) // 2.0, 0, 19) for corners in (places, places + sizes))

    for row in range(20):
        for column in range(20):
            touches = (low <= [column, np.inf, row]) & ([column, -np.inf, row] <= high)
            assert set(listed(world, row, column)) == set(np.flatnonzero(touches.all(axis=1)))


def test_tops_are_the_highest_of_terrain_and_solids() -> None:
    world = flat_world(40, SOLIDS, slope=0.1)

    assert world.cell_top[10, 10] == 6.0
    assert world.cell_top[9, 9] == 1.0
    assert world.cell_top[0, 0] == pytest.approx(-1.8)  # its eastern corners: -18 × 0.1
    assert world.cell_top[10, 19] == pytest.approx(2.0)  # the ground is above the solid
    assert world.block_top.shape == (3, 3)
    assert world.block_top[1, 1] == 6.0  # cells 8 to 15
    assert world.block_top[0, 0] == pytest.approx(-0.4)  # cells 0 to 7 end at x = -4
    assert world.block_top[2, 2] == pytest.approx(2.0)


def test_the_ceiling_is_the_lowest_solid_that_a_body_in_a_cell_can_touch() -> None:
    world = flat_world(40, SOLIDS[:2])

    assert ARM == 0.7
    assert world.ceiling[10, 10] == 0.0
    assert world.ceiling[9, 9] == 0.0
    assert world.ceiling[10, 8] == np.inf  # its eastern edge, x = -2, is 1 m away from the box
    apart = flat_world(40, [box((0.5, 5, 0.5), (1.5, 6, 1.5))])
    assert apart.ceiling[10, 10] == 5.0
    assert apart.ceiling[10, 9] == 5.0  # 0.5 m away from it
    assert apart.ceiling[10, 12] == np.inf


def test_a_map_without_solids_is_its_ground() -> None:
    heights = np.array([[0.0, 1.0, 2.0], [0.0, 4.0, 2.0]])
    world = build_world((0.0, 0.0), heights, np.full((1, 2), -np.inf), (), np.zeros((0, 3)))

    assert world.cell_top.tolist() == [[4.0, 4.0]]
    assert world.faces.shape == (0, 4)
    assert world.cell_start.tolist() == [0, 0, 0]
    assert world.spawns.shape == (0, 3)
