"""Images of maps agree with brute force over the exported triangles and do not depend on other images."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import box
from tests.engine.rendering.brute_force import (
    NEAR_SURFACE,
    Surface,
    containers,
    disagreements,
    surface_of,
)
from tests.engine.rendering.views import (
    SIZES,
    Country,
    View,
    cast,
    check,
    directions,
    in_the_air,
    look,
    look_at,
    seen_by,
)

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import CELL
from wildscav_engine.rendering.hits import WATER_HIT
from wildscav_engine.rendering.tracing.solids import gather_solids

# --- Images of generated maps -----------------------------------------------------------------------------


def standing(country: Country, place: str, random: np.random.Generator) -> tuple[float, float, float]:
    """Return a random eye of an agent."""
    x, y, z = random.choice(getattr(country.map, place))
    return x, y + 1.5, z


@pytest.mark.parametrize("place", ["outdoor", "indoor", "in the air"])
@pytest.mark.parametrize("number", range(2))
def test_images_show_what_is_there(country: Country, place: str, number: int) -> None:
    random = np.random.default_rng(number)
    if place == "in the air":
        eye, pitch, far = in_the_air(country.world, random), random.uniform(-20, 60), 300.0
    else:
        eye, pitch, far = standing(country, place, random), random.uniform(-30, 30), 100.0
    check(country.surface, country.scene, View(eye, random.uniform(-180, 180), pitch, (38, 22), far=far))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("field_of_view", [1.0, 60.0, 170.0])
def test_every_size_and_field_of_view_shows_what_is_there(
    village: Country, size: tuple[int, int], field_of_view: float
) -> None:
    random = np.random.default_rng(size[0] * 1000 + int(field_of_view))
    eye = standing(village, "outdoor", random)
    check(village.surface, village.scene, View(eye, 200.0, 5.0, size, field_of_view))


@pytest.mark.parametrize("pitch", [-90.0, -89.9, -60.0, 60.0, 89.9, 90.0])
@pytest.mark.parametrize("yaw", [0.0, 90.0, 137.0, -180.0])
def test_looking_steeply_up_and_down_shows_what_is_there(village: Country, yaw: float, pitch: float) -> None:
    for place in (village.map.indoor[0], village.map.outdoor[40]):
        # Off the grid of places, where many rays would run along edges of cells.
        eye = (place[0] + 0.13, place[1] + 1.5, place[2] + 0.07)
        check(village.surface, village.scene, View(eye, yaw, pitch, (15, 9), 90.0))


@pytest.mark.parametrize("far", [0.5, 3.0, 12.0, 16.0, 40.0])
def test_nothing_beyond_far_is_seen_and_nothing_before_it_is_lost(village: Country, far: float) -> None:
    for place in (village.map.indoor[3], village.map.outdoor[7]):
        view = View((place[0], place[1] + 1.5, place[2]), 60.0, 20.0, (38, 22), far=far)
        check(village.surface, village.scene, view)
        assert not np.any(np.isfinite(d := look(village.scene, [view]).distance) & (d > far))


# --- Single rays ------------------------------------------------------------------------------------------


def check_rays(country: Country, eye: Sequence[float], ways: NDArray[np.float64], far: float = 100.0) -> None:
    """Check that single rays and images of one pixel hit the same as brute force."""
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


@settings(max_examples=25)
@given(st.integers(-29, 29), st.integers(-29, 29), st.sampled_from([0.25, 1.5, 4.0, 30.0]))
def test_rays_along_the_axes(village: Country, x: int, z: int, up: float) -> None:
    check_rays(village, (x, ground_at(village.world, x, z).height + up, z), AXES)


@settings(max_examples=25)
@given(st.floats(-29, 29), st.floats(-29, 29), st.floats(0.1, 20), st.integers(-15, 15), st.integers(-15, 15))
@example(x=3.0, z=0.0, up=1.0, column=0, row=1)
def test_rays_through_corners_of_the_terrain(
    village: Country, x: float, z: float, up: float, column: int, row: int
) -> None:
    eye = np.array([x, ground_at(village.world, x, z).height + up, z])
    corner = np.array([CELL * column, village.world.heights[row + 15, column + 15], CELL * row])
    diagonal = corner + np.array([1.0, 0.0, 1.0])
    check_rays(village, eye, unit(corner - eye, diagonal - eye))


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.floats(0, 1), st.floats(0.2, 15), st.integers(0, 10**6))
def test_rays_through_edges_and_corners_of_solids(
    country: Country, triangle: int, share: float, away: float, seed: int
) -> None:
    solid = np.flatnonzero(country.surface.solids >= 0)
    a, b, _ = country.surface.corners[solid[triangle % len(solid)]]
    point = a + share * (b - a)
    eye = point + away * unit(np.random.default_rng(seed).normal(size=3))[0]
    check_rays(country, eye, unit(point - eye, a - eye))


@settings(max_examples=10)
@given(st.integers(0, 10**6), st.floats(-180, 180), st.floats(-90, 90))
def test_rays_from_inside_a_house(country: Country, place: int, yaw: float, pitch: float) -> None:
    x, y, z = country.map.indoor[place % len(country.map.indoor)]
    ways = directions(View((x, y, z), yaw, pitch))
    check_rays(country, (x, y + 1.5, z), np.concatenate([ways, -ways]))


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
    """Return nine cameras at various places."""
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
