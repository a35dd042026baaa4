"""The walkable graph: what a body can walk, climb, drop and jump to, in small handmade worlds."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, Solid, World, build_world
from wildscav_engine.maps import walk
from wildscav_engine.maps.walk import NavGraph, build_graph, find_path, is_reached, leads_out, node_near
from wildscav_engine.maps.walk.explore import walk_straight
from wildscav_engine.maps.walk.lattice import SAME_SURFACE, SPACING
from wildscav_engine.maps.walk.search import LEG_STRIDE
from wildscav_engine.motion.collision import Bodies, Point

HERE, THERE = (-10.0, 0.0, 0.0), (10.0, 0.0, 0.0)


def graph_of(*solids: Solid, **world: object) -> NavGraph:
    return build_graph(flat_world(solids=solids, **world))


def block(low: Sequence[float], high: Sequence[float]) -> Solid:
    return box(low, high, Kind.FLOOR)


# A flight of stairs, and the floor that it leads to.
STAIRS = [block((i * 0.28, 0, -0.8), ((i + 1) * 0.28, (i + 1) * 0.2, 0.8)) for i in range(14)]
STAIRS.append(block((3.92, 2.8, -4), (9, 3.0, 4)))


def across(height: float, kind: Kind = Kind.WALL) -> Solid:
    """Return a wall from edge to edge of the map."""
    return box((-0.3, 0, -20), (0.3, height, 20), kind)


def test_open_ground_is_one_connected_part_a_metre_apart() -> None:
    graph = graph_of()
    assert graph.connected.all()
    assert len(graph) == 39 * 39  # whole metres from 1 m inside one edge to 1 m inside the other
    assert graph.ground_share == 1.0
    assert (graph.nodes.edges[:, ::2] >= 0).sum() == 4 * 39 * 38


@pytest.mark.parametrize(
    ("height", "passes", "jumps"),
    [
        (0.3, True, False),  # a step
        (0.49, True, False),  # the highest step
        (0.9, True, True),  # to be jumped onto
        (1.15, True, True),  # just so
        (1.4, False, False),  # higher than any jump
    ],
)
def test_a_wall_across_the_map(height: float, passes: bool, jumps: bool) -> None:
    graph = graph_of(across(height, Kind.FLOOR))
    path = find_path(graph, HERE, THERE)
    assert (path is not None) == passes
    if path:
        assert any(leg.jump for leg in path.legs) == jumps
        assert path.length == pytest.approx(20.0, abs=0.2)


@pytest.mark.parametrize(("width", "passes"), [(0.8, False), (1.5, True), (2.0, True)])
@pytest.mark.parametrize("middle", [0.0, 0.13, 0.25, 0.41])
def test_a_gap_in_a_wall_is_found_wherever_it_lies(width: float, passes: bool, middle: float) -> None:
    left, right = middle - width / 2, middle + width / 2
    graph = graph_of(box((-0.2, 0, -20), (0.2, 3, left)), box((-0.2, 0, right), (0.2, 3, 20)))
    path = find_path(graph, HERE, THERE)
    assert (path is not None) == passes
    assert path is None or path.length == pytest.approx(20.0, abs=0.1)


@pytest.mark.parametrize(("clear", "passes"), [(1.7, False), (1.9, True), (2.3, True)])
def test_a_lintel_too_low_to_walk_under_closes_a_way(clear: float, passes: bool) -> None:
    graph = graph_of(box((-0.2, clear, -20), (0.2, 3.5, 20)))
    assert (find_path(graph, HERE, THERE) is not None) == passes


def test_who_drops_from_a_platform_without_stairs_cannot_come_back() -> None:
    graph = graph_of(block((-3, 0, -3), (3, 2.5, 3)), block((3, 0, -1), (4, 1.4, 1)))
    top = node_near(graph, (0.0, 2.501, 0.0), leave=True)
    # No body can walk or jump up there, so exploring never finds it.
    assert top is None
    assert not is_reached(graph, (0.0, 2.501, 0.0), distance=1.0)


def test_a_low_platform_is_reached_and_left_both_by_a_jump_and_by_a_drop() -> None:
    graph = graph_of(block((-3, 0, -3), (3, 1.0, 3)))
    for start, end, jumps in ((HERE, (0, 1.0, 0), [True]), ((0, 1.0, 0), HERE, [False])):
        path = find_path(graph, start, end)
        assert path is not None
        assert [leg.jump for leg in path.legs if leg.leap] == jumps


def test_a_pit_is_entered_but_never_left() -> None:
    world = flat_world(size=60)
    world.heights[12:18, 12:18] = -3.0
    pit = build_graph(with_heights(world, world.heights))
    bottom = (pit.world.corner[0] + 29.0, -3.0, pit.world.corner[1] + 29.0)
    start = (0.0, 0.0, 20.0)
    assert find_path(pit, start, bottom) is not None
    assert find_path(pit, bottom, start) is None
    assert is_reached(pit, start, distance=1.0)
    assert not is_reached(pit, bottom, distance=1.0)
    assert not leads_out(pit, bottom)


def with_heights(world: World, heights: NDArray[np.float64], solids: Sequence[Solid] = ()) -> World:
    return build_world(tuple(world.corner), heights, world.water, solids, world.spawns)


@pytest.mark.parametrize(("slope", "walks"), [(0.5, True), (0.95, True), (1.1, False)])
def test_ground_is_walked_up_to_45_degrees(slope: float, walks: bool) -> None:
    graph = graph_of(slope=slope)
    path = find_path(graph, (-10.0, -10 * slope, 0.0), (10.0, 10 * slope, 0.0))
    assert (path is not None) == walks


def test_stairs_lead_to_the_floor_above_and_back() -> None:
    graph = graph_of(*STAIRS)
    up, down = find_path(graph, HERE, (7, 3.0, 2)), find_path(graph, (7, 3.0, 2), HERE)
    assert up is not None
    assert down is not None
    assert not any(leg.leap for leg in up.legs)
    under, above = (node_near(graph, (7, height, 2), leave=True) for height in (0, 3.001))
    assert None not in {under, above}
    assert under != above
    assert graph.connected[[under, above]].all()


def test_a_closed_yard_is_a_part_of_its_own() -> None:
    sides = [((5, 0, 5), (12, 3, 5.4)), ((5, 0, 11.6), (12, 3, 12)), ((5, 0, 5), (5.4, 3, 12))]
    graph = graph_of(*(box(low, high) for low, high in (*sides, ((11.6, 0, 5), (12, 3, 12)))))
    inside = node_near(graph, (8, 0, 8), leave=True)
    assert inside is not None
    assert not graph.connected[inside]
    assert find_path(graph, HERE, (8, 0, 8)) is None
    open_yard = graph_of(*(box(low, high) for low, high in sides))
    assert find_path(open_yard, HERE, (8, 0, 8)) is not None


def test_the_same_world_gives_the_same_graph_byte_for_byte() -> None:
    solids = [block((-3, 0, -3), (3, 1.0, 3)), box((6, 0, -8), (6.3, 3, 8))]
    one, other = graph_of(*solids), graph_of(*solids)
    for first, second in zip(one.nodes, other.nodes, strict=True):
        assert first.tobytes() == second.tobytes()
    assert one.leap_end.tobytes() == other.leap_end.tobytes()


def test_nobody_stands_below_the_ground_on_what_a_slope_buries() -> None:
    # The top of this block is level at 2 m; the ground around rises from 1 m to 3 m above it.
    graph = graph_of(block((2, 0, -4), (6, 2.0, 4)), slope=0.5)
    places = graph.positions()
    ground = np.array([ground_at(graph.world, x, z).height for x, _, z in places])
    assert (places[:, 1] >= ground - 1e-6).all()
    assert (places[:, 1] > ground + 0.3).any()  # but on the part that stands out


@pytest.mark.parametrize("seed", range(50, 60))
def test_every_edge_on_rugged_ground_is_walked_at_any_speed(seed: int) -> None:
    # Small blocks hang high above the ground, so fine and open cells lie side by side.
    blocks = [
        block((x + 0.8, 20, z + 0.8), (x + 1.2, 21, z + 1.2))
        for x in range(-12, 12, 4)
        for z in range(-12, 12, 2)
    ]
    heights = np.zeros((21, 21))
    heights[5:16, 5:16] = np.random.default_rng(seed).normal(0.0, 0.8, (11, 11)).cumsum(axis=seed % 2)
    graph = build_graph(with_heights(flat_world(), heights, blocks))
    nobody = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)
    places = graph.positions()
    for node, direction in np.argwhere(graph.nodes.edges[: len(graph)] >= 0):
        x, height, z = places[graph.nodes.edges[node, direction]]
        for stride in (SPACING, LEG_STRIDE):
            reached = walk_straight(graph.world, nobody, Point(*places[node]), x, z, stride)
            assert abs(reached - height) <= SAME_SURFACE, f"from {places[node]} in direction {direction}"


def test_a_cliff_is_got_down_alike_to_all_four_sides() -> None:
    # A table mountain 12 m across and 6 m high: its sides are one cell wide, at 71°.
    heights = np.zeros((21, 21))
    heights[7:14, 7:14] = 6.0
    graph = build_graph(with_heights(flat_world(), heights))
    x, _, z = graph.positions(graph.leap_end).T
    for side in (x > 6, x < -6, z > 6, z < -6):
        assert side.sum() >= 3
    assert not is_reached(graph, (0.0, 6.0, 0.0), distance=1.0)


def test_a_target_is_reached_from_as_far_as_it_counts() -> None:
    graph = graph_of(block((-3, 0, -3), (3, 3.0, 3)))
    middle = (0.0, 3.0, 0.0)
    assert not is_reached(graph, middle, distance=3.0)
    assert is_reached(graph, middle, distance=5.0)


def test_tables_that_are_full_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    solids = [*STAIRS, block((-9, 0, 5), (-3, 1.0, 9))]
    roomy = graph_of(*solids)

    monkeypatch.setattr("wildscav_engine.maps.walk.graph.LAYERS", 0.0)
    monkeypatch.setattr("wildscav_engine.maps.walk.graph.LEAPS_PER_NODE", 0.0)
    tight = graph_of(*solids)

    assert len(tight) == len(roomy)
    assert len(tight.leap_end) == len(roomy.leap_end) > 0
    assert tight.connected.sum() == roomy.connected.sum()


def test_the_graph_keeps_its_old_name_for_a_release() -> None:
    with pytest.warns(DeprecationWarning, match="NavGraph"):
        assert walk.WalkGraph is walk.NavGraph
