"""Handmade worlds and moving solids agree with brute force: cases that a fast tracer may miss."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import box, flat_world
from tests.engine.rendering.brute_force import surface_of
from tests.engine.rendering.views import EDGES, View, check, directions, look, seen_by

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.shapes import box as turned_box
from wildscav_engine.geometry.shapes import pose
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import BLOCK, CELL, Kind, Solid, World, build_world, convex_solid
from wildscav_engine.rendering.hits import WATER_HIT
from wildscav_engine.rendering.trace import scene_of
from wildscav_engine.rendering.tracing.solids import gather_solids


def check_world(solids: Sequence[Solid], *views: View, slope: float = 0.0, size: int = 80) -> None:
    """Check images of a handmade world against brute force, with its solids static and moving."""
    world = flat_world(size, solids, slope)
    bare, moving = flat_world(size, slope=slope), gather_solids(solids)
    for view in views:
        check(surface_of(world), scene_of(world), view, most=0.04)
        check(surface_of(bare, moving), scene_of(bare), view, moving, most=0.04)


# --- Worlds made by hand: what a fast tracer may lose -----------------------------------------------------

EYE = (0.0, 1.5, 0.0)


def rock(random: np.random.Generator, middle: Sequence[float], radius: float) -> Solid:
    """Return a convex solid of random shape: a distorted octahedron."""
    points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
    points *= radius * random.uniform(0.3, 1.0, (6, 1))
    faces = [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    return convex_solid(Kind.ROCK, points + middle, faces)


@pytest.mark.parametrize("column", [0, 31, 32, 63])
@pytest.mark.parametrize("away", [0.6, 17.0, 38.9])
def test_a_pole_thinner_than_a_pixel_is_seen_where_a_ray_meets_it(column: int, away: float) -> None:
    view = View(EYE, 0.0, 0.0, (64, 36))
    x, _, z = EYE + directions(view)[17 * 64 + column] * away
    pole = box((x - 0.004, 0, z - 0.004), (x + 0.004, 3.0, z + 0.004))
    assert look(scene_of(flat_world(80, [pole])), [view]).solid[0, 17, column] == 0
    check_world([pole], view)


@pytest.mark.parametrize("row", [0, 9, 17, 18, 35])
def test_a_wire_thinner_than_a_pixel_is_seen_where_a_ray_meets_it(row: int) -> None:
    view = View((0.0, 12.0, 0.0), 0.0, 0.0, (64, 36))
    _, y, z = np.array(view.eye) + directions(view)[row * 64 + 32] * 10.0
    wire = box((-30, y - 0.002, z - 0.002), (30, y + 0.002, z + 0.002))
    assert (look(scene_of(flat_world(80, [wire])), [view]).solid[0, row] == 0).sum() > 50
    check_world([wire], view)


NEAR_THE_EYE = {
    "a wall beside the eye, from behind it to before it": [((0.1, 0, -20), (0.3, 4, 20))],
    "walls on both sides": [((0.05, 0, -5), (0.3, 4, 9)), ((-0.3, 0, -9), (-0.05, 4, 3))],
    "a roof right over the eye": [((-6, 1.51, -6), (6, 1.6, 6))],
    "a floor right under the eye": [((-6, 1.3, -6), (6, 1.49, 6))],
    "a wall in front of the nose": [((-3, 0, 0.001), (3, 3, 0.2))],
    "a wall behind": [((-3, 0, -0.4), (3, 3, -0.001))],
    "a box whose corner is at the eye": [((0.01, 1.0, 0.01), (3, 1.49, 3))],
    "a pole that grazes the eye": [((0.002, 0, 0.0), (0.01, 3, 0.01))],
    "a room around the eye": [
        ((-2, 0, 2), (2, 3, 2.2)),
        ((-2, 0, -2.2), (2, 3, -2)),
        ((2, 0, -2), (2.2, 3, 2)),
        ((-2.2, 0, -2), (-2, 3, 2)),
        ((-2, 3, -2), (2, 3.2, 2)),
    ],
    "the eye in a solid": [((-1, 0, -1), (1, 3, 1)), ((-3, 0, 5), (3, 3, 6))],
    "a slab as wide as the map": [((-40, 5, -40), (40, 5.1, 40))],
    "a tower high above the view": [((-1, 0, 6), (1, 60, 8))],
    "many thin slats": [((x / 4, 0, 4), (x / 4 + 0.02, 3, 4.02)) for x in range(-12, 13)],
    "boxes one before another": [((-0.1 * k, 0, 2 * k), (0.1 * k, 3, 2 * k + 0.5)) for k in range(1, 16)],
}


@pytest.mark.parametrize("name", NEAR_THE_EYE)
def test_solids_near_beside_behind_and_around_the_eye(name: str) -> None:
    solids = [box(low, high) for low, high in NEAR_THE_EYE[name]]
    views = [
        View(EYE, yaw, pitch, (21, 13), field_of_view)
        for yaw, pitch, field_of_view in (
            *((0.0, 0.0, 60.0), (0.0, 0.0, 150.0), (37.0, -20.0, 150.0)),
            *((91.0, 40.0, 60.0), (181.0, -90.0, 150.0)),
        )
    ]
    check_world(solids, *views)


def test_the_far_side_of_the_world_is_seen() -> None:
    posts = [box((x, 0, 110), (x + 0.1, 30, 110.1)) for x in range(-90, 91, 5)]
    view = View((0.0, 10.0, -110.0), 0.0, 0.0, (380, 3), 60.0, far=1000.0)
    check_world(posts, view, size=240)
    assert (look(scene_of(flat_world(240, posts)), [view]).solid >= 0).any()


@pytest.mark.parametrize("cells", [0, BLOCK, -BLOCK, 1])
@pytest.mark.parametrize("eye_on", ["border", "just before", "just beyond"])
def test_what_stands_on_borders_of_cells_and_blocks_is_seen(cells: int, eye_on: str) -> None:
    # The map's corner is at -48, so that multiples of 16 m are borders of blocks.
    border = cells * CELL
    solids = [
        box((border, 0, border), (border + 0.1, 2, border + 0.1)),
        box((border - 0.05, 0, border + 8), (border + 0.05, 2, border + 8.1)),
        box((border - 12, 0.5, border - 0.01), (border - 4, 1, border + 0.01)),
        box((-47.9, 0, 47.9), (-47.8, 9, 48.0)),
        box((16, 0, -48), (32, 3, -32)),
    ]
    shift = {"border": 0.0, "just before": -1e-9, "just beyond": 1e-9}[eye_on]
    eye = (border + shift, 1.5, -16.0 + shift)
    views = [View(eye, yaw, 3.0, (24, 14), 90.0) for yaw in (0.0, 90.0, 135.0)]
    check_world(solids, *views, size=96)


def test_a_map_that_ends_within_a_block_is_seen_to_its_edge() -> None:
    solids = [box((20.5, 0, 20.5), (20.9, 5, 20.9)), box((-21, 0, 20.9), (21, 1, 21))]
    check_world(solids, View(EYE, 45.0, 0.0, (38, 22)), View(EYE, 0.0, 5.0, (38, 22), 100.0), size=42)


def random_world(random: np.random.Generator) -> World:
    """Return a rough world of 48 m with boxes, slats, poles and rocks anywhere, even in the air or ground."""
    heights = random.uniform(0.0, 1.0, (25, 25)) * random.choice([0.0, 0.5, 4.0])
    heights[5:9, 5:9] += random.choice([0.0, 8.0])  # a cliff on all sides
    solids = []
    for _ in range(random.integers(0, 14)):
        x, z = random.uniform(-21, 21, 2)
        y = random.choice([0.0, 0.5, 3.0, 9.0])
        if random.random() < 0.4:
            solids.append(rock(random, (x, y, z), random.choice([0.1, 0.8, 2.5])))
            continue
        half = random.choice([0.01, 0.1, 1.0, 2.0], 3) / 1.01
        where = pose(x, z, random.choice([0.0, 90.0, random.uniform(0, 360)]))
        low = (-half[0], y - half[1], -half[2])
        solids.append(turned_box(Kind.WALL, where, low, (half[0], y + half[1], half[2])))
    water = np.full((24, 24), -np.inf)
    return build_world((-24.0, -24.0), heights, water, solids, np.zeros((1, 3)))


@given(st.integers(0, 2**32), st.sampled_from([(1, 1), (3, 11), (20, 12), (33, 19), (38, 22), (65, 37)]))
def test_any_world_is_seen_as_brute_force_sees_it(seed: int, size: tuple[int, int]) -> None:
    random = np.random.default_rng(seed)
    world = random_world(random)
    x, z = random.uniform(-23.9, 23.9, 2)
    on_corner = random.random() < 0.3
    if on_corner:
        x, z = CELL * np.round(np.array([x, z]) / CELL)
    y = ground_at(world, x, z).height + random.choice([1e-3, 0.3, 1.5, 6.0, 20.0])
    yaw = random.choice([0.0, 45.0, 90.0, 180.0, random.uniform(-180, 180)])
    pitch = random.choice([0.0, -90.0, 90.0, random.uniform(-60, 60)])
    lens, far = random.choice([5.0, 60.0, 120.0, 165.0]), random.choice([4.0, 30.0, 100.0])
    # Straight down on a corner, many rays run along the edges of cells.
    most = 1.0 if on_corner else EDGES
    check(surface_of(world), scene_of(world), View((x, y, z), yaw, pitch, size, lens, far), most=most)


def test_a_ray_along_a_border_of_cells_names_a_triangle_that_it_meets() -> None:
    for seed in range(20):
        world = random_world(np.random.default_rng(seed))
        for yaw in (45.0, -45.0, 135.0):  # an image straight down, whose diagonals run along the borders
            eye = (4.0, ground_at(world, 4.0, -6.0).height + 1.0, -6.0)
            view = View(eye, yaw, 90.0, (21, 21), 120.0)
            hits = look(scene_of(world), [view])
            points = np.array(eye) + directions(view) * hits.distance.reshape(-1, 1)
            triangles = surface_of(world)
            on_ground = hits.solid.reshape(-1) == TERRAIN_HIT
            for point, face in zip(points[on_ground], hits.face.reshape(-1)[on_ground], strict=True):
                off = triangles.normals[face] @ (point - triangles.corners[face, 0])
                beside = np.abs(point - triangles.middles[face])[[0, 2]].max()
                assert abs(off) < 1e-4, (seed, yaw, point, face)
                assert beside < CELL, (seed, yaw, point, face)


# --- Things that move -------------------------------------------------------------------------------------


def test_what_moves_is_seen_before_what_stands_behind_it_and_not_through_what_stands_before() -> None:
    world = flat_world(80, [box((-2, 0, 10), (2, 3, 11))])
    moving = gather_solids([box((-0.5, 0, 5), (0.5, 1.8, 5.5)), box((-0.5, 0, 20), (0.5, 1.8, 21))])
    hits = look(scene_of(world), [View(EYE)], moving)
    assert (hits.solid[0, 0, 0], hits.distance[0, 0, 0]) == (1, 5.0)
    hits = look(scene_of(world), [View((0.0, 1.5, 7.0))], moving)
    assert (hits.solid[0, 0, 0], hits.distance[0, 0, 0]) == (0, 3.0)


def test_nobody_sees_what_is_theirs_and_everybody_what_is_not() -> None:
    scene = scene_of(flat_world(80))
    moving = gather_solids([box((-0.5, 0, -0.5), (0.5, 1.8, 0.5)), box((-1, 0, 5), (1, 2, 6))], [4, -1])
    for viewer, met, distance in ((4, 1, 5.0), (3, 0, 0.0), (-2, 0, 0.0)):
        hits = look(scene, [View(EYE, viewer=viewer)], moving)
        assert (hits.solid[0, 0, 0], hits.distance[0, 0, 0]) == (met, distance)


def test_the_water_of_a_deep_lake_is_seen_from_just_above_it() -> None:
    heights, water = np.full((49, 49), -20.0), np.full((48, 48), 0.0)
    deep = build_world((-48.0, -48.0), heights, water, [], np.zeros((1, 3)))
    view = View((0.0, 1.0, 0.0), size=(38, 22), far=40.0)
    answers = seen_by(scene_of(deep), view, with_water=True)
    below = directions(view)[:, 1] < -1.0 / 40.0
    assert below.any()
    assert (answers.solid[below] == WATER_HIT).all()


def test_nothing_is_met_beyond_the_map_even_if_a_solid_reaches_there() -> None:
    scene = scene_of(flat_world(32, [box((12.0, 0.0, -4.0), (24.0, 6.0, 4.0))]))
    beyond = View((15.5, 3.0, -15.0), yaw=20.0, pitch=-2.0, size=(41, 21), field_of_view=120.0, far=50.0)
    whole = seen_by(scene, beyond)
    places = np.array(beyond.eye) + directions(beyond) * whole.distance[:, None]
    met = whole.solid != NOTHING_HIT
    assert (whole.solid >= 0).any()
    assert (np.abs(places[met][:, [0, 2]]) <= 16.0 + 1e-4).all()
    middle = seen_by(scene, beyond._replace(size=(1, 1), field_of_view=1.0))
    assert middle.solid[0] == whole.solid[len(met) // 2] == NOTHING_HIT
