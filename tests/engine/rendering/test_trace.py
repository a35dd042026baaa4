"""What images show is what brute force over the exported triangles meets, and does not depend on company."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.engine.rendering.brute_force import (
    NEAR_SURFACE,
    Met,
    Surface,
    a_hair_aside,
    containers,
    disagreements,
    repeated,
    surface_of,
)
from tests.engine.rendering.views import (
    NOTHING_MOVES,
    View,
    cast,
    directions,
    look,
    seen_by,
)

from builders import box, flat_world
from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.shapes import box as turned_box
from wildscav_engine.geometry.shapes import pose
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import BLOCK, CELL, Kind, Solid, World, build_world, convex_solid
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.solids import Solids, gather_solids
from wildscav_engine.rendering.trace import WATER_HIT, Scene, scene_of
from wildscav_engine.spec import MapConfig

EDGES = 0.02  # of an image's rays at most may run so close to an edge that they go by either side of it
SIZES = [(1, 1), (1, 7), (7, 1), (38, 22), (64, 36), (65, 37)]
COUNTRIES = {
    "houses and trees": (MapConfig(size=60, houses=2, vegetation=0.8), 11),
    "lakes": (MapConfig(size=80, houses=1, water=0.35, vegetation=0.5), 3),
    "cliffs": (MapConfig(size=100, houses=1, relief=2.0, ruggedness=1.0, vegetation=0.3), 5),
    "streets": (MapConfig(size=120, houses=6, density="high", storeys=(2, 3), vegetation=0.2), 7),
}


class Country:
    """A generated map with its triangles."""

    def __init__(self, game_map: GameMap) -> None:
        self.map = game_map
        self.world = game_map.world
        self.scene = game_map.scene
        self.surface = surface_of(game_map.world)


@pytest.fixture(scope="module", params=COUNTRIES)
def country(request: pytest.FixtureRequest) -> Country:
    return Country(generate_map(*COUNTRIES[request.param]))


@pytest.fixture(scope="module")
def village() -> Country:
    return Country(generate_map(*COUNTRIES["houses and trees"]))


@pytest.fixture(scope="module")
def lake() -> Country:
    return Country(generate_map(*COUNTRIES["lakes"]))


def check(
    surface: Surface, scene: Scene, view: View, moving: Solids = NOTHING_MOVES, most: float = EDGES
) -> None:
    """An image is what brute force makes of it, but for the few rays that run along edges."""
    ways = directions(view)
    answers = seen_by(scene, view, moving)
    faults, along_edges = disagreements(surface, np.array(view.eye), ways, view.far, answers)
    assert not faults, f"{view}: {len(faults)} of {len(ways)} rays, the first {faults[0]}"
    assert along_edges <= max(3, most * len(ways)), f"{view}: {along_edges} rays along edges"


def check_world(solids: Sequence[Solid], *views: View, slope: float = 0.0, size: int = 80) -> None:
    """A world made by hand is seen as brute force sees it, whether its solids stand still or move."""
    world = flat_world(size, solids, slope)
    bare, moving = flat_world(size, slope=slope), gather_solids(solids)
    for view in views:
        check(surface_of(world), scene_of(world), view, most=0.04)
        check(surface_of(bare, moving), scene_of(bare), view, moving, most=0.04)


def look_at(eye: Sequence[float], point: Sequence[float]) -> tuple[float, float]:
    """Return the yaw and pitch in degrees that look from an eye to a point."""
    x, y, z = (to - at for at, to in zip(eye, point, strict=True))
    return math.degrees(math.atan2(x, z)), -math.degrees(math.atan2(y, math.hypot(x, z)))


def in_the_air(world: World, random: np.random.Generator) -> tuple[float, float, float]:
    """Return a random point above the ground of a map."""
    x, z = random.uniform(world.corner, -world.corner)
    return float(x), ground_at(world, x, z).height + float(random.exponential(4.0)), float(z)


# --- Images of generated maps -----------------------------------------------------------------------------


@pytest.mark.parametrize("place", ["outdoor", "indoor"])
@pytest.mark.parametrize("number", range(3))
def test_images_from_where_agents_stand_show_what_is_there(country: Country, place: str, number: int) -> None:
    random = np.random.default_rng(number)
    spot = random.choice(getattr(country.map, place))
    view = View(
        (spot[0], spot[1] + 1.5, spot[2]), random.uniform(-180, 180), random.uniform(-30, 30), (38, 22)
    )
    check(country.surface, country.scene, view)


@pytest.mark.parametrize("number", range(3))
def test_images_from_the_air_show_what_is_there(country: Country, number: int) -> None:
    random = np.random.default_rng(100 + number)
    eye = in_the_air(country.world, random)
    view = View(eye, random.uniform(-180, 180), random.uniform(-20, 60), (38, 22), far=300.0)
    check(country.surface, country.scene, view)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("field_of_view", [1.0, 60.0, 170.0])
def test_every_size_and_field_of_view_shows_what_is_there(
    village: Country, size: tuple[int, int], field_of_view: float
) -> None:
    random = np.random.default_rng(size[0] * 1000 + int(field_of_view))
    x, y, z = random.choice(village.map.outdoor)
    check(village.surface, village.scene, View((x, y + 1.5, z), 200.0, 5.0, size, field_of_view))


@pytest.mark.parametrize("pitch", [-90.0, -89.9, -60.0, 60.0, 89.9, 90.0])
@pytest.mark.parametrize("yaw", [0.0, 90.0, 137.0, -180.0])
def test_looking_steeply_up_and_down_shows_what_is_there(village: Country, yaw: float, pitch: float) -> None:
    for place in (village.map.indoor[0], village.map.outdoor[40]):
        # Aside from the grid of places, where many rays would run along edges of cells.
        eye = (place[0] + 0.13, place[1] + 1.5, place[2] + 0.07)
        check(village.surface, village.scene, View(eye, yaw, pitch, (15, 9), 90.0))


@pytest.mark.parametrize("far", [0.5, 3.0, 12.0, 16.0, 40.0])
def test_nothing_beyond_far_is_seen_and_nothing_before_it_is_lost(village: Country, far: float) -> None:
    for place in (village.map.indoor[3], village.map.outdoor[7]):
        view = View((place[0], place[1] + 1.5, place[2]), 60.0, 20.0, (38, 22), far=far)
        check(village.surface, village.scene, view)
        assert not np.any(np.isfinite(d := look(village.scene, [view]).distance) & (d > far))


def test_every_pixel_is_what_its_ray_alone_meets(country: Country) -> None:
    random = np.random.default_rng(5)
    for place in (country.map.indoor, country.map.outdoor):
        x, y, z = random.choice(place)
        view = View((x, y + 1.5, z), random.uniform(-180, 180), random.uniform(-30, 30), (64, 36))
        alone = cast(country.world, view.eye, directions(view), view.far)
        image = seen_by(country.scene, view)
        differs = differing(image, alone)
        beside = np.array([aside_agrees(country.world, view, image, ray) for ray in differs], bool)
        assert beside.all(), f"{view}: {differs[~beside][:5]} are not what their rays meet"
        assert len(differs) <= EDGES * len(image.solid)


def differing(one: Met, other: Met) -> NDArray[np.int64]:
    """Return the rays that two tracers do not answer alike."""
    with np.errstate(invalid="ignore"):
        apart = np.abs(one.distance - other.distance) > 1e-3 + 1e-4 * other.distance
    return np.flatnonzero((one.solid != other.solid) | (apart & (one.distance != other.distance)))


def aside_agrees(world: World, view: View, image: Met, ray: int) -> bool:
    """Return whether a ray a hair aside meets what a pixel shows."""
    ways = a_hair_aside(directions(view)[ray])
    around = cast(world, view.eye, ways, view.far)
    return len(differing(repeated(image, ray, len(ways)), around)) < len(ways)


# --- Single rays ------------------------------------------------------------------------------------------


def check_rays(country: Country, eye: Sequence[float], ways: NDArray[np.float64], far: float = 100.0) -> None:
    """Single rays, and images of one pixel, meet what brute force meets."""
    answers = cast(country.world, eye, ways, far)
    faults, _ = disagreements(country.surface, np.array(eye, np.float64), ways, far, answers)
    assert not faults, faults[0]
    for way in ways:
        yaw, pitch = look_at((0.0, 0.0, 0.0), way)
        check(country.surface, country.scene, View(tuple(map(float, eye)), yaw, pitch, far=far))


def unit(*ways: Sequence[float]) -> NDArray[np.float64]:
    rays = np.array(ways, np.float64)
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None])


AXES = unit((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


@pytest.mark.parametrize("seed", range(3))
def test_random_rays_meet_what_is_there(country: Country, seed: int) -> None:
    random = np.random.default_rng(seed)
    for _ in range(3):
        ways = unit(*random.normal(size=(12, 3)))
        check_rays(country, in_the_air(country.world, random), ways)


@settings(max_examples=25)
@given(st.integers(-29, 29), st.integers(-29, 29), st.sampled_from([0.25, 1.5, 4.0, 30.0]))
def test_rays_along_the_axes(village: Country, x: int, z: int, up: float) -> None:
    check_rays(village, (x, ground_at(village.world, x, z).height + up, z), AXES)


@settings(max_examples=25)
@given(st.floats(-29, 29), st.floats(-29, 29), st.floats(0.1, 20), st.integers(-15, 15), st.integers(-15, 15))
def test_rays_through_corners_of_the_terrain(
    village: Country, x: float, z: float, up: float, column: int, row: int
) -> None:
    eye = np.array([x, ground_at(village.world, x, z).height + up, z])
    corner = np.array([CELL * column, village.world.heights[row + 15, column + 15], CELL * row])
    diagonal = corner + np.array([1.0, 0.0, 1.0])
    check_rays(village, eye, unit(corner - eye, diagonal - eye))


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.floats(0, 1), st.floats(0.2, 15), st.integers(0, 10**6))
def test_rays_through_edges_and_corners_of_solids(
    village: Country, triangle: int, share: float, away: float, seed: int
) -> None:
    solid = np.flatnonzero(village.surface.solids >= 0)
    a, b, _ = village.surface.corners[solid[triangle % len(solid)]]
    point = a + share * (b - a)
    eye = point + away * unit(np.random.default_rng(seed).normal(size=3))[0]
    check_rays(village, eye, unit(point - eye, a - eye))


@settings(max_examples=20)
@given(st.integers(0, 10**6), st.floats(-180, 180), st.floats(-90, 90))
def test_rays_from_inside_a_house(village: Country, place: int, yaw: float, pitch: float) -> None:
    x, y, z = village.map.indoor[place % len(village.map.indoor)]
    ways = directions(View((x, y, z), yaw, pitch))
    check_rays(village, (x, y + 1.5, z), np.concatenate([ways, -ways]))


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.floats(0.05, 0.45), st.floats(0.05, 0.45), st.integers(0, 10**6))
def test_rays_that_start_on_a_surface(village: Country, triangle: int, b: float, c: float, seed: int) -> None:
    number = triangle % len(village.surface.corners)
    corner_a, corner_b, corner_c = village.surface.corners[number]
    eye = corner_a + b * (corner_b - corner_a) + c * (corner_c - corner_a)
    random = unit(np.random.default_rng(seed).normal(size=3))
    check_rays(village, eye, np.concatenate([random, -random]))
    normal = village.surface.normals[number : number + 1]
    check_rays(village, eye + 2e-3 * normal[0], np.concatenate([random, normal, -normal]))
    check_rays(village, eye - 2e-3 * normal[0], np.concatenate([random, normal, -normal]))


@settings(max_examples=20)
@given(st.floats(-35, 35), st.floats(-35, 35), st.floats(-5, 5), st.floats(-180, 180), st.floats(-90, 90))
def test_rays_from_below_the_ground_and_beside_the_map(
    village: Country, x: float, z: float, up: float, yaw: float, pitch: float
) -> None:
    eye = (x, ground_at(village.world, x, z).height + up, z)
    check_rays(village, eye, directions(View(eye, yaw, pitch)))


@pytest.mark.parametrize(
    ("x", "z", "yaw"), [(-31.0, 0.0, 90.0), (31.0, 5.0, -90.0), (0.0, 30.0, 180.0), (3.0, -900.0, 0.0)]
)
def test_who_looks_into_the_map_from_outside_sees_nothing(
    village: Country, x: float, z: float, yaw: float
) -> None:
    view = View((x, 15.0, z), yaw, 10.0, (38, 22), far=2000.0)
    assert (look(village.scene, [view]).solid == NOTHING_HIT).all()
    check(village.surface, village.scene, view)


def test_who_looks_out_of_the_map_sees_nothing_beyond_its_edge(village: Country) -> None:
    eye = (29.5, ground_at(village.world, 29.5, 3.0).height + 30.0, 3.0)
    view = View(eye, 90.0, 0.0, (9, 5), 40.0, far=2000.0)
    assert (look(village.scene, [view]).solid == NOTHING_HIT).all()
    assert np.isinf(look(village.scene, [view]).distance).all()


def test_an_eye_in_a_solid_or_below_the_ground_sees_it_at_no_distance(village: Country) -> None:
    low, high = village.world.solid_low, village.world.solid_high
    for middle in ((low + high) / 2)[::9]:
        holders = containers(village.surface, middle, NEAR_SURFACE)
        hits = look(village.scene, [View(tuple(middle), 30.0, 0.0, (7, 5))])
        if containers(village.surface, middle, -NEAR_SURFACE):
            assert (hits.distance == 0).all()
            assert np.isin(hits.solid, holders).all()
    deep = look(village.scene, [View((2.3, -300.0, 2.9), 30.0, -80.0, (7, 5))])
    assert (deep.distance == 0).all()
    assert (deep.solid == TERRAIN_HIT).all()


# --- Worlds made by hand: what a fast tracer may lose -----------------------------------------------------

EYE = (0.0, 1.5, 0.0)


def rock(random: np.random.Generator, middle: Sequence[float], radius: float) -> Solid:
    """A convex solid of random shape: an octahedron pulled about."""
    points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64)
    points *= radius * random.uniform(0.3, 1.0, (6, 1))
    faces = [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    return convex_solid(Kind.ROCK, points + middle, faces)


@pytest.mark.parametrize("column", [0, 1, 31, 32, 50, 63])
@pytest.mark.parametrize("away", [0.6, 5.0, 17.0, 38.9])
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
@pytest.mark.parametrize("field_of_view", [60.0, 150.0])
def test_solids_near_beside_behind_and_around_the_eye(name: str, field_of_view: float) -> None:
    solids = [box(low, high) for low, high in NEAR_THE_EYE[name]]
    views = [
        View(EYE, yaw, pitch, (21, 13), field_of_view)
        for yaw, pitch in ((0.0, 0.0), (37.0, -20.0), (91.0, 40.0), (181.0, -90.0))
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


def random_world(random: np.random.Generator) -> tuple[World, list[Solid]]:
    """A rough world of 48 m with boxes, slats, poles and rocks anywhere, some in the air or in the ground."""
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
    return build_world((-24.0, -24.0), heights, water, solids, np.zeros((1, 3))), solids


def check_random_world(seed: int, size: tuple[int, int]) -> None:
    random = np.random.default_rng(seed)
    world, _ = random_world(random)
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


@settings(max_examples=60)
@given(st.integers(0, 2**32), st.sampled_from([(1, 1), (3, 11), (20, 12), (33, 19)]))
def test_any_world_is_seen_as_brute_force_sees_it(seed: int, size: tuple[int, int]) -> None:
    check_random_world(seed, size)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1500))
def test_any_world_at_full_size_is_seen_as_brute_force_sees_it(seed: int) -> None:
    check_random_world(seed, [(38, 22), (64, 36), (65, 37)][seed % 3])


def test_a_ray_along_a_border_of_cells_names_a_triangle_that_it_meets() -> None:
    for seed in range(20):
        world, _ = random_world(np.random.default_rng(seed))
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


@pytest.mark.parametrize("number", range(4))
def test_crowds_in_a_village_are_seen_as_brute_force_sees_them(village: Country, number: int) -> None:
    random = np.random.default_rng(number)
    places = np.concatenate([random.choice(village.map.outdoor, 30), random.choice(village.map.indoor, 10)])
    bodies = [box(place - np.array([0.4, 0, 0.4]), place + np.array([0.4, 1.78, 0.4])) for place in places]
    moving = gather_solids(bodies, [*range(40)])
    surface = surface_of(village.world, moving)
    seat = number * 11
    rows = surface.solids != surface.static + seat
    own = Surface(*(part[rows] for part in surface[:5]), *surface[5:])
    x, y, z = places[seat]
    view = View((x, y + 1.5, z), random.uniform(-180, 180), 5.0, (38, 22), viewer=seat)
    check(own, village.scene, view, moving)


# --- Water ------------------------------------------------------------------------------------------------


def test_water_hides_its_bed_from_above_when_asked_for(lake: Country) -> None:
    random = np.random.default_rng(1)
    wet = surface_of(lake.world, with_water=True)
    seen = 0
    for _ in range(6):
        view = View(in_the_air(lake.world, random), random.uniform(-180, 180), 35.0, (38, 22))
        eye = np.array(view.eye)
        if lake.world.water.max() > eye[1]:
            continue
        answers = seen_by(lake.scene, view, with_water=True)
        faults, _ = disagreements(wet, eye, directions(view), view.far, answers)
        assert not faults, f"{view}: {len(faults)}, the first {faults[0]}"
        seen += int((answers.solid == WATER_HIT).sum())
    assert seen > 100


def test_a_hit_on_water_names_the_cell_where_its_surface_is_met(lake: Country) -> None:
    row, column = np.argwhere(np.isfinite(lake.world.water))[20]
    x, z = lake.world.corner + CELL * np.array([column + 0.5, row + 0.5])
    eye = (float(x), float(lake.world.water[row, column]) + 2.0, float(z))
    hits = look(lake.scene, [View(eye, 20.0, 60.0, (15, 9))], with_water=True)
    ways = directions(View(eye, 20.0, 60.0, (15, 9))).reshape(9, 15, 3)
    points = np.array(eye) + ways * hits.distance[0][:, :, None]
    wet = hits.solid[0] == WATER_HIT
    assert wet.any()
    cells = np.floor((points[:, :, [2, 0]] - lake.world.corner[::-1]) / CELL).astype(int)
    named = cells[:, :, 0] * lake.world.water.shape[1] + cells[:, :, 1]
    assert (hits.face[0][wet] == named[wet]).all()


# --- The same ray has the same answer ---------------------------------------------------------------------


def crowd(country: Country, size: tuple[int, int]) -> list[View]:
    """Nine cameras here and there."""
    random = np.random.default_rng(3)
    places = np.concatenate([random.choice(country.map.indoor, 4), random.choice(country.map.outdoor, 5)])
    return [
        View((x, y + 1.5, z), random.uniform(-180, 180), random.uniform(-90, 90), size) for x, y, z in places
    ]


@pytest.mark.parametrize("size", SIZES)
def test_an_image_does_not_depend_on_the_others_of_its_batch(country: Country, size: tuple[int, int]) -> None:
    views = crowd(country, size)
    together = look(country.scene, views)
    order = np.random.default_rng(8).permutation(len(views))
    shuffled = look(country.scene, [views[number] for number in order])
    for number, view in enumerate(views):
        alone = look(country.scene, [view])
        for one, all_of_them in zip(alone, together, strict=True):
            assert one[0].tobytes() == all_of_them[number].tobytes()
    for one, other in zip(together, shuffled, strict=True):
        assert one[order].tobytes() == other.tobytes()


def test_the_middle_of_an_image_does_not_depend_on_its_size(country: Country) -> None:
    for view in crowd(country, (1, 1)):
        answers = set()
        for width, height in ((1, 1), (1, 7), (7, 1), (65, 37), (5, 3), (201, 11)):
            for lens in (1.0, 60.0, 170.0):
                hits = look(country.scene, [view._replace(size=(width, height), field_of_view=lens)])
                answers.add(tuple(part[0, height // 2, width // 2].tobytes() for part in hits))
        assert len(answers) == 1, view


def test_what_lies_beyond_does_not_change_what_is_met(country: Country) -> None:
    for view in crowd(country, (38, 22)):
        near = look(country.scene, [view._replace(far=20.0)])
        distant = look(country.scene, [view._replace(far=500.0)])
        met = np.isfinite(near.distance)
        assert (near.distance[met] == distant.distance[met]).all()
        assert (distant.distance[~met] > 19.999).all()


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
